//! The caller's arrays, read where they lie, the boundary found in them, and the part near it.

pub mod boundary;
pub mod neighbourhood;
pub mod normals;
pub mod roots;
mod view;

pub use view::{FaceView, MeshView, VertexView};

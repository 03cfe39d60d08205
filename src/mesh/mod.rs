//! The caller's arrays, read where they lie, and the boundary found in them.

mod view;

pub use view::{FaceView, MeshView, VertexView};

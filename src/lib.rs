//! Fills the holes of triangle meshes so that nobody sees where they were.
//!
//! ```
//! use complete_mesh::{complete_mesh, Options};
//!
//! // A tetrahedron without its floor: one hole of three edges.
//! let vertices = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
//! let faces = [[0, 1, 3], [0, 3, 2], [1, 2, 3]];
//! let completion = complete_mesh(&vertices[..], &faces[..], &Options::default())?;
//! assert_eq!(completion.holes.len(), 1);
//! let (all_vertices, all_faces) = completion.to_mesh_f64(&vertices, &faces);
//! assert_eq!(&all_vertices[..4], &vertices[..]);
//! assert_eq!(&all_faces[..3], &faces[..]);
//! # Ok::<(), complete_mesh::Error>(())
//! ```
//!
//! The contract: every input vertex and face comes back bit for bit, first, in order; the fill is
//! manifold, oriented, joined to the rim and free of self-intersections, or the call returns an
//! [`Error`] and nothing half done. The bytes of the result do not depend on the thread count.
//!
//! Modules in the order data flows: [`mesh`] → [`holes`] → [`fill`] → [`intersect`] →
//! [`descriptor`] → [`matching`] → [`complete`] → [`result`]. [`options`] and [`guidance`] are what
//! may be asked for. `capi` is the C face of the same
//! calls; `io`, `sample`, `picture` and `cli` serve the command line.

#[cfg(feature = "capi")]
pub mod capi;
pub mod complete;
pub mod descriptor;
pub mod error;
pub mod fill;
pub mod guidance;
pub mod holes;
pub mod intersect;
#[cfg(feature = "io")]
pub mod io;
pub mod matching;
pub mod mesh;
pub mod options;
mod parallel;
pub mod points;
pub mod progress;
pub mod result;
pub mod synthesis;

#[cfg(feature = "cli")]
pub mod cli;
#[cfg(feature = "io")]
pub mod picture;
#[cfg(feature = "io")]
pub mod sample;

pub use complete::{complete_mesh, complete_mesh_with, Completer};
pub use error::{Error, Problem, Result};
pub use guidance::{Guidance, Placement};
pub use holes::{find_holes, BoundaryLoop, Hole, HoleKind, HoleList};
pub use mesh::{FaceView, MeshView, VertexView};
pub use options::{
    Appearance, Cleaning, Exemplar, Fairing, GivenHole, Grouping, Initial, Method, Options,
    Selection, Sizing, Sources,
};
pub use points::{
    complete_points, complete_points_with, find_point_holes, CleanedPoints, Copied,
    PointCompletion, PointHoles,
};
pub use progress::Monitor;
pub use result::{Completion, HoleReport, HoleStatus, Origin, Seam, SourceReport};

/// The examples of the README run as tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
pub struct Readme;

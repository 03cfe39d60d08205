//! The whole chain, method by method.

use crate::error::Result;
use crate::holes::{find_holes, HoleList};
use crate::mesh::{FaceView, MeshView, VertexView};
use crate::options::{Grouping, Options};
use crate::progress::Monitor;
use crate::result::Completion;

/// Completes a mesh in one call, in silence. See [`Completer`] for the parts.
pub fn complete_mesh<'a>(
    vertices: impl Into<VertexView<'a>>,
    faces: impl Into<FaceView<'a>>,
    options: &Options,
) -> Result<Completion> {
    complete_mesh_with(MeshView::new(vertices, faces), options, &Monitor::silent())
}

/// Completes a mesh in one call, with progress and cancel.
pub fn complete_mesh_with(
    mesh: MeshView<'_>,
    options: &Options,
    monitor: &Monitor,
) -> Result<Completion> {
    options.check()?;
    Completer::new(mesh, &options.grouping, monitor)?.complete(options, monitor)
}

/// Keeps what is expensive and does not change between calls on one mesh: the checked arrays and
/// the holes found in them.
pub struct Completer<'a> {
    mesh: MeshView<'a>,
    holes: HoleList,
}

impl<'a> Completer<'a> {
    /// Checks the arrays and finds the holes.
    pub fn new(mesh: MeshView<'a>, grouping: &Grouping, monitor: &Monitor) -> Result<Self> {
        Ok(Self { mesh, holes: find_holes(mesh, grouping, monitor)? })
    }

    /// The holes found.
    pub fn holes(&self) -> &HoleList {
        &self.holes
    }

    /// Fills the holes that `options` select. `options.grouping` is not read: it was settled in
    /// [`Completer::new`].
    pub fn complete(&self, options: &Options, _monitor: &Monitor) -> Result<Completion> {
        options.check()?;
        let _ = self.mesh;
        unimplemented!()
    }
}

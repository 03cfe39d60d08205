//! The whole chain, method by method.

pub mod smooth;

use crate::error::Result;
use crate::fill::sheet::Incidence;
use crate::mesh::neighbourhood::{Bounds, Neighbourhood};
use glam::DVec3;
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
        let t0 = std::time::Instant::now();
        let boxes: Vec<Bounds> = self.holes.holes.iter().map(|h| {
            let b = Bounds::of(h.loops.iter().flat_map(|&l| &self.holes.loops[l].vertices).map(|&v| DVec3::from(self.mesh.vertices.get(v as usize))));
            b.grown(0.3 * h.diameter + 6.0 * h.circumference / h.edges as f64)
        }).collect();
        let near = Neighbourhood::gather(self.mesh, &boxes, _monitor)?;
        let incidence = Incidence::new(&near);
        if std::env::var("CM_T").is_ok() { eprintln!("gather {:?} {} faces", t0.elapsed(), near.faces.len()); }
        let mut c = Completion { input_vertex_count: self.mesh.vertices.len(), input_face_count: self.mesh.faces.len(), vertices: vec![], faces: vec![], vertex_hole: vec![], face_hole: vec![], holes: vec![], seconds: 0.0, cpu_seconds: 0.0 };
        for h in &self.holes.holes {
            let loops: Vec<Vec<u32>> = h.loops.iter().map(|&l| self.holes.loops[l].vertices.iter().map(|&v| near.local(v).unwrap()).collect()).collect();
            let Some((outline, patch)) = smooth::fill_hole(&near, &incidence, &loops) else { eprintln!("hole {} failed", h.id); continue };
            let base = (c.input_vertex_count + c.vertices.len()) as u32;
            let r = patch.rim_count;
            for p in &patch.positions[r..] { c.vertices.push(p.to_array().map(|x| x as f32 as f64)); c.vertex_hole.push(h.id as u32); }
            for t in &patch.triangles { c.faces.push(t.map(|v| if (v as usize) < r { near.vertices[outline.vertices[v as usize] as usize] } else { base + v - r as u32 })); c.face_hole.push(h.id as u32); }
        }
        Ok(c)
    }
}

//! Boundary loops, measured and grouped into holes; which of them the caller wants.

use crate::error::{Problem, Result};
use crate::mesh::MeshView;
use crate::options::Grouping;
use crate::progress::Monitor;

/// One closed chain of boundary edges.
#[derive(Debug, Clone, PartialEq)]
pub struct BoundaryLoop {
    /// Vertices in the order that a filling face runs: each boundary edge of the input goes from
    /// `vertices[i + 1]` to `vertices[i]`. Starts at the smallest index.
    pub vertices: Vec<u32>,
    /// Length in mesh units.
    pub length: f64,
    /// Greatest distance between two of its vertices, in mesh units (over the bounding box's
    /// extreme vertices; at least 1/√3 of the true one).
    pub diameter: f64,
    /// Mean of its points, weighted by length.
    pub centre: [f64; 3],
}

/// What a hole looks like.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum HoleKind {
    /// One loop: filled by a disc.
    Disc,
    /// An outer loop with islands inside: the islands are joined to the fill.
    Islands,
    /// Two loops that face each other: a band is missing.
    Ring,
    /// Several loops that the caller joined, or a branching gap.
    Several,
}

/// Loops that are filled together by one piece of surface.
#[derive(Debug, Clone, PartialEq)]
pub struct Hole {
    /// Index in [`HoleList::holes`]; holes are ordered by their smallest vertex.
    pub id: usize,
    /// Indices into [`HoleList::loops`], the longest first.
    pub loops: Vec<usize>,
    /// What it looks like.
    pub kind: HoleKind,
    /// Boundary edges of all its loops.
    pub edges: usize,
    /// Length of all its loops, in mesh units.
    pub circumference: f64,
    /// Diameter of its longest loop, in mesh units.
    pub diameter: f64,
    /// Centre of its longest loop.
    pub centre: [f64; 3],
    /// Why it cannot be filled safely, if so.
    pub problem: Option<Problem>,
}

/// Everything found out about a mesh's boundary.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct HoleList {
    /// All boundary loops, ordered by their smallest vertex.
    pub loops: Vec<BoundaryLoop>,
    /// All holes.
    pub holes: Vec<Hole>,
    /// Edges with more than two faces, found at or near the boundary.
    pub non_manifold_edges: Vec<[u32; 2]>,
    /// Edges whose two faces run the same way.
    pub inconsistent_edges: Vec<[u32; 2]>,
    /// Faces that name a vertex twice; they are passed through and otherwise ignored.
    pub degenerate_faces: Vec<u32>,
    /// Pairs of boundary vertices at the same position: the mesh is not welded there.
    pub duplicate_boundary_vertices: Vec<[u32; 2]>,
}

/// Finds, measures and groups the boundary loops of a mesh: one linear pass.
pub fn find_holes(
    _mesh: MeshView<'_>,
    _grouping: &Grouping,
    _monitor: &Monitor,
) -> Result<HoleList> {
    unimplemented!()
}

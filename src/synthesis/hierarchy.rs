//! Bendels, Schnabel and Klein (2005), "Fragment-based surface inpainting", Sec. 5.1: a surface at ever
//! coarser scales, by smoothing in the direction of its normals.
//!
//! Differences from the paper:
//! - The completed mesh is smoothed, its holes closed by their smooth completions: what is beside a
//!   hole is then filtered as what is like it elsewhere.
//! - Neighbours are those of the mesh, and the kernel grows by more rounds, not by more neighbours.

use super::describe::Parts;
use crate::descriptor::ball::VertexGraph;
use crate::error::Result;
use crate::matching::source::Source;
use crate::mesh::normals::vertex_normals_checked;
use crate::mesh::MeshView;
use glam::DVec3;

/// Radius of a fragment of the finest scale, in mean edges: a ring of places an edge and a bit.
const FINEST: f64 = 4.0;
/// Scales at most: on the coarsest a fragment has a radius of 64 edges.
pub const MOST: usize = 5;
/// Standard deviation of the kernel that makes the next scale, in radii of a fragment: what is lost is
/// what a fragment shows several of.
const KERNEL: f64 = 0.3;
/// Rounds of smoothing at most: bounds the cost.
const ROUNDS: usize = 400;

/// A completed object at one scale.
pub struct Scale {
    /// Of all vertices, those of the smooth completions last.
    pub positions: Vec<DVec3>,
    /// Their unit normals.
    pub normals: Vec<DVec3>,
    /// What is known of it.
    pub source: Source,
}

/// Radius of a fragment at a scale, 0 the finest, in edges.
pub fn radius_in_edges(scale: usize) -> f64 {
    FINEST * f64::from(1u32 << scale)
}

/// The scales 0 to `count` − 1 of an object. `rims`: the boundary vertices of the mesh; `open`: for
/// each vertex whether it stays on a boundary.
pub fn scales(
    mesh: MeshView<'_>,
    parts: &Parts,
    rims: &[u32],
    open: &[bool],
    count: usize,
    check: &dyn Fn(f64) -> Result<()>,
) -> Result<Vec<Scale>> {
    let graph = VertexGraph::new(parts.positions.len(), &parts.faces);
    let mut positions = parts.positions.clone();
    let (mut all, mut done) = (Vec::<Scale>::with_capacity(count), 0);
    for scale in 0..count {
        if scale > 0 {
            // A round of means over six neighbours at one edge has half a square edge of variance.
            let kernel = KERNEL * radius_in_edges(scale - 1);
            let rounds = ((2.0 * kernel * kernel).ceil() as usize).min(ROUNDS);
            for _ in done..rounds {
                check(scale as f64 / count as f64)?;
                let stop = || check(scale as f64 / count as f64);
                let faces = parts.faces.iter().copied();
                let normals = vertex_normals_checked(&positions, faces, &stop)?;
                positions = smooth(&positions, &normals, &graph, open);
            }
            done = rounds.max(done);
        }
        let stop = || check(scale as f64 / count as f64);
        let faces = parts.faces.iter().copied();
        let normals = vertex_normals_checked(&positions, faces, &stop)?;
        let known: Vec<[f64; 3]> =
            positions[..mesh.vertices.len()].iter().map(|p| p.to_array()).collect();
        let view = MeshView { vertices: (&known[..]).into(), faces: mesh.faces };
        let source = Source::new(view, rims.iter().copied(), &|_| stop())?;
        all.push(Scale { positions: positions.clone(), normals, source });
    }
    Ok(all)
}

/// One round: each vertex to the mean of its neighbours, along its normal.
fn smooth(
    positions: &[DVec3],
    normals: &[DVec3],
    graph: &VertexGraph,
    open: &[bool],
) -> Vec<DVec3> {
    let one = |v: usize| {
        let (p, around) = (positions[v], graph.neighbours(v as u32));
        if open[v] || around.is_empty() {
            return p;
        }
        let mean = around.iter().map(|&w| positions[w as usize]).sum::<DVec3>();
        p + normals[v] * normals[v].dot(mean / around.len() as f64 - p)
    };
    (0..positions.len()).map(one).collect()
}

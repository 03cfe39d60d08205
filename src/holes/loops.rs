//! Boundary edges chained to loops, and what is wrong with some of them.

use super::BoundaryLoop;
use crate::error::Problem;
use crate::mesh::boundary::Boundary;
use crate::mesh::MeshView;
use glam::DVec3;
use std::collections::HashSet;

/// A loop with the faces at its edges (`faces[i]` lies at the edge from vertex i to i + 1).
pub struct Chain {
    pub shape: BoundaryLoop,
    pub faces: Vec<u32>,
    pub problem: Option<Problem>,
}

/// Chains the boundary edges. A loop through a vertex that more than one boundary edge leaves is
/// kept, so that it can be listed, but carries its problem.
pub fn chain_loops(mesh: MeshView<'_>, boundary: &Boundary) -> Vec<Chain> {
    let edges = &boundary.edges;
    let mut used = vec![false; edges.len()];
    let first_from = |v: u32| edges.partition_point(|e| e.from < v);
    let mut chains = Vec::new();
    for start in 0..edges.len() {
        if used[start] {
            continue;
        }
        // Walk on until no unused edge leaves; a vertex met again closes a loop of its own.
        let (mut vertices, mut faces) = (Vec::new(), Vec::new());
        let mut at = start;
        loop {
            used[at] = true;
            vertices.push(edges[at].from);
            faces.push(edges[at].face);
            let to = edges[at].to;
            let next = (first_from(to)..edges.len())
                .take_while(|&e| edges[e].from == to)
                .find(|&e| !used[e]);
            match next {
                Some(e) if to != vertices[0] => at = e,
                _ => break,
            }
        }
        chains.push((vertices, faces));
    }
    let suspects = Suspects::new(boundary);
    let mut chains: Vec<Chain> = chains
        .into_iter()
        .map(|(mut vertices, mut faces)| {
            let problem = suspects.problem(&vertices);
            let smallest = (0..vertices.len()).min_by_key(|&i| vertices[i]).unwrap_or(0);
            vertices.rotate_left(smallest);
            faces.rotate_left(smallest);
            Chain { shape: measure(mesh, vertices), faces, problem }
        })
        .collect();
    chains.sort_by(|a, b| a.shape.vertices.cmp(&b.shape.vertices));
    chains
}

/// The vertices at which something is wrong.
struct Suspects<'a> {
    boundary: &'a Boundary,
    touching: HashSet<u32>,
    non_manifold: HashSet<u32>,
    inconsistent: HashSet<u32>,
}

impl<'a> Suspects<'a> {
    fn new(boundary: &'a Boundary) -> Self {
        let ends = |edges: &[[u32; 2]]| edges.iter().flatten().copied().collect();
        // Where edges leave and arrive exactly once, the loop is simple.
        let mut touching: HashSet<u32> = boundary
            .edges
            .windows(2)
            .filter(|w| w[0].from == w[1].from)
            .map(|w| w[0].from)
            .collect();
        let mut to: Vec<u32> = boundary.edges.iter().map(|e| e.to).collect();
        to.sort_unstable();
        touching.extend(to.windows(2).filter(|w| w[0] == w[1]).map(|w| w[0]));
        Self {
            boundary,
            touching,
            non_manifold: ends(&boundary.non_manifold_edges),
            inconsistent: ends(&boundary.inconsistent_edges),
        }
    }

    /// The gravest problem of a loop: the others often follow from it.
    fn problem(&self, vertices: &[u32]) -> Option<Problem> {
        let on: HashSet<u32> = vertices.iter().copied().collect();
        let at = |edges: &[[u32; 2]], ends: &HashSet<u32>| -> Vec<[u32; 2]> {
            if vertices.iter().all(|v| !ends.contains(v)) {
                return Vec::new();
            }
            edges.iter().filter(|e| e.iter().any(|v| on.contains(v))).copied().collect()
        };
        let edges = at(&self.boundary.inconsistent_edges, &self.inconsistent);
        if !edges.is_empty() {
            return Some(Problem::InconsistentOrientation { edges });
        }
        let edges = at(&self.boundary.non_manifold_edges, &self.non_manifold);
        if !edges.is_empty() {
            return Some(Problem::NonManifoldEdge { edges });
        }
        let mut touched: Vec<u32> =
            vertices.iter().filter(|v| self.touching.contains(v)).copied().collect();
        touched.sort_unstable();
        touched.dedup();
        if touched.is_empty() && vertices.len() >= 3 {
            return None;
        }
        if touched.is_empty() {
            touched = vertices.to_vec();
        }
        Some(Problem::TouchingLoops { vertices: touched })
    }
}

/// Position of a vertex as a vector.
pub fn position(mesh: MeshView<'_>, v: u32) -> DVec3 {
    mesh.vertices.get(v as usize).into()
}

fn measure(mesh: MeshView<'_>, vertices: Vec<u32>) -> BoundaryLoop {
    let at = |i: usize| position(mesh, vertices[i % vertices.len()]);
    let (mut length, mut centre) = (0.0, DVec3::ZERO);
    let mut extreme = [0usize; 6];
    for i in 0..vertices.len() {
        let (p, q) = (at(i), at(i + 1));
        let l = p.distance(q);
        length += l;
        centre += 0.5 * l * (p + q);
        for d in 0..3 {
            if p[d] < at(extreme[2 * d])[d] {
                extreme[2 * d] = i;
            }
            if p[d] > at(extreme[2 * d + 1])[d] {
                extreme[2 * d + 1] = i;
            }
        }
    }
    let centre = if length > 0.0 { centre / length } else { at(0) };
    // From each extreme vertex to the farthest one: exact for convex and most other loops.
    let diameter = extreme
        .iter()
        .map(|&e| (0..vertices.len()).map(|i| at(i).distance_squared(at(e))).fold(0.0, f64::max))
        .fold(0.0, f64::max)
        .sqrt();
    BoundaryLoop { length, diameter, centre: centre.into(), vertices }
}

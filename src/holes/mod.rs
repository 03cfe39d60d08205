//! Boundary loops, measured and grouped into holes; which of them the caller wants.

mod group;
pub(crate) mod loops;
pub mod select;

use crate::error::{Error, Problem, Result};
use crate::mesh::boundary::find_boundary;
use crate::mesh::roots::Roots;
use crate::mesh::MeshView;
use crate::options::Grouping;
use crate::progress::Monitor;
use glam::DVec3;
use group::group_loops;
use loops::chain_loops;

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
pub fn find_holes(mesh: MeshView<'_>, grouping: &Grouping, monitor: &Monitor) -> Result<HoleList> {
    let boundary = find_boundary(mesh, monitor)?;
    let chains = chain_loops(mesh, &boundary);
    let groups = match grouping {
        Grouping::Automatic => group_loops(mesh, &chains),
        Grouping::Separate => (0..chains.len()).collect(),
        Grouping::Join(lists) => join_named(&chains, lists)?,
    };
    let duplicate_boundary_vertices = duplicates(mesh, &chains);
    let problems: Vec<Option<Problem>> = chains.iter().map(|c| c.problem.clone()).collect();
    let kinds = |members: &[usize]| kind_of(&chains, members);
    let loops: Vec<BoundaryLoop> = chains.iter().map(|c| c.shape.clone()).collect();
    let mut holes: Vec<Hole> = Vec::new();
    for mut members in gather_members(&groups) {
        members.sort_by(|&a, &b| loops[b].length.total_cmp(&loops[a].length).then(a.cmp(&b)));
        let longest = &loops[members[0]];
        holes.push(Hole {
            id: holes.len(),
            kind: kinds(&members),
            edges: members.iter().map(|&l| loops[l].vertices.len()).sum(),
            circumference: members.iter().map(|&l| loops[l].length).sum(),
            diameter: longest.diameter,
            centre: longest.centre,
            problem: members.iter().find_map(|&l| problems[l].clone()),
            loops: members,
        });
    }
    Ok(HoleList {
        loops,
        holes,
        non_manifold_edges: boundary.non_manifold_edges,
        inconsistent_edges: boundary.inconsistent_edges,
        degenerate_faces: boundary.degenerate_faces,
        duplicate_boundary_vertices,
    })
}

/// The loops of each group, the groups by their first loop.
fn gather_members(groups: &[usize]) -> Vec<Vec<usize>> {
    let mut members: Vec<Vec<usize>> = vec![Vec::new(); groups.len()];
    groups.iter().enumerate().for_each(|(l, &first)| members[first].push(l));
    members.retain(|m| !m.is_empty());
    members
}

/// A ring's loops are of a size and lie across from each other; an island lies inside.
fn kind_of(chains: &[loops::Chain], members: &[usize]) -> HoleKind {
    let shape = |i: usize| &chains[members[i]].shape;
    match members.len() {
        1 => HoleKind::Disc,
        // A band's two rims are about equally long; an island is shorter than what is around it.
        // Half is the ratio that tells them apart on drawn examples.
        2 if shape(1).length > 0.5 * shape(0).length => HoleKind::Ring,
        _ => {
            let centre = DVec3::from(shape(0).centre);
            let inside = (1..members.len())
                .all(|i| centre.distance(DVec3::from(shape(i).centre)) < 0.5 * shape(0).diameter);
            match inside {
                true => HoleKind::Islands,
                false => HoleKind::Several,
            }
        }
    }
}

fn join_named(chains: &[loops::Chain], lists: &[Vec<u32>]) -> Result<Vec<usize>> {
    let mut groups = Roots::new(chains.len());
    for list in lists {
        let mut first = None;
        for v in list {
            let found = chains.iter().position(|c| c.shape.vertices.contains(v));
            let found = found.ok_or_else(|| Error::InvalidOption {
                name: "grouping",
                reason: format!("vertex {v} is on no boundary loop"),
            })? as u32;
            groups.join(*first.get_or_insert(found), found);
        }
    }
    Ok(groups.into_roots().into_iter().map(|root| root as usize).collect())
}

/// Boundary vertices at the very same position: a mesh that is not welded.
fn duplicates(mesh: MeshView<'_>, chains: &[loops::Chain]) -> Vec<[u32; 2]> {
    let mut rim: Vec<([u64; 3], u32)> = chains
        .iter()
        .flat_map(|c| &c.shape.vertices)
        .map(|&v| (mesh.vertices.get(v as usize).map(|x| (x + 0.0).to_bits()), v))
        .collect();
    rim.sort_unstable();
    rim.dedup();
    rim.windows(2).filter(|w| w[0].0 == w[1].0).map(|w| [w[0].1, w[1].1]).collect()
}

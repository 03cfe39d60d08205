//! Exact tests: which faces of a fill meet each other or the rest of the mesh.
//!
//! A tree finds the pairs whose boxes overlap, [`triangles_intersect`] decides each. No tolerance
//! anywhere: a pair is reported if and only if it intersects at the positions as stored.

pub(crate) mod boxes;
mod bvh;
mod parts;
pub mod predicates;
mod triangle;

#[cfg(test)]
mod tests;

pub use boxes::Aabb;
pub use bvh::{closest_point_on_triangle, Bvh, ClosestPoint};
pub use parts::Soup;
pub use triangle::{triangles_intersect, Triangle};

use glam::DVec3;

/// All pairs of faces that intersect, of which at least one belongs to the fill.
///
/// `faces[..fill_start]` are the known faces near the fill, `faces[fill_start..]` the fill; what
/// counts as an intersection is said at [`triangles_intersect`]. Pairs of known faces are not
/// looked at. A pair is (fill face, other face) as indices into `faces`; of two fill faces the
/// smaller comes first. The list is sorted, without repetition.
///
/// Vertex indices must be below `positions.len()`, coordinates finite.
pub fn find_intersections(
    positions: &[DVec3],
    faces: &[[u32; 3]],
    fill_start: usize,
) -> Vec<[u32; 2]> {
    let mut pairs = Vec::new();
    indexed(positions, faces).any_intersection(fill_start, &mut |pair| {
        pairs.push(pair);
        false
    });
    pairs.sort_unstable();
    pairs
}

/// Whether [`find_intersections`] would find nothing; stops at the first pair.
pub fn is_intersection_free(positions: &[DVec3], faces: &[[u32; 3]], fill_start: usize) -> bool {
    !indexed(positions, faces).any_intersection(fill_start, &mut |_| true)
}

/// The faces of `faces[from..]` with (nearly) no area, ascending.
///
/// No area: height over longest edge at most 1e-12, or a coordinate that is not finite. Vertex
/// indices must be below `positions.len()`.
pub fn degenerate_faces(positions: &[DVec3], faces: &[[u32; 3]], from: usize) -> Vec<u32> {
    indexed(positions, faces).degenerate_faces(from)
}

fn indexed<'a>(
    positions: &'a [DVec3],
    faces: &'a [[u32; 3]],
) -> Soup<impl Fn(usize) -> Triangle + 'a> {
    Soup { count: faces.len(), corners: |f: usize| faces[f].map(|v| positions[v as usize]) }
}

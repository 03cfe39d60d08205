//! Exact tests: which faces of a fill meet each other or the rest of the mesh.
//!
//! A tree finds the pairs whose boxes overlap, [`triangles_intersect`] decides each. No tolerance
//! anywhere: a pair is reported if and only if it intersects at the positions as stored.

mod bvh;
pub mod predicates;
mod triangle;

#[cfg(test)]
mod tests;

pub use bvh::{closest_point_on_triangle, Aabb, Bvh, ClosestPoint};
pub use triangle::{triangles_intersect, Triangle};

use glam::DVec3;

/// Height over longest edge at and below which a face counts as having no area.
///
/// Between the two roundings that matter: three corners on a line, once rounded to f32, give a
/// ratio of 0 or about 6e-8 (2^-24), so no face that f32 can tell from a line is condemned; the
/// cross product itself is off by about 4e-16 in f64, so no line is taken for a face.
const FLAT_RATIO: f64 = 1e-12;

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
    any_intersection(positions, faces, fill_start, |pair| {
        pairs.push(pair);
        false
    });
    pairs.sort_unstable();
    pairs
}

/// The faces of the fill that [`find_intersections`] would name, ascending, by their index in
/// `faces`; only some of them if there are more than `most`. A fill that meets everything has
/// millions of pairs: they are not kept.
pub fn faces_that_meet(
    positions: &[DVec3],
    faces: &[[u32; 3]],
    fill_start: usize,
    most: usize,
) -> Vec<u32> {
    let first = fill_start.min(faces.len());
    let mut meets = vec![false; faces.len() - first];
    let mut count = 0;
    any_intersection(positions, faces, fill_start, |pair| {
        for f in pair.into_iter().filter(|&f| f as usize >= first) {
            count += usize::from(!std::mem::replace(&mut meets[f as usize - first], true));
        }
        count > most
    });
    (first as u32..).zip(meets).filter(|x| x.1).map(|x| x.0).collect()
}

/// Whether [`find_intersections`] would find nothing; stops at the first pair.
pub fn is_intersection_free(positions: &[DVec3], faces: &[[u32; 3]], fill_start: usize) -> bool {
    !any_intersection(positions, faces, fill_start, |_| true)
}

/// Calls `found` for each pair until it returns true; whether it did.
fn any_intersection(
    positions: &[DVec3],
    faces: &[[u32; 3]],
    fill_start: usize,
    mut found: impl FnMut([u32; 2]) -> bool,
) -> bool {
    let corners = |f: usize| faces[f].map(|v| positions[v as usize]);
    let fill = fill_start.min(faces.len())..faces.len();
    let fill_box = fill.clone().fold(Aabb::EMPTY, |b, f| b.union(&Aabb::of(&corners(f))));
    let near_fill = (0..faces.len())
        .map(|f| (f as u32, corners(f)))
        .filter(|(f, t)| *f as usize >= fill_start || Aabb::of(t).overlaps(&fill_box));
    let tree = Bvh::from_triangles(near_fill);
    fill.into_iter().any(|f| {
        let t = corners(f);
        tree.any_overlapping(&Aabb::of(&t), |other, s| {
            let is_mine = (other as usize) < fill_start || other as usize > f;
            is_mine && triangles_intersect(&t, s) && found([f as u32, other])
        })
    })
}

/// The faces of `faces[from..]` with (nearly) no area, ascending.
///
/// No area: height over longest edge at most 1e-12, or a coordinate that is not finite. Vertex
/// indices must be below `positions.len()`.
pub fn degenerate_faces(positions: &[DVec3], faces: &[[u32; 3]], from: usize) -> Vec<u32> {
    let is_degenerate = |f: &[u32; 3]| {
        let [a, b, c] = f.map(|v| positions[v as usize]);
        let edges = [b - a, c - b, a - c];
        let longest = edges.iter().fold(0.0, |m: f64, e| m.max(e.length_squared()));
        // Twice the area is height times longest edge. Written so that NaN is degenerate.
        let has_area = edges[0].cross(edges[1]).length() > FLAT_RATIO * longest;
        !(has_area && longest.is_finite())
    };
    (from..faces.len()).filter(|&f| is_degenerate(&faces[f])).map(|f| f as u32).collect()
}

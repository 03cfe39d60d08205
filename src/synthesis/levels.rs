//! Harary, Tal and Grinspun (2014), "Context-based coherent surface completion", sec. 7: from the
//! object to its coarse copy and back.
//!
//! Differences from the paper:
//! - It simplifies the object with its hole and completes both; here the completed object is
//!   simplified, and a coarse vertex belongs to what most of the fine ones merged into it do. So
//!   both levels have the same completion to begin with.
//! - It projects the fine completion onto the coarse result. Here the fine vertices move as the
//!   nearest point of the coarse completion has moved: the error of the simplification itself,
//!   which would be a step at the rim, stays out.

use super::describe::Parts;
use crate::descriptor::prolong::barycentric;
use crate::descriptor::simplify::{simplify, Cost};
use crate::error::Result;
use crate::fill::patch::Patch;
use crate::intersect::Bvh;
use crate::matching::object::{Object, Target};
use crate::mesh::neighbourhood::NONE;
use crate::progress::Monitor;
use glam::DVec3;
use std::collections::HashMap;

/// Part of the vertices that the coarse copy has (sec. 7).
const COARSE_SHARE: f64 = 1.0 / 50.0;
/// But at least this many: the objects in the paper have 35 to 134 thousand vertices, and with
/// fewer a patch of 1 % of the area is no patch any more.
const LEAST_COARSE: usize = 1000;

/// The coarse copy of a completed object and the coarse vertex that each vertex was merged into.
pub fn coarsen(object: &Object, monitor: &Monitor) -> Result<(Parts, Vec<u32>)> {
    let count = ((COARSE_SHARE * object.positions.len() as f64) as usize).max(LEAST_COARSE);
    let coarse = simplify(&object.positions, &object.faces, count, Cost::Quadric, monitor)?;
    let hole_of_vertex =
        most_frequent(&coarse.parent, &object.hole_of_vertex, coarse.positions.len());
    let hole_of_face = coarse
        .faces
        .iter()
        .map(|f| f.iter().map(|&v| hole_of_vertex[v as usize]).find(|&h| h != NONE).unwrap_or(NONE))
        .collect();
    let (positions, faces) = (coarse.positions, coarse.faces);
    Ok((Parts { positions, faces, hole_of_face, hole_of_vertex }, coarse.parent))
}

/// For each of `count` parents the label that most of its children have; of equals the smallest.
fn most_frequent(parent: &[u32], label: &[u32], count: usize) -> Vec<u32> {
    let mut pairs: Vec<(u32, u32)> =
        parent.iter().copied().zip(label.iter().copied()).filter(|p| p.0 != NONE).collect();
    pairs.sort_unstable();
    let mut best = vec![(0, NONE); count];
    for same in pairs.chunk_by(|a, b| a == b) {
        let place = &mut best[same[0].0 as usize];
        if same.len() > place.0 {
            *place = (same.len(), same[0].1);
        }
    }
    best.into_iter().map(|b| b.1).collect()
}

/// The completion of one hole as an object has it, with the object vertex of each of its vertices;
/// `None` if it has no vertex of its own.
pub fn target_of(object: &Object, hole: u32) -> Option<(Target, Vec<u32>)> {
    let is_mine = |f: &usize| object.hole_of_face[*f] == hole;
    let faces: Vec<[u32; 3]> =
        (0..object.faces.len()).filter(is_mine).map(|f| object.faces[f]).collect();
    let mut vertices: Vec<u32> = faces.iter().flatten().copied().collect();
    let is_new = |v: &u32| object.hole_of_vertex[*v as usize] == hole;
    vertices.sort_unstable_by_key(|v| (is_new(v), *v));
    vertices.dedup();
    let rim_count = vertices.partition_point(|v| !is_new(v));
    if rim_count == vertices.len() {
        return None;
    }
    let number: HashMap<u32, u32> = vertices.iter().copied().zip(0..).collect();
    let patch = Patch::of_triangles(
        vertices.iter().map(|&v| object.positions[v as usize]).collect(),
        vec![object.mean_edge(); vertices.len()],
        rim_count,
        faces.iter().map(|f| f.map(|v| number[&v])).collect(),
    );
    Some((Target::new(hole, patch, &vertices, object), vertices))
}

/// Moves the new vertices of `fine` as the nearest points of `coarse` have moved since it was made.
pub fn follow(fine: &mut Target, coarse: &Target) {
    let tree = Bvh::new(&coarse.rest, &coarse.patch.triangles);
    for v in fine.new_vertices() {
        let p = fine.patch.positions[v];
        let Some(closest) = tree.closest_point(p, f64::INFINITY) else { return };
        let corners = coarse.patch.triangles[closest.face as usize].map(|c| c as usize);
        let weights = barycentric(closest.point, &corners.map(|c| coarse.rest[c]));
        let moved = |k: usize| coarse.patch.positions[corners[k]] - coarse.rest[corners[k]];
        fine.patch.positions[v] = p + (0..3).map(|k| weights[k] * moved(k)).sum::<DVec3>();
    }
    fine.rest = fine.patch.positions.clone();
}

/// At most `count` of the new vertices of a target, spread evenly: each the one farthest from all
/// before it, beginning with the first.
pub fn spread_centres(target: &Target, count: usize) -> Vec<usize> {
    let new: Vec<usize> = target.new_vertices().collect();
    if new.len() <= count {
        return new;
    }
    let p = |v: usize| target.patch.positions[v];
    let mut distance = vec![f64::INFINITY; new.len()];
    let (mut chosen, mut next) = (Vec::with_capacity(count), 0);
    while chosen.len() < count {
        chosen.push(new[next]);
        let middle = p(new[next]);
        for (d, &v) in distance.iter_mut().zip(&new) {
            *d = d.min(p(v).distance_squared(middle));
        }
        // Of equals the first.
        next = (0..new.len()).fold(0, |a, b| if distance[b] > distance[a] { b } else { a });
    }
    chosen
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::descriptor::curvature::tests::grid;
    use crate::matching::object::tests::bare_object;

    fn sheet(n: usize) -> Object {
        let at = |u: f64, v: f64| DVec3::new(u, v, 0.1 * u * u);
        let (positions, faces) = grid((n, n), (false, false), at);
        bare_object(positions, faces, |p| p.distance(DVec3::new(0.5, 0.5, 0.0)) < 0.3)
    }

    #[test]
    fn the_fine_completion_follows_the_coarse_one() {
        let (fine_object, coarse_object) = (sheet(60), sheet(15));
        let (mut fine, _) = target_of(&fine_object, 0).unwrap();
        let (mut coarse, _) = target_of(&coarse_object, 0).unwrap();
        let before = fine.patch.positions.clone();
        follow(&mut fine, &coarse);
        assert_eq!(fine.patch.positions, before);
        for v in coarse.new_vertices() {
            coarse.patch.positions[v].z += 1.0;
        }
        follow(&mut fine, &coarse);
        for v in fine.new_vertices() {
            let moved = fine.patch.positions[v] - before[v];
            let inside = before[v].truncate().distance(DVec3::splat(0.5).truncate()) < 0.12;
            assert!(moved.truncate().length() < 1e-12 && (-1e-9..=1.0 + 1e-9).contains(&moved.z));
            assert!(!inside || moved.z > 0.99, "{} moved {moved}", before[v]);
        }
    }

    #[test]
    fn a_coarse_vertex_belongs_where_most_of_its_children_do() {
        let parent = [0, 0, 0, 1, 1, NONE, 2];
        let label = [5, NONE, NONE, 5, 3, 9, 4];
        assert_eq!(most_frequent(&parent, &label, 4), vec![NONE, 3, 4, NONE]);
    }

    #[test]
    fn centres_are_spread_over_the_completion() {
        let object = sheet(60);
        let (target, _) = target_of(&object, 0).unwrap();
        assert_eq!(spread_centres(&target, 10_000).len(), target.new_vertices().len());
        let chosen = spread_centres(&target, 50);
        assert_eq!(chosen.len(), 50);
        let far = |v: usize| {
            let d = |w: &usize| target.patch.positions[*w].distance(target.patch.positions[v]);
            chosen.iter().map(d).fold(f64::INFINITY, f64::min)
        };
        // Fifty discs of this radius cover a disc of 0.3.
        assert!(target.new_vertices().all(|v| far(v) < 0.075));
    }
}

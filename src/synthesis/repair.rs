//! Harary, Tal and Grinspun (2014), "Context-based coherent surface completion", sec. 6, mesh
//! repair: after each small move long, skinny, large and small triangles are removed.
//!
//! Differences from the paper:
//! - The average edge is the one wanted at the place, carried in from the rim, not that of the
//!   whole: meshes need not be even.
//! - An edge is only flipped or collapsed where that leaves a manifold without faces turned over
//!   (`fill::refine`), and a triangle is collapsed by collapsing its shortest edge.

use crate::fill::patch::{next, previous, Patch};
use crate::fill::refine::{collapse_edges, flip_pass, Taken};
use crate::matching::object::{Target, Traits};
use crate::mesh::neighbourhood::NONE;

/// Edges longer than this times the average are split (sec. 6).
const LONG: f64 = 1.5;
/// Triangles of less area than this times the average are collapsed (sec. 6).
const SMALL: f64 = 0.01;
/// Edges opposite to an angle below this are collapsed, in degrees (sec. 6).
const THIN: f64 = 10.0;

/// One pass of flips, splits and collapses; the rim stays. `taken`: edges between rim vertices
/// that the input has already.
pub fn repair(target: &mut Target, taken: Taken<'_>) {
    flip_pass(&mut target.patch, taken);
    split_long(target);
    let least = SMALL * mean_area(&target.patch);
    collapse_edges(&mut target.patch, taken, |patch, t, k| {
        let across = patch.across[t as usize][k];
        is_thin(patch, t, k, least)
            || across != NONE && {
                let tri = patch.triangles[t as usize];
                let side = patch.side_across(across, t, tri[k], tri[next(k)]);
                is_thin(patch, across, side, least)
            }
    });
    compact(target);
}

fn mean_area(patch: &Patch) -> f64 {
    let sum: f64 = (0..patch.triangles.len()).map(|t| 0.5 * patch.area_normal(t).length()).sum();
    sum / patch.triangles.len().max(1) as f64
}

/// Whether side `k` of triangle `t` shall be collapsed for the sake of `t`.
fn is_thin(patch: &Patch, t: u32, k: usize, least_area: f64) -> bool {
    let p = patch.triangles[t as usize].map(|v| patch.p(v));
    let length = |k: usize| p[k].distance_squared(p[next(k)]);
    let (u, v) = (p[k] - p[previous(k)], p[next(k)] - p[previous(k)]);
    let is_shortest = length(k) <= length(next(k)) && length(k) <= length(previous(k));
    u.angle_between(v).to_degrees() < THIN
        || is_shortest && 0.5 * patch.area_normal(t as usize).length() < least_area
}

/// Splits edges that are too long, the longest first.
fn split_long(target: &mut Target) {
    let patch = &target.patch;
    let stretch = |patch: &Patch, t: u32, k: usize| {
        let tri = patch.triangles[t as usize];
        let (a, b) = (tri[k], tri[next(k)]);
        let wanted = 0.5 * (patch.sizes[a as usize] + patch.sizes[b as usize]);
        patch.p(a).distance(patch.p(b)) / wanted
    };
    let mut long: Vec<(f64, u32, usize)> = Vec::new();
    for t in 0..patch.triangles.len() as u32 {
        for k in 0..3 {
            let across = patch.across[t as usize][k];
            if patch.is_alive(t as usize) && across != NONE && t < across {
                let ratio = stretch(patch, t, k);
                if ratio > LONG {
                    long.push((ratio, t, k));
                }
            }
        }
    }
    long.sort_by(|x, y| y.0.total_cmp(&x.0).then((x.1, x.2).cmp(&(y.1, y.2))));
    for (ratio, t, k) in long {
        let patch = &mut target.patch;
        // An earlier split may have changed this triangle.
        if patch.across[t as usize][k] == NONE || stretch(patch, t, k) != ratio {
            continue;
        }
        let tri = patch.triangles[t as usize];
        let (a, b) = (tri[k] as usize, tri[next(k)] as usize);
        patch.split(t, k, patch.positions[a].midpoint(patch.positions[b]));
        target.traits.push(Traits::between(&target.traits[a], &target.traits[b]));
        target.rest.push(target.rest[a].midpoint(target.rest[b]));
        target.centre.push(NONE);
    }
}

/// Drops removed triangles and vertices. The number of a target patch whose centre is gone goes to
/// the nearest new vertex that has none.
fn compact(target: &mut Target) {
    let patch = &mut target.patch;
    let rim = patch.rim_count;
    let is_kept: Vec<bool> =
        (0..patch.positions.len()).map(|v| v < rim || patch.at[v] != NONE).collect();
    for v in (rim..is_kept.len()).filter(|&v| !is_kept[v]) {
        let lost = std::mem::replace(&mut target.centre[v], NONE);
        if lost != NONE {
            let distance = |w: &usize| patch.positions[*w].distance_squared(patch.positions[v]);
            let free = (rim..is_kept.len()).filter(|&w| is_kept[w] && target.centre[w] == NONE);
            if let Some(w) = free.min_by(|a, b| distance(a).total_cmp(&distance(b))) {
                target.centre[w] = lost;
            }
        }
    }
    let mut kept = is_kept.iter();
    target.traits.retain(|_| *kept.next().unwrap_or(&true));
    let mut kept = is_kept.iter();
    target.rest.retain(|_| *kept.next().unwrap_or(&true));
    let mut kept = is_kept.iter();
    target.centre.retain(|_| *kept.next().unwrap_or(&true));
    patch.compact();
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::descriptor::curvature::tests::grid;
    use crate::matching::object::tests::bare_object;
    use crate::synthesis::levels::target_of;
    use glam::DVec3;

    /// A sheet of unit edges with a completion in its middle.
    fn target() -> Target {
        let at = |u: f64, v: f64| DVec3::new(20.0 * u, 20.0 * v, 0.0);
        let (positions, faces) = grid((20, 20), (false, false), at);
        let object = bare_object(positions, faces, |p| p.distance(DVec3::new(9.5, 9.5, 0.0)) < 5.0);
        let mut target = target_of(&object, 0).unwrap().0;
        target.patch.sizes.fill(1.0);
        target
    }

    fn check(target: &Target, rim: &[DVec3]) {
        let patch = &target.patch;
        assert_eq!(&patch.positions[..patch.rim_count], rim);
        for count in [target.traits.len(), target.rest.len(), target.centre.len()] {
            assert_eq!(count, patch.positions.len());
        }
        // Every edge but the rim's has its two triangles.
        for (t, across) in patch.across.iter().enumerate() {
            for k in 0..3 {
                let ends = [patch.triangles[t][k], patch.triangles[t][next(k)]];
                assert!(across[k] != NONE || ends.iter().all(|&v| patch.is_rim(v)));
            }
        }
    }

    #[test]
    fn what_is_well_stays() {
        let mut target = target();
        let before = target.patch.positions.clone();
        repair(&mut target, &[]);
        assert_eq!(target.patch.positions, before);
    }

    #[test]
    fn long_edges_are_split_and_thin_triangles_collapsed() {
        let mut target = target();
        let rim = target.patch.positions[..target.patch.rim_count].to_vec();
        let count = target.patch.positions.len();
        target.patch.sizes.fill(0.5);
        target.centre[count - 1] = 7;
        repair(&mut target, &[]);
        assert!(target.patch.positions.len() > 2 * count);
        check(&target, &rim);
        // Half a thousandth apart: needles, which go again; the target patch stays with a vertex.
        target.patch.sizes.fill(1.0);
        let mut fan = Vec::new();
        let before = target.patch.positions.len();
        for v in (target.patch.rim_count..before).step_by(5) {
            target.patch.fan(v as u32, &mut fan);
            let (t, k) = fan[0];
            let w = target.patch.triangles[t as usize][next(k)];
            target.patch.positions[v] = target.patch.p(w).lerp(target.patch.positions[v], 1e-3);
        }
        repair(&mut target, &[]);
        assert!(target.patch.positions.len() < before);
        check(&target, &rim);
        assert_eq!(target.centre.iter().filter(|&&c| c == 7).count(), 1);
    }
}

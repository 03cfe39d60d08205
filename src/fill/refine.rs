//! Botsch and Kobbelt (2004), "A remeshing approach to multiresolution modeling": the fill's
//! triangles are brought to the wanted size and shape by splits, collapses, flips and relaxation.
//!
//! Differences from the paper:
//! - The size is a field, carried in from the rim, not one number.
//! - Flips aim at Delaunay triangles, not at valence six: cotangent weights stay positive.

use super::patch::{next, previous, Patch, NONE};
use glam::DVec3;

/// Edges longer than this times the wanted length are split (4/3 in the paper).
const SPLIT: f64 = 4.0 / 3.0;
/// Edges shorter than this times the wanted length are collapsed (4/5 in the paper; lower here,
/// since the rim's own edges are uneven and fixed).
const COLLAPSE: f64 = 0.6;
/// Flips passes at most; a pass without a flip ends them earlier.
const FLIP_PASSES: usize = 12;
/// Least cosine between the two faces after a flip (20°), unless it was worse before. A coarse
/// triangulation's folds are its shape: Delaunay flips across them turn a ridge into a pit.
const FLIP_BEND: f64 = 0.94;
/// New vertices of one hole at most: 2³¹ indices are shared by all; beyond this the wanted length
/// is surely a mistake.
const MOST_VERTICES: usize = 40_000_000;

/// Edges that the fill must not have, since the input has them already: pairs (smaller, larger)
/// of rim vertices, sorted.
pub type Taken<'a> = &'a [(u32, u32)];

/// Brings the patch to its sizes by up to `rounds` of all passes, then compacts it. False if the
/// sizes ask for more vertices than can be had.
pub fn refine(patch: &mut Patch, taken: Taken<'_>, rounds: usize) -> bool {
    for round in 0..rounds {
        let changed = split_long(patch);
        flip_to_delaunay(patch, taken);
        if patch.positions.len() > MOST_VERTICES {
            return false;
        }
        let collapsed = collapse_short(patch, taken);
        if collapsed {
            flip_to_delaunay(patch, taken);
        }
        relax_positions(patch, if round == 0 { 6 } else { 3 });
        if round > 0 && !changed && !collapsed {
            break;
        }
    }
    flip_to_delaunay(patch, taken);
    split_taken(patch, taken);
    patch.compact();
    true
}

fn wanted(patch: &Patch, a: u32, b: u32) -> f64 {
    0.5 * (patch.sizes[a as usize] + patch.sizes[b as usize])
}

/// Splits every edge that is too long, the longest (relative to its wanted length) first.
fn split_long(patch: &mut Patch) -> bool {
    let mut any = false;
    // Each pass halves; long edges across a coarse triangulation need several.
    for _ in 0..32 {
        let mut long: Vec<(f64, u32, usize)> = Vec::new();
        for t in 0..patch.triangles.len() {
            if !patch.is_alive(t) {
                continue;
            }
            for k in 0..3 {
                let n = patch.across[t][k];
                if n != NONE && (t as u32) < n {
                    let ratio = stretch(patch, t as u32, k);
                    if ratio > SPLIT {
                        long.push((ratio, t as u32, k));
                    }
                }
            }
        }
        if long.is_empty() || patch.positions.len() > MOST_VERTICES {
            return any;
        }
        any = true;
        long.sort_by(|x, y| y.0.total_cmp(&x.0).then((x.1, x.2).cmp(&(y.1, y.2))));
        for (ratio, t, k) in long {
            // An earlier split may have changed this triangle.
            if stretch(patch, t, k) == ratio && patch.across[t as usize][k] != NONE {
                let tri = patch.triangles[t as usize];
                let middle = 0.5 * (patch.p(tri[k]) + patch.p(tri[next(k)]));
                patch.split(t, k, middle);
            }
        }
        flip_pass(patch, &[]);
    }
    any
}

fn stretch(patch: &Patch, t: u32, k: usize) -> f64 {
    let tri = patch.triangles[t as usize];
    let (a, b) = (tri[k], tri[next(k)]);
    patch.p(a).distance(patch.p(b)) / wanted(patch, a, b)
}

fn flip_to_delaunay(patch: &mut Patch, taken: Taken<'_>) {
    for _ in 0..FLIP_PASSES {
        if !flip_pass(patch, taken) {
            return;
        }
    }
}

/// One pass of flips towards Delaunay triangles; whether there was one.
pub fn flip_pass(patch: &mut Patch, taken: Taken<'_>) -> bool {
    let mut any = false;
    let mut fan = Vec::new();
    for t in 0..patch.triangles.len() as u32 {
        if !patch.is_alive(t as usize) {
            continue;
        }
        for k in 0..3 {
            let n = patch.across[t as usize][k];
            if n != NONE && t < n && should_flip(patch, t, k, taken, &mut fan) {
                patch.flip(t, k);
                any = true;
                break;
            }
        }
    }
    any
}

fn should_flip(
    patch: &Patch,
    t: u32,
    k: usize,
    taken: Taken<'_>,
    fan: &mut Vec<(u32, usize)>,
) -> bool {
    let tri = patch.triangles[t as usize];
    let (a, b, c) = (tri[k], tri[next(k)], tri[previous(k)]);
    let n = patch.across[t as usize][k];
    let j = patch.side_across(n, t, a, b);
    let d = patch.triangles[n as usize][previous(j)];
    if c == d {
        return false;
    }
    let [pa, pb, pc, pd] = [a, b, c, d].map(|v| patch.p(v));
    // cot + cot < 0: the opposite angles sum to more than π. Both cotangents share a scale below.
    let (u, v) = ((pa - pc), (pb - pc));
    let (w, x) = ((pa - pd), (pb - pd));
    let (s1, s2) = (u.cross(v).length(), w.cross(x).length());
    if u.dot(v) * s2 + w.dot(x) * s1 >= -1e-9 * s1 * s2 {
        return false;
    }
    let bend = |m: DVec3, n: DVec3| m.normalize_or_zero().dot(n.normalize_or_zero());
    let before = bend((pb - pa).cross(pc - pa), (pa - pb).cross(pd - pb));
    let after = bend((pd - pa).cross(pc - pa), (pb - pd).cross(pc - pd));
    if after < FLIP_BEND && after <= before {
        return false;
    }
    let pair = (c.min(d), c.max(d));
    taken.binary_search(&pair).is_err() && !patch.joined(c, d, fan)
}

/// Collapses edges that are too short.
fn collapse_short(patch: &mut Patch, taken: Taken<'_>) -> bool {
    collapse_edges(patch, taken, |patch, t, k| stretch(patch, t, k) < COLLAPSE)
}

/// Collapses the edges (side k of triangle t) that shall go, one end of which is new, where that
/// leaves a manifold without overlong edges or faces turned over; whether there was one.
pub fn collapse_edges(
    patch: &mut Patch,
    taken: Taken<'_>,
    shall_go: impl Fn(&Patch, u32, usize) -> bool,
) -> bool {
    let mut any = false;
    let (mut fan, mut other) = (Vec::new(), Vec::new());
    for t in 0..patch.triangles.len() as u32 {
        for k in 0..3 {
            if !patch.is_alive(t as usize) {
                break;
            }
            let tri = patch.triangles[t as usize];
            let (u, v) = (tri[k], tri[next(k)]);
            if patch.is_rim(u) || patch.across[t as usize][k] == NONE || !shall_go(patch, t, k) {
                continue;
            }
            if can_collapse(patch, u, v, taken, &mut fan, &mut other) {
                patch.collapse(t, k, &mut fan);
                any = true;
            }
        }
    }
    any
}

/// The link condition, no forbidden edge, no overlong edge, no face turned over.
fn can_collapse(
    patch: &Patch,
    u: u32,
    v: u32,
    taken: Taken<'_>,
    fan: &mut Vec<(u32, usize)>,
    other: &mut Vec<(u32, usize)>,
) -> bool {
    patch.fan(u, fan);
    patch.fan(v, other);
    if fan.len() < 4 {
        return false;
    }
    let around = |f: &[(u32, usize)], w: u32| {
        f.iter().any(|&(t, k)| {
            let tri = patch.triangles[t as usize];
            tri[next(k)] == w || tri[previous(k)] == w
        })
    };
    let target = patch.p(v);
    let mut common = 0;
    for &(t, k) in fan.iter() {
        let tri = patch.triangles[t as usize];
        let (b, c) = (tri[next(k)], tri[previous(k)]);
        // An open fan of v lists its last vertex only as the end of a side.
        if b != v && around(other, b) {
            common += 1;
        } else if b != v
            && (target.distance(patch.p(b)) > SPLIT * wanted(patch, v, b)
                || taken.binary_search(&(v.min(b), v.max(b))).is_ok())
        {
            return false;
        }
        if b != v && c != v {
            let (pb, pc) = (patch.p(b), patch.p(c));
            let old = (pb - patch.p(u)).cross(pc - patch.p(u));
            let new = (pb - target).cross(pc - target);
            if old.dot(new) <= 0.2 * old.length() * new.length() {
                return false;
            }
        }
    }
    common == 2
}

/// Half the way to the average of the neighbours, in the tangent plane.
fn relax_positions(patch: &mut Patch, sweeps: usize) {
    let mut fan = Vec::new();
    for _ in 0..sweeps {
        for v in patch.rim_count as u32..patch.positions.len() as u32 {
            if patch.at[v as usize] == NONE {
                continue;
            }
            patch.fan(v, &mut fan);
            let (mut sum, mut normal) = (DVec3::ZERO, DVec3::ZERO);
            for &(t, k) in &fan {
                sum += patch.p(patch.triangles[t as usize][next(k)]);
                normal += patch.area_normal(t as usize);
            }
            let step = sum / fan.len() as f64 - patch.p(v);
            let n = normal.normalize_or_zero();
            patch.positions[v as usize] += 0.5 * (step - n * n.dot(step));
        }
    }
}

/// Splits edges that the input has already, or that two different edges of the patch share: after
/// this each pair of vertices has at most one edge.
pub fn split_taken(patch: &mut Patch, taken: Taken<'_>) {
    // A split makes no new edge between old vertices, so one round suffices; the doubles among
    // the fill's own edges are found by sorting.
    let mut edges: Vec<(u32, u32, u32, usize)> = Vec::new();
    for t in 0..patch.triangles.len() {
        for k in 0..3 {
            let n = patch.across[t][k];
            if patch.is_alive(t) && n != NONE && (t as u32) < n {
                let (a, b) = (patch.triangles[t][k], patch.triangles[t][next(k)]);
                edges.push((a.min(b), a.max(b), t as u32, k));
            }
        }
    }
    edges.sort_unstable();
    let mut bad: Vec<(u32, u32)> = Vec::new();
    for same in edges.chunk_by(|x, y| (x.0, x.1) == (y.0, y.1)) {
        let pair = (same[0].0, same[0].1);
        if same.len() > 1 || taken.binary_search(&pair).is_ok() {
            bad.extend(same.iter().map(|e| (e.2, e.3 as u32)));
        }
    }
    let ends: Vec<(u32, u32)> = bad
        .iter()
        .map(|&(t, k)| {
            let tri = patch.triangles[t as usize];
            (tri[k as usize], tri[next(k as usize)])
        })
        .collect();
    let mut fan = Vec::new();
    for (a, b) in ends {
        // The triangle may have been cut by an earlier split: one of its parts keeps the edge.
        patch.fan(a, &mut fan);
        let found = fan.iter().copied().find(|&(s, k)| {
            let tri = patch.triangles[s as usize];
            tri[next(k)] == b && patch.across[s as usize][k] != NONE
        });
        if let Some((s, k)) = found {
            let middle = 0.5 * (patch.p(a) + patch.p(b));
            patch.split(s, k, middle);
        }
    }
}

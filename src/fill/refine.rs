//! Botsch and Kobbelt (2004), "A remeshing approach to multiresolution modeling": the fill's
//! triangles are brought to the wanted size and shape by splits, collapses, flips and relaxation.
//!
//! Differences from the paper:
//! - The size is a field, carried in from the rim, not one number.
//! - Flips aim at Delaunay triangles, not at valence six: cotangent weights stay positive.

use super::patch::{next, previous, Patch, NONE};
use crate::error::Result;
use crate::progress::Pace;
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
/// Removed vertices are dropped between two rounds when there is more than one for so many: less is not
/// worth the pass.
const MOST_GONE: usize = 8;
/// New vertices of one hole at most: 2³¹ indices are shared by all; beyond this the wanted length
/// is surely a mistake.
const MOST_VERTICES: usize = 40_000_000;

/// Edges that the fill must not have, since the input has them already: pairs (smaller, larger)
/// of rim vertices, sorted.
pub type Taken<'a> = &'a [(u32, u32)];

/// Brings the patch to its sizes by up to `rounds` of all passes, then compacts it. False if the
/// sizes ask for more vertices than can be had. Asks `pace` on the way.
pub fn refine(
    patch: &mut Patch,
    taken: Taken<'_>,
    rounds: usize,
    pace: &mut Pace<'_>,
) -> Result<bool> {
    let mut looks = Looks::default();
    for round in 0..rounds {
        // What is gone keeps its place in all arrays, and more is gone each round.
        if round > 0 && patch.gone() * MOST_GONE > patch.positions.len() {
            patch.compact();
        }
        let changed = split_long(patch, &mut looks, pace)?;
        flip_to_delaunay(patch, taken, &mut looks, pace)?;
        if patch.positions.len() > MOST_VERTICES {
            return Ok(false);
        }
        let collapsed = collapse_short(patch, taken, &mut looks, pace)?;
        if collapsed {
            flip_to_delaunay(patch, taken, &mut looks, pace)?;
        }
        relax_positions(patch, if round == 0 { 6 } else { 3 }, pace)?;
        looks = Looks::default();
        if round > 0 && !changed && !collapsed {
            break;
        }
    }
    flip_to_delaunay(patch, taken, &mut looks, pace)?;
    split_taken(patch, taken);
    patch.compact();
    Ok(true)
}

/// When each triangle was last changed and last looked at for flips, by a clock that counts changes:
/// most passes change little, and what neither side of an edge has seen change need not be looked
/// at again.
#[derive(Default)]
struct Looks {
    changed: Vec<u32>,
    seen: Vec<u32>,
    clock: u32,
}

impl Looks {
    /// Counts triangles that are new as changed.
    fn grow(&mut self, patch: &Patch) {
        if self.changed.len() < patch.triangles.len() {
            self.clock += 1;
            self.changed.resize(patch.triangles.len(), self.clock);
            self.seen.resize(patch.triangles.len(), 0);
        }
    }
    fn reserve(&mut self, triangles: usize) {
        self.changed.reserve_exact(triangles);
        self.seen.reserve_exact(triangles);
    }
    fn change(&mut self, triangles: impl IntoIterator<Item = u32>) {
        self.clock += 1;
        for t in triangles {
            self.changed[t as usize] = self.clock;
        }
    }
}

fn wanted(patch: &Patch, a: u32, b: u32) -> f64 {
    0.5 * (patch.sizes[a as usize] + patch.sizes[b as usize])
}

/// Splits every edge that is too long, the longest (relative to its wanted length) first.
fn split_long(patch: &mut Patch, looks: &mut Looks, pace: &mut Pace<'_>) -> Result<bool> {
    let mut any = split_lone(patch);
    let mut since = 0;
    // Each pass halves; long edges across a coarse triangulation need several.
    for _ in 0..32 {
        let mut long: Vec<(f64, u32, usize)> = Vec::new();
        looks.grow(patch);
        let is_fresh = |t: u32| looks.changed[t as usize] > since;
        for t in 0..patch.triangles.len() as u32 {
            if !is_fresh(t) || !patch.is_alive(t as usize) {
                continue;
            }
            for k in 0..3 {
                let n = patch.across[t as usize][k];
                if n == NONE || n < t && is_fresh(n) || !is_stretched(patch, t, k, SPLIT) {
                    continue;
                }
                let ratio = stretch(patch, t, k);
                if t < n {
                    long.push((ratio, t, k));
                } else {
                    let tri = patch.triangles[t as usize];
                    long.push((ratio, n, patch.side_across(n, t, tri[k], tri[next(k)])));
                }
            }
        }
        since = looks.clock;
        pace.work(4 * patch.triangles.len())?;
        if long.is_empty() || patch.positions.len() > MOST_VERTICES {
            return Ok(any);
        }
        any = true;
        long.sort_unstable_by(|x, y| y.0.total_cmp(&x.0).then((x.1, x.2).cmp(&(y.1, y.2))));
        patch.reserve(long.len());
        looks.reserve(2 * long.len());
        for (ratio, t, k) in long {
            // An earlier split may have changed this triangle.
            let n = patch.across[t as usize][k];
            if n != NONE && stretch(patch, t, k) == ratio {
                let tri = patch.triangles[t as usize];
                let middle = 0.5 * (patch.p(tri[k]) + patch.p(tri[next(k)]));
                patch.split(t, k, middle);
                looks.change([t, n]);
                looks.grow(patch);
            }
        }
        flip_fresh(patch, &[], looks, pace)?;
    }
    Ok(any)
}

/// A rim of three edges has one triangle and no edge to split: if it is too large it gets a vertex in
/// the middle.
fn split_lone(patch: &mut Patch) -> bool {
    let is_lone = patch.triangles.len() == 1 && patch.across[0] == [NONE; 3];
    let is_large = is_lone && (0..3).any(|k| is_stretched(patch, 0, k, SPLIT));
    if is_large {
        let [a, b, c] = patch.triangles[0].map(|v| patch.p(v));
        patch.insert(0, (a + b + c) / 3.0);
    }
    is_large
}

/// Length of an edge in wanted ones.
pub fn stretch(patch: &Patch, t: u32, k: usize) -> f64 {
    let tri = patch.triangles[t as usize];
    let (a, b) = (tri[k], tri[next(k)]);
    patch.p(a).distance(patch.p(b)) / wanted(patch, a, b)
}

/// Whether an edge is longer than `limit` wanted lengths.
fn is_stretched(patch: &Patch, t: u32, k: usize, limit: f64) -> bool {
    let tri = patch.triangles[t as usize];
    let (a, b) = (tri[k], tri[next(k)]);
    patch.p(a).distance_squared(patch.p(b)) > (limit * wanted(patch, a, b)).powi(2)
}

fn flip_to_delaunay(
    patch: &mut Patch,
    taken: Taken<'_>,
    looks: &mut Looks,
    pace: &mut Pace<'_>,
) -> Result<()> {
    for _ in 0..FLIP_PASSES {
        if !flip_fresh(patch, taken, looks, pace)? {
            break;
        }
    }
    Ok(())
}

/// One pass of flips towards Delaunay triangles; whether there was one.
pub fn flip_pass(patch: &mut Patch, taken: Taken<'_>) -> bool {
    let never = || Ok(());
    flip_fresh(patch, taken, &mut Looks::default(), &mut Pace::new(&never)).unwrap_or(false)
}

fn flip_fresh(
    patch: &mut Patch,
    taken: Taken<'_>,
    looks: &mut Looks,
    pace: &mut Pace<'_>,
) -> Result<bool> {
    let mut any = false;
    let mut fan = Vec::new();
    looks.grow(patch);
    for t in 0..patch.triangles.len() as u32 {
        let last = std::mem::replace(&mut looks.seen[t as usize], looks.clock);
        if !patch.is_alive(t as usize) {
            continue;
        }
        let is_changed = looks.changed[t as usize] > last;
        for k in 0..3 {
            let n = patch.across[t as usize][k];
            if n == NONE || t > n || !is_changed && looks.changed[n as usize] <= last {
                continue;
            }
            match flip_wish(patch, t, k, taken, &mut fan) {
                Wish::Stay => {}
                // What forbids it may go away without a change here.
                Wish::Forbidden => looks.seen[t as usize] = 0,
                Wish::Flip => {
                    patch.flip(t, k);
                    looks.change([t, n]);
                    looks.seen[t as usize] = 0;
                    any = true;
                    break;
                }
            }
        }
    }
    pace.work(4 * patch.triangles.len())?;
    Ok(any)
}

/// What is to be done with an edge.
enum Wish {
    Stay,
    Flip,
    /// It should be flipped, but its ends have an edge already.
    Forbidden,
}

fn flip_wish(
    patch: &Patch,
    t: u32,
    k: usize,
    taken: Taken<'_>,
    fan: &mut Vec<(u32, usize)>,
) -> Wish {
    let tri = patch.triangles[t as usize];
    let (a, b, c) = (tri[k], tri[next(k)], tri[previous(k)]);
    let n = patch.across[t as usize][k];
    let j = patch.side_across(n, t, a, b);
    let d = patch.triangles[n as usize][previous(j)];
    if c == d {
        return Wish::Stay;
    }
    let [pa, pb, pc, pd] = [a, b, c, d].map(|v| patch.p(v));
    // cot + cot < 0: the opposite angles sum to more than π. Both cotangents share a scale below.
    let (u, v) = ((pa - pc), (pb - pc));
    let (w, x) = ((pa - pd), (pb - pd));
    let (cos1, cos2) = (u.dot(v), w.dot(x));
    if cos1 >= 0.0 && cos2 >= 0.0 {
        return Wish::Stay;
    }
    let (s1, s2) = (u.cross(v).length(), w.cross(x).length());
    if cos1 * s2 + cos2 * s1 >= -1e-9 * s1 * s2 {
        return Wish::Stay;
    }
    let bend = |m: DVec3, n: DVec3| m.normalize_or_zero().dot(n.normalize_or_zero());
    let before = bend((pb - pa).cross(pc - pa), (pa - pb).cross(pd - pb));
    let after = bend((pd - pa).cross(pc - pa), (pb - pd).cross(pc - pd));
    if after < FLIP_BEND && after <= before {
        return Wish::Stay;
    }
    let pair = (c.min(d), c.max(d));
    if taken.binary_search(&pair).is_err() && !patch.joined(c, d, fan) {
        Wish::Flip
    } else {
        Wish::Forbidden
    }
}

/// Collapses edges that are too short, one end of which is new.
fn collapse_short(
    patch: &mut Patch,
    taken: Taken<'_>,
    looks: &mut Looks,
    pace: &mut Pace<'_>,
) -> Result<bool> {
    let any = collapse_where(patch, taken, looks, |p, t, k| !is_stretched(p, t, k, COLLAPSE));
    pace.work(4 * patch.triangles.len())?;
    Ok(any)
}

/// Collapses the edges (side k of triangle t) that shall go, one end of which is new, where that
/// leaves a manifold without overlong edges or faces turned over; whether there was one.
pub fn collapse_edges(
    patch: &mut Patch,
    taken: Taken<'_>,
    shall_go: impl Fn(&Patch, u32, usize) -> bool,
) -> bool {
    let mut looks = Looks::default();
    looks.grow(patch);
    collapse_where(patch, taken, &mut looks, shall_go)
}

fn collapse_where(
    patch: &mut Patch,
    taken: Taken<'_>,
    looks: &mut Looks,
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
                looks.change(fan.iter().map(|f| f.0));
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
fn relax_positions(patch: &mut Patch, sweeps: usize, pace: &mut Pace<'_>) -> Result<()> {
    let rim = patch.rim_count;
    // The side opposite each new vertex in each of its triangles, vertex by vertex.
    let mut start = vec![0u32; patch.positions.len() - rim + 1];
    let alive = || patch.triangles.iter().filter(|tri| tri[0] != NONE);
    for v in alive().flatten().filter(|&&v| v as usize >= rim) {
        start[*v as usize - rim + 1] += 1;
    }
    for v in 1..start.len() {
        start[v] += start[v - 1];
    }
    let mut next_place = start.clone();
    let mut sides = vec![(0, 0); start[start.len() - 1] as usize];
    for tri in alive() {
        for k in 0..3 {
            if let Some(v) = (tri[k] as usize).checked_sub(rim) {
                sides[next_place[v] as usize] = (tri[next(k)], tri[previous(k)]);
                next_place[v] += 1;
            }
        }
    }
    for _ in 0..sweeps {
        for (i, range) in start.windows(2).enumerate() {
            let around = &sides[range[0] as usize..range[1] as usize];
            if around.is_empty() {
                continue;
            }
            let p = patch.positions[rim + i];
            let (mut sum, mut normal) = (DVec3::ZERO, DVec3::ZERO);
            for &(b, c) in around {
                let b = patch.p(b) - p;
                sum += b;
                normal += b.cross(patch.p(c) - p);
            }
            let step = sum / around.len() as f64;
            let along =
                normal * (normal.dot(step) / normal.length_squared().max(f64::MIN_POSITIVE));
            patch.positions[rim + i] += 0.5 * (step - along);
        }
        pace.work(2 * sides.len())?;
    }
    Ok(())
}

/// Splits edges that the input has already, or that two different edges of the patch share: after
/// this each pair of vertices has at most one edge.
pub fn split_taken(patch: &mut Patch, taken: Taken<'_>) {
    // A split makes no new edge between old vertices, so one round suffices. Doubles come from the
    // triangulation alone, so both ends belong to the rim; they are found by sorting.
    let mut edges: Vec<(u32, u32, u32, usize)> = Vec::new();
    for t in 0..patch.triangles.len() {
        for k in 0..3 {
            let n = patch.across[t][k];
            if n == NONE || n < t as u32 || !patch.is_alive(t) {
                continue;
            }
            let (a, b) = (patch.triangles[t][k], patch.triangles[t][next(k)]);
            if patch.is_rim(a) && patch.is_rim(b) {
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

#[cfg(test)]
mod tests {
    use super::*;

    /// One triangle, in the plane z = 2, whose sides are `side` wanted lengths.
    fn refined(side: f64) -> Patch {
        let corner = |i: u32| {
            let (sin, cos) = (f64::from(i) * std::f64::consts::TAU / 3.0).sin_cos();
            DVec3::new(1.0 + cos, sin, 2.0)
        };
        let positions: Vec<DVec3> = (0..3).map(corner).collect();
        let wanted = positions[0].distance(positions[1]) / side;
        let mut patch = Patch::of_triangles(positions, vec![wanted; 3], 3, vec![[0, 1, 2]]);
        let never = || Ok(());
        assert!(refine(&mut patch, &[], 4, &mut Pace::new(&never)).unwrap());
        patch
    }

    /// It was never refined, having no edge that could be split.
    #[test]
    fn a_lone_triangle_is_refined() {
        assert_eq!(refined(1.2).positions.len(), 3);
        let one = refined(1.5);
        assert_eq!(one.positions.len(), 4);
        assert!(one.p(3).distance(DVec3::new(1.0, 0.0, 2.0)) < 1e-12, "{}", one.p(3));
        assert_eq!(one.triangles, [[0, 1, 3], [1, 2, 3], [2, 0, 3]]);

        // Sides much longer than that cannot be split, and pull what is near them out of shape.
        let many = refined(2.5);
        let area = |p: &Patch| {
            let all = 0..p.triangles.len();
            all.map(|t| p.area_normal(t).z).inspect(|z| assert!(*z > 0.0)).sum::<f64>()
        };
        assert!((area(&many) - 1.5 * 3f64.sqrt()).abs() < 1e-9);
        assert!(many.positions.iter().all(|p| p.z == 2.0));
        for t in 0..many.triangles.len() as u32 {
            for k in 0..3 {
                let inner = many.across[t as usize][k] != NONE;
                assert!(!inner || stretch(&many, t, k) < 1.5, "{}", stretch(&many, t, k));
            }
        }
    }
}

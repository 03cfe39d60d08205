//! From the triangles through the points to a mesh whose boundary loops are holes: cracks between
//! stars that did not agree are closed, triangles that hang on by a corner go, and so do specks.

use super::given::Ball;
use super::surface::{turn, Surface};
use crate::mesh::roots::Roots;
use glam::DVec3;
use std::collections::HashSet;

/// Rims of fewer points are never a hole. A hole of 13 points in a mesh has about 8 here: triangles
/// that are not too large cut the corners of its rim.
pub const SMALLEST_RIM: usize = 8;
/// A gap is a hole if at least so many points are missing in it, counted by the larger triangles
/// around it, ...
const MISSING: f64 = 5.0;
/// ... and this many for each point of its rim. Both measured on meshes without their faces: chains
/// of cracks between uneven points have 0 to 0.2, holes from 0.36 on.
const MISSING_EACH: f64 = 0.3;
/// In a region that the caller gives a gap may be a hole if so much of a point is missing in it: one is 1, where
/// the points are even, and a crack has 0.
const MISSING_GIVEN: f64 = 0.75;
/// Longest rim that is triangulated to measure it; the time grows with the cube. Longer ones are
/// holes or borders.
const MEASURED: usize = 160;
/// Least cosine between a border's area and its normals, negated: see [`is_border`].
const AROUND: f64 = 0.3;

/// A boundary loop of the surface.
#[derive(Debug, Clone, PartialEq)]
pub struct Rim {
    /// Points in the order in which a filling face runs.
    pub points: Vec<u32>,
    /// What it goes round.
    pub kind: RimKind,
    /// How many points are missing inside, by the size of the triangles around it.
    pub missing: f64,
    /// Mean boundary probability of its points, once it is known.
    pub probability: f64,
    /// Whether the loops of [`super::spanning`] agree, once they are asked.
    pub in_loops: bool,
    /// Whether the distance field agrees, once it is asked and if it can say.
    pub in_field: Option<bool>,
}

/// What a rim goes round.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RimKind {
    /// A hole.
    Hole,
    /// The whole piece: the outer border of an open surface.
    Border,
    /// A gap that is too small or too thin for a hole, but lies in a region that the caller gives.
    Gap,
    /// A gap that is too small or too thin for a hole, and could not be closed.
    Crack,
}

/// Closes cracks, but for gaps in the regions that are given.
pub fn tidy(surface: &mut Surface<'_>, regions: &[Ball]) {
    drop_small_fans(surface);
    for _ in 0..3 {
        let closed = close_cracks(surface, regions);
        let fans = drop_small_fans(surface);
        if closed + fans == 0 {
            break;
        }
    }
    drop_specks(surface);
}

/// The rims of a surface, judged.
pub fn rims(surface: &Surface<'_>, regions: &[Ball]) -> Vec<Rim> {
    loops(surface).into_iter().map(|points| judge(surface, points, regions).0).collect()
}

/// Closes every loop that is no hole; returns how many were.
fn close_cracks(surface: &mut Surface<'_>, regions: &[Ball]) -> usize {
    let mut closed = 0;
    for points in loops(surface) {
        let (rim, triangles) = judge(surface, points, regions);
        if rim.kind != RimKind::Crack || triangles.is_empty() {
            continue;
        }
        closed += 1;
        triangles.into_iter().for_each(|t| surface.add(t));
    }
    closed
}

/// What a loop goes round, and the triangles that close it (none if it is long, or none fit).
fn judge(surface: &Surface<'_>, points: Vec<u32>, regions: &[Ball]) -> (Rim, Vec<[u32; 3]>) {
    let count = points.len();
    let rim = |points, kind, missing| Rim {
        points,
        kind,
        missing,
        probability: 0.0,
        in_loops: false,
        in_field: None,
    };
    if count >= SMALLEST_RIM && is_border(surface, &points) {
        return (rim(points, RimKind::Border, 0.0), Vec::new());
    }
    let Measure { missing, surely, triangles } = measure(surface, &points);
    let least = MISSING.max(MISSING_EACH * count as f64);
    let asked = || missing >= MISSING_GIVEN && regions.iter().any(|r| r.has_all(surface, &points));
    let kind = match count >= SMALLEST_RIM && surely >= least {
        true => RimKind::Hole,
        false if asked() => RimKind::Gap,
        false => RimKind::Crack,
    };
    (rim(points, kind, missing), triangles)
}

/// What a loop goes round, measured.
pub struct Measure {
    /// How many points are missing, by the mean triangle around it, and by the larger ones.
    pub missing: f64,
    surely: f64,
    /// Triangles that close it; none if it is long, or none fit.
    triangles: Vec<[u32; 3]>,
}

/// Measures a loop.
pub fn measure(surface: &Surface<'_>, points: &[u32]) -> Measure {
    let count = points.len();
    let cover = if count <= MEASURED { cover(surface, points) } else { None };
    let (area, triangles) = match cover {
        Some((area, triangles)) => (area, triangles),
        None => (newell(surface, points).length(), Vec::new()),
    };
    let (mean, large) = areas(surface, points);
    let [missing, surely] = [mean, large].map(|each| inside(area, each, count));
    Measure { missing, surely, triangles }
}

/// Points inside a rim of so many points around an area that triangles of area `each` cover (Pick's
/// theorem on their lattice).
fn inside(area: f64, each: f64, rim: usize) -> f64 {
    area / (2.0 * each) - rim as f64 / 2.0 + 1.0
}

/// Area vector of a loop.
fn newell(surface: &Surface<'_>, points: &[u32]) -> DVec3 {
    let p = |i: usize| {
        surface.points[points[i % points.len()] as usize] - surface.points[points[0] as usize]
    };
    0.5 * (0..points.len()).map(|i| p(i).cross(p(i + 1))).sum::<DVec3>()
}

/// Whether a loop runs round the outside of an open surface: seen along the normals at its points it
/// runs the other way round than the rim of a hole. Where the rim lies athwart, as that of half a
/// ball, it is a hole.
fn is_border(surface: &Surface<'_>, points: &[u32]) -> bool {
    let normal: DVec3 = points.iter().map(|&v| surface.normals[v as usize]).sum();
    let mean = normal / points.len() as f64;
    newell(surface, points).normalize_or_zero().dot(mean) < -AROUND
}

/// Rings of points around a rim whose triangles say how large triangles are there.
const RINGS: usize = 3;

/// Areas of the triangles around a loop: their mean, and the one that nine in ten stay below.
fn areas(surface: &Surface<'_>, points: &[u32]) -> (f64, f64) {
    let (mut seen, mut areas) = (HashSet::new(), Vec::new());
    let mut rim: Vec<u32> = points.to_vec();
    for _ in 0..RINGS {
        let mut next = Vec::new();
        for &v in &rim {
            for (t, k) in surface.at(v) {
                if seen.insert(t) {
                    let [a, b, c] =
                        surface.triangles[t as usize].map(|v| surface.points[v as usize]);
                    areas.push(0.5 * (b - a).cross(c - a).length());
                    next.extend(surface.others((t, k)));
                }
            }
        }
        next.sort_unstable();
        next.dedup();
        rim = next;
    }
    if areas.is_empty() {
        return (f64::MIN_POSITIVE, f64::MIN_POSITIVE);
    }
    areas.sort_unstable_by(f64::total_cmp);
    let mean = areas.iter().sum::<f64>() / areas.len() as f64;
    (mean.max(f64::MIN_POSITIVE), areas[areas.len() * 9 / 10].max(f64::MIN_POSITIVE))
}

/// The boundary loops, each from its smallest point on, in ascending order.
pub fn loops(surface: &Surface<'_>) -> Vec<Vec<u32>> {
    // Where the loop goes on: for each point, from which point it comes and to which it goes.
    let mut steps: Vec<(u32, u32, u32)> = Vec::new();
    let mut sectors = Vec::new();
    for v in 0..surface.points.len() as u32 {
        sectors.clear();
        sectors.extend(surface.at(v).map(|s| surface.others(s)));
        let open: Vec<u32> =
            sectors.iter().filter(|s| sectors.iter().all(|o| o[1] != s[0])).map(|s| s[0]).collect();
        for start in &open {
            // The fan that ends just before this one starts, turning clockwise over the gap.
            let ends =
                sectors.iter().filter(|s| sectors.iter().all(|o| o[0] != s[1])).map(|s| s[1]);
            let from = if open.len() > 1 { surface.angle(v, *start) } else { 0.0 };
            let back = |&e: &u32| {
                if open.len() > 1 {
                    turn(from - surface.angle(v, e))
                } else {
                    0.0
                }
            };
            if let Some(end) = ends.min_by(|a, b| back(a).total_cmp(&back(b))) {
                steps.push((v, *start, end));
            }
        }
    }
    // Sorted by point: the steps are made in that order.
    let at = |v: u32, from: u32| {
        let first = steps.partition_point(|s| s.0 < v);
        (first..steps.len()).take_while(|&i| steps[i].0 == v).find(|&i| steps[i].1 == from)
    };
    let mut used = vec![false; steps.len()];
    let mut all = Vec::new();
    for first in 0..steps.len() {
        let (mut chain, mut here) = (Vec::new(), first);
        while !used[here] {
            used[here] = true;
            let (v, _, to) = steps[here];
            chain.push(v);
            match at(to, v) {
                Some(next) => here = next,
                None => break,
            }
        }
        if chain.len() >= 3 {
            all.push(chain);
        }
    }
    all
}

/// Fewest area triangulation of a loop that uses no edge that the surface has: its area and its
/// triangles. `None` if there is none, or the loop meets itself.
fn cover(surface: &Surface<'_>, points: &[u32]) -> Option<(f64, Vec<[u32; 3]>)> {
    let n = points.len();
    let mut sorted = points.to_vec();
    sorted.sort_unstable();
    if sorted.windows(2).any(|w| w[0] == w[1]) {
        return None;
    }
    let p = |i: usize| surface.points[points[i] as usize];
    let mut free = vec![true; n * n];
    for (i, &v) in points.iter().enumerate() {
        for s in surface.at(v) {
            for other in surface.others(s) {
                if let Some(j) = points.iter().position(|&w| w == other) {
                    free[i * n + j] = false;
                    free[j * n + i] = false;
                }
            }
        }
    }
    for i in 0..n {
        let j = (i + 1) % n;
        free[i * n + j] = true;
        free[j * n + i] = true;
    }
    let (mut best, mut apex) = (vec![0.0; n * n], vec![0; n * n]);
    for span in 2..n {
        for i in 0..n - span {
            let j = i + span;
            best[i * n + j] = f64::INFINITY;
            if !free[i * n + j] {
                continue;
            }
            for k in i + 1..j {
                let area = 0.5 * (p(k) - p(i)).cross(p(j) - p(i)).length();
                let sum = best[i * n + k] + best[k * n + j] + area;
                if sum < best[i * n + j] {
                    best[i * n + j] = sum;
                    apex[i * n + j] = k;
                }
            }
        }
    }
    let area = best[n - 1];
    if !area.is_finite() {
        return None;
    }
    let (mut triangles, mut todo) = (Vec::new(), vec![(0, n - 1)]);
    while let Some((i, j)) = todo.pop() {
        if j > i + 1 {
            let k = apex[i * n + j];
            triangles.push([points[i], points[k], points[j]]);
            todo.extend([(i, k), (k, j)]);
        }
    }
    Some((area, triangles))
}

/// Where several fans meet in one point only the largest stays, or loops would touch there. Returns
/// how many points that was at.
fn drop_small_fans(surface: &mut Surface<'_>) -> usize {
    let mut count = 0;
    for v in 0..surface.points.len() as u32 {
        let mut fans = fans(surface, v);
        if fans.len() < 2 {
            continue;
        }
        count += 1;
        fans.sort_by_key(|f| std::cmp::Reverse((f.len(), f[0])));
        for &t in fans[1..].iter().flatten() {
            surface.dropped[t as usize] = true;
        }
    }
    count
}

/// The triangles at a point, those that are joined by edges together.
pub fn fans(surface: &Surface<'_>, v: u32) -> Vec<Vec<u32>> {
    let mut left: Vec<(u32, [u32; 2])> = surface.at(v).map(|s| (s.0, surface.others(s))).collect();
    let mut fans = Vec::new();
    while let Some(first) = left.pop() {
        let (mut fan, mut ends) = (vec![first.0], first.1);
        while let Some(i) = left.iter().position(|(_, o)| o[0] == ends[1] || o[1] == ends[0]) {
            let (t, o) = left.remove(i);
            fan.push(t);
            if o[0] == ends[1] {
                ends[1] = o[1]
            } else {
                ends[0] = o[0]
            }
        }
        fan.sort_unstable();
        fans.push(fan);
    }
    fans
}

/// Pieces of fewer triangles are chance meetings of outliers; larger ones may be islands.
const SPECK: u32 = 12;

fn drop_specks(surface: &mut Surface<'_>) {
    let mut roots = Roots::new(surface.points.len());
    let alive = |s: &Surface<'_>, t: usize| !s.dropped[t];
    for t in (0..surface.triangles.len()).filter(|&t| alive(surface, t)) {
        let [a, b, c] = surface.triangles[t];
        roots.join(a, b);
        roots.join(b, c);
    }
    let mut sizes = vec![0u32; surface.points.len()];
    for t in (0..surface.triangles.len()).filter(|&t| alive(surface, t)) {
        sizes[roots.root(surface.triangles[t][0]) as usize] += 1;
    }
    for t in 0..surface.triangles.len() {
        if sizes[roots.root(surface.triangles[t][0]) as usize] < SPECK {
            surface.dropped[t] = true;
        }
    }
}

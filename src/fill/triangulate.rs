//! Liepa (2003), "Filling holes in meshes": minimum weight triangulation of the rim.
//!
//! Differences from the paper:
//! - The weight is a sum (area, squared edge lengths, dihedral angles), not the pair (largest
//!   dihedral angle, area): the largest angle says little on ragged rims.
//! - Not cubic in the rim. Chords are only tried between corners that are near each other, on a
//!   hierarchy of levels, level l holding every 2^l-th corner: O(n) chords. A triangulation
//!   always exists among them, since neighbours on each level are always tried.
//! - Several loops: the polygon runs over bridges ([`super::polygon`]), which are glued here.

use super::patch::{Patch, NONE};
use super::polygon::{Beyond, Polygon};
use crate::error::Result;
use crate::progress::Pace;
use glam::DVec3;
use std::collections::HashMap;

/// Nearest corners tried on each level: own choice; 6 misses chords across cracks, 16 changes
/// nothing more.
const NEAREST: usize = 10;
/// Neighbours along the polygon tried on each level.
const ALONG: usize = 4;
/// With how many corners or fewer all chords are tried.
#[derive(Debug, Clone, Copy)]
pub struct AllPairs {
    /// On the polygon itself.
    whole: usize,
    /// On the coarsest level of a hierarchy.
    coarsest: usize,
}

/// In the order in which they are worth trying. Full: the hierarchy misses the ridge across a
/// broken edge, and 300³/6 triangles take some 20 ms. Then sparse: fewer chords keep closer to the
/// rim, which helps where a wall lies close behind it. Last full again, for what takes up to a second:
/// around islands in a wide hole the hierarchy misses the chords from loop to loop.
pub const ALL_PAIRS: [AllPairs; 3] = [
    AllPairs { whole: 300, coarsest: 200 },
    AllPairs { whole: 64, coarsest: 64 },
    AllPairs { whole: 1000, coarsest: 200 },
];

impl AllPairs {
    /// Whether a polygon is small enough for all its chords.
    pub fn holds(self, polygon: &Polygon) -> bool {
        polygon.corners.len() <= self.whole
    }
}

/// Weight of squared edge lengths against area: breaks the ties of flat rims towards short edges.
const EDGE_WEIGHT: f64 = 0.02;
/// Weight of a right-angled fold, times its length and the hole's radius, against area. Measured
/// on broken edges and missing bands: with 0.3 a band is capped twice (least area), above 1
/// nothing more changes.
const FOLD_WEIGHT: f64 = 3.0;
/// How much more a fold costs that turns back over itself.
const FOLD_BACK: f64 = 4.0;

/// Triangulates a polygon over patch vertices; the result has no new vertices. `None` if no
/// triangulation was found (too few corners that differ). Asks `pace` on the way.
pub fn triangulate(
    positions: &[DVec3],
    sizes: &[f64],
    polygon: &Polygon,
    all_pairs: AllPairs,
    pace: &mut Pace<'_>,
) -> Result<Option<Patch>> {
    let n = polygon.corners.len();
    if n < 3 {
        return Ok(None);
    }
    let chords = Chords::new(positions, polygon, all_pairs);
    let triangles = Weights::minimise(positions, polygon, &chords, pace)?.triangles(&chords, n);
    Ok((triangles.len() == n - 2).then(|| build_patch(positions, sizes, polygon, &triangles)))
}

/// The chords (i, j), i < j, that may be used; rows sorted.
struct Chords {
    start: Vec<usize>,
    to: Vec<u32>,
}

impl Chords {
    fn new(positions: &[DVec3], polygon: &Polygon, all_pairs: AllPairs) -> Self {
        let n = polygon.corners.len();
        let point = |i: usize| positions[polygon.corners[i] as usize];
        let mut pairs: Vec<(u32, u32)> = Vec::new();
        let mut step = 1;
        loop {
            let mut level: Vec<usize> = (0..n).step_by(step).collect();
            if level.last() != Some(&(n - 1)) {
                level.push(n - 1);
            }
            let m = level.len();
            if m <= if step == 1 { all_pairs.whole } else { all_pairs.coarsest } {
                for a in 0..m {
                    pairs.extend((a + 1..m).map(|b| (level[a] as u32, level[b] as u32)));
                }
                break;
            }
            for a in 0..m {
                let along = (a + 1)..(a + 1 + ALONG).min(m);
                pairs.extend(along.map(|b| (level[a] as u32, level[b] as u32)));
            }
            let points: Vec<DVec3> = level.iter().map(|&i| point(i)).collect();
            nearest_pairs(&points, |a, b| {
                pairs.push((level[a.min(b)] as u32, level[a.max(b)] as u32));
            });
            step *= 2;
        }
        pairs.sort_unstable();
        pairs.dedup();
        // The two corners of a bridge's end are one vertex: no chord joins them.
        let same = |&(i, j): &(u32, u32)| {
            j == i + 1 || polygon.corners[i as usize] != polygon.corners[j as usize]
        };
        pairs.retain(same);
        let mut start = vec![0; n + 1];
        pairs.iter().for_each(|&(i, _)| start[i as usize + 1] += 1);
        for i in 0..n {
            start[i + 1] += start[i];
        }
        Self { start, to: pairs.into_iter().map(|(_, j)| j).collect() }
    }

    fn row(&self, i: usize) -> &[u32] {
        &self.to[self.start[i]..self.start[i + 1]]
    }

    fn find(&self, i: usize, j: u32) -> Option<usize> {
        self.row(i).binary_search(&j).ok().map(|k| self.start[i] + k)
    }
}

/// Calls `f` for each point and its nearest ones, by a sweep along x: a rim is a curve, so few
/// points share an x.
fn nearest_pairs(points: &[DVec3], mut f: impl FnMut(usize, usize)) {
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by(|&a, &b| points[a].x.total_cmp(&points[b].x).then(a.cmp(&b)));
    let mut best: Vec<(f64, usize)> = Vec::with_capacity(NEAREST + 1);
    for (place, &a) in order.iter().enumerate() {
        best.clear();
        let limit = |best: &[(f64, usize)]| match best.len() {
            NEAREST => best[NEAREST - 1].0,
            _ => f64::INFINITY,
        };
        let (mut left, mut right) = (place, place + 1);
        loop {
            let dx = |b: usize| (points[order[b]].x - points[a].x).powi(2);
            let l = if left > 0 { dx(left - 1) } else { f64::INFINITY };
            let r = if right < order.len() { dx(right) } else { f64::INFINITY };
            if l.min(r) >= limit(&best) {
                break;
            }
            let b = if l <= r {
                left -= 1;
                order[left]
            } else {
                right += 1;
                order[right - 1]
            };
            let d = (points[a].distance_squared(points[b]), b);
            let at = best.partition_point(|x| x.0 < d.0 || (x.0 == d.0 && x.1 < d.1));
            best.insert(at, d);
            best.truncate(NEAREST);
        }
        best.iter().for_each(|&(_, b)| f(a, b));
    }
}

/// The chords by their second corner, ascending by the first, filled from the end as the first
/// corners descend. Walking a column is what the time goes into, so each thing lies by itself.
struct Columns {
    start: Vec<usize>,
    corner: Vec<u32>,
    weight: Vec<f64>,
    chord: Vec<u32>,
    /// First filled place of each column.
    open: Vec<usize>,
}

impl Columns {
    fn new(chords: &Chords, n: usize) -> Self {
        let mut start = vec![0; n + 1];
        chords.to.iter().for_each(|&j| start[j as usize + 1] += 1);
        for j in 0..n {
            start[j + 1] += start[j];
        }
        let open = start[1..].to_vec();
        let m = chords.to.len();
        let (corner, weight, chord) = (vec![0; m], vec![f64::INFINITY; m], vec![0; m]);
        Self { start, corner, weight, chord, open }
    }
    fn filled(&self, j: u32) -> std::ops::Range<usize> {
        self.open[j as usize]..self.start[j as usize + 1]
    }
    fn put(&mut self, i: usize, j: u32, weight: f64, chord: usize) {
        self.open[j as usize] -= 1;
        let at = self.open[j as usize];
        self.corner[at] = i as u32;
        self.weight[at] = weight;
        self.chord[at] = chord as u32;
    }
}

/// The least weight of the part of the polygon behind each chord, and the corner that gives it.
struct Weights {
    apex: Vec<u32>,
}

impl Weights {
    fn minimise(
        positions: &[DVec3],
        polygon: &Polygon,
        chords: &Chords,
        pace: &mut Pace<'_>,
    ) -> Result<Self> {
        let n = polygon.corners.len();
        let point = |i: usize| positions[polygon.corners[i] as usize];
        let points: Vec<DVec3> = (0..n).map(point).collect();
        let around: f64 = (0..n).map(|i| points[i].distance(points[(i + 1) % n])).sum();
        let fold_scale = FOLD_WEIGHT * around / std::f64::consts::TAU;
        let fold = |n: DVec3, m: DVec3, length: f64| fold_scale * length * bend(n, m);
        let mut weight = vec![f64::INFINITY; chords.to.len()];
        let mut normal = vec![DVec3::ZERO; chords.to.len()];
        let mut apex = vec![NONE; chords.to.len()];
        let mut length = vec![0.0; chords.to.len()];
        let mut columns = Columns::new(chords, n);
        // The chords of row i by their second corner; infinite where there is none.
        let mut left_weight = vec![f64::INFINITY; n];
        let mut left_chord = vec![0u32; n];
        // Descending i, ascending j: the parts of a chord come before it.
        for i in (0..n).rev() {
            let row = chords.row(i);
            let base = chords.start[i];
            for (at, &j) in row.iter().enumerate() {
                let chord = base + at;
                left_chord[j as usize] = chord as u32;
                let (a, c) = (points[i], points[j as usize]);
                let chord2 = a.distance_squared(c);
                length[chord] = chord2.sqrt();
                if j as usize == i + 1 {
                    weight[chord] = 0.0;
                    if let Beyond::Face(face) = polygon.beyond[i] {
                        normal[chord] = face;
                    }
                    columns.put(i, j, 0.0, chord);
                    left_weight[j as usize] = 0.0;
                    continue;
                }
                let filled = columns.filled(j);
                let corners = &columns.corner[filled.clone()];
                let rights = &columns.weight[filled.clone()];
                let right_chords = &columns.chord[filled];
                let sum = |k: usize| left_weight[corners[k] as usize] + rights[k];
                // The apex with the cheapest parts first: its total rules most others out unseen.
                let (mut cheapest, mut least) = (usize::MAX, f64::INFINITY);
                for k in 0..corners.len() {
                    if sum(k) < least {
                        (cheapest, least) = (k, sum(k));
                    }
                }
                let own = EDGE_WEIGHT * chord2;
                let (mut best, mut best_normal, mut best_apex) = (f64::INFINITY, DVec3::ZERO, NONE);
                let mut offer = |k: usize, best: &mut f64| {
                    let mut total = sum(k) + own;
                    let b = points[corners[k] as usize];
                    let cross = (b - a).cross(c - a);
                    let area2 = cross.length();
                    total += 0.5 * area2;
                    if total >= *best {
                        return;
                    }
                    let unit = if area2 > 0.0 { cross / area2 } else { DVec3::ZERO };
                    let left = left_chord[corners[k] as usize] as usize;
                    let right = right_chords[k] as usize;
                    total += fold(unit, normal[left], length[left])
                        + fold(unit, normal[right], length[right]);
                    if i == 0 && j as usize == n - 1 {
                        if let Beyond::Face(face) = polygon.beyond[n - 1] {
                            total += fold(unit, face, length[chord]);
                        }
                    }
                    if total < *best {
                        *best = total;
                        (best_normal, best_apex) = (unit, corners[k]);
                    }
                };
                if cheapest != usize::MAX {
                    offer(cheapest, &mut best);
                    for k in 0..corners.len() {
                        if sum(k) + own < best && k != cheapest {
                            offer(k, &mut best);
                        }
                    }
                }
                weight[chord] = best;
                normal[chord] = best_normal;
                apex[chord] = best_apex;
                left_weight[j as usize] = best;
                pace.work(corners.len())?;
                columns.put(i, j, best, chord);
            }
            row.iter().for_each(|&j| left_weight[j as usize] = f64::INFINITY);
        }
        Ok(Self { apex })
    }

    /// The triangles in corner numbers.
    fn triangles(&self, chords: &Chords, n: usize) -> Vec<[u32; 3]> {
        let mut triangles = Vec::with_capacity(n.saturating_sub(2));
        let mut stack = vec![(0u32, n as u32 - 1)];
        while let Some((i, j)) = stack.pop() {
            if j == i + 1 {
                continue;
            }
            let Some(k) = chords.find(i as usize, j).map(|c| self.apex[c]) else { continue };
            if k != NONE {
                triangles.push([i, k, j]);
                stack.push((i, k));
                stack.push((k, j));
            }
        }
        triangles
    }
}

/// The cost of the angle between two faces: nothing when flat, 1 at 90°, 2 + `FOLD_BACK` when
/// folded back; nothing where a normal is unknown.
fn bend(n: DVec3, m: DVec3) -> f64 {
    let cosine = n.dot(m);
    if cosine == 0.0 && (n == DVec3::ZERO || m == DVec3::ZERO) {
        return 0.0;
    }
    1.0 - cosine + FOLD_BACK * cosine.min(0.0).powi(2)
}

fn build_patch(
    positions: &[DVec3],
    sizes: &[f64],
    polygon: &Polygon,
    triangles: &[[u32; 3]],
) -> Patch {
    let n = polygon.corners.len();
    let mut open: HashMap<(u32, u32), (u32, usize)> = HashMap::new();
    let mut across = vec![[NONE; 3]; triangles.len()];
    for (t, tri) in triangles.iter().enumerate() {
        for k in 0..3 {
            let (a, b) = (tri[k], tri[(k + 1) % 3]);
            match open.remove(&(b, a)) {
                Some((s, side)) => {
                    across[t][k] = s;
                    across[s as usize][side] = t as u32;
                }
                None => {
                    open.insert((a, b), (t as u32, k));
                }
            }
        }
    }
    // What is still open lies on the polygon; the sides of a bridge are glued.
    for i in 0..n {
        if let Beyond::Bridge(twin) = polygon.beyond[i] {
            let edge = |i: usize| (i as u32, ((i + 1) % n) as u32);
            if let (Some(&(t, k)), Some(&(s, l))) = (open.get(&edge(i)), open.get(&edge(twin))) {
                across[t as usize][k] = s;
                across[s as usize][l] = t;
            }
        }
    }
    let mut at = vec![NONE; positions.len()];
    let triangles: Vec<[u32; 3]> =
        triangles.iter().map(|t| t.map(|c| polygon.corners[c as usize])).collect();
    for (t, tri) in triangles.iter().enumerate() {
        tri.iter().for_each(|&v| at[v as usize] = t as u32);
    }
    Patch {
        positions: positions.to_vec(),
        sizes: sizes.to_vec(),
        offsets: vec![DVec3::ZERO; positions.len()],
        rim_count: positions.len(),
        triangles,
        across,
        at,
    }
}

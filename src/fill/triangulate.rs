//! Liepa (2003), "Filling holes in meshes": minimum weight triangulation of the rim.
//!
//! Differences from the paper:
//! - The weight is a sum (area, squared edge lengths, dihedral angles), not the pair (largest
//!   dihedral angle, area): the largest angle says little on ragged rims.
//! - Not cubic in the rim. Chords are only tried between corners that are near each other, on a
//!   hierarchy of levels, level l holding every 2^l-th corner: O(n) chords. A triangulation
//!   always exists among them, since neighbours on each level are always tried.
//! - Several loops: the polygon runs over bridges ([`super::polygon`]), which are glued here. Chords
//!   are also tried to the nearest corners of other loops: without them a wide band's rims were capped
//!   one by one, since no band without folds is made of what is near on one's own rim.

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
    let points: Vec<DVec3> = polygon.corners.iter().map(|&v| positions[v as usize]).collect();
    let around: f64 = (0..n).map(|i| points[i].distance(points[(i + 1) % n])).sum();
    let fold_scale = FOLD_WEIGHT * around / std::f64::consts::TAU;
    let chords = Chords::new(&points, polygon, all_pairs);
    let corners = Corners { polygon, points, fold_scale };
    let triangles = trace(&corners.minimise(&chords, pace)?, n);
    Ok((triangles.len() == n - 2).then(|| build_patch(positions, sizes, polygon, &triangles)))
}

/// The chords (i, j), i < j, that may be used; rows sorted.
struct Chords {
    start: Vec<usize>,
    to: Vec<u32>,
}

impl Chords {
    fn new(points: &[DVec3], polygon: &Polygon, all_pairs: AllPairs) -> Self {
        let n = polygon.corners.len();
        // The two corners of a bridge's end are one vertex: no chord joins them.
        let may_join = |i: usize, j: usize| j == i + 1 || polygon.corners[i] != polygon.corners[j];
        if all_pairs.holds(polygon) {
            let mut all = Self { start: vec![0], to: Vec::with_capacity(n * (n - 1) / 2) };
            for i in 0..n {
                all.to.extend((i + 1..n).filter(|&j| may_join(i, j)).map(|j| j as u32));
                all.start.push(all.to.len());
            }
            return all;
        }
        let mut pairs: Vec<(u32, u32)> = Vec::new();
        let loops = polygon.loops();
        let has_many = loops.iter().any(|&l| l != 0);
        let mut step = 1;
        loop {
            let mut level: Vec<usize> = (0..n).step_by(step).collect();
            if level.last() != Some(&(n - 1)) {
                level.push(n - 1);
            }
            let m = level.len();
            if step > 1 && m <= all_pairs.coarsest {
                for a in 0..m {
                    pairs.extend((a + 1..m).map(|b| (level[a] as u32, level[b] as u32)));
                }
                break;
            }
            for a in 0..m {
                let along = (a + 1)..(a + 1 + ALONG).min(m);
                pairs.extend(along.map(|b| (level[a] as u32, level[b] as u32)));
            }
            let points: Vec<DVec3> = level.iter().map(|&i| points[i]).collect();
            let mut add = |a: usize, b: usize| {
                pairs.push((level[a.min(b)] as u32, level[a.max(b)] as u32));
            };
            nearest_pairs(&points, |_, _| true, &mut add);
            // Across a wide band the nearest corners are all of one's own rim.
            if has_many {
                let differ = |a: usize, b: usize| loops[level[a]] != loops[level[b]];
                nearest_pairs(&points, differ, &mut add);
            }
            step *= 2;
        }
        pairs.sort_unstable();
        pairs.dedup();
        pairs.retain(|&(i, j)| may_join(i as usize, j as usize));
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
}

/// Calls `f` for each point and the nearest ones that it may be joined to, by a sweep along x: a rim is a
/// curve, so few points share an x.
fn nearest_pairs(
    points: &[DVec3],
    may_join: impl Fn(usize, usize) -> bool,
    f: &mut dyn FnMut(usize, usize),
) {
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
            if d.0 > limit(&best) || !may_join(a, b) {
                continue;
            }
            let at = best.partition_point(|x| x.0 < d.0 || (x.0 == d.0 && x.1 < d.1));
            best.insert(at, d);
            best.truncate(NEAREST);
        }
        best.iter().for_each(|&(_, b)| f(a, b));
    }
}

/// Chords up to which the normals behind them are kept: 24 bytes each, and so three quarters of a megabyte
/// at most, for the rims of up to 256 edges that most holes have.
const MOST_NORMALS: usize = 1 << 15;

/// The chords by their second corner, ascending by the first, filled from the end as the first
/// corners descend. Walking a column is what the time goes into, so each thing lies by itself.
struct Columns {
    start: Vec<usize>,
    /// First filled place of each column.
    open: Vec<usize>,
    corner: Vec<u32>,
    /// The least weight of the part of the polygon behind the chord.
    weight: Vec<f64>,
    /// The corner that gives it: of the triangle at the chord.
    apex: Vec<u32>,
    /// The unit normal of that triangle; empty if there are more than [`MOST_NORMALS`].
    normal: Vec<DVec3>,
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
        let (corner, weight, apex) = (vec![0; m], vec![f64::INFINITY; m], vec![NONE; m]);
        let normal = if m <= MOST_NORMALS { vec![DVec3::ZERO; m] } else { Vec::new() };
        Self { start, open, corner, weight, apex, normal }
    }
    fn filled(&self, j: u32) -> std::ops::Range<usize> {
        self.open[j as usize]..self.start[j as usize + 1]
    }
    fn put(&mut self, i: usize, j: u32, (weight, apex, normal): (f64, u32, DVec3)) {
        self.open[j as usize] -= 1;
        let at = self.open[j as usize];
        self.corner[at] = i as u32;
        self.weight[at] = weight;
        self.apex[at] = apex;
        if let Some(kept) = self.normal.get_mut(at) {
            *kept = normal;
        }
    }
    /// The apex behind the chord (i, j).
    fn apex(&self, i: u32, j: u32) -> Option<u32> {
        let column = self.filled(j);
        let k = self.corner[column.clone()].binary_search(&i).ok()?;
        Some(self.apex[column.start + k]).filter(|&apex| apex != NONE)
    }
}

/// What a triangulation is chosen from.
struct Corners<'a> {
    polygon: &'a Polygon,
    points: Vec<DVec3>,
    fold_scale: f64,
}

impl Corners<'_> {
    fn fold(&self, n: DVec3, m: DVec3, length: f64) -> f64 {
        self.fold_scale * length * bend(n, m)
    }

    /// Unit normal of the input face at an edge of the polygon; zero where that is a bridge.
    fn beyond(&self, edge: usize) -> DVec3 {
        match self.polygon.beyond[edge] {
            Beyond::Face(normal) => normal,
            Beyond::Bridge(_) => DVec3::ZERO,
        }
    }

    /// Unit normal of the face behind the chord (i, j) whose apex is known, made anew: of many chords kept,
    /// the normals would be half of all that a triangulation takes.
    fn normal(&self, i: usize, j: usize, apex: u32) -> DVec3 {
        if j == i + 1 {
            return self.beyond(i);
        }
        let (a, b, c) = (self.points[i], self.points[apex as usize], self.points[j]);
        unit((b - a).cross(c - a)).0
    }

    /// The least weights, and the corners that give them.
    fn minimise(&self, chords: &Chords, pace: &mut Pace<'_>) -> Result<Columns> {
        let n = self.points.len();
        let mut columns = Columns::new(chords, n);
        // The chords of row i by their second corner; infinite where there is none.
        let mut left_weight = vec![f64::INFINITY; n];
        let mut left_normal = vec![DVec3::ZERO; n];
        let mut left_length = vec![0.0; n];
        let mut sums = Vec::with_capacity(n);
        // Descending i, ascending j: the parts of a chord come before it.
        for i in (0..n).rev() {
            let row = chords.row(i);
            for &j in row {
                left_length[j as usize] = self.points[i].distance(self.points[j as usize]);
                let (best, apex, normal) = if j as usize == i + 1 {
                    (0.0, NONE, self.beyond(i))
                } else {
                    let filled = columns.filled(j);
                    let parts = Parts {
                        corners: &columns.corner[filled.clone()],
                        rights: &columns.weight[filled.clone()],
                        apexes: &columns.apex[filled.clone()],
                        normals: columns.normal.get(filled).unwrap_or_default(),
                        left_weight: &left_weight,
                        left_normal: &left_normal,
                        left_length: &left_length,
                    };
                    pace.work(parts.corners.len())?;
                    parts.least(self, (i, j as usize), &mut sums)
                };
                (left_weight[j as usize], left_normal[j as usize]) = (best, normal);
                columns.put(i, j, (best, apex, normal));
            }
            row.iter().for_each(|&j| left_weight[j as usize] = f64::INFINITY);
        }
        Ok(columns)
    }
}

/// What lies behind one chord (i, j): for each corner between, the parts to its left and right.
struct Parts<'a> {
    corners: &'a [u32],
    rights: &'a [f64],
    apexes: &'a [u32],
    /// May be empty.
    normals: &'a [DVec3],
    left_weight: &'a [f64],
    left_normal: &'a [DVec3],
    left_length: &'a [f64],
}

impl Parts<'_> {
    /// The weights to the left, corner by corner, if these are next to each other: without bridges and with
    /// all chords they are, and need not be looked up one by one.
    fn lefts(&self) -> Option<&[f64]> {
        let (first, last) = (*self.corners.first()? as usize, *self.corners.last()? as usize);
        (last - first + 1 == self.corners.len()).then(|| &self.left_weight[first..=last])
    }

    /// The least weight, its apex, and the normal there.
    fn least(
        &self,
        all: &Corners<'_>,
        (i, j): (usize, usize),
        sums: &mut Vec<f64>,
    ) -> (f64, u32, DVec3) {
        let n = all.points.len();
        let (a, c) = (all.points[i], all.points[j]);
        let chord2 = a.distance_squared(c);
        let own = EDGE_WEIGHT * chord2;
        sums.clear();
        match self.lefts() {
            Some(lefts) => sums.extend(lefts.iter().zip(self.rights).map(|(l, r)| l + r)),
            None => {
                let left = |&at: &u32| self.left_weight[at as usize];
                sums.extend(self.corners.iter().zip(self.rights).map(|(at, r)| left(at) + r));
            }
        }
        // The apex with the cheapest parts first: its total rules most others out unseen.
        let least = least_of(sums);
        let cheapest = match least < f64::INFINITY {
            true => sums.iter().position(|&sum| sum == least).unwrap_or(usize::MAX),
            false => usize::MAX,
        };
        let mut best = (f64::INFINITY, NONE, DVec3::ZERO);
        if cheapest == usize::MAX {
            return best;
        }
        // Rejected as soon as a part of the sum is too much: square roots are what this costs.
        let offer = |k: usize, best: &mut (f64, u32, DVec3)| {
            let mut total = sums[k] + own;
            let at = self.corners[k] as usize;
            let b = all.points[at];
            let cross = (b - a).cross(c - a);
            let room = best.0 - total;
            if 0.25 * cross.length_squared() > SURELY * room * room {
                return;
            }
            let (normal, area2) = unit(cross);
            total += 0.5 * area2;
            let left = all.fold(normal, self.left_normal[at], self.left_length[at]);
            if total + left >= best.0 {
                return;
            }
            let right = match self.normals.get(k) {
                Some(&normal) => normal,
                None => all.normal(at, j, self.apexes[k]),
            };
            total += left + all.fold(normal, right, b.distance(c));
            if i == 0 && j == n - 1 {
                total += all.fold(normal, all.beyond(n - 1), chord2.sqrt());
            }
            if total < best.0 {
                *best = (total, self.corners[k], normal);
            }
        };
        offer(cheapest, &mut best);
        for (part, some) in sums.chunks(AT_ONCE).enumerate() {
            if least_of(some) + own >= best.0 {
                continue;
            }
            for k in part * AT_ONCE..part * AT_ONCE + some.len() {
                if sums[k] + own < best.0 && k != cheapest {
                    offer(k, &mut best);
                }
            }
        }
        best
    }
}

/// Sums of parts that are compared at once.
const AT_ONCE: usize = 8;

/// The least of some numbers; infinite without any. By lanes, which the compiler makes registers of.
#[inline]
fn least_of(numbers: &[f64]) -> f64 {
    let mut lanes = [f64::INFINITY; AT_ONCE];
    let parts = numbers.chunks_exact(AT_ONCE);
    let less = |a: f64, b: f64| if b < a { b } else { a };
    let rest = parts.remainder().iter().fold(f64::INFINITY, |a, &b| less(a, b));
    for part in parts {
        for (lane, &x) in lanes.iter_mut().zip(part) {
            *lane = less(*lane, x);
        }
    }
    lanes.into_iter().fold(rest, less)
}

/// What is greater by this factor is so whatever the rounding.
const SURELY: f64 = 1.0 + 1e-9;

/// A vector's direction, zero without one, and its length.
fn unit(v: DVec3) -> (DVec3, f64) {
    let length = v.length();
    (if length > 0.0 { v / length } else { DVec3::ZERO }, length)
}

/// The triangles behind the chord (0, n − 1), in corner numbers.
fn trace(columns: &Columns, n: usize) -> Vec<[u32; 3]> {
    let mut triangles = Vec::with_capacity(n.saturating_sub(2));
    let mut stack = vec![(0u32, n as u32 - 1)];
    while let Some((i, j)) = stack.pop() {
        if j == i + 1 {
            continue;
        }
        if let Some(k) = columns.apex(i, j) {
            triangles.push([i, k, j]);
            stack.push((i, k));
            stack.push((k, j));
        }
    }
    triangles
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
        offsets: Vec::new(),
        rim_count: positions.len(),
        triangles,
        across,
        at,
    }
}

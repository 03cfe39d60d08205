//! Holes that the caller gives instead of having them found: a loop is cut out of the mesh through the
//! points, and in a region gaps count that are too small to be found.

use super::surface::Surface;
use super::tidy::{fans, measure, rims, Rim, RimKind};
use crate::error::{Error, Result};
use crate::mesh::VertexView;
use crate::options::GivenHole;
use glam::DVec3;
use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet, BinaryHeap};

/// Where the surface has no edge between two points of a loop, the way along its edges is at most so many
/// times their distance, and a spacing, long: on a hexagonal lattice ways are up to 1.16 times as long, and an
/// edge that is missing takes the two other sides of its triangle.
const DETOUR: f64 = 1.25;
/// What an edge of a rim counts on such a way: through a few points of a rim the loop follows it.
const RIM: f64 = 0.5;
/// In a region triangles are so much smaller than elsewhere: one point that is missing is then seen, see
/// [`super::surface::RADIUS`].
const NARROW: f64 = 0.85;

/// The holes given, in the numbers of the mesh.
#[derive(Debug, Clone, Default)]
pub struct Given {
    /// Points of each loop.
    loops: Vec<Vec<u32>>,
    /// The regions.
    balls: Vec<Ball>,
}

/// A region: centre and radius, in cloud units.
#[derive(Debug, Clone, Copy)]
pub struct Ball {
    centre: DVec3,
    radius: f64,
}

impl Ball {
    /// Whether a point lies in it, made larger by a factor.
    fn has(&self, p: DVec3, factor: f64) -> bool {
        p.distance(self.centre) <= factor * self.radius
    }

    /// Whether all points of a rim lie in it.
    pub fn has_all(&self, surface: &Surface<'_>, rim: &[u32]) -> bool {
        rim.iter().all(|&v| self.has(surface.points[v as usize], 1.0))
    }
}

fn bad(reason: String) -> Error {
    Error::InvalidOption { name: "given_holes", reason }
}

/// Checks what can be checked before the points are looked at.
pub fn check(given: &[GivenHole], cloud: VertexView<'_>) -> Result<()> {
    let (mut loops, mut regions) = (0, 0);
    for hole in given {
        match hole {
            GivenHole::Loop(points) => {
                let l = loops;
                loops += 1;
                if points.len() < 3 {
                    return Err(bad(format!(
                        "loop {l} has {} points: give 3 or more",
                        points.len()
                    )));
                }
                if let Some(p) = points.iter().find(|&&p| p as usize >= cloud.len()) {
                    let n = cloud.len();
                    return Err(bad(format!("loop {l} names point {p}: the cloud has {n} points")));
                }
                let mut seen = BTreeSet::new();
                if let Some(p) = points.iter().find(|&&p| !seen.insert(p)) {
                    return Err(bad(format!("loop {l} names point {p} twice: leave one out")));
                }
            }
            GivenHole::Region { centre, radius } => {
                let r = regions;
                regions += 1;
                if centre.iter().any(|x| !x.is_finite()) {
                    return Err(bad(format!("the centre of region {r} is not finite")));
                }
                if !(*radius > 0.0 && radius.is_finite()) {
                    return Err(bad(format!("the radius {radius} of region {r} is not positive")));
                }
            }
        }
    }
    Ok(())
}

impl Given {
    /// `ids`: the input points that are vertices of the mesh, ascending.
    pub fn new(given: &[GivenHole], ids: &[u32]) -> Result<Self> {
        let mut made = Self::default();
        for hole in given {
            match hole {
                GivenHole::Region { centre, radius } => {
                    made.balls.push(Ball { centre: DVec3::from(*centre), radius: *radius });
                }
                GivenHole::Loop(points) => {
                    let l = made.loops.len();
                    let local = |p: &u32| {
                        let refused = |_| {
                            bad(format!(
                                "point {p} of loop {l} is not on the surface: it has no coordinates, \
                                 doubles an earlier point, or lies beside the surface; leave it out"
                            ))
                        };
                        ids.binary_search(p).map(|i| i as u32).map_err(refused)
                    };
                    made.loops.push(points.iter().map(local).collect::<Result<_>>()?);
                }
            }
        }
        Ok(made)
    }

    /// Whether there are none: holes are to be found.
    pub fn is_empty(&self) -> bool {
        self.loops.is_empty() && self.balls.is_empty()
    }

    /// The regions in which no hole is found.
    pub fn without_hole(&self, surface: &Surface<'_>) -> Vec<Ball> {
        if self.balls.is_empty() {
            return Vec::new();
        }
        let mut found = rims(surface, &[]);
        found.retain(|r| r.kind == RimKind::Hole);
        let is_empty = |b: &&Ball| !found.iter().any(|r| b.has_all(surface, &r.points));
        self.balls.iter().filter(is_empty).copied().collect()
    }

    /// Cuts the loops out of the surface. Returns the points inside, which are on it no more, and the rims, in
    /// the order in which a filling face runs, the smallest point first. `ids` are for messages.
    pub fn cut(
        &self,
        surface: &mut Surface<'_>,
        spacing: &[f64],
        ids: &[u32],
    ) -> Result<(Vec<u32>, Vec<Vec<u32>>)> {
        let (mut inside, mut cut) = (BTreeSet::new(), Vec::new());
        for (l, points) in self.loops.iter().enumerate() {
            let (rim, dropped) = Cut { surface, spacing, ids, l }.run(points)?;
            let own: BTreeSet<u32> = rim.iter().copied().collect();
            for t in dropped {
                surface.dropped[t as usize] = true;
                let corners = surface.triangles[t as usize];
                inside.extend(corners.iter().filter(|v| !own.contains(v)));
            }
            cut.push(rim);
        }
        // Where only a corner of the surface is left at a point, or none, the rim is no rim.
        for (l, rim) in cut.iter().enumerate() {
            if let Some(&v) = rim.iter().find(|&&v| fans(surface, v).len() != 1) {
                let p = ids[v as usize];
                return Err(bad(format!(
                    "loop {l} touches another gap, or itself, at point {p}: lead it around"
                )));
            }
        }
        Ok((inside.into_iter().collect(), cut))
    }

    /// Makes the rims given the only holes. `cut`: those of the loops.
    pub fn mark(&self, surface: &Surface<'_>, rims: &mut [Rim], cut: &[Vec<u32>]) -> Result<()> {
        let of_loop: Vec<bool> = rims.iter().map(|r| cut.contains(&r.points)).collect();
        let mut chosen = of_loop.clone();
        for ball in &self.balls {
            let of = |kind: RimKind| {
                let all = rims.iter().enumerate();
                all.filter(move |(_, r)| r.kind == kind && ball.has_all(surface, &r.points))
            };
            of(RimKind::Hole).for_each(|(i, _)| chosen[i] = true);
            let largest = of(RimKind::Gap)
                .max_by(|a, b| a.1.missing.total_cmp(&b.1.missing).then(b.0.cmp(&a.0)));
            if let (None, Some((i, _))) = (of(RimKind::Hole).next(), largest) {
                chosen[i] = true;
            }
        }
        for (i, rim) in rims.iter_mut().enumerate() {
            rim.kind = if chosen[i] { RimKind::Hole } else { RimKind::Crack };
            if of_loop[i] {
                rim.missing = measure(surface, &rim.points).missing;
            }
        }
        if let Some(l) = cut.iter().position(|c| !rims.iter().any(|r| r.points == *c)) {
            return Err(bad(format!("loop {l} is not the rim of one gap: lead it around the gap")));
        }
        for (r, ball) in self.balls.iter().enumerate() {
            let has = |rim: &Rim| rim.kind == RimKind::Hole && ball.has_all(surface, &rim.points);
            if !rims.iter().any(has) {
                let [x, y, z] = ball.centre.to_array();
                let radius = ball.radius;
                return Err(bad(format!(
                    "region {r} has no rim of a gap within {radius} of {x}, {y}, {z}: make it larger \
                     than the gap, or give a loop"
                )));
            }
        }
        Ok(())
    }
}

/// The spacings that the surface is to be made with so that small gaps show in regions: in them none is wider than
/// most are there and around, or triangles would span what is missing. Where most are sparse that is no gap.
pub fn narrow(regions: &[Ball], points: &[DVec3], spacing: &[f64]) -> Vec<f64> {
    let mut all = spacing.to_vec();
    for ball in regions {
        let around = (0..points.len()).filter(|&i| ball.has(points[i], 2.0));
        let mut near: Vec<f64> = around.map(|i| spacing[i]).collect();
        if near.is_empty() {
            continue;
        }
        let half = near.len() / 2;
        let middle = *near.select_nth_unstable_by(half, f64::total_cmp).1;
        for i in (0..points.len()).filter(|&i| ball.has(points[i], 1.0)) {
            all[i] = NARROW * spacing[i].min(middle);
        }
    }
    all
}

/// One loop to be cut out.
struct Cut<'a, 's> {
    surface: &'a Surface<'s>,
    spacing: &'a [f64],
    ids: &'a [u32],
    l: usize,
}

impl Cut<'_, '_> {
    /// The rim, and the triangles inside.
    fn run(&self, points: &[u32]) -> Result<(Vec<u32>, Vec<u32>)> {
        let l = self.l;
        let mut path = self.path(points)?;
        let walls: BTreeSet<[u32; 2]> = edges(&path).map(sorted).collect();
        let of = |flip: bool| {
            edges(&path).filter_map(move |[a, b]| self.on_left(if flip { [b, a] } else { [a, b] }))
        };
        let mut sides = [Side::new(of(false)), Side::new(of(true))];
        // The side that is exhausted first is the inside.
        let inner = 'inner: loop {
            for k in 0..2 {
                let Some(t) = sides[k].open.pop() else { break 'inner k };
                if sides[1 - k].seen.contains(&t) {
                    return Err(bad(format!(
                        "loop {l} does not part the surface: lead it around the gap"
                    )));
                }
                for edge in edges(&self.surface.triangles[t as usize]) {
                    if !walls.contains(&sorted(edge)) {
                        sides[k].add(self.on_left([edge[1], edge[0]]));
                    }
                }
            }
        };
        let on_outside = |[a, b]: [u32; 2]| self.on_left(if inner == 0 { [b, a] } else { [a, b] });
        if let Some([a, _]) = edges(&path).find(|e| on_outside(*e).is_none()) {
            let p = self.ids[a as usize];
            return Err(bad(format!(
                "loop {l} leaves out a part of a gap, at point {p}: take it in"
            )));
        }
        if inner == 1 {
            path.reverse();
        }
        let first = (0..path.len()).min_by_key(|&i| path[i]).unwrap_or(0);
        path.rotate_left(first);
        let [left, right] = sides;
        let seen = if inner == 0 { left.seen } else { right.seen };
        Ok((path, seen.into_iter().collect()))
    }

    /// The loop along the surface's edges.
    fn path(&self, points: &[u32]) -> Result<Vec<u32>> {
        let mut taken: BTreeSet<u32> = points.iter().copied().collect();
        let mut path = Vec::new();
        for [a, b] in edges(points) {
            path.push(a);
            let Some(between) = self.way(a, b, &taken) else {
                let [p, q] = [a, b].map(|v| self.ids[v as usize]);
                return Err(bad(format!(
                    "points {p} and {q} of loop {} are too far apart: no edges of the surface lead from \
                     one to the other without a detour; give points between them",
                    self.l
                )));
            };
            taken.extend(&between);
            path.extend(between);
        }
        Ok(path)
    }

    /// The points between two on the best way, which keeps off those `taken`.
    fn way(&self, from: u32, to: u32, taken: &BTreeSet<u32>) -> Option<Vec<u32>> {
        if self.on_left([from, to]).or(self.on_left([to, from])).is_some() {
            return Some(Vec::new());
        }
        let at = |v: u32| self.surface.points[v as usize];
        let most = DETOUR * at(from).distance(at(to)) + self.spacing[from as usize];
        // For each point the cost and the length of the way to it, and where that comes from.
        let mut best = BTreeMap::from([(from, (0.0, 0.0, from))]);
        // A float that is not negative sorts like its bits.
        let mut queue = BinaryHeap::from([Reverse((0u64, from))]);
        while let Some(Reverse((bits, v))) = queue.pop() {
            if v == to {
                let back = std::iter::successors(Some(best[&to].2), |w| Some(best[w].2));
                let mut way: Vec<u32> = back.take_while(|&w| w != from).collect();
                way.reverse();
                return Some(way);
            }
            let (cost, length, _) = best[&v];
            if f64::from_bits(bits) > cost {
                continue;
            }
            for w in self.surface.at(v).flat_map(|s| self.surface.others(s)) {
                let step = at(v).distance(at(w));
                let is_rim = self.on_left([v, w]).is_none() || self.on_left([w, v]).is_none();
                let cost = cost + if is_rim { RIM * step } else { step };
                let free = w == to || !taken.contains(&w);
                let better = best.get(&w).is_none_or(|b| cost < b.0);
                if free && better && length + step <= most {
                    best.insert(w, (cost, length + step, v));
                    queue.push(Reverse((cost.to_bits(), w)));
                }
            }
        }
        None
    }

    /// The triangle that an edge runs around counter-clockwise.
    fn on_left(&self, [a, b]: [u32; 2]) -> Option<u32> {
        self.surface.at(a).find(|&s| self.surface.others(s)[0] == b).map(|s| s.0)
    }
}

/// Triangles on one side of a loop.
struct Side {
    seen: BTreeSet<u32>,
    open: Vec<u32>,
}

impl Side {
    fn new(first: impl Iterator<Item = u32>) -> Self {
        let seen: BTreeSet<u32> = first.collect();
        Self { open: seen.iter().copied().collect(), seen }
    }

    fn add(&mut self, triangle: Option<u32>) {
        self.open.extend(triangle.filter(|t| self.seen.insert(*t)));
    }
}

/// The edges of a closed loop.
fn edges(points: &[u32]) -> impl Iterator<Item = [u32; 2]> + '_ {
    (0..points.len()).map(|i| [points[i], points[(i + 1) % points.len()]])
}

fn sorted([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

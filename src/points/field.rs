//! Park, Guo, Shin and Qin (2006), "Surface completion for shape and appearance", Sec. 4: contours grow
//! from the maxima of the unsigned distance field towards the points; where one that is inside meets one
//! that is outside is a hole. A third opinion, which knows neither a mesh nor boundary probabilities.
//!
//! Differences from the paper:
//! - An octree whose cells grow with the distance, each with its centre's distance from the nearest
//!   point, instead of levels of a grid with block distances.
//! - Cells nearer to a point than [`OPEN`] spacings are closed: contours meet in holes only.
//! - Contours that meet nearly as far from the points as one of them started are one ([`SHALLOW`]).
//! - In and out: the contours on the two sides of a point have opposite sides, most points first.
//! - The rim are the points nearest to the cells where contours meet; no angle is needed.
//! - A surface with one side only (open, or more hole than wall) is none of its business: no verdict.

use super::neighbours::{blocks, Graph, Neighbours};
use super::tidy::SMALLEST_RIM;
use crate::error::Result;
use crate::mesh::roots::Roots;
use crate::progress::Monitor;
use glam::{DVec3, UVec3};
use kiddo::{ImmutableKdTree, SquaredEuclidean};
use std::collections::{BTreeMap, VecDeque};

/// Nearer to a point than so many spacings a cell is closed. The middle of a triangle of a square
/// lattice is 0.71 from its corners, and half a cell aside 1.0; a gap of 8 points is 1.3 wide.
const OPEN: f64 = 1.25;
/// Greatest edge of a cell beside the surface, in spacings: its centre is then nearer than `OPEN`.
const CELL: f64 = 1.2;
/// A cell is divided if a point is nearer to its centre than so many of its edges.
const FINE: f64 = 1.5;
/// Two contours are one if they meet at this share of the lower one's greatest distance: what the
/// cells' size can make of one maximum.
const SHALLOW: f64 = 0.85;
/// How far from a point its two sides are looked at, in spacings; farther if that is closed.
const SIDES: [f64; 2] = [2.0, 3.0];
/// Divisions at most: a cell is then a 200,000th of the cloud.
const DEEPEST: u32 = 18;
/// Share of a rim's points beside which contours meet: a crack is wide enough for them in places only, and
/// elsewhere they do not meet at all.
const SHARED: f64 = 0.25;
/// Least distance from all points at such a place, as a share of that from the own: less is beyond a wall.
const FREE: f64 = 0.6;
/// Neighbours that are beside a point: those at one spacing on an even cloud.
const BESIDE: usize = 6;
const NONE: u32 = u32::MAX;

/// What the distance field shows of a cloud.
pub struct Field {
    /// For each point whether contours meet in a hole next to it.
    rim: Vec<bool>,
    /// For each point whether one contour, or none, is on both its sides.
    alone: Vec<bool>,
}

impl Field {
    /// From points, the spacing around each, and normals on any side.
    pub fn new(
        points: &[DVec3],
        normals: &[DVec3],
        spacing: &[f64],
        threads: usize,
        monitor: &Monitor,
    ) -> Result<Self> {
        let cells = Cells::new(points, spacing, threads, monitor)?;
        let (open, number) = cells.open(spacing);
        monitor.check()?;
        let graph = Graph::new(open.len(), &cells.touching(&number));
        let mut flood = Flood::new(&cells, &open, &graph, monitor)?;
        let at = |p: DVec3, far: f64| {
            let cell = cells.at(p) as usize;
            let free = number[cell] != NONE && f64::from(cells.far[cell]) > FREE * far;
            free.then_some(number[cell])
        };
        let contours: Vec<[Option<u32>; 2]> = blocks(points.len(), threads, monitor, &|i| {
            [1.0, -1.0].map(|side| {
                let away = SIDES.iter().map(|k| k * spacing[i]);
                away.clone().find_map(|far| at(points[i] + side * far * normals[i], far))
            })
        })?;
        let contours: Vec<[Option<u32>; 2]> =
            contours.into_iter().map(|c| c.map(|i| i.map(|i| flood.contour(i as usize)))).collect();
        let outside = at(cells.low, 0.0).map_or(NONE, |i| flood.contour(i as usize));
        let mut inside = sides(&contours, outside);
        let met = std::mem::take(&mut flood.met);
        let met: Vec<(u32, [u32; 2])> = met
            .into_iter()
            .map(|(cell, a, b)| (cell, [a, b].map(|c| flood.roots.root(c))))
            .collect();
        // The widest meetings come first: a pocket that no point looks into is on the side it opens to.
        for (_, [a, b]) in &met {
            match (inside.get(a).copied(), inside.get(b).copied()) {
                (Some(side), None) => inside.insert(*b, side),
                (None, Some(side)) => inside.insert(*a, side),
                _ => None,
            };
        }
        let mut rim = vec![false; points.len()];
        for (cell, [a, b]) in met {
            if inside.get(&a) != inside.get(&b) {
                rim[cells.near[open[cell as usize] as usize] as usize] = true;
            }
        }
        let alone = contours.iter().map(|[a, b]| a == b).collect();
        Ok(Self { rim, alone })
    }

    /// Whether there is a hole at a rim; `None` where the surface has one side only.
    pub fn agrees(&self, rim: &[u32], neighbours: &Neighbours) -> Option<bool> {
        let share = |is: &dyn Fn(u32) -> bool| {
            rim.iter().filter(|&&v| is(v)).count() as f64 / rim.len().max(1) as f64
        };
        let near = |v: u32| {
            let mut beside = neighbours.of(v as usize).iter().take(BESIDE);
            self.rim[v as usize] || beside.any(|&q| self.rim[q as usize])
        };
        (share(&|v| self.alone[v as usize]) < 0.5).then(|| share(&near) >= SHARED)
    }

    /// Holes that no rim runs beside: their points.
    pub fn others(&self, rims: &[&[u32]], neighbours: &Neighbours) -> Vec<Vec<u32>> {
        let mut known = vec![false; self.rim.len()];
        for &v in rims.iter().copied().flatten() {
            known[v as usize] = true;
            neighbours.of(v as usize).iter().for_each(|&q| known[q as usize] = true);
        }
        let mut roots = Roots::new(self.rim.len());
        let marked = |v: usize| self.rim[v];
        for v in (0..self.rim.len()).filter(|&v| marked(v)) {
            let near = neighbours.of(v).iter().filter(|&&q| marked(q as usize));
            near.for_each(|&q| {
                roots.join(v as u32, q);
            });
        }
        let mut all: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
        for v in (0..self.rim.len()).filter(|&v| marked(v)) {
            all.entry(roots.root(v as u32)).or_default().push(v as u32);
        }
        let new = |list: &Vec<u32>| {
            let seen = list.iter().filter(|&&v| known[v as usize]).count();
            list.len() >= SMALLEST_RIM && 2 * seen < list.len()
        };
        all.into_values().filter(new).collect()
    }
}

/// An octree: cells by level, eight children together.
struct Cells {
    low: DVec3,
    size: f64,
    /// The first child of each; `NONE` for a leaf.
    first: Vec<u32>,
    /// Distance of the centre from the nearest point, and that point.
    far: Vec<f32>,
    near: Vec<u32>,
    /// Whether it lies at the border of the whole.
    outer: Vec<bool>,
}

impl Cells {
    fn new(points: &[DVec3], spacing: &[f64], threads: usize, monitor: &Monitor) -> Result<Self> {
        let entries: Vec<[f64; 3]> = points.iter().map(|p| p.to_array()).collect();
        let tree: ImmutableKdTree<f64, 3> = ImmutableKdTree::new_from_slice(&entries);
        let low = points.iter().copied().reduce(DVec3::min).unwrap_or_default();
        let high = points.iter().copied().reduce(DVec3::max).unwrap_or_default();
        // Room for the outer contour all around.
        let size = 1.5 * (high - low).max_element();
        let low = 0.5 * (low + high) - DVec3::splat(0.5 * size);
        let (first, far, near, outer) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let mut made = Self { low, size, first, far, near, outer };
        let mut level = vec![UVec3::ZERO];
        for depth in 0..=DEEPEST {
            let edge = size / f64::from(1u32 << depth);
            let seen = blocks(level.len(), threads, monitor, &|i| {
                let centre = low + edge * (level[i].as_dvec3() + 0.5);
                let found = tree.nearest_one::<SquaredEuclidean>(&centre.to_array());
                (found.distance.sqrt(), found.item as u32)
            })?;
            let base = (made.first.len() + level.len()) as u32;
            let mut next = Vec::new();
            for (cell, (far, near)) in level.iter().zip(seen) {
                let wide = edge > CELL * spacing[near as usize] && far < FINE * edge;
                let split = wide && depth < DEEPEST;
                made.first.push(if split { base + next.len() as u32 } else { NONE });
                made.far.push(far as f32);
                made.near.push(near);
                made.outer.push(cell.min_element() == 0 || cell.max_element() == (1 << depth) - 1);
                if split {
                    let corner = |c: u32| UVec3::new(c & 1, (c >> 1) & 1, c >> 2);
                    next.extend((0..8).map(|c| 2 * *cell + corner(c)));
                }
            }
            level = next;
        }
        Ok(made)
    }

    /// The leaf at a place.
    fn at(&self, p: DVec3) -> u32 {
        let (mut cell, mut low, mut edge) = (0, self.low, self.size);
        while self.first[cell as usize] != NONE {
            edge *= 0.5;
            let up = (p - low).cmpge(DVec3::splat(edge));
            cell = self.first[cell as usize] + up.bitmask();
            low += edge * DVec3::select(up, DVec3::ONE, DVec3::ZERO);
        }
        cell
    }

    /// The open leaves, and for each cell its number among them.
    fn open(&self, spacing: &[f64]) -> (Vec<u32>, Vec<u32>) {
        let is = |i: usize| {
            let least = OPEN * spacing[self.near[i] as usize];
            self.first[i] == NONE && f64::from(self.far[i]) > least
        };
        let open: Vec<u32> = (0..self.far.len()).filter(|&i| is(i)).map(|i| i as u32).collect();
        let mut number = vec![NONE; self.far.len()];
        open.iter().enumerate().for_each(|(n, &i)| number[i as usize] = n as u32);
        (open, number)
    }

    /// All pairs of open leaves with a common face, by their numbers.
    fn touching(&self, number: &[u32]) -> Vec<[u32; 2]> {
        let mut pairs = Vec::new();
        for &first in self.first.iter().filter(|&&f| f != NONE) {
            for axis in [1, 2, 4] {
                for c in (0..8).filter(|c| c & axis == 0) {
                    self.across(first + c, first + (c | axis), axis, number, &mut pairs);
                }
            }
        }
        pairs
    }

    /// The pairs of leaves on the two sides of the face between two cells.
    fn across(&self, a: u32, b: u32, axis: u32, number: &[u32], pairs: &mut Vec<[u32; 2]>) {
        let [inner, outer] = [a, b].map(|c| self.first[c as usize]);
        if inner == NONE && outer == NONE {
            let both = [number[a as usize], number[b as usize]];
            pairs.extend((!both.contains(&NONE)).then_some(both));
            return;
        }
        for c in (0..8).filter(|c| c & axis == 0) {
            let a = if inner == NONE { a } else { inner + (c | axis) };
            let b = if outer == NONE { b } else { outer + c };
            self.across(a, b, axis, number, pairs);
        }
    }
}

/// The contours, grown until every open leaf belongs to one.
struct Flood {
    label: Vec<u32>,
    roots: Roots,
    /// Where two met: an open leaf and the two.
    met: Vec<(u32, u32, u32)>,
}

impl Flood {
    fn new(cells: &Cells, open: &[u32], graph: &Graph, monitor: &Monitor) -> Result<Self> {
        let far = |i: usize| cells.far[open[i] as usize];
        let mut order: Vec<u32> = (0..open.len() as u32).collect();
        order
            .sort_unstable_by(|&a, &b| far(b as usize).total_cmp(&far(a as usize)).then(a.cmp(&b)));
        let mut made =
            Self { label: vec![NONE; open.len()], roots: Roots::default(), met: Vec::new() };
        let mut peaks: Vec<f32> = Vec::new();
        let mut around: Vec<u32> = Vec::new();
        let mut outside = None;
        for (k, &cell) in order.iter().enumerate() {
            if k % 65536 == 0 {
                monitor.check()?;
            }
            let i = cell as usize;
            let labelled = graph.of(i).iter().filter(|&&q| made.label[q as usize] != NONE);
            let highest = labelled
                .max_by(|&&a, &&b| far(a as usize).total_cmp(&far(b as usize)).then(b.cmp(&a)));
            made.label[i] = match highest {
                Some(&q) => made.label[q as usize],
                None => {
                    peaks.push(far(i));
                    made.roots.add()
                }
            };
            if cells.outer[open[i] as usize] {
                // One contour starts all around in the bounding space.
                let (own, all) = (made.label[i], *outside.get_or_insert(made.label[i]));
                made.join(own, all, &mut peaks);
            }
            around.clear();
            for &q in graph.of(i) {
                if made.label[q as usize] != NONE {
                    around.push(made.roots.root(made.label[q as usize]));
                }
            }
            around.sort_unstable();
            around.dedup();
            let mut one = made.roots.root(made.label[i]);
            for &other in &around {
                let other = made.roots.root(other);
                if other == one {
                    continue;
                }
                let lower = peaks[one as usize].min(peaks[other as usize]);
                if f64::from(far(i)) < SHALLOW * f64::from(lower) {
                    made.met.push((cell, one, other));
                } else {
                    one = made.join(one, other, &mut peaks);
                }
            }
        }
        Ok(made)
    }

    /// Makes two contours one; gives it.
    fn join(&mut self, a: u32, b: u32, peaks: &mut [f32]) -> u32 {
        let (a, b) = (self.roots.root(a), self.roots.root(b));
        let higher = peaks[a as usize].max(peaks[b as usize]);
        self.roots.join(a, b);
        peaks[a.min(b) as usize] = higher;
        a.min(b)
    }

    fn contour(&mut self, open: usize) -> u32 {
        self.roots.root(self.label[open])
    }
}

/// For each contour whether it is inside, as far as that follows from the points between them. The
/// pairs with most points between them come first.
fn sides(contours: &[[Option<u32>; 2]], outside: u32) -> BTreeMap<u32, bool> {
    let mut between: BTreeMap<[u32; 2], usize> = BTreeMap::new();
    for pair in contours {
        if let [Some(a), Some(b)] = *pair {
            if a != b {
                *between.entry([a.min(b), a.max(b)]).or_default() += 1;
            }
        }
    }
    let mut pairs: Vec<([u32; 2], usize)> = between.into_iter().collect();
    pairs.sort_by_key(|p| (std::cmp::Reverse(p.1), p.0));
    let most = pairs.iter().map(|p| p.0[1] as usize + 1).max().unwrap_or(0);
    let mut roots = Roots::new(most);
    let mut walls: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    for ([a, b], _) in pairs {
        if roots.join(a, b) {
            walls.entry(a).or_default().push(b);
            walls.entry(b).or_default().push(a);
        }
    }
    let mut inside = BTreeMap::from([(outside, false)]);
    let mut queue = VecDeque::from([outside]);
    while let Some(c) = queue.pop_front() {
        let side = inside[&c];
        for &other in walls.get(&c).map_or(&[][..], |w| w) {
            inside.entry(other).or_insert_with(|| {
                queue.push_back(other);
                !side
            });
        }
    }
    inside
}

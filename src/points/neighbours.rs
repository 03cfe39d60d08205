//! The nearest neighbours of every point, and how far apart points lie around it.

use crate::error::Result;
use crate::parallel;
use crate::progress::Monitor;
use glam::DVec3;
use kiddo::{ImmutableKdTree, SquaredEuclidean};
use std::collections::BTreeMap;
use std::num::NonZeroUsize;

/// Neighbours kept for each point: on an even cloud they reach 2.3 spacings far, which is more than
/// the longest edge of a star (`surface::RADIUS`).
pub const COUNT: usize = 20;
/// The neighbour whose distance is the spacing: on an even cloud a point has six at one spacing.
const RING: usize = 6;
/// Points handled in one piece of work.
const BLOCK: usize = 4096;

/// The nearest neighbours of every point, nearest first, the point itself left out.
#[derive(Debug, Clone)]
pub struct Neighbours {
    starts: Vec<u32>,
    ids: Vec<u32>,
}

impl Neighbours {
    /// Finds them: n log n.
    pub fn new(points: &[DVec3], threads: usize, monitor: &Monitor) -> Result<Self> {
        let entries: Vec<[f64; 3]> = points.iter().map(|p| p.to_array()).collect();
        let tree: ImmutableKdTree<f64, 3> = ImmutableKdTree::new_from_slice(&entries);
        let wanted = NonZeroUsize::new(COUNT + 1).unwrap_or(NonZeroUsize::MIN);
        let found = blocks(points.len(), threads, monitor, &|i| {
            let mut near: Vec<(f64, u32)> = tree
                .nearest_n::<SquaredEuclidean>(&entries[i], wanted)
                .iter()
                .map(|n| (n.distance, n.item as u32))
                .filter(|n| n.1 != i as u32)
                .collect();
            near.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            near.truncate(COUNT);
            near.into_iter().map(|n| n.1)
        })?;
        let mut all = Self { starts: vec![0], ids: Vec::with_capacity(points.len() * COUNT) };
        for ids in found {
            all.ids.extend(ids);
            all.starts.push(all.ids.len() as u32);
        }
        Ok(all)
    }

    /// Of one point.
    pub fn of(&self, i: usize) -> &[u32] {
        &self.ids[self.starts[i] as usize..self.starts[i + 1] as usize]
    }

    /// The lists without the points that are not `kept`, which are left out of the numbering, too.
    pub fn thinned(&self, kept: &[bool]) -> Self {
        let mut number = vec![0; kept.len()];
        let mut count = 0;
        for (n, &k) in number.iter_mut().zip(kept) {
            *n = count;
            count += u32::from(k);
        }
        let mut all = Self { starts: vec![0], ids: Vec::with_capacity(self.ids.len()) };
        for i in (0..kept.len()).filter(|&i| kept[i]) {
            let near = self.of(i).iter().filter(|&&q| kept[q as usize]);
            all.ids.extend(near.map(|&q| number[q as usize]));
            all.starts.push(all.ids.len() as u32);
        }
        all
    }

    /// The lists with those added that have a point in theirs: where the points suddenly lie closer,
    /// the nearest of the last of the sparse ones are all on the dense side.
    pub fn mutual(&self) -> Self {
        let count = self.starts.len() - 1;
        let missing = |i: usize, q: u32| !self.of(q as usize).contains(&(i as u32));
        let mut more = vec![0u32; count + 1];
        for i in 0..count {
            for &q in self.of(i).iter().filter(|&&q| missing(i, q)) {
                more[q as usize] += 1;
            }
        }
        let mut starts = vec![0u32; count + 1];
        for i in 0..count {
            starts[i + 1] = starts[i] + self.of(i).len() as u32 + more[i];
        }
        let mut ids = vec![0; starts[count] as usize];
        let mut free = Vec::with_capacity(count);
        for i in 0..count {
            let (at, own) = (starts[i] as usize, self.of(i));
            ids[at..at + own.len()].copy_from_slice(own);
            free.push(at + own.len());
        }
        for i in 0..count {
            for &q in self.of(i).iter().filter(|&&q| missing(i, q)) {
                ids[free[q as usize]] = i as u32;
                free[q as usize] += 1;
            }
        }
        Self { starts, ids }
    }

    /// For each of the `wanted` points all that have it in their lists, beyond its own.
    pub fn named_by(&self, wanted: &[bool]) -> BTreeMap<u32, Vec<u32>> {
        let mut all: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
        for i in 0..self.starts.len() - 1 {
            for &q in self.of(i).iter().filter(|&&q| wanted[q as usize]) {
                if !self.of(q as usize).contains(&(i as u32)) {
                    all.entry(q).or_default().push(i as u32);
                }
            }
        }
        all
    }

    /// For each point the distance of its sixth neighbour, or the last there is.
    pub fn reach(&self, points: &[DVec3]) -> Vec<f64> {
        let reach = |i: usize| match self.of(i) {
            [] => 0.0,
            near => points[near[RING.min(near.len()) - 1] as usize].distance(points[i]),
        };
        (0..points.len()).map(reach).collect()
    }

    /// The spacing around each point: the middle one of the reaches of the point and its neighbours,
    /// so that the rim of a hole, where a half-disc has to give six neighbours, does not count. Where
    /// the points are known to be `sparse` the own reach, if that is more: most of the neighbours are beyond
    /// the sparse place.
    pub fn spacing(&self, reach: &[f64], sparse: &[bool]) -> Vec<f64> {
        let mut all = Vec::with_capacity(COUNT + 1);
        (0..reach.len())
            .map(|i| {
                all.clear();
                all.push(reach[i]);
                all.extend(self.of(i).iter().map(|&q| reach[q as usize]));
                let middle = all.len() / 2;
                let middle = *all.select_nth_unstable_by(middle, f64::total_cmp).1;
                if sparse[i] {
                    middle.max(reach[i])
                } else {
                    middle
                }
            })
            .collect()
    }
}

/// The neighbours of every point, by edges.
pub struct Graph {
    starts: Vec<u32>,
    ids: Vec<u32>,
}

impl Graph {
    /// Of one point.
    pub fn of(&self, i: usize) -> &[u32] {
        &self.ids[self.starts[i] as usize..self.starts[i + 1] as usize]
    }

    /// From edges between so many points.
    pub fn new(count: usize, edges: &[[u32; 2]]) -> Self {
        let mut starts = vec![0u32; count + 1];
        edges.iter().flatten().for_each(|&v| starts[v as usize + 1] += 1);
        for i in 1..starts.len() {
            starts[i] += starts[i - 1];
        }
        let mut free = starts.clone();
        let mut ids = vec![0; 2 * edges.len()];
        for &[a, b] in edges {
            for (from, to) in [(a, b), (b, a)] {
                ids[free[from as usize] as usize] = to;
                free[from as usize] += 1;
            }
        }
        Self { starts, ids }
    }
}

/// `f` of every index, in order, worked on side by side.
pub fn blocks<T: Send>(
    count: usize,
    threads: usize,
    monitor: &Monitor,
    f: &(dyn Fn(usize) -> T + Sync),
) -> Result<Vec<T>> {
    let threads = parallel::thread_count(threads);
    let made = parallel::map(count.div_ceil(BLOCK), threads, &|| monitor.check(), &|b| {
        (b * BLOCK..count.min((b + 1) * BLOCK)).map(f).collect::<Vec<T>>()
    })?;
    let mut all = Vec::with_capacity(count);
    made.into_iter().for_each(|block| all.extend(block));
    Ok(all)
}

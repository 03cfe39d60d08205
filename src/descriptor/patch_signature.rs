//! Signatures of patches and the search for similar ones (Harary, Tal and Grinspun 2014,
//! "Context-based coherent surface completion", section 4).
//!
//! Differences from the paper:
//! - Averages are over area, not over vertices, so that the density of the mesh does not count.
//! - The search is among the leading principal components ([`SEARCH_DIMENSIONS`]).
//! - The square of the signature is interpolated like the signature itself, so the variance counts
//!   a little of that within coarse triangles.

use super::ball::{Balls, VertexGraph};
use super::heat::Heat;
use super::principal::principal_axes;
use super::prolong::Prolongation;
use crate::error::Result;
use crate::progress::Monitor;
use glam::DVec3;
use std::collections::BinaryHeap;

/// Principal components that the search looks at. Measured: with 12 the right patch is found as often
/// as with all 100 entries, with 6 nearly so; `docs/spectrum.md`.
pub const SEARCH_DIMENSIONS: usize = 12;
/// Patches between two looks at the monitor: some 10 ms.
const BEAT: usize = 256;
/// Sources compared at a time: 12 · 1024 numbers stay in the first-level cache.
const BLOCK: usize = 1024;

/// Part of the time domain that the paper's descriptor looks at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Domain {
    /// All times.
    Whole,
    /// The lower three quarters.
    LowerThreeQuarters,
    /// The lower half.
    LowerHalf,
}

impl Domain {
    /// All three, in the paper's order.
    pub const ALL: [Self; 3] = [Self::Whole, Self::LowerThreeQuarters, Self::LowerHalf];

    fn count(self, times: usize) -> usize {
        match self {
            Self::Whole => times,
            Self::LowerThreeQuarters => 3 * times / 4,
            Self::LowerHalf => times / 2,
        }
    }
}

/// One vector for each of a number of patches.
#[derive(Debug, Clone, Default)]
pub struct Signatures {
    /// Length of a vector.
    pub dim: usize,
    /// The vectors, one after the other.
    pub rows: Vec<f32>,
}

impl Signatures {
    /// Number of patches.
    pub fn len(&self) -> usize {
        self.rows.len() / self.dim.max(1)
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// The vector of patch `i`.
    pub fn row(&self, i: usize) -> &[f32] {
        &self.rows[i * self.dim..(i + 1) * self.dim]
    }

    fn from_rows(dim: usize, count: usize, mut fill: impl FnMut(usize, &mut [f32])) -> Self {
        let mut rows = vec![0.0; dim * count];
        rows.chunks_exact_mut(dim.max(1)).enumerate().for_each(|(i, row)| fill(i, row));
        Self { dim, rows }
    }
}

/// Mean and variance of the heat kernel signature over patches.
#[derive(Debug, Clone, Default)]
pub struct Moments {
    times: usize,
    /// Rows of `times` means, then as many variances.
    rows: Vec<f64>,
}

/// What patches are described with.
#[derive(Clone, Copy)]
pub struct Surface<'a> {
    /// Vertices of the fine mesh.
    pub positions: &'a [DVec3],
    /// Its edges.
    pub graph: &'a VertexGraph,
    /// Area of each vertex, in square mesh units.
    pub mass: &'a [f64],
    /// Way from the coarse mesh to the fine one.
    pub prolongation: &'a Prolongation,
}

impl Moments {
    /// Over the patches of `radius` (mesh units) around fine vertices.
    pub fn new(
        surface: Surface<'_>,
        heat: &Heat,
        centres: &[u32],
        radius: f64,
        monitor: &Monitor,
    ) -> Result<Self> {
        let times = heat.times.len();
        let mut rows = vec![0.0; 2 * times * centres.len()];
        let mut balls = Balls::new(surface.positions, surface.graph);
        let mut patch = Vec::new();
        // The mean is a sum over few coarse vertices: how much each counts, and which they are.
        let mut share = vec![0.0; heat.values.len() / times.max(1)];
        let mut used: Vec<usize> = Vec::new();
        for (i, (&centre, row)) in
            centres.iter().zip(rows.chunks_exact_mut((2 * times).max(1))).enumerate()
        {
            if i % BEAT == 0 {
                monitor.check()?;
            }
            balls.gather(centre, radius, &mut patch);
            let mut sum = 0.0;
            for &v in &patch {
                let mass = surface.mass[v as usize].max(f64::MIN_POSITIVE);
                for (c, w) in surface.prolongation.row(v as usize) {
                    if share[c] == 0.0 {
                        used.push(c);
                    }
                    share[c] += mass * w;
                    sum += mass * w;
                }
            }
            let (mean, variance) = row.split_at_mut(times);
            for c in used.drain(..) {
                let part = std::mem::take(&mut share[c]) / sum;
                let row = heat.row(c);
                mean.iter_mut().zip(row).for_each(|(m, h)| *m += part * h);
                variance.iter_mut().zip(row).for_each(|(s, h)| *s += part * h * h);
            }
            variance.iter_mut().zip(mean).for_each(|(s, m)| *s = (*s - *m * *m).max(0.0));
        }
        Ok(Self { times, rows })
    }

    /// Number of patches.
    pub fn len(&self) -> usize {
        self.rows.len() / (2 * self.times).max(1)
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// The mean over patch `i` at each time, in 1/(square mesh unit).
    pub fn mean(&self, i: usize) -> &[f64] {
        &self.rows[2 * i * self.times..][..self.times]
    }

    /// The variance over patch `i` at each time, in the square of that.
    pub fn variance(&self, i: usize) -> &[f64] {
        &self.rows[(2 * i + 1) * self.times..][..self.times]
    }

    /// Mean and variance in a time domain, the greatest of each scaled to 1. Times should be evenly
    /// spaced.
    pub fn paper(&self, domain: Domain) -> Signatures {
        let count = domain.count(self.times);
        Signatures::from_rows(2 * count, self.len(), |i, row| {
            let (a, b) = row.split_at_mut(count);
            for (part, values) in [(a, self.mean(i)), (b, self.variance(i))] {
                let values = &values[..count];
                let most = values.iter().fold(f64::MIN_POSITIVE, |m, x| m.max(x.abs()));
                part.iter_mut().zip(values).for_each(|(p, x)| *p = (x / most) as f32);
            }
        })
    }
}

/// Signatures ready to be searched.
pub struct Index {
    source: Signatures,
    /// Mean of the sources.
    mean: Vec<f64>,
    /// Principal directions as rows.
    axes: Vec<Vec<f64>>,
    /// Components of the sources: all first ones, all second ones, ...
    columns: Vec<Vec<f32>>,
}

/// A source patch and how far its signature is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Neighbour {
    /// Number among the sources.
    pub source: u32,
    /// Squared distance of the components in use.
    pub distance: f32,
}

impl Eq for Neighbour {}

impl PartialOrd for Neighbour {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Neighbour {
    /// By distance, then by number.
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        let by_distance = self.distance.total_cmp(&other.distance);
        by_distance.then(self.source.cmp(&other.source))
    }
}

impl Index {
    /// Principal components of the sources, at most `dimensions`.
    pub fn new(source: Signatures, dimensions: usize, monitor: &Monitor) -> Result<Self> {
        let (n, dim) = (source.len(), source.dim);
        let mut mean = vec![0.0; dim];
        for i in 0..n {
            mean.iter_mut().zip(source.row(i)).for_each(|(m, x)| *m += f64::from(*x));
        }
        mean.iter_mut().for_each(|m| *m /= n.max(1) as f64);
        let centred = |i: usize, out: &mut [f64]| {
            for k in 0..dim {
                out[k] = f64::from(source.row(i)[k]) - mean[k];
            }
        };
        let axes = principal_axes(dim, dimensions, n, centred, monitor)?;
        let mut index = Self { source, mean, axes, columns: Vec::new() };
        index.columns = vec![vec![0.0; n]; index.axes.len()];
        let mut components = vec![0.0; index.axes.len()];
        for i in 0..n {
            if i % BEAT == 0 {
                monitor.check()?;
            }
            index.project(index.source.row(i), &mut components);
            index.columns.iter_mut().zip(&components).for_each(|(c, x)| c[i] = *x);
        }
        Ok(index)
    }

    fn project(&self, row: &[f32], components: &mut [f32]) {
        let centred: Vec<f64> =
            row.iter().zip(&self.mean).map(|(x, m)| f64::from(*x) - m).collect();
        for (component, axis) in components.iter_mut().zip(&self.axes) {
            *component = centred.iter().zip(axis).map(|(x, a)| x * a).sum::<f64>() as f32;
        }
    }

    /// Number of sources.
    pub fn len(&self) -> usize {
        self.source.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.source.is_empty()
    }

    /// For each target the `k` nearest sources, nearest first, ties by number. Both must be the
    /// same kind of signature.
    pub fn nearest(
        &self,
        targets: &Signatures,
        k: usize,
        monitor: &Monitor,
    ) -> Result<Vec<Vec<Neighbour>>> {
        let mut components = vec![0.0; self.axes.len()];
        let mut distance = [0f32; BLOCK];
        let mut all = Vec::with_capacity(targets.len());
        for t in 0..targets.len() {
            if t % 16 == 0 {
                monitor.check()?;
            }
            self.project(targets.row(t), &mut components);
            // The greatest of the best on top.
            let mut best: BinaryHeap<Neighbour> = BinaryHeap::with_capacity(k + 1);
            for from in (0..self.len()).step_by(BLOCK) {
                let to = (from + BLOCK).min(self.len());
                let distance = &mut distance[..to - from];
                distance.fill(0.0);
                for (column, x) in self.columns.iter().zip(&components) {
                    (distance.iter_mut().zip(&column[from..to]))
                        .for_each(|(d, y)| *d += (x - y) * (x - y));
                }
                for (i, &d) in distance.iter().enumerate() {
                    let new = Neighbour { source: (from + i) as u32, distance: d };
                    if best.len() < k {
                        best.push(new);
                    } else if best.peek().is_some_and(|worst| new < *worst) {
                        best.pop();
                        best.push(new);
                    }
                }
            }
            all.push(best.into_sorted_vec());
        }
        Ok(all)
    }
}

//! Boykov, Veksler, Zabih (2001), "Fast approximate energy minimization via graph cuts": which copy
//! gives the detail at each vertex, so that seams run where the copies agree.
//!
//! Minimises Σ_i unary(i, l_i) + Σ_edges (|p_i^a − p_i^b| + |p_j^a − p_j^b|), a and b the labels of
//! the edge's ends, by α-expansion. The flow is Dinic's.
//!
//! Differences from the paper: two rounds over the labels at most, best first; a third changes
//! nothing to speak of.

use crate::error::Result;
use crate::matching::paint::squared_difference;
use std::collections::VecDeque;

/// Rounds over all labels.
const ROUNDS: usize = 2;

/// What is to be minimised.
pub struct Energy<'a> {
    /// Cost of label l at vertex i: `unary[l][i]`; infinite where it must not be.
    pub unary: &'a [Vec<f64>],
    /// Value of label l at vertex i; seams cost their differences.
    pub values: &'a [Vec<f64>],
    /// The same for colours, rows of so many numbers in the unit of the values; none: empty.
    pub rows: (&'a [Vec<f64>], usize),
    /// Pairs of neighbours.
    pub edges: &'a [(u32, u32)],
}

impl Energy<'_> {
    fn seam(&self, i: u32, j: u32, a: usize, b: usize) -> f64 {
        if a == b {
            return 0.0;
        }
        let at = |v: u32| (self.values[a][v as usize] - self.values[b][v as usize]).abs();
        let (rows, channels) = self.rows;
        if rows.is_empty() {
            return at(i) + at(j);
        }
        let row = |l: usize, v: u32| &rows[l][v as usize * channels..][..channels];
        let stain = |v: u32| squared_difference(row(a, v), row(b, v)).sqrt();
        at(i) + at(j) + stain(i) + stain(j)
    }

    /// The energy of a labelling.
    pub fn of(&self, labels: &[usize]) -> f64 {
        let unary: f64 = labels.iter().enumerate().map(|(i, &l)| self.unary[l][i]).sum();
        let seams: f64 = self
            .edges
            .iter()
            .map(|&(i, j)| self.seam(i, j, labels[i as usize], labels[j as usize]))
            .sum();
        unary + seams
    }

    /// A labelling with (locally) least energy, started from another. Labels are offered in the order
    /// given.
    pub fn minimise(
        &self,
        mut labels: Vec<usize>,
        order: &[usize],
        check: &dyn Fn() -> Result<()>,
    ) -> Result<Vec<usize>> {
        let mut energy = self.of(&labels);
        for _ in 0..ROUNDS {
            let before = energy;
            for &alpha in order {
                check()?;
                let moved = self.expand(&labels, alpha, check)?;
                let better = self.of(&moved);
                if better < energy {
                    (labels, energy) = (moved, better);
                }
            }
            if energy >= before * (1.0 - 1e-6) {
                break;
            }
        }
        Ok(labels)
    }

    /// The best labelling in which each vertex keeps its label or takes α. A vertex on the source's
    /// side keeps, on the sink's side takes α.
    fn expand(
        &self,
        labels: &[usize],
        alpha: usize,
        check: &dyn Fn() -> Result<()>,
    ) -> Result<Vec<usize>> {
        // Where α must not be, all is as it is.
        let mut number = vec![usize::MAX; labels.len()];
        let free: Vec<usize> =
            (0..labels.len()).filter(|&i| self.unary[alpha][i].is_finite()).collect();
        free.iter().enumerate().for_each(|(k, &i)| number[i] = k);
        let n = free.len();
        let mut flow = Flow::new(n + 2);
        let (source, sink) = (n, n + 1);
        let mut keep: Vec<f64> =
            labels.iter().enumerate().map(|(i, &l)| self.unary[l][i]).collect();
        let mut take: Vec<f64> = self.unary[alpha].clone();
        for &(i, j) in self.edges {
            let ends = [i, j].map(|v| number[v as usize]);
            if ends == [usize::MAX; 2] {
                continue;
            }
            let (a, b) = (labels[i as usize], labels[j as usize]);
            let both = self.seam(i, j, a, b);
            let only_j = self.seam(i, j, a, alpha);
            let only_i = if a == b { only_j } else { self.seam(i, j, alpha, b) };
            // θ(keep, keep) = both, θ(keep, take) = only_j, θ(take, keep) = only_i, θ(take, take) = 0.
            keep[i as usize] += both;
            take[i as usize] += only_i;
            if ends[1] == usize::MAX {
                continue;
            }
            if ends[0] == usize::MAX {
                keep[j as usize] += both;
                take[j as usize] += only_j;
                continue;
            }
            keep[j as usize] += 0.0;
            take[j as usize] -= only_i;
            let cross = (only_j + only_i - both).max(0.0);
            flow.add(ends[0], ends[1], cross, 0.0);
        }
        for (k, &i) in free.iter().enumerate() {
            // Keeping cuts the edge to the sink, taking that from the source.
            let least = keep[i].min(take[i]);
            flow.add(source, k, take[i] - least, 0.0);
            flow.add(k, sink, keep[i] - least, 0.0);
        }
        let kept = flow.source_side(source, sink, check)?;
        let mut moved = labels.to_vec();
        free.iter().enumerate().filter(|&(k, _)| !kept[k]).for_each(|(_, &i)| moved[i] = alpha);
        Ok(moved)
    }
}

/// Maximum flow (Dinic 1970).
struct Flow {
    first: Vec<u32>,
    next: Vec<u32>,
    to: Vec<u32>,
    left: Vec<f64>,
}

const END: u32 = u32::MAX;

impl Flow {
    fn new(n: usize) -> Self {
        Self { first: vec![END; n], next: vec![], to: vec![], left: vec![] }
    }

    fn add(&mut self, a: usize, b: usize, forth: f64, back: f64) {
        for (from, to, capacity) in [(a, b, forth), (b, a, back)] {
            self.next.push(self.first[from]);
            self.first[from] = self.to.len() as u32;
            self.to.push(to as u32);
            self.left.push(capacity);
        }
    }

    /// Levels from the source along edges with capacity left.
    fn levels(&self, source: usize) -> Vec<u32> {
        let mut level = vec![END; self.first.len()];
        level[source] = 0;
        let mut queue = VecDeque::from([source]);
        while let Some(v) = queue.pop_front() {
            let mut e = self.first[v];
            while e != END {
                let w = self.to[e as usize] as usize;
                if self.left[e as usize] > 0.0 && level[w] == END {
                    level[w] = level[v] + 1;
                    queue.push_back(w);
                }
                e = self.next[e as usize];
            }
        }
        level
    }

    /// Which nodes stay with the source in a minimum cut.
    fn source_side(
        &mut self,
        source: usize,
        sink: usize,
        check: &dyn Fn() -> Result<()>,
    ) -> Result<Vec<bool>> {
        let total: f64 = self.left.iter().sum();
        loop {
            check()?;
            let level = self.levels(source);
            if level[sink] == END {
                return Ok(level.iter().map(|&l| l != END).collect());
            }
            let mut at = self.first.clone();
            while self.augment(source, sink, &level, &mut at, total * 1e-12) {}
        }
    }

    /// One path from source to sink over rising levels; amounts below `dust` are rounding.
    fn augment(
        &mut self,
        source: usize,
        sink: usize,
        level: &[u32],
        at: &mut [u32],
        dust: f64,
    ) -> bool {
        let mut path: Vec<u32> = Vec::new();
        let mut v = source;
        while v != sink {
            let e = at[v];
            if e == END {
                let Some(back) = path.pop() else { return false };
                v = self.to[back as usize ^ 1] as usize;
                at[v] = self.next[at[v] as usize];
                continue;
            }
            let w = self.to[e as usize] as usize;
            if self.left[e as usize] > 0.0 && level[w] == level[v] + 1 {
                path.push(e);
                v = w;
            } else {
                at[v] = self.next[e as usize];
            }
        }
        let amount = path.iter().map(|&e| self.left[e as usize]).fold(f64::INFINITY, f64::min);
        for &e in &path {
            let e = e as usize;
            self.left[e] -= amount;
            if self.left[e] <= dust {
                self.left[e] = 0.0;
            }
            self.left[e ^ 1] += amount;
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A chain of four with three labels, some of which must not be: every labelling is tried.
    #[test]
    fn no_labelling_of_a_chain_is_better() {
        let noise = |s: usize| ((s * 7919 + 13) % 101) as f64 / 101.0;
        for seed in 0..20 {
            let table = |k: usize| -> Vec<Vec<f64>> {
                (0..3).map(|l| (0..4).map(|i| noise(seed * 64 + k + 4 * l + i)).collect()).collect()
            };
            let (mut unary, values) = (table(0), table(31));
            // Label 0, the first, may be everywhere.
            for k in 0..seed % 4 {
                unary[1 + k % 2][(seed + k) % 4] = f64::INFINITY;
            }
            let edges = [(0, 1), (1, 2), (2, 3)];
            let energy = Energy { unary: &unary, values: &values, rows: (&[], 0), edges: &edges };
            let found = energy.of(&energy.minimise(vec![0; 4], &[0, 1, 2], &|| Ok(())).unwrap());
            let all = (0..81).map(|c| energy.of(&[c % 3, c / 3 % 3, c / 9 % 3, c / 27]));
            let best = all.fold(f64::INFINITY, f64::min);
            // Expansion moves promise a factor of two; on a chain they nearly always find the best.
            assert!(found <= best * 1.1 + 1e-12, "{found} {best}");
        }
    }
}

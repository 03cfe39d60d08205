//! Park, Guo, Shin, Qin (2006), "Surface completion for shape and appearance", Eq. 13 to 15: what
//! the vertices carry (colours, any numbers) copied from where the shape was copied from, the seams
//! closed by the Poisson equation.
//!
//! Minimises, over the values x of the new vertices with those of the rim fixed,
//!
//!   Σ_edges (x_i − x_j − α g_ij)²  +  Σ_fill α ε (x_i − s_i)²
//!
//! with s the copied values, g_ij = s_i − s_j as the copy has it, and α the trust in the copy. Solved, as
//! Eq. 15, for the correction x − s, which is nothing where the copy fits.
//!
//! Differences from the paper:
//! - Copied values are interpolated on the source's faces, not taken from the nearest point.
//! - A fill may have several copies. Across their borders g is the mean of what both copies say.
//! - The trust α (`trust`): 1 where a copy has on the ring what is known there, down to 0, a harmonic
//!   fill, where it has not. The paper copies whatever was found.
//! - The screen ε: values whose mean is wrong at the rim fade into the copied ones instead of flooding
//!   the fill.
//! - Weights are 1: the correction is smooth, and the positions are not needed.
//! - A vertex without a source has no g and no s: there the values are harmonic.

use super::factor::Symmetric;
use super::join::MOST_GAIN;
use crate::mesh::FaceView;
use crate::options::{Appearance, Exemplar};
use crate::result::{Completion, Seam, NONE};
use std::collections::{BTreeMap, HashMap, HashSet};
use std::ops::Range;

/// Length over which a wrong value at the rim fades, in radii of a round hole of so many vertices.
const FADE: f64 = 0.5;
/// Radius of a round hole of one vertex on a mesh of equilateral triangles, in edges.
const RADIUS: f64 = 0.525;
/// ε of a fading length of one edge: what the sum over six neighbours is to the Laplacian.
const SCREEN: f64 = 1.5;

/// Root of the share of the ring's variance that a copy leaves, up to which it is believed whole, and from
/// which on not at all: where shape is trusted alone, and where the plate has its full say.
pub const TRUSTED: (f64, f64) = (0.5, 0.8);
/// What is not seen: differences of this part of the range, 8 of 255.
const UNSEEN: f64 = 0.03;
/// Weight of an edge to a rim vertex that values do not go on from: only where no other says anything is it heard.
const LOOSE: f64 = 1e-6;
/// Fewer vertices of the ring than this say nothing.
const LEAST: usize = 12;

/// What is known: a row of numbers for each vertex.
pub trait Known {
    /// The numbers of a row.
    fn channels(&self) -> usize;
    /// Whether the channel belongs to the one before it, as green does to red: they are believed or not
    /// together.
    fn goes_with_last(&self, channel: usize) -> bool;
    /// The row of an input vertex on the rim or the ring.
    fn vertex(&self, vertex: u32) -> &[f64];
    /// The rows of the corners of a source face; `None` if nothing is known there.
    fn corners(&self, face: u32) -> Option<[&[f64]; 3]>;
    /// Least and greatest number of a channel: the new ones stay between.
    fn range(&self, channel: usize) -> [f64; 2];
}

/// The rows of all new vertices, one after the other; `None` if the system cannot be factored.
pub fn complete_rows(completion: &Completion, known: &dyn Known) -> Option<Vec<f64>> {
    let (n, channels) = (completion.vertices.len(), known.channels());
    if n == 0 || channels == 0 {
        return Some(Vec::new());
    }
    let mut guide = Guide::new(completion, known);
    let edges = edges(completion);
    let mut matrix = matrix(completion, &edges);
    let mut corrections = guide.solve(&mut matrix, &edges)?;
    let input = completion.input_vertex_count as u32;
    guide.gains = guide.lost(&edges, &corrections);
    if !guide.gains.is_empty() {
        corrections = guide.solve(&mut matrix, &edges)?;
    }
    let ranges: Vec<[f64; 2]> = (0..channels).map(|c| known.range(c)).collect();
    let mut rows = Vec::with_capacity(n * channels);
    for i in 0..n {
        for (c, range) in ranges.iter().enumerate() {
            let value = guide.base(input + i as u32, c) + corrections[c][i];
            rows.push(value.clamp(range[0], range[1]));
        }
    }
    Some(rows)
}

/// Σ_edges (y_i − y_j)² of the corrections y.
fn matrix(completion: &Completion, edges: &[Edge]) -> Symmetric {
    let n = completion.vertices.len();
    let input = completion.input_vertex_count as u32;
    let mut columns: Vec<Vec<(u32, f64)>> = (0..n).map(|i| vec![(i as u32, 0.0)]).collect();
    for &Edge { i, j, weight } in edges {
        let at = (i - input) as usize;
        columns[at][0].1 += weight;
        if let Some(other) = j.checked_sub(input) {
            let (low, high) = (at.min(other as usize), at.max(other as usize));
            columns[low].push((high as u32, -1.0));
            columns[other as usize][0].1 += 1.0;
        }
    }
    Symmetric::from_columns(columns)
}

/// An edge from a new vertex to another, or to one of the rim.
struct Edge {
    i: u32,
    j: u32,
    weight: f64,
}

/// Edges with a new vertex, each once.
fn edges(completion: &Completion) -> Vec<Edge> {
    let input = completion.input_vertex_count as u32;
    let mut edges: Vec<[u32; 2]> = completion
        .faces
        .iter()
        .flat_map(|f| [[f[0], f[1]], [f[1], f[2]], [f[2], f[0]]])
        .map(|[a, b]| [a.min(b), a.max(b)])
        .filter(|e| e[1] >= input)
        .collect();
    edges.sort_unstable();
    edges.dedup();
    let loose: HashSet<u32> = completion.loose.iter().copied().collect();
    let edge = |[a, b]: [u32; 2]| {
        // The new one of the two, or the first.
        let (i, j) = if a < input { (b, a) } else { (a, b) };
        Edge { i, j, weight: if loose.contains(&j) { LOOSE } else { 1.0 } }
    };
    edges.into_iter().map(edge).collect()
}

/// A copy's rows at the ends of an edge, and its source.
type Said = (usize, usize, u32);

/// What the copies say.
struct Guide<'a> {
    completion: &'a Completion,
    known: &'a dyn Known,
    /// The copied rows, of new vertices and of those beside them.
    rows: Vec<f64>,
    /// Where in `rows`, in rows, the copy of its own source is; `usize::MAX` without one.
    own: Vec<usize>,
    /// The same of another source, by vertex, hole and source.
    beside: HashMap<[u32; 3], usize>,
    /// Channels that are believed together.
    groups: Vec<Range<usize>>,
    /// α by channel, by hole and source.
    trust: BTreeMap<[u32; 2], Vec<f64>>,
    /// What the steps of copies that the ring does not judge are multiplied by, by hole, then channel; 1
    /// where there is none.
    gains: BTreeMap<u32, Vec<f64>>,
}

impl<'a> Guide<'a> {
    fn new(completion: &'a Completion, known: &'a dyn Known) -> Self {
        let (rows, own, beside) = (Vec::new(), Vec::new(), HashMap::new());
        let (groups, trust, gains) = (groups(known), BTreeMap::new(), BTreeMap::new());
        let mut guide = Self { completion, known, rows, own, beside, groups, trust, gains };
        for origin in completion.colours_from() {
            let row = guide.copy(origin.face, origin.barycentric);
            guide.own.push(row.unwrap_or(usize::MAX));
        }
        for hole in &completion.holes {
            for seam in &hole.seams {
                if let Some(row) = guide.copy(seam.face, seam.barycentric) {
                    guide.beside.insert([seam.vertex, hole.hole as u32, seam.source], row);
                }
            }
            for of_copy in hole.ring.chunk_by(|a, b| a.source == b.source) {
                let trust = guide.judge(of_copy);
                guide.trust.insert([hole.hole as u32, of_copy[0].source], trust);
            }
        }
        guide
    }

    /// α by channel of a copy that is seen on the ring.
    fn judge(&mut self, ring: &[Seam]) -> Vec<f64> {
        let first = self.rows.len();
        let mut seen = Vec::new();
        for place in ring {
            if self.copy(place.face, place.barycentric).is_some() {
                seen.push(self.known.vertex(place.vertex));
            }
        }
        let channels = self.known.channels();
        let copied: Vec<&[f64]> = self.rows[first..].chunks_exact(channels).collect();
        let mut of_all = vec![1.0; channels];
        for channels in self.groups.iter().filter(|_| seen.len() >= LEAST) {
            let ranges: Vec<[f64; 2]> = channels.clone().map(|c| self.known.range(c)).collect();
            let alpha = trust(&seen, &copied, channels.clone(), &ranges);
            of_all[channels.clone()].fill(alpha);
        }
        self.rows.truncate(first);
        of_all
    }

    /// α of a copy.
    fn alpha(&self, hole: u32, source: u32, channel: usize) -> f64 {
        self.trust.get(&[hole, source]).map_or(1.0, |t| t[channel])
    }

    /// Interpolates a row on a face.
    fn copy(&mut self, face: u32, weights: [f64; 3]) -> Option<usize> {
        let corners = self.known.corners(face).filter(|_| face != NONE)?;
        let channels = self.known.channels();
        let at = |c: usize| (0..3).map(|k| weights[k] * corners[k][c]).sum::<f64>();
        self.rows.extend((0..channels).map(at));
        Some(self.rows.len() / channels - 1)
    }

    fn value(&self, row: usize, channel: usize) -> f64 {
        self.rows[row * self.known.channels() + channel]
    }

    /// What the correction is added to: the copied value, that of the rim, or 0.
    fn base(&self, v: u32, channel: usize) -> f64 {
        match v.checked_sub(self.completion.input_vertex_count as u32) {
            None => self.known.vertex(v)[channel],
            Some(i) => match self.own[i as usize] {
                usize::MAX => 0.0,
                row => self.value(row, channel),
            },
        }
    }

    /// The row of a source at a vertex.
    fn row(&self, v: u32, hole: u32, source: u32) -> Option<usize> {
        let new = v.checked_sub(self.completion.input_vertex_count as u32);
        match new.map(|i| i as usize) {
            Some(i) if self.completion.colours_from()[i].source == source => {
                Some(self.own[i]).filter(|&row| row != usize::MAX)
            }
            _ => self.beside.get(&[v, hole, source]).copied(),
        }
    }

    /// The hole of an edge, and what the sources of its ends say of it.
    fn said(&self, i: u32, j: u32) -> (u32, [Option<Said>; 2]) {
        let input = self.completion.input_vertex_count as u32;
        let hole = self.completion.vertex_hole[(i - input) as usize];
        let from = self.completion.colours_from();
        let source = |v: u32| Some(from[v.checked_sub(input)? as usize].source);
        let (a, b) = (source(i), source(j));
        let said = [a, b.filter(|_| b != a)].map(|source| {
            let source = source.filter(|&s| s != NONE)?;
            Some((self.row(i, hole, source)?, self.row(j, hole, source)?, source))
        });
        (hole, said)
    }

    /// g of an edge, by channel: the mean over the sources of its ends; 0 if they say nothing.
    fn step(&self, i: u32, j: u32) -> impl Fn(usize) -> f64 + '_ {
        let (hole, said) = self.said(i, j);
        let gains = self.gains.get(&hole);
        move |c| {
            let (mut sum, mut count) = (0.0, 0.0);
            for (x, y, source) in said.into_iter().flatten() {
                let judged = self.trust.contains_key(&[hole, source]);
                let gain = gains.filter(|_| !judged).map_or(1.0, |g| g[c]);
                sum += gain * self.alpha(hole, source, c) * (self.value(x, c) - self.value(y, c));
                count += 1.0;
            }
            sum / f64::max(count, 1.0)
        }
    }

    /// The corrections x − s, by channel.
    fn solve(&self, matrix: &mut Symmetric, edges: &[Edge]) -> Option<Vec<Vec<f64>>> {
        let input = self.completion.input_vertex_count as u32;
        let mut rhs = vec![vec![0.0; self.own.len()]; self.known.channels()];
        for &Edge { i, j, weight } in edges {
            let step = self.step(i, j);
            for (c, rhs) in rhs.iter_mut().enumerate() {
                let lacking = step(c) - (self.base(i, c) - self.base(j, c));
                rhs[(i - input) as usize] += weight * lacking;
                if let Some(other) = j.checked_sub(input) {
                    rhs[other as usize] -= lacking;
                }
            }
        }
        for channels in &self.groups {
            let factor = matrix.factor(1.0, &self.screens(channels.start))?;
            factor.solve(&mut rhs[channels.clone()]);
        }
        Some(rhs)
    }

    /// How many times larger the steps along the rim are than those of copies that the ring does not judge, by hole
    /// and channel; as with detail of shape at most [`MOST_GAIN`]. Such copies are to look right, and are blander than the rim: smooth places differ least
    /// from what is half known, and where copies meet their steps cancel out.
    fn lost(&self, edges: &[Edge], corrections: &[Vec<f64>]) -> BTreeMap<u32, Vec<f64>> {
        let (input, channels) = (self.completion.input_vertex_count as u32, self.known.channels());
        let value = |v: u32, c: usize| {
            self.base(v, c) + v.checked_sub(input).map_or(0.0, |i| corrections[c][i as usize])
        };
        let squares = |a: u32, b: u32, sums: &mut Vec<f64>| {
            sums.resize(channels, 0.0);
            sums.iter_mut()
                .enumerate()
                .for_each(|(c, s)| *s += (value(a, c) - value(b, c)).powi(2));
        };
        let mut made: BTreeMap<u32, (Vec<f64>, usize)> = BTreeMap::new();
        for &Edge { i, j, .. } in edges {
            let (hole, said) = self.said(i, j);
            let judged = |s: Said| self.trust.contains_key(&[hole, s.2]);
            if said.iter().flatten().next().is_some() && !said.into_iter().flatten().any(judged) {
                let (sums, count) = made.entry(hole).or_default();
                squares(i, j, sums);
                *count += 1;
            }
        }
        let mut along: BTreeMap<u32, (Vec<f64>, usize)> = BTreeMap::new();
        for &[a, b, c] in self.completion.faces.iter().filter(|_| !made.is_empty()) {
            for [a, b, c] in [[a, b, c], [b, c, a], [c, a, b]] {
                // An edge of the rim, and a new vertex across.
                if a < input && b < input && c >= input {
                    let hole = self.completion.vertex_hole[(c - input) as usize];
                    let (sums, count) = along.entry(hole).or_default();
                    squares(a, b, sums);
                    *count += 1;
                }
            }
        }
        let gains = |(hole, (sums, count)): (u32, (Vec<f64>, usize))| {
            let mut gains = vec![1.0; channels];
            let Some((rim, rim_count)) = along.get(&hole) else { return (hole, gains) };
            for group in &self.groups {
                let mean =
                    |sums: &[f64], n: usize| sums[group.clone()].iter().sum::<f64>() / n as f64;
                let left = mean(&sums, count).max(f64::MIN_POSITIVE);
                let gain = (mean(rim, *rim_count) / left).sqrt();
                gains[group.clone()].fill(gain.clamp(1.0, MOST_GAIN));
            }
            (hole, gains)
        };
        made.into_iter().map(gains).collect()
    }

    /// α ε of each new vertex.
    fn screens(&self, channel: usize) -> Vec<f64> {
        let mut sizes = vec![0.0; self.completion.holes.len()];
        let hole = |i: usize| self.completion.vertex_hole[i] as usize;
        (0..self.own.len()).for_each(|i| sizes[hole(i)] += 1.0);
        let screen = |i: usize| match self.own[i] {
            usize::MAX => 0.0,
            _ => {
                let from = self.completion.colours_from()[i].source;
                let alpha = self.alpha(hole(i) as u32, from, channel);
                alpha * SCREEN / ((FADE * RADIUS).powi(2) * sizes[hole(i)])
            }
        };
        (0..self.own.len()).map(screen).collect()
    }
}

fn groups(known: &dyn Known) -> Vec<Range<usize>> {
    let mut groups: Vec<Range<usize>> = Vec::new();
    for c in 0..known.channels() {
        match groups.last_mut().filter(|_| known.goes_with_last(c)) {
            Some(group) => group.end = c + 1,
            None => groups.push(c..c + 1),
        }
    }
    groups
}

/// How far to believe a copy: 1 up to ρ = 0.5 and 0 from 0.8 on, ρ what [`unlike`] says.
fn trust(known: &[&[f64]], copied: &[&[f64]], channels: Range<usize>, ranges: &[[f64; 2]]) -> f64 {
    let rho = unlike(known, copied, channels, ranges);
    1.0 - ((rho - TRUSTED.0) / (TRUSTED.1 - TRUSTED.0)).clamp(0.0, 1.0)
}

/// What is known on the ring and what a copy has there, each less its mean (the rim corrects that): with a the
/// known and b the copied rows, ρ² = Σ |a − b|² / Σ |a|². `ranges`: least and greatest of each of `channels`.
pub fn unlike(
    known: &[&[f64]],
    copied: &[&[f64]],
    channels: Range<usize>,
    ranges: &[[f64; 2]],
) -> f64 {
    let n = known.len() as f64;
    let (mut own, mut bare) = (0.0, 0.0);
    for (c, range) in channels.zip(ranges) {
        let mean = |rows: &[&[f64]]| rows.iter().map(|r| r[c]).sum::<f64>() / n;
        let (of_known, of_copy) = (mean(known), mean(copied));
        bare += n * (UNSEEN * (range[1] - range[0])).powi(2);
        for (a, b) in known.iter().zip(copied) {
            let (a, b) = (a[c] - of_known, b[c] - of_copy);
            own += (a - b) * (a - b);
            bare += a * a;
        }
    }
    (own / f64::max(bare, f64::MIN_POSITIVE)).sqrt()
}

/// The values of a whole mesh and of its exemplar.
struct Whole<'a> {
    appearance: &'a Appearance,
    faces: FaceView<'a>,
    exemplar: Option<&'a Exemplar>,
    ranges: Vec<[f64; 2]>,
}

impl Known for Whole<'_> {
    fn channels(&self) -> usize {
        self.appearance.channels
    }

    fn goes_with_last(&self, channel: usize) -> bool {
        (1..self.appearance.steering).contains(&channel)
    }

    fn vertex(&self, vertex: u32) -> &[f64] {
        row(&self.appearance.values, self.appearance.channels, vertex)
    }

    fn corners(&self, face: u32) -> Option<[&[f64]; 3]> {
        let Appearance { channels, values, exemplar_values, .. } = self.appearance;
        let face = face as usize;
        if face < self.faces.len() {
            return Some(self.faces.get(face).map(|v| row(values, *channels, v)));
        }
        let faces = &self.exemplar.filter(|_| !exemplar_values.is_empty())?.faces;
        let corners = faces.get(face - self.faces.len())?;
        Some(corners.map(|v| row(exemplar_values, *channels, v)))
    }

    fn range(&self, channel: usize) -> [f64; 2] {
        self.ranges[channel]
    }
}

fn row(values: &[f64], channels: usize, v: u32) -> &[f64] {
    &values[v as usize * channels..][..channels]
}

impl Appearance {
    /// The values of the new vertices of a completion, `channels` numbers each, between the least and
    /// the greatest of the input's. `faces` and `exemplar`: of the mesh that was completed.
    ///
    /// Where a vertex has a source they are copied from there, else carried in from the rim; the seams
    /// are closed either way (`docs/appearance.md`).
    pub fn complete(
        &self,
        faces: FaceView<'_>,
        exemplar: Option<&Exemplar>,
        completion: &Completion,
    ) -> Vec<f64> {
        let mut ranges = vec![[f64::INFINITY, f64::NEG_INFINITY]; self.channels];
        for (i, &x) in self.values.iter().chain(&self.exemplar_values).enumerate() {
            let range = &mut ranges[i % self.channels];
            *range = [range[0].min(x), range[1].max(x)];
        }
        let known = Whole { appearance: self, faces, exemplar, ranges };
        // A Laplacian whose parts all touch the rim can be factored.
        let zeros = || vec![0.0; completion.vertices.len() * self.channels];
        complete_rows(completion, &known).unwrap_or_else(zeros)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// α for what is known and what a copy has, each a function of the vertex' number.
    fn alpha(known: impl Fn(f64) -> f64, copied: impl Fn(f64) -> f64) -> f64 {
        let rows = |f: &dyn Fn(f64) -> f64| -> Vec<[f64; 1]> {
            (0..200).map(|i| [f(f64::from(i))]).collect()
        };
        let (a, b) = (rows(&known), rows(&copied));
        let (a, b): (Vec<&[f64]>, Vec<&[f64]>) =
            (a.iter().map(|r| &r[..]).collect(), b.iter().map(|r| &r[..]).collect());
        trust(&a, &b, 0..1, &[[0.0, 1.0]])
    }

    #[test]
    fn copies_are_believed_as_the_ring_bears_them_out() {
        let stripes = |i: f64| 0.5 + 0.4 * (0.3 * i).sin();
        let other = |i: f64| 0.5 + 0.4 * (0.47 * i).cos();
        assert_eq!(alpha(stripes, stripes), 1.0);
        // Another mean is corrected from the rim.
        assert_eq!(alpha(stripes, |i| stripes(i) - 0.3), 1.0);
        assert_eq!(alpha(stripes, other), 0.0);
        assert_eq!(alpha(stripes, |i| 1.0 - stripes(i)), 0.0);
        let half = alpha(stripes, |i| 0.6 * stripes(i) + 0.4 * other(i));
        assert!(half > 0.3 && half < 1.0, "{half}");
    }

    /// A grey ring says nothing against a twin that is as grey, give or take what nobody sees; it does
    /// against stripes.
    #[test]
    fn noise_is_no_difference() {
        let noise = |i: f64| 0.5 + 0.005 * (1.7 * i * i).sin();
        assert_eq!(alpha(noise, |i| noise(i + 7.0)), 1.0);
        assert_eq!(alpha(noise, |i| 0.5 + 0.4 * (0.3 * i).sin()), 0.0);
    }
}

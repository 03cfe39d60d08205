//! Park, Guo, Shin, Qin (2006), "Surface completion for shape and appearance", Eq. 13 to 15: what
//! the vertices carry (colours, any numbers) copied from where the shape was copied from, the seams
//! closed by the Poisson equation.
//!
//! Minimises, over the values x of the new vertices with those of the rim fixed,
//!
//!   Σ_edges (x_i − x_j − g_ij)²  +  Σ_fill ε (x_i − s_i)²
//!
//! with s the copied values and g_ij = s_i − s_j as the copy has it. Solved, as Eq. 15, for the
//! correction x − s, which is nothing where the copy fits.
//!
//! Differences from the paper:
//! - Copied values are interpolated on the source's faces, not taken from the nearest point.
//! - A fill may have several copies. Across their borders g is the mean of what both copies say.
//! - The screen ε: values whose mean is wrong at the rim fade into the copied ones instead of flooding
//!   the fill. Measured on a painted vase and a painted head, `docs/appearance.md`.
//! - Weights are 1: the correction is smooth, and the positions are not needed.
//! - A vertex without a source has no g and no s: there the values are harmonic.

use super::factor::Symmetric;
use crate::mesh::FaceView;
use crate::options::{Appearance, Exemplar};
use crate::result::{Completion, NONE};
use std::collections::HashMap;

/// Length over which a wrong value at the rim fades, in radii of a round hole of so many vertices.
const FADE: f64 = 0.5;
/// Radius of a round hole of one vertex on a mesh of equilateral triangles, in edges.
const RADIUS: f64 = 0.525;
/// ε of a fading length of one edge: what the sum over six neighbours is to the Laplacian.
const SCREEN: f64 = 1.5;

/// What is known: a row of numbers for each vertex.
pub trait Known {
    /// The numbers of a row.
    fn channels(&self) -> usize;
    /// The row of an input vertex on the rim.
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
    let guide = Guide::new(completion, known);
    let input = completion.input_vertex_count as u32;
    let mut columns: Vec<Vec<(u32, f64)>> = (0..n).map(|i| vec![(i as u32, 0.0)]).collect();
    let mut rhs = vec![vec![0.0; n]; channels];
    for [a, b] in edges(completion) {
        // The new one of the two, or the first.
        let (i, j) = if a < input { (b, a) } else { (a, b) };
        let step = guide.step(i, j);
        let at = (i - input) as usize;
        columns[at][0].1 += 1.0;
        for (c, rhs) in rhs.iter_mut().enumerate() {
            rhs[at] += step(c) - (guide.base(i, c) - guide.base(j, c));
        }
        if let Some(other) = j.checked_sub(input) {
            let (low, high) = (at.min(other as usize), at.max(other as usize));
            columns[low].push((high as u32, -1.0));
            columns[other as usize][0].1 += 1.0;
            for (c, rhs) in rhs.iter_mut().enumerate() {
                rhs[other as usize] -= step(c) - (guide.base(i, c) - guide.base(j, c));
            }
        }
    }
    let factor = Symmetric::from_columns(columns).factor(1.0, &guide.screens())?;
    factor.solve(&mut rhs);
    let ranges: Vec<[f64; 2]> = (0..channels).map(|c| known.range(c)).collect();
    let mut rows = Vec::with_capacity(n * channels);
    for i in 0..n {
        for (c, range) in ranges.iter().enumerate() {
            let value = guide.base(input + i as u32, c) + rhs[c][i];
            rows.push(value.clamp(range[0], range[1]));
        }
    }
    Some(rows)
}

/// Edges with a new vertex, each once.
fn edges(completion: &Completion) -> Vec<[u32; 2]> {
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
    edges
}

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
}

impl<'a> Guide<'a> {
    fn new(completion: &'a Completion, known: &'a dyn Known) -> Self {
        let (rows, own, beside) = (Vec::new(), Vec::new(), HashMap::new());
        let mut guide = Self { completion, known, rows, own, beside };
        for origin in &completion.origins {
            let row = guide.copy(origin.face, origin.barycentric);
            guide.own.push(row.unwrap_or(usize::MAX));
        }
        for hole in &completion.holes {
            for seam in &hole.seams {
                if let Some(row) = guide.copy(seam.face, seam.barycentric) {
                    guide.beside.insert([seam.vertex, hole.hole as u32, seam.source], row);
                }
            }
        }
        guide
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
            Some(i) if self.completion.origins[i].source == source => {
                Some(self.own[i]).filter(|&row| row != usize::MAX)
            }
            _ => self.beside.get(&[v, hole, source]).copied(),
        }
    }

    /// g of an edge, by channel: the mean over the sources of its ends; 0 if they say nothing.
    fn step(&self, i: u32, j: u32) -> impl Fn(usize) -> f64 + '_ {
        let input = self.completion.input_vertex_count as u32;
        let hole = self.completion.vertex_hole[(i - input) as usize];
        let source = |v: u32| Some(self.completion.origins[v.checked_sub(input)? as usize].source);
        let (a, b) = (source(i), source(j));
        let said = [a, b.filter(|_| b != a)].map(|source| {
            let source = source.filter(|&s| s != NONE)?;
            Some((self.row(i, hole, source)?, self.row(j, hole, source)?))
        });
        move |c| {
            let (mut sum, mut count) = (0.0, 0.0);
            for (x, y) in said.into_iter().flatten() {
                sum += self.value(x, c) - self.value(y, c);
                count += 1.0;
            }
            sum / f64::max(count, 1.0)
        }
    }

    /// ε of each new vertex.
    fn screens(&self) -> Vec<f64> {
        let mut sizes = vec![0.0; self.completion.holes.len()];
        let hole = |i: usize| self.completion.vertex_hole[i] as usize;
        (0..self.own.len()).for_each(|i| sizes[hole(i)] += 1.0);
        let screen = |i: usize| match self.own[i] {
            usize::MAX => 0.0,
            _ => SCREEN / ((FADE * RADIUS).powi(2) * sizes[hole(i)]),
        };
        (0..self.own.len()).map(screen).collect()
    }
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

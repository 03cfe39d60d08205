//! The heat kernel signature (Sun, Ovsjanikov and Guibas 2009, "A concise and provably informative
//! multi-scale signature based on heat diffusion").
//!
//! Differences from the paper: it is known at coarse vertices and interpolated (in the manner of
//! Vaxman, Ben-Chen and Gotsman 2010); times are spaced evenly, as Harary, Tal and Grinspun (2014) do,
//! not by factors.

use super::prolong::Prolongation;
use super::spectrum::Spectrum;
use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, Par};

/// Times of a signature; Harary et al. 2014, section 4.
pub const TIME_COUNT: usize = 100;

/// Heat kernel signatures of all vertices of a (coarse) mesh.
#[derive(Debug, Clone, Default)]
pub struct Heat {
    /// The times, ascending, in square mesh units.
    pub times: Vec<f64>,
    /// h_t(x, x), a row a vertex, in 1/(square mesh unit).
    pub values: Vec<f64>,
}

/// `count` times, evenly spaced, between 4 ln 10/λ_last and 4 ln 10/λ_first (of those above zero); without any
/// such eigenvalue, or where they are zero by rounding, the area stands for the longest time.
pub fn heat_times(spectrum: &Spectrum, count: usize) -> Vec<f64> {
    let four_ln_10 = 4.0 * 10f64.ln();
    let area: f64 = spectrum.mass.iter().sum();
    // λ₂ of a long thin object is small, but not beyond this.
    let least = 1e-12 / area.max(f64::MIN_POSITIVE);
    let time = |value: Option<f64>| four_ln_10 / value.unwrap_or(1.0 / area).max(least);
    let (first, last) = (time(spectrum.last_value()), time(spectrum.first_value()));
    let part = |i: usize| i as f64 / (count.max(2) - 1) as f64;
    (0..count).map(|i| first + part(i) * (last - first)).collect()
}

impl Heat {
    /// h_t(x, x) = Σ exp(−λᵢ t) φᵢ(x)² at all vertices.
    pub fn new(spectrum: &Spectrum, times: Vec<f64>) -> Self {
        let (n, count, k) = (spectrum.vertex_count(), times.len(), spectrum.values.len());
        let squares = Mat::from_fn(n, k, |i, j| spectrum.vectors[(i, j)].powi(2));
        let decay = Mat::from_fn(count, k, |i, j| (-spectrum.values[j] * times[i]).exp());
        // The product with times as rows has the values of one vertex next to each other.
        let mut product = Mat::<f64>::zeros(count, n);
        matmul(&mut product, Accum::Replace, &decay, squares.transpose(), 1.0, Par::Seq);
        let mut values = Vec::with_capacity(n * count);
        for v in 0..n {
            let constant = 1.0 / spectrum.component_mass[spectrum.component[v] as usize];
            values.extend(product.col(v).iter().map(|x| x + constant));
        }
        Self { values, times }
    }

    /// The signature of coarse vertex `v`.
    pub fn row(&self, v: usize) -> &[f64] {
        &self.values[v * self.times.len()..(v + 1) * self.times.len()]
    }

    /// The signature of fine vertex `v`, interpolated; zeros for one without faces.
    pub fn at_fine(&self, prolongation: &Prolongation, v: usize) -> Vec<f64> {
        let mut sum = vec![0.0; self.times.len()];
        for (c, w) in prolongation.row(v) {
            sum.iter_mut().zip(self.row(c)).for_each(|(s, h)| *s += w * h);
        }
        sum
    }
}

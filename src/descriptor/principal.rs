//! Principal components: the directions in which rows of numbers differ most.

use super::dense::symmetric_eigen;
use faer::Mat;

/// Rows that decide the directions at most, evenly spread.
const MOST_ROWS: usize = 1 << 13;

/// A mean and orthonormal directions, those of the greatest spread first.
#[derive(Debug, Clone, Default)]
pub struct Principal {
    mean: Vec<f64>,
    axes: Vec<Vec<f64>>,
}

impl Principal {
    /// The `count` principal directions of rows of `dim` numbers each; the first coordinates if
    /// they have none (numbers beyond all measure).
    pub fn new<'a>(
        row: impl Fn(usize) -> &'a [f64],
        row_count: usize,
        dim: usize,
        count: usize,
    ) -> Self {
        let mut mean = vec![0.0; dim];
        for i in 0..row_count {
            mean.iter_mut().zip(row(i)).for_each(|(m, x)| *m += x / row_count as f64);
        }
        let mut covariance = Mat::<f64>::zeros(dim, dim);
        let mut centred = vec![0.0; dim];
        for i in (0..row_count).step_by(row_count.div_ceil(MOST_ROWS).max(1)) {
            (centred.iter_mut().zip(row(i)).zip(&mean)).for_each(|((c, x), m)| *c = x - m);
            for b in 0..dim {
                let column = covariance.col_mut(b).subrows_mut(b, dim - b);
                column.iter_mut().zip(&centred[b..]).for_each(|(c, r)| *c += centred[b] * r);
            }
        }
        let eigen = symmetric_eigen(covariance.as_ref());
        let axis = |k: usize| match &eigen {
            Some((_, u)) => (0..dim).map(|i| u[(i, dim - 1 - k)]).collect(),
            None => (0..dim).map(|i| f64::from(i == k)).collect(),
        };
        Self { axes: (0..count.min(dim)).map(axis).collect(), mean }
    }

    /// The components of a row.
    pub fn components(&self, row: &[f64]) -> impl Iterator<Item = f64> + '_ {
        let centred: Vec<f64> = row.iter().zip(&self.mean).map(|(x, m)| x - m).collect();
        self.axes.iter().map(move |a| a.iter().zip(&centred).map(|(a, x)| a * x).sum())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points on a tilted plane: two components keep all distances.
    #[test]
    fn components_keep_distances_where_enough_are_kept() {
        let rows: Vec<[f64; 4]> = (0..50)
            .map(|i| {
                let (a, b) = ((i % 7) as f64, (i % 11) as f64);
                [a + b, a - b, 2.0 * a, 5.0]
            })
            .collect();
        let principal = Principal::new(|i| &rows[i], rows.len(), 4, 2);
        let at: Vec<Vec<f64>> = rows.iter().map(|r| principal.components(r).collect()).collect();
        let apart =
            |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(x, y)| (x - y).powi(2)).sum() };
        for i in 0..50 {
            let (truth, found) = (apart(&rows[i], &rows[3]), apart(&at[i], &at[3]));
            assert!((truth - found).abs() < 1e-9, "{truth} {found}");
        }
    }
}

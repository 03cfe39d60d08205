//! Principal components: the directions in which rows of numbers differ most.

use super::dense::symmetric_eigen;
use crate::error::Result;
use crate::progress::Monitor;
use faer::Mat;

/// Rows that decide the directions at most, evenly spread.
const MOST_ROWS: usize = 1 << 13;
/// Rows between two looks at the monitor: some 10 ms.
const BEAT: usize = 256;

/// A mean and orthonormal directions, those of the greatest spread first.
#[derive(Debug, Clone, Default)]
pub struct Principal {
    mean: Vec<f64>,
    axes: Vec<Vec<f64>>,
}

/// The `count` directions in which centred rows of `dim` numbers spread most, the most first; all
/// coordinates if there are none (numbers beyond all measure). `row` writes a centred row.
pub fn principal_axes(
    dim: usize,
    count: usize,
    row_count: usize,
    mut row: impl FnMut(usize, &mut [f64]),
    monitor: &Monitor,
) -> Result<Vec<Vec<f64>>> {
    let mut covariance = Mat::<f64>::zeros(dim, dim);
    let mut centred = vec![0.0; dim];
    for (i, at) in (0..row_count).step_by(row_count.div_ceil(MOST_ROWS).max(1)).enumerate() {
        if i % BEAT == 0 {
            monitor.check()?;
        }
        row(at, &mut centred);
        for b in 0..dim {
            let factor = centred[b];
            let column = covariance.col_mut(b).subrows_mut(b, dim - b);
            column.iter_mut().zip(&centred[b..]).for_each(|(c, r)| *c += factor * r);
        }
    }
    Ok(match symmetric_eigen(covariance.as_ref()) {
        Some((_, u)) => {
            let axis = |k: usize| (0..dim).map(|i| u[(i, dim - 1 - k)]).collect();
            (0..count.min(dim)).map(axis).collect()
        }
        // All of them, then: slower, not wrong.
        None => (0..dim).map(|k| (0..dim).map(|i| f64::from(i == k)).collect()).collect(),
    })
}

impl Principal {
    /// The `count` principal directions of rows of `dim` numbers each.
    pub fn new<'a>(
        row: impl Fn(usize) -> &'a [f64],
        row_count: usize,
        dim: usize,
        count: usize,
        monitor: &Monitor,
    ) -> Result<Self> {
        let mut mean = vec![0.0; dim];
        for i in 0..row_count {
            mean.iter_mut().zip(row(i)).for_each(|(m, x)| *m += x / row_count as f64);
        }
        let centred = |i: usize, out: &mut [f64]| {
            (out.iter_mut().zip(row(i)).zip(&mean)).for_each(|((c, x), m)| *c = x - m);
        };
        let axes = principal_axes(dim, count, row_count, centred, monitor)?;
        Ok(Self { axes, mean })
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
        let principal = Principal::new(|i| &rows[i], rows.len(), 4, 2, &Monitor::silent()).unwrap();
        let at: Vec<Vec<f64>> = rows.iter().map(|r| principal.components(r).collect()).collect();
        let apart =
            |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(x, y)| (x - y).powi(2)).sum() };
        for i in 0..50 {
            let (truth, found) = (apart(&rows[i], &rows[3]), apart(&at[i], &at[3]));
            assert!((truth - found).abs() < 1e-9, "{truth} {found}");
        }
    }
}

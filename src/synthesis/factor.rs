//! A sparse symmetric system factored once and solved for any number of right-hand sides.

use faer::linalg::solvers::Solve;
use faer::sparse::linalg::solvers::{Llt, SymbolicLlt};
use faer::sparse::{SparseColMat, SymbolicSparseColMat};
use faer::{Mat, Side};

/// Added to each diagonal entry, relative to it: keeps a system regular where there is no data, and
/// is far too little to decide anything.
const FAINT: f64 = 1e-9;

/// The lower triangle of a symmetric matrix, by columns, diagonal first in each.
pub struct Symmetric {
    size: usize,
    columns: Vec<usize>,
    rows: Vec<usize>,
    values: Vec<f64>,
    symbolic: Option<SymbolicLlt<usize>>,
}

impl Symmetric {
    /// From columns of (row, value), rows below the diagonal or on it, in any order, repeated rows
    /// summed. Every column has its diagonal entry.
    pub fn from_columns(columns: Vec<Vec<(u32, f64)>>) -> Self {
        let size = columns.len();
        let mut matrix =
            Self { size, columns: vec![0], rows: vec![], values: vec![], symbolic: None };
        for mut column in columns {
            column.sort_by_key(|e| e.0);
            for same in column.chunk_by(|a, b| a.0 == b.0) {
                matrix.rows.push(same[0].0 as usize);
                matrix.values.push(same.iter().map(|e| e.1).sum());
            }
            matrix.columns.push(matrix.rows.len());
        }
        matrix
    }

    /// How many unknowns.
    pub fn size(&self) -> usize {
        self.size
    }

    /// Factors `scale` · this + diag(`diagonal`); `None` if that is not positive definite. Finds
    /// the ordering at the first call and keeps it.
    pub fn factor(&mut self, scale: f64, diagonal: &[f64]) -> Option<Factor> {
        self.order();
        self.factored(scale, diagonal)
    }

    /// Finds the ordering, if that was not done yet: it takes as long as a factorisation.
    pub fn order(&mut self) {
        if self.symbolic.is_none() {
            let matrix = self.with_diagonal(1.0, &vec![0.0; self.size]);
            self.symbolic = SymbolicLlt::try_new(matrix.symbolic(), Side::Lower).ok();
        }
    }

    /// The same with the ordering that an earlier [`Symmetric::factor`] found; `None` without one.
    pub fn factored(&self, scale: f64, diagonal: &[f64]) -> Option<Factor> {
        let matrix = self.with_diagonal(scale, diagonal);
        let symbolic = self.symbolic.clone()?;
        let llt = Llt::try_new_with_symbolic(symbolic, matrix.as_ref(), Side::Lower).ok()?;
        Some(Factor { llt, size: self.size })
    }

    fn with_diagonal(&self, scale: f64, diagonal: &[f64]) -> SparseColMat<usize, f64> {
        let mut values: Vec<f64> = self.values.iter().map(|v| scale * v).collect();
        for i in 0..self.size {
            let own = &mut values[self.columns[i]];
            *own += diagonal[i] + FAINT * own.abs();
            // Nothing speaks of it: its row is 0.
            if *own == 0.0 {
                *own = 1.0;
            }
        }
        let (columns, rows) = (self.columns.clone(), self.rows.clone());
        let n = self.size;
        SparseColMat::new(SymbolicSparseColMat::new_checked(n, n, columns, None, rows), values)
    }
}

/// A factored system.
pub struct Factor {
    llt: Llt<usize, f64>,
    size: usize,
}

impl Factor {
    /// Solves for all right-hand sides together, in place.
    pub fn solve(&self, columns: &mut [Vec<f64>]) {
        if self.size == 0 || columns.is_empty() {
            return;
        }
        let rhs = Mat::from_fn(self.size, columns.len(), |i, k| columns[k][i]);
        let x = self.llt.solve(&rhs);
        for (k, column) in columns.iter_mut().enumerate() {
            for i in 0..self.size {
                column[i] = x[(i, k)];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// tridiag(−1, 2, −1) x = b, a row of which can be checked by hand.
    #[test]
    fn a_chain_is_solved_for_every_right_hand_side() {
        let n = 40;
        let column = |i: u32| match i + 1 < n {
            true => vec![(i + 1, -1.0), (i, 1.5), (i, 0.5)],
            false => vec![(i, 2.0)],
        };
        let mut matrix = Symmetric::from_columns((0..n).map(column).collect());
        let factor = matrix.factor(2.0, &vec![0.25; n as usize]).unwrap();
        let mut x: Vec<Vec<f64>> =
            (1..4).map(|k| (0..n).map(|i| f64::from(i * k % 7)).collect()).collect();
        let b = x.clone();
        factor.solve(&mut x);
        for (x, b) in x.iter().zip(&b) {
            for i in 1..n as usize - 1 {
                let row = 4.25 * x[i] - 2.0 * x[i - 1] - 2.0 * x[i + 1];
                assert!((row - b[i]).abs() < 1e-6);
            }
        }
        assert!(matrix.factor(-1.0, &vec![0.0; n as usize]).is_none());
    }

    /// An unknown in no row leaves the others as they are.
    #[test]
    fn what_nothing_speaks_of_is_what_it_is_given() {
        let columns = vec![vec![(0, 2.0), (2, -1.0)], vec![(1, 0.0)], vec![(2, 2.0)]];
        let mut matrix = Symmetric::from_columns(columns);
        let mut x = [vec![1.0, 5.0, 1.0]];
        matrix.factor(1.0, &[0.0; 3]).unwrap().solve(&mut x);
        assert!((x[0][0] - 1.0).abs() < 1e-8 && (x[0][2] - 1.0).abs() < 1e-8);
        assert_eq!(x[0][1], 5.0);
    }
}

//! Dense and sparse factorisations of faer that run on one thread, so that their bits are the same
//! whatever the host has set for the crate as a whole.

use faer::diag::Diag;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::evd::{self, ComputeEigenvectors};
use faer::sparse::linalg::cholesky::{
    factorize_symbolic_cholesky, CholeskySymbolicParams, LltRef, SymbolicCholesky,
    SymmetricOrdering,
};
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, Mat, MatMut, MatRef, Par, Side};

/// Eigenvalues, ascending, and eigenvectors, as columns, of a symmetric matrix (its lower triangle
/// counts); `None` if the iteration fails.
pub fn symmetric_eigen(a: MatRef<'_, f64>) -> Option<(Vec<f64>, Mat<f64>)> {
    let n = a.nrows();
    if n == 0 {
        // faer subtracts one from the size.
        return Some((Vec::new(), Mat::zeros(0, 0)));
    }
    let (mut values, mut vectors) = (Diag::<f64>::zeros(n), Mat::zeros(n, n));
    let (par, params) = (Par::Seq, Default::default());
    let request = evd::self_adjoint_evd_scratch::<f64>(n, ComputeEigenvectors::Yes, par, params);
    let mut memory = MemBuffer::try_new(request).ok()?;
    let stack = MemStack::new(&mut memory);
    let (s, u) = (values.as_mut(), Some(vectors.as_mut()));
    evd::self_adjoint_evd(a, s, u, par, stack, params).ok()?;
    let values: Vec<f64> = values.column_vector().iter().copied().collect();
    values.iter().all(|x| x.is_finite()).then_some((values, vectors))
}

/// A sparse Cholesky factor, supernodal (for many right-hand sides), AMD ordering.
pub struct Cholesky {
    symbolic: SymbolicCholesky<usize>,
    values: Vec<f64>,
    memory: MemBuffer,
}

impl Cholesky {
    /// Factors the symmetric matrix whose lower triangle is given by columns, for solves with
    /// `columns` right-hand sides at a time; `None` if it is not positive definite.
    pub fn new(start: &[usize], rows: &[usize], values: &[f64], columns: usize) -> Option<Self> {
        let n = start.len() - 1;
        let pattern = SymbolicSparseColMatRef::new_checked(n, n, start, None, rows);
        let params = CholeskySymbolicParams {
            supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
            ..Default::default()
        };
        let symbolic =
            factorize_symbolic_cholesky(pattern, Side::Lower, SymmetricOrdering::Amd, params)
                .ok()?;
        let mut factor = vec![0.0; symbolic.len_val()];
        let request = symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default());
        let mut memory = MemBuffer::try_new(request).ok()?;
        symbolic
            .factorize_numeric_llt(
                &mut factor,
                SparseColMatRef::new(pattern, values),
                Side::Lower,
                Default::default(),
                Par::Seq,
                MemStack::new(&mut memory),
                Default::default(),
            )
            .ok()?;
        let request = symbolic.solve_in_place_scratch::<f64>(columns, Par::Seq);
        let memory = MemBuffer::try_new(request).ok()?;
        Some(Self { symbolic, values: factor, memory })
    }

    /// Replaces right-hand sides by solutions.
    pub fn solve(&mut self, rhs: MatMut<'_, f64>) {
        let factor = LltRef::new(&self.symbolic, &self.values);
        factor.solve_in_place_with_conj(Conj::No, rhs, Par::Seq, MemStack::new(&mut self.memory));
    }
}

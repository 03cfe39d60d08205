//! One sparse symmetric positive definite system, three right-hand sides (x, y, z).

use super::envelope::{Envelope, Lower};
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::reborrow::IntoConst;
use faer::sparse::linalg::cholesky::simplicial::{
    factorize_simplicial_numeric_llt, factorize_simplicial_numeric_llt_scratch,
};
use faer::sparse::linalg::cholesky::supernodal::{
    factorize_supernodal_numeric_llt, factorize_supernodal_numeric_llt_scratch,
};
use faer::sparse::linalg::cholesky::{
    factorize_symbolic_cholesky, CholeskySymbolicParams, LltRef, SymbolicCholeskyRaw,
    SymmetricOrdering,
};
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::utils::{permute_self_adjoint_scratch, permute_self_adjoint_to_unsorted};
use faer::sparse::{SparseColMat, SymbolicSparseColMat};
use faer::{Conj, Mat, Par, Side};
use glam::DVec3;

/// Multiplications within the envelope, per entry of the matrix, up to which it beats the general
/// factorisation: measured on discs and bands of 16 to 10,000 unknowns, where the two meet between
/// 450 and 550.
const ENVELOPE_COST: f64 = 450.0;
/// With more unknowns than this none was narrow enough.
const ENVELOPE_UNKNOWNS: usize = 5000;

/// How much denser than by the crate's own choice a factor is before it is made by dense blocks: their
/// products keep 4 MiB a thread, more than a small mesh, and up to some 10,000 unknowns are no faster.
const SUPERNODAL: f64 = 4.0;

/// Makes room for more entries of a matrix with so many rows, some entries a row at a time: doubled, the
/// arrays of a triharmonic system would be twice as long as what is in them.
pub fn grow(columns: &mut Vec<u32>, values: &mut Vec<f64>, more: usize, rows: usize) {
    if columns.len() + more > columns.capacity() {
        columns.reserve_exact(more + 4 * rows);
        values.reserve_exact(more + 4 * rows);
    }
}

/// A symmetric matrix being assembled column by column: the lower triangle and the right-hand side.
pub struct System {
    columns: Vec<u32>,
    rows: Vec<u32>,
    values: Vec<f64>,
    rhs: Vec<DVec3>,
    /// Where the unknowns lie, if that is known.
    places: Vec<DVec3>,
    /// Values of the current column, and which rows are in use.
    scratch: Vec<f64>,
    used: Vec<usize>,
}

impl System {
    /// An empty system of `n` unknowns.
    pub fn new(n: usize) -> Self {
        Self {
            columns: Vec::with_capacity(n + 1),
            rows: Vec::with_capacity(10 * n),
            values: Vec::with_capacity(10 * n),
            rhs: Vec::with_capacity(n),
            places: Vec::new(),
            scratch: vec![f64::NAN; n],
            used: Vec::new(),
        }
    }

    /// Says where the unknowns lie, about: it helps to number them.
    pub fn with_places(mut self, places: impl Iterator<Item = DVec3>) -> Self {
        self.places.extend(places);
        self
    }

    /// Adds to row `i` of the current column; rows above the diagonal are left out.
    pub fn add(&mut self, i: usize, value: f64) {
        if i < self.columns.len() {
            return;
        }
        if self.scratch[i].is_nan() {
            self.scratch[i] = 0.0;
            self.used.push(i);
        }
        self.scratch[i] += value;
    }

    /// Ends the current column, whose right-hand side is `rhs`.
    pub fn end_column(&mut self, rhs: DVec3) {
        self.columns.push(self.rows.len() as u32);
        grow(&mut self.rows, &mut self.values, self.used.len(), self.scratch.len());
        for &i in &self.used {
            self.rows.push(i as u32);
            self.values.push(self.scratch[i]);
            self.scratch[i] = f64::NAN;
        }
        self.used.clear();
        self.rhs.push(rhs);
    }

    /// Factors (Cholesky) and solves; `None` if the matrix is not positive definite.
    pub fn solve(mut self) -> Option<Vec<DVec3>> {
        let n = self.rhs.len();
        if n == 0 {
            return Some(Vec::new());
        }
        // Of a face whose area is lost to rounding: by an entry that is no number its row is there twice.
        if !self.values.iter().all(|v| v.is_finite()) {
            return None;
        }
        self.columns.push(u32::try_from(self.rows.len()).ok()?);
        self.scratch = Vec::new();
        self.used = Vec::new();
        self.rows.shrink_to_fit();
        self.values.shrink_to_fit();
        let solution = match self.narrow_envelope() {
            Some(envelope) => envelope.solve(&self.lower(), &self.rhs)?,
            None => self.solve_sparse()?,
        };
        solution.iter().all(|p| p.is_finite()).then_some(solution)
    }

    fn lower(&self) -> Lower<'_> {
        Lower { columns: &self.columns, rows: &self.rows, values: &self.values }
    }

    fn narrow_envelope(&self) -> Option<Envelope> {
        if self.places.len() != self.rhs.len() || self.rhs.len() > ENVELOPE_UNKNOWNS {
            return None;
        }
        let envelope = Envelope::new(&self.lower(), &self.places);
        (envelope.cost() <= ENVELOPE_COST * self.rows.len() as f64).then_some(envelope)
    }

    /// By the crate `faer`, AMD ordering. Each thing is dropped as soon as the next one is there: what is
    /// alive beside the factor is most of what a fill takes.
    fn solve_sparse(self) -> Option<Vec<DVec3>> {
        let (matrix, rhs) = self.sorted();
        let params = CholeskySymbolicParams {
            supernodal_flop_ratio_threshold: SupernodalThreshold(SUPERNODAL),
            ..Default::default()
        };
        let order = SymmetricOrdering::Amd;
        let shape =
            factorize_symbolic_cholesky(matrix.symbolic(), Side::Lower, order, params).ok()?;
        let n = shape.nrows();
        // As `SymbolicCholesky::factorize_numeric_llt`, which keeps the matrix beside its own copy.
        let side = match shape.raw() {
            SymbolicCholeskyRaw::Simplicial(_) => Side::Upper,
            SymbolicCholeskyRaw::Supernodal(_) => Side::Lower,
        };
        let entries = matrix.row_idx().len();
        let (mut columns, mut rows) = (vec![0u32; n + 1], vec![0u32; entries]);
        let mut values = vec![0.0; entries];
        let permuted = permute_self_adjoint_to_unsorted(
            &mut values,
            &mut columns,
            &mut rows,
            matrix.as_ref(),
            shape.perm()?,
            Side::Lower,
            side,
            MemStack::new(&mut MemBuffer::try_new(permute_self_adjoint_scratch::<u32>(n)).ok()?),
        )
        .into_const();
        drop(matrix);
        let mut factor = vec![0.0; shape.len_val()];
        match shape.raw() {
            SymbolicCholeskyRaw::Simplicial(shape) => {
                let room = factorize_simplicial_numeric_llt_scratch::<u32, f64>(n);
                let stack = &mut MemBuffer::try_new(room).ok()?;
                let (stack, regular) = (MemStack::new(stack), Default::default());
                factorize_simplicial_numeric_llt(&mut factor, permuted, regular, shape, stack)
                    .ok()?;
            }
            SymbolicCholeskyRaw::Supernodal(shape) => {
                let (par, params) = (Par::Seq, Default::default());
                let room = factorize_supernodal_numeric_llt_scratch::<u32, f64>(shape, par, params);
                let stack = &mut MemBuffer::try_new(room).ok()?;
                let (stack, regular) = (MemStack::new(stack), Default::default());
                factorize_supernodal_numeric_llt(
                    &mut factor,
                    permuted,
                    regular,
                    shape,
                    par,
                    stack,
                    params,
                )
                .ok()?;
            }
        }
        drop((columns, rows, values));
        let mut x = Mat::from_fn(n, 3, |i, d| rhs[i][d]);
        drop(rhs);
        let room = shape.solve_in_place_scratch::<f64>(3, Par::Seq);
        LltRef::new(&shape, &factor).solve_in_place_with_conj(
            Conj::No,
            x.as_mut(),
            Par::Seq,
            MemStack::new(&mut MemBuffer::try_new(room).ok()?),
        );
        Some((0..n).map(|i| DVec3::new(x[(i, 0)], x[(i, 1)], x[(i, 2)])).collect())
    }

    /// The matrix with the rows of each column ascending, and the right-hand side.
    fn sorted(self) -> (SparseColMat<u32, f64>, Vec<DVec3>) {
        let n = self.rhs.len();
        let (mut rows, mut values) = (self.rows, self.values);
        let mut column: Vec<(u32, f64)> = Vec::new();
        for range in self.columns.windows(2).map(|c| c[0] as usize..c[1] as usize) {
            column.clear();
            column.extend(
                rows[range.clone()].iter().copied().zip(values[range.clone()].iter().copied()),
            );
            column.sort_unstable_by_key(|e| e.0);
            for (place, entry) in range.zip(&column) {
                (rows[place], values[place]) = *entry;
            }
        }
        let symbolic = SymbolicSparseColMat::new_checked(n, n, self.columns, None, rows);
        (SparseColMat::new(symbolic, values), self.rhs)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The bi-Laplacian of a strip of `n` × 4 points, plus one, with and without places.
    fn strip(n: usize, with_places: bool, shift: f64) -> System {
        let place = |v: usize| DVec3::new((v / 4) as f64, (v % 4) as f64, 0.0);
        let mut system = System::new(4 * n);
        if with_places {
            system = system.with_places((0..4 * n).map(place));
        }
        for v in 0..4 * n {
            for w in 0..4 * n {
                match place(v).distance_squared(place(w)) {
                    0.0 => system.add(w, 20.0 + shift),
                    1.0 => system.add(w, -8.0),
                    2.0 => system.add(w, 2.0),
                    4.0 => system.add(w, 1.0),
                    _ => {}
                }
            }
            system.end_column(DVec3::new(v as f64, 1.0, (v % 7) as f64));
        }
        system
    }

    #[test]
    fn both_factorisations_solve_the_same_system() {
        for n in [1, 2, 5, 40] {
            let (a, b) =
                (strip(n, true, 1.0).solve().unwrap(), strip(n, false, 1.0).solve().unwrap());
            for (a, b) in a.iter().zip(&b) {
                assert!(a.distance(*b) < 1e-9 * (1.0 + b.length()), "{n}: {a} {b}");
            }
        }
    }

    /// Found by fuzzing: the row that was there twice was a panic in the crate that factors.
    #[test]
    fn a_system_with_an_entry_that_is_no_number_has_no_solution() {
        for value in [f64::NAN, f64::INFINITY] {
            let mut system = System::new(2);
            system.add(0, value);
            system.add(0, value);
            system.add(1, 1.0);
            system.end_column(DVec3::ONE);
            system.add(1, 1.0);
            system.end_column(DVec3::ONE);
            assert!(system.solve().is_none(), "{value}");
        }
    }

    #[test]
    fn an_indefinite_system_has_no_solution() {
        assert!(strip(10, true, -30.0).solve().is_none());
        assert!(strip(10, false, -30.0).solve().is_none());
    }
}

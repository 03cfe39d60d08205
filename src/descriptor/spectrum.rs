//! The lowest eigenpairs of the Laplacian, by block Lanczos on the inverse (Golub and Underwood
//! 1977; Vallet and Lévy 2008, "Spectral geometry processing with manifold harmonics", for the
//! shift and invert).
//!
//! Differences from the papers:
//! - One pass: a basis of `BASIS_RATIO` times the pairs wanted, full reorthogonalisation, no
//!   restart. The last pairs are then not converged, which the heat kernel does not feel: there
//!   exp(−λ t) is below 1e-4 at all its times (measured: `docs/spectrum.md`).
//! - The kernel is known, one constant a component, so it is projected out instead of computed.
//! - Small meshes are solved densely.

use super::dense::{symmetric_eigen, Cholesky};
use super::laplacian::{cotangent_stiffness, lift_masses, Stiffness};
use crate::error::{Error, Result};
use crate::mesh::roots::Roots;
use crate::progress::Monitor;
use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatMut, MatRef, Par};
use glam::DVec3;

/// Vectors a step; measured, `docs/spectrum.md`.
const BLOCK: usize = 16;
/// Basis vectors for each pair wanted: 480 for 300 have the heat kernel right to 1e-3.
const BASIS_RATIO: f64 = 1.6;
/// Steps beyond the pairs wanted at least: with few pairs the ratio alone is a few steps, which do
/// not converge. Own choice; does not bind at 300 pairs.
const LEAST_STEPS: usize = 10;
/// Up to this many vertices a dense solve is as fast (0.1 s), and exact.
const DENSE: usize = 512;
/// The shift s of (L + s M)⁻¹, in units of 1/area: far below the eigenvalues that matter (λ₂ of a
/// sphere is 25/area, λ₃₀₀ about 3,800/area), enough for Cholesky.
const SHIFT: f64 = 0.5;
/// A vector that loses more than this part of its length to the basis is replaced by a random one.
const LOST: f64 = 1e-10;

/// Eigenpairs of L φ = λ M φ, L the cotangent Laplacian, M the lumped masses.
#[derive(Debug, Clone)]
pub struct Spectrum {
    /// Mass of each vertex, in square mesh units.
    pub mass: Vec<f64>,
    /// The component that each vertex is in.
    pub component: Vec<u32>,
    /// Mass of each component. Its eigenvalue is 0, its eigenvector 1/√mass there and 0 elsewhere.
    pub component_mass: Vec<f64>,
    /// The eigenvalues after those zeros, ascending, in 1/(square mesh unit).
    pub values: Vec<f64>,
    /// Their eigenvectors as columns, a row a vertex; orthonormal: φᵢᵀ M φⱼ = δᵢⱼ.
    pub vectors: Mat<f64>,
}

impl Spectrum {
    /// The `pairs` lowest eigenpairs, counting one zero (300 gives 299 values); all there are on a
    /// mesh of fewer vertices. `mass` holds the mass of each vertex, all a third of the area of its
    /// faces if `None`.
    ///
    /// Face indices must be below `positions.len()`. One thread; the bits depend on the arguments
    /// and the instruction set only.
    pub fn new(
        positions: &[DVec3],
        faces: &[[u32; 3]],
        mass: Option<Vec<f64>>,
        pairs: usize,
        monitor: &Monitor,
    ) -> Result<Self> {
        let mut mass = mass.unwrap_or_else(|| super::laplacian::lumped_masses(positions, faces));
        lift_masses(&mut mass);
        let stiffness = cotangent_stiffness(positions, faces);
        monitor.check()?;
        let kernel = Kernel::new(&stiffness, &mass);
        let n = positions.len();
        let wanted = pairs.saturating_sub(1).min(n - kernel.mass.len());
        let (values, vectors) = if wanted == 0 {
            (Vec::new(), Mat::zeros(n, 0))
        } else if n <= DENSE.max(basis_size(wanted) + 2 * BLOCK) {
            solve_dense(&stiffness, &mass, &kernel, wanted).ok_or_else(no_convergence)?
        } else {
            solve_sparse(&stiffness, &mass, &kernel, wanted, monitor)?
        };
        Ok(Self { mass, component: kernel.component, component_mass: kernel.mass, values, vectors })
    }

    /// Number of vertices.
    pub fn vertex_count(&self) -> usize {
        self.mass.len()
    }

    /// The first eigenvalue above zero; `None` if there is none.
    pub fn first_value(&self) -> Option<f64> {
        self.values.first().copied()
    }

    /// The last eigenvalue in use.
    pub fn last_value(&self) -> Option<f64> {
        self.values.last().copied()
    }
}

/// Basis vectors for so many pairs: whole blocks.
fn basis_size(wanted: usize) -> usize {
    let size = ((wanted as f64 * BASIS_RATIO) as usize).max(wanted + LEAST_STEPS * BLOCK);
    size.next_multiple_of(BLOCK)
}

fn no_convergence() -> Error {
    Error::Unsupported { what: "the spectrum of a mesh with coordinates this extreme".into() }
}

/// The constants on the components: eigenvectors of the eigenvalue 0.
struct Kernel {
    component: Vec<u32>,
    mass: Vec<f64>,
    /// √mass of each vertex over √mass of its component.
    unit: Vec<f64>,
}

impl Kernel {
    fn new(l: &Stiffness, mass: &[f64]) -> Self {
        let n = mass.len();
        let mut roots = Roots::new(n);
        for u in 0..n {
            for &v in &l.rows[l.start[u]..l.start[u + 1]] {
                roots.join(u as u32, v as u32);
            }
        }
        let mut component = vec![0u32; n];
        let mut of_component: Vec<f64> = Vec::new();
        for v in 0..n {
            // A root is the smallest of its component and so comes first.
            let r = roots.root(v as u32) as usize;
            if r == v {
                component[v] = of_component.len() as u32;
                of_component.push(0.0);
            } else {
                component[v] = component[r];
            }
            of_component[component[v] as usize] += mass[v];
        }
        let unit = (0..n).map(|v| (mass[v] / of_component[component[v] as usize]).sqrt()).collect();
        Self { component, mass: of_component, unit }
    }

    /// Takes the constants out of a vector √M x.
    fn project_out(&self, x: &mut [f64], sums: &mut Vec<f64>) {
        sums.clear();
        sums.resize(self.mass.len(), 0.0);
        for ((x, u), &c) in x.iter().zip(&self.unit).zip(&self.component) {
            sums[c as usize] += x * u;
        }
        for ((x, u), &c) in x.iter_mut().zip(&self.unit).zip(&self.component) {
            *x -= sums[c as usize] * u;
        }
    }
}

/// All eigenpairs of M^(-1/2) L M^(-1/2), with the kernel moved to the upper end.
fn solve_dense(
    l: &Stiffness,
    mass: &[f64],
    kernel: &Kernel,
    wanted: usize,
) -> Option<(Vec<f64>, Mat<f64>)> {
    let n = mass.len();
    let root: Vec<f64> = mass.iter().map(|m| m.sqrt()).collect();
    let mut a = Mat::<f64>::zeros(n, n);
    let mut trace = 0.0;
    for j in 0..n {
        for e in l.start[j]..l.start[j + 1] {
            let i = l.rows[e];
            a[(i, j)] += l.values[e] / (root[i] * root[j]);
        }
        trace += a[(j, j)];
    }
    for j in 0..n {
        for i in j..n {
            if kernel.component[i] == kernel.component[j] {
                a[(i, j)] += trace * kernel.unit[i] * kernel.unit[j];
            }
        }
    }
    let (values, vectors) = symmetric_eigen(a.as_ref())?;
    let values: Vec<f64> = values[..wanted].iter().map(|v| v.max(0.0)).collect();
    let vectors = Mat::from_fn(n, wanted, |i, j| vectors[(i, j)] / root[i]);
    Some((values, vectors))
}

/// The operator √M (L + s M)⁻¹ √M, off the kernel: its eigenvalues are 1/(λ + s).
struct Inverse<'a> {
    factor: Cholesky,
    root: Vec<f64>,
    shift: f64,
    kernel: &'a Kernel,
    sums: Vec<f64>,
}

impl<'a> Inverse<'a> {
    fn new(l: &Stiffness, mass: &[f64], kernel: &'a Kernel) -> Option<Self> {
        let shift = SHIFT / mass.iter().sum::<f64>();
        let mut values = l.values.clone();
        for (v, m) in mass.iter().enumerate() {
            values[l.start[v]] += shift * m;
        }
        let factor = Cholesky::new(&l.start, &l.rows, &values, BLOCK)?;
        let root = mass.iter().map(|m| m.sqrt()).collect();
        Some(Self { factor, root, shift, kernel, sums: Vec::new() })
    }

    fn apply(&mut self, mut x: MatMut<'_, f64>) {
        let scale = |mut x: MatMut<'_, f64>, root: &[f64]| {
            for j in 0..x.ncols() {
                for (i, r) in root.iter().enumerate() {
                    x[(i, j)] *= r;
                }
            }
        };
        scale(x.as_mut(), &self.root);
        self.factor.solve(x.as_mut());
        scale(x.as_mut(), &self.root);
        for j in 0..x.ncols() {
            self.project_out(x.as_mut(), j);
        }
    }

    fn project_out(&mut self, x: MatMut<'_, f64>, j: usize) {
        if let Some(column) = x.col_mut(j).try_as_col_major_mut() {
            self.kernel.project_out(column.as_slice_mut(), &mut self.sums);
        }
    }
}

fn solve_sparse(
    l: &Stiffness,
    mass: &[f64],
    kernel: &Kernel,
    wanted: usize,
    monitor: &Monitor,
) -> Result<(Vec<f64>, Mat<f64>)> {
    let n = mass.len();
    let mut inverse = Inverse::new(l, mass, kernel).ok_or_else(no_convergence)?;
    monitor.check()?;
    let size = basis_size(wanted);
    let steps = size / BLOCK;
    let mut basis = Mat::<f64>::zeros(n, size);
    // Vᵀ A V, lower triangle.
    let mut projected = Mat::<f64>::zeros(size, size);
    let mut random = Random(0x9e37_79b9_7f4a_7c15);
    let mut block = Mat::from_fn(n, BLOCK, |_, _| random.next());
    for step in 0..steps {
        monitor.check()?;
        let (before, mut rest) = basis.as_mut().split_at_col_mut(step * BLOCK);
        orthonormalize(&mut inverse, before.as_ref(), block.as_mut(), &mut random);
        rest.as_mut().subcols_mut(0, BLOCK).copy_from(&block);
        inverse.apply(block.as_mut());
        let so_far = basis.as_ref().subcols(0, (step + 1) * BLOCK);
        let mut h = Mat::<f64>::zeros(so_far.ncols(), BLOCK);
        matmul(&mut h, Accum::Replace, so_far.transpose(), &block, 1.0, Par::Seq);
        matmul(&mut block, Accum::Add, so_far, &h, -1.0, Par::Seq);
        for j in 0..BLOCK {
            for i in 0..so_far.ncols() {
                // The row of the lower triangle; of the diagonal block the lower half.
                let column = step * BLOCK + j;
                if i <= column {
                    projected[(column, i)] = h[(i, j)];
                }
            }
        }
    }
    monitor.check()?;
    let (theta, s) = symmetric_eigen(projected.as_ref()).ok_or_else(no_convergence)?;
    monitor.check()?;
    // The greatest eigenvalues of the inverse are the lowest of L.
    let chosen = Mat::from_fn(size, wanted, |i, j| s[(i, size - 1 - j)]);
    let mut vectors = Mat::<f64>::zeros(n, wanted);
    matmul(&mut vectors, Accum::Replace, &basis, &chosen, 1.0, Par::Seq);
    let values = (0..wanted).map(|j| 1.0 / theta[size - 1 - j].max(f64::MIN_POSITIVE));
    let values: Vec<f64> = values.map(|v| (v - inverse.shift).max(0.0)).collect();
    for j in 0..wanted {
        let norm = vectors.col(j).norm_l2().max(f64::MIN_POSITIVE);
        for (i, root) in inverse.root.iter().enumerate() {
            vectors[(i, j)] /= norm * root;
        }
    }
    Ok((values, vectors))
}

/// Makes the columns of `block` orthonormal, and orthogonal to the kernel; they are so to `basis`
/// but for columns that vanish, for which random ones are put in.
fn orthonormalize(
    inverse: &mut Inverse<'_>,
    basis: MatRef<'_, f64>,
    mut block: MatMut<'_, f64>,
    random: &mut Random,
) {
    for j in 0..block.ncols() {
        // A second sweep is needed only after cancellation; always doing it costs nothing.
        for _ in 0..4 {
            inverse.project_out(block.as_mut(), j);
            let (done, rest) = block.as_mut().split_at_col_mut(j);
            let done = done.as_ref();
            let mut x = rest.col_mut(0);
            let before = x.as_ref().norm_l2();
            for _ in 0..2 {
                for k in 0..j {
                    let q = done.col(k);
                    let dot = q.transpose() * x.as_ref();
                    x -= faer::Scale(dot) * q;
                }
            }
            let after = x.as_ref().norm_l2();
            if after > LOST * before && after > f64::MIN_POSITIVE {
                x *= faer::Scale(1.0 / after);
                break;
            }
            for i in 0..x.nrows() {
                x[i] = random.next();
            }
            for _ in 0..2 {
                let h = basis.transpose() * x.as_ref();
                x -= basis * h;
            }
        }
    }
}

/// Numbers between -1 and 1 (SplitMix64, Steele et al. 2014): the same on every machine.
pub(crate) struct Random(pub u64);

impl Random {
    pub(crate) fn next_bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn next(&mut self) -> f64 {
        (self.next_bits() >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

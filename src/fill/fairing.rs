//! Botsch and Kobbelt (2004), Sorkine and Cohen-Or (2004): the smooth surface through a rim.
//!
//! Each fairing minimises a quadratic energy of the sheet (fill and surroundings): one sparse
//! Cholesky factorisation. With L the Laplacian and M the masses:
//! - C0: xᵀ L x; the rim is fixed.
//! - C1: xᵀ L M⁻¹ L x; rim and first ring are fixed.
//! - C2: xᵀ L M⁻¹ L M⁻¹ L x; two rings are fixed.
//! - Least squares (Sorkine and Cohen-Or): Σ |(L_u x)_i|² + Σ_known |x_i − p_i|², L_u uniform.
//! - Smoothed plate: s⁴ xᵀ L M⁻¹ L x + Σ_known m_i |x_i − p_i|², s a length: the thin plate
//!   through the surroundings as they are without their roughness.
//!
//! Differences from the papers: where known vertices are soft, the fill is joined to the true rim
//! afterwards by spreading the rim's residual inward over a short length.

use super::sheet::{Laplacian, Sheet, Weights};
use super::solve::System;
use glam::DVec3;

/// Length over which the residual at the rim fades, in wanted edge lengths: two edges are just
/// enough for a joint without a crease at the scale of the mesh.
const RESIDUAL_EDGES: f64 = 2.0;

/// The fairings, with what they need.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Plate {
    /// C0.
    Membrane,
    /// C1.
    Thin,
    /// C2.
    Triharmonic,
    /// The least-squares mesh.
    LeastSquares,
    /// The smoothed plate, `s` in mesh units.
    Smoothed(f64),
}

impl Plate {
    /// Rings of known surface it needs beside the soft band.
    pub fn rings(self) -> usize {
        match self {
            Plate::Membrane | Plate::Thin => 1,
            Plate::Triharmonic => 2,
            Plate::LeastSquares | Plate::Smoothed(_) => 2,
        }
    }
    /// Whether known vertices are soft constraints.
    pub fn is_soft(self) -> bool {
        matches!(self, Plate::LeastSquares | Plate::Smoothed(_))
    }
}

/// New positions of the patch's new vertices; `None` if the system is not positive definite.
pub fn fair(sheet: &Sheet, plate: Plate, edge: f64) -> Option<Vec<DVec3>> {
    let weights = match plate {
        Plate::LeastSquares => Weights::Uniform,
        _ => Weights::Cotangent,
    };
    let l = Laplacian::new(&sheet.positions, &sheet.triangles, weights);
    match plate {
        Plate::Membrane => solve_membrane(sheet, &l),
        Plate::Triharmonic => solve_triharmonic(sheet, &l),
        Plate::Thin => solve_plate(sheet, &l, |_| None, 1.0),
        Plate::LeastSquares => {
            let soft = |v: usize| (v < sheet.rim_count || v >= sheet.patch_count).then_some(1.0);
            let unit = Laplacian { mass: vec![1.0; l.mass.len()], ..l };
            let smooth = solve_plate(sheet, &unit, soft, 1.0)?;
            join_to_rim(sheet, smooth, edge)
        }
        Plate::Smoothed(s) => {
            let soft =
                |v: usize| (v < sheet.rim_count || v >= sheet.patch_count).then(|| l.mass[v]);
            let smooth = solve_plate(sheet, &l, soft, s.powi(4))?;
            join_to_rim(sheet, smooth, edge)
        }
    }
}

/// Numbers of the unknowns among all vertices.
fn number_unknowns(sheet: &Sheet, is_free: impl Fn(usize) -> bool) -> (Vec<u32>, Vec<usize>) {
    let mut number = vec![u32::MAX; sheet.positions.len()];
    let mut free = Vec::new();
    for v in 0..number.len() {
        if is_free(v) {
            number[v] = free.len() as u32;
            free.push(v);
        }
    }
    (number, free)
}

fn is_new(sheet: &Sheet, v: usize) -> bool {
    v >= sheet.rim_count && v < sheet.patch_count
}

fn solve_membrane(sheet: &Sheet, l: &Laplacian) -> Option<Vec<DVec3>> {
    let (number, free) = number_unknowns(sheet, |v| is_new(sheet, v));
    let mut system = System::new(free.len());
    for &v in &free {
        let mut rhs = DVec3::ZERO;
        system.add(number[v] as usize, l.diagonal[v]);
        for (w, weight) in l.row(v) {
            match number[w] {
                u32::MAX => rhs += weight * sheet.positions[w],
                i => system.add(i as usize, -weight),
            }
        }
        system.end_column(rhs);
    }
    system.solve()
}

/// Minimises scale · Σ |(L x)_i|² / m_i over complete rows + Σ soft(i) |x_i − p_i|². Returns the
/// solution at every vertex of the patch (rim included where it is soft, else unchanged).
fn solve_plate(
    sheet: &Sheet,
    l: &Laplacian,
    soft: impl Fn(usize) -> Option<f64>,
    scale: f64,
) -> Option<Vec<DVec3>> {
    let is_soft = soft(0).is_some();
    let last = sheet.rings as u16;
    let is_free =
        |v: usize| is_new(sheet, v) || is_soft && sheet.ring[v] < last;
    let (number, free) = number_unknowns(sheet, is_free);
    let mut system = System::new(free.len());
    for &v in &free {
        let mut rhs = DVec3::ZERO;
        // Column v of L: the rows in which x_v occurs.
        let column = std::iter::once((v, l.diagonal[v])).chain(l.row(v).map(|(i, w)| (i, -w)));
        for (i, liv) in column {
            if !sheet.is_complete(i) {
                continue;
            }
            let factor = scale * liv / l.mass[i];
            let row = std::iter::once((i, l.diagonal[i])).chain(l.row(i).map(|(k, w)| (k, -w)));
            for (k, lik) in row {
                match number[k] {
                    u32::MAX => rhs -= factor * lik * sheet.positions[k],
                    j => system.add(j as usize, factor * lik),
                }
            }
        }
        if let Some(weight) = soft(v).filter(|_| !is_new(sheet, v)) {
            system.add(number[v] as usize, weight);
            rhs += weight * sheet.positions[v];
        }
        system.end_column(rhs);
    }
    let solution = system.solve()?;
    let value = |v: usize| match number[v] {
        u32::MAX => sheet.positions[v],
        i => solution[i as usize],
    };
    let first = if is_soft { 0 } else { sheet.rim_count };
    Some((first..sheet.patch_count).map(value).collect())
}

/// x = y + δ: y the smooth solution at all patch vertices, δ its residual at the rim, spread by
/// (L + M/ℓ²) δ = 0.
fn join_to_rim(sheet: &Sheet, smooth: Vec<DVec3>, edge: f64) -> Option<Vec<DVec3>> {
    let rim = sheet.rim_count;
    let residual = |v: usize| sheet.positions[v] - smooth[v];
    let mut moved = sheet.positions.clone();
    moved[..sheet.patch_count].copy_from_slice(&smooth);
    let patch = &sheet.triangles[..sheet.triangles.len() - sheet.band_face_count];
    let l = Laplacian::new(&moved[..sheet.patch_count], patch, Weights::Cotangent);
    let screen = 1.0 / (RESIDUAL_EDGES * edge).powi(2);
    let mut system = System::new(sheet.patch_count - rim);
    for v in rim..sheet.patch_count {
        let mut rhs = DVec3::ZERO;
        system.add(v - rim, l.diagonal[v] + screen * l.mass[v]);
        for (w, weight) in l.row(v) {
            if w < rim {
                rhs += weight * residual(w);
            } else {
                system.add(w - rim, -weight);
            }
        }
        system.end_column(rhs);
    }
    let spread = system.solve()?;
    Some((rim..sheet.patch_count).map(|v| smooth[v] + spread[v - rim]).collect())
}

/// Minimises Σ_edges w_ij |(M⁻¹ L x)_i − (M⁻¹ L x)_j|²: the gradient of the mean curvature vector.
fn solve_triharmonic(sheet: &Sheet, l: &Laplacian) -> Option<Vec<DVec3>> {
    let (number, free) = number_unknowns(sheet, |v| is_new(sheet, v));
    let mut system = System::new(free.len());
    // Column v of L M⁻¹ L M⁻¹ L, by three products with sparse vectors.
    let n = sheet.positions.len();
    let mut apply = Apply { values: [vec![0.0; n], vec![0.0; n]], used: [vec![], vec![]] };
    for &v in &free {
        apply.start(v);
        apply.multiply(l, |i| sheet.is_complete(i), true);
        apply.multiply(l, |i| sheet.is_complete(i), true);
        apply.multiply(l, |_| true, false);
        let mut rhs = DVec3::ZERO;
        for &k in &apply.used[0] {
            match number[k] {
                u32::MAX => rhs -= apply.values[0][k] * sheet.positions[k],
                j => system.add(j as usize, apply.values[0][k]),
            }
        }
        system.end_column(rhs);
    }
    system.solve()
}

/// A sparse vector multiplied by L again and again.
struct Apply {
    values: [Vec<f64>; 2],
    used: [Vec<usize>; 2],
}

impl Apply {
    fn start(&mut self, v: usize) {
        self.clear(0);
        self.values[0][v] = 1.0;
        self.used[0].push(v);
    }
    fn clear(&mut self, side: usize) {
        for &i in &self.used[side] {
            self.values[side][i] = 0.0;
        }
        self.used[side].clear();
    }
    /// x ← L x at the rows allowed, divided by the masses if asked.
    fn multiply(&mut self, l: &Laplacian, allowed: impl Fn(usize) -> bool, divide: bool) {
        self.clear(1);
        let ([from, to], [used, fresh]) = (&mut self.values, &mut self.used);
        let mut add = |i: usize, x: f64, fresh: &mut Vec<usize>| {
            if allowed(i) {
                if to[i] == 0.0 {
                    fresh.push(i);
                }
                to[i] += x;
            }
        };
        for &j in used.iter() {
            add(j, l.diagonal[j] * from[j], fresh);
            for (i, w) in l.row(j) {
                add(i, -w * from[j], fresh);
            }
        }
        fresh.sort_unstable();
        fresh.dedup();
        if divide {
            fresh.iter().for_each(|&i| to[i] /= l.mass[i]);
        }
        self.values.swap(0, 1);
        self.used.swap(0, 1);
    }
}

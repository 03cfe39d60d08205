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

use super::blocks::solve_by_blocks;
use super::sheet::{Laplacian, Sheet, Weights};
use super::solve::{grow, System};
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

/// Moves the new vertices of a sheet that lie near the solution already, but for `offsets` (of all the
/// patch's vertices, or empty): with more than `most_at_once` of them the system is solved by blocks. For
/// plates with a fixed rim. Weights and masses are those of the sheet as it is.
pub fn fair_from(
    sheet: &mut Sheet,
    offsets: &[DVec3],
    plate: Plate,
    most_at_once: usize,
) -> Option<()> {
    let new = sheet.rim_count..sheet.patch_count;
    let l = Laplacian::new(&sheet.positions, &sheet.triangles, Weights::Cotangent);
    if new.len() <= most_at_once {
        let (number, free) = number_unknowns(sheet, |v| sheet.is_new(v));
        let system = assemble(plate, sheet, &l, &number, &free);
        drop((l, number, free));
        sheet.positions[new].copy_from_slice(&system.solve()?);
        return Some(());
    }
    for v in new.filter(|&v| v < offsets.len()) {
        sheet.positions[v] -= offsets[v];
    }
    solve_by_blocks(sheet, &l, &|sheet, number, free| assemble(plate, sheet, &l, number, free))
}

/// New positions of the patch's new vertices; `None` if the system is not positive definite.
pub fn fair(mut sheet: Sheet, plate: Plate, edge: f64) -> Option<Vec<DVec3>> {
    let weights = match plate {
        Plate::LeastSquares => Weights::Uniform,
        _ => Weights::Cotangent,
    };
    let l = Laplacian::new(&sheet.positions, &sheet.triangles, weights);
    let is_known = |v: usize| v < sheet.rim_count || v >= sheet.patch_count;
    match plate {
        Plate::Membrane | Plate::Triharmonic | Plate::Thin => {
            sheet.triangles = Vec::new();
            let (number, free) = number_unknowns(&sheet, |v| sheet.is_new(v));
            let system = assemble(plate, &sheet, &l, &number, &free);
            // The factor needs the room.
            drop((sheet, l, number, free));
            system.solve()
        }
        Plate::LeastSquares => {
            let unit = Laplacian { mass: vec![1.0; l.mass.len()], ..l };
            let smooth = solve_soft(&sheet, &unit, |v| is_known(v).then_some(1.0), 1.0)?;
            join_to_rim(&sheet, smooth, edge)
        }
        Plate::Smoothed(s) => {
            let soft = |v: usize| is_known(v).then(|| l.mass[v]);
            let smooth = solve_soft(&sheet, &l, soft, s.powi(4))?;
            join_to_rim(&sheet, smooth, edge)
        }
    }
}

/// Thin plate and triharmonic surface of one sheet.
pub fn fair_both(sheet: &Sheet) -> Option<[Vec<DVec3>; 2]> {
    let l = Laplacian::new(&sheet.positions, &sheet.triangles, Weights::Cotangent);
    let (number, free) = number_unknowns(sheet, |v| sheet.is_new(v));
    let thin = assemble(Plate::Thin, sheet, &l, &number, &free).solve()?;
    let curved = assemble(Plate::Triharmonic, sheet, &l, &number, &free).solve()?;
    Some([thin, curved])
}

/// The system of a plate through a rim that is fixed.
fn assemble(plate: Plate, sheet: &Sheet, l: &Laplacian, number: &[u32], free: &[usize]) -> System {
    match plate {
        Plate::Membrane => assemble_membrane(sheet, l, number, free),
        Plate::Triharmonic => assemble_triharmonic(sheet, l, number, free),
        _ => assemble_plate(sheet, l, |_| None, 1.0, number, free),
    }
}

/// What a hidden part of the surroundings says about the surface that continues it.
pub struct Prediction {
    /// Share of the triharmonic surface in the blend with the thin plate: 0 to [`MOST_CURVED`],
    /// or 1 where the surroundings are smooth.
    pub share: f64,
    /// The blend at the patch's new vertices.
    pub positions: Vec<DVec3>,
}

/// Largest share of the triharmonic surface. It carries the curvature at the rim inward and so
/// can miss by much more than the thin plate: half of it at most is what paid on 17 holes cut
/// into scans and models (`docs/smooth.md`).
pub const MOST_CURVED: f64 = 0.5;

/// Root mean square error of the thin plate at the hidden vertices, in edge lengths, below which
/// the surroundings count as smooth: their curvature is then a measurement, not noise, and is
/// carried on in full. Lies between a ribbed vase (0.09), where that paid, and cracks across a
/// scanned figure (0.14), where it did not.
const SMOOTH: f64 = 0.1;

/// Hides the rim and the first `hidden` rings from both plates and finds the blend that predicts
/// them best. With x₁ the thin, x₂ the triharmonic prediction and p the truth,
/// w = Σ m ⟨p − x₁, x₂ − x₁⟩ / Σ m |x₂ − x₁|². The sheet must have `hidden` + 2 rings; `edge` is
/// the mean edge length there.
pub fn predict_hidden(mut sheet: Sheet, hidden: usize, edge: f64) -> Option<Prediction> {
    let l = Laplacian::new(&sheet.positions, &sheet.triangles, Weights::Cotangent);
    sheet.triangles = Vec::new();
    let is_free = |v: usize| sheet.is_new(v) || sheet.ring[v] as usize <= hidden;
    let (number, free) = number_unknowns(&sheet, is_free);
    let thin = assemble(Plate::Thin, &sheet, &l, &number, &free).solve()?;
    let curved = assemble(Plate::Triharmonic, &sheet, &l, &number, &free);
    let masses = l.mass;
    // The factor needs the room.
    drop((l.start, l.to, l.weight, l.diagonal));
    let curved = curved.solve()?;
    let (mut product, mut square, mut error, mut mass) = (0.0, 0.0, 0.0, 0.0);
    for (i, &v) in free.iter().enumerate().filter(|&(_, &v)| !sheet.is_new(v)) {
        let (apart, missed) = (curved[i] - thin[i], sheet.positions[v] - thin[i]);
        product += masses[v] * apart.dot(missed);
        square += masses[v] * apart.length_squared();
        error += masses[v] * missed.length_squared();
        mass += masses[v];
    }
    let share = if error < mass * (SMOOTH * edge).powi(2) {
        1.0
    } else if square > 0.0 {
        (product / square).clamp(0.0, MOST_CURVED)
    } else {
        0.0
    };
    let blend = |i: usize| thin[i].lerp(curved[i], share);
    let positions =
        (sheet.rim_count..sheet.patch_count).map(|v| blend(number[v] as usize)).collect();
    Some(Prediction { share, positions })
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

fn assemble_membrane(sheet: &Sheet, l: &Laplacian, number: &[u32], free: &[usize]) -> System {
    let places = free.iter().map(|&v| sheet.positions[v]);
    let mut system = System::new(free.len()).with_places(places);
    for &v in free {
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
    system
}

/// Minimises scale · Σ |(L x)_i|² / m_i over complete rows + Σ soft(i) |x_i − p_i|². Returns the
/// solution at all of the patch's vertices.
fn solve_soft(
    sheet: &Sheet,
    l: &Laplacian,
    soft: impl Fn(usize) -> Option<f64>,
    scale: f64,
) -> Option<Vec<DVec3>> {
    let last = sheet.rings as u16;
    let (number, free) = number_unknowns(sheet, |v| sheet.is_new(v) || sheet.ring[v] < last);
    let solution = assemble_plate(sheet, l, soft, scale, &number, &free).solve()?;
    let value = |v: usize| match number[v] {
        u32::MAX => sheet.positions[v],
        i => solution[i as usize],
    };
    Some((0..sheet.patch_count).map(value).collect())
}

fn assemble_plate(
    sheet: &Sheet,
    l: &Laplacian,
    soft: impl Fn(usize) -> Option<f64>,
    scale: f64,
    number: &[u32],
    free: &[usize],
) -> System {
    let places = free.iter().map(|&v| sheet.positions[v]);
    let mut system = System::new(free.len()).with_places(places);
    for &v in free {
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
        if let Some(weight) = soft(v).filter(|_| !sheet.is_new(v)) {
            system.add(number[v] as usize, weight);
            rhs += weight * sheet.positions[v];
        }
        system.end_column(rhs);
    }
    system
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
    let places = moved[rim..sheet.patch_count].iter().copied();
    let mut system = System::new(sheet.patch_count - rim).with_places(places);
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

/// Minimises Σ_edges w_ij |(M⁻¹ L x)_i − (M⁻¹ L x)_j|², the gradient of the mean curvature vector,
/// over edges whose ends both have all their neighbours.
fn assemble_triharmonic(sheet: &Sheet, l: &Laplacian, number: &[u32], free: &[usize]) -> System {
    let places = free.iter().map(|&v| sheet.positions[v]);
    let mut system = System::new(free.len()).with_places(places);
    let mut needed = vec![false; sheet.positions.len()];
    for &v in free {
        needed[v] = true;
        l.row(v).for_each(|(w, _)| needed[w] = true);
    }
    let gradient = Rows::gradient(sheet, l, &needed, free.len());
    for &v in free {
        let mut rhs = DVec3::ZERO;
        // Column v of M⁻¹ L, then row by row what it is multiplied with.
        let column = std::iter::once((v, l.diagonal[v])).chain(l.row(v).map(|(i, w)| (i, -w)));
        for (i, liv) in column.filter(|&(i, _)| sheet.is_complete(i)) {
            let factor = liv / l.mass[i];
            for (k, value) in gradient.row(i) {
                match number[k] {
                    u32::MAX => rhs -= factor * value * sheet.positions[k],
                    j => system.add(j as usize, factor * value),
                }
            }
        }
        system.end_column(rhs);
    }
    system
}

/// A sparse matrix by rows.
struct Rows {
    start: Vec<u32>,
    columns: Vec<u32>,
    values: Vec<f64>,
}

impl Rows {
    /// L' M⁻¹ L at the complete rows that are needed, about `count`; L' the Laplacian of the edges
    /// both of whose ends are complete.
    fn gradient(sheet: &Sheet, l: &Laplacian, needed: &[bool], count: usize) -> Self {
        let n = sheet.positions.len();
        let mut rows = Self {
            start: vec![0; n + 1],
            columns: Vec::with_capacity(20 * count),
            values: Vec::with_capacity(20 * count),
        };
        let mut sum = vec![f64::NAN; n];
        let mut used: Vec<u32> = Vec::new();
        for i in 0..n {
            if needed[i] && sheet.is_complete(i) {
                let mut diagonal = 0.0;
                let mut add_row = |j: usize, weight: f64| {
                    let factor = weight / l.mass[j];
                    let row = std::iter::once((j, l.diagonal[j]));
                    for (k, value) in row.chain(l.row(j).map(|(k, w)| (k, -w))) {
                        if sum[k].is_nan() {
                            sum[k] = 0.0;
                            used.push(k as u32);
                        }
                        sum[k] += factor * value;
                    }
                };
                for (j, w) in l.row(i).filter(|&(j, _)| sheet.is_complete(j)) {
                    diagonal += w;
                    add_row(j, -w);
                }
                add_row(i, diagonal);
                grow(&mut rows.columns, &mut rows.values, used.len(), count);
                for &k in &used {
                    rows.columns.push(k);
                    rows.values.push(std::mem::replace(&mut sum[k as usize], f64::NAN));
                }
                used.clear();
            }
            rows.start[i + 1] = rows.columns.len() as u32;
        }
        rows
    }

    fn row(&self, i: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let range = self.start[i] as usize..self.start[i + 1] as usize;
        range.map(|e| (self.columns[e] as usize, self.values[e]))
    }
}

//! The cotangent Laplacian for spectra, on mollified edge lengths (Pinkall and Polthier 1993;
//! Sharp and Crane 2020, "A Laplacian for nonmanifold triangle meshes", section 4.5).
//!
//! Differences from the papers: no intrinsic Delaunay flips and no tufted cover, only the
//! mollification. The Laplacian of the fairings (`fill::sheet`) clamps its weights instead, which
//! is safe for one solve but changes eigenvalues, by 1 % on a grid of right triangles.

use glam::DVec3;

/// How much longer than the third two edges of a triangle are made at least, in mean edges; as in
/// Sharp and Crane.
const MOLLIFIER: f64 = 1e-5;
/// Least mass of a vertex, in mean masses: a vertex between slivers would else have a signature of
/// pure rounding. Own choice; no eigenvalue in use can feel it.
const LEAST_MASS: f64 = 1e-3;

/// L x = Σⱼ wᵢⱼ (xᵢ − xⱼ), positive semi-definite, as its lower triangle by columns.
#[derive(Debug, Clone)]
pub struct Stiffness {
    /// Column starts.
    pub start: Vec<usize>,
    /// Rows, ascending in each column, the diagonal first.
    pub rows: Vec<usize>,
    /// Values.
    pub values: Vec<f64>,
}

/// The stiffness matrix of a triangle mesh. Face indices must be below `positions.len()`.
pub fn cotangent_stiffness(positions: &[DVec3], faces: &[[u32; 3]]) -> Stiffness {
    let lengths = mollified_lengths(positions, faces);
    let n = positions.len();
    // (column, row, value) of each edge of each face; sorted, so that sums do not depend on order.
    let mut entries: Vec<(u32, u32, f64)> = Vec::with_capacity(3 * faces.len());
    for (face, length) in faces.iter().zip(&lengths) {
        let area4 = 4.0 * heron(*length);
        for k in 0..3 {
            // Edge k is opposite to corner k.
            let (a, b, c) = (length[k], length[(k + 1) % 3], length[(k + 2) % 3]);
            let half_cot = 0.5 * (b * b + c * c - a * a) / area4.max(f64::MIN_POSITIVE);
            let (u, v) = (face[(k + 1) % 3], face[(k + 2) % 3]);
            if u != v && half_cot.is_finite() {
                entries.push((u.min(v), u.max(v), half_cot));
            }
        }
    }
    entries.sort_by_key(|e| (e.0, e.1));
    let mut diagonal = vec![0.0; n];
    let mut merged: Vec<(u32, u32, f64)> = Vec::with_capacity(entries.len() / 2 + n);
    for same in entries.chunk_by(|x, y| (x.0, x.1) == (y.0, y.1)) {
        let w: f64 = same.iter().map(|e| e.2).sum();
        let (u, v, _) = same[0];
        diagonal[u as usize] += w;
        diagonal[v as usize] += w;
        merged.push((u, v, w));
    }
    let mut l = Stiffness {
        start: Vec::with_capacity(n + 1),
        rows: Vec::with_capacity(merged.len() + n),
        values: Vec::with_capacity(merged.len() + n),
    };
    let mut next = merged.iter().peekable();
    for u in 0..n {
        l.start.push(l.rows.len());
        l.rows.push(u);
        l.values.push(diagonal[u]);
        while let Some((_, v, w)) = next.next_if(|e| e.0 as usize == u) {
            l.rows.push(*v as usize);
            l.values.push(-w);
        }
    }
    l.start.push(l.rows.len());
    l
}

/// A third of the area of its faces for each vertex, in square mesh units; not lifted.
pub fn lumped_masses(positions: &[DVec3], faces: &[[u32; 3]]) -> Vec<f64> {
    let mut mass = vec![0.0; positions.len()];
    for face in faces {
        let [a, b, c] = face.map(|v| positions[v as usize]);
        let third = (b - a).cross(c - a).length() / 6.0;
        face.iter().for_each(|&v| mass[v as usize] += third);
    }
    mass
}

/// Lifts masses near zero to a small part of their mean.
pub fn lift_masses(mass: &mut [f64]) {
    let mean = mass.iter().sum::<f64>() / mass.len().max(1) as f64;
    // Without any area the unit does not matter.
    let least = LEAST_MASS * if mean > 0.0 && mean.is_finite() { mean } else { 1.0 };
    mass.iter_mut().for_each(|m| *m = m.max(least));
}

/// Lengths of the edges opposite to each corner, all longer by the same, so that no triangle is
/// degenerate.
fn mollified_lengths(positions: &[DVec3], faces: &[[u32; 3]]) -> Vec<[f64; 3]> {
    let length = |f: &[u32; 3]| {
        let p = f.map(|v| positions[v as usize]);
        [p[1].distance(p[2]), p[2].distance(p[0]), p[0].distance(p[1])]
    };
    let mut lengths: Vec<[f64; 3]> = faces.iter().map(length).collect();
    let mean = lengths.iter().flatten().sum::<f64>() / (3 * faces.len()).max(1) as f64;
    let mut longer = 0.0f64;
    for [a, b, c] in &lengths {
        for slack in [b + c - a, c + a - b, a + b - c] {
            longer = longer.max(MOLLIFIER * mean - slack);
        }
    }
    lengths.iter_mut().flatten().for_each(|l| *l += longer);
    lengths
}

/// The area of a triangle, stable for needles (Kahan's order of Heron's formula).
fn heron(mut l: [f64; 3]) -> f64 {
    l.sort_unstable_by(|x, y| y.total_cmp(x));
    let [a, b, c] = l;
    0.25 * ((a + (b + c)) * (c - (a - b)) * (c + (a - b)) * (a + (b - c))).max(0.0).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square of two right triangles, and a needle that has no area at all.
    #[test]
    fn weights_are_those_of_the_formula_and_finite() {
        let p = [DVec3::ZERO, DVec3::X, DVec3::X + DVec3::Y, DVec3::Y, 2.0 * DVec3::X];
        let l = cotangent_stiffness(&p, &[[0, 1, 2], [0, 2, 3]]);
        assert_eq!(&l.rows[..4], &[0, 1, 2, 3]);
        let first_column = [1.0, -0.5, 0.0, -0.5];
        assert!(l.values[..4].iter().zip(first_column).all(|(a, b)| (a - b).abs() < 1e-9));
        let l = cotangent_stiffness(&p, &[[0, 1, 2], [0, 2, 3], [0, 4, 1]]);
        assert!(l.values.iter().all(|v| v.is_finite()));
        assert_eq!(lumped_masses(&p, &[[0, 4, 1]]), vec![0.0; 5]);
    }
}

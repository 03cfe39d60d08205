//! Park, Guo, Shin and Qin (2006), "Surface completion for shape and appearance", Eq. 13 to 16: a patch
//! bent to a rim by the Poisson equation.
//!
//! With g the patch where it was laid and f the result, the correction f − g is harmonic over the fill and
//! takes the rim of the patch to that of the hole (Eq. 15): f has the gradients of g as far as the rim
//! allows. Weights are the paper's, one over the length of the edge (Eq. 16).
//!
//! Differences from the paper: a direct solution, not conjugate gradients.

use super::domain::Domain;
use super::factor::Symmetric;
use glam::DVec3;

/// Positions of the fill's vertices from where a patch has them. `laid`: of each vertex of the domain, but
/// only those of fill and rim count. `None` if the system cannot be factored.
pub fn warp(domain: &Domain, laid: &[DVec3]) -> Option<Vec<DVec3>> {
    let (first, n) = (domain.fill.start, domain.fill.len());
    let known = |v: usize| domain.sheet.positions[v] - laid[v];
    let mut columns: Vec<Vec<(u32, f64)>> = (0..n).map(|i| vec![(i as u32, 0.0)]).collect();
    let mut rhs = vec![vec![0.0; n]; 3];
    for i in 0..n {
        for (k, _) in domain.laplacian.row(first + i) {
            // Edges of the fill alone: two vertices may lie at one place on the patch.
            let length = laid[first + i].distance(laid[k]).max(1e-6 * domain.edge);
            let weight = domain.edge / length;
            columns[i][0].1 += weight;
            match domain.fill.contains(&k) {
                true if k > first + i => columns[i].push(((k - first) as u32, -weight)),
                true => {}
                false => (0..3).for_each(|d| rhs[d][i] += weight * known(k)[d]),
            }
        }
    }
    Symmetric::from_columns(columns).factor(1.0, &vec![0.0; n])?.solve(&mut rhs);
    let moved = |i: usize| laid[first + i] + DVec3::new(rhs[0][i], rhs[1][i], rhs[2][i]);
    Some((0..n).map(moved).collect())
}

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

/// Corrections that are harmonic inside, with weights of one over the edges' lengths, and given elsewhere.
/// `laid`: where the vertices are; `beside`: the neighbours of each; `given`: the corrections at the border,
/// `None` inside. `None` if the system cannot be factored.
pub fn harmonic(
    laid: &[DVec3],
    beside: &dyn Fn(usize) -> Vec<usize>,
    given: &dyn Fn(usize) -> Option<DVec3>,
) -> Option<Vec<DVec3>> {
    let border: Vec<Option<DVec3>> = (0..laid.len()).map(given).collect();
    let inner: Vec<usize> = (0..laid.len()).filter(|&v| border[v].is_none()).collect();
    let mut number = vec![usize::MAX; laid.len()];
    inner.iter().enumerate().for_each(|(i, &v)| number[v] = i);
    let mut columns: Vec<Vec<(u32, f64)>> =
        (0..inner.len()).map(|i| vec![(i as u32, 0.0)]).collect();
    let mut rhs = vec![vec![0.0; inner.len()]; 3];
    for (i, &v) in inner.iter().enumerate() {
        let around = beside(v);
        let lengths = || around.iter().map(|&k| laid[v].distance(laid[k]));
        let mean = lengths().sum::<f64>() / around.len().max(1) as f64;
        for (length, &k) in lengths().zip(&around) {
            // Two vertices may lie at one place on the patch.
            let weight = 1.0 / length.max(1e-6 * mean).max(f64::MIN_POSITIVE);
            columns[i][0].1 += weight;
            match border[k] {
                None if k > v => columns[i].push((number[k] as u32, -weight)),
                None => {}
                Some(by) => (0..3).for_each(|d| rhs[d][i] += weight * by[d]),
            }
        }
    }
    Symmetric::from_columns(columns).factor(1.0, &vec![0.0; inner.len()])?.solve(&mut rhs);
    let of = |v: usize| match border[v] {
        Some(by) => by,
        None => DVec3::from([0, 1, 2].map(|d| rhs[d][number[v]])),
    };
    Some((0..laid.len()).map(of).collect())
}

/// Positions of the fill's vertices from where a patch has them. `laid`: of each vertex of the domain, but
/// only those of fill and rim count. `None` if the system cannot be factored.
pub fn warp(domain: &Domain, laid: &[DVec3]) -> Option<Vec<DVec3>> {
    let known = |v: usize| domain.is_known(v).then(|| domain.sheet.positions[v] - laid[v]);
    let beside = |v: usize| domain.laplacian.row(v).map(|(k, _)| k).collect();
    let by = harmonic(laid, &beside, &known)?;
    Some(domain.fill.clone().map(|v| laid[v] + by[v]).collect())
}

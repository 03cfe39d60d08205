//! Detail from one source at each vertex, low frequencies from all: one sparse solve in differential
//! coordinates (Sorkine et al. 2004, "Laplacian surface editing").
//!
//! Minimises, over the heights x of the fill with the known vertices fixed at 0,
//!
//!   Σ_fill  1/deg (L_u x − L_u p)²  +  deg (h² / 4ℓ²)² (x − B)²
//!
//! with L_u the uniform Laplacian, p the copy chosen at the vertex, B the base, h the edge length and
//! ℓ the length that parts detail from shape. Where relief can only be plausible, what this takes from the
//! detail of a copy is given back: L_u p is multiplied by |L_u p| / |L_u x|.

use super::domain::Domain;
use super::factor::Symmetric;
use super::overlap::{blend, choose};
use super::project::Place;
use super::view::View;
use crate::error::Result;

/// ℓ in hole radii: more gives more detail and more distance; between 0.1 and 0.14 measured on seventeen
/// holes.
const SPLIT: f64 = 0.11;

/// Detail that the solve weakens is laid on by this factor at most: the mane of a lion takes 1.3.
pub const MOST_GAIN: f64 = 1.5;

/// Vertices of a ring that are reported, at most about.
pub const SEEN: usize = 500;

/// The joined surface.
pub struct Joined {
    /// Height of each fill vertex.
    pub heights: Vec<f64>,
    /// View and copy that gave its detail; `None` where no window saw anything.
    pub labels: Vec<Option<(usize, usize)>>,
}

/// Joins what all windows saw; `None` if the system cannot be factored.
pub fn join(
    domain: &Domain,
    views: &[View<'_>],
    check: &dyn Fn() -> Result<()>,
) -> Result<Option<Joined>> {
    let n = domain.fill.len();
    let first = domain.fill.start;
    let base = blend(n, views);
    let labels = choose(domain, views, &base, check)?;
    // Height of a copy at a vertex of the domain; nothing where its window ends.
    let height = |label: Option<(usize, usize)>, v: usize| match (label, domain.is_known(v)) {
        (_, true) | (None, _) => Some(0.0),
        (Some((w, k)), false) => {
            let own = views[w].index(v - first)?;
            Some(views[w].fitted.heights[k][views[w].window.domain.fill.start + own])
        }
    };
    // What it says at v beside i; it goes on level where its window ends.
    let copied = |i: usize, v: usize| {
        let label = labels[i - first];
        height(label, v).or_else(|| height(label, i)).unwrap_or(0.0)
    };
    let l = &domain.laplacian;
    let ratio = (domain.edge / (SPLIT * domain.radius)).powi(2) / 4.0;
    let mut matrix = matrix(domain.fill.clone(), ratio, &|i| l.row(i).map(|(k, _)| k).collect());
    let Some(factor) = matrix.factor(1.0, &vec![0.0; n]) else { return Ok(None) };
    // Degree · height − those around it.
    let detail = |i: usize, height: &dyn Fn(usize) -> f64| {
        l.row(i).fold(0.0, |sum, (k, _)| sum + height(i) - height(k))
    };
    let solve = |gain: f64| {
        let mut rhs = vec![0.0; n];
        for i in domain.fill.clone() {
            let degree = l.row(i).count() as f64;
            let label = labels[i - first];
            let plausible = label.map_or(0.0, |(w, _)| views[w].plausible);
            let wanted = detail(i, &|k| copied(i, k)) * (1.0 + plausible * (gain - 1.0));
            let row = || std::iter::once((i, degree)).chain(l.row(i).map(|(k, _)| (k, -1.0)));
            for (a, x) in row().filter(|&(a, _)| domain.fill.contains(&a)) {
                rhs[a - first] += x * wanted / degree;
            }
            let hold = degree * ratio * ratio;
            rhs[i - first] += hold * base[i - first];
        }
        let mut solution = [rhs];
        factor.solve(&mut solution);
        let [heights] = solution;
        heights
    };
    let mut heights = solve(1.0);
    if views.iter().any(|view| view.plausible > 0.0) {
        // Where one copy gives all.
        let inside = |&i: &usize| {
            let same =
                |k: usize| domain.fill.contains(&k) && labels[k - first] == labels[i - first];
            labels[i - first].is_some() && l.row(i).all(|(k, _)| same(k))
        };
        let [mut wanted, mut kept] = [0.0; 2];
        for i in domain.fill.clone().filter(inside) {
            wanted += detail(i, &|k| copied(i, k)).powi(2);
            kept += detail(i, &|k| heights[k - first]).powi(2);
        }
        let gain = f64::sqrt(wanted / kept).clamp(1.0, MOST_GAIN);
        if gain > 1.0 {
            heights = solve(gain);
        }
    }
    Ok(Some(Joined { heights, labels }))
}

/// Σ_fill 1/deg L_uᵀ L_u + deg `ratio`² over the vertices of a fill, by the neighbours of each.
pub fn matrix(
    fill: std::ops::Range<usize>,
    ratio: f64,
    beside: &dyn Fn(usize) -> Vec<usize>,
) -> Symmetric {
    let first = fill.start;
    let mut columns: Vec<Vec<(u32, f64)>> =
        (0..fill.len()).map(|v| vec![(v as u32, 0.0)]).collect();
    for i in fill.clone() {
        let around = beside(i);
        let degree = around.len() as f64;
        let row = || std::iter::once((i, degree)).chain(around.iter().map(|&k| (k, -1.0)));
        for (a, x) in row().filter(|&(a, _)| fill.contains(&a)) {
            for (b, y) in row().filter(|&(b, _)| b >= a && fill.contains(&b)) {
                columns[a - first].push(((b - first) as u32, x * y / degree));
            }
        }
        columns[i - first][0].1 += degree * ratio * ratio;
    }
    Symmetric::from_columns(columns)
}

/// The vertices beside those of each label that have another or are the rim's, with it; sorted.
pub fn beside<L: Copy + Ord>(domain: &Domain, labels: &[Option<L>]) -> Vec<(usize, L)> {
    let first = domain.fill.start;
    let mut found = Vec::new();
    for v in domain.fill.clone() {
        let Some(label) = labels[v - first] else { continue };
        let around = domain.laplacian.row(v).map(|(w, _)| w);
        let other = |&w: &usize| domain.is_known(w) || labels[w - first] != Some(label);
        found.extend(around.filter(other).map(|w| (w, label)));
    }
    found.sort_unstable();
    found.dedup();
    found
}

/// Where copies lie beyond their borders: at the vertices beside those they gave, the rim's and other
/// copies'. Vertex of the domain, copy, place; sorted.
pub fn places_beside<'a>(
    domain: &Domain,
    views: &'a [View<'_>],
    labels: &[Option<(usize, usize)>],
) -> impl Iterator<Item = (u32, (usize, usize), Place)> + 'a {
    let wanted = beside(domain, labels);
    // Window vertex of each vertex of the domain.
    let own: Vec<Vec<u32>> = views
        .iter()
        .map(|view| {
            let mut own = vec![u32::MAX; domain.sheet.positions.len()];
            view.window.parent.iter().enumerate().for_each(|(i, &v)| own[v] = i as u32);
            own
        })
        .collect();
    wanted.into_iter().filter_map(move |(v, (w, k))| {
        let place = views[w].copies[k].places.get(own[w][v] as usize)?.as_ref()?;
        Some((v as u32, (w, k), *place))
    })
}

/// Where the copies that gave anything lie on the known rings around their windows. Vertex of the
/// neighbourhood, copy, place; sorted.
pub fn places_on_ring<'a>(
    views: &'a [View<'_>],
    labels: &[Option<(usize, usize)>],
) -> impl Iterator<Item = (u32, (usize, usize), Place)> + 'a {
    let mut used: Vec<(usize, usize)> = labels.iter().flatten().copied().collect();
    used.sort_unstable();
    used.dedup();
    used.into_iter().flat_map(move |(w, k)| {
        let domain = &views[w].window.domain;
        let step = domain.ring.len().div_ceil(SEEN).max(1);
        let at =
            move |&v: &usize| Some((domain.near_vertex(v), (w, k), views[w].copies[k].places[v]?));
        domain.ring.iter().step_by(step).filter_map(at)
    })
}

//! Detail from one source at each vertex, low frequencies from all: one sparse solve in differential
//! coordinates (Sorkine et al. 2004, "Laplacian surface editing").
//!
//! Minimises, over the heights x of the fill with the known vertices fixed at 0,
//!
//!   Σ_fill  1/deg (L_u x − L_u p)²  +  deg (h² / 4ℓ²)² (x − B)²
//!
//! with L_u the uniform Laplacian, p the copy chosen at the vertex, B the base, h the edge length and
//! ℓ the length that parts detail from shape.

use super::domain::Domain;
use super::factor::Symmetric;
use super::project::Place;
use super::view::View;

/// ℓ in hole radii: more gives more detail and more distance; between 0.1 and 0.14 measured on seventeen
/// holes.
const SPLIT: f64 = 0.11;

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
pub fn join(domain: &Domain, views: &[View<'_>]) -> Option<Joined> {
    let n = domain.fill.len();
    let first = domain.fill.start;
    let (mut base, mut labels) = (vec![0.0; n], vec![None; n]);
    for i in 0..n {
        let (mut sum, mut best) = (0.0, 0.0);
        for (w, view) in views.iter().enumerate() {
            let Some(own) = view.index(i) else { continue };
            let weight = view.window.weight[i];
            base[i] += weight * view.base[own];
            sum += weight;
            if weight > best {
                best = weight;
                labels[i] = Some((w, view.labels[own]));
            }
        }
        if sum > 0.0 {
            base[i] /= sum;
        }
    }
    // Height of a copy at a vertex of the domain; where its window ends, that of the base.
    let height = |label: Option<(usize, usize)>, v: usize| match (label, domain.is_known(v)) {
        (_, true) | (None, _) => 0.0,
        (Some((w, k)), false) => match views[w].index(v - first) {
            Some(own) => views[w].fitted.heights[k][views[w].window.domain.fill.start + own],
            None => base[v - first],
        },
    };
    let l = &domain.laplacian;
    let ratio = (domain.edge / (SPLIT * domain.radius)).powi(2) / 4.0;
    let matrix = matrix(domain.fill.clone(), ratio, &|i| l.row(i).map(|(k, _)| k).collect());
    let mut rhs = vec![0.0; n];
    for i in domain.fill.clone() {
        let degree = l.row(i).count() as f64;
        let label = labels[i - first];
        let around: f64 = l.row(i).map(|(k, _)| height(label, k)).sum();
        let wanted = degree * height(label, i) - around;
        let row = || std::iter::once((i, degree)).chain(l.row(i).map(|(k, _)| (k, -1.0)));
        for (a, x) in row().filter(|&(a, _)| domain.fill.contains(&a)) {
            rhs[a - first] += x * wanted / degree;
        }
        let hold = degree * ratio * ratio;
        rhs[i - first] += hold * base[i - first];
    }
    let mut solution = [rhs];
    let mut matrix = matrix;
    matrix.factor(1.0, &vec![0.0; n])?.solve(&mut solution);
    let [heights] = solution;
    Some(Joined { heights, labels })
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

/// Where copies lie beyond their borders: at the vertices beside those they gave, the rim's and other
/// copies'. Vertex of the domain, copy, place; sorted.
pub fn places_beside<'a>(
    domain: &Domain,
    views: &'a [View<'_>],
    labels: &[Option<(usize, usize)>],
) -> impl Iterator<Item = (u32, (usize, usize), Place)> + 'a {
    let first = domain.fill.start;
    let mut wanted = Vec::new();
    for v in domain.fill.clone() {
        let Some(label) = labels[v - first] else { continue };
        let beside = domain.laplacian.row(v).map(|(w, _)| w);
        let other = |&w: &usize| domain.is_known(w) || labels[w - first] != Some(label);
        wanted.extend(beside.filter(other).map(|w| (w, label)));
    }
    wanted.sort_unstable();
    wanted.dedup();
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

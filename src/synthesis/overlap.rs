//! Windows of a long hole put together: the base they agree on, and which copy of which window gives the detail at
//! each vertex, by the same graph cut as within a window.

use super::domain::Domain;
use super::labels::Energy;
use super::view::View;
use crate::error::Result;
use crate::matching::paint::EDGES;

/// Sum of the windows' weights below which the initial completion has a say: where all windows serve no vertex has
/// less.
const SURE: f64 = 0.26;
/// Weight from which on a window's copies may give the detail: 0.85 of its radius from its middle.
const FAR: f64 = 0.077;
/// Costs, in edges, of a copy that its own window would not have chosen there, and of one whose window's middle is far
/// off: enough to decide where all agree.
const OTHER: f64 = 0.1;
const ASIDE: f64 = 0.1;

/// View and copy.
pub type Label = (usize, usize);

/// What the windows agree on, each as far as it reaches; where none does, the initial completion.
pub fn blend(n: usize, views: &[View<'_>]) -> Vec<f64> {
    let at = |i: usize| {
        let (mut height, mut sum) = (0.0, 0.0);
        for view in views {
            if let Some(own) = view.index(i) {
                height += view.window.weight[i] * view.base[own];
                sum += view.window.weight[i];
            }
        }
        height / f64::max(sum, SURE)
    };
    (0..n).map(at).collect()
}

/// The copy that gives the detail at each vertex of the fill: of a view of all the one it chose; of several such that
/// seams between windows, too, run where copies agree. `None`: no window reaches there.
pub fn choose(
    domain: &Domain,
    views: &[View<'_>],
    base: &[f64],
    check: &dyn Fn() -> Result<()>,
) -> Result<Vec<Option<Label>>> {
    if let Some(view) = views.first().filter(|view| !view.window.is_part()) {
        return Ok((0..base.len()).map(|i| Some((0, view.labels[view.index(i)?]))).collect());
    }
    let (mut label, mut unary, mut values, mut rows) = (vec![], vec![], vec![], vec![]);
    for offer in offers(domain, views, base) {
        label.push(offer.label);
        unary.push(offer.cost);
        values.push(offer.height);
        rows.push(offer.colours);
    }
    let channels = domain.paint.as_ref().map_or(0, |p| p.channels);
    let cheapest = |i: usize| {
        let cost = |l: &usize| unary[*l][i];
        (0..unary.len()).min_by(|a, b| cost(a).total_cmp(&cost(b))).unwrap_or(0)
    };
    let start = (0..base.len()).map(cheapest).collect();
    let rows = (if channels > 0 { &rows[..] } else { &[] }, channels);
    let edges = domain.fill_edges();
    let energy = Energy { unary: &unary, values: &values, rows, edges: &edges };
    let order: Vec<usize> = (0..unary.len()).collect();
    let labels = energy.minimise(start, &order, check)?;
    Ok(labels.into_iter().map(|l| label[l]).collect())
}

/// What may give the detail, by fill vertex.
struct Offer {
    /// `None`: the initial completion.
    label: Option<Label>,
    /// Infinite where it does not reach.
    cost: Vec<f64>,
    height: Vec<f64>,
    /// Rows, in mesh units.
    colours: Vec<f64>,
}

/// What each window chose somewhere, and the initial completion where none reaches.
fn offers(domain: &Domain, views: &[View<'_>], base: &[f64]) -> Vec<Offer> {
    let channels = domain.paint.as_ref().map_or(0, |p| p.channels);
    let mut all = Vec::new();
    for (w, view) in views.iter().enumerate() {
        let mut chosen = view.labels.clone();
        chosen.sort_unstable();
        chosen.dedup();
        all.extend(chosen.into_iter().map(|k| offer(domain, views, (w, k), base)));
    }
    let is_bare = |i: usize| views.iter().all(|view| view.window.weight[i] <= FAR);
    let bare = |i: usize| if is_bare(i) { 0.0 } else { f64::INFINITY };
    all.push(Offer {
        label: None,
        cost: (0..base.len()).map(bare).collect(),
        height: vec![0.0; base.len()],
        colours: vec![0.0; base.len() * channels],
    });
    all
}

fn offer(domain: &Domain, views: &[View<'_>], (w, k): Label, base: &[f64]) -> Offer {
    let (view, edge) = (&views[w], domain.edge);
    let first = view.window.domain.fill.start;
    let height: Vec<f64> = (0..base.len())
        .map(|i| view.index(i).map_or(base[i], |own| view.fitted.heights[k][first + own]))
        .collect();
    let cost = |i: usize| {
        let weight = view.window.weight[i];
        match view.index(i).filter(|_| weight > FAR) {
            Some(own) => {
                let other = if view.labels[own] == k { 0.0 } else { OTHER * edge };
                (height[i] - base[i]).abs() + other + ASIDE * edge * (1.0 - weight)
            }
            None => f64::INFINITY,
        }
    };
    let channels = domain.paint.as_ref().map_or(0, |p| p.channels);
    let rows = &view.copies[k].rows;
    let mut colours = vec![0.0; base.len() * channels];
    for (i, row) in colours.chunks_exact_mut(channels.max(1)).enumerate() {
        if let Some(own) = view.index(i) {
            let copied = &rows[(first + own) * channels..];
            row.iter_mut().zip(copied).for_each(|(to, x)| *to = EDGES * edge * x);
        }
    }
    Offer { label: Some((w, k)), cost: (0..base.len()).map(cost).collect(), height, colours }
}

//! What one window sees: copies projected, fitted, ranked, agreed on, and one chosen at each vertex.

use super::fit::{fit, Fitted};
use super::labels::Energy;
use super::project::{project, Copy, Place};
use super::rank::{score, weights};
use super::window::Window;
use crate::error::Result;
use crate::matching::rigid::Rigid;
use crate::matching::source::Source;

/// Consensus weight of a copy: (score / best score)^−this. 2 to 4 differ little.
const POWER: i32 = 2;
/// Cost of a vertex' own ring error in the choice of copies, against the cost of seams.
const OWN: f64 = 0.3;
/// Cost of differing from the consensus: the copy that agrees with most is the likeliest.
const APART: f64 = 1.0;
/// Ratio of the consensus' error to the smooth plate's up to which the plate has no say, and from
/// which it has all the say that the hidden ring gives it.
const TRUSTED: (f64, f64) = (0.5, 0.8);

/// The copies were chosen by the same ring that then says how far to trust them: at equal errors their
/// share is cut by this part.
const OPTIMISM: f64 = 0.6;
/// Ratio from which on a smooth surface is the better guess.
const HOPELESS: f64 = 1.1;

/// A window with all that was found for it.
pub struct View<'a> {
    /// The window.
    pub window: &'a Window,
    /// All copies.
    pub copies: Vec<Copy>,
    /// Fitted to the ring.
    pub fitted: Fitted,
    /// Low frequencies: the heights that the copies agree on, by fill vertex of the window.
    pub base: Vec<f64>,
    /// The copy that gives the detail, by fill vertex of the window.
    pub labels: Vec<usize>,
    /// Share of each copy in the base; they sum to 1.
    pub shares: Vec<f64>,
    /// 0 where the copies are trusted alone, 1 where the hidden ring decides what the smooth plate gets.
    pub doubt: f64,
    /// 1 / (1 + ratio²), ratio of the consensus' error to the plate's where the ring was hidden.
    pub confidence: f64,
    /// Window vertex of each fill vertex of the whole hole.
    own: Vec<Option<usize>>,
}

impl View<'_> {
    /// Place on the source of copy `k` at fill vertex `i` of the whole hole.
    pub fn place(&self, i: usize, k: usize) -> Option<Place> {
        self.copies[k].places[self.own[i]?]
    }

    /// Number of a fill vertex of the whole among the window's fill.
    pub fn index(&self, i: usize) -> Option<usize> {
        self.own[i].map(|v| v - self.window.domain.fill.start)
    }
}

/// Looks at the candidates through a window; `None` if none serves. `roughness` is the ring's.
pub fn look<'a>(
    window: &'a Window,
    source: &Source,
    candidates: &[Rigid],
    roughness: f64,
    threads: usize,
    check: &dyn Fn(f64) -> Result<()>,
) -> Result<Option<View<'a>>> {
    let domain = &window.domain;
    let one = |i: usize| project(domain, source, &candidates[i]);
    let copies: Vec<Copy> =
        crate::parallel::map_part(candidates.len(), threads, &|part| check(0.4 * part), &one)?
            .into_iter()
            .flatten()
            .collect();
    if copies.is_empty() || domain.fill.is_empty() {
        return Ok(None);
    }
    let Some(fitted) = fit(domain, &copies, threads, &|part| check(0.4 + 0.3 * part))? else {
        return Ok(None);
    };
    let scores = score(domain, &copies, &fitted, roughness);
    check(0.7)?;
    let (first, n) = (domain.fill.start, domain.fill.len());
    let mut shares = vec![0.0; copies.len()];
    let mut base = Vec::with_capacity(n);
    for i in 0..n {
        let w = weights(&scores, i, POWER);
        base.push(w.iter().zip(&fitted.heights).map(|(w, h)| w * h[first + i]).sum::<f64>());
        shares.iter_mut().zip(&w).for_each(|(s, w)| *s += w / n as f64);
    }
    let (share, ratio) = fitted.trust(&shares);
    if ratio > HOPELESS {
        return Ok(None);
    }
    let doubt = ((ratio - TRUSTED.0) / (TRUSTED.1 - TRUSTED.0)).clamp(0.0, 1.0);
    let apart = APART * (1.0 - 0.4 * doubt);
    let labels = choose_labels(window, &fitted, &scores, &base, apart, &|| check(0.75))?;
    let share = share * (1.0 - OPTIMISM * ratio * ratio);
    base.iter_mut().for_each(|b| *b *= 1.0 - doubt * (1.0 - share));
    check(1.0)?;
    let mut own = vec![None; window.weight.len()];
    let whole_start = window.whole_start();
    domain.fill.clone().for_each(|v| own[window.parent[v] - whole_start] = Some(v));
    let confidence = 1.0 / (1.0 + ratio * ratio);
    Ok(Some(View { window, copies, fitted, base, labels, shares, doubt, confidence, own }))
}

fn choose_labels(
    window: &Window,
    fitted: &Fitted,
    scores: &super::rank::Scores,
    base: &[f64],
    apart: f64,
    check: &dyn Fn() -> Result<()>,
) -> Result<Vec<usize>> {
    let domain = &window.domain;
    let first = domain.fill.start;
    let mut edges = Vec::new();
    for v in domain.fill.clone() {
        let later = domain.laplacian.row(v).filter(|&(w, _)| w > v && domain.fill.contains(&w));
        edges.extend(later.map(|(w, _)| ((v - first) as u32, (w - first) as u32)));
    }
    let values: Vec<Vec<f64>> =
        fitted.heights.iter().map(|h| h[domain.fill.clone()].to_vec()).collect();
    // The score's second factor alone is a length, as the seams are.
    let scale = OWN / fitted.error[scores.best].max(f64::MIN_POSITIVE);
    let unary: Vec<Vec<f64>> = scores
        .local
        .iter()
        .zip(&values)
        .map(|(own, h)| {
            let cost = |i: usize| scale * own[i] + apart * (h[i] - base[i]).abs();
            (0..base.len()).map(cost).collect()
        })
        .collect();
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&a, &b| scores.mean[a].total_cmp(&scores.mean[b]).then(a.cmp(&b)));
    Energy { unary: &unary, values: &values, edges: &edges }.minimise(scores.best, &order, check)
}

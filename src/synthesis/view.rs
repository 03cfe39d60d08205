//! What one window sees: copies projected, fitted, ranked, agreed on, and one chosen at each vertex.

use super::domain::Domain;
use super::fit::{fit, Chosen, Fitted};
use super::labels::Energy;
use super::project::{project, Copy, Place};
use super::rank::{score, weights};
use super::window::Window;
use crate::error::Result;
use crate::matching::paint::{squared_difference, EDGES};
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

/// The same ratio from which on, and from which wholly, relief shall look right rather than lie near: from where
/// there is no trust left to where copies are of no use.
const PLAUSIBLE: (f64, f64) = (TRUSTED.1, 1.0);

/// The copies were chosen by the same ring that then says how far to trust them: at equal errors their
/// share is cut by this part.
const OPTIMISM: f64 = 0.6;
/// Ratio from which on a smooth surface is the better guess.
pub const HOPELESS: f64 = 1.1;
/// The ratio of a window of a long hole counts so many times: the ring lies nearer to all of a narrow fill than around
/// a hole of its radius, so that what was aligned by it predicts it better than the fill. Measured on bands and on
/// cracks in plates: at 1 relief is laid on across bands where it does not belong and cracks are filled 4 % worse, at
/// 1.5 flutes and meander that do go on are left out; cracks through ornament do not change.
const BESIDE: f64 = 1.3;
/// Part of the ring's variance of colour that a copy may leave for its colours to be believed where its
/// shape is not: a smooth or flat wall that is painted.
const SAME_COLOURS: f64 = 0.4;

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
    /// 0 where distances count, 1 where relief can only be plausible: copies say no more of the hidden ring than
    /// the smooth plate does.
    pub plausible: f64,
    /// Whether the shape stays the smooth one, and only the colours are copied.
    pub is_smooth: bool,
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

/// Looks at the candidates through a window; `None` if none serves. `roughness` is the ring's; `before` what was
/// [chosen](Fitted::chosen) in a look at nearly the same surface.
pub fn look<'a>(
    window: &'a Window,
    source: &Source,
    candidates: &[Rigid],
    (roughness, before): (f64, Option<Chosen>),
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
    let late = |part: f64| check(0.4 + 0.3 * part);
    let Some(mut fitted) = fit(domain, &copies, window.plate.as_ref(), before, threads, &late)?
    else {
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
    let (mut share, mut ratio) = fitted.trust(&shares);
    if window.is_part() {
        ratio *= BESIDE;
    }
    let is_smooth = ratio > HOPELESS;
    if is_smooth {
        if !matches_colours(domain, &copies) {
            return Ok(None);
        }
        // The shape stays the smooth one; where the colours come from is still to be said.
        fitted.heights.iter_mut().for_each(|h| h.fill(0.0));
        base.fill(0.0);
        share = 0.0;
    }
    let doubt = ((ratio - TRUSTED.0) / (TRUSTED.1 - TRUSTED.0)).clamp(0.0, 1.0);
    let apart = APART * (1.0 - 0.4 * doubt);
    let labels = choose_labels(window, &copies, &fitted, &scores, &base, apart, &|| check(0.75))?;
    let share = share * (1.0 - OPTIMISM * ratio * ratio);
    base.iter_mut().for_each(|b| *b *= 1.0 - doubt * (1.0 - share));
    check(1.0)?;
    let mut own = vec![None; window.weight.len()];
    let whole_start = window.whole_start();
    domain.fill.clone().for_each(|v| own[window.parent[v] - whole_start] = Some(v));
    let confidence = 1.0 / (1.0 + ratio * ratio);
    Ok(Some(View {
        window,
        copies,
        fitted,
        base,
        labels,
        shares,
        doubt,
        plausible: ((ratio - PLAUSIBLE.0) / (PLAUSIBLE.1 - PLAUSIBLE.0)).clamp(0.0, 1.0),
        is_smooth,
        confidence,
        own,
    }))
}

/// Whether some copy has on the ring what is known there, far better than one colour all over would.
fn matches_colours(domain: &Domain, copies: &[Copy]) -> bool {
    let Some(known) = &domain.paint else { return false };
    let n = domain.ring.len().max(1) as f64;
    let mut mean = vec![0.0; known.channels];
    for &v in &domain.ring {
        mean.iter_mut().zip(known.row(v)).for_each(|(m, x)| *m += x / n);
    }
    let plain: f64 = domain.ring.iter().map(|&v| squared_difference(known.row(v), &mean)).sum();
    let of = |c: &Copy| domain.ring.iter().map(|&v| c.stain[v]).sum::<f64>();
    copies.iter().map(of).fold(f64::INFINITY, f64::min) < SAME_COLOURS * plain
}

fn choose_labels(
    window: &Window,
    copies: &[Copy],
    fitted: &Fitted,
    scores: &super::rank::Scores,
    base: &[f64],
    apart: f64,
    check: &dyn Fn() -> Result<()>,
) -> Result<Vec<usize>> {
    let domain = &window.domain;
    let edges = domain.fill_edges();
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
    let channels = domain.paint.as_ref().map_or(0, |p| p.channels);
    let of_fill = |c: &Copy| -> Vec<f64> {
        let rows = &c.rows[domain.fill.start * channels..domain.fill.end * channels];
        rows.iter().map(|x| EDGES * domain.edge * x).collect()
    };
    let painted = copies.iter().filter(|c| !c.rows.is_empty());
    let rows: Vec<Vec<f64>> = painted.map(of_fill).collect();
    let rows = (&rows[..], channels);
    let energy = Energy { unary: &unary, values: &values, rows, edges: &edges };
    energy.minimise(vec![scores.best; base.len()], &order, check)
}

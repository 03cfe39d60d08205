//! Which transforms a hole is looked at with: those that the search finds, as it is guided
//! ([`crate::Guidance`]): one given by hand, sources of other sizes, one candidate of several.

use super::library::Library;
use super::Completer;
use crate::error::Result;
use crate::guidance::{Guidance, Placement};
use crate::matching::icp::{misfit, worth, RingPoint};
use crate::matching::rigid::Rigid;
use crate::matching::ring_pattern::Candidate;
use crate::matching::search::{find_candidates, thin_ring, Target, POINTS};
use crate::matching::similarity::{gap, refine, scale_of, scaled, scaling};
use crate::options::{Exemplar, Options};
use crate::parallel;
use crate::progress::Monitor;
use crate::result::Completion;
use crate::synthesis::fit::Chosen;
use crate::synthesis::view::{View, HOPELESS};
use glam::DVec3;
use std::slice::from_ref;
use std::sync::Arc;

/// The ratio of one scale that is tried to the next: the alignment finds a scale that is off by half of
/// it, and rings that are stretched by 5 % still look alike to the search.
const SCALE_STEP: f64 = 1.1;
/// Candidates of each scale that are aligned with their scale.
const TRIED: usize = 8;
/// Candidates kept of all scales.
const KEPT: usize = 40;
/// A misfit and a gap of less than these parts of an edge are an exact copy's: no other scale is tried, and
/// only such copies are kept. Two samplings of one surface differ by more.
const EXACT: (f64, f64) = (0.1, 1e-3);
/// Farthest that a partner may lie, in hole radii, as in the search.
const REACH: f64 = 0.5;
/// Two transforms that lay the hole onto places nearer to each other than this, in hole radii (root mean
/// square), are one candidate: the alignments of one place differ by some hundredths, and ornament repeats
/// seldom within a fifth of what is lost.
const SAME: f64 = 0.2;
/// Places of each window that may serve all windows of a hole, and the gap, in edges, up to which one does: two
/// scans of one thing differ by less, other things by more all around a long hole.
const COMMON: (usize, f64) = (2, 0.5);
/// Points of a fill that are compared, at most about.
const SEEN: usize = 64;

/// The transforms of each of some windows.
pub type Transforms = Arc<Vec<Vec<Rigid>>>;

/// The scales at which exemplars are as large as the mesh, by their areas: an intact twin's, nearly.
pub fn guess_scales(area: f64, exemplar: Option<&Exemplar>) -> Vec<f64> {
    let Some(exemplar) = exemplar else { return Vec::new() };
    let mut areas = vec![0.0; exemplar.parts.len().max(1)];
    for face in &exemplar.faces {
        let [a, b, c] = face.map(|v| DVec3::from(exemplar.vertices[v as usize]));
        areas[exemplar.part_of(face[0])] += 0.5 * (b - a).cross(c - a).length();
    }
    areas.iter().map(|own| (area / own).sqrt()).filter(|s| s.is_finite()).collect()
}

/// The transforms that some windows of a hole are looked at with; the windows share one radius.
pub fn transforms(
    library: &Library,
    guidance: &Guidance,
    targets: &[Target<'_>],
    threads: usize,
    check: &dyn Fn(f64) -> Result<()>,
) -> Result<Transforms> {
    if let Some(placement) = &guidance.placement {
        check(0.0)?;
        return Ok(Arc::new(vec![vec![placed(library, placement, targets)]; targets.len()]));
    }
    if let Some(range) = guidance.scales.filter(|&range| range != [1.0, 1.0]) {
        let make = || search_scales(library, targets, range, threads, check);
        return library.kept.scaled.find(targets, Some(range), make);
    }
    let found = library.candidates(targets, threads, check)?;
    let transforms = |list: &Vec<Candidate>| list.iter().map(|c| c.transform).collect();
    Ok(Arc::new(found.iter().map(transforms).collect()))
}

/// The one place that serves all windows of a hole, if there is one: of the best of each that which fits the rings of
/// all, aligned with them.
pub fn common(
    library: &Library,
    guidance: &Guidance,
    targets: &[Target<'_>],
    found: &[Vec<Rigid>],
    threads: usize,
    check: &dyn Fn() -> Result<()>,
) -> Result<Option<Rigid>> {
    let (source, edge) = (library.source(), library.known.edge);
    let (ring, radius) = ring_of_all(library, targets, 2 * POINTS[1]);
    let fill: Vec<DVec3> = targets.iter().flat_map(|t| t.fill.iter().copied()).collect();
    let firsts = found.iter().flat_map(|list| list.iter().take(COMMON.0).copied());
    let starts = distinct(firsts, &fill, 0.25 * SAME * radius, KEPT);
    let one = |i: usize| {
        let with_scale = guidance.scales.is_some();
        let place = refine(source, &ring, &starts[i], with_scale, REACH * radius);
        (gap(source, &ring, &place, radius), place)
    };
    let tried = parallel::map(starts.len(), threads, check, &one)?;
    let best = tried.into_iter().min_by(|a, b| a.0.total_cmp(&b.0));
    Ok(best.filter(|b| b.0 < COMMON.1 * edge).map(|b| b.1))
}

/// The rings of all windows, of about so many points at most, and the greatest radius.
fn ring_of_all(library: &Library, targets: &[Target<'_>], most: usize) -> (Vec<RingPoint>, f64) {
    let all: Vec<RingPoint> = targets.iter().flat_map(|t| t.ring.iter().copied()).collect();
    let radius = targets.iter().map(|t| t.radius).fold(0.0, f64::max);
    (thin_ring(&all, most, &library.known.axes), radius)
}

/// The transform given by hand, improved on the rings of all windows if that is wished for.
pub fn placed(library: &Library, placement: &Placement, targets: &[Target<'_>]) -> Rigid {
    let Placement { transform, refined } = *placement;
    if !refined {
        return transform;
    }
    let (ring, radius) = ring_of_all(library, targets, POINTS[1] * targets.len());
    // What is of another size is seldom so exactly.
    let with_scale = (scale_of(&transform) - 1.0).abs() > 1e-6;
    refine(library.source(), &ring, &transform, with_scale, REACH * radius)
}

/// Scales to try: where the exemplars are as large as the mesh, then none, then the whole range.
fn hypotheses(guesses: &[f64], [least, most]: [f64; 2]) -> Vec<f64> {
    let inside = |s: &f64| (least..=most).contains(s);
    let mut all: Vec<f64> = guesses.iter().copied().filter(inside).collect();
    all.extend(Some(1.0).filter(inside));
    let steps = ((most / least).ln() / SCALE_STEP.ln()).ceil().max(1.0);
    let last = if most > least { steps as usize } else { 0 };
    all.extend((0..=last).map(|i| least * (most / least).powf(i as f64 / steps)));
    all
}

/// The best places at any scale of a range, best first: at each scale the search, then the alignment that
/// scales, too.
fn search_scales(
    library: &Library,
    targets: &[Target<'_>],
    range: [f64; 2],
    threads: usize,
    check: &dyn Fn(f64) -> Result<()>,
) -> Result<Transforms> {
    let (source, known) = (library.source(), &library.known);
    let rings: Vec<Vec<RingPoint>> =
        targets.iter().map(|t| thin_ring(t.ring, POINTS[1], &known.axes)).collect();
    let mut all: Vec<Vec<Candidate>> = vec![Vec::new(); targets.len()];
    let tried = hypotheses(&library.guesses, range);
    for (i, &scale) in tried.iter().enumerate() {
        let part = |part: f64| check((i as f64 + part) / tried.len() as f64);
        let source = scaled(source, scale, &|| part(0.0))?;
        let radius = targets.first().map_or(0.0, |t| t.radius);
        let maps = library.maps_of(&source, radius, &|| part(0.1))?;
        let late = |p: f64| part(0.1 + 0.8 * p);
        let found = find_candidates(known, &source, &maps, targets, threads, &late)?;
        for (w, mut list) in found.into_iter().enumerate() {
            list.truncate(TRIED);
            let align = |k: usize| {
                let Candidate { transform, bland, cost } = list[k];
                let aligned = refine(&source, &rings[w], &transform, true, REACH * radius);
                let whole = aligned.after(&scaling(scale));
                match (range[0]..=range[1]).contains(&scale_of(&whole)) {
                    true => {
                        let cost = bland
                            * misfit(&source, &rings[w], &aligned, [radius, worth(&source)], None);
                        Candidate { transform: whole, bland, cost }
                    }
                    false => Candidate { transform: transform.after(&scaling(scale)), bland, cost },
                }
            };
            all[w].extend(parallel::map(list.len(), threads, &|| part(0.9), &align)?);
        }
        let is_exact = |c: &Candidate, w: usize| {
            c.cost < EXACT.0 * known.edge
                && gap(library.source(), &rings[w], &c.transform, radius) < EXACT.1 * known.edge
        };
        let exact: Vec<Vec<Candidate>> = (all.iter().enumerate())
            .map(|(w, list)| list.iter().filter(|c| is_exact(c, w)).copied().collect())
            .collect();
        if exact.iter().all(|list| !list.is_empty()) {
            all = exact;
            break;
        }
    }
    let best = |(mut list, target): (Vec<Candidate>, &Target<'_>)| {
        list.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        let transforms = list.iter().map(|c| c.transform);
        distinct(transforms, target.fill, 0.25 * SAME * target.radius, KEPT)
    };
    Ok(Arc::new(all.into_iter().zip(targets).map(best).collect()))
}

/// The transforms that lay some points onto places farther than `apart` from those of all before, at most
/// `most` of them.
fn distinct(
    transforms: impl Iterator<Item = Rigid>,
    points: &[DVec3],
    apart: f64,
    most: usize,
) -> Vec<Rigid> {
    let step = points.len().div_ceil(SEEN).max(1);
    let places = |t: &Rigid| -> Vec<DVec3> {
        let back = t.inverse();
        points.iter().step_by(step).map(|&p| back.point(p)).collect()
    };
    let mut kept: Vec<(Rigid, Vec<DVec3>)> = Vec::new();
    for transform in transforms {
        if kept.len() == most {
            break;
        }
        // Lengths on the source, in units of the target.
        let (own, scale) = (places(&transform), scale_of(&transform));
        let near = |other: &(Rigid, Vec<DVec3>)| {
            let square: f64 = own.iter().zip(&other.1).map(|(a, b)| a.distance_squared(*b)).sum();
            scale * (square / own.len().max(1) as f64).sqrt() < apart
        };
        if !kept.iter().any(near) {
            kept.push((transform, own));
        }
    }
    kept.into_iter().map(|k| k.0).collect()
}

/// The candidates of a window: what was found for it, best first by the fit, each place once, without
/// those that predict known surface worse than a smooth one does (they may have its colours). `look`: at all that
/// was found, if that was not yet done.
pub fn rank(
    library: &Library,
    guidance: &Guidance,
    target: &Target<'_>,
    look: impl FnOnce() -> Result<Ranked>,
) -> Result<Arc<Ranked>> {
    library.kept.ranked.find(from_ref(target), guidance.scales, || Ok(Arc::new(look()?)))
}

impl Completer<'_> {
    /// The `count` best candidates, best first: the completion that each alone makes, with its transform,
    /// error and confidence in the reports. Fewer if there are fewer; of holes that have different numbers
    /// as many as one has, and those that have no more get smooth fills. None if nothing serves.
    /// The search is done once. `options.guidance.candidate` is not read.
    pub fn candidates(
        &self,
        count: usize,
        options: &Options,
        monitor: &Monitor,
    ) -> Result<Vec<Completion>> {
        let mut all = Vec::new();
        for candidate in 1..=count {
            let guidance = Guidance { candidate, ..options.guidance.clone() };
            let done = |part: f64| (candidate as f64 - 1.0 + part) / count as f64;
            let report = |part: f64, stage: &str| monitor.step(done(part), stage).is_ok();
            let own = Options { guidance, ..options.clone() };
            let made = self.complete(&own, &Monitor::new(&report))?;
            if made.holes.iter().all(|h| h.candidates < candidate) {
                break;
            }
            all.push(made);
        }
        monitor.step(1.0, "done")?;
        Ok(all)
    }
}

/// What a look at all that was found says of it.
#[derive(Default)]
pub struct Ranked {
    /// The candidates, the best first, each place once.
    pub places: Vec<Rigid>,
    /// The stiffnesses chosen for all of them, if any serves.
    pub chosen: Option<Chosen>,
}

impl Ranked {
    /// Of a view of all, if any serves.
    pub fn of(view: Option<&View<'_>>, target: &Target<'_>) -> Self {
        let Some(view) = view else { return Self::default() };
        let mut order: Vec<usize> = (0..view.copies.len()).collect();
        order.sort_by(|&a, &b| view.shares[b].total_cmp(&view.shares[a]).then(a.cmp(&b)));
        let painted = view.window.domain.paint.is_some();
        let worst = HOPELESS * view.fitted.plate_error;
        order.retain(|&k| painted || view.fitted.error[k] <= worst);
        let copies = order.iter().map(|&k| view.copies[k].transform);
        let places = distinct(copies, target.fill, SAME * target.radius, usize::MAX);
        Self { places, chosen: Some(view.fitted.chosen) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DMat3;

    #[test]
    fn scales_cover_their_range() {
        for (range, count) in [([1.0, 1.0], 2), ([0.5, 0.5], 1), ([0.1, 10.0], 52), ([0.9, 1.0], 4)]
        {
            let all = hypotheses(&[2.0, 20.0], range);
            assert_eq!(all.len(), count, "{all:?}");
            assert!(all.iter().all(|s| (range[0]..=range[1] * (1.0 + 1e-12)).contains(s)));
            let mut sorted = all;
            sorted.sort_by(f64::total_cmp);
            assert!(sorted.windows(2).all(|w| w[1] < 1.1001 * w[0]));
        }
        assert_eq!(hypotheses(&[2.0], [0.1, 10.0])[..2], [2.0, 1.0]);
    }

    /// A turn about the patch's own middle is another place for what is off the middle, a small shift is
    /// not; the first of two stays.
    #[test]
    fn places_that_are_the_same_count_once() {
        let points: Vec<DVec3> =
            (0..50).map(|i| DVec3::new((i % 7) as f64 - 3.0, (i / 7) as f64 - 3.0, 0.0)).collect();
        let turn = |angle: f64| Rigid {
            linear: DMat3::from_axis_angle(DVec3::Z, angle),
            translation: DVec3::ZERO,
        };
        let shift = |by: f64| Rigid { translation: by * DVec3::X, ..Rigid::IDENTITY };
        let all = [turn(0.0), shift(0.3), turn(0.05), turn(1.6), shift(2.0), scaling(2.0)];
        let kept = distinct(all.into_iter(), &points, 0.5, 9);
        assert_eq!(kept, [turn(0.0), turn(1.6), shift(2.0), scaling(2.0)]);
        assert_eq!(distinct(all.into_iter(), &points, 0.5, 2), [turn(0.0), turn(1.6)]);
    }
}

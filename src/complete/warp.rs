//! Park, Guo, Shin and Qin (2006), "Surface completion for shape and appearance", Sec. 5 and 6: the patch of
//! the object whose surroundings are the most similar is warped into the hole.
//!
//! Reads as the list of its steps; `docs/warp.md` explains them. Differences from the paper:
//! - Of the best aligned patches the one is taken that predicts best what is known near the rim and was
//!   hidden from it. Where a smooth surface predicts that better the fill stays smooth.
//! - The vertices are those of the smooth fill, moved onto the patch along their normals, twice: the
//!   second time from the surface that the first found.
//! - Colours come from another place only where the shape's has not those known around the hole.

use super::coherent::{
    domain_of, roughness, take_density, tell, with_colours, Search, AGAIN, LEAST,
};
use super::guided::{placed, Ranked};
use super::smooth::{Fill, Story, Surroundings};
use crate::error::Result;
use crate::fill::even::refine_for;
use crate::fill::patch::Patch;
use crate::matching::height_map::Frame;
use crate::matching::rigid::Rigid;
use crate::matching::search::{align_candidates, Target};
use crate::matching::signature::{most_similar, By, Hole};
use crate::options::Sizing;
use crate::progress::Pace;
use crate::synthesis::domain::{Domain, Extent};
use crate::synthesis::resemblance::coherence_error;
use crate::synthesis::view::{look, View};
use crate::synthesis::warp::warp;
use crate::synthesis::window::{one_window, Window};
use std::slice::from_ref;
use std::sync::Arc;

/// Aligned patches that are judged by what they predict.
const JUDGED: usize = 12;
/// Parts of the whole by what the steps cost: until the search ends, until the first warp does.
const PARTS: (f64, f64) = (0.6, 0.8);

/// The completion of a hole whose smooth completion is given. `Ok(None)`: no patch serves.
pub fn complete_hole(
    around: &Surroundings<'_>,
    fill: &Fill,
    search: &Search<'_>,
    check: &dyn Fn(f64) -> Result<()>,
) -> Result<Option<(Patch, Story)>> {
    if fill.patch.new_count() < LEAST {
        return Ok(None);
    }
    let task = Task { around, fill, search, check };
    let find = |domain: &Domain, target: Target<'_>| {
        task.find(domain, &target, By::Colour, &|_| check(1.0))
    };
    with_colours(around, fill, search, task.shape()?, &find, &|| check(1.0))
}

/// One hole.
struct Task<'a> {
    around: &'a Surroundings<'a>,
    fill: &'a Fill,
    search: &'a Search<'a>,
    check: &'a dyn Fn(f64) -> Result<()>,
}

impl Task<'_> {
    fn shape(&self) -> Result<Option<(Patch, Story)>> {
        let &Self { around, fill, search, check } = self;
        let library = search.library;
        let domain = |patch: &Patch, extent| domain_of(around, fill, library, patch, extent);
        let Some(whole) = domain(&fill.patch, Extent::Whole) else { return Ok(None) };
        let Some(window) = one_window(&whole) else { return Ok(None) };
        let Some(chosen) = self.choose(&window)? else { return Ok(None) };
        let late = |part: f64| check(PARTS.1 + (1.0 - PARTS.1) * part);
        let made = self.lay(&fill.patch, &whole, &window, &chosen)?;
        let Some(Laid { patch, story, view }) = made else { return Ok(None) };
        if view.doubt > 0.0 {
            return Ok(Some((patch, Story { doubt: view.doubt, ..story })));
        }
        // Again on the surface found: triangles where it is steep, lines that meet it at right angles.
        let mut finer = patch.clone();
        if around.sizing == Sizing::Surroundings && fill.outline.share.is_none() {
            take_density(&mut finer, &view, library.source());
        }
        let stop = || late(0.2);
        if !refine_for(&fill.outline, &mut finer, AGAIN, &mut Pace::new(&stop))? {
            return Ok(Some((patch, story)));
        }
        let error = story.coherence_error;
        let first = Ok(Some((patch, story)));
        let Some(found) = domain(&finer, Extent::Found) else { return first };
        let Some(window) = one_window(&found) else { return first };
        let Some(mut again) = self.lay(&finer, &found, &window, &chosen)? else { return first };
        if let (Some(both), Some(first)) = (&mut again.story.coherence_error, error) {
            both[0] = first[0];
        }
        Ok(Some((again.patch, again.story)))
    }

    /// The patch that is warped.
    fn choose(&self, window: &Window) -> Result<Option<Rigid>> {
        let Search { library, guidance, candidates, threads, .. } = *self.search;
        let ring = window.domain.ring_points();
        let target = window.domain.target(&ring);
        if let Some(placement) = &guidance.placement {
            (self.check)(0.0)?;
            return Ok(Some(placed(library, placement, from_ref(&target))));
        }
        let early = |part: f64| (self.check)(PARTS.0 * part);
        let ranked = library.kept.warped.find(from_ref(&target), None, || {
            let found = self.find(&window.domain, &target, By::Shape, &|p| early(0.8 * p))?;
            let rough = roughness(self.around, library, &window.domain);
            let judged = &found[..found.len().min(JUDGED)];
            let view = look(window, library.source(), judged, (rough, None), threads, &|p| {
                early(0.8 + 0.2 * p)
            })?;
            Ok(Arc::new(Ranked::of(view.as_ref(), &target).places))
        })?;
        if guidance.candidate > 0 {
            candidates.set(ranked.len());
        }
        Ok(ranked.get(guidance.candidate.max(1) - 1).copied())
    }

    /// The most similar patches, aligned, best first.
    fn find(
        &self,
        domain: &Domain,
        target: &Target<'_>,
        by: By,
        check: &dyn Fn(f64) -> Result<()>,
    ) -> Result<Vec<Rigid>> {
        let Search { library, threads, .. } = *self.search;
        let features = library.features(threads, &|| check(0.0))?;
        let near = |v: usize| self.around.near.vertices[domain.near_vertex(v) as usize];
        let positions = &domain.sheet.positions;
        let ring: Vec<_> = domain.ring.iter().map(|&v| (positions[v], near(v))).collect();
        // On the fill, where the middle of a bent one is not.
        let off = |&v: &usize| positions[v].distance_squared(target.centre);
        let middle = domain.fill.clone().min_by(|a, b| off(a).total_cmp(&off(b)));
        let centre = middle.map_or(target.centre, |v| positions[v]);
        let frame = Frame::new(centre, target.normal, &library.known.axes);
        // Colours may come from a smoother place.
        let rough = match by {
            By::Shape => roughness(self.around, library, domain),
            By::Colour => 0.0,
        };
        let hole = Hole::new(frame, target.radius, target.fill, &ring, &features.known, rough);
        let (source, mirrored) = (library.source(), library.mirrored);
        let of_source = features.chosen.as_ref().unwrap_or(&features.known);
        let early = |part: f64| check(0.1 + 0.5 * part);
        let found = most_similar(&hole, source, of_source, by, mirrored, threads, &early)?;
        let late = |part: f64| check(0.6 + 0.4 * part);
        let aligned = align_candidates(&library.known, source, target, &found, threads, &late)?;
        Ok(aligned.into_iter().map(|c| c.transform).collect())
    }

    /// Warps the patch that a transform lays over the hole.
    fn lay<'w>(
        &self,
        initial: &Patch,
        domain: &Domain,
        window: &'w Window,
        transform: &Rigid,
    ) -> Result<Option<Laid<'w>>> {
        let Search { library, threads, .. } = *self.search;
        let rough = roughness(self.around, library, &window.domain);
        let check = |part: f64| (self.check)(PARTS.0 + (PARTS.1 - PARTS.0) * part);
        let source = library.source();
        let view = look(window, source, from_ref(transform), (rough, None), threads, &check)?;
        let Some(view) = view else { return Ok(None) };
        let own = &window.domain;
        let at = |v: usize| own.sheet.positions[v] + view.copies[0].heights[v] * own.directions[v];
        let laid: Vec<_> = (0..own.sheet.positions.len()).map(at).collect();
        let mut patch = initial.clone();
        if !view.is_smooth {
            let Some(warped) = warp(own, &laid) else { return Ok(None) };
            for (v, p) in own.fill.clone().zip(warped) {
                patch.positions[window.parent[v]] = p;
            }
        }
        let height = |i: usize| {
            let v = domain.fill.start + i;
            (patch.positions[v] - domain.sheet.positions[v]).dot(domain.directions[v])
        };
        let stop = || check(1.0);
        let views = [view];
        let before = coherence_error(&views, &|_| 0.0, &stop)?;
        let after = coherence_error(&views, &height, &stop)?;
        let labels: Vec<_> =
            (0..domain.fill.len()).map(|i| views[0].index(i).map(|_| (0, 0))).collect();
        let error = Some([before, after]).filter(|e| e[0].is_finite());
        let story = Story { coherence_error: error, ..tell(source, domain, &views, &labels) };
        let [view] = views;
        Ok(Some(Laid { patch, story, view }))
    }
}

/// A warped patch.
struct Laid<'w> {
    patch: Patch,
    story: Story,
    view: View<'w>,
}

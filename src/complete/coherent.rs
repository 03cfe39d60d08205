//! Harary, Tal, Grinspun (2014), "Context-based coherent surface completion", with other means:
//! the fill of one hole continued from what the rest of the object shows.
//!
//! Reads as the list of its steps; each is a file of `matching` or `synthesis`, and `docs/coherent.md`
//! explains them. Differences from the paper:
//! - Sources are found by what is known around the hole (height maps, ICP), not by descriptors of
//!   the initial completion, and one transform serves the whole hole or a window of it.
//! - A source is fitted to the ring with a stiffness that predicts best what was hidden.
//! - Low frequencies come from a consensus of the sources, detail from one source at each vertex:
//!   averages of positions (Eq. 5 and 6) lose the detail.

use super::coloured::{lack, take_colours, EMPHASIS};
use super::cost::Cost;
use super::guided::{common, rank, transforms, Ranked};
use super::library::Library;
use super::long::complete_long;
use super::quilted::quilt_colours;
use super::smooth::{Fill, Story, Surroundings};
use crate::error::Result;
use crate::fill::even::refine_for;
use crate::fill::patch::Patch;
use crate::guidance::Guidance;
use crate::matching::icp::RingPoint;
use crate::matching::rigid::Rigid;
use crate::matching::search::{realign, Target};
use crate::matching::similarity::size_change;
use crate::matching::source::Source;
use crate::options::Sizing;
use crate::progress::Pace;
use crate::result::{Origin, Seam, SourceReport};
use crate::synthesis::domain::{Domain, Extent};
use crate::synthesis::join::{join, places_beside, places_on_ring};
use crate::synthesis::project::Place;
use crate::synthesis::resemblance::coherence_error;
use crate::synthesis::view::{look, View};
use crate::synthesis::window::{one_window, Window};
use std::cell::Cell;
use std::slice::from_ref;
use std::sync::Arc;

/// Fewer new vertices than this have no room for detail.
pub const LEAST: usize = 6;
/// Triangles of the fill are this much smaller than those around it, at most.
const FINER: f64 = 0.5;
/// Rounds of refinement between the two looks.
pub const AGAIN: usize = 2;

/// Where sources are looked for.
pub struct Search<'a> {
    /// The object.
    pub library: &'a Library,
    /// What the caller says of it.
    pub guidance: &'a Guidance,
    /// Receives how many candidates there are, if one was asked for.
    pub candidates: &'a Cell<usize>,
    /// Threads to use.
    pub threads: usize,
}

/// The coherent completion of a hole whose smooth completion is given. `Ok(None)`: nothing on the
/// object serves.
pub fn complete_hole(
    around: &Surroundings<'_>,
    fill: &Fill,
    search: &Search<'_>,
    check: &dyn Fn(f64) -> Result<()>,
) -> Result<Option<(Patch, Story)>> {
    let shape = complete_shape(around, fill, search, check)?;
    let find = |_: &Domain, target: Target<'_>| {
        let found = search.library.candidates(&[target], search.threads, &|_| check(1.0))?;
        Ok(found.iter().flatten().map(|c| c.transform).collect())
    };
    with_colours(around, fill, search, shape, &find, &|| check(1.0))
}

/// The places for a target of a domain, best first.
pub type Find<'a> = &'a dyn Fn(&Domain, Target<'_>) -> Result<Vec<Rigid>>;

/// A completed shape, or the smooth fill if nothing serves it, with the colours that were found elsewhere;
/// `None` if it has neither.
pub fn with_colours(
    around: &Surroundings<'_>,
    fill: &Fill,
    search: &Search<'_>,
    shape: Option<(Patch, Story)>,
    find: Find<'_>,
    check: &dyn Fn() -> Result<()>,
) -> Result<Option<(Patch, Story)>> {
    let nothing = shape.is_none();
    let (patch, mut story) =
        shape.unwrap_or_else(|| (fill.patch.clone(), Story::nothing(&fill.patch)));
    search_colours(around, fill, search, &patch, &mut story, find, check)?;
    Ok((!nothing || !story.colours.is_empty()).then_some((patch, story)))
}

/// Looks elsewhere for the colours of a finished fill where its shape's sources do not have them.
fn search_colours(
    around: &Surroundings<'_>,
    fill: &Fill,
    search: &Search<'_>,
    patch: &Patch,
    story: &mut Story,
    find: Find<'_>,
    check: &dyn Fn() -> Result<()>,
) -> Result<()> {
    let &Search { library, guidance, threads, .. } = search;
    // One place that was chosen gives all.
    let lack = lack(story, around.near, library).filter(|_| !guidance.is_single());
    let Some(rho) = lack else { return Ok(()) };
    let domain = domain_of(around, fill, library, patch, Extent::Found);
    let Some(domain) = domain.filter(|d| !d.is_slender()) else { return Ok(()) };
    let ring = domain.ring_points();
    let target = || Target { emphasis: EMPHASIS, ..domain.target(&ring) };
    let found = find(&domain, target())?;
    if !take_colours(story, &domain, library, (&target(), &found), rho, threads, check)? {
        quilt_colours(story, &domain, library, rho, threads, check)?;
    }
    Ok(())
}

/// A patch with what is known around its hole.
pub fn domain_of(
    around: &Surroundings<'_>,
    fill: &Fill,
    library: &Library,
    patch: &Patch,
    extent: Extent,
) -> Option<Domain> {
    let (rim, edge) = (&fill.outline.vertices, fill.outline.mean_size());
    let domain = Domain::new(patch, around.near, &around.incidence.get(), rim, edge, extent);
    domain.map(|d| d.painted(&library.known.paint, around.near))
}

fn complete_shape(
    around: &Surroundings<'_>,
    fill: &Fill,
    search: &Search<'_>,
    check: &dyn Fn(f64) -> Result<()>,
) -> Result<Option<(Patch, Story)>> {
    if fill.patch.new_count() < LEAST {
        return Ok(None);
    }
    let &Search { library, guidance, candidates, threads } = search;
    let domain_of = |patch: &Patch, extent: Extent| domain_of(around, fill, library, patch, extent);
    let Some(domain) = domain_of(&fill.patch, Extent::Whole) else { return Ok(None) };
    check(0.0)?;
    let cost = Cost::of(domain.fill.len(), library.known.area / domain.radius.powi(2));
    let [search, first] = cost.parts();
    let scope = Scope { around, library, guidance, candidates, threads, check, search, first };
    // In parts where the hole is long or bends around the object.
    let Some(whole) = one_window(&domain).filter(|_| !domain.is_slender()) else {
        return complete_long(&scope, fill);
    };
    let whole = [whole];
    let views = scope.look_through(&whole)?;
    let stop = || check(scope.first);
    let made = finish(&fill.patch, library.source(), &domain, &views, &stop)?;
    let Some((patch, story)) = made else { return Ok(None) };
    if views[0].doubt > 0.0 {
        return Ok(Some((patch, Story { doubt: views[0].doubt, ..story })));
    }
    // Again on the surface found: triangles where it is steep, lines that meet it at right angles.
    let mut finer = patch.clone();
    if around.sizing == Sizing::Surroundings && fill.outline.share.is_none() {
        take_density(&mut finer, &views[0], library.source());
    }
    if !refine_for(&fill.outline, &mut finer, AGAIN, &mut Pace::new(&stop))? {
        return Ok(Some((patch, story)));
    }
    let domain = domain_of(&finer, Extent::Found);
    let second = match domain {
        Some(domain) => scope.look_again(&finer, &domain, &views[0], story.coherence_error)?,
        None => None,
    };
    Ok(second.or(Some((patch, story))))
}

/// Where the copies' triangles are smaller than those around the hole, the fill's shall be, too.
pub fn take_density(patch: &mut Patch, view: &View<'_>, source: &Source) {
    let first = patch.rim_count;
    for (i, &copy) in view.labels.iter().enumerate() {
        if let Some(place) = view.copies[copy].places[view.window.domain.fill.start + i] {
            let wanted = &mut patch.sizes[first + i];
            let scale = size_change(&view.copies[copy].transform);
            let length = scale * source.length_at(place.face, place.barycentric);
            *wanted = length.clamp(FINER * *wanted, *wanted);
        }
    }
}

/// What all windows of a hole share.
#[derive(Clone, Copy)]
pub struct Scope<'a> {
    /// What is around the hole.
    pub around: &'a Surroundings<'a>,
    /// Where sources are.
    pub library: &'a Library,
    /// See [`Search`].
    pub guidance: &'a Guidance,
    /// See [`Search`].
    pub candidates: &'a Cell<usize>,
    /// Threads to use.
    pub threads: usize,
    /// Called with the part of the whole that is done.
    pub check: &'a dyn Fn(f64) -> Result<()>,
    /// Where the search ends in the whole, and where the first look does.
    pub search: f64,
    /// See `search`.
    pub first: f64,
}

impl Scope<'_> {
    /// Searches from some windows and looks through each at what it found.
    pub fn look_through<'w>(&self, windows: &'w [Window]) -> Result<Vec<View<'w>>> {
        let (source, threads) = (self.library.source(), self.threads);
        let rings: Vec<Vec<RingPoint>> = windows.iter().map(|w| w.domain.ring_points()).collect();
        let targets: Vec<Target<'_>> =
            windows.iter().zip(&rings).map(|(w, ring)| w.domain.target(ring)).collect();
        let check = |part: f64| (self.check)(part * self.search);
        let mut found = transforms(self.library, self.guidance, &targets, threads, &check)?;
        // A twin, or what is left of one, may have all of a long hole in one place.
        if targets.len() > 1 && !self.library.is_whole() && !self.guidance.is_single() {
            let check = || check(1.0);
            let one = common(self.library, self.guidance, &targets, &found, threads, &check)?;
            found = one.map_or(found, |place| Arc::new(vec![vec![place]; targets.len()]));
        }
        let mut views = Vec::new();
        for (i, (window, all)) in windows.iter().zip(found.iter()).enumerate() {
            let part = |part: f64| (i as f64 + part) / windows.len() as f64;
            let at = |p: f64| (self.check)(self.search + (self.first - self.search) * part(p));
            let roughness = self.roughness(&window.domain);
            let target = &targets[i];
            let at_all = |check: &dyn Fn(f64) -> Result<()>| {
                look(window, source, all, (roughness, None), threads, check)
            };
            let Some(place) = self.guidance.candidate.checked_sub(1) else {
                let view = at_all(&at)?;
                // Whoever then asks for one of them need not wait for this look.
                rank(self.library, self.guidance, target, || {
                    Ok(Ranked::of(view.as_ref(), target))
                })?;
                views.extend(view);
                continue;
            };
            let ranked = rank(self.library, self.guidance, target, || {
                Ok(Ranked::of(at_all(&|_| at(0.0))?.as_ref(), target))
            })?;
            self.candidates.set(self.candidates.get().max(ranked.places.len()));
            if let Some(one) = ranked.places.get(place) {
                let told = (roughness, ranked.chosen);
                views.extend(look(window, source, from_ref(one), told, threads, &at)?);
            }
        }
        Ok(views)
    }

    /// Looks at what a view saw once more, over a surface that was found so. `error`: what the first look
    /// says of the coherence error.
    fn look_again(
        &self,
        found: &Patch,
        domain: &Domain,
        first: &View<'_>,
        error: Option<[f64; 2]>,
    ) -> Result<Option<(Patch, Story)>> {
        let Some(window) = one_window(domain) else { return Ok(None) };
        let source = self.library.source();
        let mut transforms: Vec<_> = first.copies.iter().map(|c| c.transform).collect();
        let told = (self.roughness(&window.domain), Some(first.fitted.chosen));
        let stop = |part: f64| (self.check)(self.first + (1.0 - self.first) * part);
        // Those that had the most say are worth more alignments.
        let mut order: Vec<usize> = (0..transforms.len()).collect();
        order.sort_by(|&a, &b| first.shares[b].total_cmp(&first.shares[a]).then(a.cmp(&b)));
        let best: Vec<_> = order.iter().map(|&k| transforms[k]).collect();
        let ring = first.window.domain.ring_points();
        let target = first.window.domain.target(&ring);
        let (known, threads) = (&self.library.known, self.threads);
        // One that was chosen is left as it is; the alignments below keep the size.
        if !self.guidance.is_single() && self.guidance.scales.is_none() {
            transforms.extend(realign(known, source, &target, &best, threads, &|| stop(0.0))?);
        }
        let views: Vec<View<'_>> =
            look(&window, source, &transforms, told, self.threads, &stop)?.into_iter().collect();
        finish_again(found, source, domain, &views, error, &|| stop(1.0))
    }

    /// See [`roughness`].
    pub fn roughness(&self, domain: &Domain) -> f64 {
        roughness(self.around, self.library, domain)
    }
}

/// Mean roughness of the ring, see [`SourceMesh::roughness`](crate::matching::source::SourceMesh::roughness).
pub fn roughness(around: &Surroundings<'_>, library: &Library, domain: &Domain) -> f64 {
    let of = |&v: &usize| {
        let input = around.near.vertices[domain.near_vertex(v) as usize];
        library.known.roughness[input as usize]
    };
    domain.ring.iter().map(of).sum::<f64>() / domain.ring.len().max(1) as f64
}

/// The surface that some views make of a patch, if they serve.
pub fn finish(
    initial: &Patch,
    source: &Source,
    domain: &Domain,
    views: &[View<'_>],
    check: &dyn Fn() -> Result<()>,
) -> Result<Option<(Patch, Story)>> {
    if views.is_empty() {
        return Ok(None);
    }
    let Some(joined) = join(domain, views, check)? else { return Ok(None) };
    let before = coherence_error(views, &|_| 0.0, check)?;
    let after = coherence_error(views, &|i| joined.heights[i], check)?;
    let mut patch = initial.clone();
    for (i, v) in domain.fill.clone().enumerate() {
        patch.positions[v] = domain.sheet.positions[v] + joined.heights[i] * domain.directions[v];
    }
    let coherence_error = Some([before, after]).filter(|e| e[0].is_finite());
    let story = tell(source, domain, views, &joined.labels);
    Ok(Some((patch, Story { coherence_error, ..story })))
}

/// The same of a second look; `error`: what the first says of the coherence error. What it was before is what it was
/// before both looks.
pub fn finish_again(
    found: &Patch,
    source: &Source,
    domain: &Domain,
    views: &[View<'_>],
    error: Option<[f64; 2]>,
    check: &dyn Fn() -> Result<()>,
) -> Result<Option<(Patch, Story)>> {
    let made = finish(found, source, domain, views, check)?;
    let Some((patch, mut story)) = made else { return Ok(None) };
    if let (Some(both), Some(first)) = (&mut story.coherence_error, error) {
        both[0] = first[0];
    }
    Ok(Some((patch, story)))
}

/// A place that windows copy from.
struct CopiedPlace {
    /// Views and their copies that are of it.
    labels: Vec<(usize, usize)>,
    /// Of the whole fill.
    share: f64,
    /// Mean over the views.
    error: f64,
}

/// The places of all views, the most used first; one that serves several windows once.
fn places_of(views: &[View<'_>]) -> Vec<CopiedPlace> {
    let fills: f64 = views.iter().map(|v| v.window.domain.fill.len() as f64).sum();
    let mut all: Vec<CopiedPlace> = Vec::new();
    for (w, view) in views.iter().enumerate() {
        for (k, copy) in view.copies.iter().enumerate() {
            let share = view.shares[k] * view.window.domain.fill.len() as f64 / fills;
            let (label, error) = ((w, k), view.fitted.error[k]);
            let same = |of: &&mut CopiedPlace| {
                let (w, k) = of.labels[0];
                views[w].copies[k].transform == copy.transform
            };
            match all.iter_mut().find(same).filter(|of| of.labels[0].0 != w) {
                Some(of) => {
                    of.error += (error - of.error) / (of.labels.len() + 1) as f64;
                    of.share += share;
                    of.labels.push(label);
                }
                None => all.push(CopiedPlace { labels: vec![label], share, error }),
            }
        }
    }
    all.sort_by(|a, b| b.share.total_cmp(&a.share).then(a.labels.cmp(&b.labels)));
    all
}

/// Where each vertex comes from. `labels`: view and copy of each fill vertex.
pub fn tell(
    source: &Source,
    domain: &Domain,
    views: &[View<'_>],
    labels: &[Option<(usize, usize)>],
) -> Story {
    let all = places_of(views);
    let place = |label: (usize, usize)| {
        all.iter().position(|of| of.labels.contains(&label)).unwrap_or(0) as u32
    };
    let origin = |(i, label): (usize, &Option<(usize, usize)>)| {
        let found = label.and_then(|(w, k)| Some((views[w].place(i, k)?, (w, k))));
        // A completion is no place to come from.
        let found = found.filter(|(at, _)| !source.is_completion(at.face));
        match found {
            Some((at, label)) => Origin {
                face: source.face_ids[at.face as usize],
                barycentric: at.barycentric,
                source: place(label),
                confidence: views[label.0].confidence,
            },
            None => Origin::NOWHERE,
        }
    };
    let origins: Vec<Origin> = labels.iter().enumerate().map(origin).collect();
    let seam = |(v, label, at): (u32, (usize, usize), Place)| Seam {
        vertex: v,
        source: place(label),
        face: source.face_ids[at.face as usize],
        barycentric: at.barycentric,
    };
    let is_known = |(_, _, at): &(u32, (usize, usize), Place)| !source.is_completion(at.face);
    let seams = places_beside(domain, views, labels).filter(is_known).map(seam).collect();
    let ring = places_on_ring(views, labels).filter(is_known).map(seam).collect();
    let mut used = vec![0; all.len()];
    origins.iter().filter(|o| !o.is_nowhere()).for_each(|o| used[o.source as usize] += 1);
    // As the exemplar lies, of which it is.
    let given = |&(w, k): &(usize, usize)| {
        let copy = &views[w].copies[k];
        let at = copy.places.iter().flatten().next();
        at.map_or(copy.transform, |at| {
            source.as_given(&copy.transform, source.face_ids[at.face as usize])
        })
    };
    let sources = all
        .iter()
        .zip(used)
        .map(|(of, vertices)| SourceReport {
            transform: given(&of.labels[0]),
            error: of.error,
            weight: of.share,
            vertices,
            coloured: 0,
        })
        .collect();
    let confidence =
        origins.iter().map(|o| o.confidence).sum::<f64>() / origins.len().max(1) as f64;
    let (colours, coherence_error) = (Vec::new(), None);
    Story { origins, colours, sources, seams, ring, confidence, coherence_error, doubt: 0.0 }
}

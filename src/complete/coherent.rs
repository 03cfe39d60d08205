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

use super::smooth::{Fill, Story, Surroundings};
use crate::error::Result;
use crate::fill::patch::Patch;
use crate::fill::refine::refine;
use crate::matching::cloud::Cloud;
use crate::matching::icp::RingPoint;
use crate::matching::paint::Paint;
use crate::matching::search::{
    cloud_at, cloud_scale, find_candidates, radius_at, scale_of, Maps, Target,
};
use crate::matching::source::Source;
use crate::mesh::MeshView;
use crate::options::{Appearance, Sizing, Sources};
use crate::progress::Pace;
use crate::result::{Origin, Seam, SourceReport};
use crate::synthesis::domain::{Domain, Extent};
use crate::synthesis::join::{join, places_beside, places_on_ring};
use crate::synthesis::project::Place;
use crate::synthesis::resemblance::coherence_error;
use crate::synthesis::view::{look, View};
use crate::synthesis::window::{one_window, plan_windows, Window};
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

/// Fewer new vertices than this have no room for detail.
const LEAST: usize = 6;
/// Triangles of the fill are this much smaller than those around it, at most.
const FINER: f64 = 0.5;
/// Rounds of refinement between the two looks.
const AGAIN: usize = 2;

/// What is made once a mesh and kept: what is known, what may be copied from, and its maps by scale.
pub struct Library {
    known: Source,
    /// What may be copied from, where that is not all that is known.
    chosen: Option<Source>,
    mirrored: bool,
    maps: Mutex<BTreeMap<i32, Arc<Maps>>>,
    /// Of what is known, and of what was chosen.
    clouds: [Mutex<BTreeMap<i32, Arc<Cloud>>>; 2],
}

impl Library {
    /// Of a mesh with these boundary vertices; maps are made when a hole first asks for them.
    pub fn new(
        mesh: MeshView<'_>,
        boundary: &[u32],
        sources: &Sources,
        appearance: Option<&Appearance>,
    ) -> Result<Self> {
        let rims = || boundary.iter().copied();
        let of_part = sources.faces.is_some() || sources.exemplar.is_some();
        let paint = appearance.and_then(Paint::new);
        let chosen = of_part.then(|| Source::chosen(mesh, rims(), sources)).transpose()?;
        Ok(Self {
            known: Source::new(mesh, rims()).painted(&paint),
            chosen: chosen.map(|s| s.painted(&paint)),
            mirrored: !sources.unmirrored,
            maps: Mutex::default(),
            clouds: Default::default(),
        })
    }

    /// What may be copied from.
    fn source(&self) -> &Source {
        self.chosen.as_ref().unwrap_or(&self.known)
    }

    fn maps(&self, radius: f64) -> Arc<Maps> {
        let edge = self.known.edge;
        let scale = scale_of(edge, radius);
        let radius = radius_at(edge, scale);
        let cloud = |source: &Source, kept: usize| {
            let key = cloud_scale(source, radius);
            once(&self.clouds[kept], key, || cloud_at(source, key))
        };
        let known = cloud(&self.known, 0);
        let of_source = self.chosen.as_ref().map_or(known.clone(), |s| cloud(s, 1));
        let make = || Maps::new(self.source(), radius, of_source, known, self.mirrored);
        once(&self.maps, scale, make)
    }
}

/// What is kept under a key, made if it is not there: who comes later waits for the first.
fn once<T>(kept: &Mutex<BTreeMap<i32, Arc<T>>>, key: i32, make: impl FnOnce() -> T) -> Arc<T> {
    let mut kept = kept.lock().unwrap_or_else(PoisonError::into_inner);
    kept.entry(key).or_insert_with(|| Arc::new(make())).clone()
}

/// The coherent completion of a hole whose smooth completion is given. `Ok(None)`: nothing on the
/// object serves.
pub fn complete_hole(
    around: &Surroundings<'_>,
    fill: &Fill,
    library: &Library,
    threads: usize,
    check: &dyn Fn(f64) -> Result<()>,
) -> Result<Option<(Patch, Story)>> {
    if fill.patch.positions.len() < fill.patch.rim_count + LEAST {
        return Ok(None);
    }
    let domain_of = |patch: &Patch, extent: Extent| {
        let (rim, edge) = (&fill.outline.vertices, fill.outline.mean_size());
        let domain = Domain::new(patch, around.near, around.incidence, rim, edge, extent);
        domain.map(|d| d.painted(&library.known.paint, around.near))
    };
    let Some(domain) = domain_of(&fill.patch, Extent::Whole) else { return Ok(None) };
    let scope = Scope { around, library, threads, check };
    // In parts where the hole is long or bends around the object.
    let Some(whole) = one_window(&domain).filter(|_| !domain.is_slender()) else {
        let Some(narrow) = domain_of(&fill.patch, Extent::Narrow) else { return Ok(None) };
        let windows = plan_windows(&narrow);
        let views = scope.look_through(&windows)?;
        return Ok(finish(&fill.patch, library.source(), &narrow, &views));
    };
    let whole = [whole];
    let views = scope.look_through(&whole)?;
    let Some((patch, story)) = finish(&fill.patch, library.source(), &domain, &views) else {
        return Ok(None);
    };
    if views[0].doubt > 0.0 {
        return Ok(Some((patch, story)));
    }
    // Again on the surface found: triangles where it is steep, lines that meet it at right angles.
    let mut finer = patch.clone();
    if around.sizing == Sizing::Surroundings {
        take_density(&mut finer, &views[0], library.source());
    }
    let stop = || check(0.8);
    if !refine(&mut finer, &fill.outline.taken, AGAIN, &mut Pace::new(&stop))? {
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
fn take_density(patch: &mut Patch, view: &View<'_>, source: &Source) {
    let first = patch.rim_count;
    for (i, &copy) in view.labels.iter().enumerate() {
        if let Some(place) = view.copies[copy].places[view.window.domain.fill.start + i] {
            let wanted = &mut patch.sizes[first + i];
            let length = source.length_at(place.face, place.barycentric);
            *wanted = length.clamp(FINER * *wanted, *wanted);
        }
    }
}

/// What all windows of a hole share.
struct Scope<'a> {
    around: &'a Surroundings<'a>,
    library: &'a Library,
    threads: usize,
    check: &'a dyn Fn(f64) -> Result<()>,
}

impl Scope<'_> {
    /// Searches for all windows and looks through each.
    fn look_through<'w>(&self, windows: &'w [Window]) -> Result<Vec<View<'w>>> {
        let Some(first) = windows.first() else { return Ok(Vec::new()) };
        let (source, threads) = (self.library.source(), self.threads);
        let known = &self.library.known;
        let at = |part: f64| move || (self.check)(part);
        let maps = self.library.maps(first.domain.radius);
        (self.check)(0.1)?;
        let rings: Vec<Vec<RingPoint>> = windows.iter().map(|w| w.domain.ring_points()).collect();
        let targets: Vec<Target<'_>> =
            windows.iter().zip(&rings).map(|(w, ring)| w.domain.target(ring)).collect();
        let found = find_candidates(known, source, &maps, &targets, threads, &at(0.3))?;
        let mut views = Vec::new();
        for (i, (window, candidates)) in windows.iter().zip(found).enumerate() {
            let part = 0.5 + 0.4 * i as f64 / windows.len() as f64;
            let transforms: Vec<_> = candidates.iter().map(|c| c.transform).collect();
            let roughness = self.roughness(&window.domain);
            views.extend(look(window, source, &transforms, roughness, threads, &at(part))?);
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
        let transforms: Vec<_> = first.copies.iter().map(|c| c.transform).collect();
        let roughness = self.roughness(&window.domain);
        let stop = || (self.check)(0.85);
        let views: Vec<View<'_>> =
            look(&window, source, &transforms, roughness, self.threads, &stop)?
                .into_iter()
                .collect();
        let Some((patch, mut story)) = finish(found, source, domain, &views) else {
            return Ok(None);
        };
        // What it was before is what it was before both looks.
        if let (Some(both), Some(first)) = (&mut story.coherence_error, error) {
            both[0] = first[0];
        }
        Ok(Some((patch, story)))
    }

    /// Mean roughness of the ring, see [`Source::roughness`].
    fn roughness(&self, domain: &Domain) -> f64 {
        let of = |&v: &usize| {
            let input = self.around.near.vertices[domain.near_vertex(v) as usize];
            self.library.known.roughness[input as usize]
        };
        domain.ring.iter().map(of).sum::<f64>() / domain.ring.len().max(1) as f64
    }
}

fn finish(
    initial: &Patch,
    source: &Source,
    domain: &Domain,
    views: &[View<'_>],
) -> Option<(Patch, Story)> {
    if views.is_empty() {
        return None;
    }
    let joined = join(domain, views)?;
    let before = coherence_error(views, &|_| 0.0);
    let after = coherence_error(views, &|i| joined.heights[i]);
    let mut patch = initial.clone();
    for (i, v) in domain.fill.clone().enumerate() {
        patch.positions[v] = domain.sheet.positions[v] + joined.heights[i] * domain.directions[v];
    }
    let coherence_error = Some([before, after]).filter(|e| e[0].is_finite());
    let story = tell(source, domain, views, &joined.labels);
    Some((patch, Story { coherence_error, ..story }))
}

/// Where each vertex comes from. `labels`: view and copy of each fill vertex.
fn tell(
    source: &Source,
    domain: &Domain,
    views: &[View<'_>],
    labels: &[Option<(usize, usize)>],
) -> Story {
    // The copies of all windows, the most used first.
    let mut all: Vec<(usize, usize)> =
        (0..views.len()).flat_map(|w| (0..views[w].copies.len()).map(move |k| (w, k))).collect();
    let fills: f64 = views.iter().map(|v| v.window.domain.fill.len() as f64).sum();
    let share = |&(w, k): &(usize, usize)| {
        views[w].shares[k] * views[w].window.domain.fill.len() as f64 / fills
    };
    all.sort_by(|a, b| share(b).total_cmp(&share(a)).then(a.cmp(b)));
    let place = |label: (usize, usize)| all.iter().position(|&l| l == label).unwrap_or(0) as u32;
    let origin = |(i, label): (usize, &Option<(usize, usize)>)| {
        let found = label.and_then(|(w, k)| Some((views[w].place(i, k)?, (w, k))));
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
    let seams = places_beside(domain, views, labels).map(seam).collect();
    let ring = places_on_ring(views, labels).map(seam).collect();
    let mut used = vec![0; all.len()];
    labels.iter().flatten().for_each(|&l| used[place(l) as usize] += 1);
    let sources = all
        .iter()
        .zip(used)
        .map(|(l, vertices)| SourceReport {
            transform: views[l.0].copies[l.1].transform,
            error: views[l.0].fitted.error[l.1],
            weight: share(l),
            vertices,
        })
        .collect();
    let confidence =
        origins.iter().map(|o| o.confidence).sum::<f64>() / origins.len().max(1) as f64;
    Story { origins, sources, seams, ring, confidence, coherence_error: None }
}

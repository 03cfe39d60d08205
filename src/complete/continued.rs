//! Holes filled one by one: smoothly, or with a part that was missing, and by the methods that copy continued
//! from there, when all smooth fills are there to copy from.

use super::check::Obstacles;
use super::coherent::{self, Search};
use super::cost::{cost_of, Cost};
use super::finished::{as_wanted, Finished};
use super::harary::Initial;
use super::library::Library;
use super::pulled::pull_fill;
use super::smooth::{fill_hole, Fill, Story, Surroundings};
use super::together::initial_of;
use super::{warp, workers, Completer, Outcome, LIBRARIES};
use crate::error::Result;
use crate::fill::outline::Outline;
use crate::fill::patch::Patch;
use crate::holes::Hole;
use crate::mesh::neighbourhood::Bounds;
use crate::options::{Appearance, Method, Options, Sizing, Sources};
use crate::parallel::thread_count;
use crate::progress::Monitor;
use glam::DVec3;
use std::cell::Cell;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

/// The part of a copied fill's time in which its initial completion is made.
const SMOOTH_SHARE: f64 = 0.05;
/// The part of making the library that its sources take; the rest go to the object's symmetries.
const SOURCES_SHARE: f64 = 0.78;

/// What a call works on.
pub(super) struct Call<'c> {
    /// The surroundings of all holes.
    pub around: &'c Surroundings<'c>,
    /// How far those of each hole reach.
    pub boxes: &'c [Bounds],
    /// The holes, with the points that each fill shall go through.
    pub holes: &'c [(&'c Hole, &'c [DVec3])],
    /// What the caller wishes.
    pub options: &'c Options,
}

impl Call<'_> {
    /// Whether fills are continued from a library, one by one.
    fn copies(&self) -> bool {
        let copies = matches!(self.options.method, Method::Coherent | Method::Warp);
        copies && !self.options.guidance.part
    }
}

/// What a library was made from.
pub(super) struct Key {
    sources: Sources,
    appearance: Option<Arc<Appearance>>,
    fills: Vec<(u32, Patch)>,
}

impl Key {
    fn is(
        &self,
        sources: &Sources,
        appearance: &Option<Arc<Appearance>>,
        fills: &[(u32, Initial<'_>)],
    ) -> bool {
        let same_values = match (&self.appearance, appearance) {
            (Some(a), Some(b)) => Arc::ptr_eq(a, b) || a == b,
            (a, b) => a.is_none() && b.is_none(),
        };
        let same = |(own, other): (&(u32, Patch), &(u32, Initial<'_>))| {
            let same_shape = own.1.positions == other.1.patch.positions;
            own.0 == other.0 && same_shape && own.1.triangles == other.1.patch.triangles
        };
        let same_fills = self.fills.len() == fills.len() && self.fills.iter().zip(fills).all(same);
        same_values && same_fills && self.sources == *sources
    }
}

/// A hole that has a smooth fill.
struct Begun {
    /// The fill, or why there is none.
    fill: std::result::Result<Fill, String>,
    /// Whether that is the standard one and the caller wants another: it is continued, and what comes of it
    /// made as the caller wants it.
    is_standard: bool,
    /// The standard one where the fill is another: others copy from it, so that they are the same then.
    standard: Option<Fill>,
    seconds: f64,
}

impl Begun {
    /// The fill that others may copy from.
    fn source(&self) -> Option<&Fill> {
        self.standard.as_ref().or(self.fill.as_ref().ok())
    }

    fn new_vertices(&self) -> usize {
        self.fill.as_ref().map_or(0, |fill| fill.patch.new_count())
    }

    /// What its completion costs, about.
    fn cost(&self, sizing: Sizing) -> f64 {
        let of_fill = |fill: &Fill| cost_of(&fill.patch);
        self.fill.as_ref().map_or(0.0, of_fill) + self.cost_of_resizing(sizing)
    }

    /// The part of it that follows the search and the looks.
    fn cost_of_resizing(&self, sizing: Sizing) -> f64 {
        let Ok(fill) = &self.fill else { return 0.0 };
        let factor = match sizing {
            Sizing::Scaled(factor) if self.is_standard => factor,
            Sizing::EdgeLength(length) if self.is_standard => length / fill.outline.mean_size(),
            _ => return 0.0,
        };
        Cost::of_resizing(self.new_vertices() as f64 / factor.powi(2))
    }

    /// As it is.
    fn end(self) -> Outcome {
        let seconds = self.seconds;
        self.fill.map(|f| (f, seconds)).map_err(|why| (why, seconds))
    }
}

impl Completer<'_> {
    /// Fills all holes of a call, and returns what they were continued from.
    pub(super) fn fill_all(
        &self,
        call: &Call<'_>,
        (monitor, span): (&Monitor, workers::Span),
    ) -> Result<(Vec<Outcome>, Option<Arc<Library>>)> {
        let (count, threads) = (call.holes.len(), call.options.threads);
        let obstacles = Obstacles { mesh: self.mesh, covered: call.boxes, others: &[] };
        // The smooth fills are there early; most of the time comes after them.
        let share = if call.copies() { SMOOTH_SHARE } else { 1.0 };
        let middle = span.0 + (span.1 - span.0) * share;
        let first = (monitor, (span.0, middle));
        let inside = workers::threads_inside(count, threads);
        let begun = workers::run(&vec![1.0; count], threads, first, &|i, check| {
            self.begin(call, &obstacles, i, inside, check)
        })?;
        if !call.copies() {
            return Ok((begun.into_iter().map(Begun::end).collect(), None));
        }
        let costs: Vec<f64> = begun.iter().map(|b| b.cost(call.options.sizing)).collect();
        let making = Cost::of_library(self.mesh.vertices.len());
        let made = middle + (span.1 - middle) * making / (making + costs.iter().sum::<f64>());
        let check = |part: f64| monitor.step(middle + (made - middle) * part, "looking around");
        let library = self.library_of(call, &begun, &|part| check(SOURCES_SHARE * part))?;
        let search = begun.iter().any(|b| b.new_vertices() >= coherent::LEAST);
        if search && call.options.method == Method::Coherent && library.is_whole() {
            // Here, where there is progress for it: whichever hole came first would wait for them.
            library.symmetries(&|part| check(SOURCES_SHARE + (1.0 - SOURCES_SHARE) * part))?;
        }
        // Each is worked on by one thread.
        let begun: Vec<Mutex<Begun>> = begun.into_iter().map(Mutex::new).collect();
        workers::run(&costs, threads, (monitor, (made, span.1)), &|i, check| {
            let mut begun = begun[i].lock().unwrap_or_else(PoisonError::into_inner);
            self.go_on(call, &obstacles, i, &mut begun, &library, inside, check)
        })?;
        let done =
            begun.into_iter().map(|b| b.into_inner().unwrap_or_else(PoisonError::into_inner));
        Ok((done.map(Begun::end).collect(), Some(library)))
    }

    /// Fills hole `i` of a call from the first to the last step.
    pub(super) fn fill_one(
        &self,
        call: &Call<'_>,
        obstacles: &Obstacles<'_>,
        i: usize,
        library: Option<&Library>,
        check: &dyn Fn(f64) -> Result<()>,
    ) -> Result<Outcome> {
        let threads = thread_count(call.options.threads);
        let mut begun = self.begin(call, obstacles, i, threads, check)?;
        if let Some(library) = library {
            self.go_on(call, obstacles, i, &mut begun, library, threads, check)?;
        }
        Ok(begun.end())
    }

    /// Fills a hole smoothly or with a part that was missing.
    fn begin(
        &self,
        call: &Call<'_>,
        obstacles: &Obstacles<'_>,
        i: usize,
        threads: usize,
        check: &dyn Fn(f64) -> Result<()>,
    ) -> Result<Begun> {
        let clock = Instant::now();
        let &Call { around, options, holes, .. } = call;
        let (hole, points) = holes[i];
        // The neighbourhood holds every face that touches the rim's box.
        let Some(loops) = self.loops_of(around, hole) else {
            let fill = Err("its rim was not found again".into());
            return Ok(Begun { fill, is_standard: false, standard: None, seconds: 0.0 });
        };
        let mut is_standard = call.copies() && points.is_empty() && wants_another(around, &loops);
        let mut fill = match around.initial {
            _ if options.guidance.part => {
                self.fill_with_part(around, obstacles, (hole, &loops), options, threads, check)?
            }
            Some(initial) => initial.fill_hole(around, &loops, obstacles, check)?,
            None if is_standard => self.standard_fill(around, &loops, obstacles, check)?,
            None if around.is_standard() => self.standard_fill(around, &loops, obstacles, check)?,
            None => fill_hole(around, &loops, obstacles, check)?,
        };
        let mut standard = None;
        // The caller's own may be fine enough.
        if is_standard && !fill.as_ref().is_ok_and(|f| f.patch.new_count() >= coherent::LEAST) {
            is_standard = false;
            standard = fill.ok();
            fill = fill_hole(around, &loops, obstacles, check)?;
        }
        if let Ok(smooth) = &mut fill {
            let drawn = (points, options.guidance.softness);
            if let Err(why) = pull_fill(around, obstacles, smooth, drawn, check)? {
                fill = Err(why);
            }
        }
        Ok(Begun { fill, is_standard, standard, seconds: clock.elapsed().as_secs_f64() })
    }

    /// The standard fill of a hole, kept.
    fn standard_fill(
        &self,
        around: &Surroundings<'_>,
        loops: &[Vec<u32>],
        obstacles: &Obstacles<'_>,
        check: &dyn Fn(f64) -> Result<()>,
    ) -> Result<std::result::Result<Fill, String>> {
        let make = || fill_hole(&around.standard(), loops, obstacles, check);
        match self.keeps && obstacles.others.is_empty() {
            true => self.standards.find(around.near, loops, make),
            false => make(),
        }
    }

    /// The loops of a hole in neighbourhood vertices.
    fn loops_of(&self, around: &Surroundings<'_>, hole: &Hole) -> Option<Vec<Vec<u32>>> {
        let local = |&v: &u32| around.near.local(v);
        let of = |&l: &usize| self.holes.loops[l].vertices.iter().map(local).collect();
        hole.loops.iter().map(of).collect()
    }

    /// Continues a fill that was begun, from a library that all holes share.
    #[allow(clippy::too_many_arguments)]
    fn go_on(
        &self,
        call: &Call<'_>,
        obstacles: &Obstacles<'_>,
        i: usize,
        begun: &mut Begun,
        library: &Library,
        threads: usize,
        check: &dyn Fn(f64) -> Result<()>,
    ) -> Result<()> {
        let clock = Instant::now();
        let &Call { options, holes, .. } = call;
        let (guidance, candidates) = (&options.guidance, &Cell::new(0));
        let library = &library.for_hole(i as u32);
        let search = Search { library, guidance, candidates, threads };
        if begun.fill.is_ok() {
            self.continue_fill(call, obstacles, i, begun, &search, check)?;
        }
        if let Ok(fill) = &mut begun.fill {
            fill.candidates = candidates.get();
            // What was copied does not know of the points; a smooth fill went through them already.
            if fill.method != Method::Smooth {
                let drawn = (holes[i].1, guidance.softness);
                let pulled = pull_fill(call.around, obstacles, fill, drawn, &|_| check(1.0))?;
                if let Err(why) = pulled {
                    begun.fill = Err(why);
                }
            }
        }
        begun.seconds += clock.elapsed().as_secs_f64();
        Ok(())
    }

    /// A smooth fill continued from what the object shows; it stands where nothing on the object serves
    /// or the result meets something.
    fn continue_fill(
        &self,
        call: &Call<'_>,
        obstacles: &Obstacles<'_>,
        i: usize,
        begun: &mut Begun,
        search: &Search<'_>,
        check: &dyn Fn(f64) -> Result<()>,
    ) -> Result<()> {
        let (around, sizing) = (call.around, call.options.sizing);
        let looks = 1.0 - begun.cost_of_resizing(sizing) / begun.cost(sizing);
        let (early, stop) = (|part: f64| check(looks * part), || check(looks));
        let own = |around: &Surroundings<'_>| match self.loops_of(around, call.holes[i].0) {
            Some(loops) => fill_hole(around, &loops, obstacles, &|_| stop()),
            None => Ok(Err("its rim was not found again".into())),
        };
        let Ok(fill) = &mut begun.fill else { return Ok(()) };
        let from = if begun.is_standard { &around.standard() } else { around };
        let mut made = self.finished(call, (from, fill), search, &early)?;
        if let Some(finished) = made.take_if(|_| begun.is_standard) {
            let own = match finished.1.doubt > 0.0 && around.fairing != from.fairing {
                true => Some(own(&Surroundings { sizing: from.sizing, ..*around })?),
                false => None,
            };
            let own = match own.transpose() {
                Ok(own) => own,
                Err(why) => {
                    begun.fill = Err(why);
                    return Ok(());
                }
            };
            let (source, threads) = (search.library.source(), search.threads);
            made = as_wanted(finished, fill, own.as_ref(), around, source, threads, &stop)?;
            fill.fairing = own.map_or(fill.fairing, |own| own.fairing);
        }
        if let Some((patch, story)) = made {
            if let Ok(patch) = obstacles.settle(around, patch, &stop)? {
                let method = call.options.method;
                fill.coherence_error = story.coherence_error;
                (fill.patch, fill.story, fill.method) = (patch, Some(story), method);
                return Ok(());
            }
        }
        if begun.is_standard {
            begun.fill = own(around)?;
        }
        Ok(())
    }

    /// The completion of a fill, not yet checked, kept; `None` if nothing on the object serves.
    fn finished(
        &self,
        call: &Call<'_>,
        (around, fill): (&Surroundings<'_>, &Fill),
        search: &Search<'_>,
        check: &dyn Fn(f64) -> Result<()>,
    ) -> Result<Option<(Patch, Story)>> {
        let method = call.options.method;
        let make = || {
            let made = match method {
                Method::Warp => warp::complete_hole(around, fill, search, check)?,
                _ => coherent::complete_hole(around, fill, search, check)?,
            };
            Ok(Finished { made, candidates: search.candidates.get() })
        };
        let Finished { made, candidates } = match self.keeps {
            true => {
                let asked = (method, search.guidance);
                search.library.kept.finished.find(around, fill, asked, make)?
            }
            false => make()?,
        };
        search.candidates.set(candidates);
        Ok(made)
    }

    /// What the holes that were begun are continued from.
    fn library_of(
        &self,
        call: &Call<'_>,
        begun: &[Begun],
        check: &dyn Fn(f64) -> Result<()>,
    ) -> Result<Arc<Library>> {
        let Options { sources, appearance, method, .. } = call.options;
        // Completions have no colours that could steer.
        let steered = appearance.as_ref().is_some_and(|a| a.steering > 0);
        let whole = sources.faces.is_none() && sources.exemplar.is_none();
        let shared = whole && !steered && *method == Method::Coherent;
        let fills = begun.iter().enumerate().filter(|_| shared);
        let fills =
            fills.filter_map(|(i, b)| Some((i as u32, initial_of(call.around, b.source()?))));
        self.library(call.options, &fills.collect::<Vec<_>>(), check)
    }

    /// What completions copy from, kept until other sources are asked for. `fills`: smooth ones of several
    /// holes, that others may copy from; fewer than two say nothing to each other.
    pub(super) fn library(
        &self,
        options: &Options,
        fills: &[(u32, Initial<'_>)],
        check: &dyn Fn(f64) -> Result<()>,
    ) -> Result<Arc<Library>> {
        let fills = if fills.len() > 1 { fills } else { &[] };
        let (sources, appearance) = (&options.sources, &options.appearance);
        let key = || Key {
            sources: sources.clone(),
            appearance: appearance.clone(),
            fills: fills.iter().map(|f| (f.0, f.1.patch.clone())).collect(),
        };
        let mut kept = self.libraries.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(place) = kept.iter().position(|k| k.0.is(sources, appearance, fills)) {
            kept.swap(0, place);
            return Ok(kept[0].1.clone());
        }
        let like = kept.iter().find(|k| k.0.is(&k.0.sources, appearance, fills));
        let like = like.map(|k| k.1.clone());
        kept.truncate(LIBRARIES - 1);
        let (rims, mirrored, paint) = (self.rims(), !sources.unmirrored, appearance.as_deref());
        let library = match (&like, fills.is_empty()) {
            (_, true) => Library::new(self.mesh, &rims, sources, paint, like.as_deref(), check)?,
            // Of all sources, too: fills are shared then only.
            (Some(like), false) => like.with_mirrored(mirrored),
            (None, false) => Library::completed(self.mesh, &rims, fills, mirrored, check)?,
        };
        let library = Arc::new(library);
        kept.push_front((key(), library.clone()));
        Ok(library)
    }
}

/// Whether the caller wants another smooth fill than the standard one, and that has not many more vertices.
fn wants_another(around: &Surroundings<'_>, loops: &[Vec<u32>]) -> bool {
    let edge = || Outline::new(around.near, &around.incidence.get(), loops).mean_size();
    around.initial.is_none() && !around.is_standard() && around.is_near_standard(edge())
}

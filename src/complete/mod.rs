//! The whole chain: the neighbourhood of the holes copied out, each hole filled, the fills put
//! together.

mod assemble;
mod check;
mod coherent;
mod coloured;
mod fragment;
mod guided;
pub mod harary;
mod initial;
mod library;
mod part;
mod pulled;
mod searches;
mod smooth;
mod warp;
mod workers;

use crate::error::{Error, Result};
use crate::fill::patch::Patch;
use crate::fill::sheet::Incidences;
use crate::guidance::Guidance;
use crate::holes::select::select_holes;
use crate::holes::{find_holes, Hole, HoleList};
use crate::mesh::neighbourhood::{Bounds, FacePlaces, Neighbourhood};
use crate::mesh::{FaceView, MeshView, VertexView};
use crate::options::{Appearance, Grouping, Method, Options, Sources};
use crate::parallel::thread_count;
#[cfg(feature = "capi")]
pub(crate) use crate::parallel::WORKER;
use crate::progress::Monitor;
use crate::result::Completion;
use assemble::{assemble, blank};
use check::{Obstacles, Rounding};
use coherent::{Cost, Search};
use cpu_time::ProcessTime;
use glam::DVec3;
use initial::InitialFaces;
use library::Library;
use pulled::{pull_fill, share_points};
use smooth::{fill_hole, Fill, Story, Surroundings};
use std::cell::Cell;
use std::collections::HashSet;
use std::slice::from_ref;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// How far around its rim a hole's neighbourhood reaches, in diameters: a fill seldom bulges
/// more, and the soft bands of the fairings need half of it.
const REACH: f64 = 0.3;
/// And at least this many mean rim edges.
const REACH_EDGES: f64 = 6.0;

/// The part of a coherent fill's time in which its initial completion is made.
const SMOOTH_SHARE: f64 = 0.03;
/// Part of the call's progress in which what follows the smooth fills of some methods is made.
const BESIDE: workers::Span = (0.05, 0.98);

/// Where filling begins and ends in the call's progress. What comes before it is a pass over the mesh: much
/// beside a smooth fill, next to nothing beside the others.
fn filling(method: Method) -> workers::Span {
    match method {
        Method::Smooth => (0.1, 0.95),
        Method::Coherent | Method::Warp => (0.02, 0.98),
        Method::Harary | Method::Fragment => (0.02, BESIDE.0),
    }
}

/// Completes a mesh in one call, in silence. See [`Completer`] for the parts.
pub fn complete_mesh<'a>(
    vertices: impl Into<VertexView<'a>>,
    faces: impl Into<FaceView<'a>>,
    options: &Options,
) -> Result<Completion> {
    complete_mesh_with(MeshView::new(vertices, faces), options, &Monitor::silent())
}

/// Completes a mesh in one call, with progress and cancel.
pub fn complete_mesh_with(
    mesh: MeshView<'_>,
    options: &Options,
    monitor: &Monitor,
) -> Result<Completion> {
    options.check()?;
    // No second copy of the result for a redo that cannot come.
    Completer::new(mesh, &options.grouping, monitor)?.complete_anew(options, monitor)
}

/// Keeps what is expensive and does not change between calls on one mesh: the checked arrays and
/// the holes found in them.
pub struct Completer<'a> {
    mesh: MeshView<'a>,
    holes: HoleList,
    /// Whether the vertices are a cloud's points.
    of_points: bool,
    /// Made when a coherent completion first asks for it.
    library: Mutex<Option<(Key, Arc<Library>)>>,
    /// The last result and what was asked for: a host that redoes need not wait.
    last: Mutex<Option<(Options, Completion)>>,
    /// Wall and CPU time of finding the holes.
    spent: (Duration, Duration),
}

/// What a library was made from.
type Key = (Sources, Option<Arc<Appearance>>);

/// What became of one selected hole.
type Outcome = std::result::Result<(Fill, f64), (String, f64)>;

impl<'a> Completer<'a> {
    /// Checks the arrays and finds the holes.
    pub fn new(mesh: MeshView<'a>, grouping: &Grouping, monitor: &Monitor) -> Result<Self> {
        let (clock, cpu) = (Instant::now(), ProcessTime::now());
        monitor.step(0.0, "finding holes")?;
        let holes = find_holes(mesh, grouping, monitor)?;
        Ok(Self {
            mesh,
            holes,
            of_points: false,
            library: Mutex::default(),
            last: Mutex::default(),
            spent: (clock.elapsed(), cpu.elapsed()),
        })
    }

    /// The same of a mesh laid through a cloud's points.
    pub(crate) fn of_points(self) -> Self {
        Self { of_points: true, ..self }
    }

    /// What coherent completions copy from, kept until other sources are asked for.
    fn library(
        &self,
        options: &Options,
        check: &dyn Fn(f64) -> Result<()>,
    ) -> Result<Arc<Library>> {
        let (sources, appearance) = (&options.sources, &options.appearance);
        let same_values = |kept: &Option<Arc<Appearance>>| match (kept, appearance) {
            (Some(a), Some(b)) => Arc::ptr_eq(a, b) || a == b,
            (a, b) => a.is_none() && b.is_none(),
        };
        let same = |k: &Key| k.0 == *sources && same_values(&k.1);
        let mut kept = self.library.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, library)) = kept.as_ref().filter(|k| same(&k.0)) {
            return Ok(library.clone());
        }
        let library = Library::new(self.mesh, &self.rims(), sources, appearance.as_deref(), check)?;
        let library = Arc::new(library);
        *kept = Some(((sources.clone(), appearance.clone()), library.clone()));
        Ok(library)
    }

    /// The vertices that fills are only joined at, as those of the neighbourhood.
    fn loose(&self, near: &Neighbourhood, given: &[u32]) -> Result<Vec<u32>> {
        if given.is_empty() {
            return Ok(Vec::new());
        }
        let rims: HashSet<u32> = self.rims().into_iter().collect();
        if let Some(v) = given.iter().find(|v| !rims.contains(v)) {
            let reason = format!("vertex {v} is on no rim; take it out");
            return Err(Error::InvalidOption { name: "loose", reason });
        }
        let mut loose: Vec<u32> = given.iter().filter_map(|&v| near.local(v)).collect();
        loose.sort_unstable();
        loose.dedup();
        Ok(loose)
    }

    /// All vertices of boundary loops.
    fn rims(&self) -> Vec<u32> {
        self.holes.loops.iter().flat_map(|l| l.vertices.iter().copied()).collect()
    }

    /// The part of a coherent fill that making the library is, as it seems from here.
    fn making(&self, fill: &Fill) -> f64 {
        if self.library.lock().unwrap_or_else(PoisonError::into_inner).is_some() {
            return 0.0;
        }
        let library = Cost::of_library(self.mesh.vertices.len());
        let new = fill.patch.positions.len() - fill.patch.rim_count;
        library / (library + Cost::of(new, f64::INFINITY).all())
    }

    /// The holes found.
    pub fn holes(&self) -> &HoleList {
        &self.holes
    }

    /// Fills the holes that `options` select. `options.grouping` is not read: it was settled in
    /// [`Completer::new`]. The seconds returned include those of [`Completer::new`].
    pub fn complete(&self, options: &Options, monitor: &Monitor) -> Result<Completion> {
        let (clock, cpu) = (Instant::now(), ProcessTime::now());
        // The thread count cannot change the result.
        let asked = Options { threads: 0, ..options.clone() };
        if let Some(mut again) = self.last_if(&asked) {
            again.seconds = (clock.elapsed() + self.spent.0).as_secs_f64();
            again.cpu_seconds = (cpu.elapsed() + self.spent.1).as_secs_f64();
            monitor.step(1.0, "done")?;
            return Ok(again);
        }
        let completion = self.complete_anew(options, monitor)?;
        let last = Some((asked, completion.clone()));
        *self.last.lock().unwrap_or_else(PoisonError::into_inner) = last;
        Ok(completion)
    }

    /// The same, whatever was asked for last.
    fn complete_anew(&self, options: &Options, monitor: &Monitor) -> Result<Completion> {
        let (clock, cpu) = (Instant::now(), ProcessTime::now());
        options.check()?;
        let options = &options.guided();
        options.sources.check(self.mesh.faces.len())?;
        if options.clean.is_some() {
            let reason = "only a point cloud is cleaned".into();
            return Err(Error::InvalidOption { name: "clean", reason });
        }
        let vertices = self.mesh.vertices.len();
        if let Some(appearance) = &options.appearance {
            appearance.check(vertices, &options.sources)?;
        }
        options.initial.as_ref().map_or(Ok(()), |i| i.check(vertices))?;
        let wanted = select_holes(self.mesh, &self.holes, &options.selection)?;
        let todo = self.safe_holes(&wanted, options)?;
        let points = share_points(&options.guidance, &todo)?;
        let span = filling(options.method);
        monitor.step(0.5 * span.0, "copying the surroundings")?;
        let boxes: Vec<Bounds> = todo.iter().map(|h| self.reach(h)).collect();
        let mut near = Neighbourhood::gather(self.mesh, &boxes, monitor)?;
        near.loose = self.loose(&near, &options.guidance.loose)?;
        let incidence = Incidences::new(&near);
        let single = self.mesh.vertices.is_single();
        let initial = options.initial.as_ref().map(|i| InitialFaces::new(i, vertices));
        let places = FacePlaces::new(&near, todo.len());
        let around = Surroundings {
            initial: initial.as_ref(),
            input_vertices: self.mesh.vertices.len(),
            near: &near,
            incidence: &incidence,
            places: &places,
            fairing: options.fairing,
            sizing: options.sizing,
            rounding: if single { Rounding::Single } else { Rounding::Double },
        };
        monitor.step(span.0, "filling")?;
        let mut outcomes =
            workers::run(todo.len(), options.threads, (monitor, span), &|i, check| {
                let obstacles = Obstacles { mesh: self.mesh, covered: &boxes, others: &[] };
                let hole = (todo[i], &points[i][..]);
                self.fill_one(&around, &obstacles, hole, todo.len(), options, check)
            })?;
        match options.method {
            Method::Harary => self.make_coherent(&around, &boxes, &mut outcomes, monitor)?,
            Method::Fragment => {
                self.paste_fragments(&around, &boxes, &mut outcomes, options, monitor)?;
            }
            Method::Coherent | Method::Warp | Method::Smooth => {}
        }
        monitor.step(span.1.max(BESIDE.1), "checking the fills against each other")?;
        let holes: Vec<_> = todo.iter().copied().zip(points.iter().map(|p| &p[..])).collect();
        self.part_fills(&around, &boxes, &holes, &mut outcomes, options, monitor)?;
        let mut completion = assemble(
            blank(self.mesh, &self.holes, &wanted),
            &near,
            &todo,
            outcomes,
            options.skip_unsafe,
        )?;
        completion.loose = options.guidance.loose.clone();
        completion.seconds = (clock.elapsed() + self.spent.0).as_secs_f64();
        completion.cpu_seconds = (cpu.elapsed() + self.spent.1).as_secs_f64();
        monitor.step(1.0, "done")?;
        Ok(completion)
    }

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

    /// The last result, if the same was asked for.
    fn last_if(&self, asked: &Options) -> Option<Completion> {
        let last = self.last.lock().unwrap_or_else(PoisonError::into_inner);
        last.as_ref().filter(|l| l.0 == *asked).map(|l| l.1.clone())
    }

    /// The selected holes that can be filled; an error for others unless they are to be skipped.
    fn safe_holes(&self, wanted: &[bool], options: &Options) -> Result<Vec<&Hole>> {
        let selected = self.holes.holes.iter().filter(|h| wanted[h.id]);
        let (mut safe, mut bad) = (Vec::new(), None);
        for hole in selected {
            match &hole.problem {
                Some(problem) => bad = bad.or(Some((hole.id, problem.clone()))),
                None => safe.push(hole),
            }
        }
        match bad {
            Some((hole, problem)) if !options.skip_unsafe => {
                Err(Error::UnsafeHole { hole, problem })
            }
            _ => Ok(safe),
        }
    }

    fn reach(&self, hole: &Hole) -> Bounds {
        let rim = hole.loops.iter().flat_map(|&l| &self.holes.loops[l].vertices);
        let bounds = Bounds::of(rim.map(|&v| DVec3::from(self.mesh.vertices.get(v as usize))));
        let edge = hole.circumference / hole.edges.max(1) as f64;
        bounds.grown(REACH * hole.diameter + REACH_EDGES * edge)
    }

    /// Fills one of `holes` that are worked on.
    fn fill_one(
        &self,
        around: &Surroundings<'_>,
        obstacles: &Obstacles<'_>,
        (hole, points): (&Hole, &[DVec3]),
        holes: usize,
        options: &Options,
        check: &dyn Fn(f64) -> Result<()>,
    ) -> Result<Outcome> {
        let clock = Instant::now();
        let local = |&v: &u32| around.near.local(v);
        let loops: Option<Vec<Vec<u32>>> = hole
            .loops
            .iter()
            .map(|&l| self.holes.loops[l].vertices.iter().map(local).collect())
            .collect();
        // The neighbourhood holds every face that touches the rim's box.
        let Some(loops) = loops else {
            return Ok(Err(("its rim was not found again".into(), 0.0)));
        };
        // The smooth fill is there early; most of a coherent one's time comes after it.
        let copies = matches!(options.method, Method::Coherent | Method::Warp);
        let share = if copies { SMOOTH_SHARE } else { 1.0 };
        let early = |part: f64| check(share * part);
        let late = |part: f64| check(share + (1.0 - share) * part);
        let mut filled = match around.initial {
            _ if options.guidance.part => {
                let threads = workers::threads_inside(holes, options.threads);
                self.fill_with_part(around, obstacles, (hole, &loops), options, threads, check)?
            }
            Some(initial) => initial.fill_hole(around, &loops, obstacles, &early)?,
            None => fill_hole(around, &loops, obstacles, &early)?,
        };
        let copies = copies && !options.guidance.part;
        let drawn = (points, options.guidance.softness);
        if let Ok(fill) = &mut filled {
            if let Err(why) = pull_fill(around, obstacles, fill, drawn, &early)? {
                filled = Err(why);
            }
        }
        if let (true, Ok(fill)) = (copies, &mut filled) {
            let threads = workers::threads_inside(holes, options.threads);
            let making = self.making(fill);
            let library = self.library(options, &|part| late(making * part))?;
            let late = |part: f64| late(making + (1.0 - making) * part);
            // Sources are looked for from the same fill whatever the options: what was found is kept.
            let own = around.initial.is_some() || around.is_standard();
            let own = own || options.method == Method::Warp;
            let standard = match own || !around.is_near_standard(fill.outline.mean_size()) {
                true => None,
                false => fill_hole(&around.standard(), &loops, obstacles, &|_| late(0.0))?.ok(),
            };
            let (guidance, candidates) = (&options.guidance, &Cell::new(0));
            let (library, from) = (&library, standard.as_ref());
            let search = Search { library, from, guidance, candidates, threads };
            self.continue_fill(around, obstacles, fill, options.method, &search, &late)?;
            fill.candidates = candidates.get();
            // What was copied does not know of the points; a smooth fill went through them already.
            if fill.method != Method::Smooth {
                if let Err(why) = pull_fill(around, obstacles, fill, drawn, &|_| late(1.0))? {
                    filled = Err(why);
                }
            }
        }
        let seconds = clock.elapsed().as_secs_f64();
        Ok(filled.map(|f| (f, seconds)).map_err(|why| (why, seconds)))
    }

    /// Fills a hole with a part that lies over it whole: the one that was placed, or the first of the places
    /// found (of a number, the one of that number) that keeps the contract.
    fn fill_with_part(
        &self,
        around: &Surroundings<'_>,
        obstacles: &Obstacles<'_>,
        (hole, loops): (&Hole, &[Vec<u32>]),
        options: &Options,
        threads: usize,
        check: &dyn Fn(f64) -> Result<()>,
    ) -> Result<std::result::Result<Fill, String>> {
        let library = self.library(options, &|part| check(0.3 * part))?;
        let rim: Vec<Vec<u32>> =
            hole.loops.iter().map(|&l| self.holes.loops[l].vertices.clone()).collect();
        let ring = part::ring_around(around, &library, loops);
        let at = |&v: &u32| library.known.positions[v as usize];
        let positions: Vec<DVec3> = rim.iter().flatten().map(at).collect();
        let target = part::target_of(&ring, &positions);
        let guidance = &options.guidance;
        let late = |part: f64| check(0.3 + 0.4 * part);
        let found = guided::transforms(&library, guidance, from_ref(&target), threads, &late)?;
        let wanted = part::Wanted {
            mesh: self.mesh,
            library: &library,
            rim: &rim,
            local: loops,
            ring: &ring,
        };
        let (mut first, mut good) = (None, 0);
        for transform in found.iter().flatten() {
            let made = part::take_part(around, obstacles, &wanted, transform, &|| check(0.8))?;
            match made {
                Ok(fill) => {
                    good += 1;
                    if good >= guidance.candidate {
                        return Ok(Ok(Fill { candidates: good.min(guidance.candidate), ..fill }));
                    }
                }
                Err(why) => first = first.or(Some(why)),
            }
        }
        Ok(Err(match (first, good) {
            (Some(why), 0) => why,
            (None, 0) => "no place with surroundings like its own was found: give the part's \
                          transform"
                .into(),
            _ => format!("only {good} places have a part for it"),
        }))
    }

    /// The smooth fills made coherent with the object (Harary et al. 2014): of each hole the most
    /// coherent one that keeps the contract, the smooth one at the worst.
    fn make_coherent(
        &self,
        around: &Surroundings<'_>,
        boxes: &[Bounds],
        outcomes: &mut [Outcome],
        monitor: &Monitor,
    ) -> Result<()> {
        let mut fills = filled(outcomes);
        let initial = initial_of(around, &fills);
        let made = workers::beside(
            (monitor, BESIDE),
            "continuing what the object shows",
            &|inner, done| harary::complete_holes_harary(self.mesh, &initial, inner, done),
        )?;
        for (fill, coherent) in fills.iter_mut().zip(made) {
            fill.coherence_error = Some(coherent.errors).filter(|e| e[0].is_finite());
            let offered = coherent.patches.into_iter().map(|patch| (patch, None));
            self.settle_first(around, boxes, fill, Method::Harary, offered, monitor)?;
        }
        Ok(())
    }

    /// The smooth fills replaced by fragments of the object (Bendels et al. 2005): of each hole those of
    /// the finest scale that keep the contract, the smooth one at the worst.
    fn paste_fragments(
        &self,
        around: &Surroundings<'_>,
        boxes: &[Bounds],
        outcomes: &mut [Outcome],
        options: &Options,
        monitor: &Monitor,
    ) -> Result<()> {
        let mut fills = filled(outcomes);
        let initial = initial_of(around, &fills);
        let asked = fragment::Asked {
            rims: &self.rims(),
            of_points: self.of_points,
            mirrored: !options.sources.unmirrored,
            threads: thread_count(options.threads),
        };
        let made = workers::beside((monitor, BESIDE), "copying fragments", &|inner, done| {
            fragment::complete_holes(self.mesh, &initial, &asked, inner, done)
        })?;
        for (fill, completed) in fills.iter_mut().zip(made) {
            let offered = completed.patches.into_iter().map(|(patch, story)| (patch, Some(story)));
            self.settle_first(around, boxes, fill, Method::Fragment, offered, monitor)?;
        }
        Ok(())
    }

    /// Takes the first of some patches that keeps the contract; the fill stands if none does.
    fn settle_first(
        &self,
        around: &Surroundings<'_>,
        boxes: &[Bounds],
        fill: &mut Fill,
        method: Method,
        offered: impl Iterator<Item = (Patch, Option<Story>)>,
        monitor: &Monitor,
    ) -> Result<()> {
        let obstacles = Obstacles { mesh: self.mesh, covered: boxes, others: &[] };
        for (patch, story) in offered {
            monitor.check()?;
            if let Ok(patch) = obstacles.settle(around, patch, &|| monitor.check())? {
                (fill.patch, fill.story, fill.method) = (patch, story, method);
                break;
            }
        }
        Ok(())
    }

    /// A smooth fill continued from what the object shows; it stands where nothing on the object serves
    /// or the result meets something.
    fn continue_fill(
        &self,
        around: &Surroundings<'_>,
        obstacles: &Obstacles<'_>,
        fill: &mut Fill,
        method: Method,
        search: &Search<'_>,
        check: &dyn Fn(f64) -> Result<()>,
    ) -> Result<()> {
        let made = match method {
            Method::Warp => warp::complete_hole(around, fill, search, check)?,
            _ => coherent::complete_hole(around, fill, search, check)?,
        };
        let Some((patch, story)) = made else { return Ok(()) };
        if let Ok(patch) = obstacles.settle(around, patch, &|| check(1.0))? {
            fill.coherence_error = story.coherence_error;
            (fill.patch, fill.story, fill.method) = (patch, Some(story), method);
        }
        Ok(())
    }

    /// Fills made side by side may meet: the later one is then made again around the earlier.
    fn part_fills(
        &self,
        around: &Surroundings<'_>,
        boxes: &[Bounds],
        todo: &[(&Hole, &[DVec3])],
        outcomes: &mut [Outcome],
        options: &Options,
        monitor: &Monitor,
    ) -> Result<()> {
        let bounds: Vec<Bounds> = outcomes
            .iter()
            .map(|o| match o {
                Ok((fill, _)) => Bounds::of(fill.patch.positions.iter().copied()),
                Err(_) => Bounds::EMPTY,
            })
            .collect();
        let mut order: Vec<usize> = (0..bounds.len()).collect();
        order.sort_by(|&a, &b| bounds[a].min.x.total_cmp(&bounds[b].min.x).then(a.cmp(&b)));
        // Neighbours by a sweep along x; for each fill the earlier holes whose box meets its own.
        let mut earlier: Vec<Vec<usize>> = vec![Vec::new(); bounds.len()];
        for (place, &a) in order.iter().enumerate() {
            for &b in &order[place + 1..] {
                if bounds[b].min.x > bounds[a].max.x {
                    break;
                }
                if bounds[a].overlaps(&bounds[b]) {
                    earlier[a.max(b)].push(a.min(b));
                }
            }
        }
        for i in 0..outcomes.len() {
            monitor.check()?;
            earlier[i].sort_unstable();
            let others: Vec<[DVec3; 3]> = earlier[i]
                .iter()
                .filter_map(|&j| outcomes[j].as_ref().ok())
                .flat_map(|(f, _)| f.patch.triangles.iter().map(|t| t.map(|v| f.patch.p(v))))
                .collect();
            let obstacles = Obstacles { mesh: self.mesh, covered: boxes, others: &others };
            let meets = match &outcomes[i] {
                Ok((fill, _)) if !others.is_empty() => obstacles.meets(around, &fill.patch),
                _ => false,
            };
            if meets {
                outcomes[i] =
                    self.fill_one(around, &obstacles, todo[i], 1, options, &|_| monitor.check())?;
            }
        }
        Ok(())
    }
}

/// The fills there are.
fn filled(outcomes: &mut [Outcome]) -> Vec<&mut Fill> {
    outcomes.iter_mut().filter_map(|o| o.as_mut().ok()).map(|o| &mut o.0).collect()
}

/// The same as what to start from.
fn initial_of<'f>(around: &Surroundings<'_>, fills: &'f [&mut Fill]) -> Vec<harary::Initial<'f>> {
    let input = |&v: &u32| around.near.vertices[v as usize];
    let one = |fill: &'f &mut Fill| harary::Initial {
        rim: fill.outline.vertices.iter().map(input).collect(),
        patch: &fill.patch,
        taken: &fill.outline.taken,
    };
    fills.iter().map(one).collect()
}

//! The whole chain: the neighbourhood of the holes copied out, each hole filled, the fills put
//! together.

mod apart;
mod assemble;
mod check;
mod coherent;
mod coloured;
mod continued;
mod cost;
mod finished;
mod fragment;
mod guided;
pub mod harary;
mod initial;
mod library;
mod long;
mod part;
mod pulled;
mod quilted;
mod resized;
mod searches;
mod smooth;
mod together;
mod warp;
mod workers;

use crate::error::{Error, Result};
use crate::fill::sheet::Incidences;
use crate::holes::select::select_holes;
use crate::holes::{find_holes, Hole, HoleList};
use crate::mesh::neighbourhood::{Bounds, FacePlaces, Neighbourhood};
use crate::mesh::{FaceView, MeshView, VertexView};
use crate::options::{Grouping, Method, Options, Selection};
#[cfg(feature = "capi")]
pub(crate) use crate::parallel::WORKER;
use crate::progress::Monitor;
use crate::result::Completion;
use assemble::{assemble, blank};
use check::Rounding;
use continued::{Call, Key};
use cpu_time::ProcessTime;
use finished::Standards;
use glam::DVec3;
use initial::InitialFaces;
use library::Library;
use pulled::share_points;
use smooth::{Fill, Spreading, Surroundings};
use std::collections::{HashSet, VecDeque};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// How far around its rim a hole's neighbourhood reaches, in diameters: a fill seldom bulges
/// more, and the soft bands of the fairings need half of it.
const REACH: f64 = 0.3;
/// And at least this many mean rim edges.
const REACH_EDGES: f64 = 6.0;

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

/// Results that a completer keeps.
const LAST: usize = 16;
/// Libraries that it keeps: of all holes and of one of them, as a host goes back and forth. They are large.
const LIBRARIES: usize = 2;

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
    // No second copy of anything for a redo that cannot come.
    let completer = Completer::new(mesh, &options.grouping, monitor)?;
    Completer { keeps: false, ..completer }.complete_anew(options, monitor)
}

/// Keeps what is expensive and does not change between calls on one mesh: the checked arrays and
/// the holes found in them.
pub struct Completer<'a> {
    mesh: MeshView<'a>,
    holes: HoleList,
    /// Whether the vertices are a cloud's points.
    of_points: bool,
    /// Whether what it makes may be asked for again.
    keeps: bool,
    /// Smooth fills without options.
    standards: Standards,
    /// Made when a coherent completion first asks for them: the last ones.
    libraries: Mutex<VecDeque<(Key, Arc<Library>)>>,
    /// The last results and what was asked for: a host that redoes, or goes back, need not wait. They are of new
    /// vertices and faces alone.
    last: Mutex<VecDeque<(Options, Completion)>>,
    /// Wall and CPU time of finding the holes.
    spent: (Duration, Duration),
}

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
            keeps: true,
            standards: Standards::default(),
            libraries: Mutex::default(),
            last: Mutex::default(),
            spent: (clock.elapsed(), cpu.elapsed()),
        })
    }

    /// The same of a mesh laid through a cloud's points, for one call.
    pub(crate) fn of_points(self) -> Self {
        Self { of_points: true, keeps: false, ..self }
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

    fn spreading(&self, method: Method) -> Spreading {
        match method {
            _ if !self.of_points => Spreading::Never,
            // It may bring points along, and from even vertices it lays no better copies.
            Method::Fragment => Spreading::Late,
            Method::Smooth | Method::Coherent | Method::Warp | Method::Harary => Spreading::Early,
        }
    }

    /// All vertices of boundary loops.
    fn rims(&self) -> Vec<u32> {
        self.holes.loops.iter().flat_map(|l| l.vertices.iter().copied()).collect()
    }

    /// The holes found.
    pub fn holes(&self) -> &HoleList {
        &self.holes
    }

    /// Fills the holes that `options` select. `options.grouping` is not read: it was settled in
    /// [`Completer::new`]. The seconds returned include those of [`Completer::new`].
    pub fn complete(&self, options: &Options, monitor: &Monitor) -> Result<Completion> {
        let (clock, cpu) = (Instant::now(), ProcessTime::now());
        // The thread count cannot change the result, nor can it matter how the holes were chosen.
        let mut asked = Options { threads: 0, ..options.clone() };
        if let Ok(wanted) = select_holes(self.mesh, &self.holes, &options.selection) {
            asked.selection = Selection::Ids((0..wanted.len()).filter(|&h| wanted[h]).collect());
        }
        if let Some(mut again) = self.last_if(&asked) {
            again.seconds = (clock.elapsed() + self.spent.0).as_secs_f64();
            again.cpu_seconds = (cpu.elapsed() + self.spent.1).as_secs_f64();
            monitor.step(1.0, "done")?;
            return Ok(again);
        }
        let completion = self.complete_anew(options, monitor)?;
        let mut last = self.last.lock().unwrap_or_else(PoisonError::into_inner);
        if last.len() == LAST {
            last.pop_front();
        }
        last.push_back((asked, completion.clone()));
        drop(last);
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
        if !options.given_holes.is_empty() {
            let reason = "a mesh has rims: choose among its holes with a selection".into();
            return Err(Error::InvalidOption { name: "given_holes", reason });
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
            spreading: self.spreading(options.method),
            near: &near,
            incidence: &incidence,
            places: &places,
            fairing: options.fairing,
            sizing: options.sizing,
            rounding: if single { Rounding::Single } else { Rounding::Double },
        };
        monitor.step(span.0, "filling")?;
        let holes: Vec<_> = todo.iter().copied().zip(points.iter().map(|p| &p[..])).collect();
        let call = Call { around: &around, boxes: &boxes, holes: &holes, options };
        let (mut outcomes, library) = self.fill_all(&call, (monitor, span))?;
        match options.method {
            Method::Harary => self.make_coherent(&around, &boxes, &mut outcomes, monitor)?,
            Method::Fragment => {
                self.paste_fragments(&around, &boxes, &mut outcomes, options, monitor)?;
            }
            Method::Coherent | Method::Warp | Method::Smooth => {}
        }
        monitor.step(span.1.max(BESIDE.1), "checking the fills against each other")?;
        self.part_fills(&call, &mut outcomes, library.as_deref(), monitor)?;
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

    /// One of the last results, if the same was asked for.
    fn last_if(&self, asked: &Options) -> Option<Completion> {
        let last = self.last.lock().unwrap_or_else(PoisonError::into_inner);
        last.iter().find(|l| l.0 == *asked).map(|l| l.1.clone())
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
}

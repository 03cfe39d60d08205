//! Point clouds: holes found and filled where there are no faces.
//!
//! A mesh is laid through the points for the time of the call; its boundary loops are judged, and the
//! holes among them filled like those of any mesh. The fill's vertices are the new points: they lie
//! as densely as the points around the hole. Points of the input neither move nor go.

mod boundary;
mod clean;
mod detectors;
mod field;
mod given;
mod holes;
mod neighbours;
mod normals;
mod smooth;
mod spanning;
mod surface;
mod tidy;

pub use holes::{find_point_holes, PointHoles};

use crate::complete::Completer;
use crate::error::{Error, Result};
use crate::holes::select::select_holes;
use crate::mesh::normals::vertex_normals;
use crate::mesh::{FaceView, MeshView, VertexView};
use crate::options::{Options, Selection};
use crate::progress::Monitor;
use crate::result::{Completion, HoleStatus, Origin, NONE};
use cpu_time::ProcessTime;
use holes::Scaffold;
use std::sync::Arc;
use std::time::Instant;

/// New points for the holes of a cloud. The input is not in it: the caller has it, and it does not
/// change.
#[derive(Debug, Clone, PartialEq)]
pub struct PointCompletion {
    /// The new points as vertices, with holes, sources and confidences; its faces join them to each
    /// other and to the input's points around each hole. No origin names a face.
    pub completion: Completion,
    /// For each new point a unit normal, on the side of those given, or else outside.
    pub normals: Vec<[f64; 3]>,
    /// For each new point the input point nearest to where its detail was copied from;
    /// [`crate::result::NONE`] if from nowhere.
    pub source_points: Vec<u32>,
    /// For each new point the numbers that [`Options::appearance`] gave the input's; empty without.
    pub values: Vec<f64>,
    /// What else the points carry can be copied with it.
    pub copied: Copied,
    /// The cleaned copy that was completed, if [`Options::clean`] asked for one.
    pub cleaned: Option<CleanedPoints>,
    /// All holes and borders found, filled or not.
    pub found: PointHoles,
}

/// A cleaned copy of a cloud, point by point.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CleanedPoints {
    /// For each input point where it lies without the noise; one that was removed where it was.
    pub positions: Vec<[f64; 3]>,
    /// For each input point whether it was removed: beside the surface, a double, or without coordinates.
    pub removed: Vec<bool>,
}

/// The mesh that was laid through the points, and where on it the detail was copied from.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Copied {
    /// Its faces, over the cloud's points.
    pub faces: Vec<[u32; 3]>,
    /// The origins of the new points, with faces; none: as in the completion.
    pub origins: Vec<Origin>,
}

#[cfg(feature = "io")]
impl PointCompletion {
    /// The completion as one of the mesh through the points.
    pub(crate) fn on_mesh(&self) -> Completion {
        let mut made = self.completion.clone();
        if self.copied.origins.len() == made.origins.len() {
            made.origins.clone_from(&self.copied.origins);
        }
        Completion { input_face_count: self.copied.faces.len(), ..made }
    }
}

/// Fills the holes of a point cloud.
///
/// `normals`: one a point, any length, zero for unknown, to say which side is out; `None`: guessed.
/// Options are those of meshes; [`Selection::All`] leaves outer borders of open surfaces open, which
/// are filled when they are named. `sources.faces` and `initial` do not apply.
///
/// Errors: [`Error::TooFewPoints`], [`Error::PointsOnALine`], [`Error::NonFinitePoint`], and those
/// of [`crate::complete_mesh`].
pub fn complete_points<'a>(
    points: impl Into<VertexView<'a>>,
    normals: Option<VertexView<'a>>,
    options: &Options,
) -> Result<PointCompletion> {
    complete_points_with(points.into(), normals, options, &Monitor::silent())
}

/// The same with progress and cancel.
pub fn complete_points_with(
    points: VertexView<'_>,
    normals: Option<VertexView<'_>>,
    options: &Options,
    monitor: &Monitor,
) -> Result<PointCompletion> {
    let (clock, cpu) = (Instant::now(), ProcessTime::now());
    options.check()?;
    check_options(options)?;
    let scaffold = Scaffold::new(points, normals, options, monitor)?;
    let cleaned = options.clean.map(|_| scaffold.cleaned(points));
    let vertices = scaffold.vertices(points);
    let mesh = MeshView { vertices: vertices.view(), faces: (&scaffold.faces[..]).into() };
    // What follows reports as if it were all there is.
    let report = |part: f64, stage: &str| {
        let done = if part < 1.0 { holes::MADE + (1.0 - holes::MADE) * part } else { 1.0 };
        monitor.step(done, stage).is_ok()
    };
    let monitor = &Monitor::new(&report);
    let grouping = scaffold.local_grouping(mesh, &options.grouping, monitor)?;
    let completer = Completer::new(mesh, &grouping, monitor)?.of_points();
    let (found, numbers) = scaffold.holes(completer.holes());
    let wanted = select_point_holes(points, &found, &options.selection)?;
    let ids: Vec<usize> = (0..numbers.len()).filter(|&h| wanted[h]).map(|h| numbers[h]).collect();
    let appearance = options.appearance.as_deref();
    let appearance = appearance.map(|a| scaffold.appearance(a, points.len(), &options.sources));
    let appearance = appearance.transpose()?.map(Arc::new);
    let selection = Selection::Ids(ids);
    let appearance_of = appearance.clone();
    let own = Options { clean: None, given_holes: Vec::new(), ..options.clone() };
    let local = Options { selection, grouping, appearance: appearance_of, ..own };
    let made = completer.complete(&local, monitor)?;
    let exemplar = options.sources.exemplar.as_deref();
    let values = appearance.map(|a| a.complete(mesh.faces, exemplar, &made)).unwrap_or_default();
    let made = scaffold.into_points(made, points, found, &numbers);
    let mut made = PointCompletion { values, cleaned, ..made };
    made.completion.seconds = clock.elapsed().as_secs_f64();
    made.completion.cpu_seconds = cpu.elapsed().as_secs_f64();
    Ok(made)
}

/// What a mesh's options may ask for and a cloud's may not.
pub(crate) fn check_options(options: &Options) -> Result<()> {
    let bad = |name, reason: &str| Err(Error::InvalidOption { name, reason: reason.into() });
    if options.sources.faces.is_some() {
        return bad("sources", "a point cloud has no faces to choose");
    }
    if options.guidance.part {
        return bad("part", "a part is made of triangles, which a point cloud has none of");
    }
    if !options.guidance.loose.is_empty() {
        return bad("loose", "a point cloud has no rims of its own to name vertices of");
    }
    if options.initial.is_some() {
        return bad("initial", "a point cloud takes no completion to start from");
    }
    Ok(())
}

/// For each hole whether it is selected; borders only if they are named.
pub fn select_point_holes(
    points: VertexView<'_>,
    found: &PointHoles,
    selection: &Selection,
) -> Result<Vec<bool>> {
    let no_faces: &[[u32; 3]] = &[];
    let mesh = MeshView { vertices: points, faces: FaceView::from(no_faces) };
    let mut wanted = select_holes(mesh, &found.list, selection)?;
    let named = matches!(
        selection,
        Selection::Ids(_) | Selection::NearPoint(_) | Selection::NearVertices(_)
    );
    if !named {
        wanted.iter_mut().zip(&found.borders).for_each(|(w, &border)| *w &= !border);
    }
    Ok(wanted)
}

/// The points that the mesh goes through, packed, in the input's own precision: new points are then
/// rounded to it, too.
enum Vertices {
    Single(Vec<[f32; 3]>),
    Double(Vec<[f64; 3]>),
}

impl Vertices {
    fn new(all: impl Iterator<Item = [f64; 3]>, single: bool) -> Self {
        if single {
            Self::Single(all.map(|p| p.map(|x| x as f32)).collect())
        } else {
            Self::Double(all.collect())
        }
    }

    fn view(&self) -> VertexView<'_> {
        match self {
            Self::Single(v) => v.as_slice().into(),
            Self::Double(v) => v.as_slice().into(),
        }
    }
}

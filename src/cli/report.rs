//! What `--report` writes and `--json` prints. `docs/cli.md` describes every field.

use super::console::short;
use crate::holes::{Hole, HoleKind, HoleList};
use crate::mesh::MeshView;
use crate::options::Options;
use crate::points::{PointCompletion, PointHoles};
use crate::result::{Completion, HoleStatus, SourceReport};
use serde::Serialize;

/// At most this many elements of a warning are listed; their count is always given.
pub(super) const LISTED: usize = 20;

/// The report of `fill`.
#[derive(Debug, Serialize)]
pub(super) struct Report {
    pub version: &'static str,
    pub method: &'static str,
    pub fairing: &'static str,
    pub threads: usize,
    /// Which candidate the fills are made from; 0: all together.
    pub candidate: usize,
    pub input: File,
    pub output: File,
    pub new_vertices: usize,
    pub new_faces: usize,
    pub holes_found: usize,
    pub holes_filled: usize,
    pub fill_seconds: f64,
    pub fill_cpu_seconds: f64,
    pub holes: Vec<HoleEntry>,
    pub warnings: Vec<Warning>,
}

/// A mesh file.
#[derive(Debug, Clone, Serialize)]
pub(super) struct File {
    pub path: String,
    pub format: String,
    pub vertices: usize,
    /// Triangles; a polygon of n corners counts n - 2.
    pub faces: usize,
}

/// One hole of the input.
#[derive(Debug, Serialize)]
pub(super) struct HoleEntry {
    #[serde(flatten)]
    pub measured: Measured,
    #[serde(flatten)]
    pub detected: Option<Detected>,
    pub status: &'static str,
    pub reason: Option<String>,
    /// The one that made the fill.
    pub method: Option<&'static str>,
    pub fairing: Option<&'static str>,
    /// How many there are, if one was asked for.
    pub candidates: usize,
    pub confidence: f64,
    /// Before and after.
    pub coherence_error: Option<[f64; 2]>,
    pub sources: Vec<SourceEntry>,
    pub new_vertices: usize,
    pub new_faces: usize,
    pub seconds: f64,
}

/// A place that a fill was continued from.
#[derive(Debug, Serialize)]
pub(super) struct SourceEntry {
    /// Rows of a matrix, rotation and translation.
    pub transform: [[f64; 4]; 3],
    pub mirrored: bool,
    pub error: f64,
    pub weight: f64,
    pub vertices: usize,
    /// With their colours, but not their shape, from here.
    pub coloured: usize,
}

impl SourceEntry {
    fn of(source: &SourceReport) -> Self {
        Self {
            transform: source.transform.rows(),
            mirrored: source.transform.is_mirrored(),
            error: source.error,
            weight: source.weight,
            vertices: source.vertices,
            coloured: source.coloured,
        }
    }
}

/// What a hole looks like.
#[derive(Debug, Serialize)]
pub(super) struct Measured {
    pub id: usize,
    pub kind: &'static str,
    pub loops: usize,
    pub edges: usize,
    pub circumference: f64,
    pub diameter: f64,
    pub centre: [f64; 3],
    /// Why it cannot be filled safely.
    pub problem: Option<String>,
}

/// What is known of a cloud's hole beyond its measures.
#[derive(Debug, Serialize)]
pub(super) struct Detected {
    pub border: bool,
    pub missing_points: f64,
    pub boundary_probability: f64,
    /// Whether no other detector that can judge is against it, and what each says.
    pub agreed: bool,
    pub boundary_loops: bool,
    pub distance_field: Option<bool>,
}

impl Detected {
    /// Of one hole, by its id.
    pub fn of(found: &PointHoles, hole: usize) -> Self {
        Self {
            border: found.borders[hole],
            missing_points: found.missing_in[hole],
            boundary_probability: found.probability[hole],
            agreed: found.agreed(hole),
            boundary_loops: found.in_loops[hole],
            distance_field: found.in_field[hole],
        }
    }

    /// The detectors that see it, for a table or a message.
    pub fn seen_by(&self) -> String {
        let loops = if self.boundary_loops { " loops" } else { "" };
        let field = match self.distance_field {
            Some(true) => " field",
            Some(false) => "",
            None => " -",
        };
        format!("mesh{loops}{field}")
    }
}

/// Something about the mesh that the user should know; nothing was changed.
#[derive(Debug, Serialize)]
pub(super) struct Warning {
    pub kind: &'static str,
    pub message: String,
    pub count: usize,
    /// The first 20: pairs of vertices, faces, points, holes, places, or files.
    pub elements: Vec<Element>,
}

/// An element that a warning names.
#[derive(Debug, Serialize)]
#[serde(untagged)]
pub(super) enum Element {
    Vertices([u32; 2]),
    Face(u32),
    Point(u32),
    Hole(usize),
    Place([f64; 3]),
    Text(String),
}

impl Measured {
    /// Of one hole.
    pub fn of(hole: &Hole) -> Self {
        Self {
            id: hole.id,
            kind: kind_name(hole.kind),
            loops: hole.loops.len(),
            edges: hole.edges,
            circumference: hole.circumference,
            diameter: hole.diameter,
            centre: hole.centre,
            problem: hole.problem.as_ref().map(ToString::to_string),
        }
    }
}

fn kind_name(kind: HoleKind) -> &'static str {
    match kind {
        HoleKind::Disc => "disc",
        HoleKind::Islands => "islands",
        HoleKind::Ring => "ring",
        HoleKind::Several => "several",
    }
}

impl Report {
    /// Of a completion.
    pub fn new(
        input: File,
        output: File,
        options: &Options,
        holes: &HoleList,
        done: &Completion,
    ) -> Self {
        let entries: Vec<HoleEntry> = done
            .holes
            .iter()
            .filter_map(|report| {
                let hole = holes.holes.get(report.hole)?;
                let (status, reason) = match &report.status {
                    HoleStatus::Filled => ("filled", None),
                    HoleStatus::NotSelected => ("not-selected", None),
                    HoleStatus::Unsafe(problem) => ("unsafe", Some(problem.to_string())),
                    HoleStatus::Failed(error) => ("failed", Some(error.to_string())),
                };
                Some(HoleEntry {
                    measured: Measured::of(hole),
                    detected: None,
                    status,
                    reason,
                    method: (status == "filled").then(|| report.method.name()),
                    fairing: (status == "filled").then(|| report.fairing.name()),
                    candidates: report.candidates,
                    confidence: report.confidence,
                    coherence_error: report.coherence_error,
                    sources: report.sources.iter().map(SourceEntry::of).collect(),
                    new_vertices: report.vertices.len(),
                    new_faces: report.faces.len(),
                    seconds: report.seconds,
                })
            })
            .collect();
        Self {
            version: env!("CARGO_PKG_VERSION"),
            method: options.method.name(),
            fairing: options.fairing.name(),
            threads: options.threads,
            candidate: options.guidance.candidate,
            input,
            output,
            new_vertices: done.vertices.len(),
            new_faces: done.faces.len(),
            holes_found: entries.len(),
            holes_filled: entries.iter().filter(|e| e.status == "filled").count(),
            fill_seconds: done.seconds,
            fill_cpu_seconds: done.cpu_seconds,
            holes: entries,
            warnings: warnings(holes),
        }
    }
}

impl Report {
    /// Of a cloud's completion: vertices are points, and there are no faces.
    pub fn of_points(input: File, output: File, options: &Options, made: &PointCompletion) -> Self {
        let mut report = Self::new(input, output, options, &made.found.list, &made.completion);
        report.new_faces = 0;
        for hole in &mut report.holes {
            hole.new_faces = 0;
            hole.detected = Some(Detected::of(&made.found, hole.measured.id));
        }
        report.warnings = point_warnings(&made.found);
        report
    }
}

/// What is odd about a cloud.
pub(super) fn point_warnings(found: &PointHoles) -> Vec<Warning> {
    let points = |kind, what: &str, list: &[u32]| Warning {
        kind,
        message: message(list.len(), what, list.first().map(ToString::to_string)),
        count: list.len(),
        elements: list.iter().take(LISTED).map(|&p| Element::Point(p)).collect(),
    };
    let all = [
        points(
            "missing-points",
            "points have no coordinates; they are passed through",
            &found.missing,
        ),
        points(
            "duplicate-points",
            "points are at the place of an earlier one; they stay and were not looked at",
            &found.doubles,
        ),
        points(
            "outliers",
            "points lie beside the surface; they stay and were not looked at",
            &found.outliers,
        ),
        points(
            "points-inside",
            "points lie inside a loop that was given; they stay and were not looked at",
            &found.inside,
        ),
        disagreement(found),
        only_in_field(found),
    ];
    all.into_iter().filter(|w| w.count > 0).collect()
}

/// The holes that not all detectors see.
fn disagreement(found: &PointHoles) -> Warning {
    let all: Vec<usize> =
        (0..found.list.holes.len()).filter(|&h| !found.borders[h] && !found.agreed(h)).collect();
    let first = all.first().map(|&h| format!("{h}, seen by: {}", Detected::of(found, h).seen_by()));
    Warning {
        kind: "detectors-disagree",
        message: message(
            all.len(),
            "holes are not seen by all detectors; they may be sparse places, or cracks",
            first,
        ),
        count: all.len(),
        elements: all.into_iter().take(LISTED).map(Element::Hole).collect(),
    }
}

/// The places that only the distance field takes for holes.
fn only_in_field(found: &PointHoles) -> Warning {
    let all = &found.only_in_field;
    let first = all.first().map(|p| p.map(short).join(" "));
    Warning {
        kind: "only-distance-field",
        message: message(
            all.len(),
            "places are holes for the distance field alone, which takes tight folds for some",
            first,
        ),
        count: all.len(),
        elements: all.iter().take(LISTED).map(|&p| Element::Place(p)).collect(),
    }
}

/// What is odd about the boundary.
pub(super) fn warnings(holes: &HoleList) -> Vec<Warning> {
    let pairs = |kind, what: &str, list: &[[u32; 2]]| Warning {
        kind,
        message: message(list.len(), what, list.first().map(|[a, b]| format!("{a}-{b}"))),
        count: list.len(),
        elements: list.iter().take(LISTED).map(|&e| Element::Vertices(e)).collect(),
    };
    let faces = &holes.degenerate_faces;
    let all = [
        pairs("non-manifold-edges", "edges have more than two faces", &holes.non_manifold_edges),
        pairs(
            "inconsistent-orientation",
            "edges lie between faces oriented against each other; nothing was flipped",
            &holes.inconsistent_edges,
        ),
        pairs(
            "duplicate-vertices",
            "pairs of boundary vertices are at one place; nothing was welded",
            &holes.duplicate_boundary_vertices,
        ),
        Warning {
            kind: "degenerate-faces",
            message: message(
                faces.len(),
                "faces name a vertex twice; they are passed through",
                faces.first().map(ToString::to_string),
            ),
            count: faces.len(),
            elements: faces.iter().take(LISTED).map(|&f| Element::Face(f)).collect(),
        },
    ];
    all.into_iter().filter(|w| w.count > 0).collect()
}

fn message(count: usize, what: &str, first: Option<String>) -> String {
    format!("{count} {what} (the first: {})", first.unwrap_or_default())
}

/// Mean edge length of a mesh, each face's edges counted once; 0 without faces.
pub(super) fn mean_edge(mesh: MeshView<'_>) -> f64 {
    let mut sum = 0.0;
    for f in 0..mesh.faces.len() {
        let p = mesh.faces.get(f).map(|v| mesh.vertices.get(v as usize));
        for k in 0..3 {
            let (a, b) = (p[k], p[(k + 1) % 3]);
            sum += (0..3).map(|x| (a[x] - b[x]).powi(2)).sum::<f64>().sqrt();
        }
    }
    sum / (3 * mesh.faces.len().max(1)) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn warnings_list_twenty_elements_and_count_all() {
        let holes = HoleList {
            inconsistent_edges: (0..57).map(|i| [i, i + 1]).collect(),
            degenerate_faces: vec![7],
            ..HoleList::default()
        };
        let json = serde_json::to_value(warnings(&holes)).unwrap();
        assert_eq!(json.as_array().unwrap().len(), 2);
        assert_eq!(json[0]["kind"], "inconsistent-orientation");
        assert_eq!(json[0]["count"], 57);
        assert_eq!(json[0]["elements"].as_array().unwrap().len(), LISTED);
        assert_eq!(json[0]["elements"][3], serde_json::json!([3, 4]));
        assert_eq!(json[1]["elements"], serde_json::json!([7]));
    }

    #[test]
    fn mean_edge_of_a_right_triangle() {
        let (v, f) = ([[0.0f32, 0.0, 0.0], [3.0, 0.0, 0.0], [0.0, 4.0, 0.0]], [[0u32, 1, 2]]);
        assert_eq!(mean_edge(MeshView::new(&v[..], &f[..])), 4.0);
        assert_eq!(mean_edge(MeshView::new(&v[..], &f[..0])), 0.0);
    }
}

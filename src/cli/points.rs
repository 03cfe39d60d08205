//! `fill` and `holes` on files without faces: point clouds.

use super::args::{FillArgs, HolesArgs};
use super::console::{short, Console};
use super::failure::Failure;
use super::fill::{describe, tell, tell_warnings, write};
use super::output::Outputs;
use super::report::{point_warnings, File, Measured, Report, Warning};
use super::{check_interrupt, interrupt};
use crate::io::{Document, Extras};
use crate::options::Options;
use crate::points::{complete_points_with, find_point_holes, PointCompletion, PointHoles};
use crate::progress::Monitor;
use serde::Serialize;

/// The last line of `holes --json`.
#[derive(Serialize)]
struct Summary {
    path: String,
    points: usize,
    spacing: f64,
    holes: usize,
    borders: usize,
    warnings: Vec<Warning>,
}

/// A hole as `holes --json` tells it.
#[derive(Serialize)]
struct Hole {
    #[serde(flatten)]
    measured: Measured,
    border: bool,
    missing_points: f64,
    boundary_probability: f64,
    agreed: bool,
}

/// The table of a cloud's holes.
pub(super) fn holes(
    args: &HolesArgs,
    document: &Document,
    console: &Console,
) -> Result<(), Failure> {
    let normals = document.vertex_normals();
    let normals = normals.as_deref().map(Into::into);
    let progress = |fraction: f64, stage: &str| console.progress(fraction, stage);
    let monitor = Monitor::new(&progress);
    let points = document.vertices();
    let found = interrupt::watched(&monitor, || {
        find_point_holes(points, normals, &args.grouping.grouping(), 0, &monitor)
    })?;
    console.clear();
    console.say(&format!(
        "{}: {} points, no faces, spacing {}",
        args.input.display(),
        points.len(),
        short(found.spacing)
    ));
    let borders = found.borders.iter().filter(|b| **b).count();
    if found.list.holes.is_empty() {
        console.say("no holes");
    } else {
        console.say(&table(&found));
        if found.agreed.contains(&false) {
            console.say("? only the mesh through the points has this hole, the likely boundary points close no loop");
        }
    }
    for (i, hole) in found.list.holes.iter().enumerate() {
        let (border, missing_points) = (found.borders[i], found.missing_in[i]);
        let (measured, boundary_probability) = (Measured::of(hole), found.probability[i]);
        let agreed = found.agreed[i];
        let hole = Hole { measured, border, missing_points, boundary_probability, agreed };
        console.event("hole", &hole);
    }
    let warnings = point_warnings(&found);
    tell_warnings(&warnings, console);
    let summary = Summary {
        path: args.input.display().to_string(),
        points: points.len(),
        spacing: found.spacing,
        holes: found.list.holes.len() - borders,
        borders,
        warnings,
    };
    console.event("done", &summary);
    Ok(())
}

/// The table; lengths in cloud units and, in brackets, in spacings.
fn table(found: &PointHoles) -> String {
    let head = ["id", "kind", "loops", "rim", "missing", "circumference", "diameter", "centre"];
    let length = |x: f64| format!("{} ({:.1})", short(x), x / found.spacing);
    let mut rows = vec![head.map(str::to_owned)];
    rows.extend(found.list.holes.iter().enumerate().map(|(i, hole)| {
        let m = Measured::of(hole);
        let border = found.borders[i];
        [
            m.id.to_string(),
            format!(
                "{}{}",
                if border { "border" } else { m.kind },
                if found.agreed[i] { "" } else { "?" }
            ),
            m.loops.to_string(),
            m.edges.to_string(),
            if border { "-".into() } else { format!("{:.0}", found.missing_in[i]) },
            length(m.circumference),
            length(m.diameter),
            m.centre.map(|x| short(if x.abs() < 1e-9 * m.diameter { 0.0 } else { x })).join(" "),
        ]
    }));
    super::holes::align(&rows, &[1, 7])
}

/// Fills a cloud's holes; `output` has been converted to the format that is written.
pub(super) fn fill(
    args: &FillArgs,
    options: &Options,
    input: File,
    mut document: Document,
    exemplar: Option<&Document>,
    console: &Console,
) -> Result<(), Failure> {
    for (given, name) in [
        (args.picture.is_some(), "--picture"),
        (args.initial.is_some(), "--initial"),
        (args.guidance.candidates.is_some(), "--candidates"),
    ] {
        if given {
            return Err(Failure::Usage(format!("{name} takes a mesh; the input has no faces")));
        }
    }
    let made = complete(&document, options, console)?;
    let extras = Extras { provenance: args.provenance };
    document.append_points_with(&made, &extras, exemplar)?;
    let output = describe(&args.output, &document);
    let report = Report::of_points(input, output, options, &made);
    write(args, Outputs::default(), &report, &document, console)?;
    tell(&report, &made.completion, console);
    Ok(())
}

fn complete(
    document: &Document,
    options: &Options,
    console: &Console,
) -> Result<PointCompletion, Failure> {
    let normals = document.vertex_normals();
    let normals = normals.as_deref().map(Into::into);
    let progress = |fraction: f64, stage: &str| console.progress(fraction, stage);
    let monitor = Monitor::new(&progress);
    let made = interrupt::watched(&monitor, || {
        complete_points_with(document.vertices(), normals, options, &monitor)
    })?;
    check_interrupt()?;
    Ok(made)
}

//! `fill` and `holes` on files without faces: point clouds.

use super::args::{FillArgs, HolesArgs};
use super::console::{short, Console};
use super::failure::Failure;
use super::fill::{describe, tell, tell_warnings, write};
use super::output::Outputs;
use super::report::{point_warnings, Detected, File, Measured, Report, Warning};
use super::{check_interrupt, interrupt};
use crate::io::{Document, Extras, Format, IoError};
use crate::options::Options;
use crate::points::{
    complete_points_with, find_point_holes, CleanedPoints, PointCompletion, PointHoles,
};
use crate::progress::Monitor;
use serde::Serialize;
use std::path::Path;

/// The last line of `holes --json`.
#[derive(Serialize)]
struct Summary {
    path: String,
    points: usize,
    spacing: f64,
    holes: usize,
    borders: usize,
    /// Centres of the places that only the distance field takes for holes.
    only_distance_field: Vec<[f64; 3]>,
    warnings: Vec<Warning>,
}

/// A hole as `holes --json` tells it.
#[derive(Serialize)]
struct Hole {
    #[serde(flatten)]
    measured: Measured,
    #[serde(flatten)]
    detected: Detected,
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
        let (grouping, given_holes) = (args.grouping.grouping(), args.given.holes());
        let options = Options { grouping, given_holes, ..Options::default() };
        find_point_holes(points, normals, &options, &monitor)
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
        console.say(
            "seen by: mesh through the points; loops of likely boundary points; distance field \
             (- where it cannot say: the surface is open)",
        );
    }
    for (i, hole) in found.list.holes.iter().enumerate() {
        let (measured, detected) = (Measured::of(hole), Detected::of(&found, i));
        console.event("hole", &Hole { measured, detected });
    }
    let warnings = point_warnings(&found);
    tell_warnings(&warnings, console);
    let summary = Summary {
        path: args.input.display().to_string(),
        points: points.len(),
        spacing: found.spacing,
        holes: found.list.holes.len() - borders,
        borders,
        only_distance_field: found.only_in_field.clone(),
        warnings,
    };
    console.event("done", &summary);
    Ok(())
}

/// The table; lengths in cloud units and, in brackets, in spacings.
fn table(found: &PointHoles) -> String {
    let head =
        ["id", "kind", "loops", "rim", "missing", "circumference", "diameter", "centre", "seen by"];
    let length = |x: f64| format!("{} ({:.1})", short(x), x / found.spacing);
    let mut rows = vec![head.map(str::to_owned)];
    rows.extend(found.list.holes.iter().enumerate().map(|(i, hole)| {
        let m = Measured::of(hole);
        let border = found.borders[i];
        [
            m.id.to_string(),
            if border { "border".into() } else { m.kind.to_owned() },
            m.loops.to_string(),
            m.edges.to_string(),
            if border { "-".into() } else { format!("{:.0}", found.missing_in[i]) },
            length(m.circumference),
            length(m.diameter),
            m.centre.map(|x| short(if x.abs() < 1e-9 * m.diameter { 0.0 } else { x })).join(" "),
            Detected::of(found, i).seen_by(),
        ]
    }));
    super::holes::align(&rows, &[1, 7, 8])
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
    let mut outputs = Outputs::default();
    if let (Some(path), Some(cleaned)) = (&args.cleaned, &made.cleaned) {
        let copy = cleaned_copy(&document, &made, cleaned, path)?;
        outputs.stage(path, |w| w.write_all(copy.as_bytes()))?;
    }
    write(args, outputs, &report, &document, console)?;
    tell(&report, &made.completion, console);
    if let (Some(path), Some(cleaned)) = (&args.cleaned, &made.cleaned) {
        let removed = cleaned.removed.iter().filter(|r| **r).count();
        console.say(&format!("wrote {}: {removed} points removed", path.display()));
    }
    Ok(())
}

/// What is left of the input, smoothed, and the new points; with the colours of the completed cloud.
/// Other columns stay with the points that they were measured at.
fn cleaned_copy(
    completed: &Document,
    made: &PointCompletion,
    cleaned: &CleanedPoints,
    path: &Path,
) -> Result<Document, Failure> {
    let format =
        Format::from_path(path).ok_or_else(|| IoError::UnknownFormat { path: path.to_owned() })?;
    let count = cleaned.removed.len();
    let kept: Vec<usize> =
        (0..completed.vertices().len()).filter(|&i| i >= count || !cleaned.removed[i]).collect();
    let at = |&i: &usize| match i.checked_sub(count) {
        Some(new) => made.completion.vertices[new],
        None => cleaned.positions[i],
    };
    let positions = kept.iter().map(at);
    let single = || positions.clone().map(|p| p.map(|x| x as f32)).collect::<Vec<_>>();
    let copy = match completed.vertex_colours() {
        Some(all) => {
            let colours: Vec<[u8; 4]> = kept.iter().map(|&i| all[i]).collect();
            Document::from_painted_mesh_f32(&single(), &[], &colours)?
        }
        None if completed.vertices().is_single() => Document::from_mesh_f32(single(), vec![])?,
        None => Document::from_mesh_f64(positions.collect(), vec![])?,
    };
    match format {
        Format::Ply => Ok(copy),
        other => Ok(copy.convert(other)?),
    }
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

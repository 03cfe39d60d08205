//! `complete-mesh fill --candidates N`: a file for each of the best places that a fill could come from.

use super::args::FillArgs;
use super::console::Console;
use super::failure::Failure;
use super::fill::{describe, draw, tell, wardrobe};
use super::output::{same_file, Outputs};
use super::report::{File, Report};
use super::{check_interrupt, interrupt};
use crate::complete::Completer;
use crate::error::Error;
use crate::io::{Document, Extras};
use crate::mesh::MeshView;
use crate::options::Options;
use crate::progress::Monitor;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// What `--report` writes then: a report for each file, the best first.
#[derive(Serialize)]
struct Reports {
    candidates: Vec<Report>,
}

/// Fills, and writes all files together or none.
pub(super) fn run(
    args: &FillArgs,
    count: usize,
    options: &Options,
    input: &File,
    document: &Document,
    exemplar: Option<&Document>,
    console: &Console,
) -> Result<(), Failure> {
    check_paths(args, count)?;
    let mesh = MeshView::new(document.vertices(), document.faces());
    let progress = |fraction: f64, stage: &str| console.progress(fraction, stage);
    let monitor = Monitor::new(&progress);
    let (holes, all) = interrupt::watched(&monitor, || {
        let completer = Completer::new(mesh, &options.grouping, &monitor)?;
        let all = completer.candidates(count, options, &monitor)?;
        Ok::<_, Error>((completer.holes().clone(), all))
    })?;
    check_interrupt()?;
    if all.is_empty() {
        return Err(Failure::NoCandidate);
    }
    let extras = Extras { provenance: args.provenance };
    let (mut outputs, mut reports) = (Outputs::default(), Vec::new());
    let wardrobe = args.picture.as_ref().map(|_| wardrobe(args, document));
    for (i, completion) in all.iter().enumerate() {
        let mut own = document.clone();
        own.append_with(completion, &extras, exemplar)?;
        let mut drawn_plain = Vec::new();
        if let (Some(path), Some(wardrobe)) = (&args.picture, &wardrobe) {
            console.step("draw");
            let image;
            (image, drawn_plain) = draw(&own, &holes, completion, args.tint, wardrobe);
            outputs.stage(&numbered(path, i + 1), |w| image.write_png(w))?;
        }
        let path = numbered(&args.output, i + 1);
        outputs.stage(&path, |w| w.write_all(own.as_bytes()))?;
        let mut report =
            Report::new(input.clone(), describe(&path, &own), options, &holes, completion);
        report.warnings.extend(drawn_plain);
        reports.push(Report { candidate: i + 1, ..report });
    }
    let reports = Reports { candidates: reports };
    if let Some(path) = &args.report {
        outputs.stage(path, |w| {
            serde_json::to_writer_pretty(&mut *w, &reports)?;
            w.write_all(b"\n")
        })?;
    }
    check_interrupt()?;
    outputs.commit()?;
    console.clear();
    for (report, completion) in reports.candidates.iter().zip(&all) {
        tell(report, completion, console);
    }
    if all.len() < count {
        console.warn(&format!("there are {} candidates, not {count}", all.len()));
    }
    Ok(())
}

/// OUT.ply as OUT-3.ply.
fn numbered(path: &Path, number: usize) -> PathBuf {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let name = match path.extension() {
        Some(ending) => format!("{stem}-{number}.{}", ending.to_string_lossy()),
        None => format!("{stem}-{number}"),
    };
    path.with_file_name(name)
}

/// No file that is read, nor the report, may be one of those written.
fn check_paths(args: &FillArgs, count: usize) -> Result<(), Failure> {
    let mut others = vec![("IN", &args.input)];
    others.extend(args.report.as_ref().map(|p| ("--report", p)));
    others.extend(args.initial.as_ref().map(|p| ("--initial", p)));
    others.extend(args.sources.exemplar.iter().map(|p| ("--exemplar", p)));
    others.extend(args.guidance.points.as_ref().map(|p| ("--points", p)));
    let made = |path: &Path| (1..=count).map(|i| numbered(path, i)).collect::<Vec<_>>();
    let mut written = made(&args.output);
    written.extend(args.picture.as_deref().map(made).unwrap_or_default());
    for path in &written {
        if let Some((name, _)) = others.iter().find(|(_, other)| same_file(path, other)) {
            let path = path.display();
            return Err(Failure::Usage(format!(
                "{name} is one of the files to be written: {path}"
            )));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_get_their_number_before_the_ending() {
        for (path, wanted) in [("a/out.ply", "a/out-3.ply"), ("b.c.obj", "b.c-3.obj"), ("x", "x-3")]
        {
            assert_eq!(numbered(Path::new(path), 3), Path::new(wanted));
        }
    }
}

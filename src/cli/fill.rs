//! `complete-mesh fill`: reads, completes, writes; the mesh, the report and the picture together
//! or nothing.

use super::args::FillArgs;
use super::candidates;
use super::console::Console;
use super::failure::Failure;
use super::output::{same_file, Outputs};
use super::points;
use super::report::{warnings, File, Report, Warning};
use super::skin::Wardrobe;
use super::{check_interrupt, interrupt};
use crate::complete::Completer;
use crate::error::Error;
use crate::holes::HoleList;
use crate::io::{Document, Extras, Format, IoError};
use crate::mesh::MeshView;
use crate::options::{Appearance, Initial, Options};
use crate::picture::{before_and_after, with_sources, Image, Shape};
use crate::progress::Monitor;
use crate::result::{Completion, HoleStatus};
use std::path::Path;
use std::sync::Arc;

/// Holes that the summary tells about one by one.
const TOLD: usize = 12;

pub(super) fn run(args: &FillArgs, console: &Console) -> Result<(), Failure> {
    let mut options = args.options()?;
    check_paths(args)?;
    let format = Format::from_path(&args.output)
        .ok_or_else(|| IoError::UnknownFormat { path: args.output.clone() })?;
    console.step("read");
    let mut document = Document::read(&args.input)?;
    check_interrupt()?;
    let input = describe(&args.input, &document);
    // Before the fill: another format may number the vertices anew.
    document = convert(document, format, console)?;
    let mut exemplars = args.sources.exemplars()?;
    options.sources = args.sources.sources(&document, &exemplars);
    let exemplar = match exemplars.len() {
        0 | 1 => exemplars.pop(),
        _ => Some(joined(&exemplars)?),
    };
    options.appearance = appearance(&document, exemplar.as_ref());
    if document.is_cloud() {
        return points::fill(args, &options, input, document, exemplar.as_ref(), console);
    }
    args.given.none_of_a_mesh()?;
    if let Some(path) = &args.initial {
        options.initial = Some(Arc::new(initial(path, &document)?));
    }
    if let Some(count) = args.guidance.candidates {
        let exemplar = exemplar.as_ref();
        return candidates::run(args, count, &options, &input, &document, exemplar, console);
    }
    let (holes, completion) = complete(&document, &options, console)?;
    let extras = Extras { provenance: args.provenance };
    document.append_with(&completion, &extras, exemplar.as_ref())?;
    let mut outputs = Outputs::default();
    let mut drawn_plain = Vec::new();
    if let Some(path) = &args.picture {
        console.step("draw");
        let wardrobe = wardrobe(args, &document);
        let image;
        (image, drawn_plain) = draw(&document, &holes, &completion, args.tint, &wardrobe);
        outputs.stage(path, |w| image.write_png(w))?;
    }
    let output = describe(&args.output, &document);
    let mut report = Report::new(input, output, &options, &holes, &completion);
    report.warnings.extend(drawn_plain);
    write(args, outputs, &report, &document, console)?;
    tell(&report, &completion, console);
    Ok(())
}

/// Writes the report and the completed document, and with them what is staged already.
pub(super) fn write(
    args: &FillArgs,
    mut outputs: Outputs,
    report: &Report,
    document: &Document,
    console: &Console,
) -> Result<(), Failure> {
    if let Some(path) = &args.report {
        outputs.stage(path, |w| {
            serde_json::to_writer_pretty(&mut *w, report)?;
            w.write_all(b"\n")
        })?;
    }
    console.step("write");
    outputs.stage(&args.output, |w| w.write_all(document.as_bytes()))?;
    check_interrupt()?;
    outputs.commit()?;
    console.clear();
    Ok(())
}

/// Several exemplars as one file, which is asked for its faces and colours only: those, if all have them.
fn joined(all: &[Document]) -> Result<Document, Failure> {
    let (mut vertices, mut faces, mut colours) = (Vec::new(), Vec::new(), Vec::new());
    for one in all {
        let first = vertices.len() as u32;
        vertices.extend((0..one.vertices().len()).map(|v| one.vertices().get(v).map(|x| x as f32)));
        faces.extend((0..one.faces().len()).map(|f| one.faces().get(f).map(|v| v + first)));
        colours.extend(one.vertex_colours().into_iter().flatten());
    }
    Ok(match colours.len() == vertices.len() {
        true => Document::from_painted_mesh_f32(&vertices, &faces, &colours)?,
        false => Document::from_mesh_f32(vertices, faces)?,
    })
}

/// The colours of the file, which help to find where to copy from.
fn appearance(document: &Document, exemplar: Option<&Document>) -> Option<Arc<Appearance>> {
    let numbers = |colours: Vec<[u8; 4]>| -> Vec<f64> {
        colours.iter().flat_map(|c| [c[0], c[1], c[2]]).map(f64::from).collect()
    };
    let values = numbers(document.vertex_colours()?);
    let exemplar_values = exemplar.and_then(Document::vertex_colours).map(numbers);
    let exemplar_values = exemplar_values.unwrap_or_default();
    Some(Arc::new(Appearance { channels: 3, steering: 3, values, exemplar_values }))
}

/// What another file adds to the mesh that was read.
fn initial(path: &Path, document: &Document) -> Result<Initial, Failure> {
    let other = Document::read(path)?;
    let (vertices, faces) = (other.vertices(), other.faces());
    let (count, first) = (document.vertices().len(), document.faces().len());
    let same = vertices.len() >= count
        && faces.len() >= first
        && (0..count).all(|v| vertices.get(v) == document.vertices().get(v))
        && (0..first).all(|f| faces.get(f) == document.faces().get(f));
    if !same {
        return Err(Failure::Usage(format!(
            "{} does not begin with the vertices and faces of the input: --initial takes a completed \
             mesh, input first",
            path.display()
        )));
    }
    Ok(Initial {
        vertices: (count..vertices.len()).map(|v| vertices.get(v)).collect(),
        faces: (first..faces.len()).map(|f| faces.get(f)).collect(),
    })
}

/// No file may be written twice, and only the mesh may take the input's place.
fn check_paths(args: &FillArgs) -> Result<(), Failure> {
    let mut named = vec![("IN", &args.input), ("OUT", &args.output)];
    named.extend(args.report.as_ref().map(|p| ("--report", p)));
    named.extend(args.picture.as_ref().map(|p| ("--picture", p)));
    named.extend(args.cleaned.as_ref().map(|p| ("--cleaned", p)));
    named.extend(args.initial.as_ref().map(|p| ("--initial", p)));
    named.extend(args.sources.exemplar.iter().map(|p| ("--exemplar", p)));
    named.extend(args.guidance.points.as_ref().map(|p| ("--points", p)));
    for (i, (a, path)) in named.iter().enumerate() {
        for (b, other) in &named[i + 1..] {
            let both_read = a == b || (*a, *b) == ("IN", "OUT");
            if !both_read && same_file(path, other) {
                return Err(Failure::Usage(format!(
                    "{a} and {b} name one file: {}",
                    path.display()
                )));
            }
        }
    }
    Ok(())
}

/// Finds and fills the holes, with a bar and Ctrl-C.
pub(super) fn complete(
    document: &Document,
    options: &Options,
    console: &Console,
) -> Result<(HoleList, Completion), Failure> {
    let mesh = MeshView::new(document.vertices(), document.faces());
    let progress = |fraction: f64, stage: &str| console.progress(fraction, stage);
    let monitor = Monitor::new(&progress);
    let result = interrupt::watched(&monitor, || {
        let completer = Completer::new(mesh, &options.grouping, &monitor)?;
        let completion = completer.complete(options, &monitor)?;
        Ok::<_, Error>((completer.holes().clone(), completion))
    })?;
    check_interrupt()?;
    Ok(result)
}

/// The materials that the input names.
pub(super) fn wardrobe(args: &FillArgs, document: &Document) -> Wardrobe {
    Wardrobe::open(document, args.input.parent().unwrap_or(Path::new("")))
}

/// Both pictures from the completed document: the input's faces come first in it. And what is drawn plain
/// for want of a texture.
pub(super) fn draw(
    document: &Document,
    holes: &HoleList,
    completion: &Completion,
    tint: bool,
    wardrobe: &Wardrobe,
) -> (Image, Vec<Warning>) {
    let (skin, warnings) = wardrobe.dress(document);
    let view = document.faces();
    let faces: Vec<[u32; 3]> = (0..view.len()).map(|f| view.get(f)).collect();
    let colours: Option<Vec<[u8; 3]>> =
        document.vertex_colours().map(|c| c.iter().map(|c| [c[0], c[1], c[2]]).collect());
    let shape = |count: usize| Shape {
        mesh: MeshView::new(document.vertices(), &faces[..count]),
        colours: colours.as_deref(),
        tints: None,
        skin: skin.as_ref(),
    };
    let filled: Vec<usize> = completion
        .holes
        .iter()
        .filter(|h| h.status != HoleStatus::NotSelected)
        .map(|h| h.hole)
        .collect();
    let (before, after) = (shape(completion.input_face_count), shape(faces.len()));
    let image = if tint {
        with_sources(&before, &after, holes, &filled, completion)
    } else {
        before_and_after(&before, &after, holes, &filled)
    };
    (image, warnings)
}

pub(super) fn describe(path: &Path, document: &Document) -> File {
    File {
        path: path.display().to_string(),
        format: document.format().to_string(),
        vertices: document.vertices().len(),
        faces: document.faces().len(),
    }
}

/// Changes the format where OUT's name asks for it, and says what is lost.
pub(super) fn convert(
    document: Document,
    format: Format,
    console: &Console,
) -> Result<Document, Failure> {
    if document.format() == format {
        return Ok(document);
    }
    let converted = document.convert(format)?;
    for what in converted.dropped() {
        console.warn(&format!("lost in the conversion to {format}: {what}"));
    }
    Ok(converted)
}

/// The summary.
pub(super) fn tell(report: &Report, completion: &Completion, console: &Console) {
    tell_warnings(&report.warnings, console);
    for hole in &report.holes {
        if let Some(reason) = &hole.reason {
            console.warn(&format!("hole {} was left open: {reason}", hole.measured.id));
        }
    }
    console.event("done", report);
    let plural = |n: usize, word: &str| format!("{n} {word}{}", if n == 1 { "" } else { "s" });
    if report.holes_found == 0 {
        console.say("no holes: the mesh is closed, the output equals the input");
    } else {
        console.say(&format!(
            "filled {} of {}: {} and {} new, in {:.3} s ({:.3} s CPU)",
            report.holes_filled,
            plural(report.holes_found, "hole"),
            plural(report.new_vertices, "vertex").replace("vertexs", "vertices"),
            plural(report.new_faces, "face"),
            report.fill_seconds,
            report.fill_cpu_seconds,
        ));
        let filled = || completion.holes.iter().filter(|h| h.status == HoleStatus::Filled);
        for hole in filled().take(TOLD) {
            console.say(&format!("  hole {}: {}", hole.hole, hole.summary()));
        }
        if filled().count() > TOLD {
            let more = plural(filled().count() - TOLD, "more hole");
            console.say(&format!("  and {more}; --report lists all"));
        }
    }
    console.say(&format!("wrote {}", report.output.path));
}

/// Warnings about the mesh. With `--json` they are part of the last line.
pub(super) fn tell_warnings(list: &[Warning], console: &Console) {
    if !console.is_json() {
        list.iter().for_each(|w| console.warn(&w.message));
    }
}

/// Warnings of a mesh that was only looked at.
pub(super) fn look(holes: &HoleList, console: &Console) -> Vec<Warning> {
    let list = warnings(holes);
    tell_warnings(&list, console);
    list
}

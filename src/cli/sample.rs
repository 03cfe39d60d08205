//! `complete-mesh sample`: the procedural models.

use super::args::SampleArgs;
use super::console::Console;
use super::failure::Failure;
use super::fill::convert;
use super::output::{same_file, Outputs};
use crate::io::{Document, Format, IoError};
use crate::sample::{break_mesh, BreakOptions, SampleMesh};
use serde::Serialize;
use std::path::Path;

#[derive(Serialize)]
struct Made {
    sample: &'static str,
    #[serde(rename = "break")]
    broken: Option<&'static str>,
    path: String,
    vertices: usize,
    faces: usize,
    /// Faces of the piece broken off.
    removed_faces: usize,
}

pub(super) fn run(args: &SampleArgs, console: &Console) -> Result<(), Failure> {
    if args.truth.as_ref().is_some_and(|t| same_file(t, &args.output)) {
        return Err(Failure::Usage("--output and --truth name one file".into()));
    }
    if args.painted && args.sample.paint(&[]).is_none() {
        return Err(Failure::Usage(format!("--painted: {} has no colours", args.sample.name())));
    }
    console.step("make");
    let mut mesh = args.sample.build(args.resolution)?;
    let mut outputs = Outputs::default();
    let stage = |outputs: &mut Outputs, path: &Path, mesh: SampleMesh| match args.painted {
        true => {
            let colours = args.sample.paint(&mesh.vertices).unwrap_or_default();
            let made = Document::from_painted_mesh_f32(&mesh.vertices, &mesh.faces, &colours)?;
            stage_document(outputs, path, made, console)
        }
        false => stage_mesh(outputs, path, mesh, console),
    };
    let mut removed_faces = 0;
    if let Some(kind) = args.broken {
        let options = BreakOptions { kind, seed: args.seed, size: args.size };
        let broken = break_mesh(args.sample, &mesh, &options)?;
        removed_faces = broken.removed.faces.len();
        mesh = broken.mesh;
        if let Some(path) = &args.truth {
            stage(&mut outputs, path, broken.removed)?;
        }
    }
    let made = Made {
        sample: args.sample.name(),
        broken: args.broken.map(|b| b.name()),
        path: args.output.display().to_string(),
        vertices: mesh.vertices.len(),
        faces: mesh.faces.len(),
        removed_faces,
    };
    super::check_interrupt()?;
    stage(&mut outputs, &args.output, mesh)?;
    super::check_interrupt()?;
    outputs.commit()?;
    console.clear();
    console.event("done", &made);
    let Made { sample, path, vertices, faces, .. } = &made;
    console.say(&format!("{sample}: {vertices} vertices, {faces} faces, written to {path}"));
    Ok(())
}

/// A mesh in the format that the path's ending names.
pub(super) fn stage_mesh(
    outputs: &mut Outputs,
    path: &Path,
    mesh: SampleMesh,
    console: &Console,
) -> Result<(), Failure> {
    stage_document(outputs, path, Document::from_mesh_f32(mesh.vertices, mesh.faces)?, console)
}

fn stage_document(
    outputs: &mut Outputs,
    path: &Path,
    document: Document,
    console: &Console,
) -> Result<(), Failure> {
    let format =
        Format::from_path(path).ok_or_else(|| IoError::UnknownFormat { path: path.to_owned() })?;
    let document = convert(document, format, console)?;
    outputs.stage(path, |w| w.write_all(document.as_bytes()))
}

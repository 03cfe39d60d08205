//! The result: the fills appended in order of their holes' ids, and the report of every hole.

use super::smooth::Fill;
use super::Outcome;
use crate::error::{Error, Result};
use crate::holes::{Hole, HoleList};
use crate::mesh::neighbourhood::Neighbourhood;
use crate::mesh::MeshView;
use crate::options::{Fairing, Method};
use crate::result::{Completion, HoleReport, HoleStatus, Origin};

/// A result without fills: every hole's report says whether it was wanted.
pub fn blank(mesh: MeshView<'_>, list: &HoleList, wanted: &[bool]) -> Completion {
    Completion {
        input_vertex_count: mesh.vertices.len(),
        input_face_count: mesh.faces.len(),
        vertices: Vec::new(),
        faces: Vec::new(),
        vertex_hole: Vec::new(),
        origins: Vec::new(),
        colour_origins: Vec::new(),
        loose: Default::default(),
        face_hole: Vec::new(),
        holes: list.holes.iter().map(|h| blank_report(h, wanted[h.id])).collect(),
        seconds: 0.0,
        cpu_seconds: 0.0,
    }
}

/// Adds what became of the holes worked on, in order of their ids.
pub fn assemble(
    mut out: Completion,
    near: &Neighbourhood,
    todo: &[&Hole],
    outcomes: Vec<Outcome>,
    skip_unsafe: bool,
) -> Result<Completion> {
    for (hole, outcome) in todo.iter().zip(outcomes) {
        let (first_vertex, first_face) = (out.vertices.len(), out.faces.len());
        let report = &mut out.holes[hole.id];
        report.vertices = first_vertex..first_vertex;
        report.faces = first_face..first_face;
        match outcome {
            Ok((mut fill, seconds)) => {
                let vertices = append(near, &mut fill, hole.id, &mut out)?;
                let report = &mut out.holes[hole.id];
                report.vertices = first_vertex..first_vertex + vertices;
                report.faces = first_face..out.faces.len();
                report.status = HoleStatus::Filled;
                report.method = fill.method;
                report.coherence_error = fill.coherence_error;
                report.fairing = fill.fairing;
                report.candidates = fill.candidates;
                if let Some(story) = fill.story {
                    report.sources = story.sources;
                    report.seams = story.seams;
                    report.ring = story.ring;
                    report.confidence = story.confidence;
                }
                report.seconds = seconds;
            }
            Err((reason, seconds)) => {
                let error = Error::HoleFailed { hole: hole.id, reason };
                if !skip_unsafe {
                    return Err(error);
                }
                report.status = HoleStatus::Failed(error);
                report.seconds = seconds;
            }
        }
    }
    Ok(out)
}

fn blank_report(hole: &Hole, wanted: bool) -> HoleReport {
    let status = match &hole.problem {
        Some(problem) if wanted => HoleStatus::Unsafe(problem.clone()),
        _ => HoleStatus::NotSelected,
    };
    HoleReport {
        hole: hole.id,
        loops: hole.loops.clone(),
        status,
        method: Method::Smooth,
        fairing: Fairing::Auto,
        sources: Vec::new(),
        seams: Vec::new(),
        ring: Vec::new(),
        candidates: 0,
        confidence: 0.0,
        coherence_error: None,
        vertices: 0..0,
        faces: 0..0,
        seconds: 0.0,
    }
}

/// Appends a fill; returns how many vertices it has.
fn append(
    near: &Neighbourhood,
    fill: &mut Fill,
    hole: usize,
    out: &mut Completion,
) -> Result<usize> {
    let rim = fill.patch.rim_count;
    let base = out.input_vertex_count + out.vertices.len();
    let new = &fill.patch.positions[rim..];
    let limit = u32::MAX as usize - 1;
    if base + new.len() > limit {
        return Err(Error::TooLarge { what: "vertices", count: base + new.len(), limit });
    }
    out.vertices.extend(new.iter().map(|p| p.to_array()));
    out.vertex_hole.resize(out.vertices.len(), hole as u32);
    let before = out.origins.len();
    match &fill.story {
        Some(story) => out.origins.extend_from_slice(&story.origins),
        None => out.origins.resize(out.vertices.len(), Origin::NOWHERE),
    }
    let colours = fill.story.as_ref().map_or(&[][..], |s| &s.colours);
    if !colours.is_empty() || !out.colour_origins.is_empty() {
        // As the shape's, up to here.
        let (colours, all) = (colours.to_vec(), &out.origins);
        out.colour_origins.extend_from_slice(&all[out.colour_origins.len()..before]);
        out.colour_origins.extend(if colours.is_empty() {
            all[before..].to_vec()
        } else {
            colours
        });
    }
    let index = |v: u32| match (v as usize).checked_sub(rim) {
        Some(i) => (base + i) as u32,
        None => near.vertices[fill.outline.vertices[v as usize] as usize],
    };
    out.faces.extend(fill.patch.triangles.iter().map(|t| t.map(index)));
    let seams = fill.story.iter_mut().flat_map(|s| &mut s.seams);
    seams.for_each(|s| s.vertex = index(s.vertex));
    let ring = fill.story.iter_mut().flat_map(|s| &mut s.ring);
    ring.for_each(|s| s.vertex = near.vertices[s.vertex as usize]);
    out.face_hole.resize(out.faces.len(), hole as u32);
    Ok(new.len())
}

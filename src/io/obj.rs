//! Wavefront OBJ. The lines stay as they are; new `v` and `f` lines go to the end of the file.

use super::attributes::{Blend, Column, Patch};
use super::edit::Edit;
use super::error::{Fault, IoError, Parsed};
use super::obj_corners::Corners;
use super::obj_texture::Sourced;
use super::polygon::{Triangles, MAX_CORNERS};
use super::text::{coordinate, fits_single, line_end, parse, push_real, show, words, Line, Lines};
use super::{Mesh, Positions};
use crate::result::Completion;
use std::collections::BTreeSet;

/// The statements, `v` and `f` lines joined with those that continue them after a backslash.
pub(super) struct Statements<'a>(Lines<'a>);

impl<'a> Iterator for Statements<'a> {
    type Item = Line<'a>;

    fn next(&mut self) -> Option<Line<'a>> {
        let first = self.0.next()?;
        let mut last = first;
        // Only there: a comment or a file name may end with a backslash of its own.
        if matches!(keyword(first.text), b"v" | b"f") {
            while last.text.trim_ascii_end().ends_with(b"\\") {
                let Some(line) = self.0.next() else { break };
                last = line;
            }
        }
        let text = &self.0.bytes[first.start..last.start + last.text.len()];
        Some(Line { text, end: last.end, ..first })
    }
}

pub(super) fn statements(bytes: &[u8]) -> Statements<'_> {
    Statements(Lines::new(bytes))
}

pub(super) fn keyword(text: &[u8]) -> &[u8] {
    words(text).next().unwrap_or_default()
}

/// The words after the keyword, without comments and the backslashes of continued lines.
pub(super) fn arguments(text: &[u8]) -> impl Iterator<Item = &[u8]> {
    words(text).skip(1).filter(|&w| w != b"\\").take_while(|w| !w.starts_with(b"#"))
}

pub(super) fn read(bytes: &[u8]) -> Parsed<Mesh> {
    let (mut points, mut single) = (Vec::new(), true);
    let mut triangles = Triangles::default();
    // The greatest vertex number and its line: faces may come before their vertices.
    let mut greatest = (0, 0);
    let mut corners = Vec::new();
    let mut line_count = 0;
    for line in statements(bytes) {
        line_count = line.number;
        match keyword(line.text) {
            b"v" => points.push(read_point(&line, points.len(), &mut single)?),
            b"f" => {
                read_corners(&line, points.len(), &mut corners)?;
                triangles.push(&corners);
                let top = corners.iter().copied().max().unwrap_or(0);
                if top >= greatest.0 {
                    greatest = (top, line.number);
                }
            }
            _ => {}
        }
    }
    if greatest.1 > 0 && greatest.0 as usize >= points.len() {
        let number = u64::from(greatest.0) + 1;
        let reason = format!("the face names vertex {number}, but there are only {}", points.len());
        return Fault::line(greatest.1, reason);
    }
    if points.is_empty() {
        return Fault::line(line_count, "there is no \"v\" line: this is not an OBJ mesh");
    }
    let mut mesh = Mesh { positions: Positions::from_text(points, single), triangles };
    mesh.cut_polygons(bytes);
    Ok(mesh)
}

fn read_point(line: &Line<'_>, index: usize, single: &mut bool) -> Parsed<[f64; 3]> {
    if index >= u32::MAX as usize {
        return Fault::line(line.number, "more vertices than 32-bit indices can name");
    }
    let mut numbers = arguments(line.text);
    let mut p = [0.0; 3];
    for x in &mut p {
        let Some(word) = numbers.next() else {
            return Fault::line(
                line.number,
                format!("vertex {} has fewer than 3 numbers", index + 1),
            );
        };
        *x = coordinate(word, line.number)?;
        *single = *single && fits_single(word, *x);
    }
    Ok(p)
}

/// The vertices of an `f` line, from 0. `so_far` vertices have been read: negative numbers count
/// back from the last.
fn read_corners(line: &Line<'_>, so_far: usize, corners: &mut Vec<u32>) -> Parsed<()> {
    corners.clear();
    for word in arguments(line.text) {
        let number = word.split(|&c| c == b'/').next().unwrap_or_default();
        let index = match parse::<i64>(number) {
            Some(n) if n > 0 => n - 1,
            Some(n) if n < 0 => so_far as i64 + n,
            _ => {
                let reason = format!("{} is not a vertex number (they begin with 1)", show(word));
                return Fault::line(line.number, reason);
            }
        };
        match u32::try_from(index) {
            Ok(v) => corners.push(v),
            Err(_) => {
                let reason = format!("{} names no vertex: {so_far} were read so far", show(word));
                return Fault::line(line.number, reason);
            }
        }
    }
    if !(3..=MAX_CORNERS).contains(&corners.len()) {
        let n = corners.len();
        let reason = format!("a face with {n} corners; from 3 to {MAX_CORNERS} are possible");
        return Fault::line(line.number, reason);
    }
    Ok(())
}

pub(super) fn each_face(bytes: &[u8], mut face: impl FnMut(&[u32])) -> Parsed<()> {
    let (mut so_far, mut corners) = (0, Vec::new());
    for line in statements(bytes) {
        match keyword(line.text) {
            b"v" => so_far += 1,
            b"f" => {
                read_corners(&line, so_far, &mut corners)?;
                face(&corners);
            }
            _ => {}
        }
    }
    Ok(())
}

/// The numbers after x, y and z of each vertex: a colour if there are 3 or more (one would be a
/// weight).
fn extras(bytes: &[u8]) -> impl Iterator<Item = Vec<f64>> + '_ {
    statements(bytes).filter(|l| keyword(l.text) == b"v").map(|l| {
        let numbers: Vec<f64> = arguments(l.text).skip(3).filter_map(parse).collect();
        if numbers.len() < 3 {
            Vec::new()
        } else {
            numbers
        }
    })
}

pub(super) fn vertex_colours(bytes: &[u8]) -> Option<Vec<[u8; 4]>> {
    let all: Vec<Vec<f64>> = extras(bytes).collect();
    if all.iter().all(Vec::is_empty) {
        return None;
    }
    // Some programs write 0 to 255, most 0 to 1.
    let full = if all.iter().flatten().any(|&x| x > 1.0) { 1.0 } else { 255.0 };
    let channel = |x: Option<&f64>| x.map_or(255, |x| (x * full).round().clamp(0.0, 255.0) as u8);
    Some(all.iter().map(|e| [0, 1, 2, 3].map(|i| channel(e.get(i)))).collect())
}

/// What another format would not keep.
pub(super) fn extra_statements(bytes: &[u8]) -> Vec<String> {
    const NAMES: [(&[u8], &str); 11] = [
        (b"vt", "texture coordinates"),
        (b"vn", "normals"),
        (b"vp", "parameter space points"),
        (b"g", "groups"),
        (b"o", "objects"),
        (b"s", "smoothing groups"),
        (b"usemtl", "materials"),
        (b"mtllib", "material libraries"),
        (b"l", "lines"),
        (b"p", "points"),
        (b"#", "comments"),
    ];
    let mut found = BTreeSet::new();
    for line in statements(bytes) {
        let word = keyword(line.text);
        let known =
            NAMES.iter().position(|n| n.0 == word || (n.0 == b"#" && word.starts_with(b"#")));
        found.extend(known);
    }
    found.into_iter().map(|i| NAMES[i].1.into()).collect()
}

/// The edit that appends the fill.
pub(super) fn append(
    bytes: &[u8],
    mesh: &Mesh,
    completion: &Completion,
    patch: &Patch<'_>,
) -> Result<Vec<Edit>, IoError> {
    let line_end = line_end(bytes);
    let mut with = Vec::new();
    if bytes.trim_ascii_end().ends_with(b"\\") {
        // The empty line ends what the backslash continues.
        with.extend_from_slice(line_end);
        with.extend_from_slice(line_end);
    } else if !matches!(bytes.last(), Some(b'\n' | b'\r')) {
        with.extend_from_slice(line_end);
    }
    write_points(&mut with, bytes, mesh, completion, patch, line_end);
    let vertices = mesh.positions.view(bytes);
    let sourced = Sourced::new(completion, vertices, mesh.triangles.faces.len());
    let corners =
        Corners::write_values(&mut with, bytes, mesh, completion, patch, &sourced, line_end);
    write_faces(&mut with, bytes, mesh, patch, (&sourced, &corners), line_end);
    Ok(vec![Edit { at: bytes.len()..bytes.len(), with }])
}

fn write_points(
    out: &mut Vec<u8>,
    bytes: &[u8],
    mesh: &Mesh,
    completion: &Completion,
    patch: &Patch<'_>,
    line_end: &[u8],
) {
    let single = mesh.positions.view(bytes).is_single();
    let mut known = patch.known().iter().peekable();
    let rows: Vec<Vec<f64>> = extras(bytes)
        .enumerate()
        .filter(|(i, _)| known.next_if(|&&v| v as usize == *i).is_some())
        .map(|(_, e)| e)
        .collect();
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0).min(4);
    // A vertex without a colour is white.
    let in_bytes = rows.iter().flatten().any(|&x| x > 1.0);
    let white = if in_bytes { 255.0 } else { 1.0 };
    let values: Vec<f64> = rows
        .iter()
        .flat_map(|row| (0..columns).map(|c| row.get(c).copied().unwrap_or(white)))
        .collect();
    let full = if in_bytes { 255.0 } else { 1.0 };
    let column = |c: usize| Column { blend: Blend::Copied, colour: Some((c, full)) };
    let carried = patch.complete(&values, &(0..columns).map(column).collect::<Vec<_>>());
    for (i, p) in completion.vertices.iter().enumerate() {
        out.push(b'v');
        for &x in p {
            out.push(b' ');
            push_real(out, x, single);
        }
        for &x in &carried[i * columns..(i + 1) * columns] {
            out.push(b' ');
            push_real(out, if in_bytes { x.round() } else { x }, true);
        }
        out.extend_from_slice(line_end);
    }
}

/// The lines in force at a face: object, group, material, smoothing.
type State<'a> = [&'a [u8]; 4];
const STATE_WORDS: [&[u8]; 4] = [b"o", b"g", b"usemtl", b"s"];
const MATERIAL: usize = 2;

/// The states at the given faces (sorted), and at the end of the file.
fn states<'a>(bytes: &'a [u8], faces: &[usize]) -> (Vec<State<'a>>, State<'a>) {
    let mut state: State<'a> = [&[]; 4];
    let (mut found, mut face) = (Vec::with_capacity(faces.len()), 0);
    for line in statements(bytes) {
        let word = keyword(line.text);
        if word == b"f" {
            if faces.get(found.len()) == Some(&face) {
                found.push(state);
            }
            face += 1;
        } else if let Some(k) = STATE_WORDS.iter().position(|w| *w == word) {
            state[k] = line.text.trim_ascii();
        }
    }
    (found, state)
}

fn write_faces(
    out: &mut Vec<u8>,
    bytes: &[u8],
    mesh: &Mesh,
    patch: &Patch<'_>,
    (sourced, corners): (&Sourced, &Corners<'_>),
    line_end: &[u8],
) {
    let templates = patch.templates(mesh.triangles.view());
    let face_of = |t: Option<u32>| t.map(|t| mesh.triangles.face_of(t as usize));
    let faces = &patch.completion().faces;
    // The material is the source's, the rest the neighbours'.
    let beside: Vec<Option<usize>> = templates.iter().map(|t| face_of(*t)).collect();
    let copied: Vec<Option<usize>> =
        (0..faces.len()).map(|f| face_of(sourced.triangle(f))).collect();
    let mut wanted: Vec<usize> = beside.iter().chain(&copied).flatten().copied().collect();
    wanted.sort_unstable();
    wanted.dedup();
    let (found, mut current) = states(bytes, &wanted);
    let state_of = |face: Option<usize>| {
        let at = face.and_then(|f| wanted.binary_search(&f).ok());
        at.and_then(|i| found.get(i)).copied()
    };
    let mut told = false;
    for f in 0..faces.len() {
        let mut state = state_of(beside[f]).unwrap_or(current);
        if let Some(source) = state_of(copied[f]) {
            state[MATERIAL] = source[MATERIAL];
        }
        for (now, then) in current.iter_mut().zip(state) {
            // What was not set at the template cannot be unset.
            if *now != then && !then.is_empty() {
                out.extend_from_slice(then);
                out.extend_from_slice(line_end);
                *now = then;
            }
        }
        if told != corners.lacks_source(f) {
            told = !told;
            let said: &[u8] = if told { b"# without a source" } else { b"# with a source" };
            out.extend_from_slice(said);
            out.extend_from_slice(line_end);
        }
        out.push(b'f');
        (0..3).for_each(|k| corners.write(out, f, k));
        out.extend_from_slice(line_end);
    }
}

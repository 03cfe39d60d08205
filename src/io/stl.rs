//! STL, ascii and binary. The file is a heap of triangles; for the analysis corners in the same
//! place are one vertex, in the order they first come up.

use super::attributes::{face_normal, Patch};
use super::edit::Edit;
use super::error::{Fault, IoError, Parsed};
use super::polygon::Triangles;
use super::text::{coordinate, is_blank, line_end, push_real, show, words, Line, Lines};
use super::{Mesh, Positions};
use crate::result::Completion;
use std::collections::HashMap;

#[derive(Debug, Clone)]
pub(super) struct Layout {
    kind: Kind,
    /// The facet of each triangle, if some facets were left out: those with two corners in the
    /// same place, which have no area and join nothing.
    facets: Option<Vec<u32>>,
}

#[derive(Debug, Clone)]
enum Kind {
    Binary,
    /// Where the last `endsolid` line begins.
    Ascii {
        end: usize,
    },
}

/// A binary file's head (80 bytes of anything, a count) and one facet: a normal, three corners
/// (twelve f32) and two bytes of attribute.
const HEAD: usize = 84;
const FACET: usize = 50;

type Corners = [[f32; 3]; 3];

pub(super) fn read(bytes: &[u8]) -> Parsed<(Layout, Mesh)> {
    let count = bytes[..bytes.len().min(HEAD)].last_chunk::<4>().filter(|_| bytes.len() >= HEAD);
    let count = count.map(|raw| u32::from_le_bytes(*raw) as usize);
    let needed = count.map(|n| HEAD as u64 + FACET as u64 * n as u64);
    // Some programs begin binary files with "solid", too: the length settles it.
    if needed == Some(bytes.len() as u64) {
        let facets = bytes[HEAD..].chunks_exact(FACET);
        let (facets, mesh) = weld(facets.map(|f| Ok(corners_of(f))))?;
        return Ok((Layout { kind: Kind::Binary, facets }, mesh));
    }
    let is_text = !bytes[..bytes.len().min(HEAD)].contains(&0);
    if is_text
        && bytes.trim_ascii_start().get(..5).is_some_and(|w| w.eq_ignore_ascii_case(b"solid"))
    {
        let mut text = AsciiFacets::new(bytes);
        let (facets, mesh) = weld(&mut text)?;
        return Ok((Layout { kind: Kind::Ascii { end: text.end }, facets }, mesh));
    }
    match (count, needed) {
        (Some(n), Some(needed)) => Fault::byte(
            HEAD - 4,
            format!(
                "{n} triangles take {needed} bytes, but the file has {}; it is cut off, or the \
                 count is wrong",
                bytes.len()
            ),
        ),
        _ => Fault::byte(bytes.len(), "the file ends before the 84 bytes that it begins with"),
    }
}

fn corners_of(facet: &[u8]) -> Corners {
    let number = |i: usize| {
        let raw = facet[12 + 4 * i..].first_chunk().copied().unwrap_or_default();
        f32::from_le_bytes(raw)
    };
    [[0, 1, 2], [3, 4, 5], [6, 7, 8]].map(|c| c.map(number))
}

/// Makes one vertex of all corners with the same bits (0 and -0 are the same place). Returns the
/// facets that are left, unless all are.
fn weld(facets: impl Iterator<Item = Parsed<Corners>>) -> Parsed<(Option<Vec<u32>>, Mesh)> {
    let mut vertices = Vec::new();
    let mut seen: HashMap<[u32; 3], u32> = HashMap::new();
    let mut triangles = Triangles::default();
    let mut left_out = false;
    let mut kept = Vec::new();
    for (i, corners) in facets.enumerate() {
        let face = corners?.map(|p| {
            let bits = p.map(|x| if x == 0.0 { 0 } else { x.to_bits() });
            *seen.entry(bits).or_insert_with(|| {
                vertices.push(p);
                vertices.len() as u32 - 1
            })
        });
        if face[0] == face[1] || face[1] == face[2] || face[2] == face[0] {
            if !left_out {
                (left_out, kept) = (true, (0..i as u32).collect());
            }
            continue;
        }
        triangles.push(&face);
        if left_out {
            kept.push(i as u32);
        }
    }
    Ok((left_out.then_some(kept), Mesh { positions: Positions::Single(vertices), triangles }))
}

/// The facets of an ascii file, which may hold several solids.
struct AsciiFacets<'a> {
    lines: Lines<'a>,
    /// Where the last `endsolid` begins.
    end: usize,
    inside: bool,
    done: bool,
}

impl<'a> AsciiFacets<'a> {
    fn new(bytes: &'a [u8]) -> Self {
        Self { lines: Lines::new(bytes), end: 0, inside: false, done: false }
    }

    fn line(&mut self) -> Option<Line<'a>> {
        self.lines.by_ref().find(|l| !is_blank(l.text))
    }

    fn cut_off<T>(&self, wanted: &str) -> Parsed<T> {
        let reason = format!("the file ends where \"{wanted}\" should stand; it is cut off");
        Fault::line(self.lines.number + 1, reason)
    }

    /// Reads a line that begins with `wanted`, and returns its other words.
    fn expect(&mut self, wanted: &str) -> Parsed<(usize, Vec<&'a [u8]>)> {
        let Some(line) = self.line() else { return self.cut_off(wanted) };
        let mut rest = words(line.text);
        let first = rest.next().unwrap_or_default();
        if !first.eq_ignore_ascii_case(wanted.as_bytes()) {
            let reason = format!("{} stands where \"{wanted}\" should", show(first));
            return Fault::line(line.number, reason);
        }
        Ok((line.number, rest.take(8).collect()))
    }

    fn read(&mut self) -> Parsed<Option<Corners>> {
        loop {
            let line = match self.line() {
                Some(line) => line,
                None if self.inside => return self.cut_off("endsolid"),
                None => return Ok(None),
            };
            let first = words(line.text).next().unwrap_or_default().to_ascii_lowercase();
            match (self.inside, first.as_slice()) {
                (false, b"solid") => self.inside = true,
                (true, b"endsolid") => (self.inside, self.end) = (false, line.start),
                (true, b"facet") => return self.read_facet().map(Some),
                _ => {
                    let reason = format!("{} has no place here", show(&first));
                    return Fault::line(line.number, reason);
                }
            }
        }
    }

    fn read_facet(&mut self) -> Parsed<Corners> {
        self.expect("outer")?;
        let mut corners = [[0.0; 3]; 3];
        for corner in &mut corners {
            let (line, numbers) = self.expect("vertex")?;
            let [x, y, z] = numbers[..] else {
                return Fault::line(line, format!("a vertex with {} numbers", numbers.len()));
            };
            for (to, word) in corner.iter_mut().zip([x, y, z]) {
                *to = coordinate(word, line)? as f32;
                if !to.is_finite() {
                    let reason = format!("the coordinate {} is too large", show(word));
                    return Fault::line(line, reason);
                }
            }
        }
        self.expect("endloop")?;
        self.expect("endfacet")?;
        Ok(corners)
    }
}

impl Iterator for AsciiFacets<'_> {
    type Item = Parsed<Corners>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.done {
            return None;
        }
        let read = self.read();
        self.done = !matches!(read, Ok(Some(_)));
        read.transpose()
    }
}

/// The edits that append the fill: facets at the end of the (last) solid.
pub(super) fn append(
    layout: &Layout,
    bytes: &[u8],
    mesh: &Mesh,
    completion: &Completion,
) -> Result<Vec<Edit>, IoError> {
    let vertices = mesh.positions.view(bytes);
    let position = |v: u32| match (v as usize).checked_sub(completion.input_vertex_count) {
        Some(new) => completion.vertices[new].map(|x| x as f32),
        None => vertices.get(v as usize).map(|x| x as f32),
    };
    let facets = completion.faces.iter().map(|f| {
        let p = f.map(position);
        let normal = face_normal(p.map(|p| p.map(f64::from))).map(|x| x as f32);
        [normal, p[0], p[1], p[2]]
    });
    match layout.kind {
        Kind::Binary => {
            let total = (bytes.len() - HEAD) / FACET + completion.faces.len();
            let Ok(total) = u32::try_from(total) else {
                let what = format!("{total} triangles are more than its count can hold");
                return Err(IoError::Unsupported { format: super::Format::Stl, what });
            };
            let templates = Patch::new(completion).templates(mesh.triangles.view());
            let mut rows = Vec::with_capacity(completion.faces.len() * FACET);
            for (facet, template) in facets.zip(templates) {
                rows.extend(facet.iter().flatten().flat_map(|x| x.to_le_bytes()));
                rows.extend_from_slice(&attribute(layout, bytes, template));
            }
            let end = bytes.len();
            let count = Edit { at: HEAD - 4..HEAD, with: total.to_le_bytes().to_vec() };
            Ok(vec![count, Edit { at: end..end, with: rows }])
        }
        Kind::Ascii { end } => {
            let mut with = Vec::new();
            let line_end = line_end(bytes);
            for facet in facets {
                write_facet(&mut with, &facet, line_end);
            }
            Ok(vec![Edit { at: end..end, with }])
        }
    }
}

/// The attribute bytes (in some programs a colour) of the facet that a new one takes after.
fn attribute(layout: &Layout, bytes: &[u8], template: Option<u32>) -> [u8; 2] {
    let facet = template.map(|t| layout.facets.as_ref().map_or(t, |f| f[t as usize]) as usize);
    let at = facet.map(|f| HEAD + FACET * f + FACET - 2);
    at.and_then(|at| bytes[at..].first_chunk().copied()).unwrap_or_default()
}

fn write_facet(out: &mut Vec<u8>, facet: &[[f32; 3]; 4], line_end: &[u8]) {
    let mut line = |words: &str, numbers: &[f32]| {
        out.extend_from_slice(words.as_bytes());
        for &x in numbers {
            out.push(b' ');
            push_real(out, x.into(), true);
        }
        out.extend_from_slice(line_end);
    };
    line("  facet normal", &facet[0]);
    line("    outer loop", &[]);
    for corner in &facet[1..] {
        line("      vertex", corner);
    }
    line("    endloop", &[]);
    line("  endfacet", &[]);
}

/// A binary file of these facets.
pub(super) fn from_triangles(count: u32, corners: impl Iterator<Item = Corners>) -> Vec<u8> {
    let mut bytes = vec![b' '; HEAD - 4];
    bytes.extend_from_slice(&count.to_le_bytes());
    for p in corners {
        let normal = face_normal(p.map(|p| p.map(f64::from))).map(|x| x as f32);
        let numbers = [normal, p[0], p[1], p[2]];
        bytes.extend(numbers.iter().flatten().flat_map(|x| x.to_le_bytes()));
        bytes.extend_from_slice(&[0; 2]);
    }
    bytes
}

impl Layout {
    /// What another format would not keep.
    pub fn extras(&self, bytes: &[u8]) -> Vec<String> {
        match self.kind {
            Kind::Ascii { .. } => vec!["the names of solids".into()],
            Kind::Binary => {
                let mut facets = bytes[HEAD..].chunks_exact(FACET);
                let attributes = facets.any(|f| f[FACET - 2..] != [0; 2]);
                let header = bytes[..HEAD - 4].iter().any(|&c| c != 0 && c != b' ');
                let names = [(header, "the header"), (attributes, "the facets' attribute bytes")];
                names.iter().filter(|n| n.0).map(|n| n.1.into()).collect()
            }
        }
    }
}

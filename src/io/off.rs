//! OFF of Geomview, with colours (COFF) and normals (NOFF): further numbers on a line are kept.

use super::attributes::{Blend, Column, Patch};
use super::edit::Edit;
use super::error::{Fault, IoError, Parsed};
use super::polygon::{Triangles, MAX_CORNERS};
use super::text::{
    coordinate, fits_single, is_blank, line_end, parse, push_real, show, words, Line, Lines,
};
use super::{Mesh, Positions};
use crate::result::Completion;
use std::ops::Range;

#[derive(Debug, Clone)]
pub(super) struct Layout {
    has_normals: bool,
    has_colours: bool,
    /// Counts of vertices and faces, and where their digits stand.
    counts: [usize; 2],
    counts_at: [Range<usize>; 2],
    /// Where the first vertex line and the first face line may begin.
    starts: [usize; 2],
    /// The byte after the last vertex line and the last face line.
    ends: [usize; 2],
}

/// The lines that say something, comments cut off.
#[derive(Clone)]
struct Rows<'a>(Lines<'a>);

impl<'a> Iterator for Rows<'a> {
    type Item = Line<'a>;

    fn next(&mut self) -> Option<Line<'a>> {
        self.0.by_ref().find_map(|line| {
            let comment = memchr::memchr(b'#', line.text).unwrap_or(line.text.len());
            let text = &line.text[..comment];
            (!is_blank(text)).then_some(Line { text, ..line })
        })
    }
}

impl Rows<'_> {
    fn next_row(&mut self, what: &str, index: usize, count: usize) -> Parsed<Line<'_>> {
        let number = self.0.number;
        match self.next() {
            Some(line) => Ok(line),
            None => Fault::line(
                number + 1,
                format!("the file ends at {what} {index} of {count} (counted from 0); it is cut off, or a count is wrong"),
            ),
        }
    }
}

pub(super) fn read(bytes: &[u8]) -> Parsed<(Layout, Mesh)> {
    let mut rows = Rows(Lines::new(bytes));
    let mut layout = read_head(bytes, &mut rows)?;
    let [vertex_count, face_count] = layout.counts;
    let left = bytes.len() - rows.0.at + 1;
    // The shortest lines are "0 0 0" and "3 0 0 0".
    if vertex_count > left / 6 || face_count > left / 8 || u32::try_from(vertex_count).is_err() {
        let reason = format!(
            "{vertex_count} vertices and {face_count} faces cannot be in the {} bytes that are \
             left; the file is cut off, or the counts are wrong",
            left - 1
        );
        return Fault::line(rows.0.number, reason);
    }
    layout.starts[0] = rows.0.at;
    layout.ends[0] = rows.0.at;
    let mut points = Vec::with_capacity(vertex_count);
    let mut single = true;
    for i in 0..vertex_count {
        let line = rows.next_row("vertex", i, vertex_count)?;
        let mut numbers = words(line.text);
        let mut p = [0.0; 3];
        for x in &mut p {
            let Some(word) = numbers.next() else {
                return Fault::line(line.number, format!("vertex {i} has fewer than 3 numbers"));
            };
            *x = coordinate(word, line.number)?;
            single = single && fits_single(word, *x);
        }
        points.push(p);
        layout.ends[0] = line.end;
    }
    layout.starts[1] = layout.ends[0];
    layout.ends[1] = layout.ends[0];
    let mut triangles = Triangles::default();
    layout.ends[1] = read_faces(&mut rows, layout.counts, layout.ends[1], |c| triangles.push(c))?;
    if let Some(line) = rows.next() {
        return Fault::line(line.number, "more lines follow the last face; a count is too small");
    }
    let mut mesh = Mesh { positions: Positions::from_text(points, single), triangles };
    mesh.cut_polygons(bytes);
    Ok((layout, mesh))
}

/// The keyword, which says what a vertex line holds, and the counts.
fn read_head(bytes: &[u8], rows: &mut Rows<'_>) -> Parsed<Layout> {
    let Some(first) =
        rows.0.find(|l| !is_blank(l.text) && !l.text.trim_ascii_start().starts_with(b"#"))
    else {
        return Fault::line(1, "the file is empty");
    };
    let text = first.text.split(|&c| c == b'#').next().unwrap_or_default();
    let mut rest = words(text);
    let keyword = rest.next().unwrap_or_default();
    let Some(kind) = keyword.strip_suffix(b"OFF") else {
        return Fault::line(first.number, "the file does not begin with the word \"OFF\"");
    };
    if kind.iter().any(|c| !b"STCN".contains(c)) {
        let reason = format!("{} has points that are not in three dimensions", show(keyword));
        return Fault::line(first.number, reason);
    }
    let mut number = first.number;
    let mut counts: Vec<&[u8]> = rest.collect();
    if counts.is_empty() {
        let line = rows.next();
        number = line.map_or(number + 1, |l| l.number);
        counts = line.map(|l| words(l.text).collect()).unwrap_or_default();
    }
    if counts.first() == Some(&&b"BINARY"[..]) {
        return Fault::line(number, "binary OFF is not supported; convert it to text or to PLY");
    }
    let [Some(v), Some(f)] = [0, 1].map(|i| counts.get(i).copied()) else {
        return Fault::line(number, "the counts of vertices and faces are missing");
    };
    let place = |word: &[u8]| {
        let start = word.as_ptr() as usize - bytes.as_ptr() as usize;
        start..start + word.len()
    };
    let count = |word: &[u8]| match parse::<usize>(word) {
        Some(n) => Ok(n),
        None => {
            Fault::line(number, format!("the count {} is not a whole number from 0", show(word)))
        }
    };
    Ok(Layout {
        has_normals: kind.contains(&b'N'),
        has_colours: kind.contains(&b'C'),
        counts: [count(v)?, count(f)?],
        counts_at: [place(v), place(f)],
        starts: [0; 2],
        ends: [0; 2],
    })
}

/// Reads the face lines; returns the byte after the last.
fn read_faces(
    rows: &mut Rows<'_>,
    [vertex_count, face_count]: [usize; 2],
    mut end: usize,
    mut face: impl FnMut(&[u32]),
) -> Parsed<usize> {
    let mut corners = Vec::new();
    for i in 0..face_count {
        let line = rows.next_row("face", i, face_count)?;
        let mut numbers = words(line.text);
        let word = numbers.next().unwrap_or_default();
        let n = match parse::<usize>(word) {
            Some(n) if (3..=MAX_CORNERS).contains(&n) => n,
            _ => {
                let reason = format!(
                    "face {i} has {} corners; from 3 to {MAX_CORNERS} are possible",
                    show(word)
                );
                return Fault::line(line.number, reason);
            }
        };
        corners.clear();
        for word in numbers.take(n) {
            match parse::<u32>(word).filter(|&v| (v as usize) < vertex_count) {
                Some(v) => corners.push(v),
                None => {
                    let reason = format!(
                        "face {i} names vertex {}, but there are only {vertex_count}",
                        show(word)
                    );
                    return Fault::line(line.number, reason);
                }
            }
        }
        if corners.len() < n {
            return Fault::line(line.number, format!("face {i} has fewer than its {n} corners"));
        }
        face(&corners);
        end = line.end;
    }
    Ok(end)
}

impl Layout {
    fn rows<'a>(&self, bytes: &'a [u8], part: usize) -> Rows<'a> {
        Rows(Lines { bytes, at: self.starts[part], number: 0 })
    }

    pub fn each_face(&self, bytes: &[u8], face: impl FnMut(&[u32])) -> Parsed<()> {
        read_faces(&mut self.rows(bytes, 1), self.counts, 0, face).map(|_| ())
    }

    /// The numbers after x, y and z of each vertex, as they are written.
    fn vertex_extras<'a>(&self, bytes: &'a [u8]) -> impl Iterator<Item = Vec<&'a [u8]>> {
        self.rows(bytes, 0).take(self.counts[0]).map(|l| words(l.text).skip(3).collect())
    }

    pub fn vertex_colours(&self, bytes: &[u8]) -> Option<Vec<[u8; 4]>> {
        if !self.has_colours {
            return None;
        }
        let skip = if self.has_normals { 3 } else { 0 };
        let colour = |extras: Vec<&[u8]>| {
            // Whole numbers go to 255, others to 1.
            let channels: Vec<&[u8]> = extras.into_iter().skip(skip).take(4).collect();
            let full = if channels.iter().all(|w| is_whole(w)) { 1.0 } else { 255.0 };
            let channel = |i: usize| {
                let x = channels.get(i).and_then(|w| parse::<f64>(w));
                x.map_or(255, |x| (x * full).round().clamp(0.0, 255.0) as u8)
            };
            [0, 1, 2, 3].map(channel)
        };
        Some(self.vertex_extras(bytes).map(colour).collect())
    }

    /// What another format would not keep.
    pub fn extras(&self, bytes: &[u8]) -> Vec<String> {
        let more = |w: &Line<'_>| {
            let n = words(w.text).next().and_then(parse::<usize>).unwrap_or(0);
            words(w.text).count() > n.saturating_add(1)
        };
        let faces = self.rows(bytes, 1).take(self.counts[1]).any(|l| more(&l));
        let names = [
            (self.has_normals, "the vertices' normals"),
            (faces, "the faces' colours"),
            (memchr::memchr(b'#', bytes).is_some(), "comments"),
        ];
        names.iter().filter(|n| n.0).map(|n| n.1.into()).collect()
    }
}

fn is_whole(word: &[u8]) -> bool {
    word.iter().all(u8::is_ascii_digit)
}

/// The edits that append the fill.
pub(super) fn append(
    layout: &Layout,
    bytes: &[u8],
    mesh: &Mesh,
    completion: &Completion,
    patch: &Patch<'_>,
) -> Result<Vec<Edit>, IoError> {
    let line_end = line_end(bytes);
    let new = [
        write_vertices(layout, bytes, mesh, completion, patch, line_end),
        write_faces(layout, bytes, mesh, completion, patch, line_end),
    ];
    let added = [completion.vertices.len(), completion.faces.len()];
    let mut edits = Vec::new();
    for (part, with) in new.into_iter().enumerate() {
        let count = (layout.counts[part] + added[part]).to_string();
        // "007" may be longer than what replaces it; zeros in front make up for it.
        let at = layout.counts_at[part].clone();
        let with_count = format!("{count:0>width$}", width = at.len()).into_bytes();
        edits.push(Edit { at, with: with_count });
        let end = layout.ends[part];
        let open = !with.is_empty() && !matches!(bytes[end - 1], b'\n' | b'\r');
        // The file's last line may lack its end; both parts may come to stand there.
        let gap = if open && (part == 0 || edits[1].with.is_empty() || layout.ends[0] < end) {
            line_end.to_vec()
        } else {
            Vec::new()
        };
        edits.push(Edit { at: end..end, with: [gap, with].concat() });
    }
    Ok(edits)
}

fn write_vertices(
    layout: &Layout,
    bytes: &[u8],
    mesh: &Mesh,
    completion: &Completion,
    patch: &Patch<'_>,
    line_end: &[u8],
) -> Vec<u8> {
    let view = mesh.positions.view(bytes);
    let known = known_extras(layout, bytes, patch);
    let columns = known.iter().map(Vec::len).min().unwrap_or(0);
    let number = |w: &[u8]| parse::<f64>(w).unwrap_or(f64::NAN);
    let values: Vec<f64> =
        known.iter().flat_map(|row| row[..columns].iter().map(|w| number(w))).collect();
    let whole: Vec<bool> = (0..columns).map(|c| known.iter().all(|row| is_whole(row[c]))).collect();
    // A colour stands last; it is in bytes or from 0 to 1.
    let first = if layout.has_normals { 3.min(columns) } else { 0 };
    let full = if whole[first..].iter().all(|w| *w) { 255.0 } else { 1.0 };
    let colour = |c: usize| c.checked_sub(first).filter(|&k| k < 4).map(|k| (k, full));
    let column = |c: usize| Column { blend: Blend::Copied, colour: colour(c) };
    let carried = patch.complete(&values, &(0..columns).map(column).collect::<Vec<_>>());
    let normals = if layout.has_normals && columns >= 3 {
        let rim_normals: Vec<_> =
            patch.rim_of(&values, columns).map(|r| [r[0], r[1], r[2]]).collect();
        patch.normals(view, &rim_normals)
    } else {
        Vec::new()
    };
    let mut out = Vec::new();
    for (i, p) in completion.vertices.iter().enumerate() {
        for (axis, &x) in p.iter().enumerate() {
            if axis > 0 {
                out.push(b' ');
            }
            push_real(&mut out, x, view.is_single());
        }
        for c in 0..columns {
            out.push(b' ');
            match normals.get(i) {
                Some(normal) if c < 3 => push_real(&mut out, normal[c], true),
                _ if whole[c] => push_real(&mut out, carried[i * columns + c].round(), false),
                _ => push_real(&mut out, carried[i * columns + c], true),
            }
        }
        out.extend_from_slice(line_end);
    }
    out
}

fn known_extras<'a>(layout: &Layout, bytes: &'a [u8], patch: &Patch<'_>) -> Vec<Vec<&'a [u8]>> {
    let mut known = patch.known().iter().peekable();
    let numbered = layout.vertex_extras(bytes).enumerate();
    numbered
        .filter(|(i, _)| known.next_if(|&&v| v as usize == *i).is_some())
        .map(|(_, e)| e)
        .collect()
}

fn write_faces(
    layout: &Layout,
    bytes: &[u8],
    mesh: &Mesh,
    completion: &Completion,
    patch: &Patch<'_>,
    line_end: &[u8],
) -> Vec<u8> {
    let lines: Vec<&[u8]> = layout.rows(bytes, 1).take(layout.counts[1]).map(|l| l.text).collect();
    let templates = patch.templates(mesh.triangles.view());
    let mut out = Vec::new();
    for (face, template) in completion.faces.iter().zip(templates) {
        out.extend(format!("3 {} {} {}", face[0], face[1], face[2]).into_bytes());
        // The numbers after the corners are a colour.
        let text = template.and_then(|t| lines.get(mesh.triangles.face_of(t as usize)));
        let mut numbers = words(text.copied().unwrap_or_default());
        let corners = numbers.next().and_then(parse::<usize>).unwrap_or(0);
        for word in numbers.skip(corners) {
            out.push(b' ');
            out.extend_from_slice(word);
        }
        out.extend_from_slice(line_end);
    }
    out
}

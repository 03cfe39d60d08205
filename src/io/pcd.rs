//! PCD of the Point Cloud Library, version 0.7: ascii, binary, and binary_compressed, which is unpacked to
//! binary when it is read. Points whose coordinates are NaN stand for places where a scanner saw nothing.

use super::attributes::{Blend, Patch};
use super::edit::Edit;
use super::error::{Fault, Parsed};
use super::table::{new_rows, Column};
use super::text::{line_end, parse, push_real, show, words, Line, Lines};
use super::xyz::padded;
use super::{Mesh, Positions};
use crate::points::PointCompletion;
use std::ops::Range;

#[derive(Debug, Clone)]
pub(super) struct Layout {
    fields: Vec<Field>,
    /// Bytes of each field of the header, all its numbers together.
    widths: Vec<usize>,
    binary: bool,
    /// Field by field, packed by LZF.
    compressed: bool,
    points: usize,
    /// Where WIDTH, HEIGHT and POINTS stand in the header.
    width_at: Range<usize>,
    height_at: Range<usize>,
    points_at: Range<usize>,
    start: usize,
    /// The line before the first row.
    start_line: usize,
    end: usize,
}

/// One number of a row.
#[derive(Debug, Clone, PartialEq)]
struct Field {
    name: String,
    size: usize,
    /// F, I or U.
    kind: u8,
    offset: usize,
}

impl Field {
    /// Red, green and blue in one number, as the bytes of an integer or a float.
    fn is_packed(&self) -> bool {
        self.size == 4 && matches!(&*self.name, "rgb" | "rgba")
    }

    fn read(&self, row: &[u8]) -> f64 {
        let mut bytes = [0; 8];
        bytes[..self.size].copy_from_slice(&row[self.offset..self.offset + self.size]);
        let unsigned = u64::from_le_bytes(bytes);
        match (self.kind, self.size) {
            (b'F', 4) => f32::from_bits(unsigned as u32).into(),
            (b'F', _) => f64::from_bits(unsigned),
            (b'I', size) => {
                let shift = 64 - 8 * size;
                ((unsigned << shift) as i64 >> shift) as f64
            }
            _ => unsigned as f64,
        }
    }

    fn write(&self, x: f64, out: &mut Vec<u8>) {
        match (self.kind, self.size) {
            (b'F', 4) => out.extend_from_slice(&(x as f32).to_le_bytes()),
            (b'F', _) => out.extend_from_slice(&x.to_le_bytes()),
            (b'I', n) => out.extend_from_slice(&(x.round() as i64).to_le_bytes()[..n]),
            (_, n) => out.extend_from_slice(&(x.round() as u64).to_le_bytes()[..n]),
        }
    }

    /// The bits of a packed colour.
    fn bits(&self, x: f64) -> u32 {
        if self.kind == b'F' {
            (x as f32).to_bits()
        } else {
            x as u32
        }
    }

    fn value_of(&self, bits: u32) -> f64 {
        if self.kind == b'F' {
            f32::from_bits(bits).into()
        } else {
            bits.into()
        }
    }
}

/// The value of a header line and where it stands.
fn value<'a>(line: &Line<'a>) -> (Vec<&'a [u8]>, Range<usize>) {
    let all: Vec<&[u8]> = words(line.text).skip(1).collect();
    let at = all.first().map_or(0, |w| w.as_ptr() as usize - line.text.as_ptr() as usize);
    let at = line.start + at;
    (all.clone(), at..at + all.first().map_or(0, |w| w.len()))
}

/// A binary_compressed file as a binary one: the same points bit for bit, row by row. Others as they are.
pub(super) fn unpack(bytes: Vec<u8>) -> Parsed<Vec<u8>> {
    // What is wrong with a header is told when the file is read.
    let Some(layout) = read_header(&bytes).ok().filter(|l| l.compressed) else {
        return Ok(bytes);
    };
    let body = &bytes[layout.start..];
    let sizes = body
        .get(..8)
        .map(|b| [0, 4].map(|i| u32::from_le_bytes([b[i], b[i + 1], b[i + 2], b[i + 3]])));
    let Some([packed, whole]) = sizes.map(|s| s.map(|n| n as usize)) else {
        return Fault::byte(bytes.len(), "the file is cut off before its compressed data");
    };
    let size = layout.row_size();
    if layout.points.checked_mul(size) != Some(whole) {
        let reason = format!("{whole} bytes are not {} points of {size}", layout.points);
        return Fault::byte(layout.start + 4, reason);
    }
    let Some(data) = body[8..].get(..packed) else {
        let (there, at) = (body.len() - 8, bytes.len());
        return Fault::byte(
            at,
            format!("the file is cut off at byte {there} of {packed} compressed"),
        );
    };
    // The format packs a byte into no fewer than a 90th: no small file asks for much memory.
    if whole / 128 > packed {
        return Fault::byte(layout.start, format!("{packed} bytes cannot hold {whole}"));
    }
    let mut columns = vec![0; whole];
    if !lzf_rust::decompress(data, &mut columns).is_ok_and(|n| n == whole) {
        return Fault::byte(layout.start + 8, "the compressed data is damaged");
    }
    const WORD: &[u8] = b"_compressed";
    let word = bytes[..layout.start].windows(WORD.len()).rposition(|w| w == WORD).unwrap_or(0);
    let mut made = Vec::with_capacity(layout.start + whole);
    made.extend_from_slice(&bytes[..word]);
    made.extend_from_slice(&bytes[word + WORD.len()..layout.start]);
    for i in 0..layout.points {
        let mut from = 0;
        for &width in &layout.widths {
            made.extend_from_slice(&columns[from + i * width..][..width]);
            from += layout.points * width;
        }
    }
    Ok(made)
}

pub(super) fn read(bytes: &[u8]) -> Parsed<(Layout, Mesh)> {
    let layout = read_header(bytes)?;
    let axes = ["x", "y", "z"].map(|n| layout.fields.iter().position(|f| f.name == n));
    let [Some(x), Some(y), Some(z)] = axes else {
        return Fault::line(
            layout.start_line,
            "the fields x, y and z are not all there".to_owned(),
        );
    };
    let columns = [x, y, z];
    let single = columns.iter().all(|&c| layout.fields[c].size == 4);
    let mut layout = layout;
    let mut points = Vec::new();
    let end = layout.each_row(bytes, |row| points.push(columns.map(|c| row[c])))?;
    layout.end = end;
    let positions = if single {
        Positions::Single(points.into_iter().map(|p| p.map(|x| x as f32)).collect())
    } else {
        Positions::Double(points)
    };
    Ok((layout, Mesh { positions, triangles: Default::default() }))
}

fn read_header(bytes: &[u8]) -> Parsed<Layout> {
    let mut lines = Lines::new(bytes);
    let (mut names, mut sizes, mut kinds, mut counts) = (vec![], vec![], vec![], vec![]);
    let (mut width, mut height, mut points) = (None, None, None);
    for line in lines.by_ref() {
        let Some(key) = words(line.text).next().filter(|k| !k.starts_with(b"#")) else { continue };
        let (all, at) = value(&line);
        let number = || match all.first().and_then(|w| parse::<usize>(w)) {
            Some(n) => Ok((n, at.clone())),
            None => Fault::line(line.number, format!("{} takes a number", show(key))),
        };
        match key {
            b"FIELDS" => {
                names = all.iter().map(|w| String::from_utf8_lossy(w).into_owned()).collect()
            }
            b"SIZE" => sizes = all.iter().map(|w| parse::<usize>(w).unwrap_or(0)).collect(),
            b"TYPE" => kinds = all.iter().map(|w| w[0]).collect(),
            b"COUNT" => counts = all.iter().map(|w| parse::<usize>(w).unwrap_or(0)).collect(),
            b"WIDTH" => width = Some(number()?),
            b"HEIGHT" => height = Some(number()?),
            b"POINTS" => points = Some(number()?),
            b"VERSION" | b"VIEWPOINT" => {}
            b"DATA" => {
                let (binary, compressed) = match all.first() {
                    Some(&b"ascii") => (false, false),
                    Some(&b"binary") => (true, false),
                    Some(&b"binary_compressed") => (true, true),
                    other => {
                        let what = show(other.copied().unwrap_or_default());
                        let reason = format!(
                            "data as {what} is not read; write ascii, binary or binary_compressed"
                        );
                        return Fault::line(line.number, reason);
                    }
                };
                let (Some(w), Some(h), Some(p)) = (width, height, points) else {
                    let reason = "WIDTH, HEIGHT and POINTS must stand before DATA".to_owned();
                    return Fault::line(line.number, reason);
                };
                if w.0.checked_mul(h.0) != Some(p.0) || u32::try_from(p.0).is_err() {
                    let reason = format!("{} by {} are not {} points", w.0, h.0, p.0);
                    return Fault::line(line.number, reason);
                }
                let fields = fields(&names, &sizes, &kinds, &counts, line.number)?;
                let each = |name: usize| sizes[name] * counts.get(name).copied().unwrap_or(1);
                return Ok(Layout {
                    widths: (0..names.len()).map(each).collect(),
                    fields,
                    binary,
                    compressed,
                    points: p.0,
                    width_at: w.1,
                    height_at: h.1,
                    points_at: p.1,
                    start: line.end,
                    start_line: line.number,
                    end: 0,
                });
            }
            other => {
                return Fault::line(line.number, format!("{} is no line of a header", show(other)))
            }
        }
    }
    Fault::line(lines.number, "the header has no line DATA".to_owned())
}

fn fields(
    names: &[String],
    sizes: &[usize],
    kinds: &[u8],
    counts: &[usize],
    line: usize,
) -> Parsed<Vec<Field>> {
    let ones = vec![1; names.len()];
    let counts = if counts.is_empty() { &ones } else { counts };
    let same = [sizes.len(), kinds.len(), counts.len()].iter().all(|&n| n == names.len());
    let valid = |(s, k): (&usize, &u8)| match k {
        b'F' => matches!(s, 4 | 8),
        b'I' | b'U' => matches!(s, 1 | 2 | 4 | 8),
        _ => false,
    };
    if !same || !sizes.iter().zip(kinds).all(valid) || counts.iter().any(|c| *c > 4096) {
        let reason = "FIELDS, SIZE, TYPE and COUNT do not fit each other".to_owned();
        return Fault::line(line, reason);
    }
    let (mut all, mut offset) = (Vec::new(), 0);
    for (i, name) in names.iter().enumerate() {
        for _ in 0..counts[i] {
            all.push(Field { name: name.clone(), size: sizes[i], kind: kinds[i], offset });
            offset += sizes[i];
        }
    }
    Ok(all)
}

impl Layout {
    fn row_size(&self) -> usize {
        self.fields.last().map_or(0, |f| f.offset + f.size)
    }

    /// Gives each row's numbers; returns the byte after the last one.
    fn each_row(&self, bytes: &[u8], mut visit: impl FnMut(&[f64])) -> Parsed<usize> {
        let mut row = vec![0.0; self.fields.len()];
        let size = self.row_size();
        if self.binary {
            let end = self.points.checked_mul(size).and_then(|n| n.checked_add(self.start));
            let Some(end) = end.filter(|&e| e <= bytes.len()) else {
                let whole = (bytes.len() - self.start) / size.max(1);
                let reason = format!("the file is cut off at point {whole} of {}", self.points);
                return Fault::byte(bytes.len(), reason);
            };
            for raw in bytes[self.start..end].chunks_exact(size.max(1)) {
                row.iter_mut().zip(&self.fields).for_each(|(x, f)| *x = f.read(raw));
                visit(&row);
            }
            return Ok(end);
        }
        let mut lines = Lines { bytes, at: self.start, number: self.start_line };
        for i in 0..self.points {
            let Some(line) = lines.next() else {
                let reason = format!("the file is cut off at point {i} of {}", self.points);
                return Fault::line(lines.number + 1, reason);
            };
            let mut all = words(line.text);
            for x in &mut row {
                *x = match all.next().and_then(parse::<f64>) {
                    Some(number) => number,
                    None => {
                        let reason =
                            format!("point {i} does not have {} numbers", self.fields.len());
                        return Fault::line(line.number, reason);
                    }
                };
            }
            visit(&row);
        }
        Ok(lines.at)
    }

    /// What another format would not keep.
    pub fn extras(&self) -> Vec<String> {
        let kept = |f: &&Field| !matches!(&*f.name, "x" | "y" | "z") && !f.is_packed();
        self.fields.iter().filter(kept).map(|f| format!("the field \"{}\"", f.name)).collect()
    }

    fn normal_fields(&self) -> Option<[usize; 3]> {
        let find = |n: &str| self.fields.iter().position(|f| f.name == n && f.kind == b'F');
        Some([find("normal_x")?, find("normal_y")?, find("normal_z")?])
    }

    /// The fields normal_x, normal_y and normal_z, if all three are there.
    pub fn normals(&self, bytes: &[u8]) -> Option<Vec<[f64; 3]>> {
        let columns = self.normal_fields()?;
        let mut all = Vec::with_capacity(self.points);
        self.each_row(bytes, |row| all.push(columns.map(|c| row[c]))).ok()?;
        Some(all)
    }

    /// Red, green, blue and alpha of the field rgb or rgba.
    pub fn colours(&self, bytes: &[u8]) -> Option<Vec<[u8; 4]>> {
        let column = self.fields.iter().position(Field::is_packed)?;
        let field = &self.fields[column];
        let alpha = field.name == "rgba";
        let mut all = Vec::with_capacity(self.points);
        let visit = |row: &[f64]| {
            let [b, g, r, a] = field.bits(row[column]).to_le_bytes();
            all.push([r, g, b, if alpha { a } else { 255 }]);
        };
        self.each_row(bytes, visit).ok()?;
        Some(all)
    }
}

/// The edits that append new points: the cloud becomes one row of points, as an unordered one is.
pub(super) fn append(
    layout: &Layout,
    bytes: &[u8],
    made: &PointCompletion,
    patch: &Patch<'_>,
) -> Vec<Edit> {
    let normals = layout.normal_fields();
    // A packed colour is four columns here.
    let mut columns = Vec::new();
    for (i, f) in layout.fields.iter().enumerate() {
        let axis = ["x", "y", "z"].iter().position(|n| *n == f.name);
        let normal = normals.and_then(|n| n.iter().position(|&c| c == i));
        let blend = Blend::of(&f.name, f.kind != b'F');
        match (axis, normal) {
            (Some(axis), _) => columns.push(Column::Position(axis)),
            (_, Some(axis)) => columns.push(Column::Normal(axis)),
            _ if f.is_packed() => columns.extend([2, 1, 0, 3].map(Column::Colour)),
            _ => columns.push(Column::Carried(blend)),
        }
    }
    let (mut wanted, mut i, mut known) = (patch.known().iter().peekable(), 0usize, Vec::new());
    // The rows have been read before: they are all there.
    let _ = layout.each_row(bytes, |row| {
        if wanted.peek().is_some_and(|&&w| w as usize == i) {
            wanted.next();
            for (f, &x) in layout.fields.iter().zip(row) {
                if f.is_packed() {
                    known.extend(f.bits(x).to_le_bytes().map(f64::from));
                } else {
                    known.push(x);
                }
            }
        }
        i += 1;
    });
    let rows = new_rows(made, patch, &columns, &known);
    let mut with = Vec::new();
    if !layout.binary && layout.end > 0 && !matches!(bytes[layout.end - 1], b'\n' | b'\r') {
        with.extend_from_slice(line_end(bytes));
    }
    for row in &rows {
        let mut values = row.iter();
        for (k, f) in layout.fields.iter().enumerate() {
            let mut next = || values.next().copied().unwrap_or(0.0);
            let x = if f.is_packed() {
                let bytes =
                    [next(), next(), next(), next()].map(|c| c.round().clamp(0.0, 255.0) as u8);
                f.value_of(u32::from_le_bytes(bytes))
            } else {
                next()
            };
            if layout.binary {
                f.write(x, &mut with);
                continue;
            }
            if k > 0 {
                with.push(b' ');
            }
            match f.kind {
                b'F' => push_real(&mut with, x, f.size == 4),
                _ => with.extend(format!("{:.0}", x.round()).into_bytes()),
            }
        }
        if !layout.binary {
            with.extend_from_slice(line_end(bytes));
        }
    }
    let total = layout.points + rows.len();
    let number = |n: usize, at: &Range<usize>| Edit { at: at.clone(), with: padded(n, at.len()) };
    vec![
        Edit { at: layout.end..layout.end, with },
        number(total, &layout.width_at),
        number(1, &layout.height_at),
        number(total, &layout.points_at),
    ]
}

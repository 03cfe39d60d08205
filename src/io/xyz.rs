//! XYZ and its kin (ASC, PTS): a point a line, x, y and z first, whatever else after them.

use super::attributes::{Blend, Patch};
use super::edit::Edit;
use super::error::{Fault, Parsed};
use super::table::{new_rows, Column};
use super::text::{
    coordinate, fits_single, is_blank, line_end, parse, push_real, show, Line, Lines,
};
use super::{Mesh, Positions};
use crate::points::PointCompletion;
use std::ops::Range;

/// A normal's length may be off by so much: three digits behind the point are common.
const UNIT: f64 = 0.01;

#[derive(Debug, Clone)]
pub(super) struct Layout {
    columns: Vec<Column>,
    /// Columns in which every number is whole: new ones are, too.
    whole: Vec<bool>,
    /// Between two numbers.
    separator: Vec<u8>,
    /// The first line of PTS: how many points there are, and where that stands.
    count: Option<(usize, Range<usize>)>,
    /// The byte after the last row.
    end: usize,
}

fn numbers(text: &[u8]) -> impl Iterator<Item = &[u8]> {
    let between = |c: &u8| c.is_ascii_whitespace() || matches!(c, b',' | b';');
    text.split(between).filter(|w| !w.is_empty())
}

/// The lines that hold something, comments left out.
fn content(bytes: &[u8]) -> impl Iterator<Item = Line<'_>> {
    let comment = |t: &[u8]| t.starts_with(b"#") || t.starts_with(b"//");
    Lines::new(bytes).filter(move |l| !is_blank(l.text) && !comment(l.text.trim_ascii_start()))
}

/// The rows alone: neither a line of names nor a count.
fn rows(bytes: &[u8]) -> impl Iterator<Item = Line<'_>> {
    let is_row = |l: &Line<'_>| {
        let mut words = numbers(l.text);
        words.next().is_some_and(|w| parse::<f64>(w).is_some()) && words.next().is_some()
    };
    let mut first = true;
    content(bytes).filter(move |l| !std::mem::replace(&mut first, false) || is_row(l))
}

pub(super) fn read(bytes: &[u8]) -> Parsed<(Layout, Mesh)> {
    let mut layout = Layout {
        columns: Vec::new(),
        whole: Vec::new(),
        separator: vec![b' '],
        count: count(bytes),
        end: 0,
    };
    let (mut points, mut single, mut row) = (Vec::new(), true, Vec::new());
    // Columns that may begin a normal: so far all three together have been of unit length.
    let mut normal: Vec<bool> = Vec::new();
    for line in rows(bytes) {
        row.clear();
        let mut p = [0.0; 3];
        for (i, word) in numbers(line.text).enumerate() {
            row.push(match i {
                0..=2 => coordinate(word, line.number)?,
                _ => parse(word).ok_or(()).or_else(|()| {
                    Fault::line(line.number, format!("{} is not a number", show(word)))
                })?,
            });
            if i < 3 {
                p[i] = row[i];
                single &= fits_single(word, row[i]);
            }
        }
        if points.is_empty() {
            if row.len() < 3 {
                return Fault::line(line.number, "a point needs three numbers".to_owned());
            }
            layout.whole = vec![true; row.len()];
            normal = vec![true; row.len().saturating_sub(2)];
            layout.separator = separator(line.text);
        } else if row.len() != layout.whole.len() {
            let reason = format!(
                "point {} has {} numbers, but the first one {}",
                points.len(),
                row.len(),
                layout.whole.len()
            );
            return Fault::line(line.number, reason);
        }
        layout.whole.iter_mut().zip(&row).for_each(|(w, x)| *w &= x.fract() == 0.0);
        for (c, is) in normal.iter_mut().enumerate().skip(3) {
            let length = row[c..c + 3].iter().map(|x| x * x).sum::<f64>().sqrt();
            *is &= (length - 1.0).abs() < UNIT || length == 0.0;
        }
        layout.end = line.end;
        points.push(p);
    }
    if u32::try_from(points.len()).is_err() {
        return Fault::line(1, format!("{} points are too many", points.len()));
    }
    if let Some((count, _)) = layout.count.as_ref().filter(|c| c.0 != points.len()) {
        let reason = format!("the first line says {count} points, but there are {}", points.len());
        return Fault::line(1, reason);
    }
    let start = normal.iter().enumerate().skip(3).find(|n| *n.1).map(|n| n.0);
    layout.columns = (0..layout.whole.len())
        .map(|i| match (i, start) {
            (0..=2, _) => Column::Position(i),
            (_, Some(s)) if (s..s + 3).contains(&i) => Column::Normal(i - s),
            _ => Column::Carried(Blend::Copied),
        })
        .collect();
    let positions = Positions::from_text(points, single);
    Ok((layout, Mesh { positions, triangles: Default::default() }))
}

/// PTS begins with the count of the points, alone on its line.
fn count(bytes: &[u8]) -> Option<(usize, Range<usize>)> {
    let line = content(bytes).next()?;
    let text = line.text.trim_ascii();
    let at = line.start + (line.text.len() - line.text.trim_ascii_start().len());
    Some((parse(text)?, at..at + text.len()))
}

/// What stands between the first two numbers.
fn separator(text: &[u8]) -> Vec<u8> {
    let is = |c: &u8| c.is_ascii_whitespace() || matches!(c, b',' | b';');
    let after: Vec<u8> = text.trim_ascii_start().iter().copied().skip_while(|c| !is(c)).collect();
    let between: Vec<u8> = after.into_iter().take_while(is).collect();
    if between.is_empty() {
        vec![b' ']
    } else {
        between
    }
}

impl Layout {
    /// What another format would not keep.
    pub fn extras(&self) -> Vec<String> {
        match self.columns.len() {
            0..=3 => Vec::new(),
            n => vec![format!("{} further columns", n - 3)],
        }
    }

    fn table(&self, bytes: &[u8], wanted: &[u32]) -> Vec<f64> {
        let mut wanted = wanted.iter().peekable();
        let mut values = Vec::new();
        for (i, line) in rows(bytes).enumerate() {
            if wanted.peek().is_some_and(|&&w| w as usize == i) {
                wanted.next();
                values.extend(numbers(line.text).map(|w| parse::<f64>(w).unwrap_or(f64::NAN)));
            }
        }
        values
    }

    /// The normals of all points, if three columns hold unit vectors.
    pub fn normals(&self, bytes: &[u8]) -> Option<Vec<[f64; 3]>> {
        let start = self.columns.iter().position(|c| *c == Column::Normal(0))?;
        let normal = |line: Line<'_>| {
            let mut n = [0.0; 3];
            let words = numbers(line.text).skip(start);
            n.iter_mut().zip(words).for_each(|(x, w)| *x = parse(w).unwrap_or(0.0));
            n
        };
        Some(rows(bytes).map(normal).collect())
    }
}

/// The edits that append new points.
pub(super) fn append(
    layout: &Layout,
    bytes: &[u8],
    mesh: &Mesh,
    made: &PointCompletion,
    patch: &Patch<'_>,
) -> Vec<Edit> {
    let single = mesh.positions.view(bytes).is_single();
    let end = line_end(bytes);
    let mut with = Vec::new();
    if !matches!(bytes[layout.end - 1], b'\n' | b'\r') {
        with.extend_from_slice(end);
    }
    let known = layout.table(bytes, patch.known());
    let rows = new_rows(made, patch, &layout.columns, &known);
    for row in &rows {
        for (i, &x) in row.iter().enumerate() {
            if i > 0 {
                with.extend_from_slice(&layout.separator);
            }
            match layout.columns[i] {
                Column::Position(_) => push_real(&mut with, x, single),
                _ if layout.whole[i] => push_real(&mut with, x.round(), true),
                _ => push_real(&mut with, x, true),
            }
        }
        with.extend_from_slice(end);
    }
    let mut edits = vec![Edit { at: layout.end..layout.end, with }];
    if let Some((count, at)) = &layout.count {
        edits.push(Edit { at: at.clone(), with: padded(count + rows.len(), at.len()) });
    }
    edits
}

/// A number of at least so many digits: what it replaces may not be longer.
pub(super) fn padded(number: usize, digits: usize) -> Vec<u8> {
    format!("{number:0>digits$}").into_bytes()
}

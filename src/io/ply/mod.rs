//! PLY (Turk 1994): ascii and both binaries, any elements and properties in any order.

mod append;
mod cursor;
mod header;
mod write;

pub(super) use append::{append, append_points};
pub(super) use write::{from_polygons, from_rows};

use super::error::{Fault, Parsed, Place};
use super::polygon::{Triangles, MAX_CORNERS};
use super::text::{is_blank, Lines};
use super::{Mesh, Positions};
use cursor::{each_row, each_row_from, list_count, skip_rows, skip_value, Ascii, Binary, Cursor};
use header::{Element, Encoding, Header, Kind, Scalar};
use std::ops::Range;

/// Where everything lies in the file.
#[derive(Debug, Clone)]
pub(super) struct Layout {
    header: Header,
    /// The rows of each element.
    spans: Vec<Range<usize>>,
    /// For ascii, the lines before each element's first one.
    lines: Vec<usize>,
}

/// The names of the corner list that are in use.
const CORNER_LISTS: [&str; 2] = ["vertex_indices", "vertex_index"];

/// Calls `$body` with a cursor named `$cursor` at the start of element `$element`.
macro_rules! with_cursor {
    ($layout:expr, $bytes:expr, $element:expr, |$cursor:ident| $body:expr) => {{
        let (layout, element) = (&$layout, $element);
        let at = layout.spans[element].start;
        match layout.header.encoding {
            Encoding::Ascii => {
                let lines = Lines { bytes: $bytes, at, number: layout.lines[element] };
                let $cursor = &mut Ascii::new(lines);
                $body
            }
            Encoding::Little => {
                let $cursor = &mut Binary::<false> { bytes: $bytes, at };
                $body
            }
            Encoding::Big => {
                let $cursor = &mut Binary::<true> { bytes: $bytes, at };
                $body
            }
        }
    }};
}
use with_cursor;

/// Reads the file: where its rows are, its positions and its triangles.
pub(super) fn read(bytes: &[u8]) -> Parsed<(Layout, Mesh)> {
    let header = Header::parse(bytes)?;
    let mut layout = Layout { header, spans: Vec::new(), lines: Vec::new() };
    match layout.header.encoding {
        Encoding::Ascii => {
            let lines =
                Lines { bytes, at: layout.header.data_start, number: layout.header.data_line - 1 };
            read_body(&mut layout, bytes, &mut Ascii::new(lines), |c| c.lines.number)
        }
        Encoding::Little => {
            let at = layout.header.data_start;
            read_body(&mut layout, bytes, &mut Binary::<false> { bytes, at }, |_| 0)
        }
        Encoding::Big => {
            let at = layout.header.data_start;
            read_body(&mut layout, bytes, &mut Binary::<true> { bytes, at }, |_| 0)
        }
    }
    .map(|mesh| (layout, mesh))
}

fn read_body<C: Cursor>(
    layout: &mut Layout,
    bytes: &[u8],
    cursor: &mut C,
    line: impl Fn(&C) -> usize,
) -> Parsed<Mesh> {
    let header = &layout.header;
    let Some(vertex) = header.find("vertex") else {
        return Fault::line(header.data_line - 1, "there is no element \"vertex\"");
    };
    let vertex_count = header.elements[vertex].count;
    if u32::try_from(vertex_count).is_err() {
        let reason = format!("{vertex_count} vertices are more than 32-bit indices can name");
        return Fault::line(header.data_line - 1, reason);
    }
    let (mut positions, mut faces, mut strips) = (None, Triangles::default(), Triangles::default());
    for element in &header.elements {
        let start = cursor.at();
        layout.lines.push(line(cursor));
        match &*element.name {
            "vertex" => positions = Some(read_positions(cursor, element)?),
            "face" => {
                // A face of three corners takes at least this much of what is left.
                let least = 3 + element.min_row_size(C::ENCODING);
                faces.faces.reserve_exact(element.count.min(cursor.left() / least));
                read_faces(cursor, element, vertex_count, |corners| faces.push(corners))?
            }
            "tristrips" => read_strips(cursor, element, vertex_count, &mut strips)?,
            _ => skip_rows(cursor, element)?,
        }
        layout.spans.push(start..cursor.at());
    }
    check_rest(cursor.place(), &bytes[cursor.at()..])?;
    let positions = positions.unwrap_or(Positions::Double(Vec::new()));
    faces.faces.append(&mut strips.faces);
    let mut mesh = Mesh { positions, triangles: faces };
    mesh.cut_polygons(bytes);
    Ok(mesh)
}

/// After the last row there may be nothing but line ends.
fn check_rest(place: Place, rest: &[u8]) -> Parsed<()> {
    if is_blank(rest) {
        return Ok(());
    }
    let reason = format!("{} more bytes follow the last element; a count is too small", rest.len());
    Err(Fault { place, reason })
}

/// The scalar types of x, y and z, and whether all are float.
fn position_columns(element: &Element) -> Option<[(usize, Scalar); 3]> {
    let column = |name| {
        let i = element.find(name)?;
        match element.properties[i].kind {
            Kind::Scalar(s) => Some((i, s)),
            Kind::List { .. } => None,
        }
    };
    Some([column("x")?, column("y")?, column("z")?])
}

fn read_positions<C: Cursor>(cursor: &mut C, element: &Element) -> Parsed<Positions> {
    let Some(columns) = position_columns(element) else {
        let reason = "the element \"vertex\" needs the scalar properties x, y and z".into();
        return Err(Fault { place: cursor.place(), reason });
    };
    let single = columns.iter().all(|&(_, s)| s == Scalar::F32);
    if let Some(at) = in_place(element, columns, C::ENCODING) {
        let (offset, stride) = (cursor.at() + at, element.row_size().unwrap_or(0));
        skip_rows(cursor, element)?;
        return Ok(Positions::InPlace { offset, stride, count: element.count, single });
    }
    cursor::check_room(cursor, element)?;
    let mut one = Vec::with_capacity(if single { element.count } else { 0 });
    let mut two = Vec::with_capacity(if single { 0 } else { element.count });
    let mut p = [0.0; 3];
    let last = element.properties.len() - 1;
    let visit = |c: &mut C, _: usize, i: usize, kind: Kind| {
        match (columns.iter().position(|&(k, _)| k == i), kind) {
            (Some(axis), Kind::Scalar(s)) => {
                p[axis] = c.real(s)?;
                if C::ENCODING == Encoding::Ascii && !p[axis].is_finite() {
                    let reason = format!("the coordinate {} is not finite", p[axis]);
                    return Err(Fault { place: c.place(), reason });
                }
            }
            _ => skip_value(c, kind)?,
        }
        match (i == last, single) {
            (true, true) => one.push(p.map(|x| x as f32)),
            (true, false) => two.push(p),
            _ => {}
        }
        Ok(())
    };
    each_row(cursor, element, visit, |_| ())?;
    Ok(if single { Positions::Single(one) } else { Positions::Double(two) })
}

/// Where in a row the positions lie, if they can be used as they are in the file.
fn in_place(element: &Element, columns: [(usize, Scalar); 3], encoding: Encoding) -> Option<usize> {
    element.row_size()?;
    let [(x, s), ..] = columns;
    let fits = encoding == Encoding::Little
        && cfg!(target_endian = "little")
        && columns == [(x, s), (x + 1, s), (x + 2, s)]
        && !s.is_integer();
    let before = |p: &header::Property| match p.kind {
        Kind::Scalar(s) => s.size(),
        Kind::List { .. } => 0,
    };
    fits.then(|| element.properties[..x].iter().map(before).sum())
}

/// The list that holds the corners: its index and types.
fn corner_list(element: &Element, place: Place) -> Parsed<(usize, Scalar, Scalar)> {
    let found = CORNER_LISTS.iter().find_map(|name| element.find(name));
    let fault = |reason: String| Err(Fault { place, reason });
    match found.map(|i| (i, element.properties[i].kind)) {
        Some((i, Kind::List { count, item })) if item.is_integer() => Ok((i, count, item)),
        Some(_) => fault(format!("the corners of \"{}\" are not a list of integers", element.name)),
        None => {
            fault(format!("\"{}\" needs a list vertex_indices (or vertex_index)", element.name))
        }
    }
}

fn read_faces<C: Cursor>(
    cursor: &mut C,
    element: &Element,
    vertex_count: usize,
    mut face: impl FnMut(&[u32]),
) -> Parsed<()> {
    let (column, count, item) = corner_list(element, cursor.place())?;
    cursor::check_room(cursor, element)?;
    let mut first = 0;
    if element.properties.len() == 1 && count.size() == 1 && item.size() == 4 {
        // A negative index is at least 2^31 here; the general way below says what it is.
        let limit = vertex_count.min(1 << 31) as u32;
        first = cursor.plain_triangles(element.count, limit, |f| face(&f));
    }
    let mut corners = Vec::new();
    let visit = |c: &mut C, _: usize, i: usize, kind: Kind| {
        let (true, Kind::List { count, item }) = (i == column, kind) else {
            return skip_value(c, kind);
        };
        let n = list_count(c, count)?;
        if !(3..=MAX_CORNERS).contains(&n) {
            let reason = format!("a face with {n} corners; from 3 to {MAX_CORNERS} are possible");
            return Err(Fault { place: c.place(), reason });
        }
        corners.clear();
        for _ in 0..n {
            corners.push(read_index(c, item, vertex_count)?);
        }
        face(&corners);
        Ok(())
    };
    each_row_from(cursor, element, first, visit, |_| ())
}

#[inline]
fn read_index<C: Cursor>(c: &mut C, item: Scalar, vertex_count: usize) -> Parsed<u32> {
    let v = c.integer(item)?;
    match u32::try_from(v) {
        Ok(v) if (v as usize) < vertex_count => Ok(v),
        _ => {
            let reason = format!("it names vertex {v}, but there are only {vertex_count}");
            Err(Fault { place: c.place(), reason })
        }
    }
}

/// Triangle strips, -1 between two of them. Every second triangle of a strip is turned round, and
/// triangles that name a vertex twice only serve to join strips.
fn read_strips<C: Cursor>(
    cursor: &mut C,
    element: &Element,
    vertex_count: usize,
    triangles: &mut Triangles,
) -> Parsed<()> {
    let (column, ..) = corner_list(element, cursor.place())?;
    let visit = |c: &mut C, _: usize, i: usize, kind: Kind| {
        let (true, Kind::List { count, item }) = (i == column, kind) else {
            return skip_value(c, kind);
        };
        let n = list_count(c, count)?;
        let mut strip = (0, [0; 2]);
        for _ in 0..n {
            let v = c.integer(item)?;
            if v == -1 {
                strip.0 = 0;
                continue;
            }
            let Some(v) = u32::try_from(v).ok().filter(|&v| (v as usize) < vertex_count) else {
                let reason = format!("it names vertex {v}, but there are only {vertex_count}");
                return Err(Fault { place: c.place(), reason });
            };
            let (length, [a, b]) = strip;
            if length >= 2 && a != b && b != v && a != v {
                triangles.push(&if length % 2 == 0 { [a, b, v] } else { [b, a, v] });
            }
            strip = (length + 1, [b, v]);
        }
        Ok(())
    };
    each_row(cursor, element, visit, |_| ())
}

impl Layout {
    /// The faces in order, and then the strips' triangles.
    pub fn each_face(&self, bytes: &[u8], mut face: impl FnMut(&[u32])) -> Parsed<()> {
        let elements = &self.header.elements;
        let count = self.header.find("vertex").map_or(0, |v| elements[v].count);
        if let Some(e) = self.header.find("face") {
            with_cursor!(*self, bytes, e, |c| read_faces(c, &elements[e], count, &mut face))?;
        }
        if let Some(e) = self.header.find("tristrips") {
            let mut triangles = Triangles::default();
            with_cursor!(*self, bytes, e, |c| {
                read_strips(c, &elements[e], count, &mut triangles)
            })?;
            triangles.faces.iter().for_each(|f| face(f));
        }
        Ok(())
    }

    /// What another format would not keep.
    pub fn extras(&self) -> Vec<String> {
        let kept = |element: &str, property: &str| {
            let colour = property.strip_prefix("diffuse_").unwrap_or(property);
            match element {
                "vertex" => ["x", "y", "z", "red", "green", "blue", "alpha"].contains(&colour),
                "face" | "tristrips" => CORNER_LISTS.contains(&property),
                _ => false,
            }
        };
        let all =
            self.header.elements.iter().flat_map(|e| e.properties.iter().map(move |p| (e, p)));
        all.filter(|(e, p)| !kept(&e.name, &p.name))
            .map(|(e, p)| format!("the property \"{}\" of \"{}\"", p.name, e.name))
            .collect()
    }

    /// The scalars of the given rows (sorted, no row twice) of an element, row by row, one number
    /// a property; lists count as 0.
    fn fetch_rows(&self, bytes: &[u8], element: usize, rows: &[u32]) -> Parsed<Vec<f64>> {
        let e = &self.header.elements[element];
        let mut values = Vec::with_capacity(rows.len() * e.properties.len());
        let (mut wanted, last) = (rows.iter().peekable(), e.properties.len().saturating_sub(1));
        with_cursor!(*self, bytes, element, |c| each_row(
            c,
            e,
            |c, row, i, kind| {
                if wanted.peek().is_none_or(|&&w| w as usize != row) {
                    return skip_value(c, kind);
                }
                match kind {
                    Kind::Scalar(s) => values.push(c.real(s)?),
                    Kind::List { .. } => {
                        skip_value(c, kind)?;
                        values.push(0.0);
                    }
                }
                if i == last {
                    wanted.next();
                }
                Ok(())
            },
            |_| (),
        ))?;
        Ok(values)
    }

    /// The columns nx, ny and nz, if all three are there as floats.
    pub fn vertex_normals(&self, bytes: &[u8]) -> Option<Vec<[f64; 3]>> {
        let element = self.header.find("vertex")?;
        let e = &self.header.elements[element];
        let columns = append::normal_columns(&e.properties)?;
        let mut normals = Vec::with_capacity(e.count);
        let (mut normal, last) = ([0.0; 3], e.properties.len() - 1);
        let visited = with_cursor!(*self, bytes, element, |c| each_row(
            c,
            e,
            |c, _, i, kind| {
                match (columns.iter().position(|&k| k == i), kind) {
                    (Some(axis), Kind::Scalar(s)) => normal[axis] = c.real(s)?,
                    _ => skip_value(c, kind)?,
                }
                if i == last {
                    normals.push(normal);
                }
                Ok(())
            },
            |_| (),
        ));
        visited.is_ok().then_some(normals)
    }

    /// Red, green, blue and alpha of every vertex, from 0 to 255, if the file has colours.
    pub fn vertex_colours(&self, bytes: &[u8]) -> Option<Vec<[u8; 4]>> {
        let element = self.header.find("vertex")?;
        let e = &self.header.elements[element];
        let column = |name: &str| {
            let i = e.find(name).or_else(|| e.find(&format!("diffuse_{name}")))?;
            matches!(e.properties[i].kind, Kind::Scalar(_)).then_some(i)
        };
        let columns =
            [Some(column("red")?), Some(column("green")?), Some(column("blue")?), column("alpha")];
        let mut colours = Vec::with_capacity(e.count);
        let (mut colour, last) = ([255; 4], e.properties.len() - 1);
        let visited = with_cursor!(*self, bytes, element, |c| each_row(
            c,
            e,
            |c, _, i, kind| {
                match (columns.iter().position(|&k| k == Some(i)), kind) {
                    (Some(channel), Kind::Scalar(s)) => colour[channel] = to_byte(c.real(s)?, s),
                    _ => skip_value(c, kind)?,
                }
                if i == last {
                    colours.push(colour);
                }
                Ok(())
            },
            |_| (),
        ));
        visited.is_ok().then_some(colours)
    }
}

/// A colour channel as a byte: integers use their whole range, floats 0 to 1.
fn to_byte(value: f64, s: Scalar) -> u8 {
    let full = if s.is_integer() { s.range().1 } else { 1.0 };
    (value / full * 255.0).round().clamp(0.0, 255.0) as u8
}

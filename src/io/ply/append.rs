//! New rows for the fill, every property filled in.

use super::cursor::{each_row, list_count, skip_value, Ascii, Binary, Cursor};
use super::header::{Encoding, Kind, Property, Scalar};
use super::write::Rows;
use super::{corner_list, position_columns, with_cursor, Layout};
use crate::io::attributes::{Blend, Column as Carried, Patch};
use crate::io::edit::Edit;
use crate::io::error::{Fault, IoError, Place};
use crate::io::text::Lines;
use crate::io::{Extras, Format, Mesh};
use crate::result::{Completion, Origin, NONE};

/// What the edits are made from.
struct Job<'a> {
    layout: &'a Layout,
    bytes: &'a [u8],
    mesh: &'a Mesh,
    completion: &'a Completion,
    /// Of a cloud: source points instead of source faces.
    source_points: Option<&'a [u32]>,
    patch: Patch<'a>,
    edits: Vec<Edit>,
}

/// Where a new vertex's number comes from.
#[derive(Clone, Copy, PartialEq)]
enum Source {
    Position(usize),
    Normal(usize),
    /// This column of what is carried inward.
    Carried(usize),
    Origin(Origins),
    EmptyList(Scalar),
}

/// What is known of where a vertex comes from.
#[derive(Clone, Copy, PartialEq)]
enum Origins {
    Completed,
    Hole,
    Face,
    Point,
    U,
    V,
    Source,
    Confidence,
}

/// A column of provenance.
struct Column {
    name: &'static str,
    type_name: &'static str,
    scalar: Scalar,
    /// What it says of an input vertex.
    input_value: f64,
    origin: Origins,
}

const PROVENANCE: [Column; 8] = {
    const fn column(
        name: &'static str,
        scalar: Scalar,
        input_value: f64,
        origin: Origins,
    ) -> Column {
        let type_name = match scalar {
            Scalar::U8 => "uchar",
            Scalar::F32 => "float",
            _ => "int",
        };
        Column { name, type_name, scalar, input_value, origin }
    }
    [
        column("completed", Scalar::U8, 0.0, Origins::Completed),
        column("hole", Scalar::I32, -1.0, Origins::Hole),
        column("source_face", Scalar::I32, -1.0, Origins::Face),
        column("source_point", Scalar::I32, -1.0, Origins::Point),
        column("source_u", Scalar::F32, 0.0, Origins::U),
        column("source_v", Scalar::F32, 0.0, Origins::V),
        column("source", Scalar::I32, -1.0, Origins::Source),
        column("confidence", Scalar::F32, 0.0, Origins::Confidence),
    ]
};

impl Origins {
    /// What a property is about. Names that files use for other things, too (a scanner's
    /// confidence), count only if the file has `source_face` or
    /// `source_point` (`others`), too.
    fn of(name: &str, others: bool) -> Option<Self> {
        let column = PROVENANCE.iter().find(|c| c.name == name)?;
        let common = matches!(column.origin, Origins::Source | Origins::Confidence);
        (others || !common).then_some(column.origin)
    }

    /// Whether it says something of points, of meshes, or both.
    fn fits(self, points: bool) -> bool {
        match self {
            Origins::Point => points,
            Origins::Face | Origins::U | Origins::V => !points,
            _ => true,
        }
    }

    fn value(self, hole: u32, origin: &Origin, point: u32) -> f64 {
        let index = |i: u32| if i == NONE { -1.0 } else { f64::from(i) };
        match self {
            Origins::Completed => 1.0,
            Origins::Hole => hole.into(),
            Origins::Face => index(origin.face),
            Origins::Point => index(point),
            Origins::U => origin.barycentric[1],
            Origins::V => origin.barycentric[2],
            Origins::Source => index(origin.source),
            Origins::Confidence => origin.confidence,
        }
    }
}

/// The edits that append the fill to a file.
pub(in crate::io) fn append(
    layout: &Layout,
    bytes: &[u8],
    mesh: &Mesh,
    patch: Patch<'_>,
    extras: &Extras,
) -> Result<Vec<Edit>, IoError> {
    let completion = patch.completion();
    let mut job =
        Job { layout, bytes, mesh, completion, source_points: None, patch, edits: Vec::new() };
    job.append_vertices(extras)?;
    if !completion.faces.is_empty() {
        match (layout.header.find("face"), layout.header.find("tristrips")) {
            (Some(face), _) => job.append_faces(face)?,
            (None, Some(strips)) => job.append_strips(strips)?,
            _ => return unsupported("the file has no element \"face\" to add faces to"),
        }
    }
    Ok(job.edits)
}

/// The edits that append new points to a cloud's file.
pub(in crate::io) fn append_points(
    layout: &Layout,
    bytes: &[u8],
    mesh: &Mesh,
    source_points: &[u32],
    patch: Patch<'_>,
    extras: &Extras,
) -> Result<Vec<Edit>, IoError> {
    let (completion, source_points) = (patch.completion(), Some(source_points));
    let mut job = Job { layout, bytes, mesh, completion, source_points, patch, edits: Vec::new() };
    job.append_vertices(extras)?;
    Ok(job.edits)
}

fn unsupported<T>(what: impl Into<String>) -> Result<T, IoError> {
    Err(IoError::Unsupported { format: Format::Ply, what: what.into() })
}

fn fault(f: Fault) -> IoError {
    f.into_error(Format::Ply)
}

impl Job<'_> {
    fn rows(&self) -> Rows {
        Rows::new(self.layout.header.encoding, self.layout.header.line_end)
    }

    /// Inserts rows at the end of an element and raises its count.
    fn insert(&mut self, element: usize, rows: Vec<u8>, count: usize) {
        let (e, end) = (&self.layout.header.elements[element], self.layout.spans[element].end);
        let ascii = self.layout.header.encoding == Encoding::Ascii;
        let mut with = Vec::new();
        if ascii && !matches!(self.bytes[end - 1], b'\n' | b'\r') {
            with.extend_from_slice(self.layout.header.line_end);
        }
        with.extend(rows);
        self.edits.push(Edit { at: end..end, with });
        let new_count = (e.count + count).to_string().into_bytes();
        // "007" may be longer than what replaces it; zeros in front make up for it.
        let pad = e.count_at.len().saturating_sub(new_count.len());
        let with = [vec![b'0'; pad], new_count].concat();
        self.edits.push(Edit { at: e.count_at.clone(), with });
    }

    fn append_vertices(&mut self, extras: &Extras) -> Result<(), IoError> {
        let Some(element) = self.layout.header.find("vertex") else { return Ok(()) };
        let e = &self.layout.header.elements[element];
        let mut properties = e.properties.clone();
        if extras.provenance {
            // Holes and sources are fewer than faces.
            let count = self.completion.input_face_count.max(self.completion.input_vertex_count);
            if self.source_points.is_some() && i32::try_from(count).is_err()
                || i32::try_from(self.completion.input_face_count).is_err()
            {
                return unsupported("the columns of provenance end at 2147483647 elements");
            }
            let added = self.add_provenance(element)?;
            properties.extend(added);
        }
        if self.completion.vertices.is_empty() {
            return Ok(());
        }
        let columns = position_columns(e).unwrap_or([(0, Scalar::I8); 3]);
        if columns.iter().any(|c| c.1 != columns[0].1 || c.1.is_integer()) {
            return unsupported("x, y and z are not all float or all double; change them first");
        }
        let (sources, carried) = plan(&properties);
        let values = self.carry(element, &carried)?;
        let normals = self.normals(element, &properties)?;
        let mut rows = self.rows();
        for (i, p) in self.completion.vertices.iter().enumerate() {
            for (source, property) in sources.iter().zip(&properties) {
                let Kind::Scalar(s) = property.kind else {
                    if let Source::EmptyList(count) = *source {
                        rows.push(count, 0.0);
                    }
                    continue;
                };
                let value = match *source {
                    Source::Position(axis) => p[axis],
                    Source::Normal(axis) => normals[i][axis],
                    Source::Carried(c) => values[i * carried.len() + c],
                    Source::Origin(what) => {
                        let point = self.source_points.map_or(NONE, |all| all[i]);
                        let hole = self.completion.vertex_hole[i];
                        what.value(hole, &self.completion.origins[i], point)
                    }
                    Source::EmptyList(_) => 0.0,
                };
                rows.push(s, value);
            }
            rows.end_row();
        }
        self.insert(element, rows.out, self.completion.vertices.len());
        Ok(())
    }

    /// Adds the columns of provenance, where they are missing, to every row.
    fn add_provenance(&mut self, element: usize) -> Result<Vec<Property>, IoError> {
        let e = &self.layout.header.elements[element];
        let fits = |c: &&Column| c.origin.fits(self.source_points.is_some());
        let added: Vec<&Column> =
            PROVENANCE.iter().filter(fits).filter(|c| e.find(c.name).is_none()).collect();
        if added.is_empty() {
            return Ok(Vec::new());
        }
        let (mut header, mut suffix) = (Vec::new(), self.rows());
        for Column { name, type_name, scalar, input_value, .. } in &added {
            header.extend(format!("property {type_name} {name}").into_bytes());
            header.extend_from_slice(self.layout.header.line_end);
            suffix.continue_row(*scalar, *input_value);
        }
        self.edits.push(Edit { at: e.header_end..e.header_end, with: header });
        let span = self.layout.spans[element].clone();
        let mut with = Vec::with_capacity(span.len() + e.count * suffix.out.len());
        let mut from = span.start;
        let bytes = self.bytes;
        let after = |end: usize| {
            with.extend_from_slice(&bytes[from..end]);
            with.extend_from_slice(&suffix.out);
            from = end;
        };
        with_cursor!(*self.layout, bytes, element, |c| each_row(
            c,
            e,
            |c, _, _, kind| skip_value(c, kind),
            after
        ))
        .map_err(fault)?;
        with.extend_from_slice(&bytes[from..span.end]);
        self.edits.push(Edit { at: span, with });
        let property = |c: &&Column| Property { name: c.name.into(), kind: Kind::Scalar(c.scalar) };
        Ok(added.iter().map(property).collect())
    }

    /// The columns `carried` of the new vertices, row by row.
    fn carry(&self, element: usize, carried: &[(usize, Carried)]) -> Result<Vec<f64>, IoError> {
        if carried.is_empty() {
            return Ok(Vec::new());
        }
        let all = self.known_rows(element)?;
        let width = self.layout.header.elements[element].properties.len();
        let known: Vec<f64> =
            all.chunks_exact(width).flat_map(|row| carried.iter().map(|&(c, _)| row[c])).collect();
        let columns: Vec<Carried> = carried.iter().map(|c| c.1).collect();
        Ok(self.patch.complete(&known, &columns))
    }

    fn known_rows(&self, element: usize) -> Result<Vec<f64>, IoError> {
        self.layout.fetch_rows(self.bytes, element, self.patch.known()).map_err(fault)
    }

    fn normals(&self, element: usize, properties: &[Property]) -> Result<Vec<[f64; 3]>, IoError> {
        let Some(columns) = normal_columns(properties) else { return Ok(Vec::new()) };
        let rows = self.known_rows(element)?;
        let width = self.layout.header.elements[element].properties.len();
        let rim: Vec<_> =
            self.patch.rim_of(&rows, width).map(|row| columns.map(|c| row[c])).collect();
        Ok(self.patch.normals(self.mesh.positions.view(self.bytes), &rim))
    }

    fn append_faces(&mut self, element: usize) -> Result<(), IoError> {
        let e = &self.layout.header.elements[element];
        let (column, _, item) = corner_list(e, Place::Byte(0)).map_err(fault)?;
        self.check_index_type(item)?;
        let templates = self.face_templates(element)?;
        let width = e.properties.len();
        let mut rows = self.rows();
        for (i, face) in self.completion.faces.iter().enumerate() {
            for (k, property) in e.properties.iter().enumerate() {
                match property.kind {
                    Kind::List { count, item } if k == column => {
                        rows.push(count, 3.0);
                        face.iter().for_each(|&v| rows.push(item, v.into()));
                    }
                    Kind::List { count, .. } => rows.push(count, 0.0),
                    Kind::Scalar(s) => {
                        rows.push(s, templates.get(i * width + k).copied().unwrap_or(0.0))
                    }
                }
            }
            rows.end_row();
        }
        self.insert(element, rows.out, self.completion.faces.len());
        Ok(())
    }

    /// For each new face the row of the input face it takes after; nothing if faces have only
    /// their corners.
    fn face_templates(&self, element: usize) -> Result<Vec<f64>, IoError> {
        let e = &self.layout.header.elements[element];
        if e.properties.len() < 2 {
            return Ok(Vec::new());
        }
        let face_of =
            |t: u32| Some(self.mesh.triangles.face_of(t as usize)).filter(|&f| f < e.count);
        let found = self.patch.templates(self.mesh.triangles.view());
        let found: Vec<Option<u32>> =
            found.into_iter().map(|t| t.and_then(face_of).map(|f| f as u32)).collect();
        let mut rows: Vec<u32> = found.iter().flatten().copied().collect();
        rows.sort_unstable();
        rows.dedup();
        let values = self.layout.fetch_rows(self.bytes, element, &rows).map_err(fault)?;
        let width = e.properties.len();
        let row_of = |f: &Option<u32>| match f.and_then(|f| rows.binary_search(&f).ok()) {
            Some(r) => values[r * width..(r + 1) * width].to_vec(),
            None => vec![0.0; width],
        };
        Ok(found.iter().flat_map(row_of).collect())
    }

    fn check_index_type(&self, item: Scalar) -> Result<(), IoError> {
        let total = self.completion.input_vertex_count + self.completion.vertices.len();
        let greatest = item.range().1;
        if total as f64 - 1.0 > greatest {
            return unsupported(format!(
                "the corner list's type ends at {greatest}, but with the fill there are {total} \
                 vertices; give the list a wider type first"
            ));
        }
        Ok(())
    }

    /// Appends the triangles to the last row's strips, or in rows of their own if it has no room.
    fn append_strips(&mut self, element: usize) -> Result<(), IoError> {
        let e = &self.layout.header.elements[element];
        let (column, count, item) = corner_list(e, Place::Byte(0)).map_err(fault)?;
        self.check_index_type(item)?;
        let faces = &self.completion.faces;
        let end = self.last_list(element, column)?.filter(|_| item.range().0 < 0.0);
        if let Some(end) = end {
            let separated = end.length == 0 || end.last == -1;
            let length = end.length + 4 * faces.len() - usize::from(separated);
            if length as f64 <= count.range().1 {
                let mut items = self.rows();
                for (i, face) in faces.iter().enumerate() {
                    if i > 0 || !separated {
                        items.continue_row(item, -1.0);
                    }
                    face.iter().for_each(|&v| items.continue_row(item, v.into()));
                }
                self.edits.push(Edit { at: end.items_end..end.items_end, with: items.out });
                let mut new_count = self.rows();
                new_count.push(count, length as f64);
                self.edits.push(Edit { at: end.count_at, with: new_count.out });
                return Ok(());
            }
        }
        // Without a negative number there is no separator: then each triangle is a row.
        let room = ((count.range().1 as usize).saturating_add(1) / 4).max(1);
        let per_row = if item.range().0 < 0.0 { room } else { 1 };
        let mut rows = self.rows();
        for chunk in faces.chunks(per_row) {
            for property in &e.properties {
                match property.kind {
                    Kind::List { count, item } if e.properties[column] == *property => {
                        rows.push(count, (4 * chunk.len() - 1) as f64);
                        for (i, face) in chunk.iter().enumerate() {
                            if i > 0 {
                                rows.push(item, -1.0);
                            }
                            face.iter().for_each(|&v| rows.push(item, v.into()));
                        }
                    }
                    Kind::List { count: s, .. } | Kind::Scalar(s) => rows.push(s, 0.0),
                }
            }
            rows.end_row();
        }
        self.insert(element, rows.out, faces.len().div_ceil(per_row));
        Ok(())
    }

    /// Where the list `column` of the element's last row lies.
    fn last_list(&self, element: usize, column: usize) -> Result<Option<ListEnd>, IoError> {
        let e = &self.layout.header.elements[element];
        let mut found = None;
        with_cursor!(*self.layout, self.bytes, element, |c| each_row(
            c,
            e,
            |c, row, i, kind| {
                let (true, Kind::List { count, item }) = (row + 1 == e.count && i == column, kind)
                else {
                    return skip_value(c, kind);
                };
                let start = c.value_start();
                let length = list_count(c, count)?;
                let (count_at, mut last) = (start..c.value_end(), 0);
                for _ in 0..length {
                    last = c.integer(item)?;
                }
                found = Some(ListEnd { count_at, length, last, items_end: c.value_end() });
                Ok(())
            },
            |_| (),
        ))
        .map_err(fault)?;
        Ok(found)
    }
}

/// A list in the file.
struct ListEnd {
    count_at: std::ops::Range<usize>,
    length: usize,
    last: i64,
    items_end: usize,
}

/// Where each property of a new vertex comes from, and the columns to carry inward.
fn plan(properties: &[Property]) -> (Vec<Source>, Vec<(usize, Carried)>) {
    let normals = normal_columns(properties);
    let others = properties.iter().any(|p| p.name == "source_face" || p.name == "source_point");
    let mut carried = Vec::new();
    let mut source = |(i, p): (usize, &Property)| {
        let s = match p.kind {
            Kind::Scalar(s) => s,
            Kind::List { count, .. } => return Source::EmptyList(count),
        };
        if let Some(axis) = normals.and_then(|n| n.iter().position(|&c| c == i)) {
            return Source::Normal(axis);
        }
        match &*p.name {
            "x" => Source::Position(0),
            "y" => Source::Position(1),
            "z" => Source::Position(2),
            name => match Origins::of(name, others) {
                Some(what) => Source::Origin(what),
                None => {
                    let blend = Blend::of(name, s.is_integer());
                    carried.push((i, Carried { blend, colour: colour_of(name, s) }));
                    Source::Carried(carried.len() - 1)
                }
            },
        }
    };
    let sources = properties.iter().enumerate().map(&mut source).collect();
    (sources, carried)
}

/// Which channel of a colour a property is, and what stands for 255.
fn colour_of(name: &str, scalar: Scalar) -> Option<(usize, f64)> {
    let name = name.strip_prefix("diffuse_").unwrap_or(name);
    let channel = ["red", "green", "blue", "alpha"].iter().position(|c| *c == name)?;
    Some((channel, if scalar.is_integer() { scalar.range().1 } else { 1.0 }))
}

/// The columns nx, ny and nz, if all three are there as floats.
pub(super) fn normal_columns(properties: &[Property]) -> Option<[usize; 3]> {
    let column = |name: &str| {
        properties
            .iter()
            .position(|p| p.name == name && matches!(p.kind, Kind::Scalar(s) if !s.is_integer()))
    };
    Some([column("nx")?, column("ny")?, column("nz")?])
}

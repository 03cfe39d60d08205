//! Texture coordinates and materials that an OBJ fill takes from where its shape was copied from.
//!
//! Each corner of a new face has a place on one source: its own, or what the report says of the copy
//! beside its border. The corner takes the texture coordinates of that place, interpolated on the
//! source's triangle, so that the same image goes on; edges where they jump are those where sources
//! change. All corners of a face lie in one chart: where the source's triangles are of several, or a
//! chart's two ends meet, the triangle at the first corner's place is continued.

use super::obj::{arguments, keyword, statements};
use super::text::parse;
use super::Mesh;
use crate::mesh::roots::Roots;
use crate::mesh::VertexView;
use crate::result::{Completion, NONE};
use std::collections::BTreeMap;

/// A place on the source: a triangle of the mesh and the weights of its corners.
type Place = (u32, [f64; 3]);

/// Where the corners of a new face lie on one source.
struct OnSource {
    /// The first corner that has a place, and which it is.
    first: Place,
    /// `Err`: none is known, and this is where the copy's motion takes the corner.
    corners: [Result<Place, [f64; 3]>; 3],
}

/// What the fill's faces take from their sources.
pub(super) struct Sourced {
    faces: Vec<Option<OnSource>>,
}

/// The places on the sources of a completion.
struct Places<'a> {
    completion: &'a Completion,
    vertices: VertexView<'a>,
    triangles: usize,
    /// By vertex, hole and source.
    beside: BTreeMap<[u32; 3], Place>,
}

impl<'a> Places<'a> {
    fn new(completion: &'a Completion, vertices: VertexView<'a>, triangles: usize) -> Self {
        let mut beside = BTreeMap::new();
        for hole in &completion.holes {
            for s in &hole.seams {
                beside.insert([s.vertex, hole.hole as u32, s.source], (s.face, s.barycentric));
            }
        }
        Self { completion, vertices, triangles, beside }
    }

    fn new_vertex(&self, v: u32) -> Option<usize> {
        (v as usize).checked_sub(self.completion.input_vertex_count)
    }

    /// Places on an exemplar are left out: it is another file, of another image.
    fn at(&self, v: u32, hole: u32, source: u32) -> Option<Place> {
        let own = self.new_vertex(v).map(|i| &self.completion.origins[i]);
        let own = own.filter(|o| o.source == source && !o.is_nowhere());
        let place = own.map(|o| (o.face, o.barycentric));
        let place = place.or_else(|| self.beside.get(&[v, hole, source]).copied());
        place.filter(|p| (p.0 as usize) < self.triangles)
    }

    /// The source of a new vertex.
    fn own(&self, v: u32) -> Option<u32> {
        let source = self.completion.origins[self.new_vertex(v)?].source;
        (source != NONE).then_some(source)
    }

    /// The sources beside a vertex.
    fn beside(&self, v: u32, hole: u32) -> impl Iterator<Item = u32> + '_ {
        self.beside.range([v, hole, 0]..=[v, hole, NONE]).map(|(key, _)| key[2])
    }

    /// The corners' own source that has a place for all of them, else the first; where they have none,
    /// all at the rim, the same of those beside them.
    fn source(&self, face: [u32; 3], hole: u32) -> Option<u32> {
        let mut sources: Vec<u32> = face.iter().filter_map(|&v| self.own(v)).collect();
        if sources.is_empty() {
            sources = face.iter().flat_map(|&v| self.beside(v, hole)).collect();
        }
        let serves_all = |s: &u32| face.iter().all(|&v| self.at(v, hole, *s).is_some());
        sources.iter().copied().find(serves_all).or(sources.first().copied())
    }

    fn of_face(&self, face: [u32; 3], hole: u32) -> Option<OnSource> {
        let report = self.completion.holes.iter().find(|h| h.hole as u32 == hole)?;
        let source = self.source(face, hole)?;
        let back = report.sources.get(source as usize)?.transform.inverse();
        let corners = face.map(|v| {
            self.at(v, hole, source).ok_or_else(|| {
                let p = match self.new_vertex(v) {
                    Some(i) => self.completion.vertices[i],
                    None => self.vertices.get(v as usize),
                };
                back.point(p.into()).to_array()
            })
        });
        let first = *corners.iter().find_map(|c| c.as_ref().ok())?;
        Some(OnSource { first, corners })
    }
}

impl Sourced {
    /// Of a completion of a mesh with these vertices and so many triangles.
    pub fn new(completion: &Completion, vertices: VertexView<'_>, triangles: usize) -> Self {
        let places = Places::new(completion, vertices, triangles);
        let holes = completion.face_hole.iter();
        let of_face = |(face, &hole): (&[u32; 3], &u32)| places.of_face(*face, hole);
        Self { faces: completion.faces.iter().zip(holes).map(of_face).collect() }
    }

    /// The triangle that a new face takes its material from.
    pub fn triangle(&self, face: usize) -> Option<u32> {
        Some(self.faces.get(face)?.as_ref()?.first.0)
    }

    /// Texture coordinates of the corners of the new faces; `None` where there is no source, or none
    /// that has any. Rows of [`Texture::width`] numbers.
    pub fn texture(&self, texture: &Texture, mesh: &Mesh, bytes: &[u8]) -> Vec<Option<[Row; 3]>> {
        let positions = mesh.positions.view(bytes);
        let point = |(t, w): Place| {
            let p = mesh.triangles.faces[t as usize].map(|v| positions.get(v as usize));
            [0, 1, 2].map(|d| (0..3).map(|k| w[k] * p[k][d]).sum::<f64>())
        };
        let of_face = |face: &Option<OnSource>| {
            let face = face.as_ref()?;
            let first = texture.corners(face.first.0, mesh)?;
            let p = mesh.triangles.faces[face.first.0 as usize].map(|v| positions.get(v as usize));
            Some(face.corners.map(|corner| {
                let place = match corner {
                    Ok(place) => place,
                    Err(at) => return first.at(extended(&p, at)),
                };
                let continued = first.at(extended(&p, point(place)));
                let own = texture.corners(place.0, mesh).filter(|c| c.chart == first.chart);
                match own.map(|c| c.at(place.1)) {
                    Some(row) if distance(row, continued) <= first.size() => row,
                    _ => continued,
                }
            }))
        };
        self.faces.iter().map(of_face).collect()
    }
}

/// The numbers of a `vt` line; two or three count.
pub(super) type Row = [f64; 3];

fn distance(a: Row, b: Row) -> f64 {
    (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
}

/// Barycentric coordinates of a point's foot on a triangle's plane, also outside the triangle.
fn extended(p: &[[f64; 3]; 3], at: [f64; 3]) -> [f64; 3] {
    let p = p.map(glam::DVec3::from);
    let (b, c, d) = (p[1] - p[0], p[2] - p[0], glam::DVec3::from(at) - p[0]);
    let n = b.cross(c);
    let scale = 1.0 / n.length_squared().max(f64::MIN_POSITIVE);
    let (v, w) = (d.cross(c).dot(n) * scale, b.cross(d).dot(n) * scale);
    [1.0 - v - w, v, w]
}

/// The texture coordinates of a file.
pub(super) struct Texture {
    /// How many numbers every `vt` line has.
    pub width: usize,
    rows: Vec<Row>,
    /// The chart of each: those that faces join.
    charts: Vec<u32>,
    /// Vertex and `vt` of the corners of all faces, and where each face's end.
    corners: Vec<(u32, u32)>,
    ends: Vec<usize>,
}

/// The texture coordinates at a triangle's corners.
struct Corners {
    rows: [Row; 3],
    chart: u32,
}

impl Corners {
    fn at(&self, weights: [f64; 3]) -> Row {
        [0, 1, 2].map(|d| (0..3).map(|k| weights[k] * self.rows[k][d]).sum())
    }

    /// Length of the longest side.
    fn size(&self) -> f64 {
        (0..3).map(|k| distance(self.rows[k], self.rows[(k + 1) % 3])).fold(0.0, f64::max)
    }
}

impl Texture {
    /// Of an OBJ file; `None` if it has no texture coordinates.
    pub fn read(bytes: &[u8]) -> Option<Self> {
        let mut texture =
            Self { width: 3, rows: vec![], charts: vec![], corners: vec![], ends: vec![] };
        let mut vertices = 0;
        for line in statements(bytes) {
            match keyword(line.text) {
                b"v" => vertices += 1,
                b"vt" => {
                    let mut numbers = arguments(line.text).map_while(parse::<f64>);
                    let row = [0, 1, 2].map(|_| numbers.next());
                    let given = row.iter().take_while(|x| x.is_some()).count();
                    texture.width = texture.width.min(given);
                    texture.rows.push(row.map(|x| x.filter(|x| x.is_finite()).unwrap_or(0.0)));
                }
                b"f" => {
                    let so_far = [vertices, texture.rows.len() as i64];
                    texture.corners.extend(arguments(line.text).map(|w| corner(w, so_far)));
                    texture.ends.push(texture.corners.len());
                }
                _ => {}
            }
        }
        texture.find_charts();
        (!texture.rows.is_empty() && texture.width > 0).then_some(texture)
    }

    /// How many `vt` lines there are.
    pub fn count(&self) -> usize {
        self.rows.len()
    }

    fn face(&self, face: usize) -> &[(u32, u32)] {
        let start = face.checked_sub(1).map_or(0, |f| self.ends[f]);
        &self.corners[start..self.ends[face]]
    }

    fn find_charts(&mut self) {
        let count = self.rows.len();
        let mut charts = Roots::new(count);
        for f in 0..self.ends.len() {
            let mut known = self.face(f).iter().map(|c| c.1).filter(|&t| (t as usize) < count);
            let Some(first) = known.next() else { continue };
            for other in known {
                charts.join(first, other);
            }
        }
        self.charts = charts.into_roots();
    }

    /// The first two numbers at a triangle's corners; `None` if one has none.
    pub fn coordinates(&self, triangle: u32, mesh: &Mesh) -> Option<[[f64; 2]; 3]> {
        Some(self.corners(triangle, mesh)?.rows.map(|row| [row[0], row[1]]))
    }

    /// Of a triangle of the mesh; `None` if a corner has none.
    fn corners(&self, triangle: u32, mesh: &Mesh) -> Option<Corners> {
        let face = self.face(mesh.triangles.face_of(triangle as usize));
        let number = |v: u32| face.iter().find(|c| c.0 == v).map(|c| c.1 as usize);
        let [a, b, c] = mesh.triangles.faces[triangle as usize].map(number);
        let [a, b, c] = [a?, b?, c?];
        let rows = [self.rows.get(a)?, self.rows.get(b)?, self.rows.get(c)?].map(|r| *r);
        Some(Corners { rows, chart: self.charts[a] })
    }
}

/// Vertex and `vt` of a corner, from 0; `NONE` where there is none. Negative numbers count back from
/// what was read so far.
fn corner(word: &[u8], so_far: [i64; 2]) -> (u32, u32) {
    let mut parts = word.split(|&c| c == b'/');
    let [v, t] = so_far.map(|n| {
        let i = parts.next().and_then(parse::<i64>)?;
        u32::try_from(if i < 0 { n + i } else { i - 1 }).ok()
    });
    (v.unwrap_or(NONE), t.unwrap_or(NONE))
}

//! A fill together with the known surface around it, and the cotangent Laplacian on both.

use super::patch::Patch;
use super::solve::grow;
use crate::mesh::neighbourhood::{Neighbourhood, NONE};
use glam::DVec3;
use std::sync::{Arc, Mutex, PoisonError};

/// Least and greatest weight of an edge: near-degenerate triangles, of which scans are full,
/// would else let one edge decide everything (a bi-Laplacian without the clamp explodes).
const WEIGHT_RANGE: (f64, f64) = (0.01, 3.0);
/// Least mass of a vertex, in median masses, for the same reason.
const LEAST_MASS: f64 = 0.5;
/// Triangles whose cotangents are kept while a Laplacian is made, 32 bytes each: of more they are computed
/// anew at each corner, since they would be a third of the room.
const MOST_KEPT: usize = 1 << 13;

/// Faces at each vertex of a mesh, as one array with row starts.
pub struct Incidence {
    start: Vec<u32>,
    faces: Vec<u32>,
}

impl Incidence {
    /// Counts, then fills: two linear passes over the neighbourhood.
    pub fn new(near: &Neighbourhood) -> Self {
        Self::of(near.positions.len(), &near.faces)
    }

    /// The same for any faces over `vertex_count` vertices.
    pub fn of(vertex_count: usize, faces: &[[u32; 3]]) -> Self {
        let mut start = vec![0u32; vertex_count + 1];
        faces.iter().flatten().for_each(|&v| start[v as usize + 1] += 1);
        for v in 0..vertex_count {
            start[v + 1] += start[v];
        }
        let mut next = start.clone();
        let mut at_vertex = vec![0; 3 * faces.len()];
        for (f, face) in faces.iter().enumerate() {
            for &v in face {
                at_vertex[next[v as usize] as usize] = f as u32;
                next[v as usize] += 1;
            }
        }
        Self { start, faces: at_vertex }
    }

    /// The faces at vertex `v`.
    pub fn faces(&self, v: u32) -> &[u32] {
        &self.faces[self.start[v as usize] as usize..self.start[v as usize + 1] as usize]
    }
}

/// The faces at each vertex of a neighbourhood, made when asked for. They are a third of what it takes:
/// a fill that needs the room forgets them, and who asks again has them made again.
pub struct Incidences<'a> {
    near: &'a Neighbourhood,
    made: Mutex<Option<Arc<Incidence>>>,
}

impl<'a> Incidences<'a> {
    /// Of a neighbourhood; none made yet.
    pub fn new(near: &'a Neighbourhood) -> Self {
        Self { near, made: Mutex::default() }
    }

    /// The faces at each vertex.
    pub fn get(&self) -> Arc<Incidence> {
        let mut made = self.made.lock().unwrap_or_else(PoisonError::into_inner);
        made.get_or_insert_with(|| Arc::new(Incidence::new(self.near))).clone()
    }

    /// Drops them as soon as nobody uses them.
    pub fn forget(&self) {
        *self.made.lock().unwrap_or_else(PoisonError::into_inner) = None;
    }
}

/// The known surface around a rim: the vertices and faces within a number of rings.
#[derive(Debug, Default)]
pub struct Band {
    /// Neighbourhood vertices: the rim's first, in the patch's order, then ring by ring.
    pub vertices: Vec<u32>,
    /// Where ring r ends in `vertices`; ring 0 is the rim.
    pub ring_ends: Vec<usize>,
    /// Faces in band numbers.
    pub faces: Vec<[u32; 3]>,
}

impl Band {
    /// Grows `rings` rings of faces around the rim.
    pub fn grow(near: &Neighbourhood, incidence: &Incidence, rim: &[u32], rings: usize) -> Self {
        let mut number = vec![NONE; near.positions.len()];
        rim.iter().enumerate().for_each(|(i, &v)| number[v as usize] = i as u32);
        let mut band = Band { vertices: rim.to_vec(), ring_ends: vec![rim.len()], faces: vec![] };
        let mut taken = vec![false; near.faces.len()];
        let mut begin = 0;
        for _ in 0..rings {
            let end = band.vertices.len();
            for i in begin..end {
                for &f in incidence.faces(band.vertices[i]) {
                    if std::mem::replace(&mut taken[f as usize], true) {
                        continue;
                    }
                    let face = near.faces[f as usize];
                    for v in face {
                        if number[v as usize] == NONE {
                            number[v as usize] = band.vertices.len() as u32;
                            band.vertices.push(v);
                        }
                    }
                    band.faces.push(face.map(|v| number[v as usize]));
                }
            }
            begin = end;
            band.ring_ends.push(band.vertices.len());
        }
        band
    }
}

/// Patch and band as one mesh. Vertices: the patch's (rim, then new), then the band's others.
pub struct Sheet {
    /// Positions in mesh units.
    pub positions: Vec<DVec3>,
    /// Triangles of the patch, then faces of the band.
    pub triangles: Vec<[u32; 3]>,
    /// Vertices of the rim.
    pub rim_count: usize,
    /// Vertices of the patch.
    pub patch_count: usize,
    /// Ring of each vertex: 0 on the rim and inside, r in the band.
    pub ring: Vec<u16>,
    /// Faces of the band, the last ones of `triangles`.
    pub band_face_count: usize,
    /// Rings of the band; the Laplacian is complete at rings below the last.
    pub rings: usize,
    /// Of each vertex of the rim whether the fill need only be joined there; empty: nowhere.
    pub loose: Vec<bool>,
}

impl Sheet {
    /// Puts a patch and the band around its rim together.
    pub fn new(patch: &Patch, band: &Band, near: &Neighbourhood) -> Self {
        // Exactly what is needed: growing takes twice that.
        let new = patch.new_count();
        let mut positions = Vec::with_capacity(new + band.vertices.len());
        positions.extend_from_slice(&patch.positions);
        let mut triangles = Vec::with_capacity(patch.triangles.len() + band.faces.len());
        triangles.extend_from_slice(&patch.triangles);
        Self::extend((positions, triangles), patch.rim_count, band, near)
    }

    /// The same with the patch's own positions and triangles, which it has back by [`Self::give_back`]: a
    /// large fill has no room for a second copy.
    pub fn take(patch: &mut Patch, band: &Band, near: &Neighbourhood) -> Self {
        let mut positions = std::mem::take(&mut patch.positions);
        let mut triangles = std::mem::take(&mut patch.triangles);
        positions.reserve_exact(band.vertices.len() - patch.rim_count);
        triangles.reserve_exact(band.faces.len());
        Self::extend((positions, triangles), patch.rim_count, band, near)
    }

    /// Gives the patch its positions and triangles, where they are now.
    pub fn give_back(mut self, patch: &mut Patch) {
        self.positions.truncate(self.patch_count);
        self.triangles.truncate(self.triangles.len() - self.band_face_count);
        (patch.positions, patch.triangles) = (self.positions, self.triangles);
    }

    fn extend(
        (mut positions, mut triangles): (Vec<DVec3>, Vec<[u32; 3]>),
        rim: usize,
        band: &Band,
        near: &Neighbourhood,
    ) -> Self {
        let new = positions.len() - rim;
        positions.extend(band.vertices[rim..].iter().map(|&v| near.positions.get(v)));
        let number = |v: u32| if (v as usize) < rim { v } else { v + new as u32 };
        triangles.extend(band.faces.iter().map(|f| f.map(number)));
        let mut ring = vec![0; positions.len()];
        for r in 1..band.ring_ends.len() {
            ring[new + band.ring_ends[r - 1]..new + band.ring_ends[r]].fill(r as u16);
        }
        let rings = band.ring_ends.len() - 1;
        Self {
            positions,
            triangles,
            rim_count: rim,
            patch_count: rim + new,
            ring,
            band_face_count: band.faces.len(),
            rings,
            loose: match near.loose.is_empty() {
                true => Vec::new(),
                false => band.vertices[..rim].iter().map(|&v| near.is_loose(v)).collect(),
            },
        }
    }

    /// Whether a vertex is one of the fill's own.
    pub fn is_new(&self, v: usize) -> bool {
        v >= self.rim_count && v < self.patch_count
    }

    /// Whether all faces around a vertex are in the sheet, and belong to one surface: a rim that is only joined
    /// is a hinge, whose row says nothing.
    pub fn is_complete(&self, v: usize) -> bool {
        let inner = self.is_new(v) || (self.ring[v] as usize) < self.rings;
        inner && !self.loose.get(v).is_some_and(|&loose| loose)
    }
}

/// A symmetric Laplacian by rows, positive semi-definite: `(L x)_i = Σ_j w_ij (x_i − x_j)`, with
/// the lumped masses (a third of the area around each vertex).
pub struct Laplacian {
    /// Row starts.
    pub start: Vec<u32>,
    /// Neighbours.
    pub to: Vec<u32>,
    /// Weights w_ij > 0.
    pub weight: Vec<f64>,
    /// Sum of the weights of each row.
    pub diagonal: Vec<f64>,
    /// Mass of each vertex, in square mesh units.
    pub mass: Vec<f64>,
}

/// Which weights a Laplacian has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Weights {
    /// Half the sum of the cotangents opposite to the edge, clamped.
    Cotangent,
    /// 1.
    Uniform,
}

impl Laplacian {
    /// The Laplacian of a triangle mesh.
    pub fn new(positions: &[DVec3], triangles: &[[u32; 3]], weights: Weights) -> Self {
        let n = positions.len();
        let around = Incidence::of(n, triangles);
        // Each inner edge is two entries, and has two triangles; those of the border are few.
        let entries = 3 * triangles.len();
        let mut l = Self {
            start: Vec::with_capacity(n + 1),
            to: Vec::with_capacity(entries),
            weight: Vec::with_capacity(entries),
            diagonal: vec![0.0; n],
            mass: vec![0.0; n],
        };
        l.start.push(0);
        let shape = |tri: &[u32; 3]| half_cotangents(tri.map(|v| positions[v as usize]));
        let shapes: Vec<_> = match triangles.len() <= MOST_KEPT {
            true => triangles.iter().map(shape).collect(),
            false => Vec::new(),
        };
        let mut row: Vec<(u32, f64)> = Vec::new();
        for v in 0..n {
            row.clear();
            for &t in around.faces(v as u32) {
                let tri = &triangles[t as usize];
                let (half_cot, area2) = match shapes.get(t as usize) {
                    Some(shape) => *shape,
                    None => shape(tri),
                };
                for k in (0..3).filter(|&k| tri[k] as usize == v) {
                    let (next, last) = ((k + 1) % 3, (k + 2) % 3);
                    l.mass[v] += area2 / 6.0;
                    add_to(&mut row, tri[next], half_cot[last]);
                    add_to(&mut row, tri[last], half_cot[next]);
                }
            }
            row.sort_unstable_by_key(|e| e.0);
            grow(&mut l.to, &mut l.weight, row.len(), n / 64);
            for &(to, half_cotangents) in &row {
                let w = match weights {
                    Weights::Uniform => 1.0,
                    Weights::Cotangent => half_cotangents.clamp(WEIGHT_RANGE.0, WEIGHT_RANGE.1),
                };
                l.to.push(to);
                l.weight.push(w);
                l.diagonal[v] += w;
            }
            l.start.push(l.to.len() as u32);
        }
        drop((around, shapes));
        l.lift_masses();
        l
    }

    fn lift_masses(&mut self) {
        let mut sorted = self.mass.clone();
        if sorted.is_empty() {
            return;
        }
        let middle = sorted.len() / 2;
        let least = LEAST_MASS * *sorted.select_nth_unstable_by(middle, f64::total_cmp).1;
        self.mass.iter_mut().for_each(|m| *m = m.max(least).max(f64::MIN_POSITIVE));
    }

    /// The off-diagonal entries of a row: neighbour and weight.
    pub fn row(&self, v: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let range = self.start[v] as usize..self.start[v + 1] as usize;
        range.map(|e| (self.to[e] as usize, self.weight[e]))
    }
}

/// Half the cotangent at each corner of a triangle, and twice its area.
fn half_cotangents(p: [DVec3; 3]) -> ([f64; 3], f64) {
    let area2 = (p[1] - p[0]).cross(p[2] - p[0]).length();
    let half_cot = |at: usize| {
        let (u, v) = (p[(at + 1) % 3] - p[at], p[(at + 2) % 3] - p[at]);
        0.5 * u.dot(v) / area2.max(f64::MIN_POSITIVE)
    };
    ([0, 1, 2].map(half_cot), area2)
}

/// Adds to the entry of a column; a row has few.
fn add_to(row: &mut Vec<(u32, f64)>, column: u32, value: f64) {
    match row.iter_mut().find(|e| e.0 == column) {
        Some(entry) => entry.1 += value,
        None => row.push((column, value)),
    }
}

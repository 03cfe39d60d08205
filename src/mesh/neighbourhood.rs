//! The part of the mesh near the holes, copied out: all that a fill has to know.

use super::MeshView;
use crate::error::Result;
use crate::progress::Monitor;
use glam::DVec3;

/// "No such vertex" in index arrays.
pub const NONE: u32 = u32::MAX;

/// Cells along the longest side of the grid that sorts faces to boxes; own choice: 32³ bits are
/// 4 KiB and stay in the first-level cache.
const CELLS: f64 = 32.0;

/// An axis-aligned box.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// Least corner.
    pub min: DVec3,
    /// Greatest corner.
    pub max: DVec3,
}

impl Bounds {
    /// The box that holds nothing.
    pub const EMPTY: Self =
        Self { min: DVec3::splat(f64::INFINITY), max: DVec3::splat(f64::NEG_INFINITY) };

    /// The box around points.
    pub fn of(points: impl IntoIterator<Item = DVec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, |b, p| Self { min: b.min.min(p), max: b.max.max(p) })
    }
    /// The box around a triangle.
    #[inline]
    pub fn of_triangle([a, b, c]: [DVec3; 3]) -> Self {
        Self { min: a.min(b).min(c), max: a.max(b).max(c) }
    }
    /// The same box, `by` wider to all sides.
    pub fn grown(self, by: f64) -> Self {
        Self { min: self.min - by, max: self.max + by }
    }
    /// The box around both.
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }
    /// Whether they have a point in common.
    pub fn overlaps(&self, other: &Self) -> bool {
        self.min.cmple(other.max).all() && other.min.cmple(self.max).all()
    }
    /// Whether `other` lies inside.
    pub fn contains(&self, other: &Self) -> bool {
        self.min.cmple(other.min).all() && other.max.cmple(self.max).all()
    }
    /// Length of the diagonal; 0 for the empty box.
    pub fn diagonal(&self) -> f64 {
        if self.min.x > self.max.x {
            0.0
        } else {
            self.min.distance(self.max)
        }
    }
}

/// Vertices or faces handled between two checks for cancelling.
const CHUNK: usize = 1 << 16;

/// Faces near the holes, with vertices of their own numbering.
#[derive(Debug, Default, Clone)]
pub struct Neighbourhood {
    /// Input index of each local vertex, ascending.
    pub vertices: Vec<u32>,
    /// Their positions.
    pub positions: Positions,
    /// Local vertices of each face, in input order.
    pub faces: Vec<[u32; 3]>,
    /// Local vertices that fills need only be joined at ([`crate::Guidance::loose`]), ascending.
    pub loose: Vec<u32>,
}

/// Positions in mesh units, in the precision of the input: around a wide hole they are most of the mesh.
#[derive(Debug, Clone)]
pub enum Positions {
    /// f32.
    Single(Vec<[f32; 3]>),
    /// f64.
    Double(Vec<DVec3>),
}

impl Default for Positions {
    fn default() -> Self {
        Self::Double(Vec::new())
    }
}

impl Positions {
    /// How many.
    #[inline]
    pub fn len(&self) -> usize {
        match self {
            Self::Single(p) => p.len(),
            Self::Double(p) => p.len(),
        }
    }
    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
    /// One of them.
    #[inline]
    pub fn get(&self, v: u32) -> DVec3 {
        match self {
            Self::Single(p) => {
                let [x, y, z] = p[v as usize];
                DVec3::new(x.into(), y.into(), z.into())
            }
            Self::Double(p) => p[v as usize],
        }
    }
}

impl Neighbourhood {
    /// Copies every face whose box meets one of `boxes`. Two linear passes.
    pub fn gather(mesh: MeshView<'_>, boxes: &[Bounds], monitor: &Monitor) -> Result<Self> {
        let grid = Grid::of(boxes);
        let codes = outcodes(mesh, &grid, monitor)?;
        let mut face_ids = Vec::new();
        for f in 0..mesh.faces.len() {
            if f % CHUNK == 0 {
                monitor.check()?;
            }
            let [a, b, c] = mesh.faces.get(f).map(|v| codes[v as usize]);
            // Most faces lie in one cell, or beyond one side.
            if a == b && b == c && a < NEAR || sides(a) & sides(b) & sides(c) != 0 {
                continue;
            }
            let is_marked = a == MARKED || b == MARKED || c == MARKED;
            if is_marked || grid.meets(&Bounds::of_triangle(corners(mesh, f))) {
                face_ids.push(f as u32);
            }
        }
        drop(codes);
        monitor.check()?;
        Ok(Self::copy_out(mesh, face_ids))
    }

    fn copy_out(mesh: MeshView<'_>, face_ids: Vec<u32>) -> Self {
        let mut faces: Vec<[u32; 3]> =
            face_ids.iter().map(|&f| mesh.faces.get(f as usize)).collect();
        drop(face_ids);
        let (first, last) =
            faces.iter().flatten().fold((NONE, 0), |(a, b), &v| (a.min(v), b.max(v)));
        let span = if faces.is_empty() { 0 } else { (last - first) as usize + 1 };
        let mut vertices: Vec<u32>;
        // A direct table where the indices lie close together, else a search.
        if span <= 32 * faces.len() + 1024 {
            let mut local = vec![NONE; span];
            faces.iter().flatten().for_each(|&v| local[(v - first) as usize] = 0);
            vertices = Vec::with_capacity(local.iter().filter(|&&place| place == 0).count());
            for (i, place) in local.iter_mut().enumerate().filter(|(_, place)| **place == 0) {
                *place = vertices.len() as u32;
                vertices.push(first + i as u32);
            }
            faces.iter_mut().flatten().for_each(|v| *v = local[(*v - first) as usize]);
        } else {
            vertices = faces.iter().flatten().copied().collect();
            vertices.sort_unstable();
            vertices.dedup();
            vertices.shrink_to_fit();
            let find = |v: u32| vertices.partition_point(|&w| w < v) as u32;
            faces.iter_mut().flatten().for_each(|v| *v = find(*v));
        }
        let at = vertices.iter().map(|&v| mesh.vertices.get(v as usize));
        let positions = match mesh.vertices.is_single() {
            true => Positions::Single(at.map(|p| p.map(|x| x as f32)).collect()),
            false => Positions::Double(at.map(DVec3::from).collect()),
        };
        Self { vertices, positions, faces, loose: Vec::new() }
    }

    /// The corners of a face.
    #[inline]
    pub fn corners(&self, f: u32) -> [DVec3; 3] {
        self.faces[f as usize].map(|v| self.positions.get(v))
    }

    /// The box of a face.
    fn face_box(&self, f: u32) -> Bounds {
        Bounds::of_triangle(self.corners(f))
    }

    /// Whether a fill need only be joined at a local vertex.
    pub fn is_loose(&self, v: u32) -> bool {
        self.loose.binary_search(&v).is_ok()
    }

    /// Local index of an input vertex.
    pub fn local(&self, input: u32) -> Option<u32> {
        self.vertices.binary_search(&input).ok().map(|i| i as u32)
    }
}

fn corners(mesh: MeshView<'_>, f: usize) -> [DVec3; 3] {
    let [a, b, c] = mesh.faces.get(f);
    [a, b, c].map(|v| DVec3::from(mesh.vertices.get(v as usize)))
}

/// Codes of [`outcodes`] beyond the numbers of cells, of which there are 33³ at most: with a bit for each of
/// the six sides that a vertex lies beyond.
const OUTSIDE: u16 = 0xff00;
/// In a marked cell, but in no box.
const NEAR: u16 = 0xfffe;
/// In a box, or in a marked cell where those stand for the boxes.
const MARKED: u16 = 0xffff;

/// The sides that a code names.
#[inline]
fn sides(code: u16) -> u16 {
    match code {
        OUTSIDE..NEAR => code ^ OUTSIDE,
        _ => 0,
    }
}

/// Where each vertex lies: the number of its cell if that is not marked, else one of the codes above.
fn outcodes(mesh: MeshView<'_>, grid: &Grid, monitor: &Monitor) -> Result<Vec<u16>> {
    let n = mesh.vertices.len();
    let mut codes = Vec::with_capacity(n);
    for start in (0..n).step_by(CHUNK) {
        monitor.check()?;
        let vertices = start..n.min(start + CHUNK);
        codes.extend(vertices.map(|v| grid.code(DVec3::from(mesh.vertices.get(v)))));
    }
    Ok(codes)
}

/// With fewer holes than this a scan of all faces for each is cheaper than sorting them.
const FEW_HOLES: usize = 4;

/// The faces of a neighbourhood by the cells of a coarse grid that their boxes touch.
pub struct FacePlaces {
    grid: Grid,
    /// Where the faces of each cell start in `faces`; empty where all faces are to be scanned.
    start: Vec<u32>,
    faces: Vec<u32>,
}

impl FacePlaces {
    /// Sorts the faces, if that pays for the number of holes.
    pub fn new(near: &Neighbourhood, holes: usize) -> Self {
        if holes < FEW_HOLES {
            return Self { grid: Grid::of(&[]), start: vec![], faces: vec![] };
        }
        let grid = Grid::of(&[Bounds::of(
            (0..near.positions.len() as u32).map(|v| near.positions.get(v)),
        )]);
        let cell: Vec<[u8; 3]> =
            (0..near.positions.len() as u32).map(|v| grid.cell(near.positions.get(v))).collect();
        // That of a face's box: cells do not fall where coordinates rise.
        let range = |face: &[u32; 3]| {
            let [a, b, c] = face.map(|v| cell[v as usize]);
            let least = |d: usize| a[d].min(b[d]).min(c[d]);
            let most = |d: usize| a[d].max(b[d]).max(c[d]);
            match a == b && b == c {
                true => (a, a),
                false => ([0, 1, 2].map(least), [0, 1, 2].map(most)),
            }
        };
        let mut start = vec![0u32; grid.full.len() + 1];
        near.faces.iter().for_each(|face| grid.visit(&range(face), |i| start[i + 1] += 1));
        for i in 1..start.len() {
            start[i] += start[i - 1];
        }
        let mut next = start.clone();
        let mut faces = vec![0; start[start.len() - 1] as usize];
        for (f, face) in near.faces.iter().enumerate() {
            grid.visit(&range(face), |i| {
                faces[next[i] as usize] = f as u32;
                next[i] += 1;
            });
        }
        Self { grid, start, faces }
    }

    /// The faces whose box meets `query`, ascending.
    pub fn meeting(&self, near: &Neighbourhood, query: &Bounds) -> Vec<u32> {
        let meets = |f: &u32| near.face_box(*f).overlaps(query);
        if self.start.is_empty() {
            return (0..near.faces.len() as u32).filter(meets).collect();
        }
        let mut found = Vec::new();
        self.grid.visit(&self.grid.range(query), |i| {
            found.extend(&self.faces[self.start[i] as usize..self.start[i + 1] as usize]);
        });
        found.sort_unstable();
        found.dedup();
        found.retain(meets);
        found
    }
}

/// First and last cell, by axis: there are [`CELLS`] and one at most.
type CellRange = ([u8; 3], [u8; 3]);

/// Which cells of a coarse grid the boxes touch.
pub struct Grid {
    bounds: Bounds,
    /// Cells a unit of length.
    scale: f64,
    /// The last cell of each axis.
    last: DVec3,
    size: [usize; 3],
    full: Vec<bool>,
    boxes: Vec<Bounds>,
}

impl Grid {
    /// Marks the cells of some boxes.
    pub fn of(boxes: &[Bounds]) -> Self {
        Self::new(boxes.iter().copied())
    }

    /// The same for boxes that are made twice rather than kept.
    pub fn new(boxes: impl ExactSizeIterator<Item = Bounds> + Clone) -> Self {
        let bounds = boxes.clone().fold(Bounds::EMPTY, Bounds::union);
        let extent = (bounds.max - bounds.min).max(DVec3::ZERO);
        let cell = (extent.max_element() / CELLS).max(f64::MIN_POSITIVE);
        let size = [0, 1, 2].map(|d| (extent[d] / cell) as usize + 1);
        let last = DVec3::from(size.map(|n| (n - 1) as f64));
        let full = vec![false; size.iter().product()];
        let mut grid = Self { bounds, scale: 1.0 / cell, last, size, full, boxes: vec![] };
        // With few boxes an exact test is cheap and keeps the copy small.
        if boxes.len() <= 4 {
            grid.boxes = boxes.clone().collect();
        }
        for b in boxes {
            let range = grid.range(&b);
            let mut full = std::mem::take(&mut grid.full);
            grid.visit(&range, |i| full[i] = true);
            grid.full = full;
        }
        grid
    }

    /// Calls `f` with each cell of a range.
    #[inline]
    fn visit(&self, &(lo, hi): &CellRange, mut f: impl FnMut(usize)) {
        // Most boxes lie in one cell.
        if lo == hi {
            return f(self.index(lo));
        }
        for z in lo[2]..=hi[2] {
            for y in lo[1]..=hi[1] {
                let row = self.index([0, y, z]);
                (row + usize::from(lo[0])..=row + usize::from(hi[0])).for_each(&mut f);
            }
        }
    }

    /// The number of a cell.
    #[inline]
    fn index(&self, [x, y, z]: [u8; 3]) -> usize {
        (usize::from(z) * self.size[1] + usize::from(y)) * self.size[0] + usize::from(x)
    }

    /// The cell of a point, cut to the grid.
    #[inline]
    fn cell(&self, p: DVec3) -> [u8; 3] {
        let cell = ((p - self.bounds.min) * self.scale).max(DVec3::ZERO).min(self.last);
        [cell.x as u32 as u8, cell.y as u32 as u8, cell.z as u32 as u8]
    }

    /// The cells that a box touches, cut to the grid.
    #[inline]
    fn range(&self, b: &Bounds) -> CellRange {
        (self.cell(b.min), self.cell(b.max))
    }

    /// Where a point lies, as in [`outcodes`].
    #[inline]
    fn code(&self, p: DVec3) -> u16 {
        let sides = p.cmplt(self.bounds.min).bitmask() | p.cmpgt(self.bounds.max).bitmask() << 3;
        if sides != 0 {
            return OUTSIDE | sides as u16;
        }
        let cell = self.index(self.cell(p));
        let in_box = |b: &Bounds| b.contains(&Bounds { min: p, max: p });
        match self.full[cell] {
            false => cell as u16,
            true if self.boxes.is_empty() || self.boxes.iter().any(in_box) => MARKED,
            true => NEAR,
        }
    }

    /// Whether a box touches a marked cell.
    pub fn meets(&self, b: &Bounds) -> bool {
        if !self.bounds.overlaps(b) {
            return false;
        }
        if !self.boxes.is_empty() {
            return self.boxes.iter().any(|x| x.overlaps(b));
        }
        let (lo, hi) = self.range(b);
        if lo == hi {
            return self.full[self.index(lo)];
        }
        (lo[2]..=hi[2]).any(|z| {
            (lo[1]..=hi[1]).any(|y| {
                let row = self.index([0, y, z]);
                let row = &self.full[row + usize::from(lo[0])..=row + usize::from(hi[0])];
                row.iter().any(|&full| full)
            })
        })
    }
}

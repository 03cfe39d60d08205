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

/// Faces near the holes, with vertices of their own numbering.
#[derive(Debug, Default)]
pub struct Neighbourhood {
    /// Input index of each local vertex, ascending.
    pub vertices: Vec<u32>,
    /// Their positions, in mesh units.
    pub positions: Vec<DVec3>,
    /// Local vertices of each face, in input order.
    pub faces: Vec<[u32; 3]>,
    /// Input index of each face.
    pub face_ids: Vec<u32>,
}

impl Neighbourhood {
    /// Copies every face whose box meets one of `boxes`. Two linear passes.
    pub fn gather(mesh: MeshView<'_>, boxes: &[Bounds], monitor: &Monitor) -> Result<Self> {
        let grid = Grid::new(boxes);
        let codes = outcodes(mesh, &grid.bounds);
        monitor.check()?;
        let mut face_ids = Vec::new();
        for f in 0..mesh.faces.len() {
            let face = mesh.faces.get(f).map(|v| v as usize);
            if codes[face[0]] & codes[face[1]] & codes[face[2]] != 0 {
                continue;
            }
            let corners = face.map(|v| DVec3::from(mesh.vertices.get(v)));
            if grid.meets(&Bounds::of(corners)) {
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
        let mut vertices: Vec<u32> = faces.iter().flatten().copied().collect();
        vertices.sort_unstable();
        vertices.dedup();
        let first = vertices.first().copied().unwrap_or(0);
        // A direct table where the indices lie close together, else a search.
        let span = vertices.last().map_or(0, |&l| (l - first) as usize + 1);
        if span <= 64 * vertices.len() + 1024 {
            let mut local = vec![NONE; span];
            vertices.iter().enumerate().for_each(|(i, &v)| local[(v - first) as usize] = i as u32);
            faces.iter_mut().flatten().for_each(|v| *v = local[(*v - first) as usize]);
        } else {
            let find = |v: u32| vertices.partition_point(|&w| w < v) as u32;
            faces.iter_mut().flatten().for_each(|v| *v = find(*v));
        }
        let positions =
            vertices.iter().map(|&v| DVec3::from(mesh.vertices.get(v as usize))).collect();
        Self { vertices, positions, faces, face_ids }
    }

    /// Local index of an input vertex.
    pub fn local(&self, input: u32) -> Option<u32> {
        self.vertices.binary_search(&input).ok().map(|i| i as u32)
    }
}

/// On which sides of the box each vertex lies, a bit a side.
fn outcodes(mesh: MeshView<'_>, bounds: &Bounds) -> Vec<u8> {
    let (min, max) = (bounds.min, bounds.max);
    (0..mesh.vertices.len())
        .map(|v| {
            let p = DVec3::from(mesh.vertices.get(v));
            (p.cmplt(min).bitmask() | p.cmpgt(max).bitmask() << 3) as u8
        })
        .collect()
}

/// Which cells of a coarse grid the boxes touch.
struct Grid {
    bounds: Bounds,
    cell: f64,
    size: [usize; 3],
    full: Vec<bool>,
    boxes: Vec<Bounds>,
}

impl Grid {
    fn new(boxes: &[Bounds]) -> Self {
        let bounds = boxes.iter().fold(Bounds::EMPTY, |a, b| a.union(*b));
        let extent = (bounds.max - bounds.min).max(DVec3::ZERO);
        let cell = (extent.max_element() / CELLS).max(f64::MIN_POSITIVE);
        let size = [0, 1, 2].map(|d| (extent[d] / cell) as usize + 1);
        let mut grid =
            Self { bounds, cell, size, full: vec![false; size.iter().product()], boxes: vec![] };
        for b in boxes {
            let (lo, hi) = grid.range(b);
            for z in lo[2]..=hi[2] {
                for y in lo[1]..=hi[1] {
                    let row = (z * size[1] + y) * size[0];
                    grid.full[row + lo[0]..=row + hi[0]].fill(true);
                }
            }
        }
        // With few boxes an exact test is cheap and keeps the copy small.
        if boxes.len() <= 4 {
            grid.boxes = boxes.to_vec();
        }
        grid
    }

    fn range(&self, b: &Bounds) -> ([usize; 3], [usize; 3]) {
        let index = |p: DVec3| {
            [0, 1, 2].map(|d| {
                let x = ((p[d] - self.bounds.min[d]) / self.cell).max(0.0) as usize;
                x.min(self.size[d] - 1)
            })
        };
        (index(b.min), index(b.max))
    }

    fn meets(&self, b: &Bounds) -> bool {
        if !self.bounds.overlaps(b) {
            return false;
        }
        if !self.boxes.is_empty() {
            return self.boxes.iter().any(|x| x.overlaps(b));
        }
        let (lo, hi) = self.range(b);
        (lo[2]..=hi[2]).any(|z| {
            (lo[1]..=hi[1]).any(|y| {
                let row = (z * self.size[1] + y) * self.size[0];
                self.full[row + lo[0]..=row + hi[0]].iter().any(|&full| full)
            })
        })
    }
}

//! A thinned cloud of the source: one averaged point a cell, so that what is looked at costs the
//! same whatever the density of the mesh.

use super::blocks::Blocks;
use super::source::Source;
use crate::error::Result;
use crate::mesh::neighbourhood::NONE;
use crate::progress::Pace;
use glam::{DMat3, DVec3};
use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};

/// Points with normals, evenly spread, and a tree over them.
pub struct Cloud {
    /// The points.
    pub thinned: Thinned,
    /// Over the points.
    pub blocks: Blocks,
    /// Of the source, see [`SourceMesh::axes`](super::source::SourceMesh::axes).
    pub axes: DMat3,
}

/// Points with normals, evenly spread.
pub struct Thinned {
    /// Mean positions, in mesh units.
    pub points: Vec<DVec3>,
    /// Mean normals, unit length.
    pub normals: Vec<DVec3>,
    /// Mean roughness, see [`SourceMesh::roughness`](super::source::SourceMesh::roughness).
    pub roughness: Vec<f64>,
    /// Mean tints, see [`super::paint`]; `None` without colours.
    pub tints: Option<Vec<f64>>,
    /// The hole that each is completed in; [`NONE`]: it is known. Empty if all are.
    pub completion: Vec<u32>,
}

/// A point of a surface.
#[derive(Clone, Copy)]
pub struct Sample {
    /// In mesh units.
    pub point: DVec3,
    /// Zero: it is left out.
    pub normal: DVec3,
    /// See [`SourceMesh::roughness`](super::source::SourceMesh).
    pub roughness: f64,
    /// See [`super::paint`].
    pub tint: f64,
    /// The hole that it is completed in; [`NONE`]: it is known.
    pub completion: u32,
}

/// Points of a cloud at most, so that small holes in large objects stay affordable.
const MOST_POINTS: f64 = 1.2e5;

impl Cloud {
    /// The spacing that a cloud has when `spacing` is asked for.
    pub fn spacing(source: &Source, spacing: f64) -> f64 {
        spacing.max((source.area / MOST_POINTS).sqrt())
    }

    /// The source at a spacing (or as near to it as may be): its vertices, or points on its faces
    /// where the mesh is coarser than that.
    pub fn of_source(
        source: &Source,
        spacing: f64,
        check: &dyn Fn() -> Result<()>,
    ) -> Result<Self> {
        let spacing = Self::spacing(source, spacing);
        let thinned = match source.edge < spacing {
            true => thin_vertices(source, spacing, check)?,
            false => {
                let grid = Grid::over(source.positions.iter().copied(), spacing, &source.axes);
                thin(face_samples(source, spacing), &grid, check)?
            }
        };
        Self::of_points(thinned.painted(source), source.axes, check)
    }

    /// Over such points, thinned along such axes.
    pub fn of_points(
        thinned: Thinned,
        axes: DMat3,
        check: &dyn Fn() -> Result<()>,
    ) -> Result<Self> {
        let blocks = Blocks::new(&thinned, check)?;
        Ok(Self { thinned, blocks, axes })
    }
}

impl Thinned {
    /// The hole that a point is completed in; [`NONE`]: it is known.
    pub fn completion_of(&self, i: usize) -> u32 {
        self.completion.get(i).copied().unwrap_or(NONE)
    }

    /// Forgets the tints of a source that has none.
    fn painted(self, source: &Source) -> Self {
        Self { tints: self.tints.filter(|_| source.paint.is_some()), ..self }
    }
}

/// Most cells along an axis, in bits.
const CELL_BITS: u32 = 28;
/// Elementary steps that a pass takes for a point.
const POINT: usize = 8;
/// Numbers sorted without a look at the wish to cancel: two milliseconds.
const SORTED_AT_ONCE: usize = 1 << 15;

/// The vertices of a source, thinned.
pub fn thin_vertices(
    source: &Source,
    spacing: f64,
    check: &dyn Fn() -> Result<()>,
) -> Result<Thinned> {
    let ids = source.points.ids().iter().map(|&v| v as usize);
    let grid = Grid::over(ids.clone().map(|i| source.positions[i]), spacing, &source.axes);
    let sample = |i: usize| Sample {
        point: source.positions[i],
        normal: source.normals[i],
        roughness: source.roughness[i],
        tint: source.tint(i),
        completion: if i < source.known_vertices { NONE } else { source.completion[i] },
    };
    thin(ids.map(sample), &grid, check)
}

/// Middles of small triangles that parts of an edge make lie so many parts apart: √(√3 / 4).
const MIDDLES: f64 = 0.658;

/// The middles of k² small triangles of each face, k that of its longest edge: about one a spacing.
fn face_samples(source: &Source, spacing: f64) -> impl Iterator<Item = Sample> + '_ {
    source.faces.iter().enumerate().flat_map(move |(f, face)| {
        let completed = source.is_completion(f as u32);
        let completion = if completed { source.completion[face[0] as usize] } else { NONE };
        let p = face.map(|v| source.positions[v as usize]);
        let n = face.map(|v| source.normals[v as usize]);
        let rough = face.iter().map(|&v| source.roughness[v as usize]).sum::<f64>() / 3.0;
        let tints = face.map(|v| source.tint(v as usize));
        let longest = (0..3).map(|k| p[k].distance(p[(k + 1) % 3])).fold(0.0, f64::max);
        let k = ((MIDDLES * longest / spacing).ceil() as usize).clamp(1, 16);
        let places = (0..k).flat_map(move |i| (0..2 * (k - i) - 1).map(move |j| (i, j)));
        places.map(move |(i, j)| {
            let step = 1.0 / k as f64;
            let third = if j % 2 == 0 { 1.0 / 3.0 } else { 2.0 / 3.0 };
            let (a, b) = ((i as f64 + third) * step, ((j / 2) as f64 + third) * step);
            let c = 1.0 - a - b;
            let point = a * p[0] + b * p[1] + c * p[2];
            let tint = a * tints[0] + b * tints[1] + c * tints[2];
            let normal = a * n[0] + b * n[1] + c * n[2];
            Sample { point, normal, roughness: rough, tint, completion }
        })
    })
}

/// What the samples of a cell add up to.
struct Sum {
    point: DVec3,
    normal: DVec3,
    roughness: f64,
    tint: f64,
    completion: u32,
    count: f64,
}

/// Cubic cells.
pub struct Grid {
    /// Turns their axes to those of the coordinates.
    along: DMat3,
    /// Where they begin, along their axes.
    low: DVec3,
    /// Their width, in mesh units.
    spacing: f64,
}

impl Grid {
    /// Along such axes over all of some points.
    pub fn over(points: impl Iterator<Item = DVec3>, spacing: f64, axes: &DMat3) -> Self {
        let along = axes.transpose();
        Self { along, low: points.fold(DVec3::INFINITY, |low, p| low.min(along * p)), spacing }
    }
}

/// One point for each cell of a grid over them, and each octant of the normal: the
/// two sides of a thin wall are not averaged. Points without a normal are left out, as are those of a
/// completion in a cell that has known ones.
pub fn thin(
    points: impl Iterator<Item = Sample>,
    grid: &Grid,
    check: &dyn Fn() -> Result<()>,
) -> Result<Thinned> {
    let &Grid { along, low, spacing } = grid;
    let mut pace = Pace::new(check);
    // Summed up as they come: there are many times more samples than cells.
    let mut place: HashMap<u128, u32, BuildHasherDefault<CellHasher>> = HashMap::default();
    let mut sums: Vec<Sum> = Vec::new();
    let mut cells: Vec<u128> = Vec::new();
    for sample in points.filter(|p| p.normal != DVec3::ZERO) {
        pace.work(POINT)?;
        let Sample { point: p, normal: n, roughness, tint, completion } = sample;
        let cell = ((along * p - low) / spacing).to_array().map(|x| x as u32);
        let at = |key: u128, x: u32| key << CELL_BITS | u128::from(x.min((1 << CELL_BITS) - 1));
        let octant = (along * n).cmplt(DVec3::ZERO).bitmask();
        let key = cell.into_iter().fold(0, at) << 3 | u128::from(octant);
        let i = *place.entry(key).or_insert(sums.len() as u32) as usize;
        if i == sums.len() {
            cells.push(key << 32 | i as u128);
            sums.push(Sum { point: p, normal: n, roughness, tint, completion, count: 1.0 });
            continue;
        }
        let sum = &mut sums[i];
        if sum.completion != completion {
            if completion == NONE {
                *sum = Sum { point: p, normal: n, roughness, tint, completion, count: 1.0 };
            }
            continue;
        }
        sum.point += p;
        sum.normal += n;
        sum.roughness += roughness;
        sum.tint += tint;
        sum.count += 1.0;
    }
    sort_checked(&mut cells, check)?;
    let in_order = || cells.iter().map(|&c| &sums[c as u32 as usize]);
    check()?;
    Ok(Thinned {
        points: in_order().map(|s| s.point / s.count).collect(),
        normals: in_order().map(|s| s.normal.normalize_or_zero()).collect(),
        roughness: in_order().map(|s| s.roughness / s.count).collect(),
        tints: Some(in_order().map(|s| s.tint / s.count).collect()),
        completion: match in_order().all(|s| s.completion == NONE) {
            true => Vec::new(),
            false => in_order().map(|s| s.completion).collect(),
        },
    })
}

/// Keys are cells, millions of them: multiplications by the golden ratio spread them well enough.
/// (Knuth, "The art of computer programming", vol. 3, sec. 6.4.)
#[derive(Default)]
struct CellHasher(u64);

impl Hasher for CellHasher {
    fn finish(&self) -> u64 {
        self.0
    }

    fn write(&mut self, bytes: &[u8]) {
        bytes.iter().for_each(|&b| self.write_u128(u128::from(b)));
    }

    fn write_u128(&mut self, x: u128) {
        const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;
        let low = (x as u64 ^ self.0).wrapping_mul(GOLDEN);
        let both = ((x >> 64) as u64 ^ low.rotate_left(32)).wrapping_mul(GOLDEN);
        self.0 = both ^ both >> 32;
    }
}

/// Sorts different numbers; asks `check` between the parts.
fn sort_checked(all: &mut [u128], check: &dyn Fn() -> Result<()>) -> Result<()> {
    if all.len() <= SORTED_AT_ONCE {
        all.sort_unstable();
        return Ok(());
    }
    check()?;
    let middle = all.len() / 2;
    all.select_nth_unstable(middle);
    let (low, high) = all.split_at_mut(middle);
    sort_checked(low, check)?;
    sort_checked(high, check)
}

#[cfg(test)]
pub(super) mod tests {
    use super::super::point_tree::PointTree;
    use super::super::source::tests::{hills, hilly_source};
    use super::*;

    /// A known point without a tint.
    pub(crate) fn known(point: DVec3, normal: DVec3, roughness: f64) -> Sample {
        Sample { point, normal, roughness, tint: 0.0, completion: NONE }
    }

    /// Coarser and finer than the mesh the points lie on the hills, and no farther from any place
    /// than the spacing lets expect.
    #[test]
    fn a_cloud_covers_the_surface_at_its_spacing() {
        let source = hilly_source(60);
        for spacing in [0.15, 0.02] {
            let cloud = Cloud::of_source(&source, spacing, &|| Ok(())).unwrap();
            let wanted = source.area / (spacing * spacing);
            let Thinned { points, normals, .. } = &cloud.thinned;
            let ratio = points.len() as f64 / wanted;
            assert!((0.7..2.5).contains(&ratio), "{ratio}");
            for (p, n) in points.iter().zip(normals) {
                let (q, m) = hills(p.x, p.y);
                let off = (p.z - q.z).abs() / spacing;
                // A cell cut across its diagonal is as wide as √3.
                assert!(off < 0.3 && n.dot(m) > 0.98, "{p} {off} {}", n.dot(m));
            }
            let tree = PointTree::of_all(points, &|| Ok(())).unwrap();
            for p in &source.positions {
                let (_, d2) = tree.nearest(*p).unwrap();
                assert!(d2.sqrt() < 1.5 * spacing, "{p}");
            }
        }
    }

    #[test]
    fn sides_of_a_wall_stay_apart_and_points_without_normal_go() {
        let points = [(0.01, 1.0), (0.02, 1.0), (0.03, -1.0), (0.04, 0.0)]
            .map(|(z, n)| known(DVec3::new(0.0, 0.0, z), DVec3::Z * n, z));
        let grid = Grid::over(points.iter().map(|p| p.point), 1.0, &DMat3::IDENTITY);
        let cloud = thin(points.into_iter(), &grid, &|| Ok(())).unwrap();
        assert_eq!(cloud.points.len(), 2);
        let up = cloud.normals.iter().position(|n| n.z > 0.0).unwrap();
        assert!((cloud.points[up].z - 0.015).abs() < 1e-12);
        assert!((cloud.roughness[up] - 0.015).abs() < 1e-12);
        assert_eq!(cloud.points[1 - up].z, 0.03);
    }
}

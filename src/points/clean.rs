//! Which points the surface goes through: no missing ones, no doubles, no outliers.
//!
//! Nothing is taken out of the cloud: the others are only not looked at when holes are searched and
//! filled.

use super::boundary::widest_gap;
use super::neighbours::{Neighbours, COUNT};
use super::normals::principal_axes;
use crate::error::{Error, Result};
use crate::mesh::VertexView;
use crate::progress::Monitor;
use glam::DVec3;

/// Nearer than this many spacings to an earlier point, a point counts as its double: it says nothing
/// new and spoils the triangles. Own choice; a regular cloud has none.
const DOUBLE: f64 = 0.25;
/// A point whose neighbours are so many times farther away than theirs lies alone. Rims of holes
/// reach 1.8 on even clouds, corners of thin strips 2.2.
const ALONE: f64 = 2.5;
/// A point whose neighbours are so many times farther away than theirs may lie in a sparse place: rims of
/// holes, where a half-disc gives the neighbours, reach that.
const WIDE: f64 = 1.8;
/// It does if no angle between its neighbours is as wide as this (on a rim it is half a turn) ...
const AROUND: f64 = 2.0 * std::f64::consts::FRAC_PI_3;
/// ... and it is no farther off their plane than this share of their distance, as on a surface that turns
/// by 30° on the way. An outlier is as far off as they are.
const FLAT: f64 = 0.3;
/// A point this many spacings off the plane of its neighbours, ...
const OFF: f64 = 0.7;
/// ... and so many times as far as its neighbours are off theirs, lies beside the surface.
const OFF_RATIO: f64 = 4.0;

/// The points that the surface goes through.
pub struct Cleaned {
    /// Their indices in the input, ascending.
    pub ids: Vec<u32>,
    /// Their positions, in cloud units.
    pub points: Vec<DVec3>,
    /// The nearest neighbours among them.
    pub neighbours: Neighbours,
    /// The spacing around each, in cloud units.
    pub spacing: Vec<f64>,
    /// Input points without coordinates: all three NaN, as scanners write where they saw nothing.
    pub missing: Vec<u32>,
    /// Input points at, or next to, the place of an earlier one.
    pub doubles: Vec<u32>,
    /// Input points beside the surface.
    pub outliers: Vec<u32>,
}

/// Sorts the points of a cloud out. Fewer than four, or all on one line, are an error.
pub fn clean(cloud: VertexView<'_>, threads: usize, monitor: &Monitor) -> Result<Cleaned> {
    let (mut ids, mut points, missing) = finite(cloud)?;
    let mut doubles = take_equal(&mut ids, &mut points);
    check_shape(&points)?;
    let mut neighbours = Neighbours::new(&points, threads, monitor)?;
    let near = find_doubles(&points, &neighbours);
    doubles.extend(drop_points(&mut ids, &mut points, &near));
    doubles.sort_unstable();
    if near.contains(&false) {
        neighbours = Neighbours::new(&points, threads, monitor)?;
    }
    let mut outliers = Vec::new();
    // Those that lie alone first: they pull the planes of the others.
    for find in [find_lonely, find_off_plane] {
        monitor.check()?;
        let kept = find(&points, &neighbours);
        outliers.extend(drop_points(&mut ids, &mut points, &kept));
        neighbours = neighbours.thinned(&kept);
    }
    outliers.sort_unstable();
    check_shape(&points)?;
    if outliers.len() * COUNT > points.len() {
        neighbours = Neighbours::new(&points, threads, monitor)?;
    }
    let reach = neighbours.reach(&points);
    let spacing = neighbours.spacing(&reach, &find_sparse(&points, &neighbours, &reach));
    Ok(Cleaned { ids, points, neighbours, spacing, missing, doubles, outliers })
}

type Finite = (Vec<u32>, Vec<DVec3>, Vec<u32>);

fn finite(cloud: VertexView<'_>) -> Result<Finite> {
    let limit = u32::MAX as usize - 1;
    if cloud.len() > limit {
        return Err(Error::TooLarge { what: "points", count: cloud.len(), limit });
    }
    let (mut ids, mut points) = (Vec::with_capacity(cloud.len()), Vec::with_capacity(cloud.len()));
    let mut missing = Vec::new();
    for i in 0..cloud.len() {
        let p = DVec3::from(cloud.get(i));
        if p.length_squared().is_finite() {
            ids.push(i as u32);
            points.push(p);
        } else if p.to_array().iter().all(|x| x.is_nan()) {
            missing.push(i as u32);
        } else {
            return Err(Error::NonFinitePoint { point: i });
        }
    }
    Ok((ids, points, missing))
}

/// Takes out all but the first of the points at one place; returns them.
fn take_equal(ids: &mut Vec<u32>, points: &mut Vec<DVec3>) -> Vec<u32> {
    let key = |p: &DVec3| p.to_array().map(|x| (x + 0.0).to_bits());
    let mut order: Vec<u32> = (0..points.len() as u32).collect();
    order.sort_unstable_by_key(|&i| (key(&points[i as usize]), i));
    let mut kept = vec![true; points.len()];
    for pair in order.windows(2) {
        let [a, b] = [pair[0], pair[1]].map(|i| i as usize);
        kept[b] = key(&points[a]) != key(&points[b]);
    }
    drop_points(ids, points, &kept)
}

/// Drops the points that are not kept and returns their input indices.
fn drop_points(ids: &mut Vec<u32>, points: &mut Vec<DVec3>, kept: &[bool]) -> Vec<u32> {
    let dropped = ids.iter().zip(kept).filter(|k| !k.1).map(|k| *k.0).collect();
    let mut keep = kept.iter();
    ids.retain(|_| keep.next() == Some(&true));
    let mut keep = kept.iter();
    points.retain(|_| keep.next() == Some(&true));
    dropped
}

/// A surface takes four points that are not on one line.
fn check_shape(points: &[DVec3]) -> Result<()> {
    if points.len() < 4 {
        return Err(Error::TooFewPoints { count: points.len() });
    }
    let far = |from: DVec3| {
        let d = |p: &DVec3| p.distance_squared(from);
        points.iter().copied().max_by(|a, b| d(a).total_cmp(&d(b))).unwrap_or(from)
    };
    let a = far(points[0]);
    let b = far(a);
    let along = b - a;
    let aside = |p: &DVec3| (*p - a).cross(along).length() / along.length_squared();
    // A millionth of the length is rounding.
    if points.iter().all(|p| aside(p) < 1e-6) {
        return Err(Error::PointsOnALine { count: points.len() });
    }
    Ok(())
}

fn find_doubles(points: &[DVec3], neighbours: &Neighbours) -> Vec<bool> {
    let reach = neighbours.reach(points);
    let mut kept = vec![true; points.len()];
    for i in 0..points.len() {
        let near = neighbours.of(i).iter().map(|&q| q as usize);
        kept[i] = !near
            .filter(|&q| q < i && kept[q])
            .any(|q| points[q].distance(points[i]) < DOUBLE * reach[i].min(reach[q]));
    }
    kept
}

fn middle(mut all: Vec<f64>) -> f64 {
    let half = all.len() / 2;
    if all.is_empty() {
        return 0.0;
    }
    *all.select_nth_unstable_by(half, f64::total_cmp).1
}

/// How many times farther away a point's neighbours are than theirs.
fn loneliness(neighbours: &Neighbours, reach: &[f64], i: usize) -> f64 {
    let near = neighbours.of(i).iter().map(|&q| reach[q as usize]).collect();
    reach[i] / middle(near).max(f64::MIN_POSITIVE)
}

fn find_lonely(points: &[DVec3], neighbours: &Neighbours) -> Vec<bool> {
    let reach = neighbours.reach(points);
    let sparse = find_sparse(points, neighbours, &reach);
    let lonely = |i: usize| !sparse[i] && loneliness(neighbours, &reach, i) > ALONE;
    (0..points.len()).map(|i| !lonely(i)).collect()
}

/// The points in the midst of sparse places: few, but on the surface, and with neighbours all around.
fn find_sparse(points: &[DVec3], neighbours: &Neighbours, reach: &[f64]) -> Vec<bool> {
    let wide = |i: usize| loneliness(neighbours, reach, i) > WIDE;
    let mut sparse: Vec<bool> = (0..points.len()).map(wide).collect();
    // Those on the other side of the place name it, but are not among its nearest.
    let named_by = neighbours.named_by(&sparse);
    for i in 0..points.len() {
        if !sparse[i] {
            continue;
        }
        let more = named_by.get(&(i as u32)).map_or(&[][..], |m| m);
        let near = neighbours.of(i).iter().chain(more).map(|&q| points[q as usize] - points[i]);
        let count = near.clone().count() as f64;
        let normal = principal_axes(near.clone().map(|d| (d, 1.0))).normal;
        let x = normal.any_orthonormal_vector();
        let y = normal.cross(x);
        let off = near.clone().sum::<DVec3>().dot(normal).abs() / count;
        let angles = near.map(|d| d.dot(y).atan2(d.dot(x))).collect();
        sparse[i] = off < FLAT * reach[i] && widest_gap(angles) < AROUND;
    }
    sparse
}

fn find_off_plane(points: &[DVec3], neighbours: &Neighbours) -> Vec<bool> {
    let reach = neighbours.reach(points);
    let spacing = neighbours.spacing(&reach, &find_sparse(points, neighbours, &reach));
    let off: Vec<f64> = (0..points.len())
        .map(|i| {
            let near = neighbours.of(i).iter().take(12).map(|&q| (points[q as usize], 1.0));
            let count = near.clone().count().max(1) as f64;
            let centre = near.clone().map(|p| p.0).sum::<DVec3>() / count;
            let normal = principal_axes(near).normal;
            normal.dot(points[i] - centre).abs()
        })
        .collect();
    let beside = |i: usize| {
        let near = neighbours.of(i).iter().map(|&q| off[q as usize]).collect();
        off[i] > OFF * spacing[i] && off[i] > OFF_RATIO * middle(near)
    };
    (0..points.len()).map(|i| !beside(i)).collect()
}

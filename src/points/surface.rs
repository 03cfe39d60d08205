//! Gopi, Krishnan and Silva (2000), "Surface reconstruction based on lower dimensional localized
//! Delaunay triangulation": a mesh through the points, open where there are none.
//!
//! Differences from the paper:
//! - Stars that do not agree are not left open: triangles that only two or one of their corners'
//!   stars hold are added, the smaller circumcircles first, wherever they overlap nothing.
//! - A triangle's circumcircle is limited by the spacing, not by the projection's distortion: what is
//!   larger is a gap.
//! - Neighbours are turned into the tangent plane, not projected: distances stay what they are.

use super::neighbours::{blocks, Neighbours};
use crate::error::Result;
use crate::progress::Monitor;
use glam::{DVec2, DVec3};

/// Greatest circumradius of a triangle, in spacings: a hexagonal lattice has 0.58, a square one
/// 0.71, one point missing makes 1.
pub const RADIUS: f64 = 1.15;
/// No neighbour.
const NONE: u32 = u32::MAX;
/// Sine of the angle between a neighbour's direction and the normal below which it is not looked at:
/// 10°, Bendels et al. 2005, Sec. 6.1.
const STEEP: f64 = 0.17;

/// Triangles over points, with the triangles at each point.
pub struct Surface<'a> {
    /// The positions.
    pub points: &'a [DVec3],
    /// Unit normals.
    pub normals: &'a [DVec3],
    /// Corners, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Triangles that are dropped: they hang on no point any more.
    pub dropped: Vec<bool>,
    /// The last triangle added at each point, and for each corner of a triangle the one before.
    heads: Vec<u32>,
    before: Vec<[u32; 3]>,
}

/// A triangle that a point's star holds: the corners from the smallest on, the bits of its
/// circumradius.
type Proposal = ([u32; 3], u32);

/// The surface through the points.
pub fn surface<'a>(
    points: &'a [DVec3],
    normals: &'a [DVec3],
    neighbours: &Neighbours,
    spacing: &[f64],
    threads: usize,
    monitor: &Monitor,
) -> Result<Surface<'a>> {
    let jittered: Vec<DVec3> =
        points.iter().enumerate().map(|(i, p)| *p + jitter(i) * spacing[i]).collect();
    let proposals = proposals(&jittered, normals, neighbours, spacing, threads, monitor)?;
    let mut surface = Surface::new(points, normals, proposals.len() / 3);
    let mut votes: Vec<(u32, u32, [u32; 3])> = Vec::new();
    for same in proposals.chunk_by(|a, b| a.0 == b.0) {
        // What all three stars hold overlaps nothing else of the kind: each star is a fan.
        match same.len() {
            3.. => surface.add(same[0].0),
            n => votes.push((3 - n as u32, same[0].1, same[0].0)),
        }
    }
    drop(proposals);
    votes.sort_unstable();
    for (_, _, corners) in votes {
        if surface.has_room(corners) {
            surface.add(corners);
        }
    }
    Ok(surface)
}

/// A step of at most a thousandth of the spacing, always the same for a point: of four points on
/// one circle, as on every grid, all stars then take the same diagonal.
fn jitter(i: usize) -> DVec3 {
    let mut x = (i as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let mut next = || {
        x ^= x >> 31;
        x = x.wrapping_mul(0xbf58_476d_1ce4_e5b9);
        (x >> 40) as f64 / f64::from(1 << 24) - 0.5
    };
    DVec3::new(next(), next(), next()) * 2e-3
}

fn proposals(
    points: &[DVec3],
    normals: &[DVec3],
    neighbours: &Neighbours,
    spacing: &[f64],
    threads: usize,
    monitor: &Monitor,
) -> Result<Vec<Proposal>> {
    // A handful a point: blocks of them, not a list for each.
    const BLOCK: usize = 4096;
    let made = blocks(points.len().div_ceil(BLOCK), threads, monitor, &|b| {
        let (mut out, mut star) = (Vec::new(), Star::default());
        for i in b * BLOCK..points.len().min((b + 1) * BLOCK) {
            let near = neighbours.of(i);
            let widest = near.iter().map(|&q| spacing[q as usize]).fold(spacing[i], f64::max);
            star.around(points, normals, near, i, RADIUS * widest);
            star.triangles(i as u32, spacing, &mut out);
        }
        out
    })?;
    let mut all = Vec::with_capacity(made.iter().map(Vec::len).sum());
    made.into_iter().for_each(|m| all.extend(m));
    all.sort_unstable();
    Ok(all)
}

/// The Voronoi cell of a point among its neighbours in the tangent plane.
#[derive(Default)]
struct Star {
    /// Corners of the cell, counter-clockwise, each with the neighbour whose side starts there.
    cell: Vec<(DVec2, u32)>,
    cut: Vec<(DVec2, u32)>,
}

impl Star {
    fn around(&mut self, points: &[DVec3], normals: &[DVec3], near: &[u32], i: usize, radius: f64) {
        let (p, n) = (points[i], normals[i]);
        let x = n.any_orthonormal_vector();
        let y = n.cross(x);
        let far = 2.0 * radius;
        let box_ = [(1.0, -1.0), (1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0)];
        self.cell.clear();
        self.cell.extend(box_.map(|(a, b)| (DVec2::new(a * far, b * far), NONE)));
        for &q in near {
            let d = points[q as usize] - p;
            let length = d.length();
            if length > 2.0 * radius || normals[q as usize].dot(n) < 0.0 {
                continue;
            }
            let flat = DVec2::new(d.dot(x), d.dot(y));
            if flat.length() > STEEP * length {
                self.clip(flat.normalize() * length, q);
            }
        }
    }

    /// Cuts off what is nearer to `q`.
    fn clip(&mut self, q: DVec2, id: u32) {
        let half = 0.5 * q.length_squared();
        let beyond = |v: DVec2| v.dot(q) - half;
        if self.cell.iter().all(|c| beyond(c.0) <= 0.0) {
            return;
        }
        self.cut.clear();
        let count = self.cell.len();
        for k in 0..count {
            let ((v, side), (w, _)) = (self.cell[k], self.cell[(k + 1) % count]);
            let (a, b) = (beyond(v), beyond(w));
            if a <= 0.0 {
                self.cut.push((v, side));
            }
            if (a <= 0.0) != (b <= 0.0) {
                let at = v + (w - v) * (a / (a - b));
                // Leaving: the new side starts here. Coming back: the old one goes on.
                self.cut.push((at, if a <= 0.0 { id } else { side }));
            }
        }
        std::mem::swap(&mut self.cell, &mut self.cut);
    }

    /// The triangles of the cell's corners that are near enough.
    fn triangles(&self, i: u32, spacing: &[f64], out: &mut Vec<Proposal>) {
        let count = self.cell.len();
        for k in 0..count {
            let (a, (corner, b)) = (self.cell[(k + count - 1) % count].1, self.cell[k]);
            let size = corner.length();
            if a == NONE || b == NONE || a == b {
                continue;
            }
            // The widest spacing counts, or none would lead over to a sparse region.
            let widest = [i, a, b].map(|v| spacing[v as usize]).into_iter().fold(0.0, f64::max);
            if size <= RADIUS * widest {
                out.push((from_smallest([i, a, b]), (size as f32).to_bits()));
            }
        }
    }
}

/// The same triangle, its smallest corner first.
pub fn from_smallest([a, b, c]: [u32; 3]) -> [u32; 3] {
    if a < b && a < c {
        [a, b, c]
    } else if b < c {
        [b, c, a]
    } else {
        [c, a, b]
    }
}

impl<'a> Surface<'a> {
    /// Without triangles.
    pub fn new(points: &'a [DVec3], normals: &'a [DVec3], expected: usize) -> Self {
        Self {
            points,
            normals,
            triangles: Vec::with_capacity(expected),
            dropped: Vec::with_capacity(expected),
            heads: vec![NONE; points.len()],
            before: Vec::with_capacity(expected),
        }
    }

    /// Adds a triangle.
    pub fn add(&mut self, corners: [u32; 3]) {
        let t = self.triangles.len() as u32;
        let before = corners.map(|v| std::mem::replace(&mut self.heads[v as usize], t));
        self.triangles.push(corners);
        self.before.push(before);
        self.dropped.push(false);
    }

    /// The triangles at a point that are not dropped, each with the place of the point in it.
    pub fn at(&self, v: u32) -> impl Iterator<Item = (u32, usize)> + '_ {
        let mut t = self.heads[v as usize];
        std::iter::from_fn(move || {
            if t == NONE {
                return None;
            }
            let here = t;
            let k = self.triangles[t as usize].iter().position(|&c| c == v)?;
            t = self.before[t as usize][k];
            Some((here, k))
        })
        .filter(|&(t, _)| !self.dropped[t as usize])
    }

    /// The two other corners of a triangle at a point, counter-clockwise.
    pub fn others(&self, (t, k): (u32, usize)) -> [u32; 2] {
        let corners = self.triangles[t as usize];
        [corners[(k + 1) % 3], corners[(k + 2) % 3]]
    }

    /// The direction of a point seen from `v`, in v's tangent plane.
    pub fn angle(&self, v: u32, to: u32) -> f64 {
        let n = self.normals[v as usize];
        let x = n.any_orthonormal_vector();
        let d = self.points[to as usize] - self.points[v as usize];
        d.dot(n.cross(x)).atan2(d.dot(x))
    }

    /// Whether a triangle overlaps none of those at its corners.
    pub fn has_room(&self, corners: [u32; 3]) -> bool {
        (0..3).all(|k| {
            let (v, a, b) = (corners[k], corners[(k + 1) % 3], corners[(k + 2) % 3]);
            let start = self.angle(v, a);
            let width = turn(self.angle(v, b) - start);
            if width >= std::f64::consts::PI {
                return false;
            }
            self.at(v).all(|s| {
                let [c, d] = self.others(s);
                if a == c || b == d {
                    return false;
                }
                let (from, to) = (self.angle(v, c), self.angle(v, d));
                let other = turn(to - from);
                // A shared ray is no overlap, but the rest may be.
                let a_inside = a != d && turn(start - from) < other;
                let c_inside = c != b && turn(from - start) < width;
                !a_inside && !c_inside
            })
        })
    }
}

/// An angle from 0 to 2π.
pub fn turn(angle: f64) -> f64 {
    angle.rem_euclid(std::f64::consts::TAU)
}

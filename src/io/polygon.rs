//! Polygon faces as triangles, for the analysis only: the file keeps its polygons.
//!
//! Ear clipping (Meisters 1975) in the polygon's mean plane (Newell's normal). Own code, because
//! the crates for it (`earcut`, `earcutr`) drop collinear and repeated corners; an edge dropped
//! here would look like a hole in the mesh. A polygon of n corners always gives n - 2 triangles.

use crate::mesh::FaceView;
use std::collections::VecDeque;

/// The most corners a polygon may have. Ear clipping is quadratic: twice as many took 2 to 11 s
/// (a star, a spiral, a comb, noise; release build, one core that others used, too).
pub(super) const MAX_CORNERS: usize = 1 << 15;

/// Triangles in file order, and which of them are parts of one polygon.
#[derive(Debug, Default, Clone, PartialEq)]
pub(super) struct Triangles {
    pub faces: Vec<[u32; 3]>,
    polygons: Vec<Polygon>,
    /// How many faces of the file these are.
    face_count: usize,
}

/// A face with more than three corners.
#[derive(Debug, Clone, PartialEq)]
struct Polygon {
    /// Its first triangle.
    first: usize,
    /// Its corners; it has two triangles fewer.
    corners: usize,
    /// Which face of the file it is.
    face: usize,
}

impl Triangles {
    /// Adds a face of at least 3 corners. Larger ones are put down as a fan, which keeps the
    /// corners in order, until [`Triangles::cut_polygons`] knows the positions.
    pub fn push(&mut self, corners: &[u32]) {
        if corners.len() > 3 {
            let (first, face) = (self.faces.len(), self.face_count);
            self.polygons.push(Polygon { first, corners: corners.len(), face });
        }
        self.face_count += 1;
        if let &[a, b, c] = corners {
            return self.faces.push([a, b, c]);
        }
        self.faces.extend(corners[1..].windows(2).map(|e| [corners[0], e[0], e[1]]));
    }

    pub fn view(&self) -> FaceView<'_> {
        self.faces.as_slice().into()
    }

    /// Replaces the fans by ear clipping.
    pub fn cut_polygons(&mut self, position: impl Fn(u32) -> [f64; 3]) {
        let (mut corners, mut points) = (Vec::new(), Vec::new());
        for polygon in &self.polygons {
            let fan = &mut self.faces[polygon.first..polygon.first + polygon.corners - 2];
            corners.clear();
            corners.extend([fan[0][0], fan[0][1]]);
            corners.extend(fan.iter().map(|t| t[2]));
            points.clear();
            points.extend(corners.iter().map(|&v| position(v)));
            for (triangle, ear) in fan.iter_mut().zip(clip_ears(&project(&points))) {
                *triangle = ear.map(|c| corners[c]);
            }
        }
    }

    /// The face of the file that triangle `t` is (part of).
    pub fn face_of(&self, t: usize) -> usize {
        let after = self.polygons.partition_point(|p| p.first <= t);
        let Some(p) = after.checked_sub(1).map(|i| &self.polygons[i]) else { return t };
        p.face + (t - p.first + 1).saturating_sub(p.corners - 2)
    }
}

/// The points in their mean plane, anticlockwise.
fn project(points: &[[f64; 3]]) -> Vec<[f64; 2]> {
    let o = points[0];
    let mut normal = [0.0; 3];
    for (i, p) in points.iter().enumerate() {
        let q = points[(i + 1) % points.len()];
        for k in 0..3 {
            let (a, b) = ((k + 1) % 3, (k + 2) % 3);
            normal[k] += (p[a] - o[a]) * (q[b] - o[b]) - (p[b] - o[b]) * (q[a] - o[a]);
        }
    }
    // Dropping the coordinate along which the normal is longest is an affine map of the plane, so
    // it keeps which corners are convex and which triangle contains which point.
    let k = (0..3).fold(0, |m, k| if normal[k].abs() > normal[m].abs() { k } else { m });
    let (a, b) = ((k + 1) % 3, (k + 2) % 3);
    let swap = normal[k] < 0.0;
    points.iter().map(|p| if swap { [p[b], p[a]] } else { [p[a], p[b]] }).collect()
}

fn turn(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    let coord = |p: [f64; 2]| robust::Coord { x: p[0], y: p[1] };
    robust::orient2d(coord(a), coord(b), coord(c))
}

/// Triangles (corner indices) of an anticlockwise polygon, exactly `points.len() - 2` of them.
fn clip_ears(points: &[[f64; 2]]) -> Vec<[usize; 3]> {
    let n = points.len();
    let mut ring = Ring {
        points,
        next: (0..n).map(|i| (i + 1) % n).collect(),
        previous: (0..n).map(|i| (i + n - 1) % n).collect(),
        reflex: Vec::new(),
    };
    ring.reflex = (0..n).filter(|&i| !ring.is_convex(i)).collect();
    let mut triangles = Vec::with_capacity(n - 2);
    // Each corner is tried once, and again when a neighbour goes: nothing else can make it an
    // ear. Every other corner first, which avoids a fan of slivers.
    let mut queue: VecDeque<usize> = (0..n).step_by(2).chain((1..n).step_by(2)).collect();
    let (mut at, mut missed) = (0, 0);
    while triangles.len() + 3 < n {
        let Some(i) = queue.pop_front() else {
            // No ear: the outline crosses itself. Any convex corner will do then, and at last any
            // corner at all, so that every edge is still covered.
            missed += 1;
            queue.extend(ring.corners_from(at));
            continue;
        };
        let take = match missed {
            _ if ring.next[i] == GONE => false,
            0 => ring.is_ear(i),
            1 => ring.is_convex(i),
            _ => true,
        };
        if take {
            let ear = ring.cut(i);
            triangles.push(ear);
            at = ear[0];
            queue.extend([ear[0], ear[2]]);
        }
    }
    triangles.push([ring.previous[at], at, ring.next[at]]);
    triangles
}

/// The mark in `Ring::next` of a corner that was cut off.
const GONE: usize = usize::MAX;

/// What is left of the polygon.
struct Ring<'a> {
    points: &'a [[f64; 2]],
    next: Vec<usize>,
    previous: Vec<usize>,
    /// The corners that turn the wrong way or not at all: only they can lie in an ear.
    reflex: Vec<usize>,
}

impl Ring<'_> {
    fn corners_from(&self, first: usize) -> Vec<usize> {
        let rest = std::iter::successors(Some(self.next[first]), |&i| Some(self.next[i]));
        std::iter::once(first).chain(rest.take_while(|&i| i != first)).collect()
    }

    fn is_convex(&self, i: usize) -> bool {
        turn(self.points[self.previous[i]], self.points[i], self.points[self.next[i]]) > 0.0
    }

    fn is_ear(&self, i: usize) -> bool {
        let [a, b, c] = [self.previous[i], i, self.next[i]].map(|k| self.points[k]);
        let low = [0, 1].map(|k| a[k].min(b[k]).min(c[k]));
        let high = [0, 1].map(|k| a[k].max(b[k]).max(c[k]));
        let inside = |&r: &usize| {
            let p = self.points[r];
            let near = p[0] >= low[0] && p[0] <= high[0] && p[1] >= low[1] && p[1] <= high[1];
            // A corner in the same place as one of the ear's (a slit, a bridge to an inner ring)
            // does not block it.
            near && ![a, b, c].contains(&p)
                && turn(a, b, p) >= 0.0
                && turn(b, c, p) >= 0.0
                && turn(c, a, p) >= 0.0
        };
        self.is_convex(i) && !self.reflex.iter().any(inside)
    }

    fn cut(&mut self, i: usize) -> [usize; 3] {
        let (before, after) = (self.previous[i], self.next[i]);
        self.next[before] = after;
        self.previous[after] = before;
        self.next[i] = GONE;
        for k in [before, after] {
            if self.is_convex(k) {
                self.reflex.retain(|&r| r != k);
            }
        }
        self.reflex.retain(|&r| r != i);
        [before, i, after]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cut(points: &[[f64; 3]]) -> Vec<[u32; 3]> {
        let mut t = Triangles::default();
        t.push(&(0..points.len() as u32).collect::<Vec<_>>());
        t.cut_polygons(|v| points[v as usize]);
        t.faces
    }

    fn area(points: &[[f64; 3]], t: [u32; 3]) -> f64 {
        let [a, b, c] = t.map(|v| points[v as usize]);
        0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))
    }

    #[test]
    fn concave_quad_is_cut_through_its_reflex_corner() {
        // A dart: a fan from corner 0 would leave the outline.
        let dart = [[2.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.5, 0.0, 0.0], [0.0, -1.0, 0.0]];
        let faces = cut(&dart);
        assert!(faces.iter().all(|&t| area(&dart, t) > 0.0 && t.contains(&0) && t.contains(&2)));
    }

    #[test]
    fn collinear_corners_keep_their_edges() {
        // A square with a corner in the middle of a side: that side's two halves must both be
        // triangle edges, or a crack would be seen there.
        let p = [[0., 0., 0.], [1., 0., 0.], [2., 0., 0.], [2., 2., 0.], [0., 2., 0.]];
        let faces = cut(&p);
        assert_eq!(faces.len(), 3);
        for i in 0..5u32 {
            let edge = [i, (i + 1) % 5];
            let used = faces.iter().any(|t| (0..3).any(|k| [t[k], t[(k + 1) % 3]] == edge));
            assert!(used, "outline edge {edge:?} is missing in {faces:?}");
        }
        assert!((faces.iter().map(|&t| area(&p, t)).sum::<f64>() - 4.0).abs() < 1e-12);
    }

    #[test]
    fn faces_are_found_again_from_their_triangles() {
        let mut t = Triangles::default();
        for corners in [&[0, 1, 2][..], &[0, 1, 2, 3, 4], &[2, 3, 4], &[0, 1, 2, 3], &[1, 2, 3]] {
            t.push(corners);
        }
        let found: Vec<_> = (0..t.faces.len()).map(|i| t.face_of(i)).collect();
        assert_eq!(found, [0, 1, 1, 1, 2, 3, 3, 4]);
    }

    proptest::proptest! {
        /// A star-shaped outline, seen from any side: the triangles cover exactly its area, all
        /// turned the same way, so none overlaps another or leaves the outline.
        #[test]
        fn star_shaped_outlines_are_covered(radii in proptest::collection::vec(0.2f64..5.0, 3..40), flip: bool) {
            let n = radii.len();
            let p: Vec<[f64; 3]> = radii.iter().enumerate().map(|(i, r)| {
                let angle = std::f64::consts::TAU * i as f64 / n as f64;
                let y = if flip { -angle.sin() } else { angle.sin() };
                [r * angle.cos(), r * y, 0.1 * r * y]
            }).collect();
            let faces = cut(&p);
            proptest::prop_assert_eq!(faces.len(), n - 2);
            let outline: f64 = (0..n).map(|i| {
                let (a, b) = (p[i], p[(i + 1) % n]);
                0.5 * (a[0] * b[1] - a[1] * b[0])
            }).sum();
            let areas: Vec<f64> = faces.iter().map(|&t| area(&p, t)).collect();
            proptest::prop_assert!((areas.iter().sum::<f64>() - outline).abs() < 1e-9);
            proptest::prop_assert!(areas.iter().all(|a| a * outline.signum() >= 0.0));
        }
    }
}

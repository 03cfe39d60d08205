//! The tree of `boxes` over triangles, for overlap and closest-point queries and lines.

use super::boxes::{put_in_order, sort, Aabb, Item, Later, Node, Sorted, CHECKED, INNER, STACK};
use super::triangle::Triangle;
use crate::error::Result;
use glam::DVec3;

/// The part of the build that finding the order takes.
const SORTED: f64 = 0.85;

/// The answer of [`Bvh::closest_point`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClosestPoint {
    /// Index of the face.
    pub face: u32,
    /// The closest point on it.
    pub point: DVec3,
    /// Its distance, in the unit of the positions.
    pub distance: f64,
}

/// A tree over triangles; holds copies of their corners.
pub struct Bvh {
    nodes: Vec<Node>,
    faces: Vec<u32>,
    triangles: Vec<Triangle>,
}

impl Bvh {
    /// Builds the tree over all faces. Face indices must be below `positions.len()`.
    pub fn new(positions: &[DVec3], faces: &[[u32; 3]]) -> Self {
        match Self::new_checked(positions, faces, &|_| Ok(())) {
            Ok(tree) => tree,
            Err(_) => unreachable!("nobody asked to stop"),
        }
    }

    /// The same; asks `check` now and then whether to go on, with the part that is done.
    pub fn new_checked(
        positions: &[DVec3],
        faces: &[[u32; 3]],
        check: &dyn Fn(f64) -> Result<()>,
    ) -> Result<Self> {
        let early = |part: f64| check(SORTED * part);
        let Sorted { nodes, items, .. } = sort(numbered(positions, faces), &early)?;
        let count = items.len() as f64;
        // Made again in order: to move them about takes twice the room or, in place, ten times as long.
        let mut tree = Self {
            nodes,
            faces: Vec::with_capacity(items.len()),
            triangles: Vec::with_capacity(items.len()),
        };
        for (place, Item { index, .. }) in items.into_iter().enumerate() {
            if place % CHECKED == 0 {
                check(SORTED + (1.0 - SORTED) * place as f64 / count)?;
            }
            tree.faces.push(index);
            tree.triangles.push(faces[index as usize].map(|v| positions[v as usize]));
        }
        Ok(tree)
    }

    /// Builds the tree over pairs (face index, corners).
    pub fn from_triangles(triangles: impl Iterator<Item = (u32, Triangle)>) -> Self {
        let Ok(mut sorted) = sort(triangles, &|_| Ok(())) else {
            unreachable!("nobody asked to stop")
        };
        put_in_order(&mut sorted);
        let Sorted { nodes, numbers, things, .. } = sorted;
        Self { nodes, faces: numbers, triangles: things }
    }

    /// Box of everything; [`Aabb::EMPTY`] without faces.
    pub fn bounds(&self) -> Aabb {
        self.nodes.first().map_or(Aabb::EMPTY, Node::bounds)
    }

    /// Calls `visit` with every face whose own box overlaps `query`, in the fixed order of the
    /// tree, until it returns true. Returns whether it did.
    #[inline]
    pub fn any_overlapping(
        &self,
        query: &Aabb,
        mut visit: impl FnMut(u32, &Triangle) -> bool,
    ) -> bool {
        let mut stack = [(0, INNER); STACK];
        let mut depth = usize::from(!self.nodes.is_empty());
        while depth > 0 {
            depth -= 1;
            let (first, count) = stack[depth];
            if count == INNER {
                let node = &self.nodes[first as usize];
                let overlap = node.overlap(query);
                // The left one on top.
                stack[depth] = (node.first[1], node.count[1]);
                depth += usize::from(overlap[1]);
                stack[depth] = (node.first[0], node.count[0]);
                depth += usize::from(overlap[0]);
                continue;
            }
            for k in first as usize..(first + count) as usize {
                let t = &self.triangles[k];
                if Aabb::of(t).overlaps(query) && visit(self.faces[k], t) {
                    return true;
                }
            }
        }
        false
    }

    /// The closest point on any face at a distance of at most `max_dist` (may be infinite).
    ///
    /// Of faces at equal distance the one with the smallest index is returned. `None` if there is
    /// no face so near, or if `p` or `max_dist` is NaN.
    pub fn closest_point(&self, p: DVec3, max_dist: f64) -> Option<ClosestPoint> {
        self.closest_point_within(p, max_dist * max_dist)
    }

    /// The same with the square of the distance; one that is known, from a face nearby, saves most of
    /// the search.
    pub fn closest_point_within(&self, p: DVec3, max_squared: f64) -> Option<ClosestPoint> {
        if p.is_nan() || max_squared.is_nan() || max_squared < 0.0 || self.nodes.is_empty() {
            return None;
        }
        let mut best: Option<ClosestPoint> = None;
        let mut limit = max_squared;
        let mut later = Later::new();
        while let Some((first, count)) = later.next(limit) {
            if count == INNER {
                let node = &self.nodes[first as usize];
                later.add(node, node.distances_squared(p), limit);
                continue;
            }
            for k in first as usize..(first + count) as usize {
                if Aabb::of(&self.triangles[k]).distance_squared(p) > limit {
                    continue;
                }
                let point = closest_point_on_triangle(p, &self.triangles[k]);
                let (d, face) = (point.distance_squared(p), self.faces[k]);
                if d < limit || (d == limit && best.is_none_or(|b| face < b.face)) {
                    limit = d;
                    best = Some(ClosestPoint { face, point, distance: d.sqrt() });
                }
            }
        }
        best
    }
}

impl Bvh {
    /// Where the line `origin` + t `direction`, |t| ≤ `reach`, meets a face that `accept` takes,
    /// with the least |t|; of equal ones the smaller face. Returns the face and t.
    pub fn meet_line(
        &self,
        origin: DVec3,
        direction: DVec3,
        reach: f64,
        mut accept: impl FnMut(u32, &Triangle) -> bool,
    ) -> Option<(u32, f64)> {
        let inverse = direction.recip();
        let mut best: Option<(u32, f64)> = None;
        let mut limit = reach;
        let mut later = Later::new();
        while let Some((first, count)) = later.next(limit) {
            if count == INNER {
                let Some(node) = self.nodes.get(first as usize) else { break };
                later.add(node, node.reaches(origin, inverse), limit);
                continue;
            }
            for k in first as usize..(first + count) as usize {
                let Some(t) = line_parameter(origin, direction, &self.triangles[k]) else {
                    continue;
                };
                let face = self.faces[k];
                let better = match best {
                    Some((f, s)) => t.abs() < s.abs() || t.abs() == s.abs() && face < f,
                    None => t.abs() <= limit,
                };
                if better && accept(face, &self.triangles[k]) {
                    best = Some((face, t));
                    limit = t.abs();
                }
            }
        }
        best
    }
}

/// Parameter at which a line meets a triangle (Möller and Trumbore 1997), borders included.
fn line_parameter(origin: DVec3, direction: DVec3, t: &Triangle) -> Option<f64> {
    let (e1, e2) = (t[1] - t[0], t[2] - t[0]);
    let p = direction.cross(e2);
    let det = e1.dot(p);
    if det == 0.0 {
        return None;
    }
    let s = origin - t[0];
    let u = s.dot(p) / det;
    let q = s.cross(e1);
    let v = direction.dot(q) / det;
    // A line through an edge must not slip between its two faces by rounding.
    let slack = 1e-12;
    (u >= -slack && v >= -slack && u + v <= 1.0 + slack).then(|| e2.dot(q) / det)
}

/// Faces with their numbers and corners.
fn numbered<'a>(
    positions: &'a [DVec3],
    faces: &'a [[u32; 3]],
) -> impl Iterator<Item = (u32, Triangle)> + 'a {
    faces.iter().enumerate().map(|(i, f)| (i as u32, f.map(|v| positions[v as usize])))
}

/// The point of a triangle closest to `p`; also for triangles without area.
///
/// Where `p` projects into it that point, else the best of the edges that `p` lies beyond. All
/// candidates are convex combinations of the corners, so slivers cannot throw the point off the
/// triangle.
pub fn closest_point_on_triangle(p: DVec3, t: &Triangle) -> DVec3 {
    let n = (t[1] - t[0]).cross(t[2] - t[0]);
    let weight = |k: usize| {
        let (x, y) = (t[(k + 1) % 3], t[(k + 2) % 3]);
        (x - p).cross(y - p).dot(n)
    };
    let w = DVec3::new(weight(0), weight(1), weight(2));
    let sum = w.element_sum();
    if w.min_element() > 0.0 {
        // Relative to a corner: less rounding far from the origin.
        return t[0] + (t[1] - t[0]) * (w.y / sum) + (t[2] - t[0]) * (w.z / sum);
    }
    let (mut best, mut least) = (t[0], f64::INFINITY);
    // What is nearest lies on an edge that separates `p` from the triangle: from any other edge the
    // way to `p` would lead through the inside.
    let no_area = n == DVec3::ZERO || w.max_element() <= 0.0;
    for k in (0..3).filter(|&k| w[k] <= 0.0 || no_area) {
        let point = closest_point_on_segment(p, t[(k + 1) % 3], t[(k + 2) % 3]);
        let distance = point.distance_squared(p);
        if distance < least {
            (best, least) = (point, distance);
        }
    }
    best
}

fn closest_point_on_segment(p: DVec3, a: DVec3, b: DVec3) -> DVec3 {
    let ab = b - a;
    let len2 = ab.length_squared();
    if len2 > 0.0 {
        a + ab * ((p - a).dot(ab) / len2).clamp(0.0, 1.0)
    } else {
        a
    }
}

//! Whether two triangles of a mesh meet where they should not, decided exactly.
//!
//! Two triangles in space meet if and only if an edge of one meets the other (the observation under
//! Guigue and Devillers, "Fast and Robust Triangle-Triangle Overlap Test Using Orientation
//! Predicates", 2003). Here the edge tests are written out, because neighbours in a mesh share
//! vertices and those shared points must not count. Nearly all pairs of a mesh are such neighbours,
//! so most of the file is about rejecting them with two-dimensional predicates alone.
//!
//! Every decision is the exact sign of a predicate. Dropping a coordinate is exact, so coplanar
//! points are compared in a coordinate plane. Degenerate triangles are the segment or point they
//! are.

use super::predicates::{side_of_line, side_of_plane};
use glam::DVec3;

/// The corners of a triangle.
pub type Triangle = [DVec3; 3];

/// Whether two faces of a mesh have points in common beyond the vertices and edges they share.
///
/// Vertices are shared when their positions are equal (so also when they are the same vertex).
/// - None shared: any common point counts, touching included.
/// - One shared: any other common point counts. A face without area that passes *through* the
///   shared vertex counts as well.
/// - Two shared: only when one face lies folded flat onto the other.
/// - Three shared: always, the face is there twice.
///
/// The result depends neither on the order of the faces nor on the order of their corners.
/// Coordinates must be finite; otherwise the answer is unspecified (but there is no panic).
pub fn triangles_intersect(a: &Triangle, b: &Triangle) -> bool {
    let in_a = distinct_corners(a);
    let in_b = distinct_corners(b);
    let rest_a = Rest::of(a, in_a, b);
    let rest_b = Rest::of(b, in_b, a);
    let shared = in_a.iter().filter(|&&x| x).count() - rest_a.len;
    match shared {
        0 => separate_triangles_meet(a, b),
        1 => match (rest_a.ends(), rest_b.ends()) {
            (Some(ends_a), Some(ends_b)) => meet_beyond_vertex(a, ends_a, b, ends_b),
            _ => false, // one of them is no more than the shared point
        },
        2 if rest_a.len == 1 && rest_b.len == 1 => {
            let (p, q) = (rest_a.points[0], rest_b.points[0]);
            match shared_edge(a, p) {
                Some((e0, e1)) => is_folded_flat(e0, e1, p, q),
                None => false,
            }
        }
        2 => false, // one of them is no more than the shared edge
        _ => true,
    }
}

/// Marks the corners that do not repeat an earlier one.
fn distinct_corners(t: &Triangle) -> [bool; 3] {
    [true, t[1] != t[0], t[2] != t[0] && t[2] != t[1]]
}

/// The distinct corners of a triangle that the other one does not share.
struct Rest {
    points: [DVec3; 3],
    len: usize,
}

impl Rest {
    fn of(t: &Triangle, distinct: [bool; 3], other: &Triangle) -> Self {
        let mut rest = Rest { points: *t, len: 0 };
        for k in 0..3 {
            if distinct[k] && t[k] != other[0] && t[k] != other[1] && t[k] != other[2] {
                rest.points[rest.len] = t[k];
                rest.len += 1;
            }
        }
        rest
    }

    /// The edge opposite the single shared corner; one point twice if the triangle has only two.
    fn ends(&self) -> Option<[DVec3; 2]> {
        match self.len {
            0 => None,
            1 => Some([self.points[0]; 2]),
            _ => Some([self.points[0], self.points[1]]),
        }
    }
}

/// The edge of `t` opposite the corner `p`.
fn shared_edge(t: &Triangle, p: DVec3) -> Option<(DVec3, DVec3)> {
    let k = t.iter().position(|&x| x == p)?;
    Some((t[(k + 1) % 3], t[(k + 2) % 3]))
}

/// Two triangles on the edge `e0`, `e1`: in one plane and on the same side of the edge?
fn is_folded_flat(e0: DVec3, e1: DVec3, p: DVec3, q: DVec3) -> bool {
    let first = dominant_axis((e1 - e0).cross(p - e0));
    for axis in [first, (first + 1) % 3, (first + 2) % 3] {
        let side_p = side_of_line(axis, e0, e1, p);
        let side_q = side_of_line(axis, e0, e1, q);
        match side_p * side_q {
            1 => return side_of_plane(e0, e1, p, q) == 0,
            0 if side_p == 0 && side_q == 0 => continue, // edge-on or collinear in this view
            // On opposite sides in one view; or one on the line of the edge there and the other
            // not, then either the planes differ or the one has no area.
            _ => return false,
        }
    }
    false
}

/// Two triangles with one common corner; `ends_*` are their other corners.
fn meet_beyond_vertex(a: &Triangle, ends_a: [DVec3; 2], b: &Triangle, ends_b: [DVec3; 2]) -> bool {
    let [a1, a2] = ends_a;
    let [b1, b2] = ends_b;
    let Some(&apex) = a.iter().find(|&&x| x != a1 && x != a2) else {
        return false;
    };
    if plane_separates(apex, ends_a, ends_b) {
        return false;
    }
    let axis = dominant_axis((a1 - apex).cross(a2 - apex));
    if ray_separates(axis, apex, a1, a2, ends_b)
        || ray_separates(axis, apex, a2, a1, ends_b)
        || ray_separates(axis, apex, b1, b2, ends_a)
        || ray_separates(axis, apex, b2, b1, ends_a)
    {
        return false;
    }
    // A triangle that touches the other's plane only in the apex can have no other common point.
    let sides_b = ends_b.map(|p| side_of_plane(a[0], a[1], a[2], p));
    if sides_b[0] * sides_b[1] > 0 {
        return false;
    }
    let sides_a = ends_a.map(|p| side_of_plane(b[0], b[1], b[2], p));
    if sides_a[0] * sides_a[1] > 0 {
        return false;
    }
    segment_meets(ends_a, sides_a, b) || segment_meets(ends_b, sides_b, a)
}

/// A difference of f64 is exact but for a factor of 1 ± 2⁻⁵³, so are the products; with two sums of
/// three, a scalar product of differences is off by less than this times the sum of its absolute terms.
const DOT_ERROR: f64 = 8.0 * f64::EPSILON;

/// Do the corners of two triangles lie beyond doubt on two sides of one plane through their common
/// corner? It is square to the line from one to the other, which settles most neighbours.
fn plane_separates(apex: DVec3, ends_a: [DVec3; 2], ends_b: [DVec3; 2]) -> bool {
    let (a, b) = (ends_a.map(|p| p - apex), ends_b.map(|p| p - apex));
    let across = (a[0] + a[1]) - (b[0] + b[1]);
    let side = |p: DVec3| {
        let doubt = DOT_ERROR * p.abs().dot(across.abs()) + f64::MIN_POSITIVE;
        let dot = p.dot(across);
        i32::from(dot > doubt) - i32::from(dot < -doubt)
    };
    a.iter().all(|&p| side(p) > 0) && b.iter().all(|&p| side(p) < 0)
}

/// In the view along `axis`: does the line through `apex` and `on` have the triangle (apex, on,
/// inner) on one side and the triangle (apex, others) on the other, with only the apex in common?
fn ray_separates(axis: usize, apex: DVec3, on: DVec3, inner: DVec3, others: [DVec3; 2]) -> bool {
    let inside = side_of_line(axis, apex, on, inner);
    inside != 0
        && others.iter().all(|&p| {
            let side = side_of_line(axis, apex, on, p);
            // Straight on across the apex is common in regular grids.
            side == -inside || (side == 0 && is_beyond(axis, on, apex, p))
        })
}

/// For points on one line in the view along `axis`: is `mid` strictly between `from` and `to`?
fn is_beyond(axis: usize, from: DVec3, mid: DVec3, to: DVec3) -> bool {
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let k = if from[u] != mid[u] { u } else { v };
    (from[k] < mid[k] && mid[k] < to[k]) || (from[k] > mid[k] && mid[k] > to[k])
}

/// Two triangles without a common corner.
fn separate_triangles_meet(a: &Triangle, b: &Triangle) -> bool {
    let axis = dominant_axis((a[1] - a[0]).cross(a[2] - a[0]));
    if edge_separates(axis, a, b) || edge_separates(axis, b, a) {
        return false;
    }
    let sides_b = b.map(|p| side_of_plane(a[0], a[1], a[2], p));
    if is_one_sided(sides_b) {
        return false;
    }
    let sides_a = a.map(|p| side_of_plane(b[0], b[1], b[2], p));
    if is_one_sided(sides_a) {
        return false;
    }
    (0..3).any(|k| {
        let l = (k + 1) % 3;
        segment_meets([a[k], a[l]], [sides_a[k], sides_a[l]], b)
            || segment_meets([b[k], b[l]], [sides_b[k], sides_b[l]], a)
    })
}

/// In the view along `axis`: is there an edge of `a` with `a` on one side and all of `b` strictly
/// on the other?
fn edge_separates(axis: usize, a: &Triangle, b: &Triangle) -> bool {
    let turn = side_of_line(axis, a[0], a[1], a[2]);
    turn != 0
        && (0..3).any(|k| b.iter().all(|&p| side_of_line(axis, a[k], a[(k + 1) % 3], p) == -turn))
}

/// All strictly above or all strictly below.
fn is_one_sided(sides: [i32; 3]) -> bool {
    sides[0] != 0 && sides[0] == sides[1] && sides[1] == sides[2]
}

/// A closed segment (possibly a point) and a closed triangle (possibly without area); `sides` are
/// the sides of the segment's ends towards the plane of the triangle.
fn segment_meets(segment: [DVec3; 2], sides: [i32; 2], t: &Triangle) -> bool {
    let [p, q] = segment;
    if sides[0] * sides[1] > 0 {
        return false;
    }
    if sides == [0, 0] {
        return match flat_axis(t) {
            Some(axis) => coplanar_segment_meets(axis, p, q, t),
            None => {
                let (r, s) = hull_of_collinear(t);
                segments_meet(p, q, r, s)
            }
        };
    }
    // The line of the segment crosses the plane in one point, inside if it passes all three edges
    // on the same side.
    let turns = [0, 1, 2].map(|k| side_of_plane(p, q, t[k], t[(k + 1) % 3]));
    turns.iter().all(|&s| s >= 0) || turns.iter().all(|&s| s <= 0)
}

/// Segment and triangle in one plane, seen along an `axis` in which the triangle has area.
fn coplanar_segment_meets(axis: usize, p: DVec3, q: DVec3, t: &Triangle) -> bool {
    let turn = side_of_line(axis, t[0], t[1], t[2]);
    let is_inside =
        |x: DVec3| (0..3).all(|k| side_of_line(axis, t[k], t[(k + 1) % 3], x) * turn >= 0);
    is_inside(p)
        || is_inside(q)
        || (0..3).any(|k| planar_segments_meet(axis, p, q, t[k], t[(k + 1) % 3]))
}

/// Two closed segments of one plane, seen along an `axis` that does not flatten that plane.
fn planar_segments_meet(axis: usize, p: DVec3, q: DVec3, r: DVec3, s: DVec3) -> bool {
    let (pqr, pqs) = (side_of_line(axis, p, q, r), side_of_line(axis, p, q, s));
    let (rsp, rsq) = (side_of_line(axis, r, s, p), side_of_line(axis, r, s, q));
    if pqr == 0 && pqs == 0 && rsp == 0 && rsq == 0 {
        return collinear_segments_meet(p, q, r, s);
    }
    pqr * pqs <= 0 && rsp * rsq <= 0
}

/// Two closed segments anywhere in space.
fn segments_meet(p: DVec3, q: DVec3, r: DVec3, s: DVec3) -> bool {
    if side_of_plane(p, q, r, s) != 0 {
        return false;
    }
    // The four points lie in a plane; any triple that has area in a view shows that the view does
    // not flatten that plane.
    let triples = [[p, q, r], [p, q, s], [p, r, s], [q, r, s]];
    match triples.iter().find_map(flat_axis) {
        Some(axis) => planar_segments_meet(axis, p, q, r, s),
        None => collinear_segments_meet(p, q, r, s),
    }
}

/// Two closed segments of one line. Per coordinate the intervals must overlap, and as the points
/// run monotonically along a line, overlap in every coordinate is overlap on the line.
fn collinear_segments_meet(p: DVec3, q: DVec3, r: DVec3, s: DVec3) -> bool {
    let lo = p.min(q).max(r.min(s));
    let hi = p.max(q).min(r.max(s));
    lo.cmple(hi).all()
}

/// The two ends of a triangle whose corners lie on one line.
fn hull_of_collinear(t: &Triangle) -> (DVec3, DVec3) {
    // Lexicographic order is the order along the line.
    let key = |p: &DVec3| (p.x, p.y, p.z);
    let (mut lo, mut hi) = (t[0], t[0]);
    for p in &t[1..] {
        if key(p) < key(&lo) {
            lo = *p;
        }
        if key(p) > key(&hi) {
            hi = *p;
        }
    }
    (lo, hi)
}

/// An axis along which the triangle is seen with area; none if its corners lie on one line.
fn flat_axis(t: &Triangle) -> Option<usize> {
    let first = dominant_axis((t[1] - t[0]).cross(t[2] - t[0]));
    [first, (first + 1) % 3, (first + 2) % 3]
        .into_iter()
        .find(|&axis| side_of_line(axis, t[0], t[1], t[2]) != 0)
}

/// The axis of the largest component.
fn dominant_axis(n: DVec3) -> usize {
    let n = n.abs();
    if n.x >= n.y && n.x >= n.z {
        0
    } else if n.y >= n.z {
        1
    } else {
        2
    }
}

//! Orientation predicates with the exact sign, on `glam` points.
//!
//! Shewchuk, "Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates"
//! (1997), as the crate `robust` implements it. Exact while no product of three coordinate
//! differences leaves the range of f64: coordinates that come from f32 never do.

use glam::DVec3;
use robust::{Coord, Coord3D};

/// Forward error of the determinant in `side_of_plane` relative to its permanent: Shewchuk's bound
/// "A", (7 + 56 e) e with e = 2^-53.
const ORIENT3D_BOUND: f64 = (7.0 + 56.0 * HALF_ULP) * HALF_ULP;
/// The same for [`side_of_line`]: (3 + 16 e) e.
const ORIENT2D_BOUND: f64 = (3.0 + 16.0 * HALF_ULP) * HALF_ULP;
const HALF_ULP: f64 = f64::EPSILON / 2.0;

/// Determinant of `a - d`, `b - d`, `c - d`: the sign is exact, the value is not.
///
/// Positive when `a`, `b`, `c` turn clockwise seen from `d`, zero when the four are coplanar.
pub fn orient3d(a: DVec3, b: DVec3, c: DVec3, d: DVec3) -> f64 {
    let coord = |p: DVec3| Coord3D { x: p.x, y: p.y, z: p.z };
    robust::orient3d(coord(a), coord(b), coord(c), coord(d))
}

/// Turn of `a`, `b`, `c` after dropping the coordinate `axis` (0, 1 or 2): the sign is exact.
///
/// Positive for a left turn in the plane of the axes `axis + 1`, `axis + 2` (modulo 3).
pub fn orient2d(axis: usize, a: DVec3, b: DVec3, c: DVec3) -> f64 {
    let coord = |p: DVec3| Coord { x: p[(axis + 1) % 3], y: p[(axis + 2) % 3] };
    robust::orient2d(coord(a), coord(b), coord(c))
}

/// Sign of [`orient3d`], with the plain determinant first.
#[inline]
pub fn side_of_plane(a: DVec3, b: DVec3, c: DVec3, d: DVec3) -> i32 {
    let (u, v, w) = (a - d, b - d, c - d);
    let (vw, wv) = (v.x * w.y, v.y * w.x);
    let (wu, uw) = (w.x * u.y, w.y * u.x);
    let (uv, vu) = (u.x * v.y, u.y * v.x);
    let det = u.z * (vw - wv) + v.z * (wu - uw) + w.z * (uv - vu);
    let permanent = (vw.abs() + wv.abs()) * u.z.abs()
        + (wu.abs() + uw.abs()) * v.z.abs()
        + (uv.abs() + vu.abs()) * w.z.abs();
    if det.abs() > ORIENT3D_BOUND * permanent {
        return sign(det);
    }
    // Points in a plane z = const end here; the adaptive stages would find the same zero slowly.
    if permanent == 0.0 {
        return 0;
    }
    sign(orient3d(a, b, c, d))
}

/// Sign of [`orient2d`], with the plain determinant first.
#[inline]
pub fn side_of_line(axis: usize, a: DVec3, b: DVec3, c: DVec3) -> i32 {
    let (u, v) = (a - c, b - c);
    let (left, right) = match axis {
        0 => (u.y * v.z, u.z * v.y),
        1 => (u.z * v.x, u.x * v.z),
        _ => (u.x * v.y, u.y * v.x),
    };
    let det = left - right;
    if det.abs() > ORIENT2D_BOUND * (left.abs() + right.abs()) {
        return sign(det);
    }
    sign(orient2d(axis, a, b, c))
}

/// -1, 0 or 1; 0 for NaN.
#[inline]
fn sign(x: f64) -> i32 {
    i32::from(x > 0.0) - i32::from(x < 0.0)
}

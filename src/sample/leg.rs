//! A bent, tapered tube with round ends: what a missing band of a leg is cut from.

use super::profile::{rows, skin_over, Row, ROW_STEP};
use super::{SampleMesh, Site};
use std::f64::consts::{FRAC_PI_2, TAU};

/// Longest side of the bounding box (along y), as built.
pub(super) const EXTENT: f64 = 3.1;
/// Straight thigh, bend, straight shin: lengths along the centre line.
const THIGH: f64 = 1.0;
const BEND_RADIUS: f64 = 1.0;
const BEND_ANGLE: f64 = 0.9;
const SHIN: f64 = 1.2;
/// Radii at the two ends.
const THICK: f64 = 0.45;
const THIN: f64 = 0.22;

fn length() -> f64 {
    THIGH + BEND_RADIUS * BEND_ANGLE + SHIN
}

/// A point of the centre line at length `t` (beyond the ends it runs on straight) and its tangent,
/// in the xy plane.
fn centre_line(t: f64) -> ([f64; 2], [f64; 2]) {
    let bend = (t - THIGH).clamp(0.0, BEND_RADIUS * BEND_ANGLE);
    let (sin, cos) = (bend / BEND_RADIUS).sin_cos();
    let tangent = [sin, cos];
    let straight = t - bend;
    let (before, after) = (straight.min(THIGH), (straight - THIGH).max(0.0));
    let x = BEND_RADIUS * (1.0 - cos) + after * tangent[0];
    let y = before + BEND_RADIUS * sin + after * tangent[1];
    ([x, y], tangent)
}

fn point(row: &Row, u: f64) -> [f64; 3] {
    let (centre, tangent) = centre_line(row.height);
    let (sin, cos) = (TAU * u).sin_cos();
    // The section is a little oval, as a leg is: deeper along the bend than across it.
    let across = row.radius * sin * 1.1;
    [centre[0] + across * tangent[1], centre[1] - across * tangent[0], row.radius * cos]
}

pub(super) fn build(edge: f64) -> SampleMesh {
    const PIECES: usize = 256;
    let arc = |i: usize| FRAC_PI_2 * i as f64 / PIECES as f64;
    let mut line: Vec<[f64; 2]> =
        (0..=PIECES).map(|i| [THICK * arc(i).sin(), -THICK * arc(i).cos()]).collect();
    line.extend((0..=PIECES).map(|i| [THIN * arc(i).cos(), length() + THIN * arc(i).sin()]));
    skin_over(&rows(&line, edge * ROW_STEP), edge, point)
}

pub(super) fn site() -> Site {
    let at = THIGH + 0.5 * BEND_RADIUS * BEND_ANGLE;
    let (c, t) = centre_line(at);
    let radius = THICK + (THIN - THICK) * at / length();
    Site {
        point: [c[0], c[1], radius],
        normal: [0.0, 0.0, 1.0],
        radius: 0.26,
        ring_centre: [c[0], c[1], 0.0],
        ring_axis: [t[0], t[1], 0.0],
        ring_reach: 0.8,
    }
}

//! Ornaments as height fields: a meander, a braid, stipples. All run along u with period 1.

use super::profile::smoothstep;

/// Centre line of one period of a meander ("Greek key"), in cells of a 6 x 5 lattice; v up.
const MEANDER: [[f64; 2]; 11] = [
    [0.0, 0.5],
    [0.0, 4.5],
    [4.0, 4.5],
    [4.0, 1.7],
    [2.0, 1.7],
    [2.0, 3.0],
    [2.7, 3.0],
    [2.0, 3.0],
    [2.0, 1.7],
    [2.0, 0.5],
    [6.0, 0.5],
];

/// Height (0 to 1) of a meander strip: `u` in periods, `v` from 0 to 1 across the strip; one
/// period is 6/5 as long as the strip is wide.
pub(super) fn meander(u: f64, v: f64) -> f64 {
    let p = [(u - u.floor()) * 6.0, v * 5.0];
    let mut nearest = f64::INFINITY;
    for shift in [-6.0, 0.0, 6.0] {
        for w in MEANDER.windows(2) {
            let (a, b) = ([w[0][0] + shift, w[0][1]], [w[1][0] + shift, w[1][1]]);
            nearest = nearest.min(segment_distance(p, a, b));
        }
    }
    // A strand of one third of a cell each side, with walls of a quarter of a cell.
    1.0 - smoothstep(0.3, 0.58, nearest)
}

fn segment_distance(p: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    let d = [b[0] - a[0], b[1] - a[1]];
    let square = d[0] * d[0] + d[1] * d[1];
    let t = if square > 0.0 {
        (((p[0] - a[0]) * d[0] + (p[1] - a[1]) * d[1]) / square).clamp(0.0, 1.0)
    } else {
        0.0
    };
    (p[0] - a[0] - t * d[0]).hypot(p[1] - a[1] - t * d[1])
}

/// Height (0 to 1) of a braid of two strands: `u` in crossings, `v` from 0 to 1 across.
pub(super) fn braid(u: f64, v: f64) -> f64 {
    let strand = |phase: f64| {
        let angle = std::f64::consts::PI * (u + phase);
        let off = (v - 0.5 - 0.3 * angle.sin()).abs();
        // A round strand that dips where it passes below the other.
        let round = (1.0 - (off / 0.16).powi(2)).max(0.0).sqrt();
        round * (0.75 + 0.25 * angle.cos())
    };
    strand(0.0).max(strand(1.0))
}

/// Height (0 to 1) of stipples on a triangular lattice: `u` in columns, `v` in rows.
pub(super) fn stipple(u: f64, v: f64) -> f64 {
    let mut height: f64 = 0.0;
    for row in [v.floor(), v.floor() + 1.0] {
        let shift = if (row as i64).rem_euclid(2) == 1 { 0.5 } else { 0.0 };
        let column = (u - shift).round() + shift;
        // Rows of equilateral triangles stand √3/2 of the column distance apart.
        let off = (u - column).hypot((v - row) * super::profile::ROW_STEP);
        height = height.max((1.0 - (off / 0.4).powi(2)).max(0.0).sqrt());
    }
    height
}

//! Profiles of surfaces of revolution: a line from axis to axis, cut into rows of equal distance.

use super::skin::{even_params, ring_count, Skin};
use super::SampleMesh;
use std::f64::consts::TAU;

/// One row of a profile.
#[derive(Debug, Clone, Copy)]
pub(super) struct Row {
    /// Distance from the axis.
    pub radius: f64,
    /// Height along the axis.
    pub height: f64,
    /// Length of the profile from its start to here.
    pub run: f64,
    /// Unit normal in the profile's plane (radius, height), away from the solid.
    pub normal: [f64; 2],
    /// Index of the row.
    pub index: usize,
}

/// Distance of two rows of equilateral triangles, in edge lengths: √3/2.
pub(super) const ROW_STEP: f64 = 0.866_025_403_784_438_6;

/// Cuts a fine polyline of (radius, height), upward on the outside, into rows about `step` apart.
/// The first and last row lie on its ends.
pub(super) fn rows(line: &[[f64; 2]], step: f64) -> Vec<Row> {
    let mut run = vec![0.0];
    for w in line.windows(2) {
        run.push(run[run.len() - 1] + (w[1][0] - w[0][0]).hypot(w[1][1] - w[0][1]));
    }
    let total = run[run.len() - 1];
    let count = ((total / step).round() as usize).max(4);
    let mut segment = 0;
    (0..=count)
        .map(|index| {
            let s = total * index as f64 / count as f64;
            while segment + 2 < line.len() && run[segment + 1] < s {
                segment += 1;
            }
            let (p, q) = (line[segment], line[segment + 1]);
            let length = (run[segment + 1] - run[segment]).max(f64::MIN_POSITIVE);
            let t = ((s - run[segment]) / length).clamp(0.0, 1.0);
            let direction = [(q[0] - p[0]) / length, (q[1] - p[1]) / length];
            Row {
                radius: p[0] + t * (q[0] - p[0]),
                height: p[1] + t * (q[1] - p[1]),
                run: s,
                normal: [direction[1], -direction[0]],
                index,
            }
        })
        .collect()
}

/// A point of a surface of revolution about y: `u` in turns, `lift` along the profile's normal.
pub(super) fn revolved(row: &Row, u: f64, lift: f64) -> [f64; 3] {
    let (sin, cos) = (TAU * u).sin_cos();
    let r = row.radius + lift * row.normal[0];
    [r * sin, row.height + lift * row.normal[1], r * cos]
}

/// A closed surface over a profile that starts and ends on the axis.
pub(super) fn skin_over(
    rows: &[Row],
    edge: f64,
    point: impl Fn(&Row, f64) -> [f64; 3],
) -> SampleMesh {
    let mut skin = Skin::default();
    for row in rows {
        if row.index == 0 || row.index + 1 == rows.len() {
            skin.pole(point(row, 0.0));
        } else {
            let params = even_params(ring_count(row.radius, edge), row.index);
            skin.ring(params, |u| point(row, u));
        }
    }
    skin.finish()
}

/// Rounds the corners of a polyline of (radius, height, corner radius) with arcs, finely sampled.
pub(super) fn rounded(corners: &[[f64; 3]]) -> Vec<[f64; 2]> {
    let mut line = vec![[corners[0][0], corners[0][1]]];
    for w in corners.windows(3) {
        let [p, c, q] = [w[0], w[1], w[2]].map(|x| [x[0], x[1]]);
        let (a, b) = (unit(c, p), unit(c, q));
        let cos = (a[0] * b[0] + a[1] * b[1]).clamp(-1.0, 1.0);
        // The arc touches both sides this far from the corner.
        let reach = w[1][2] / (cos.acos() / 2.0).tan();
        let start = [c[0] + reach * a[0], c[1] + reach * a[1]];
        let end = [c[0] + reach * b[0], c[1] + reach * b[1]];
        // A quadratic curve: as round as a wall corner needs to be.
        const PIECES: usize = 24;
        line.extend((0..=PIECES).map(|i| {
            let t = i as f64 / PIECES as f64;
            let weight = [(1.0 - t) * (1.0 - t), 2.0 * t * (1.0 - t), t * t];
            std::array::from_fn(|k| weight[0] * start[k] + weight[1] * c[k] + weight[2] * end[k])
        }));
    }
    let last = corners[corners.len() - 1];
    line.push([last[0], last[1]]);
    line
}

fn unit(from: [f64; 2], to: [f64; 2]) -> [f64; 2] {
    let d = [to[0] - from[0], to[1] - from[1]];
    let length = d[0].hypot(d[1]);
    [d[0] / length, d[1] / length]
}

/// 0 below `low`, 1 above `high`, smooth between.
pub(super) fn smoothstep(low: f64, high: f64, x: f64) -> f64 {
    let t = ((x - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

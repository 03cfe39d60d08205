//! A thick-walled vessel: a profile closed inside and outside, a braid on the shoulder and a band
//! of stipples on the belly.

use super::motif::{braid, stipple};
use super::profile::{revolved, rows, skin_over, smoothstep, Row, ROW_STEP};
use super::{SampleMesh, Site};
use std::f64::consts::TAU;

/// Height of the vessel.
pub(super) const HEIGHT: f64 = 3.0;
/// The profile: foot, belly, neck, lip, and back down inside, as (radius, height).
const KNOTS: [[f64; 2]; 19] = [
    [0.0, 0.06],
    [0.34, 0.03],
    [0.50, 0.02],
    [0.55, 0.10],
    [0.62, 0.32],
    [0.95, 0.85],
    [1.08, 1.35],
    [0.92, 1.90],
    [0.60, 2.30],
    [0.52, 2.60],
    [0.64, 2.93],
    [0.60, 2.99],
    [0.53, 2.92],
    [0.42, 2.60],
    [0.80, 1.85],
    [0.94, 1.35],
    [0.83, 0.92],
    [0.55, 0.46],
    [0.0, 0.30],
];
/// The knot at the lip: what comes after is inside.
const LIP: usize = 11;
/// Heights of the two bands on the outside.
const STIPPLES: [f64; 2] = [0.82, 1.36];
const BRAID: [f64; 2] = [1.52, 1.86];
const RELIEF: f64 = 0.035;

/// A smooth line through the knots (Catmull-Rom, in equal parameter steps), and where the lip is.
fn profile_line() -> (Vec<[f64; 2]>, usize) {
    const PIECES: usize = 64;
    let knot = |i: isize| KNOTS[i.clamp(0, KNOTS.len() as isize - 1) as usize];
    let mut line = Vec::new();
    for i in 0..KNOTS.len() - 1 {
        let k = i as isize;
        let (a, b, c, d) = (knot(k - 1), knot(k), knot(k + 1), knot(k + 2));
        for piece in 0..PIECES {
            let t = piece as f64 / PIECES as f64;
            line.push(std::array::from_fn(|x| {
                let slope = [(c[x] - a[x]) / 2.0, (d[x] - b[x]) / 2.0];
                let (t2, t3) = (t * t, t * t * t);
                (2.0 * t3 - 3.0 * t2 + 1.0) * b[x]
                    + (t3 - 2.0 * t2 + t) * slope[0]
                    + (3.0 * t2 - 2.0 * t3) * c[x]
                    + (t3 - t2) * slope[1]
            }));
        }
    }
    line.push(knot(KNOTS.len() as isize));
    (line, LIP * PIECES)
}

/// Fades a band's relief out towards its borders (`v` from 0 to 1 across).
fn inside_band(v: f64) -> f64 {
    smoothstep(0.0, 0.06, v) * smoothstep(0.0, 0.06, 1.0 - v)
}

/// Height of the ornament on the outside.
fn relief(row: &Row, u: f64) -> f64 {
    let across = |band: [f64; 2]| (row.height - band[0]) / (band[1] - band[0]);
    let v = across(STIPPLES);
    if (0.0..=1.0).contains(&v) {
        // 44 columns around; rows at the distance that makes the lattice equilateral.
        let pitch = TAU * 1.02 / 44.0;
        let line = (row.height - STIPPLES[0]) / (pitch * ROW_STEP);
        return 0.8 * RELIEF * stipple(44.0 * u, line) * inside_band(v);
    }
    let v = across(BRAID);
    if (0.0..=1.0).contains(&v) {
        return 1.4 * RELIEF * braid(24.0 * u, v) * inside_band(v);
    }
    0.0
}

pub(super) fn build(edge: f64) -> SampleMesh {
    let (line, lip) = profile_line();
    let to_lip: f64 =
        line[..=lip].windows(2).map(|w| (w[1][0] - w[0][0]).hypot(w[1][1] - w[0][1])).sum();
    skin_over(&rows(&line, edge * ROW_STEP), edge, |row, u| {
        revolved(row, u, if row.run < to_lip { relief(row, u) } else { 0.0 })
    })
}

/// The clay, the slip of the bands, and the two paints.
const CLAY: [f64; 3] = [176.0, 104.0, 66.0];
const SLIP: [f64; 3] = [232.0, 214.0, 178.0];
const BLUE: [f64; 3] = [38.0, 66.0, 128.0];
const BLACK: [f64; 3] = [46.0, 34.0, 30.0];
/// A zigzag on the neck, where there is no relief.
const ZIGZAG: [f64; 2] = [2.00, 2.34];
/// Paint runs out over so much of a motif.
const EDGE: f64 = 0.12;

/// The colour at a height and an angle (0 to 1 around).
fn colour(height: f64, u: f64) -> [f64; 3] {
    let across = |band: [f64; 2]| (height - band[0]) / (band[1] - band[0]);
    let mix = |a: [f64; 3], b: [f64; 3], t: f64| [0, 1, 2].map(|k| a[k] + t * (b[k] - a[k]));
    let v = across(STIPPLES);
    if (0.0..=1.0).contains(&v) {
        let pitch = TAU * 1.02 / 44.0;
        let dot = stipple(44.0 * u, (height - STIPPLES[0]) / (pitch * ROW_STEP));
        let ground = mix(CLAY, SLIP, inside_band(v));
        return mix(ground, BLACK, smoothstep(0.3, 0.6, dot) * inside_band(v));
    }
    let v = across(BRAID);
    if (0.0..=1.0).contains(&v) {
        let strand = smoothstep(0.3, 0.6, braid(24.0 * u, v));
        return mix(CLAY, mix(BLUE, SLIP, strand), inside_band(v));
    }
    let v = across(ZIGZAG);
    let wave = (2.0 * (16.0 * u).fract() - 1.0).abs();
    let near = 1.0 - ((v - 0.25 - 0.5 * wave) / 0.22).abs();
    mix(CLAY, BLUE, smoothstep(0.0, EDGE, near))
}

/// Colours of points of the vessel, rounded to bytes.
pub(super) fn paint(positions: &[[f32; 3]]) -> Vec<[u8; 4]> {
    let of = |p: &[f32; 3]| {
        let u = f64::from(p[0]).atan2(f64::from(p[2])) / TAU + 1.0;
        let [r, g, b] = colour(f64::from(p[1]), u).map(|x| x.round() as u8);
        [r, g, b, 255]
    };
    positions.iter().map(of).collect()
}

pub(super) fn site() -> Site {
    Site {
        point: [0.0, 1.45, 1.07],
        normal: [0.0, 0.0, 1.0],
        radius: 0.38,
        ring_centre: [0.0, 1.45, 0.0],
        ring_axis: [0.0, 1.0, 0.0],
        ring_reach: 3.0,
    }
}

//! A fluted column shaft: what is missing can be told from what is left, and a smooth fill cannot.

use super::profile::{revolved, rounded, rows, Row};
use super::skin::{even_params, ring_count, Skin};
use super::{SampleMesh, Site};
use std::f64::consts::TAU;

/// Length of the whole piece, end to end.
pub(super) const LENGTH: f64 = 4.6;
/// Flutes around the shaft, as on a Doric column.
const FLUTES: usize = 20;
/// Depth of a flute where the shaft has radius 1.
const DEPTH: f64 = 0.075;
/// The flutes end this far from the ends of the piece.
const PLAIN: f64 = 0.24;
/// Radius of the rounded edge at the ends.
const ROUND: f64 = 0.1;

/// Radius at a height: tapers upward, ever faster (entasis).
fn shaft_radius(height: f64) -> f64 {
    1.0 - 0.17 * (height / LENGTH).clamp(0.0, 1.0).powf(1.7)
}

/// How deep the flutes are at a height, 0 to 1: they run out in a quarter circle.
fn flute_strength(height: f64) -> f64 {
    let half_width = TAU / FLUTES as f64 / 2.0;
    let inside = (height - PLAIN).min(LENGTH - PLAIN - height);
    let q = 1.0 - (inside / half_width).clamp(0.0, 1.0);
    (1.0 - q * q).sqrt()
}

/// A point of the fluted shaft, `u` in turns: circular arcs that meet in sharp arrises.
fn fluted(row: &Row, u: f64, strength: f64) -> [f64; 3] {
    let flute = (u * FLUTES as f64 + 1e-9).floor();
    let t = u * FLUTES as f64 - flute;
    let half = TAU / FLUTES as f64 / 2.0;
    // The arc over a chord of half-length `chord` with sagitta `depth`, in units of the radius.
    let (chord, depth) = (half.sin(), DEPTH);
    let rho = (chord * chord + depth * depth) / (2.0 * depth);
    let angle = (chord / rho).asin() * (2.0 * t - 1.0);
    let along = rho * angle.sin();
    let inward = half.cos() - (rho * angle.cos() - (rho - depth));
    let mid = (flute + 0.5) / FLUTES as f64 * TAU;
    let (sin, cos) = mid.sin_cos();
    let groove = [inward * sin + along * cos, inward * cos - along * sin];
    let (plain_sin, plain_cos) = (TAU * u).sin_cos();
    let r = row.radius;
    [
        r * (strength * groove[0] + (1.0 - strength) * plain_sin),
        row.height,
        r * (strength * groove[1] + (1.0 - strength) * plain_cos),
    ]
}

fn profile_line() -> Vec<[f64; 2]> {
    let top = shaft_radius(LENGTH);
    let mut line = rounded(&[[0.0, 0.0, 0.0], [1.0, 0.0, ROUND], [1.0, 2.0 * ROUND, 0.0]]);
    const PIECES: usize = 2000;
    line.extend((1..PIECES).map(|i| {
        let y = 2.0 * ROUND + (LENGTH - 4.0 * ROUND) * i as f64 / PIECES as f64;
        [shaft_radius(y), y]
    }));
    line.extend(rounded(&[
        [shaft_radius(LENGTH - 2.0 * ROUND), LENGTH - 2.0 * ROUND, 0.0],
        [top, LENGTH, ROUND],
        [0.0, LENGTH, 0.0],
    ]));
    line
}

pub(super) fn build(edge: f64) -> SampleMesh {
    let rows = rows(&profile_line(), edge * 0.93);
    let mut skin = Skin::default();
    for row in &rows {
        let strength = flute_strength(row.height);
        if row.index == 0 || row.index + 1 == rows.len() {
            skin.pole(revolved(row, 0.0, 0.0));
        } else if strength > 0.0 {
            // The same steps in each flute put a line of vertices on every arris.
            let steps = (ring_count(row.radius * 1.04, edge) as f64 / FLUTES as f64).round();
            let count = FLUTES * (steps as usize).max(3);
            skin.ring(even_params(count, 0), |u| fluted(row, u, strength));
        } else {
            let params = even_params(ring_count(row.radius, edge), row.index);
            skin.ring(params, |u| revolved(row, u, 0.0));
        }
    }
    skin.finish()
}

pub(super) fn site() -> Site {
    let y = 2.4;
    Site {
        point: [0.0, y, shaft_radius(y)],
        normal: [0.0, 0.0, 1.0],
        radius: 0.62,
        ring_centre: [0.0, y, 0.0],
        ring_axis: [0.0, 1.0, 0.0],
        ring_reach: 3.0,
    }
}

//! A torus about the y axis: genus 1, with its vertices on the surface to f32 precision.

use super::profile::ROW_STEP;
use super::skin::{even_params, ring_count, Skin};
use super::{SampleMesh, Site};
use std::f64::consts::TAU;

/// Radius of the centre line.
pub(super) const MAJOR: f64 = 1.0;
/// Radius of the tube.
pub(super) const MINOR: f64 = 0.4;

pub(super) fn build(edge: f64) -> SampleMesh {
    // Even, so that the rows' half turns also alternate across the seam.
    let rows = 2 * ((TAU * MINOR / (edge * ROW_STEP) / 2.0).round() as usize).max(3);
    let mut skin = Skin::default();
    for row in 0..rows {
        let (sin, cos) = (TAU * row as f64 / rows as f64).sin_cos();
        let radius = MAJOR + MINOR * cos;
        skin.ring(even_params(ring_count(radius, edge), row), |u| {
            let (s, c) = (TAU * u).sin_cos();
            [radius * s, MINOR * sin, radius * c]
        });
    }
    skin.close();
    skin.finish()
}

pub(super) fn site() -> Site {
    Site {
        point: [0.0, 0.0, MAJOR + MINOR],
        normal: [0.0, 0.0, 1.0],
        radius: 0.3,
        ring_centre: [0.0, 0.0, MAJOR],
        ring_axis: [1.0, 0.0, 0.0],
        ring_reach: 0.7,
    }
}

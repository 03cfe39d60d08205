//! The unit sphere: every vertex lies on it to f32 precision.

use super::profile::{revolved, rows, skin_over, ROW_STEP};
use super::{SampleMesh, Site};
use std::f64::consts::PI;

pub(super) fn build(edge: f64) -> SampleMesh {
    // Only the rows' heights come from this polyline; the points are put on the sphere below.
    let line: Vec<_> = (0..=4096)
        .map(|i| {
            let t = PI * i as f64 / 4096.0;
            [t.sin(), -t.cos()]
        })
        .collect();
    skin_over(&rows(&line, edge * ROW_STEP), edge, |row, u| {
        let p = revolved(row, u, 0.0);
        let length = p.iter().map(|x| x * x).sum::<f64>().sqrt();
        p.map(|x| x / length)
    })
}

pub(super) fn site() -> Site {
    Site {
        point: [0.0, 0.0, 1.0],
        normal: [0.0, 0.0, 1.0],
        radius: 0.5,
        ring_centre: [0.0; 3],
        ring_axis: [0.0, 1.0, 0.0],
        ring_reach: 2.0,
    }
}

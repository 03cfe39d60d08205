//! A slab with a meander strip between two ridges: ornament that must be continued across a hole.

use super::motif::meander;
use super::profile::smoothstep;
use super::{SampleMesh, Site};
use std::collections::HashMap;

/// Width, height and thickness.
pub(super) const SIZE: [f64; 3] = [3.6, 2.0, 0.36];
/// Radius of the rounded edges.
const ROUND: f64 = 0.08;
/// Half the height of the meander strip, its period (6/5 of the whole), and the relief.
const STRIP: f64 = 0.375;
const PERIOD: f64 = 0.9;
const RELIEF: f64 = 0.05;

/// Relief on the front face at (x, y), measured from the middle.
fn relief(x: f64, y: f64) -> f64 {
    let border = (SIZE[0] / 2.0 - x.abs()).min(SIZE[1] / 2.0 - y.abs());
    let fade = smoothstep(ROUND, 3.0 * ROUND, border);
    if y.abs() <= STRIP {
        // Out of the strip's borders it must have run down to the ground.
        let edge = smoothstep(0.0, 0.03, STRIP - y.abs());
        return RELIEF * fade * edge * meander(x / PERIOD, 0.5 + y / (2.0 * STRIP));
    }
    // A round ridge of 0.12 at 0.55 from the middle line.
    let off = (y.abs() - 0.55) / 0.06;
    RELIEF * fade * (1.0 - off * off).max(0.0).sqrt()
}

/// Rounds the box's edges, then lifts the front face.
fn shape(p: [f64; 3]) -> [f64; 3] {
    let half = SIZE.map(|s| s / 2.0);
    let core: [f64; 3] = std::array::from_fn(|k| p[k].clamp(ROUND - half[k], half[k] - ROUND));
    let out: [f64; 3] = std::array::from_fn(|k| p[k] - core[k]);
    let length = out.iter().map(|x| x * x).sum::<f64>().sqrt();
    let mut q: [f64; 3] = std::array::from_fn(|k| core[k] + out[k] * ROUND / length);
    if p[2] >= half[2] {
        q[2] += relief(q[0], q[1]);
    }
    q
}

/// The surface of a box of lattice cells: vertices are made when first asked for.
struct Lattice {
    cells: [usize; 3],
    ids: HashMap<[usize; 3], u32>,
    mesh: SampleMesh,
}

impl Lattice {
    fn vertex(&mut self, at: [usize; 3]) -> u32 {
        let next = self.mesh.vertices.len() as u32;
        let id = *self.ids.entry(at).or_insert(next);
        if id == next {
            let p = std::array::from_fn(|k| SIZE[k] * (at[k] as f64 / self.cells[k] as f64 - 0.5));
            self.mesh.vertices.push(shape(p).map(|x| x as f32));
        }
        id
    }

    /// The side where coordinate `axis` is 0 or, with `far`, greatest.
    fn side(&mut self, axis: usize, far: bool) {
        // Right-handed about the outward normal.
        let (u, v) =
            if far { ((axis + 1) % 3, (axis + 2) % 3) } else { ((axis + 2) % 3, (axis + 1) % 3) };
        for i in 0..self.cells[u] {
            for j in 0..self.cells[v] {
                let quad = [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[di, dj]| {
                    let mut at = [0; 3];
                    at[axis] = if far { self.cells[axis] } else { 0 };
                    at[u] = i + di;
                    at[v] = j + dj;
                    self.vertex(at)
                });
                self.split(quad, (i + j) % 2 == 0);
            }
        }
    }

    /// Cuts a quad along its shorter diagonal; alternately where both are equal.
    fn split(&mut self, [a, b, c, d]: [u32; 4], even: bool) {
        let square = |p: u32, q: u32| -> f64 {
            let (p, q) = (self.mesh.vertices[p as usize], self.mesh.vertices[q as usize]);
            (0..3).map(|k| f64::from(p[k] - q[k]).powi(2)).sum()
        };
        let (ac, bd) = (square(a, c), square(b, d));
        // 1e-4: f32 noise on equal diagonals stays far below this.
        let along_ac = if (ac - bd).abs() < 1e-4 * ac { even } else { ac < bd };
        self.mesh.faces.extend(if along_ac {
            [[a, b, c], [a, c, d]]
        } else {
            [[a, b, d], [b, c, d]]
        });
    }
}

pub(super) fn build(edge: f64) -> SampleMesh {
    // The edges are the lattice's and its diagonals': 0.88 makes their mean the edge asked for.
    let cells = SIZE.map(|s| ((s / (0.88 * edge)).round() as usize).max(2));
    let mut lattice = Lattice { cells, ids: HashMap::new(), mesh: SampleMesh::default() };
    for axis in [2, 0, 1] {
        lattice.side(axis, true);
        lattice.side(axis, false);
    }
    lattice.mesh
}

pub(super) fn site() -> Site {
    Site {
        point: [0.0, 0.1, SIZE[2] / 2.0],
        normal: [0.0, 0.0, 1.0],
        radius: 0.55,
        ring_centre: [0.0; 3],
        ring_axis: [1.0, 0.0, 0.0],
        ring_reach: 3.0,
    }
}

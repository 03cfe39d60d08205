//! Closed surfaces made of rings: each may have its own number of vertices, so that the edges stay
//! of one length where the surface narrows.

use super::SampleMesh;

/// A row of vertices, by where they stand around it (ascending in 0..1); a pole has one.
struct Ring {
    start: u32,
    params: Vec<f64>,
}

/// The surface so far. Rings grow along the axis while their parameter runs counter-clockwise
/// seen from the tip, which makes the faces point outward.
#[derive(Default)]
pub(super) struct Skin {
    mesh: SampleMesh,
    first: Option<Ring>,
    last: Option<Ring>,
    rows: usize,
}

impl Skin {
    /// Adds a ring and joins it to the one before.
    pub fn ring(&mut self, params: Vec<f64>, point: impl Fn(f64) -> [f64; 3]) {
        let start = self.mesh.vertices.len() as u32;
        self.mesh.vertices.extend(params.iter().map(|&u| point(u).map(|x| x as f32)));
        let ring = Ring { start, params };
        match self.last.take() {
            Some(below) => self.stitch(&below, &ring),
            None => {
                self.first = Some(Ring { start, params: ring.params.clone() });
            }
        }
        self.rows += 1;
        self.last = Some(ring);
    }

    /// Adds a single vertex: the tip of the first or last ring.
    pub fn pole(&mut self, point: [f64; 3]) {
        self.ring(vec![0.0], |_| point);
    }

    /// Joins the last ring to the first: a surface like a torus.
    pub fn close(&mut self) {
        if let (Some(below), Some(above)) = (self.last.take(), self.first.take()) {
            self.stitch(&below, &above);
        }
    }

    /// The mesh.
    pub fn finish(self) -> SampleMesh {
        self.mesh
    }

    /// Triangles between two rings: walks around both, each time over the shorter diagonal.
    fn stitch(&mut self, a: &Ring, b: &Ring) {
        let (na, nb) = (a.params.len(), b.params.len());
        let at_a = |i: usize| a.params[i % na] + (i / na) as f64;
        // Start at the vertex of b nearest to the first of a, counted from one turn below.
        let shift = nearest(&b.params, a.params[0]);
        let at_b = |j: usize| {
            let k = j + shift.0;
            b.params[k % nb] + (k / nb) as f64 - shift.1
        };
        let id_a = |i: usize| a.start + (i % na) as u32;
        let id_b = |j: usize| b.start + ((j + shift.0) % nb) as u32;
        let (mut i, mut j) = (0, 0);
        // A pole stands still: all triangles fan around it.
        let (end_a, end_b) = (if na == 1 { 0 } else { na }, if nb == 1 { 0 } else { nb });
        while i < end_a || j < end_b {
            let across_a = (at_a(i + 1) - at_b(j)).abs();
            let across_b = (at_b(j + 1) - at_a(i)).abs();
            // Equal on aligned rings: the diagonals then alternate, so that none is preferred.
            let tie = (across_a - across_b).abs() < 1e-9;
            let step_a = if tie { (i + self.rows).is_multiple_of(2) } else { across_a < across_b };
            if j >= end_b || (i < end_a && step_a) {
                self.mesh.faces.push([id_a(i), id_a(i + 1), id_b(j)]);
                i += 1;
            } else {
                self.mesh.faces.push([id_a(i), id_b(j + 1), id_b(j)]);
                j += 1;
            }
        }
    }
}

/// The index of the parameter nearest to `u` on the circle, and the turn to take off it.
fn nearest(params: &[f64], u: f64) -> (usize, f64) {
    let distance = |p: f64| (p - u) - (p - u).round();
    let best = (0..params.len())
        .min_by(|&i, &j| distance(params[i]).abs().total_cmp(&distance(params[j]).abs()))
        .unwrap_or(0);
    (best, (params[best] - u).round())
}

/// `n` parameters evenly around a ring; every other row is turned by half a step, so that the
/// triangles come out nearly equilateral.
pub(super) fn even_params(n: usize, row: usize) -> Vec<f64> {
    let offset = if row % 2 == 1 { 0.5 } else { 0.0 };
    (0..n).map(|i| (i as f64 + offset) / n as f64).collect()
}

/// How many vertices a ring of this radius takes; at least 5, the least that closes a tip well.
pub(super) fn ring_count(radius: f64, edge: f64) -> usize {
    ((std::f64::consts::TAU * radius / edge).round() as usize).max(5)
}

//! From a coarse mesh back to the fine one: the closest point on the coarse surface.

use super::simplify::Coarse;
use crate::error::Result;
use crate::intersect::closest_point_on_triangle;
use crate::mesh::neighbourhood::NONE;
use crate::progress::Monitor;
use glam::DVec3;

/// How far the search walks over the coarse mesh, in vertices; it nearly always ends after one or
/// two, since it starts at the vertex into which the fine one was merged.
const LONGEST_WALK: usize = 8;
/// Fine vertices between two looks at the monitor: some 10 ms.
const BEAT: usize = 1 << 14;

/// For each fine vertex a face of the coarse mesh and a place on it.
#[derive(Debug, Clone, Default)]
pub struct Prolongation {
    /// Corners of the face; [`NONE`] for fine vertices without faces.
    pub corners: Vec<[u32; 3]>,
    /// Barycentric coordinates on it, at least 0, sum 1 (0 for vertices without faces).
    pub weights: Vec<[f64; 3]>,
}

impl Prolongation {
    /// Finds the places, walking from the vertex that each fine one was merged into: on a thin
    /// wall the nearest coarse point in space may be on the other side, on the surface it is not.
    pub fn new(fine: &[DVec3], coarse: &Coarse, monitor: &Monitor) -> Result<Self> {
        let mut at_vertex: Vec<Vec<u32>> = vec![Vec::new(); coarse.positions.len()];
        for (f, face) in coarse.faces.iter().enumerate() {
            face.iter().for_each(|&v| at_vertex[v as usize].push(f as u32));
        }
        let mut found = Self::default();
        for (i, &p) in fine.iter().enumerate() {
            if i % BEAT == 0 {
                monitor.check()?;
            }
            let (corners, weights) = match coarse.parent[i] {
                NONE => ([NONE; 3], [0.0; 3]),
                start => locate(p, start, coarse, &at_vertex),
            };
            found.corners.push(corners);
            found.weights.push(weights);
        }
        Ok(found)
    }

    /// Number of fine vertices.
    pub fn fine_count(&self) -> usize {
        self.corners.len()
    }

    /// Corners and weights of fine vertex `v`; nothing for one without faces.
    pub fn row(&self, v: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let pairs = self.corners[v].into_iter().zip(self.weights[v]);
        pairs.filter(|e| e.0 != NONE).map(|(c, w)| (c as usize, w))
    }

    /// Pᵀ x: what each fine vertex has, handed to its coarse corners. Sums are kept.
    pub fn restrict(&self, fine: &[f64], coarse_count: usize) -> Vec<f64> {
        let mut coarse = vec![0.0; coarse_count];
        for (v, x) in fine.iter().enumerate() {
            self.row(v).for_each(|(c, w)| coarse[c] += w * x);
        }
        coarse
    }
}

fn locate(p: DVec3, start: u32, coarse: &Coarse, at_vertex: &[Vec<u32>]) -> ([u32; 3], [f64; 3]) {
    let mut best = (f64::INFINITY, 0u32, p);
    let mut at = start;
    for _ in 0..LONGEST_WALK {
        let before = best.0;
        for &f in &at_vertex[at as usize] {
            let q = closest_point_on_triangle(p, &corners(coarse, f));
            let d = q.distance_squared(p);
            if d < best.0 {
                best = (d, f, q);
            }
        }
        if best.0 >= before {
            break;
        }
        // On to the nearest corner.
        let face = coarse.faces[best.1 as usize];
        let distance = |v: u32| coarse.positions[v as usize].distance_squared(best.2);
        let next = face.into_iter().min_by(|&a, &b| distance(a).total_cmp(&distance(b)));
        match next {
            Some(v) if v != at => at = v,
            _ => break,
        }
    }
    let weights = barycentric(best.2, &corners(coarse, best.1));
    (coarse.faces[best.1 as usize], weights)
}

fn corners(coarse: &Coarse, f: u32) -> [DVec3; 3] {
    coarse.faces[f as usize].map(|v| coarse.positions[v as usize])
}

/// Barycentric coordinates of a point on a triangle; those of the nearest corner if it has no area.
pub(crate) fn barycentric(p: DVec3, t: &[DVec3; 3]) -> [f64; 3] {
    let n = (t[1] - t[0]).cross(t[2] - t[0]);
    let part = |k: usize| (t[(k + 1) % 3] - p).cross(t[(k + 2) % 3] - p).dot(n).max(0.0);
    let w = [part(0), part(1), part(2)];
    let sum: f64 = w.iter().sum();
    if sum > 0.0 && sum.is_finite() {
        return w.map(|x| x / sum);
    }
    let distance = |k: &usize| t[*k].distance_squared(p);
    let nearest = (0..3).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(0);
    [0, 1, 2].map(|k| if k == nearest { 1.0 } else { 0.0 })
}

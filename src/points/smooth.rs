//! Alexa, Behr, Cohen-Or, Fleishman, Levin and Silva (2003), "Computing and rendering point set surfaces":
//! noise is smoothed by moving points onto the surface that their neighbours show.
//!
//! Differences from the paper:
//! - The plane is that of the point's normal, not found by minimizing; the quadratic over it is fitted to
//!   the nearest neighbours only, and the step is done several times: it reaches as far as one wide fit
//!   and takes less from what is curved.
//! - Neighbours that look another way are left out: beyond an edge, or on the other side of a wall.

use super::neighbours::{blocks, Neighbours};
use crate::error::Result;
use crate::progress::Monitor;
use glam::DVec3;
use nalgebra::{Matrix6, Vector6};

/// Where a neighbour counts 1/e, in spacings: the twenty nearest of an even cloud reach 2.3.
const REACH: f64 = 2.0;
/// Least cosine between the normals of a point and a neighbour that it is fitted to: 60°.
const ALIKE: f64 = 0.5;
/// A quadratic has six numbers: with fewer neighbours than this there is nothing to average.
const LEAST: usize = 9;
/// Farthest that a point is moved in all, in spacings: noise of 0.3 spacings goes no farther in a
/// thousand points.
const MOST: f64 = 1.0;

/// The points, smoothed so many times.
pub fn smooth(
    points: &[DVec3],
    normals: &[DVec3],
    neighbours: &Neighbours,
    spacing: &[f64],
    rounds: usize,
    threads: usize,
    monitor: &Monitor,
) -> Result<Vec<DVec3>> {
    let mut now = points.to_vec();
    for _ in 0..rounds {
        now = blocks(points.len(), threads, monitor, &|i| {
            let near = neighbours.of(i).iter().map(|&q| q as usize);
            let alike = near.filter(|&q| normals[q].dot(normals[i]) > ALIKE);
            let offsets = alike.map(|q| now[q] - now[i]).chain([DVec3::ZERO]);
            let step = height(offsets, normals[i], REACH * spacing[i]).unwrap_or(0.0);
            let to = now[i] + step * normals[i] - points[i];
            points[i] + to.clamp_length_max(MOST * spacing[i])
        })?;
    }
    Ok(now)
}

/// Height over the origin of the quadratic that is nearest to some offsets; `None` if they are too few or
/// on a line.
fn height(offsets: impl Iterator<Item = DVec3>, normal: DVec3, reach: f64) -> Option<f64> {
    let x = normal.any_orthonormal_vector();
    let y = normal.cross(x);
    let (mut matrix, mut right, mut count) = (Matrix6::zeros(), Vector6::zeros(), 0);
    for d in offsets {
        let d = d / reach;
        let weight = (-d.length_squared()).exp();
        let (u, v, h) = (d.dot(x), d.dot(y), d.dot(normal));
        let row = Vector6::new(1.0, u, v, u * u, u * v, v * v);
        matrix += weight * row * row.transpose();
        right += weight * h * row;
        count += 1;
    }
    if count < LEAST {
        return None;
    }
    // A rim sees one side only: what the points do not say is held at flat.
    let hold = 1e-6 * matrix[(0, 0)];
    (3..6).for_each(|k| matrix[(k, k)] += hold);
    let solved = matrix.cholesky()?.solve(&right);
    Some(reach * solved[0]).filter(|h| h.is_finite())
}

#[cfg(test)]
mod tests {
    use super::super::normals::normals;
    use super::*;

    /// A sphere of radius 1, evenly (Fibonacci), each point moved along its normal.
    fn sphere(count: usize, noise: impl Fn(usize) -> f64) -> Vec<DVec3> {
        let golden = std::f64::consts::PI * (3.0 - 5f64.sqrt());
        let at = |i: usize| {
            let y = 1.0 - 2.0 * (i as f64 + 0.5) / count as f64;
            let (s, c) = (golden * i as f64).sin_cos();
            let r = (1.0 - y * y).sqrt();
            DVec3::new(r * c, y, r * s) * (1.0 + noise(i))
        };
        (0..count).map(at).collect()
    }

    fn smoothed(points: &[DVec3], rounds: usize) -> (Vec<DVec3>, f64) {
        let quiet = Monitor::silent();
        let neighbours = Neighbours::new(points, 1, &quiet).unwrap();
        let spacing = neighbours.spacing(&neighbours.reach(points), &vec![false; points.len()]);
        let normals = normals(points, &neighbours, None, 1, &quiet).unwrap();
        let all = smooth(points, &normals, &neighbours, &spacing, rounds, 1, &quiet).unwrap();
        (all, spacing[0])
    }

    fn off(points: &[DVec3]) -> f64 {
        let square = points.iter().map(|p| (p.length() - 1.0).powi(2)).sum::<f64>();
        (square / points.len() as f64).sqrt()
    }

    /// Noise becomes less with every round; without noise a sphere stays one.
    #[test]
    fn noise_goes_and_the_shape_stays() {
        let chance = |i: usize| (i * 7919 % 1009) as f64 / 504.5 - 1.0;
        let (clean, spacing) = smoothed(&sphere(3000, |_| 0.0), 3);
        assert!(off(&clean) < 0.01 * spacing, "{}", off(&clean) / spacing);
        let rough = sphere(3000, |i| 0.3 * 3f64.sqrt() * spacing * chance(i));
        let before = off(&rough);
        assert!((before / spacing - 0.3).abs() < 0.02);
        let (once, _) = smoothed(&rough, 1);
        let (thrice, _) = smoothed(&rough, 3);
        assert!(off(&once) < 0.7 * before, "{}", off(&once) / before);
        assert!(off(&thrice) < 0.8 * off(&once) && off(&thrice) < 0.5 * before);
        // Along the normals only: nothing slides.
        for (p, q) in rough.iter().zip(&thrice) {
            assert!(p.normalize().distance(q.normalize()) < 0.3 * spacing);
        }
        assert_eq!(smoothed(&rough, 0).0, rough);
    }

    /// The two sides of a wall two spacings thick, noisy, stay as far apart as they are.
    #[test]
    fn a_wall_is_not_pressed_together() {
        let chance = |i: usize| (i * 7919 % 1009) as f64 / 504.5 - 1.0;
        let points: Vec<DVec3> = (0..1800)
            .map(|i| {
                let (side, j, k) = (i / 900, i % 900 / 30, i % 30);
                let at = |v: usize| v as f64 + 0.3 * side as f64;
                let off = 0.2 * 3f64.sqrt() * chance(i);
                DVec3::new(
                    at(k) + 0.5 * (j % 2) as f64,
                    at(j) * 0.75f64.sqrt(),
                    2.0 * side as f64 + off,
                )
            })
            .collect();
        let quiet = Monitor::silent();
        let neighbours = Neighbours::new(&points, 1, &quiet).unwrap();
        let normals: Vec<DVec3> =
            (0..1800).map(|i| if i < 900 { -DVec3::Z } else { DVec3::Z }).collect();
        let made = smooth(&points, &normals, &neighbours, &[1.0; 1800], 3, 1, &quiet).unwrap();
        let off = |all: &[DVec3]| {
            let square =
                all.iter().enumerate().map(|(i, p)| (p.z - 2.0 * (i / 900) as f64).powi(2));
            (square.sum::<f64>() / 1800.0).sqrt()
        };
        assert!(off(&made) < 0.7 * off(&points), "{} {}", off(&points), off(&made));
    }
}

//! Park, Guo, Shin and Qin (2006), "Surface completion for shape and appearance", Eq. 2 to 6: principal
//! curvatures by normal voting (after Page et al. 2001).
//!
//! Differences from the paper:
//! - The nine neighbours are the nearest among those along edges, so that no other sheet votes.
//! - The arc length Δs is that of the circle over the chord: c (θ/2) / sin(θ/2).
//! - The weights ω are the angles that each direction has to itself: the integral of Eq. 2 by the
//!   trapezoidal rule, whatever the directions.

use super::ball::VertexGraph;
use crate::error::Result;
use crate::parallel;
use glam::{DMat2, DVec2, DVec3};
use std::f64::consts::TAU;

/// Neighbours that vote (Sec. 7).
const VOTERS: usize = 9;
/// Rings they are looked for in.
const RINGS: usize = 2;
/// Fewer say nothing.
const LEAST: usize = 3;
/// Vertices between two looks at the wish to stop.
const BLOCK: usize = 2048;

/// The greater and the smaller principal curvature at each vertex, in 1 / mesh unit; positive where the
/// surface is convex seen from outside; 0 where too few neighbours vote.
pub fn voted_curvatures(
    positions: &[DVec3],
    normals: &[DVec3],
    faces: &[[u32; 3]],
    threads: usize,
    check: &dyn Fn() -> Result<()>,
) -> Result<Vec<[f64; 2]>> {
    let graph = VertexGraph::new(positions.len(), faces);
    let block = |b: usize| {
        let mut near = Vec::new();
        let end = positions.len().min((b + 1) * BLOCK);
        let one = |v: usize| {
            gather(&graph, v as u32, &mut near);
            let off = |w: &u32| positions[*w as usize].distance_squared(positions[v]);
            near.sort_by(|a, b| off(a).total_cmp(&off(b)).then(a.cmp(b)));
            near.truncate(VOTERS);
            let voter = |&w: &u32| (positions[w as usize], normals[w as usize]);
            vote((positions[v], normals[v]), near.iter().map(voter))
        };
        (b * BLOCK..end).map(one).collect::<Vec<_>>()
    };
    let all = parallel::map(positions.len().div_ceil(BLOCK), threads, check, &block)?;
    Ok(all.concat())
}

/// The vertices around `v`, without it.
fn gather(graph: &VertexGraph, v: u32, found: &mut Vec<u32>) {
    found.clear();
    found.push(v);
    let mut begin = 0;
    for _ in 0..RINGS {
        let end = found.len();
        for i in begin..end {
            for &w in graph.neighbours(found[i]) {
                // A few dozen at most.
                if !found.contains(&w) {
                    found.push(w);
                }
            }
        }
        begin = end;
    }
    found.swap_remove(0);
}

/// Curvatures at a point with its normal, from others.
fn vote((p, n): (DVec3, DVec3), voters: impl Iterator<Item = (DVec3, DVec3)>) -> [f64; 2] {
    if n == DVec3::ZERO {
        return [0.0; 2];
    }
    let (x, y) = n.any_orthonormal_pair();
    // Direction in the tangent plane, and the normal curvature along it.
    let mut votes: Vec<(f64, f64)> = voters
        .filter_map(|(q, m)| {
            let chord = q - p;
            let t = DVec2::new(chord.dot(x), chord.dot(y)).try_normalize()?;
            let along = t.x * x + t.y * y;
            // The turn of the normal in the plane of n and the chord (Eq. 5), away from n if convex.
            let turn = m.dot(along).atan2(m.dot(n));
            let half = 0.5 * turn;
            let arc = chord.length() * if half.abs() < 1e-6 { 1.0 } else { half / half.sin() };
            (m != DVec3::ZERO).then_some((t.to_angle(), turn / arc))
        })
        .collect();
    if votes.len() < LEAST {
        return [0.0; 2];
    }
    votes.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let count = votes.len();
    let mut matrix = DMat2::ZERO;
    for (i, &(angle, curvature)) in votes.iter().enumerate() {
        let before = votes[(i + count - 1) % count].0 - if i == 0 { TAU } else { 0.0 };
        let after = votes[(i + 1) % count].0 + if i + 1 == count { TAU } else { 0.0 };
        let weight = 0.5 * (after - before);
        let t = DVec2::from_angle(angle);
        matrix += DMat2::from_cols(t.x * t, t.y * t) * (weight * curvature / TAU);
    }
    let (a, b, c) = (matrix.x_axis.x, matrix.x_axis.y, matrix.y_axis.y);
    let (mean, half) = (0.5 * (a + c), (0.25 * (a - c).powi(2) + b * b).sqrt());
    let [m1, m2] = [mean + half, mean - half];
    [3.0 * m1 - m2, 3.0 * m2 - m1]
}

#[cfg(test)]
mod tests {
    use super::super::curvature::tests::grid;
    use super::*;
    use crate::mesh::normals::vertex_normals;

    fn of(positions: &[DVec3], faces: &[[u32; 3]]) -> Vec<[f64; 2]> {
        let normals = vertex_normals(positions, faces.iter().copied());
        voted_curvatures(positions, &normals, faces, 1, &|| Ok(())).unwrap()
    }

    /// Along any chord of a sphere the normals turn by the angle of its arc: exact, whatever the voters.
    #[test]
    fn a_sphere_votes_for_its_radius() {
        let at = |a: f64, z: f64| DVec3::new(a.cos() * z.sin(), a.sin() * z.sin(), z.cos());
        let n = at(0.3, 1.1);
        let voters = (0..9).map(|k| at(0.3 + 0.2 * f64::from(k % 3), 1.0 + 0.06 * f64::from(k)));
        let [k1, k2] = vote((2.5 * n, n), voters.map(|m| (2.5 * m, m)));
        // Uneven directions: the sum is that of Eq. 2 for a constant only in the trace.
        assert!((k1 + k2 - 0.8).abs() < 1e-9, "{k1} {k2}");
        let even = (0..9).map(|k| {
            let (a, d) = (TAU * f64::from(k) / 9.0, 0.1 + 0.02 * f64::from(k));
            (n + d * (a.cos() * n.any_orthonormal_pair().0 + a.sin() * n.any_orthonormal_pair().1))
                .normalize()
        });
        for k in vote((-2.5 * n, -n), even.map(|m| (-2.5 * m, -m))) {
            assert!((k - 0.4).abs() < 1e-12, "{k}");
        }
        // Seen from inside: concave.
        let inner = (0..9).map(|k| DVec2::from_angle(TAU * f64::from(k) / 9.0));
        let inner = inner.map(|t| DVec3::new(0.1 * t.x, 0.1 * t.y, 1.0).normalize());
        for k in vote((2.5 * DVec3::Z, -DVec3::Z), inner.map(|m| (2.5 * m, -m))) {
            assert!((k + 0.4).abs() < 1e-12, "{k}");
        }
    }

    /// Curved one way only: within some per cent on a mesh of even triangles.
    #[test]
    fn a_cylinder_is_curved_across() {
        let at = |u: f64, v: f64| DVec3::new((TAU * u).cos(), (TAU * u).sin(), 3.0 * v);
        let (positions, faces) = grid((60, 30), (true, false), at);
        for (p, [k1, k2]) in positions.iter().zip(of(&positions, &faces)) {
            if (0.3..2.6).contains(&p.z) {
                assert!((k1 - 1.0).abs() < 0.06 && k2.abs() < 0.06, "{p}: {k1} {k2}");
            }
        }
    }

    /// One that nobody votes for, and a flat sheet.
    #[test]
    fn nothing_is_curved_where_nothing_is_known() {
        assert_eq!(vote((DVec3::ZERO, DVec3::Z), std::iter::empty()), [0.0; 2]);
        assert_eq!(vote((DVec3::ZERO, DVec3::ZERO), std::iter::empty()), [0.0; 2]);
        let (positions, faces) = grid((8, 8), (false, false), |u, v| DVec3::new(u, v, 0.0));
        assert!(of(&positions, &faces).iter().flatten().all(|k| k.abs() < 1e-12));
    }
}

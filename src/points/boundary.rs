//! Bendels, Schnabel and Klein (2005), "Fragment-based surface inpainting", Sec. 6.1: how probable it
//! is that a point lies on a boundary.
//!
//! Differences from the paper:
//! - The loops that are filled are the boundary loops of the mesh through the points ([`super::tidy`]):
//!   they are closed and simple without a threshold. The probability, and the loops that a spanning tree
//!   closes ([`super::spanning`]), say how far a rim is to be believed.
//! - The shape criterion takes the inverse of the distances: as printed, the farther from the
//!   boundary's shape the more probable.

use super::neighbours::Neighbours;
use super::normals::principal_axes;
use glam::{DVec2, DVec3};
use std::f64::consts::{PI, TAU};

/// Sine of the angle to the normal below which a neighbour has no direction: 10°, Sec. 6.1.
const STEEP: f64 = 0.17;
/// Shapes of neighbourhoods, by their relative spreads: boundary, interior, corner or noise, line.
const SHAPES: [[f64; 3]; 4] =
    [[2.0 / 3.0, 1.0 / 3.0, 0.0], [0.5, 0.5, 0.0], [1.0 / 3.0; 3], [1.0, 0.0, 0.0]];

/// Probability from 0 to 1: the mean of the angle, the half-disc and the shape criterion.
pub fn probability(points: &[DVec3], normals: &[DVec3], neighbours: &Neighbours, i: usize) -> f64 {
    let (p, n) = (points[i], normals[i]);
    let x = n.any_orthonormal_vector();
    let y = n.cross(x);
    let offsets: Vec<DVec3> = neighbours.of(i).iter().map(|&q| points[q as usize] - p).collect();
    let Some(radius) = offsets.last().map(|d| d.length()).filter(|r| *r > 0.0) else {
        return 1.0;
    };
    let flat: Vec<(DVec2, f64)> =
        offsets.iter().map(|d| (DVec2::new(d.dot(x), d.dot(y)), d.length())).collect();
    let all = (angle(&flat) + half_disc(&flat, radius) + shape(&offsets, radius)) / 3.0;
    if all.is_finite() {
        all
    } else {
        0.0
    }
}

/// The largest gap between the directions of two neighbours.
fn angle(flat: &[(DVec2, f64)]) -> f64 {
    let level = flat.iter().filter(|(d, length)| d.length() > STEEP * length);
    let angles: Vec<f64> = level.map(|(d, _)| d.y.atan2(d.x)).collect();
    if angles.len() < 3 {
        return 1.0;
    }
    let even = TAU / angles.len() as f64;
    ((widest_gap(angles) - even) / (PI - even)).clamp(0.0, 1.0)
}

/// The widest angle between two directions next to each other; a full turn for none.
pub fn widest_gap(mut angles: Vec<f64>) -> f64 {
    angles.sort_unstable_by(f64::total_cmp);
    let (Some(first), Some(last)) = (angles.first(), angles.last()) else { return TAU };
    let over = TAU - (last - first);
    angles.windows(2).map(|w| w[1] - w[0]).fold(over, f64::max)
}

/// How far the mean of the neighbours lies aside, 1 as in a half-disc.
fn half_disc(flat: &[(DVec2, f64)], radius: f64) -> f64 {
    let mean = flat.iter().map(|f| f.0).sum::<DVec2>() / (flat.len() + 1) as f64;
    (mean.length() / (4.0 / (3.0 * PI) * radius)).min(1.0)
}

/// How near the spreads are to those of a half-disc among the four shapes. The weight falls with the
/// distance, to 1/e at the last neighbour.
fn shape(offsets: &[DVec3], radius: f64) -> f64 {
    let weight = |d: &DVec3| (-d.length_squared() / (radius * radius)).exp();
    let all = offsets.iter().map(|d| (*d, weight(d))).chain([(DVec3::ZERO, 1.0)]);
    let spreads = principal_axes(all).spreads;
    let sum: f64 = spreads.iter().sum();
    if sum <= 0.0 {
        return 0.0;
    }
    let nearness = |s: &[f64; 3]| {
        let d2: f64 = (0..3).map(|k| (spreads[k] / sum - s[k]).powi(2)).sum();
        1.0 / d2.sqrt().max(1e-9)
    };
    nearness(&SHAPES[0]) / SHAPES.iter().map(nearness).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::progress::Monitor;

    /// Half a plane of a hexagonal lattice: on its edge all criteria are high, inside all are low.
    #[test]
    fn the_edge_of_a_half_plane_is_a_boundary() {
        let points: Vec<DVec3> = (0..15)
            .flat_map(|j| {
                let shift = 0.5 * f64::from(j % 2);
                (-15..15).map(move |i| {
                    DVec3::new(f64::from(i) + shift, f64::from(j) * 0.75f64.sqrt(), 0.0)
                })
            })
            .collect();
        let normals = vec![DVec3::Z; points.len()];
        let neighbours = Neighbours::new(&points, 1, &Monitor::silent()).unwrap();
        let at = |i: usize, j: usize| probability(&points, &normals, &neighbours, 30 * j + i);
        assert!(at(15, 0) > 0.6, "{}", at(15, 0));
        assert!(at(15, 7) < 0.25, "{}", at(15, 7));
        assert!(at(15, 0) > at(15, 1) && at(15, 1) > at(15, 7));
    }
}

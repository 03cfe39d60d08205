//! Duchon (1977), "Splines minimizing rotation-invariant semi-norms in Sobolev spaces": a fill moved by a
//! thin-plate spline so that it passes through, or near, points that are known inside the hole.
//!
//! Minimises, over the offsets u of the fill's vertices (three numbers each), those of the known ones being 0,
//!
//!   1/n Σ |B u − d|²  +  s² R² uᵀ L M⁻¹ L u
//!
//! with d from the fill's nearest point to each of n points, B the weights of the corners there, R the
//! hole's radius and s the softness. The plate is clamped: the offset and its slope are 0 at the rim.
//!
//! Differences from the paper: on a triangulated surface; what is nearest changes with the offset, so that a
//! few rounds are made.

use super::domain::Domain;
use super::factor::Symmetric;
use crate::fill::patch::Patch;
use crate::intersect::Bvh;
use glam::DVec3;

/// Softness of points that the fill shall pass through: what is missing is a millionth.
const HARD: f64 = 1e-4;
/// Rounds: the nearest points of a steep bump settle in three or four.
const ROUNDS: usize = 6;

/// A point's place on the fill.
struct Anchor {
    corners: [u32; 3],
    weights: [f64; 3],
}

/// The positions of a patch drawn to some points; `None` if the system cannot be factored. `softness`: 0 to
/// pass through them; 0.1 halves the height of a bump over the whole hole.
pub fn pull(patch: &Patch, domain: &Domain, points: &[DVec3], softness: f64) -> Option<Vec<DVec3>> {
    let (first, n) = (domain.fill.start, domain.fill.len());
    let stiff = points.len() as f64 * (softness.max(HARD) * domain.radius).powi(2);
    let plate = domain.plate_columns();
    let inner = |&(row, x): &(u32, f64)| {
        domain.fill.contains(&(row as usize)).then(|| (row - first as u32, stiff * x))
    };
    let plate: Vec<Vec<(u32, f64)>> =
        domain.fill.clone().map(|c| plate[c].iter().filter_map(inner).collect()).collect();
    let mut made = patch.positions.clone();
    for _ in 0..ROUNDS {
        let anchors = anchors(patch, &made, points)?;
        let mut columns = plate.clone();
        let mut rhs = vec![vec![0.0; n]; 3];
        for (anchor, &point) in anchors.iter().zip(points) {
            let own = || anchor.corners.iter().zip(anchor.weights);
            let there: DVec3 = own().map(|(&v, w)| w * patch.p(v)).sum();
            let free = || own().filter_map(|(&v, w)| Some(((v as usize).checked_sub(first)?, w)));
            for (a, x) in free() {
                for (k, rhs) in rhs.iter_mut().enumerate() {
                    rhs[a] += x * (point - there)[k];
                }
                for (b, y) in free().filter(|&(b, _)| b >= a) {
                    columns[a].push((b as u32, x * y));
                }
            }
        }
        Symmetric::from_columns(columns).factor(1.0, &vec![0.0; n])?.solve(&mut rhs);
        let offset = |i: usize| DVec3::new(rhs[0][i], rhs[1][i], rhs[2][i]);
        let moved =
            (0..n).map(|i| (patch.positions[first + i] + offset(i)).distance(made[first + i]));
        let most = moved.fold(0.0, f64::max);
        (0..n).for_each(|i| made[first + i] = patch.positions[first + i] + offset(i));
        if most < 1e-6 * domain.radius {
            break;
        }
    }
    made.iter().all(|p| p.is_finite()).then_some(made)
}

/// Where on a patch, its vertices at some positions, the points' nearest are.
fn anchors(patch: &Patch, positions: &[DVec3], points: &[DVec3]) -> Option<Vec<Anchor>> {
    let tree = Bvh::new(positions, &patch.triangles);
    let one = |&p: &DVec3| {
        let hit = tree.closest_point(p, f64::INFINITY)?;
        let corners = patch.triangles[hit.face as usize];
        let [a, b, c] = corners.map(|v| positions[v as usize]);
        let normal = (b - a).cross(c - a);
        let part = |p: DVec3, q: DVec3| (p - hit.point).cross(q - hit.point).dot(normal);
        let weights = [part(b, c), part(c, a), part(a, b)].map(|x| x / normal.length_squared());
        Some(Anchor { corners, weights })
    };
    points.iter().map(one).collect()
}

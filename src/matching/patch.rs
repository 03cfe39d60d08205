//! Harary, Tal and Grinspun (2014), "Context-based coherent surface completion", sec. 5: how
//! similar a source patch is to a target patch once it is laid on it,
//!
//! D(T, S) = min over R in O(3) of Σ_k |(R v_k^S + t) − v_k^T|²   (Eq. 4),
//!
//! where v_k^S is the vertex of S whose heat kernel signature is nearest to that of v_k^T and t
//! takes the centre of S to the centre of T.
//!
//! Differences from the paper:
//! - Signatures are compared by their first principal components ([`HEAT`]), not by all hundred
//!   times: what is left out is below a hundredth of their spread.
//! - The minimum is Σ|p|² + Σ|q|² − 2 (σ₁ + σ₂ + σ₃), with p and q the vertices relative to the
//!   centres and σ the singular values of Σ p qᵀ, so candidates are ranked without a rotation.

use super::object::{Scene, HEAT};
use super::rigid::Rigid;
use crate::descriptor::ball::Balls;
use glam::{DMat3, DVec3};

/// The vertices of a patch, centre first, ready to be compared.
#[derive(Debug, Clone, Default)]
pub struct LocalPatch {
    /// The scene's numbers.
    pub vertices: Vec<u32>,
    /// Positions relative to the centre.
    offsets: Vec<DVec3>,
    /// Heat of each vertex.
    heat: Vec<[f64; HEAT]>,
    /// The vertices' places by ascending first component.
    order: Vec<u32>,
    /// The first components in that order.
    first: Vec<f64>,
}

impl LocalPatch {
    /// The patch of a vertex.
    pub fn gather(scene: &Scene<'_>, balls: &mut Balls<'_>, centre: u32, radius: f64) -> Self {
        let mut vertices = Vec::new();
        balls.gather(centre, radius, &mut vertices);
        let place = |&v: &u32| scene.positions[v as usize];
        let offsets = vertices.iter().map(|v| place(v) - place(&centre)).collect();
        let heat: Vec<[f64; HEAT]> = vertices.iter().map(|&v| scene.traits(v).heat).collect();
        let mut order: Vec<u32> = (0..vertices.len() as u32).collect();
        let key = |i: &u32| heat[*i as usize][0];
        order.sort_by(|a, b| key(a).total_cmp(&key(b)).then(a.cmp(b)));
        let first = order.iter().map(key).collect();
        Self { vertices, offsets, heat, order, first }
    }

    /// The patch of a source vertex; `None` if it is not contained in the source.
    pub fn of_source(
        scene: &Scene<'_>,
        balls: &mut Balls<'_>,
        centre: u32,
        radius: f64,
    ) -> Option<Self> {
        let patch = Self::gather(scene, balls, centre, radius);
        patch.vertices.iter().all(|&v| scene.is_source(v)).then_some(patch)
    }

    /// The place of the vertex whose heat is nearest. Outward from where the first component
    /// fits, until it alone is farther than the best.
    fn nearest(&self, heat: &[f64; HEAT]) -> usize {
        let mut right = self.first.partition_point(|&x| x < heat[0]);
        let mut left = right;
        let mut best = (f64::INFINITY, 0);
        let look = |place: usize, best: &mut (f64, usize)| {
            let i = self.order[place] as usize;
            let d: f64 = (0..HEAT).map(|k| (self.heat[i][k] - heat[k]).powi(2)).sum();
            if d < best.0 || d == best.0 && i < best.1 {
                *best = (d, i);
            }
        };
        loop {
            let gap = |place: usize| (self.first[place] - heat[0]).powi(2);
            let go_left = left > 0 && gap(left - 1) <= best.0;
            let go_right = right < self.first.len() && gap(right) <= best.0;
            if !go_left && !go_right {
                return best.1;
            }
            if go_left {
                left -= 1;
                look(left, &mut best);
            }
            if go_right {
                look(right, &mut best);
                right += 1;
            }
        }
    }

    /// For each vertex of `target` the place in `self` that corresponds to it.
    fn correspondences<'a>(&'a self, target: &'a Self) -> impl Iterator<Item = usize> + Clone + 'a {
        target.heat.iter().map(|h| self.nearest(h))
    }

    /// D(target, self) of Eq. 4, in square mesh units.
    pub fn dissimilarity(&self, target: &Self) -> f64 {
        let mut m = DMat3::ZERO;
        let mut squares = 0.0;
        for (i, q) in self.correspondences(target).zip(&target.offsets) {
            let p = self.offsets[i];
            m += DMat3::from_cols(p.x * *q, p.y * *q, p.z * *q);
            squares += p.length_squared() + q.length_squared();
        }
        (squares - 2.0 * nuclear_norm(m)).max(0.0)
    }

    /// The transform of Eq. 4, which lays `self` on `target`.
    pub fn align(&self, scene: &Scene<'_>, target: &Self) -> Option<Rigid> {
        let pairs: Vec<(DVec3, DVec3, f64)> = self
            .correspondences(target)
            .zip(&target.offsets)
            .map(|(i, &q)| (self.offsets[i], q, 1.0))
            .collect();
        let about = Rigid::fit_about(DVec3::ZERO, DVec3::ZERO, pairs.into_iter(), None)?;
        let place = |p: &Self| scene.positions[p.vertices[0] as usize];
        let (from, to) = (place(self), place(target));
        Some(Rigid { linear: about.linear, translation: to - about.linear * from })
    }
}

/// Sum of the singular values. With p = Σ σ², q = Σ σᵢ²σⱼ² and d = |det| it is the greatest root of
/// (x² − p)² / 4 = q + 2 d x, which Newton's method finds from above.
pub fn nuclear_norm(m: DMat3) -> f64 {
    let [a, b, c] = [m.x_axis, m.y_axis, m.z_axis];
    let p = a.length_squared() + b.length_squared() + c.length_squared();
    if p <= 0.0 {
        return 0.0;
    }
    // In units of √p.
    let scale = p.sqrt();
    let [a, b, c] = [a / scale, b / scale, c / scale];
    let q = a.cross(b).length_squared() + b.cross(c).length_squared() + c.cross(a).length_squared();
    let d = a.cross(b).dot(c).abs();
    let mut x = 3f64.sqrt();
    for _ in 0..60 {
        let s = x * x - 1.0;
        let slope = x * s - 2.0 * d;
        let step = (0.25 * s * s - q - 2.0 * d * x) / slope;
        // Not a number where the slope vanishes: at the root.
        if step.is_nan() || step <= 1e-13 {
            break;
        }
        x -= step;
    }
    x * scale
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Matrix3;

    #[test]
    fn the_nuclear_norm_is_that_of_the_singular_values() {
        let mut seed = 1u64;
        let mut next = || {
            seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (seed >> 33) as f64 / 2f64.powi(31) - 0.5
        };
        for round in 0..300 {
            let mut m = DMat3::from_cols_array(&std::array::from_fn(|_| next()));
            if round % 3 == 1 {
                m.z_axis = m.x_axis * next();
            } else if round % 3 == 2 {
                (m.y_axis, m.z_axis) = (m.x_axis * next(), m.x_axis * next());
            }
            m *= 10f64.powf(20.0 * next());
            let truth: f64 =
                Matrix3::from_column_slice(&m.to_cols_array()).singular_values().iter().sum();
            let found = nuclear_norm(m);
            // A double root of rank one halves the digits.
            assert!((found - truth).abs() < 1e-6 * truth, "{round}: {found} {truth}");
        }
        assert_eq!(nuclear_norm(DMat3::ZERO), 0.0);
    }

    fn patch_of(points: &[DVec3], heat: impl Fn(DVec3) -> [f64; HEAT]) -> LocalPatch {
        let values: Vec<[f64; HEAT]> = points.iter().map(|&p| heat(p)).collect();
        let mut order: Vec<u32> = (0..points.len() as u32).collect();
        order.sort_by(|&a, &b| values[a as usize][0].total_cmp(&values[b as usize][0]));
        LocalPatch {
            vertices: (0..points.len() as u32).collect(),
            offsets: points.iter().map(|&p| p - points[0]).collect(),
            first: order.iter().map(|&i| values[i as usize][0]).collect(),
            heat: values,
            order,
        }
    }

    /// Heat that tells where a vertex is: a moved copy is found to be the same, a bent one is not,
    /// and the sum is that of the squares after the best of many turns.
    #[test]
    fn a_turned_and_mirrored_copy_is_no_different() {
        let points: Vec<DVec3> = (0..60)
            .map(|i| {
                let (x, y) = ((i % 8) as f64 - 3.5, (i / 8) as f64 - 3.5);
                DVec3::new(x, y, 0.1 * x * x - 0.07 * y * y + 0.01 * x * y * x)
            })
            .collect();
        let heat = |p: DVec3| [p.x + 0.1 * p.y, p.y, 0.0, 0.0, 0.0, 0.0];
        let target = patch_of(&points, heat);
        let turn = DMat3::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), 1.0)
            * DMat3::from_diagonal(DVec3::new(-1.0, 1.0, 1.0));
        let moved: Vec<DVec3> = points.iter().map(|&p| turn * p).collect();
        let source = patch_of(&moved, |p| heat(turn.transpose() * p));
        assert!(source.dissimilarity(&target) < 1e-9);
        let bent: Vec<DVec3> = points.iter().map(|&p| p + DVec3::Z * 0.2 * p.x.abs()).collect();
        let other = patch_of(&bent, heat);
        let d = other.dissimilarity(&target);
        let at = |turn: DMat3| -> f64 {
            let pairs = other.offsets.iter().zip(&target.offsets);
            pairs.map(|(&p, &q)| (turn * p - q).length_squared()).sum()
        };
        let pairs = other.offsets.iter().zip(&target.offsets).map(|(&p, &q)| (p, q, 1.0));
        let best = Rigid::fit_about(DVec3::ZERO, DVec3::ZERO, pairs, None).unwrap();
        assert!((at(best.linear) - d).abs() < 1e-9 * d, "{} {d}", at(best.linear));
        for k in 0..50 {
            let axis = DVec3::new((k % 3) as f64 - 1.0, (k % 5) as f64 - 2.0, 1.0).normalize();
            let turn = DMat3::from_axis_angle(axis, 0.02 * k as f64);
            assert!(at(turn * best.linear) >= d - 1e-9);
        }
    }

    #[test]
    fn the_nearest_heat_is_the_nearest_of_all() {
        let points: Vec<DVec3> = (0..200)
            .map(|i| DVec3::new((i * 37 % 101) as f64, (i * 53 % 97) as f64, 0.0))
            .collect();
        let heat = |p: DVec3| [0.01 * p.x, 0.01 * p.y, (p.x * p.y).sin(), 0.0, 0.0, 0.0];
        let patch = patch_of(&points, heat);
        for i in 0..100 {
            let h = [0.011 * i as f64, 0.5, (i as f64).cos(), 0.0, 0.0, 0.0];
            let d =
                |j: usize| -> f64 { (0..HEAT).map(|k| (patch.heat[j][k] - h[k]).powi(2)).sum() };
            let truth = (0..200).min_by(|&a, &b| d(a).total_cmp(&d(b)).then(a.cmp(&b))).unwrap();
            assert_eq!(patch.nearest(&h), truth);
        }
    }
}

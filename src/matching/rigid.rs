//! Rigid transforms with or without a reflection, and the best one between paired points
//! (Müller et al. 2005, "Meshless deformations based on shape matching"; Kabsch 1976).

use glam::{DMat3, DVec3};
use nalgebra::{Matrix3, SVD};

/// x ↦ `linear` x + `translation`. `linear` is orthogonal, its determinant −1 for a reflection; or
/// orthogonal up to strains of some per cent ([`super::stretch`]).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rigid {
    /// Rotation, or rotation and reflection, and the strain if there is one.
    pub linear: DMat3,
    /// In mesh units.
    pub translation: DVec3,
}

impl Rigid {
    /// Moves nothing.
    pub const IDENTITY: Self = Self { linear: DMat3::IDENTITY, translation: DVec3::ZERO };

    /// From three rows of four numbers, the last of each the translation's.
    pub fn from_rows(rows: [[f64; 4]; 3]) -> Self {
        let column = |j: usize| DVec3::from(rows.map(|row| row[j]));
        let linear = DMat3::from_cols(column(0), column(1), column(2));
        Self { linear, translation: column(3) }
    }

    /// Three rows of four numbers, the last of each the translation's.
    pub fn rows(&self) -> [[f64; 4]; 3] {
        let (linear, t) = (self.linear.transpose(), self.translation);
        [0, 1, 2].map(|i| linear.col(i).extend(t[i]).to_array())
    }

    /// Where a point goes.
    #[inline]
    pub fn point(&self, p: DVec3) -> DVec3 {
        self.linear * p + self.translation
    }

    /// Where a direction goes. A reflected surface's outward normal is the reflected normal.
    #[inline]
    pub fn direction(&self, d: DVec3) -> DVec3 {
        self.linear * d
    }

    /// The way back.
    pub fn inverse(&self) -> Self {
        let transposed = self.linear.transpose();
        let strain = (transposed * self.linear - DMat3::IDENTITY).to_cols_array();
        let is_rigid = strain.iter().all(|s| s.abs() < 1e-9);
        let linear = if is_rigid { transposed } else { self.linear.inverse() };
        Self { linear, translation: -(linear * self.translation) }
    }

    /// First `first`, then this.
    pub fn after(&self, first: &Self) -> Self {
        Self {
            linear: self.linear * first.linear,
            translation: self.linear * first.translation + self.translation,
        }
    }

    /// Whether it mirrors.
    pub fn is_mirrored(&self) -> bool {
        self.linear.determinant() < 0.0
    }

    /// The transform that takes `from` to `to` with the least Σ w |linear from + t − to|², over all
    /// rotations, and over reflections too if `mirrored` is `None`; `Some` fixes which.
    /// `None` without pairs.
    pub fn fit(
        pairs: impl Iterator<Item = (DVec3, DVec3, f64)> + Clone,
        mirrored: Option<bool>,
    ) -> Option<Self> {
        let (mut a, mut b, mut sum) = (DVec3::ZERO, DVec3::ZERO, 0.0);
        for (from, to, w) in pairs.clone() {
            a += w * from;
            b += w * to;
            sum += w;
        }
        if sum <= 0.0 {
            return None;
        }
        Self::fit_about(a / sum, b / sum, pairs, mirrored)
    }

    /// The same with `a` going to `b` exactly.
    pub fn fit_about(
        a: DVec3,
        b: DVec3,
        pairs: impl Iterator<Item = (DVec3, DVec3, f64)>,
        mirrored: Option<bool>,
    ) -> Option<Self> {
        let mut m = Matrix3::<f64>::zeros();
        for (from, to, w) in pairs {
            let (p, q) = (from - a, w * (to - b));
            m += Matrix3::from_fn(|i, j| q[i] * p[j]);
        }
        let svd = SVD::new(m, true, true);
        let (mut u, v) = (svd.u?, svd.v_t?);
        if let Some(mirrored) = mirrored {
            if ((u * v).determinant() < 0.0) != mirrored {
                // The direction that the pairs say least about.
                let least = svd.singular_values.imin();
                u.column_mut(least).neg_mut();
            }
        }
        let r = u * v;
        let linear = DMat3::from_cols_array_2d(&[0, 1, 2].map(|j| [0, 1, 2].map(|i| r[(i, j)])));
        Some(Self { linear, translation: b - linear * a })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn some_points() -> Vec<DVec3> {
        (0..7).map(|i| DVec3::new((i * i % 5) as f64, i as f64 * 0.3, (i % 3) as f64)).collect()
    }

    fn some_rotation() -> DMat3 {
        DMat3::from_axis_angle(DVec3::new(1.0, 2.0, -0.5).normalize(), 2.1)
    }

    #[test]
    fn known_transforms_come_back() {
        for mirror in [DMat3::IDENTITY, DMat3::from_diagonal(DVec3::new(1.0, -1.0, 1.0))] {
            let t = Rigid {
                linear: some_rotation() * mirror,
                translation: DVec3::new(3.0, -7.0, 0.25),
            };
            let points = some_points();
            let found = Rigid::fit(points.iter().map(|&p| (p, t.point(p), 1.0)), None).unwrap();
            assert_eq!(found.is_mirrored(), t.is_mirrored());
            for p in points {
                assert!(found.point(p).distance(t.point(p)) < 1e-12);
                assert!(found.inverse().point(t.point(p)).distance(p) < 1e-12);
                let twice = t.after(&found).point(p);
                assert!(twice.distance(t.point(t.point(p))) < 1e-11);
            }
        }
    }

    /// Points in a plane fit a rotation and a reflection equally well.
    #[test]
    fn the_kind_asked_for_is_kept() {
        let flat: Vec<DVec3> = some_points().iter().map(|p| p.with_z(0.0)).collect();
        for mirrored in [false, true] {
            let pairs = flat.iter().map(|&p| (p, some_rotation() * p, 1.0));
            let found = Rigid::fit(pairs, Some(mirrored)).unwrap();
            assert_eq!(found.is_mirrored(), mirrored);
            for &p in &flat {
                assert!(found.point(p).distance(some_rotation() * p) < 1e-12);
            }
        }
    }
}

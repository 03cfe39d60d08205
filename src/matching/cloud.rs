//! A thinned cloud of the source: one averaged point a cell, so that what is looked at costs the
//! same whatever the density of the mesh.

use super::source::{PointTree, Source};
use glam::DVec3;

/// Points with normals, evenly spread.
pub struct Cloud {
    /// Mean positions, in mesh units.
    pub points: Vec<DVec3>,
    /// Mean normals, unit length.
    pub normals: Vec<DVec3>,
    /// Mean roughness, see [`Source::roughness`].
    pub roughness: Vec<f64>,
    /// Mean tints, see [`super::paint`]; `None` without colours.
    pub tints: Option<Vec<f64>>,
    /// Tree over the points.
    pub tree: PointTree,
}

/// A point, its normal, its roughness and its tint.
pub type Sample = (DVec3, DVec3, f64, f64);

/// Points of a cloud at most, so that small holes in large objects stay affordable.
const MOST_POINTS: f64 = 1.2e5;

impl Cloud {
    /// The spacing that a cloud has when `spacing` is asked for.
    pub fn spacing(source: &Source, spacing: f64) -> f64 {
        spacing.max((source.area / MOST_POINTS).sqrt())
    }

    /// The source at a spacing (or as near to it as may be): its vertices, or points on its faces
    /// where the mesh is coarser than that.
    pub fn of_source(source: &Source, spacing: f64) -> Self {
        let spacing = Self::spacing(source, spacing);
        if source.edge < spacing {
            let all = source.points.ids().iter();
            let point = |&v: &u32| {
                let v = v as usize;
                (source.positions[v], source.normals[v], source.roughness[v], source.tint(v))
            };
            return Self::thin(all.map(point), spacing).painted(source);
        }
        let mut samples = Vec::new();
        for face in &source.faces {
            let p = face.map(|v| source.positions[v as usize]);
            let n = face.map(|v| source.normals[v as usize]);
            let rough = face.iter().map(|&v| source.roughness[v as usize]).sum::<f64>() / 3.0;
            let tints = face.map(|v| source.tint(v as usize));
            let longest = (0..3).map(|k| p[k].distance(p[(k + 1) % 3])).fold(0.0, f64::max);
            // The middles of k² small triangles.
            let k = ((longest / spacing).ceil() as usize).clamp(1, 16);
            for i in 0..k {
                for j in 0..2 * (k - i) - 1 {
                    let step = 1.0 / k as f64;
                    let third = if j % 2 == 0 { 1.0 / 3.0 } else { 2.0 / 3.0 };
                    let (a, b) = ((i as f64 + third) * step, ((j / 2) as f64 + third) * step);
                    let c = 1.0 - a - b;
                    let point = a * p[0] + b * p[1] + c * p[2];
                    let tint = a * tints[0] + b * tints[1] + c * tints[2];
                    samples.push((point, a * n[0] + b * n[1] + c * n[2], rough, tint));
                }
            }
        }
        Self::thin(samples.into_iter(), spacing).painted(source)
    }

    /// Forgets the tints of a source that has none.
    fn painted(self, source: &Source) -> Self {
        Self { tints: self.tints.filter(|_| source.paint.is_some()), ..self }
    }

    /// One point for each cubic cell of width `spacing` and each octant of the normal: the two
    /// sides of a thin wall are not averaged. Points without a normal are left out.
    pub fn thin(points: impl Iterator<Item = Sample> + Clone, spacing: f64) -> Self {
        let low = points.clone().fold(DVec3::INFINITY, |low, (p, ..)| low.min(p));
        let points: Vec<_> = points.filter(|(_, n, ..)| *n != DVec3::ZERO).collect();
        let mut cells: Vec<([u32; 3], u8, u32)> = points
            .iter()
            .enumerate()
            .map(|(i, (p, n, ..))| {
                let cell = ((*p - low) / spacing).to_array().map(|x| x as u32);
                (cell, n.cmplt(DVec3::ZERO).bitmask() as u8, i as u32)
            })
            .collect();
        // By index at last, so that the sums below run in input order.
        cells.sort_unstable();
        let (mut means, mut normals) = (Vec::new(), Vec::new());
        let (mut roughness, mut tints) = (Vec::new(), Vec::new());
        for same in cells.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
            let count = same.len() as f64;
            let members = || same.iter().map(|c| &points[c.2 as usize]);
            means.push(members().map(|m| m.0).sum::<DVec3>() / count);
            normals.push(members().map(|m| m.1).sum::<DVec3>().normalize_or_zero());
            roughness.push(members().map(|m| m.2).sum::<f64>() / count);
            tints.push(members().map(|m| m.3).sum::<f64>() / count);
        }
        Self {
            tree: PointTree::of_all(&means),
            points: means,
            normals,
            roughness,
            tints: Some(tints),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::source::tests::{hills, hilly_source};
    use super::*;

    /// Coarser and finer than the mesh the points lie on the hills, and no farther from any place
    /// than the spacing lets expect.
    #[test]
    fn a_cloud_covers_the_surface_at_its_spacing() {
        let source = hilly_source(60);
        for spacing in [0.15, 0.02] {
            let cloud = Cloud::of_source(&source, spacing);
            let wanted = source.area / (spacing * spacing);
            let ratio = cloud.points.len() as f64 / wanted;
            assert!((0.7..2.5).contains(&ratio), "{ratio}");
            for (p, n) in cloud.points.iter().zip(&cloud.normals) {
                let (q, m) = hills(p.x, p.y);
                assert!((p.z - q.z).abs() < 0.2 * spacing && n.dot(m) > 0.98, "{p}");
            }
            for p in &source.positions {
                let (_, d2) = cloud.tree.nearest(*p).unwrap();
                assert!(d2.sqrt() < 1.5 * spacing, "{p}");
            }
        }
    }

    #[test]
    fn sides_of_a_wall_stay_apart_and_points_without_normal_go() {
        let points = [(0.01, 1.0), (0.02, 1.0), (0.03, -1.0), (0.04, 0.0)]
            .map(|(z, n)| (DVec3::new(0.0, 0.0, z), DVec3::Z * n, z, 0.0));
        let cloud = Cloud::thin(points.into_iter(), 1.0);
        assert_eq!(cloud.points.len(), 2);
        let up = cloud.normals.iter().position(|n| n.z > 0.0).unwrap();
        assert!((cloud.points[up].z - 0.015).abs() < 1e-12);
        assert!((cloud.roughness[up] - 0.015).abs() < 1e-12);
        assert_eq!(cloud.points[1 - up].z, 0.03);
    }
}

//! Mitra, Guibas, Pauly (2006), "Partial and approximate symmetry detection for 3D geometry", the simplest
//! case: what carries the object as a whole (nearly) onto itself, so that a hole can be laid straight onto
//! its mirror image.
//!
//! Differences from the paper: only the reflections and half turns about the principal axes are tried, each
//! improved by ICP; no voting. What repeats in part is found by the search for places.

use super::cloud::thin_vertices;
use super::icp::{align, Pairing, Partner, RingPoint};
use super::rigid::Rigid;
use super::source::Source;
use crate::error::Result;
use crate::mesh::neighbourhood::NONE;
use glam::{DMat3, DVec3};

/// Points of the object that are laid onto it, about.
const POINTS: f64 = 100.0;
/// Iterations of the ICP: a hole is aligned by its own ring after it.
const STEPS: usize = 12;
/// Farthest that a partner may lie, in spreads of the points: limbs are seldom held alike.
const REACH: f64 = 0.25;
/// Share of the points that is used, the nearest: the rest has its holes and its pose.
const KEEP: f64 = 0.7;

/// Transforms of a source onto itself that may be symmetries of it: nothing is said of how exact they are.
pub fn symmetries(
    source: &Source,
    mirrored: bool,
    check: &dyn Fn(f64) -> Result<()>,
) -> Result<Vec<Rigid>> {
    // The same whichever hole asks first.
    let source = &source.for_hole(NONE);
    let spacing = (source.area / POINTS).sqrt();
    let thinned = thin_vertices(source, spacing, &|| check(0.0))?;
    let points: Vec<RingPoint> =
        thinned.points.into_iter().zip(thinned.normals).map(|(p, n)| (p, n, 0.0)).collect();
    if points.is_empty() {
        return Ok(Vec::new());
    }
    let n = points.len() as f64;
    let middle = points.iter().map(|p| p.0).sum::<DVec3>() / n;
    let spread = points.iter().map(|p| p.0.distance_squared(middle)).sum::<f64>() / n;
    let radius = REACH * spread.sqrt();
    let pairing = Pairing { source, partner: Partner::Vertex, radius, keep: KEEP, paint: 0.0 };
    signs()
        .enumerate()
        .filter(|(_, s)| mirrored || s.x * s.y * s.z > 0.0)
        .map(|(i, signs)| {
            let linear = source.axes * DMat3::from_diagonal(signs) * source.axes.transpose();
            let start = Rigid { linear, translation: middle - linear * middle };
            // The points take about as long as one of them.
            check((i + 1) as f64 / 7.0)?;
            Ok(align(&points, start, STEPS, &pairing))
        })
        .collect()
}

/// Three reflections, three half turns.
fn signs() -> impl Iterator<Item = DVec3> {
    let one = |k: usize| DVec3::from([0, 1, 2].map(|i| if i == k { -1.0 } else { 1.0 }));
    (0..3).map(one).chain((0..3).map(move |k| -one(k)))
}

#[cfg(test)]
mod tests {
    use super::super::source::tests::some_transform;
    use super::*;
    use crate::mesh::MeshView;

    /// A bumpy ellipsoid whose bumps are mirrored in one plane, a part of it missing: the reflection comes back
    /// as one of the transforms, wherever it lies; without reflections it does not.
    #[test]
    fn the_mirror_of_a_broken_body_is_found() {
        let moved = some_transform(false);
        let (rows, columns) = (40_u32, 80_u32);
        let at = |i: u32, j: u32| {
            let (a, b) = (f64::from(i) / f64::from(rows), f64::from(j) / f64::from(columns));
            let (a, b) = (a * std::f64::consts::PI, b * std::f64::consts::TAU);
            let d = DVec3::new(a.sin() * b.cos(), a.sin() * b.sin(), a.cos());
            // Even in y alone.
            let bumps = 0.1 * (5.0 * d.x + 1.0).sin() + 0.1 * (4.0 * d.z - 2.0 * d.x).cos();
            let r = 1.0 + bumps + 0.1 * (6.0 * d.y).cos() + 0.4 * d.z.max(0.0);
            moved.point(r * d * DVec3::new(1.6, 0.8, 1.1)).to_array()
        };
        let vertices: Vec<[f64; 3]> =
            (0..=rows).flat_map(|i| (0..columns).map(move |j| at(i, j))).collect();
        let mut faces = Vec::new();
        for (i, j) in (1..rows - 1).flat_map(|i| (0..columns).map(move |j| (i, j))) {
            let [a, b] = [i * columns + j, i * columns + (j + 1) % columns];
            if !(10..16).contains(&i) || j > 12 {
                faces.extend([[a, a + columns, b], [b, a + columns, b + columns]]);
            }
        }
        let mesh = MeshView::new(&vertices[..], &faces[..]);
        let source = Source::new(mesh, std::iter::empty(), &|_| Ok(())).unwrap();
        let mirror = DMat3::from_diagonal(DVec3::new(1.0, -1.0, 1.0));
        let truth = moved.after(&Rigid { linear: mirror, translation: DVec3::ZERO });
        let truth = truth.after(&moved.inverse());
        let off = |t: &Rigid| {
            let places = source.positions.iter().step_by(37);
            places.map(|&p| t.point(p).distance(truth.point(p))).fold(0.0, f64::max)
        };
        let best = |all: &[Rigid]| all.iter().map(off).fold(f64::INFINITY, f64::min);
        let found = symmetries(&source, true, &|_| Ok(())).unwrap();
        println!("{:.4} edges", best(&found) / source.edge);
        assert_eq!(found.len(), 6);
        assert!(best(&found) < 0.5 * source.edge);
        // Kept for all holes: it may not matter which of them asked.
        let completion = (0..vertices.len()).map(|v| (v % 3) as u32).collect();
        let all = [vertices.len(), faces.len()];
        let whole = Source::completed(mesh, std::iter::empty(), completion, all, &|_| Ok(()));
        let whole = whole.unwrap();
        let of = |own| symmetries(&whole.for_hole(own), true, &|_| Ok(())).unwrap();
        assert!(of(0) == of(1) && of(0) == found);
        let turns = symmetries(&source, false, &|_| Ok(())).unwrap();
        assert!(turns.len() == 3 && turns.iter().all(|t| !t.is_mirrored()));
    }
}

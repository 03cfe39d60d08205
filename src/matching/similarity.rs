//! Zinßer, Schmidt and Niemann (2005), "Point set registration with integrated scale estimation": ICP
//! whose steps scale, too, for a source of another size.
//!
//! Differences from the paper: point-to-plane distances and trimming, as in [`super::icp`], and the scale
//! is an unknown of the same linear system as turn and shift: on a bent ring neither is right without
//! the others. A run that changes the scale much is given up: all points drawn together fit anywhere.

use super::icp::{find_partner, normal_equations, worth, Hint, Pairing, Partner, RingPoint, KEEP};
use super::point_tree::PointTree;
use super::rigid::Rigid;
use super::source::{Source, SourceMesh};
use crate::error::Result;
use crate::intersect::Bvh;
use glam::{DMat3, DQuat, DVec3};

/// Steps at most; from a tenth of the radius it takes five to ten.
const STEPS: usize = 40;
/// A step that moves no point by more than this part of an edge is the last: rounding.
const STILL: f64 = 1e-9;
/// Greatest change of scale: twice what lies between two hypotheses (10 %).
const MOST: f64 = 1.2;
/// Where shape alone moves a point by less than this, in edges, it is more exact than the colours.
const NEAR: f64 = 0.2;

/// By how much a transform scales: the cube root of its determinant's size.
pub fn scale_of(transform: &Rigid) -> f64 {
    transform.linear.determinant().abs().cbrt()
}

/// The same where a source is of another size; 1 where there are strains and rounding only.
pub fn size_change(transform: &Rigid) -> f64 {
    let scale = scale_of(transform);
    match (0.8..1.25).contains(&scale) {
        true => 1.0,
        false => scale,
    }
}

/// A scaling about the origin.
pub fn scaling(factor: f64) -> Rigid {
    Rigid { linear: DMat3::from_diagonal(DVec3::splat(factor)), translation: DVec3::ZERO }
}

/// A source of another size, its trees made anew.
pub fn scaled(source: &Source, factor: f64, check: &dyn Fn() -> Result<()>) -> Result<Source> {
    let positions: Vec<DVec3> = source.positions.iter().map(|&p| factor * p).collect();
    let paint = source.paint.clone().map(|mut paint| {
        paint.slopes.iter_mut().for_each(|s| *s /= factor);
        paint
    });
    let mesh = SourceMesh {
        axes: source.axes,
        tree: Bvh::new_checked(&positions, &source.faces, &|_| check())?,
        points: PointTree::new(&positions, source.points.ids().to_vec(), &|_| check())?,
        positions,
        normals: source.normals.clone(),
        faces: source.faces.clone(),
        face_ids: source.face_ids.clone(),
        on_boundary: source.on_boundary.clone(),
        completion: source.completion.clone(),
        known_vertices: source.known_vertices,
        known_faces: source.known_faces,
        area: factor * factor * source.area,
        edge: factor * source.edge,
        roughness: source.roughness.clone(),
        shifts: source.shifts.iter().map(|&(face, by)| (face, factor * by)).collect(),
        lengths: source.lengths.iter().map(|l| factor * l).collect(),
        paint,
    };
    Ok(Source::of(mesh).for_hole(source.own))
}

/// Improves a similarity (source to target) to rounding; `with_scale`: its scale, too. `radius` bounds how
/// far a partner may lie, in units of the target.
pub fn refine(
    source: &Source,
    ring: &[RingPoint],
    start: &Rigid,
    with_scale: bool,
    radius: f64,
) -> Rigid {
    let reach = radius * scale_of(&start.inverse());
    let found = run(source, ring, start, with_scale, reach, worth(source));
    if worth(source) == 0.0 {
        return found;
    }
    // Smoothed tints differ where the hole cut their surroundings off: the last word is the shape's, where
    // it has something to say.
    let last = run(source, ring, &found, with_scale, reach, 0.0);
    let moved = ring.iter().map(|p| last.inverse().point(p.0).distance(found.inverse().point(p.0)));
    match moved.fold(0.0, f64::max) < NEAR * source.edge {
        true => last,
        false => found,
    }
}

/// Root mean square distance of the ring from the planes at its partners, in units of the target; those
/// without one count as `radius`.
pub fn gap(source: &Source, ring: &[RingPoint], transform: &Rigid, radius: f64) -> f64 {
    let back = transform.inverse();
    let scale = scale_of(&back);
    let square = |p: &RingPoint| {
        let at = back.point(p.0);
        let hint = &mut Hint::NOTHING.clone();
        let met = find_partner(source, at, Partner::Surface, scale * radius, hint);
        met.map_or(radius, |(q, m, ..)| (q - at).dot(m) / scale).powi(2)
    };
    (ring.iter().map(square).sum::<f64>() / ring.len().max(1) as f64).sqrt()
}

fn run(
    source: &Source,
    ring: &[RingPoint],
    start: &Rigid,
    with_scale: bool,
    reach: f64,
    paint: f64,
) -> Rigid {
    let first = start.inverse();
    let mut back = first;
    let mut hints = vec![Hint::NOTHING; ring.len()];
    for _ in 0..STEPS {
        let step = improve(source, ring, &back, with_scale, reach, paint, &mut hints);
        let Some(step) = step else { break };
        let new = step.after(&back);
        let moved = ring.iter().map(|p| new.point(p.0).distance(back.point(p.0)));
        let moved = moved.fold(0.0, f64::max);
        back = new;
        if moved < STILL * source.edge {
            break;
        }
    }
    let change = scale_of(&back) / scale_of(&first);
    match (1.0 / MOST..=MOST).contains(&change) {
        true => back.inverse(),
        false => *start,
    }
}

fn improve(
    source: &Source,
    ring: &[RingPoint],
    back: &Rigid,
    with_scale: bool,
    reach: f64,
    paint: f64,
    hints: &mut [Hint],
) -> Option<Rigid> {
    let partner = Partner::Surface;
    let pairing = Pairing { source, partner, radius: reach, keep: KEEP, paint };
    let (pairs, middle) = pairing.find(ring, back, hints)?;
    let (mut a, b) = normal_equations(&pairs, paint > 0.0, |p, m| {
        let (c, d) = ((p - middle).cross(m), if with_scale { (p - middle).dot(m) } else { 0.0 });
        [c.x, c.y, c.z, m.x, m.y, m.z, d]
    });
    // Directions that a plane or a cylinder leaves free stay as they are.
    let extent = pairs.iter().map(|p| p.place.distance_squared(middle)).sum::<f64>();
    for k in 0..7 {
        a[(k, k)] += 1e-6 * if (3..6).contains(&k) { pairs.len() as f64 } else { extent };
    }
    let x = a.cholesky()?.solve(&b);
    let turn = DVec3::new(x[0], x[1], x[2]);
    // A larger turn than 20°, or more than a tenth in scale, is beyond the linearisation.
    let turn = turn.clamp_length_max(0.35);
    let linear = (1.0 + x[6].clamp(-0.1, 0.1)) * DMat3::from_quat(DQuat::from_scaled_axis(turn));
    let shift = DVec3::new(x[3], x[4], x[5]).clamp_length_max(reach);
    Some(Rigid { linear, translation: middle + shift - linear * middle })
}

#[cfg(test)]
mod tests {
    use super::super::source::tests::{hilly_source, some_transform};
    use super::*;

    /// Points on the source's own triangles, moved and scaled.
    fn ring(source: &Source, to: &Rigid) -> Vec<RingPoint> {
        let near = |p: &DVec3| (0.3..0.6).contains(&p.truncate().length());
        let all = source.positions.iter().zip(&source.normals).filter(|(p, _)| near(p));
        all.map(|(&p, &n)| (to.point(p), to.direction(n).normalize(), 0.0)).collect()
    }

    /// A scale 8 % off, a turn and a shift: all come back to rounding, mirrored or not; without scale the
    /// error stays.
    #[test]
    fn a_known_similarity_comes_back() {
        let source = hilly_source(60);
        for (mirrored, scale) in [(false, 0.2), (true, 3.0)] {
            let truth = some_transform(mirrored).after(&scaling(scale));
            let ring = ring(&source, &truth);
            let turn = DMat3::from_axis_angle(DVec3::new(1.0, 2.0, -2.0) / 3.0, 0.1);
            let shift = DVec3::new(0.02, -0.03, 0.01);
            let off = Rigid { linear: 1.08 * turn, translation: shift };
            let start = truth.after(&off);
            let worst = |t: &Rigid| {
                let apart =
                    |p: &RingPoint| t.inverse().point(p.0).distance(truth.inverse().point(p.0));
                ring.iter().map(apart).fold(0.0, f64::max) / source.edge
            };
            let found = refine(&source, &ring, &start, true, 0.2 * scale);
            let rigid = refine(&source, &ring, &start, false, 0.2 * scale);
            println!("{:.3} {:.1e} {:.3}", worst(&start), worst(&found), worst(&rigid));
            assert_eq!(found.is_mirrored(), mirrored);
            assert!(worst(&start) > 0.5 && worst(&found) < 1e-6);
            assert!((scale_of(&found) / scale - 1.0).abs() < 1e-7);
            assert!(
                (scale_of(&rigid) / scale_of(&start) - 1.0).abs() < 1e-9 && worst(&rigid) > 0.1
            );
        }
    }

    /// What is scaled answers as the original does, at its own size.
    #[test]
    fn a_scaled_source_is_the_same_thing_in_another_unit() {
        let source = hilly_source(20);
        let large = scaled(&source, 5.0, &|| Ok(())).unwrap();
        assert!((large.edge / source.edge - 5.0).abs() < 1e-12);
        assert!((large.area / source.area - 25.0).abs() < 1e-9);
        let p = DVec3::new(0.1, 0.2, 0.4);
        let (v, d2) = source.points.nearest(p).unwrap();
        let (w, e2) = large.points.nearest(5.0 * p).unwrap();
        assert!(v == w && (e2 / d2 - 25.0).abs() < 1e-9);
        let [a, b] = [(&source, 1.0), (&large, 5.0)]
            .map(|(s, f)| s.tree.closest_point(f * p, f64::INFINITY).unwrap().distance / f);
        assert!((a - b).abs() < 1e-12);
    }

    /// Nothing near: the start is given back.
    #[test]
    fn too_few_pairs_move_nothing() {
        let source = hilly_source(20);
        let far = Rigid { translation: 50.0 * DVec3::X, ..Rigid::IDENTITY };
        let ring = ring(&source, &Rigid::IDENTITY);
        assert_eq!(refine(&source, &ring, &far, true, 0.2).translation, far.translation);
    }
}

//! Leifman and Tal (2012), "Mesh colorization", as Harary et al. (2014, sec. 6) use it: a tangent
//! field across the ridges and valleys, carried on over the whole object.
//!
//! At the vertices of the faces through which a line passes the field is perpendicular to the
//! line, away from valleys and towards ridges. Elsewhere each coordinate solves L f = 0; then f is
//! brought into the tangent plane and to length 1.
//!
//! Differences from the paper: it gives a direction to vertices that share a face with exactly two
//! marked vertices, which drops the places where lines end or meet. Here every marked vertex has
//! one, but for those whose lines disagree.

use crate::descriptor::curvature::vertex_normal;
use crate::descriptor::ridges::{LineKind, Segment};
use crate::fill::sheet::{Incidence, Laplacian, Weights};
use crate::fill::solve::System;
use glam::DVec3;

/// Length of the mean direction below which the lines at a vertex disagree: cos 60°.
const AGREEMENT: f64 = 0.5;
/// Share of the diagonal added to it, so that a part of the mesh without lines has a solution
/// (nothing); over a hundred edges it changes nothing.
const SCREEN: f64 = 1e-9;

/// The feature-line field at the vertices of a mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct FeatureField {
    /// Unit tangents; zero where no line is connected.
    pub direction: Vec<DVec3>,
    /// Whether the direction comes from a line through a face of the vertex.
    pub is_feature: Vec<bool>,
}

/// The field of the given lines. `None` if the harmonic system has no factor.
pub fn feature_line_field(
    positions: &[DVec3],
    faces: &[[u32; 3]],
    incidence: &Incidence,
    lines: &[Segment],
) -> Option<FeatureField> {
    let normal = |v: usize| vertex_normal(positions, faces, incidence.faces(v as u32));
    let mut direction = directions_at_lines(positions, faces, lines, &normal);
    let is_feature: Vec<bool> = direction.iter().map(|d| *d != DVec3::ZERO).collect();
    interpolate(positions, faces, &is_feature, &mut direction)?;
    for (v, d) in direction.iter_mut().enumerate() {
        let n = normal(v);
        // What is left of a field that has faded to rounding errors points nowhere.
        *d =
            if d.length() > 1e-12 { (*d - n * n.dot(*d)).normalize_or_zero() } else { DVec3::ZERO };
    }
    Some(FeatureField { direction, is_feature })
}

/// The mean of the directions that the lines give to each vertex of their faces; zero elsewhere.
fn directions_at_lines(
    positions: &[DVec3],
    faces: &[[u32; 3]],
    lines: &[Segment],
    normal: &dyn Fn(usize) -> DVec3,
) -> Vec<DVec3> {
    let mut sum = vec![DVec3::ZERO; positions.len()];
    let mut count = vec![0.0; positions.len()];
    for line in lines {
        let along = (line.ends[1] - line.ends[0]).normalize_or_zero();
        for v in faces[line.face as usize].map(|v| v as usize) {
            let away = positions[v] - line.ends[0];
            let n = normal(v);
            let across = n.cross(along).normalize_or_zero();
            let side = across.dot(away);
            let outward = if side < 0.0 { -across } else { across };
            sum[v] += if line.kind == LineKind::Valley { outward } else { -outward };
            count[v] += 1.0;
        }
    }
    for (s, count) in sum.iter_mut().zip(count) {
        let agree = count > 0.0 && s.length() >= AGREEMENT * count;
        *s = if agree { s.normalize() } else { DVec3::ZERO };
    }
    sum
}

/// Harmonic interpolation: solves L x = 0 with `values` kept where `is_fixed`, with cotangent
/// weights. Vertices without faces get zero. `None` if the system has no factor.
pub fn interpolate(
    positions: &[DVec3],
    faces: &[[u32; 3]],
    is_fixed: &[bool],
    values: &mut [DVec3],
) -> Option<()> {
    let l = Laplacian::new(positions, faces, Weights::Cotangent);
    let mut number = vec![usize::MAX; positions.len()];
    let mut count = 0;
    for v in 0..positions.len() {
        if !is_fixed[v] && l.diagonal[v] > 0.0 {
            number[v] = count;
            count += 1;
        }
    }
    let mut system = System::new(count);
    for v in (0..positions.len()).filter(|&v| number[v] != usize::MAX) {
        let mut rhs = DVec3::ZERO;
        system.add(number[v], (1.0 + SCREEN) * l.diagonal[v]);
        for (w, weight) in l.row(v) {
            match number[w] {
                usize::MAX => rhs += weight * values[w],
                i => system.add(i, -weight),
            }
        }
        system.end_column(rhs);
    }
    let solution = system.solve()?;
    for v in 0..positions.len() {
        if number[v] != usize::MAX {
            values[v] = solution[number[v]];
        } else if !is_fixed[v] {
            values[v] = DVec3::ZERO;
        }
    }
    Some(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::descriptor::curvature::tests::grid;

    fn plane() -> (Vec<DVec3>, Vec<[u32; 3]>, Incidence) {
        let (positions, faces) = grid((30, 30), (false, false), |u, v| DVec3::new(u, v, 0.0));
        let incidence = Incidence::of(positions.len(), &faces);
        (positions, faces, incidence)
    }

    #[test]
    fn linear_functions_are_harmonic() {
        let (positions, faces, _) = plane();
        let is_border = |p: &DVec3| p.x.min(p.y) < 0.01 || p.x.max(p.y) > 0.96;
        let fixed: Vec<bool> = positions.iter().map(is_border).collect();
        let truth = |p: &DVec3| DVec3::new(p.x, 2.0 * p.y - p.x, 1.0);
        let mut values: Vec<DVec3> = positions
            .iter()
            .zip(&fixed)
            .map(|(p, f)| if *f { truth(p) } else { DVec3::NAN })
            .collect();
        interpolate(&positions, &faces, &fixed, &mut values).unwrap();
        for (p, v) in positions.iter().zip(&values) {
            assert!(v.distance(truth(p)) < 1e-6, "{p}: {v}");
        }
    }

    /// A valley along y at x = 0.51: away from it on both sides; a ridge there: towards it.
    #[test]
    fn the_field_crosses_a_line_as_its_kind_says() {
        let (positions, faces, incidence) = plane();
        for (kind, sign) in [(LineKind::Valley, 1.0), (LineKind::Ridge, -1.0)] {
            let mut lines = Vec::new();
            for (f, face) in faces.iter().enumerate() {
                let p = face.map(|v| positions[v as usize]);
                let crossing = |a: DVec3, b: DVec3| {
                    let t = (0.51 - a.x) / (b.x - a.x);
                    (t > 0.0 && t < 1.0).then(|| a.lerp(b, t))
                };
                let ends: Vec<DVec3> =
                    (0..3).filter_map(|k| crossing(p[k], p[(k + 1) % 3])).collect();
                if let [a, b] = ends[..] {
                    lines.push(Segment { face: f as u32, ends: [a, b], kind });
                }
            }
            assert!(lines.len() > 25);
            let field = feature_line_field(&positions, &faces, &incidence, &lines).unwrap();
            assert!(field.is_feature.iter().filter(|&&f| f).count() >= 60);
            for (p, d) in positions.iter().zip(&field.direction) {
                let expected = DVec3::X * sign * (p.x - 0.51).signum();
                assert!(d.distance(expected) < 1e-6, "{p}: {d}");
            }
        }
    }

    #[test]
    fn without_lines_there_is_no_field() {
        let (positions, faces, incidence) = plane();
        let field = feature_line_field(&positions, &faces, &incidence, &[]).unwrap();
        assert!(field.direction.iter().all(|d| *d == DVec3::ZERO));
    }
}

//! Ohtake, Belyaev and Seidel (2004), "Ridge-valley lines on meshes via implicit surface fitting":
//! the lines along which a surface bends most sharply, outward (ridges) and inward (valleys).
//!
//! A ridge is where the greater curvature has a maximum along its own direction:
//! k_max > |k_min|, e = ∂k_max/∂t_max = 0, ∂e/∂t_max < 0; a valley is a ridge of the surface
//! turned inside out.
//!
//! Differences from the paper:
//! - Curvatures and extremalities come from fits on the mesh ([`super::curvature`]), not from an
//!   implicit surface fitted to it: no second surface to build and to bring into agreement.
//! - Lines are weighed by ∫ |k| ds along them, as there, but only to drop weak ones; no gaps
//!   between lines are bridged, for nothing here follows a line from end to end.

use super::curvature::Curvature;
use crate::mesh::roots::Roots;
use glam::DVec3;
use std::collections::HashMap;

/// What a line is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LineKind {
    /// Convex.
    Ridge,
    /// Concave.
    Valley,
}

/// The part of a line that lies in one face.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Segment {
    /// The face.
    pub face: u32,
    /// Where the line enters and leaves it; the middle of the face where three lines meet.
    pub ends: [DVec3; 2],
    /// Ridge or valley.
    pub kind: LineKind,
}

/// A point of a line, on an edge.
struct Crossing {
    point: DVec3,
    curvature: f64,
}

/// All ridges and valleys with ∫ |k| ds of at least `least_strength` (no unit: the length of a line
/// in radii of its curvature), face by face, ridges first.
pub fn find_feature_lines(
    positions: &[DVec3],
    faces: &[[u32; 3]],
    curvature: &[Curvature],
    least_strength: f64,
) -> Vec<Segment> {
    let mut lines = Vec::new();
    for kind in [LineKind::Ridge, LineKind::Valley] {
        lines.extend(lines_of(kind, positions, faces, curvature, least_strength));
    }
    lines
}

fn lines_of(
    kind: LineKind,
    positions: &[DVec3],
    faces: &[[u32; 3]],
    curvature: &[Curvature],
    least_strength: f64,
) -> Vec<Segment> {
    let mut number: HashMap<(u32, u32), Option<u32>> = HashMap::new();
    let mut crossings: Vec<Crossing> = Vec::new();
    // (segment, crossing at its first end, its strength)
    let mut pieces: Vec<(Segment, u32, f64)> = Vec::new();
    // Crossings of one line.
    let mut joined = Roots::default();
    for (f, face) in faces.iter().enumerate() {
        if !face.iter().all(|&v| bends_most(kind, &curvature[v as usize])) {
            continue;
        }
        let mut here = Vec::with_capacity(3);
        for k in 0..3 {
            let (a, b) = (face[k].min(face[(k + 1) % 3]), face[k].max(face[(k + 1) % 3]));
            let found = *number.entry((a, b)).or_insert_with(|| {
                let crossing = cross_edge(kind, positions, curvature, a, b)?;
                crossings.push(crossing);
                Some(joined.add())
            });
            here.extend(found);
        }
        let middle = face.iter().map(|&v| positions[v as usize]).sum::<DVec3>() / 3.0;
        let mut piece = |i: u32, end: DVec3, k: f64| {
            let start = &crossings[i as usize];
            let strength = start.point.distance(end) * 0.5 * (start.curvature + k);
            let segment = Segment { face: f as u32, ends: [start.point, end], kind };
            pieces.push((segment, i, strength));
        };
        match here[..] {
            [i, j] => {
                let end = &crossings[j as usize];
                piece(i, end.point, end.curvature);
                joined.join(i, j);
            }
            [i, j, k] => {
                here.iter().for_each(|&i| piece(i, middle, crossings[i as usize].curvature));
                joined.join(i, j);
                joined.join(i, k);
            }
            _ => {}
        }
    }
    let mut strength = vec![0.0; crossings.len()];
    pieces.iter().for_each(|&(_, i, s)| strength[joined.root(i) as usize] += s);
    pieces.retain(|&(_, i, _)| strength[joined.root(i) as usize] >= least_strength);
    pieces.into_iter().map(|(segment, ..)| segment).collect()
}

/// The curvature, its direction and its derivative that make lines of this kind; of valleys those
/// of the surface turned inside out. Last the other curvature, without its sign.
fn sharper(kind: LineKind, c: &Curvature) -> (f64, DVec3, f64, f64) {
    match kind {
        LineKind::Ridge => (c.max, c.max_direction, c.max_extremality, c.min.abs()),
        LineKind::Valley => (-c.min, c.min_direction, -c.min_extremality, c.max.abs()),
    }
}

fn bends_most(kind: LineKind, c: &Curvature) -> bool {
    let (k, _, _, other) = sharper(kind, c);
    k > other
}

/// Where the curvature has its maximum on an edge, if it has one.
fn cross_edge(
    kind: LineKind,
    positions: &[DVec3],
    curvature: &[Curvature],
    a: u32,
    b: u32,
) -> Option<Crossing> {
    let (p, q) = (positions[a as usize], positions[b as usize]);
    let (k, t, e, _) = sharper(kind, &curvature[a as usize]);
    let (l, mut u, mut f, _) = sharper(kind, &curvature[b as usize]);
    if t.dot(u) < 0.0 {
        (u, f) = (-u, -f);
    }
    let is_maximum = e * t.dot(q - p) > 0.0 || f * u.dot(p - q) > 0.0;
    if e * f >= 0.0 || !is_maximum {
        return None;
    }
    let share = e.abs() / (e.abs() + f.abs());
    Some(Crossing { point: p.lerp(q, share), curvature: k + share * (l - k) })
}

#[cfg(test)]
mod tests {
    use super::super::curvature::tests::{curvatures, grid};
    use super::*;

    /// A wave along x: ridges at its crests, valleys in its troughs, and nothing else.
    #[test]
    fn a_wave_has_its_lines_at_crests_and_troughs() {
        // Uneven steps, so that no crest lies on a row of vertices.
        let at = |u: f64, v: f64| {
            let x = 4.03 * u + 0.02 * (40.0 * v).sin();
            DVec3::new(x, 4.0 * v, 0.2 * (std::f64::consts::PI * x).cos())
        };
        let (positions, faces) = grid((120, 120), (false, false), at);
        let lines = find_feature_lines(&positions, &faces, &curvatures(&positions, &faces), 1.0);
        let (mut ridges, mut valleys) = (0.0, 0.0);
        for s in &lines {
            let middle = 0.5 * (s.ends[0] + s.ends[1]);
            // Fits at the border are one-sided.
            if middle.x < 0.3 || middle.x > 3.7 || middle.y < 0.3 || middle.y > 3.7 {
                continue;
            }
            let crest =
                if s.kind == LineKind::Ridge { 2.0 } else { 2.0 * (middle.x / 2.0).floor() + 1.0 };
            assert!((middle.x - crest).abs() < 0.03, "{s:?}");
            let length = s.ends[0].distance(s.ends[1]);
            *if s.kind == LineKind::Ridge { &mut ridges } else { &mut valleys } += length;
        }
        assert!((ridges - 3.4).abs() < 0.3, "{ridges}");
        assert!((valleys - 6.8).abs() < 0.6, "{valleys}");
    }

    #[test]
    fn weak_lines_are_dropped_and_a_sphere_has_none() {
        let at = |u: f64, v: f64| DVec3::new(u, v, 0.0005 * (20.0 * u).cos());
        let (positions, faces) = grid((40, 40), (false, false), at);
        let all = curvatures(&positions, &faces);
        assert!(find_feature_lines(&positions, &faces, &all, 1.0).is_empty());
        assert!(!find_feature_lines(&positions, &faces, &all, 0.01).is_empty());
    }
}

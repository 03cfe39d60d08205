//! Cazals and Pouget (2005), "Estimating differential quantities using polynomial fitting of
//! osculating jets": principal curvatures, their directions, and their derivatives along them.
//!
//! Differences from the paper:
//! - Always degree three, which the derivatives need; normal equations in coordinates scaled to
//!   the neighbourhood instead of an SVD: ten unknowns, well conditioned there.
//! - Two fits: the second in the tangent plane of the first, so that the terms in the slope, which
//!   the formulas below leave out, vanish.

use crate::error::Result;
use crate::fill::sheet::Incidence;
use crate::progress::Monitor;
use glam::DVec3;

/// Coefficients of a cubic in two variables.
const TERMS: usize = 10;
/// Fewest points that decide ten coefficients with something to spare.
const FEWEST: usize = 13;
/// Most points of one fit: four rings of a regular mesh have 61.
const MOST: usize = 64;
/// Rings looked through at most, where vertices have few neighbours.
const MOST_RINGS: usize = 8;
/// Vertices between two looks at the wish to stop.
const BLOCK: usize = 1024;

/// The curvature of the surface at a vertex. Positive where the surface is convex seen from
/// outside: on a sphere of radius r both are 1/r.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Curvature {
    /// Outward unit normal.
    pub normal: DVec3,
    /// The greater principal curvature, in 1 / mesh unit.
    pub max: f64,
    /// The smaller one.
    pub min: f64,
    /// Unit tangent along the greater one.
    pub max_direction: DVec3,
    /// Unit tangent along the smaller one.
    pub min_direction: DVec3,
    /// Derivative of the greater curvature along its direction, in 1 / mesh unit².
    pub max_extremality: f64,
    /// Derivative of the smaller curvature along its direction.
    pub min_extremality: f64,
}

impl Curvature {
    /// Where nothing is known.
    pub const FLAT: Self = Self {
        normal: DVec3::ZERO,
        max: 0.0,
        min: 0.0,
        max_direction: DVec3::ZERO,
        min_direction: DVec3::ZERO,
        max_extremality: 0.0,
        min_extremality: 0.0,
    };

    /// The curvature that is greater without its sign, without its sign.
    pub fn magnitude(&self) -> f64 {
        self.max.abs().max(self.min.abs())
    }
}

/// Curvatures at all vertices from fits over `rings` rings of neighbours (2 or 3; more rings,
/// less noise and less detail).
pub fn principal_curvatures(
    positions: &[DVec3],
    faces: &[[u32; 3]],
    incidence: &Incidence,
    rings: usize,
    monitor: &Monitor,
) -> Result<Vec<Curvature>> {
    let mut rings_of = Rings::new(positions.len());
    let mut result = Vec::with_capacity(positions.len());
    for v in 0..positions.len() as u32 {
        if (v as usize).is_multiple_of(BLOCK) {
            monitor.check()?;
        }
        rings_of.gather(v, faces, incidence, rings);
        let normal = vertex_normal(positions, faces, incidence.faces(v));
        result.push(fit(positions, &rings_of.found, normal).unwrap_or(Curvature::FLAT));
    }
    Ok(result)
}

/// Area-weighted unit normal of a vertex; zero where its faces have no area.
pub fn vertex_normal(positions: &[DVec3], faces: &[[u32; 3]], at_vertex: &[u32]) -> DVec3 {
    let normal = |&f: &u32| {
        let [a, b, c] = faces[f as usize].map(|v| positions[v as usize]);
        (b - a).cross(c - a)
    };
    at_vertex.iter().map(normal).sum::<DVec3>().normalize_or_zero()
}

/// Rings of vertices around a vertex, without searching twice.
struct Rings {
    seen: Vec<u32>,
    found: Vec<u32>,
}

impl Rings {
    fn new(vertex_count: usize) -> Self {
        Self { seen: vec![u32::MAX; vertex_count], found: Vec::new() }
    }

    /// `v` and its rings, more than asked for while there are too few points.
    fn gather(&mut self, v: u32, faces: &[[u32; 3]], incidence: &Incidence, rings: usize) {
        self.found.clear();
        self.found.push(v);
        self.seen[v as usize] = v;
        let mut begin = 0;
        for ring in 0..MOST_RINGS {
            let end = self.found.len();
            if ring >= rings && end >= FEWEST || begin == end || end >= MOST {
                break;
            }
            for i in begin..end {
                for w in incidence.faces(self.found[i]).iter().flat_map(|&f| faces[f as usize]) {
                    if std::mem::replace(&mut self.seen[w as usize], v) != v {
                        self.found.push(w);
                    }
                }
            }
            begin = end;
        }
        self.found.truncate(MOST);
    }
}

/// The curvature at the first point. `None` if the points do not decide it.
fn fit(positions: &[DVec3], points: &[u32], normal: DVec3) -> Option<Curvature> {
    if points.len() < TERMS || normal == DVec3::ZERO {
        return None;
    }
    let first = jet(positions, points, normal)?;
    let slope = first.x * first.terms[1] + first.y * first.terms[2];
    let jet = jet(positions, points, (normal - slope).normalize())?;
    let (t, h) = (jet.terms, jet.scale);
    // z = … + a x² + b xy + c y² + …; its Hessian's eigenvalues are minus the curvatures.
    let (a, b, c) = (2.0 * t[3], t[4], 2.0 * t[5]);
    let (mean, half) = (0.5 * (a + c), (0.25 * (a - c).powi(2) + b * b).sqrt());
    let angle = 0.5 * f64::atan2(2.0 * b, a - c);
    // The angle belongs to mean + half, the smaller curvature.
    let (s, u) = angle.sin_cos();
    let third = |x: f64, y: f64| {
        -6.0 * (t[6] * x * x * x + t[7] * x * x * y + t[8] * x * y * y + t[9] * y * y * y) / (h * h)
    };
    Some(Curvature {
        normal: jet.normal,
        max: -(mean - half) / h,
        min: -(mean + half) / h,
        max_direction: jet.x * -s + jet.y * u,
        min_direction: jet.x * u + jet.y * s,
        max_extremality: third(-s, u),
        min_extremality: third(u, s),
    })
}

/// A cubic height function over a tangent plane, everything in units of `scale`.
struct Jet {
    normal: DVec3,
    x: DVec3,
    y: DVec3,
    scale: f64,
    /// Of 1, x, y, x², xy, y², x³, x²y, xy², y³.
    terms: [f64; TERMS],
}

fn jet(positions: &[DVec3], points: &[u32], normal: DVec3) -> Option<Jet> {
    let origin = positions[points[0] as usize];
    let (x, y) = normal.any_orthonormal_pair();
    let far = |&v: &u32| positions[v as usize].distance_squared(origin);
    let scale = points.iter().map(far).fold(0.0, f64::max).sqrt();
    if scale <= 0.0 {
        return None;
    }
    let mut matrix = [[0.0; TERMS]; TERMS];
    let mut rhs = [0.0; TERMS];
    for &v in points {
        let d = (positions[v as usize] - origin) / scale;
        let (p, q, z) = (d.dot(x), d.dot(y), d.dot(normal));
        let row = [1.0, p, q, p * p, p * q, q * q, p * p * p, p * p * q, p * q * q, q * q * q];
        for i in 0..TERMS {
            for j in 0..=i {
                matrix[i][j] += row[i] * row[j];
            }
            rhs[i] += row[i] * z;
        }
    }
    let terms = solve_cholesky(matrix, rhs)?;
    Some(Jet { normal, x, y, scale, terms })
}

/// Solves a small positive definite system given by its lower triangle.
fn solve_cholesky(mut m: [[f64; TERMS]; TERMS], mut x: [f64; TERMS]) -> Option<[f64; TERMS]> {
    // Points on a line or a conic leave a direction open; a trace of damping closes it.
    let damping = 1e-10 * (0..TERMS).map(|i| m[i][i]).sum::<f64>();
    for i in 0..TERMS {
        for j in 0..=i {
            let mut sum = m[i][j] + if i == j { damping } else { 0.0 };
            for k in 0..j {
                sum -= m[i][k] * m[j][k];
            }
            m[i][j] = match i == j {
                true if sum > 0.0 => sum.sqrt(),
                true => return None,
                false => sum / m[j][j],
            };
        }
    }
    for i in 0..TERMS {
        for k in 0..i {
            x[i] -= m[i][k] * x[k];
        }
        x[i] /= m[i][i];
    }
    for i in (0..TERMS).rev() {
        for k in i + 1..TERMS {
            x[i] -= m[k][i] * x[k];
        }
        x[i] /= m[i][i];
    }
    x.iter().all(|t| t.is_finite()).then_some(x)
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// A grid over (u, v) in [0, 1)², closed in both directions if asked.
    pub(crate) fn grid(
        (n, m): (usize, usize),
        closed: (bool, bool),
        at: impl Fn(f64, f64) -> DVec3,
    ) -> (Vec<DVec3>, Vec<[u32; 3]>) {
        // A shear makes the triangles uneven, so that no symmetry hides an error.
        let point = |i: usize, j: usize| {
            let shear = if closed.1 { 0.3 * j as f64 } else { 0.0 };
            at((i as f64 + shear) / n as f64, j as f64 / m as f64)
        };
        let positions = (0..n * m).map(|k| point(k % n, k / n)).collect();
        let mut faces = Vec::new();
        for j in 0..if closed.1 { m } else { m - 1 } {
            for i in 0..if closed.0 { n } else { n - 1 } {
                // Around the second seam the shear has moved the first row.
                let wrap = |i: usize, j: usize| {
                    let moved = if j == m { (0.3 * m as f64).round() as usize } else { 0 };
                    (((i + moved) % n) + (j % m) * n) as u32
                };
                let [a, b, c, d] = [wrap(i, j), wrap(i + 1, j), wrap(i + 1, j + 1), wrap(i, j + 1)];
                faces.push([a, b, c]);
                faces.push([a, c, d]);
            }
        }
        (positions, faces)
    }

    pub(crate) fn curvatures(positions: &[DVec3], faces: &[[u32; 3]]) -> Vec<Curvature> {
        let incidence = Incidence::of(positions.len(), faces);
        principal_curvatures(positions, faces, &incidence, 3, &Monitor::silent()).unwrap()
    }

    #[test]
    fn a_sphere_is_as_curved_as_its_radius_says() {
        let at = |u: f64, v: f64| {
            let (a, z) = (TAU * u, 0.3 + 0.9 * v);
            2.0 * DVec3::new(a.cos() * z.sin(), a.sin() * z.sin(), -z.cos())
        };
        let (positions, faces) = grid((80, 14), (true, false), at);
        for (p, c) in positions.iter().zip(curvatures(&positions, &faces)) {
            assert!((c.max - 0.5).abs() < 0.02 && (c.min - 0.5).abs() < 0.02, "{p}: {c:?}");
            assert!(c.normal.dot(p.normalize()) > 0.999);
        }
    }

    #[test]
    fn a_cylinder_is_curved_across_only() {
        let at = |u: f64, v: f64| DVec3::new((TAU * u).cos(), (TAU * u).sin(), 2.0 * v);
        let (positions, faces) = grid((60, 20), (true, false), at);
        for (p, c) in positions.iter().zip(curvatures(&positions, &faces)) {
            // At the border a fit knows one side only.
            let slack = if p.z > 0.25 && p.z < 1.7 { 0.03 } else { 0.06 };
            assert!((c.max - 1.0).abs() < slack && c.min.abs() < slack, "{p}: {c:?}");
            assert!(c.min_direction.dot(DVec3::Z).abs() > 0.999);
            assert!(c.max_extremality.abs() < 10.0 * slack);
        }
    }

    /// Radii 1 and r: across the tube 1/r, along it cos t / (1 + r cos t), with a derivative of 0
    /// along itself, as the surface is one of revolution; and the saddle inside is concave.
    #[test]
    fn a_torus_has_the_curvatures_of_its_circles() {
        let r = 0.4;
        let at = |u: f64, v: f64| {
            let (a, t) = (TAU * u, TAU * v);
            let out = 1.0 + r * t.cos();
            DVec3::new(out * a.cos(), out * a.sin(), r * t.sin())
        };
        let (positions, faces) = grid((200, 80), (true, true), at);
        for (p, c) in positions.iter().zip(curvatures(&positions, &faces)) {
            let out = p.truncate().length();
            let along = (out - 1.0) / r / out;
            assert!((c.max - 1.0 / r).abs() < 0.05, "{c:?}");
            assert!((c.min - along).abs() < 0.05, "{} instead of {along}", c.min);
            assert!(c.min_direction.dot(DVec3::Z).abs() < 0.02);
        }
    }

    /// z = −½ x² − ⅙ b x³ is Monge's form: the derivative at the origin is b.
    #[test]
    fn the_derivative_is_that_of_a_cubic() {
        let at = |u: f64, v: f64| {
            let (x, y) = (u - 0.5, v - 0.5);
            DVec3::new(x, y, -0.5 * x * x - 0.7 * x * x * x / 6.0)
        };
        let (positions, faces) = grid((41, 41), (false, false), at);
        let all = curvatures(&positions, &faces);
        let middle = (0..positions.len())
            .min_by(|&a, &b| positions[a].length().total_cmp(&positions[b].length()))
            .unwrap();
        let c = all[middle];
        assert!(positions[middle].length() < 0.03);
        let turned = c.max_extremality * c.max_direction.x.signum();
        assert!((turned - 0.7).abs() < 0.05, "{c:?}");
        assert!((c.max - 1.0).abs() < 0.05);
    }
}

//! Points of uneven density: a mesh's vertices thinned out, or rows of points across it.

use super::chance;
use glam::DVec3;
use std::collections::HashMap;

/// How the density of the points changes from place to place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Uneven {
    /// It falls to a ninth and rises again, along the longest side.
    Smooth,
    /// The one half has a ninth of the other's.
    Abrupt,
    /// Scan lines: points close together in rows that are three times farther apart.
    Rows,
}

/// Of the sparsest places: no two points are nearer, and none of the mesh's vertices is farther from all
/// points, in mean edges.
const SPARSE: f64 = 2.5;
/// Of the densest: nearly all vertices stay.
const DENSE: f64 = 0.7;
/// Mean distance of neighbours, in least ones.
const MEAN: f64 = 1.2;
/// Planes through the rows are so many mean edges apart ...
const ROWS: f64 = 2.5;
/// ... and turn where the surface is nearer to their direction than this cosine.
const ALONG: f64 = 0.7;

/// A point and the unit normal there.
pub type Sample = (DVec3, DVec3);

impl Uneven {
    /// By its name.
    pub fn named(name: &str) -> Option<Self> {
        match name {
            "smooth" => Some(Self::Smooth),
            "abrupt" => Some(Self::Abrupt),
            "rows" => Some(Self::Rows),
            _ => None,
        }
    }

    /// Mean distance of the points at a place from 0 to 1 along the longest side, in mean edges; of rows
    /// that between them.
    pub fn spacing(self, place: f64) -> f64 {
        (MEAN * self.least(place)).max(1.0)
    }

    fn least(self, place: f64) -> f64 {
        let sparse = match self {
            Self::Smooth => (1.5 * std::f64::consts::PI * place).sin().powi(2),
            Self::Abrupt => f64::from(place > 0.5),
            Self::Rows => 1.0,
        };
        DENSE + (SPARSE - DENSE) * sparse
    }

    /// The points, `all` being the vertices that `faces` use.
    pub fn points(
        self,
        all: &[Sample],
        faces: &[[u32; 3]],
        edge: f64,
        place: &dyn Fn(DVec3) -> f64,
    ) -> Vec<Sample> {
        match self {
            Self::Rows => thinned(&rows(all, faces, ROWS * edge), &|_| DENSE * edge),
            _ => thinned(all, &|p| self.least(place(p)) * edge),
        }
    }
}

/// Where edges cross planes that are so far apart.
fn rows(all: &[Sample], faces: &[[u32; 3]], apart: f64) -> Vec<Sample> {
    let mut made = Vec::new();
    for face in faces {
        let [a, b, c] = face.map(|v| all[v as usize].0);
        let level = (b - a).cross(c - a).normalize_or_zero().z.abs() < ALONG;
        let axis = if level { DVec3::Z } else { DVec3::X };
        for k in 0..3 {
            let ends = [face[k], face[(k + 1) % 3]];
            let [(p, n), (q, m)] =
                [ends[0].min(ends[1]), ends[0].max(ends[1])].map(|v| all[v as usize]);
            let [from, to] = [p, q].map(|p| p.dot(axis) / apart);
            let (first, last) = (from.min(to).ceil() as i64, from.max(to).floor() as i64);
            made.extend((first..=last).filter(|_| from != to).map(|plane| {
                let t = (plane as f64 - from) / (to - from);
                (p.lerp(q, t), n.lerp(m, t).normalize_or_zero())
            }));
        }
    }
    made
}

/// Poisson discs: in random order each that has no other nearer than its `least`, on the same side.
fn thinned(all: &[Sample], least: &dyn Fn(DVec3) -> f64) -> Vec<Sample> {
    let cell = all.iter().map(|s| least(s.0)).fold(f64::MIN_POSITIVE, f64::max);
    let at = |p: DVec3| (p / cell).floor().as_i64vec3();
    let mut order: Vec<u64> = (0..all.len() as u64).collect();
    order.sort_by(|&a, &b| chance(a).total_cmp(&chance(b)));
    let mut kept: HashMap<glam::I64Vec3, Vec<Sample>> = HashMap::new();
    let mut made = Vec::new();
    for i in order {
        let (p, n) = all[i as usize];
        let around =
            (0..27).map(|k| at(p) + glam::I64Vec3::new(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1));
        let near = |s: &Sample| s.0.distance(p) < least(p) && s.1.dot(n) > 0.0;
        if !around.filter_map(|c| kept.get(&c)).flatten().any(near) {
            kept.entry(at(p)).or_default().push((p, n));
            made.push((p, n));
        }
    }
    made
}

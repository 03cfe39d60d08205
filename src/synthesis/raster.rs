//! Turk and Levoy (1994), "Zippered polygon meshes from range images": a scanner takes its points at the nodes of a
//! raster, seen along a direction. Where the points around a hole still lie so, the raster goes on through the hole.
//!
//! Differences from the paper: there the raster is known; here it is found. Points on it have their structure factor
//!
//!   S(k) = |1/n Σ exp(2πi k·(p − o))|
//!
//! near 1 at some waves k. Two of them span it: its nodes are where both k·(p − o) are whole numbers but for a phase.

use crate::fill::patch::Patch;
use glam::DVec3;
use std::collections::BTreeMap;
use std::f64::consts::TAU;

/// Least structure factor of a wave. Points off it by a normal error of σ periods have exp(−2π² σ²), so σ is below 0.19
/// here; n points without order have 1/√n, the greatest of a million waves some four times that.
const LEAST: f64 = 0.5;
/// Fewest points that tell a raster: by chance none of a million waves reaches 0.3 then.
const FEWEST: usize = 200;
/// Periods looked at, in mean edges: least, of rows three times as far apart as the points in them, and greatest.
const PERIODS: [f64; 2] = [0.4, 2.0];
/// Points that the search begins with, and how many waves are followed from there; then both change twofold.
const FIRST: usize = 80;
const FOLLOWED: usize = 64;
/// Waves kept to the end.
const KEPT: usize = 8;
/// Sine of the least angle between the two waves: 30°.
const APART: f64 = 0.5;
/// Waves no longer than this many times another are about as long.
const ABOUT: f64 = 1.1;
/// A surface is seen if the cosine between its normal and the direction of view is greater: below, the nodes on it lie
/// three times as far apart as the raster's.
const SEEN: f64 = 0.33;
/// A raster is believed if it has so many nodes in the hole for each point that there shall be: within this range.
const COUNT: [f64; 2] = [0.6, 1.6];

/// A raster seen along a direction.
#[derive(Debug, Clone, Copy)]
pub struct Raster {
    origin: DVec3,
    waves: [DVec3; 2],
    /// Of the waves, in turns.
    phases: [f64; 2],
}

impl Raster {
    /// The raster that points lie on, if they do. `starts`: places among them where the search begins; `edge`: their mean
    /// edge length.
    pub fn find(points: &[DVec3], starts: &[DVec3], edge: f64) -> Option<Self> {
        if points.len() < FEWEST {
            return None;
        }
        let origin = points.iter().copied().sum::<DVec3>() / points.len() as f64;
        let mut waves: Vec<(f64, DVec3)> = Vec::new();
        for wave in starts.iter().flat_map(|start| follow(points, *start, edge)) {
            let (cos, sin) = sum(points, origin, wave);
            let factor = cos.hypot(sin);
            // Everything lies on a wave as long as the whole.
            if factor >= LEAST && wave.length() * edge * PERIODS[1] > 1.0 {
                waves.push((factor, wave));
            }
        }
        // The longest periods are the raster's, the others their sums.
        let first = longest(&waves, |_| true)?;
        let is_other = |k: DVec3| k.cross(first).length() > APART * k.length() * first.length();
        let second = longest(&waves, is_other)?;
        let phase = |k: DVec3| {
            let (cos, sin) = sum(points, origin, k);
            sin.atan2(cos) / TAU
        };
        Some(Self { origin, waves: [first, second], phases: [phase(first), phase(second)] })
    }

    /// Unit vector along which it is seen, on either side.
    fn view(&self) -> DVec3 {
        self.waves[0].cross(self.waves[1]).normalize_or_zero()
    }

    fn place(&self, p: DVec3) -> [f64; 2] {
        [0, 1].map(|i| self.waves[i].dot(p - self.origin) - self.phases[i])
    }

    /// Its nodes on the triangles of a patch that it sees, from the side of most; `None` if they are not about as many
    /// as the patch has vertices there.
    pub fn nodes(&self, patch: &Patch) -> Option<Vec<DVec3>> {
        let view = self.view();
        let alive = || (0..patch.triangles.len()).filter(|&t| patch.is_alive(t));
        let side = alive().map(|t| patch.area_normal(t).dot(view)).sum::<f64>().signum();
        let is_seen = |t: &usize| {
            let normal = patch.area_normal(*t);
            side * normal.dot(view) > SEEN * normal.length()
        };
        let mut found: BTreeMap<[i64; 2], DVec3> = BTreeMap::new();
        let mut wanted = 0.0;
        for t in alive().filter(is_seen) {
            // By Euler's formula there are half as many vertices as triangles.
            wanted += 0.5;
            for (node, p) in self.nodes_on(patch.triangles[t].map(|v| patch.p(v))) {
                found.entry(node).or_insert(p);
            }
        }
        let share = found.len() as f64 / f64::max(wanted, 1.0);
        (COUNT[0]..COUNT[1]).contains(&share).then(|| found.into_values().collect())
    }

    /// The nodes on a triangle.
    fn nodes_on(&self, corners: [DVec3; 3]) -> Vec<([i64; 2], DVec3)> {
        let [a, b, c] = corners.map(|p| self.place(p));
        let cross = |u: [f64; 2], v: [f64; 2], w: [f64; 2]| {
            (v[0] - u[0]) * (w[1] - u[1]) - (v[1] - u[1]) * (w[0] - u[0])
        };
        let area = cross(a, b, c);
        if area == 0.0 {
            return Vec::new();
        }
        let range = |i: usize| {
            let (low, high) = (a[i].min(b[i]).min(c[i]), a[i].max(b[i]).max(c[i]));
            low.ceil() as i64..=high.floor() as i64
        };
        let mut found = Vec::new();
        for (i, j) in range(0).flat_map(|i| range(1).map(move |j| (i, j))) {
            let q = [i as f64, j as f64];
            let weights = [cross(q, b, c), cross(a, q, c), cross(a, b, q)].map(|w| w / area);
            if weights.iter().all(|w| *w >= 0.0) {
                found.push(([i, j], (0..3).map(|k| weights[k] * corners[k]).sum()));
            }
        }
        found
    }
}

/// Of some waves with their factors the one with the longest period; of several about so long the clearest.
fn longest(waves: &[(f64, DVec3)], fits: impl Fn(DVec3) -> bool) -> Option<DVec3> {
    let own = || waves.iter().filter(|w| fits(w.1));
    let least = own().map(|w| w.1.length()).fold(f64::INFINITY, f64::min);
    let alike = own().filter(|w| w.1.length() < ABOUT * least);
    alike.max_by(|a, b| a.0.total_cmp(&b.0)).map(|w| w.1)
}

/// Mean of the cosines and of the sines of a wave at some points.
fn sum(points: &[DVec3], origin: DVec3, wave: DVec3) -> (f64, f64) {
    let mut total = (0.0, 0.0);
    for p in points {
        let (sin, cos) = (TAU * wave.dot(*p - origin)).sin_cos();
        total = (total.0 + cos, total.1 + sin);
    }
    (total.0 / points.len() as f64, total.1 / points.len() as f64)
}

/// Waves on which the points lie around a start, and farther and farther out.
fn follow(points: &[DVec3], start: DVec3, edge: f64) -> Vec<DVec3> {
    let mut order: Vec<DVec3> = points.to_vec();
    let far = |p: &DVec3| p.distance_squared(start);
    order.sort_by(|a, b| far(a).total_cmp(&far(b)));
    let mut count = FIRST.min(order.len());
    let mut waves = coarse(&order[..count], start, edge);
    let mut kept = FOLLOWED;
    loop {
        let some = &order[..count];
        let radius = some[count - 1].distance(start).max(edge);
        let mut climbed: Vec<(f64, DVec3)> =
            waves.iter().map(|&k| climb(some, start, k, 0.25 / radius)).collect();
        climbed.sort_by(|a, b| b.0.total_cmp(&a.0));
        waves = distinct(&climbed, 0.5 / radius, kept);
        if count == order.len() {
            return waves;
        }
        count = (2 * count).min(order.len());
        kept = (kept / 2).max(KEPT);
    }
}

/// The best of some waves, none so near to another.
fn distinct(sorted: &[(f64, DVec3)], apart: f64, most: usize) -> Vec<DVec3> {
    let mut kept: Vec<DVec3> = Vec::new();
    for &(_, k) in sorted {
        if kept.len() == most {
            break;
        }
        // A wave and its opposite are one.
        if kept.iter().all(|q| q.distance(k).min(q.distance(-k)) > apart) {
            kept.push(k);
        }
    }
    kept
}

/// The best waves of a grid so fine that none is missed between: a quarter of a period across the points.
fn coarse(points: &[DVec3], start: DVec3, edge: f64) -> Vec<DVec3> {
    let radius = points.last().map_or(edge, |p| p.distance(start)).max(edge);
    let step = 0.25 / radius;
    let [long, short] = PERIODS.map(|p| 1.0 / (p * edge));
    let most = (long / step).ceil() as i64;
    let mut all: Vec<(f64, DVec3)> = Vec::new();
    let turn = |turns: f64| {
        let (sin, cos) = (TAU * turns).sin_cos();
        [cos, sin]
    };
    let steps: Vec<[f64; 2]> = points.iter().map(|p| turn(step * (*p - start).z)).collect();
    for (i, j) in (0..=most).flat_map(|i| (-most..=most).map(move |j| (i, j))) {
        let from = step * DVec3::new(i as f64, j as f64, -most as f64);
        let mut now: Vec<[f64; 2]> = points.iter().map(|p| turn(from.dot(*p - start))).collect();
        for l in -most..=most {
            let k = step * DVec3::new(i as f64, j as f64, l as f64);
            if (short..=long).contains(&k.length()) {
                let total = now.iter().fold([0.0; 2], |s, c| [s[0] + c[0], s[1] + c[1]]);
                all.push((total[0].hypot(total[1]), k));
            }
            for (c, s) in now.iter_mut().zip(&steps) {
                *c = [c[0] * s[0] - c[1] * s[1], c[0] * s[1] + c[1] * s[0]];
            }
        }
    }
    all.sort_by(|a, b| b.0.total_cmp(&a.0));
    distinct(&all, 1.5 * step, FOLLOWED)
}

/// The nearest maximum of the structure factor, by steps along the axes that grow shorter.
fn climb(points: &[DVec3], origin: DVec3, from: DVec3, step: f64) -> (f64, DVec3) {
    let value = |k: DVec3| {
        let (cos, sin) = sum(points, origin, k);
        cos.hypot(sin)
    };
    let (mut at, mut best, mut h) = (from, value(from), step);
    while h > step / 64.0 {
        let tried = DVec3::AXES.into_iter().flat_map(|axis| [at + h * axis, at - h * axis]);
        let found = tried.map(|k| (value(k), k)).max_by(|a, b| a.0.total_cmp(&b.0));
        match found.filter(|f| f.0 > best) {
            Some(better) => (best, at) = better,
            None => h *= 0.5,
        }
    }
    (best, at)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chance(seed: usize) -> f64 {
        let x = (seed as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let x = (x ^ (x >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        ((x ^ (x >> 32)) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// A hilly surface sampled at the nodes of a raster of 0.8 and 1.1 that is seen aslant, off by noise.
    fn sampled(noise: f64) -> (Vec<DVec3>, DVec3) {
        let view = DVec3::new(0.2, -0.3, 0.9).normalize();
        let (x, y) = view.any_orthonormal_pair();
        let off =
            |i: usize| noise * (chance(i) + chance(7 * i + 3) + chance(11 * i + 5) - 1.5) * 2.0;
        let node = |i: usize| {
            let (u, v) = (0.8 * (i % 40) as f64 - 16.0, 1.1 * (i / 40) as f64 - 16.0);
            let height = 2.0 * (0.3 * u).sin() + 0.1 * v * v.sin();
            (u + off(3 * i)) * x + (v + off(3 * i + 1)) * y + (height + off(3 * i + 2)) * view
        };
        ((0..1200).map(node).collect(), view)
    }

    #[test]
    fn a_raster_is_found_with_its_phase() {
        for noise in [0.0, 0.1] {
            let (points, view) = sampled(noise);
            let hole = |p: &DVec3| p.length() < 5.0;
            let (gone, known): (Vec<DVec3>, Vec<DVec3>) = points.iter().partition(|p| hole(p));
            let starts = [known[0], known[500]];
            let raster = Raster::find(&known, &starts, 1.0).unwrap();
            assert!(raster.view().dot(view).abs() > 0.999, "{raster:?}");
            let periods = raster.waves.map(|k| 1.0 / k.length());
            assert!((periods[0] - 1.1).abs() < 0.01 && (periods[1] - 0.8).abs() < 0.01);
            // What was taken out lies at its nodes.
            let apart = |p: &DVec3| {
                raster.place(*p).map(|x| (x - x.round()).abs()).into_iter().fold(0.0, f64::max)
            };
            let mean = gone.iter().map(apart).sum::<f64>() / gone.len() as f64;
            assert!(mean < 0.02 + 1.2 * noise, "{noise}: {mean}");
        }
    }

    #[test]
    fn points_without_order_are_on_no_raster() {
        let points: Vec<DVec3> = (0..1200)
            .map(|i| {
                let [u, v] = [0, 1].map(|k| 32.0 * chance(2 * i + k) - 16.0);
                DVec3::new(u, v, 2.0 * (0.3 * u).sin())
            })
            .collect();
        assert!(Raster::find(&points, &[points[0], points[7], points[99]], 1.0).is_none());
        assert!(Raster::find(&sampled(0.0).0[..FEWEST - 1], &[DVec3::ZERO], 1.0).is_none());
    }

    /// Nodes lie on the patch, one for each cell of the raster; a patch seen from the side has none.
    #[test]
    fn nodes_lie_on_what_is_seen() {
        let raster =
            Raster { origin: DVec3::ZERO, waves: [DVec3::X, DVec3::Y], phases: [0.25, 0.5] };
        let n = 9;
        let side = |i: usize| i as f64 - 4.0;
        let patch = |tilt: f64| {
            let positions: Vec<DVec3> = (0..n * n)
                .map(|v| DVec3::new(side(v % n), side(v / n), tilt * side(v % n)))
                .collect();
            let cell = |c: usize| {
                let v = (c / (n - 1) * n + c % (n - 1)) as u32;
                [[v, v + 1, v + 1 + n as u32], [v, v + 1 + n as u32, v + n as u32]]
            };
            let triangles = (0..(n - 1) * (n - 1)).flat_map(cell).collect();
            Patch::of_triangles(positions, vec![1.0; n * n], 0, triangles)
        };
        let nodes = raster.nodes(&patch(0.5)).unwrap();
        assert_eq!(nodes.len(), 64);
        for p in nodes {
            assert!((p.x - 0.25 - (p.x - 0.25).round()).abs() < 1e-12);
            assert!((p.y - 0.5 - (p.y - 0.5).round()).abs() < 1e-12);
            assert!((p.z - 0.5 * p.x).abs() < 1e-12);
        }
        assert!(raster.nodes(&patch(4.0)).is_none());
    }
}

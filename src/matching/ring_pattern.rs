//! Where the object looks like the known ring around a hole: height maps compared, turned and mirrored.
//!
//! The method is our own. It stands in for the descriptors of Harary et al. 2014, Sec. 4, where the
//! initial completion says too little: only what is known is compared, so nothing depends on the
//! smooth fill but the frame that the ring is seen in.
//!
//! The cost of laying a source map over the target's known bins, for each of 36 turns and 2 sides, is
//! the root mean square of the height difference d with its best plane a + b x + c y taken out (the ICP
//! that follows corrects offset and tilt anyway), plus what is not covered times the radius. The sums
//! that this takes are five correlations of rows, less the target's moments where the source knows
//! nothing.

use super::correlation::{Bin, Doubled, SoFar, Sums};
use super::height_map::{bin_of, Frame, HeightMap, ANGLES, RADII, WHOLE};
use super::rigid::Rigid;
use glam::{DMat3, DVec3};
use pulp::{Simd, WithSimd};

/// Exponent of [`blandness`].
const BLAND: f64 = 1.0;
/// Known bins that a source must cover.
const COVER: f64 = 0.9;
/// Greatest slope of the plane taken out: what is steeper is another place, not the same aslant.
const MOST_TILT: f64 = 0.7;
/// Turns kept of each source map and side: periodic ornament fits at more than one.
const TURNS_KEPT: usize = 2;
/// Turns that count as the same.
const SAME_TURN: usize = 4;

/// The target's known bins, ready to be compared.
pub struct RingPattern {
    frame: Frame,
    /// As it is, and mirrored; by radius.
    bins: [Vec<Bin>; 2],
    /// The same as a bit for each angle.
    masks: [[u64; RADII]; 2],
    /// Where the bins of each radius begin, and the end.
    rows: [usize; RADII + 1],
    /// The widths of the ring that are compared, ascending.
    widths: Vec<Width>,
    /// Bins from the centre out that a source must have something in.
    inner: usize,
    /// Radius of the map, in mesh units.
    radius: f64,
    /// Mean roughness of what is known.
    roughness: f64,
    /// Tints of the bins, if they are compared.
    tints: Vec<f32>,
    /// What a difference of 1 in tint is worth, in mesh units.
    paint: f64,
}

/// A width of the ring.
struct Width {
    /// Radii and bins within it.
    rows: usize,
    bins: usize,
    /// Sums over the bins as they are, with d the target's heights.
    sums: Sums,
}

/// The work of [`RingPattern::is_covered`], with the machine's own instruction to count bits.
struct Covered<'a> {
    widths: &'a [Width],
    masks: &'a [u64; RADII],
    known: &'a [u64; RADII],
}

impl WithSimd for Covered<'_> {
    type Output = bool;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> bool {
        let Self { widths, masks, known } = self;
        (0..ANGLES).any(|turn| {
            let (mut covered, mut row) = (0, 0);
            widths.iter().any(|width| {
                for r in row..width.rows {
                    let turned = (masks[r] << turn | masks[r] >> (ANGLES - turn)) & WHOLE;
                    covered += (turned & known[r]).count_ones();
                }
                row = width.rows;
                f64::from(covered) / width.bins as f64 >= COVER
            })
        })
    }
}

/// A place on the source whose surroundings look like the ring.
#[derive(Debug, Clone, Copy)]
pub struct Candidate {
    /// From source to target.
    pub transform: Rigid,
    /// How badly it fits, in mesh units, times `bland`.
    pub cost: f64,
    /// See [`blandness`].
    pub bland: f64,
}

impl RingPattern {
    /// From the map of the known points; bins that hold a point of the fill are unknown. Bins nearer than
    /// each of `reaches` (mesh units, ascending) are compared, with those of the nearer ones once for all.
    /// `paint`: what a difference of 1 in tint is worth, in mesh units.
    pub fn new(
        known: &HeightMap,
        fill: &[DVec3],
        radius: f64,
        reaches: &[f64],
        paint: f64,
    ) -> Self {
        let frame = known.frame;
        let mut filled = [[false; ANGLES]; RADII];
        let mut inner = 0;
        for &p in fill {
            if let Some((r, a)) = bin_of(frame.local(p), radius) {
                filled[r][a] = true;
                inner = inner.max(r + 1);
            }
        }
        let step = radius / RADII as f64;
        let lasts: Vec<usize> =
            reaches.iter().map(|reach| ((reach / step).ceil() as usize).min(RADII)).collect();
        let mut widths = Vec::with_capacity(reaches.len());
        let (mut bins, mut sums) = ([Vec::new(), Vec::new()], Sums::default());
        let mut rows = [0; RADII + 1];
        let mut masks = [[0; RADII]; 2];
        let mut tints = Vec::new();
        for r in 0..=lasts.last().copied().unwrap_or(0) {
            while lasts.get(widths.len()) == Some(&r) {
                widths.push(Width { rows: r, bins: bins[0].len(), sums });
            }
            if lasts.len() == widths.len() {
                break;
            }
            for a in (0..ANGLES).filter(|&a| known.knows(r, a) && !filled[r][a]) {
                let turn = (a as f64 + 0.5) / ANGLES as f64 * std::f64::consts::TAU;
                let at = (r as f64 + 0.5) * step;
                let (x, y) = (at * turn.cos(), at * turn.sin());
                let h = f64::from(known.height[r][a]);
                let moments = [1.0, x, y, h, x * x, x * y, y * y, x * h, y * h, h * h];
                let moments = moments.map(|m| m as f32);
                // A mirrored source runs around the other way.
                bins[0].push(Bin { r, a, moments });
                bins[1].push(Bin { r, a: ANGLES - 1 - a, moments });
                masks[0][r] |= 1 << a;
                masks[1][r] |= 1 << (ANGLES - 1 - a);
                sums.add(1.0, x, y, h);
                tints.extend(known.tint.as_ref().map(|t| t[r][a]));
            }
            rows[r + 1..].fill(bins[0].len());
        }
        let roughness = known.roughness;
        Self { tints, paint, frame, bins, masks, rows, widths, inner, radius, roughness }
    }

    /// Whether there is enough to compare with.
    pub fn is_useful(&self) -> bool {
        self.widths.iter().any(Width::is_useful)
    }

    /// The best turns of one source map, as it is and (if wanted) mirrored, added to those found for each
    /// width.
    pub fn compare(&self, map: &HeightMap, mirror: bool, found: &mut [Vec<Candidate>]) {
        if map.coverage_inside(self.inner) < COVER {
            return;
        }
        let bland = blandness(self.roughness, map.roughness);
        let doubled = Doubled::new(map);
        for mirrored in [false, true].into_iter().take(1 + usize::from(mirror)) {
            let bins = &self.bins[usize::from(mirrored)];
            if !self.is_covered(&self.masks[usize::from(mirrored)], &map.known) {
                continue;
            }
            let mut so_far = SoFar::default();
            let (mut rows, mut first) = (0, 0);
            for (width, found) in self.widths.iter().zip(found.iter_mut()) {
                let more = &bins[first..width.bins];
                so_far.add_heights(more, &doubled.height);
                for r in rows..width.rows {
                    let row = &bins[self.rows[r]..self.rows[r + 1]];
                    so_far.add_missing(row, doubled.known[r]);
                    if let Some(tint) = &doubled.tint {
                        so_far.add_tints(row, &self.tints[self.rows[r]..], tint, doubled.known[r]);
                    }
                }
                (rows, first) = (width.rows, width.bins);
                if width.is_useful() {
                    self.keep_best(
                        width,
                        &so_far,
                        doubled.tint.is_some(),
                        &mut |turn, plane, cost| {
                            let transform = self.transform(map, turn, mirrored, plane);
                            found.push(Candidate { transform, cost: cost * bland, bland });
                        },
                    );
                }
            }
        }
    }

    /// Whether a source that knows such bins covers enough of some width at some turn: many do not, and all
    /// sums over them are in vain.
    fn is_covered(&self, masks: &[u64; RADII], known: &[u64; RADII]) -> bool {
        pulp::Arch::new().dispatch(Covered { widths: &self.widths, masks, known })
    }

    /// Tells `keep` the best turns of a width, with the plane and the cost.
    fn keep_best(
        &self,
        width: &Width,
        so_far: &SoFar,
        painted: bool,
        keep: &mut dyn FnMut(usize, DVec3, f64),
    ) {
        let mut costs = [(f64::INFINITY, DVec3::ZERO); ANGLES];
        for (turn, at) in costs.iter_mut().enumerate() {
            let sums = so_far.at(turn, &width.sums);
            let Some((mut cost, plane)) = self.cost(&sums, width.bins) else { continue };
            if painted {
                let off = f64::from(so_far.tints[turn]) / sums.n;
                cost = (cost * cost + self.paint * self.paint * off).sqrt();
            }
            *at = (cost, plane);
        }
        for _ in 0..TURNS_KEPT {
            let least = |a: &usize, b: &usize| costs[*a].0.total_cmp(&costs[*b].0);
            let Some(best) = (0..ANGLES).min_by(least).filter(|&b| costs[b].0 < f64::INFINITY)
            else {
                break;
            };
            keep(best, costs[best].1, costs[best].0);
            for (turn, at) in costs.iter_mut().enumerate() {
                let apart = turn.abs_diff(best);
                if apart.min(ANGLES - apart) < SAME_TURN {
                    at.0 = f64::INFINITY;
                }
            }
        }
    }

    /// Cost of the sums over so many bins, and the plane taken out.
    fn cost(&self, s: &Sums, bins: usize) -> Option<(f64, DVec3)> {
        let covered = s.n / bins as f64;
        if covered < COVER {
            return None;
        }
        let m = DMat3::from_cols(
            DVec3::new(s.n, s.x, s.y),
            DVec3::new(s.x, s.xx, s.xy),
            DVec3::new(s.y, s.xy, s.yy),
        );
        let rhs = DVec3::new(s.d, s.dx, s.dy);
        let plane = m.inverse() * rhs;
        if !plane.is_finite() || plane.y * plane.y + plane.z * plane.z > MOST_TILT * MOST_TILT {
            return None;
        }
        let left = (s.dd - plane.dot(rhs)).max(0.0) / s.n;
        Some((left.sqrt() + (1.0 - covered) * self.radius * 0.25, plane))
    }

    fn transform(&self, map: &HeightMap, turn: usize, mirrored: bool, plane: DVec3) -> Rigid {
        // Source angle = ±(target angle) + turn, so the target's is ±(source angle − turn).
        let angle = -(turn as f64) / ANGLES as f64 * std::f64::consts::TAU;
        let mut in_plane = DMat3::from_rotation_z(angle);
        if mirrored {
            in_plane = DMat3::from_diagonal(DVec3::new(1.0, -1.0, 1.0)) * in_plane;
        }
        let normal = DVec3::new(-plane.y, -plane.z, 1.0).normalize();
        let tilt = DMat3::from_quat(glam::DQuat::from_rotation_arc(DVec3::Z, normal));
        let linear = self.frame.axes * tilt * in_plane * map.frame.axes.transpose();
        let to = self.frame.centre + plane.x * self.frame.axes.z_axis;
        Rigid { linear, translation: to - linear * map.frame.centre }
    }
}

impl Width {
    fn is_useful(&self) -> bool {
        self.bins > ANGLES
    }
}

/// What the cost of a source that is smoother than the surroundings is multiplied with, from their
/// mean square turns: (target / source)^(exponent / 2), at least 1. A smooth source always fits better,
/// as it adds no noise of its own: without this the fur of a scan is continued by its bald spots.
pub fn blandness(target: f64, source: f64) -> f64 {
    (target / source.max(f64::MIN_POSITIVE)).max(1.0).powf(0.5 * BLAND)
}

/// Keeps the best that differ: what they lay over `centre` more than a quarter of `radius` apart, or
/// turned by more than `turn` (Frobenius norm of the difference of the linear parts).
pub fn keep_different(
    all: Vec<Candidate>,
    centre: DVec3,
    radius: f64,
    turn: f64,
    most: usize,
) -> Vec<Candidate> {
    // Their numbers are sorted: they themselves are large.
    let mut order: Vec<u32> = (0..all.len() as u32).collect();
    let cost = |i: &u32| all[*i as usize].cost;
    order.sort_unstable_by(|a, b| cost(a).total_cmp(&cost(b)).then(a.cmp(b)));
    let mut kept: Vec<(Candidate, DVec3)> = Vec::new();
    for m in order.into_iter().map(|i| all[i as usize]) {
        // What lies over the target's centre says where on the source we are.
        let place = m.transform.inverse().point(centre);
        let same = |k: &(Candidate, DVec3)| {
            let d = k.0.transform.linear - m.transform.linear;
            let norm = d.to_cols_array().iter().map(|x| x * x).sum::<f64>().sqrt();
            place.distance(k.1) < 0.25 * radius && norm < turn
        };
        if !kept.iter().any(same) {
            kept.push((m, place));
            if kept.len() == most {
                break;
            }
        }
    }
    kept.into_iter().map(|k| k.0).collect()
}

#[cfg(test)]
mod tests {
    use super::super::cloud::tests::known;
    use super::super::cloud::{thin, Cloud, Grid, Sample};
    use super::super::height_map::tests::map_at;
    use super::super::source::tests::{hills, hilly_source, some_transform};
    use super::*;

    /// The hills moved, as a cloud.
    fn moved_cloud(t: &Rigid) -> Cloud {
        let n = 120;
        let side = |i: usize| 2.4 * i as f64 / n as f64 - 1.2;
        let points = (0..n * n).map(|k| {
            let (p, m) = hills(side(k % n), side(k / n));
            known(t.point(p), t.direction(m), 0.0)
        });
        cloud_of(points)
    }

    fn cloud_of(points: impl Iterator<Item = Sample> + Clone) -> Cloud {
        let axes = DMat3::IDENTITY;
        let grid = Grid::over(points.clone().map(|p| p.point), 0.04, &axes);
        Cloud::of_points(thin(points, &grid, &|| Ok(())).unwrap(), axes, &|| Ok(())).unwrap()
    }

    /// Where the source shows the same hills, rotated or mirrored, the best candidate of many places
    /// is that place, with the turn within a bin.
    #[test]
    fn hills_are_found_again() {
        let radius = 0.8;
        let cloud = Cloud::of_source(&hilly_source(60), 0.04, &|| Ok(())).unwrap();
        let places: Vec<HeightMap> = (0..25)
            .map(|k| {
                let (p, _) = hills(0.2 * (k % 5) as f64 - 0.4, 0.2 * (k / 5) as f64 - 0.4);
                map_at(&cloud, p, DVec3::Z, radius)
            })
            .collect();
        for mirrored in [false, true] {
            let truth = some_transform(mirrored);
            let target = moved_cloud(&truth);
            let centre = truth.point(hills(0.0, 0.0).0);
            let known = map_at(&target, centre, truth.direction(DVec3::Z), radius);
            let hole: Vec<DVec3> = target
                .thinned
                .points
                .iter()
                .copied()
                .filter(|p| p.distance(centre) < 0.35)
                .collect();
            let pattern = RingPattern::new(&known, &hole, radius, &[radius], 0.0);
            assert!(pattern.is_useful());
            let mut found = [Vec::new()];
            places.iter().for_each(|m| pattern.compare(m, true, &mut found));
            let [found] = found;
            let best = keep_different(found, centre, 0.4, 0.6, 20);
            assert!(best.is_sorted_by(|a, b| a.cost <= b.cost));
            let found = best[0].transform;
            assert_eq!(found.is_mirrored(), mirrored);
            let turn = (found.linear.transpose() * truth.linear).to_cols_array();
            let trace = turn[0] + turn[4] + turn[8];
            let angle = (0.5 * (trace - 1.0)).clamp(-1.0, 1.0).acos().to_degrees();
            let off = found.point(hills(0.0, 0.0).0).distance(centre);
            println!("{angle:.2}° {off:.4}, cost {:.4} then {:.4}", best[0].cost, best[1].cost);
            assert!(angle < 8.0 && off < 0.06, "{angle} {off}");
            assert!(best[0].cost < 0.5 * best[1].cost);
        }
    }

    /// Offset and tilt are taken out, so they cost nothing.
    #[test]
    fn a_plane_fits_at_no_cost() {
        let level = |slope: f64, lift: f64| {
            let n = 60;
            let side = |i: usize| 3.0 * i as f64 / n as f64 - 1.5;
            let points = (0..n * n).map(move |k| {
                let (x, y) = (side(k % n), side(k / n));
                known(DVec3::new(x, y, slope * x + lift), DVec3::Z, 0.0)
            });
            cloud_of(points)
        };
        let map = |cloud: &Cloud| map_at(cloud, DVec3::ZERO, DVec3::Z, 1.0);
        let pattern = RingPattern::new(&map(&level(0.0, 0.0)), &[DVec3::X * 0.1], 1.0, &[1.0], 0.0);
        let mut found = [Vec::new()];
        pattern.compare(&map(&level(0.3, 0.1)), true, &mut found);
        let [found] = found;
        assert!(!found.is_empty());
        for c in &found {
            assert!(c.cost < 0.01, "{}", c.cost);
            // The slope is undone by the transform.
            let up = c.transform.direction(DVec3::new(-0.3, 0.0, 1.0).normalize());
            assert!(up.dot(DVec3::Z) > 0.999, "{up}");
        }
        // Steeper than what counts as the same place.
        let mut steep = [Vec::new()];
        pattern.compare(&map(&level(0.9, 0.0)), true, &mut steep);
        assert!(steep[0].is_empty());
    }

    #[test]
    fn only_a_smoother_source_is_bland() {
        assert_eq!(blandness(1.0, 4.0), 1.0);
        assert!((blandness(4.0, 1.0) - 2.0).abs() < 1e-12);
        assert!(blandness(0.0, 0.0).is_finite() && blandness(1.0, 0.0) > 1e100);
    }

    #[test]
    fn of_equal_places_the_best_is_kept() {
        let at = |x: f64, cost: f64| {
            let transform = Rigid { translation: DVec3::X * x, ..Rigid::IDENTITY };
            Candidate { transform, cost, bland: 1.0 }
        };
        let all = vec![at(0.0, 3.0), at(0.1, 1.0), at(5.0, 2.0), at(5.2, 4.0), at(9.0, 5.0)];
        let kept = keep_different(all, DVec3::ZERO, 1.0, 0.5, 2);
        assert_eq!(kept.iter().map(|c| c.cost).collect::<Vec<_>>(), [1.0, 2.0]);
    }
}

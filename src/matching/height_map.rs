//! Polar height maps: what the surface around a centre looks like, above its plane.
//!
//! The method is our own. A map holds the mean height (and the mean tint) on 14 radii × 36 angles
//! around a centre; [`super::ring_pattern`] compares them.

use super::blocks::{Lanes, Near, LANES};
use super::cloud::Cloud;
use crate::mesh::neighbourhood::NONE;
use glam::{DMat3, DVec3};
use pulp::{Simd, WithSimd};

/// Bins along the radius.
pub const RADII: usize = 14;
/// Bins around; 10° each, within reach of the ICP.
pub const ANGLES: usize = 36;
/// Least cosine between a point's normal and the map's: other sides of thin parts are left out.
const SAME_SIDE: f32 = 0.1;
/// The bins of one radius.
pub type Row = [f32; ANGLES];

/// Heights over a plane, by radius and angle.
pub struct HeightMap {
    /// Where the bins are.
    pub frame: Frame,
    /// Mean roughness of the points in the bins, see [`SourceMesh::roughness`](super::source::SourceMesh::roughness).
    pub roughness: f64,
    /// Mean heights, in mesh units.
    pub height: [Row; RADII],
    /// A bit for each angle where something is known.
    pub known: [u64; RADII],
    /// The holes whose completions it shows.
    pub completions: Vec<u32>,
    /// Mean tint, if there are colours.
    pub tint: Option<Box<[Row; RADII]>>,
}

/// A centre and three axes, the last one the normal.
#[derive(Debug, Clone, Copy)]
pub struct Frame {
    /// In mesh units.
    pub centre: DVec3,
    /// Columns: two tangents and the normal; right-handed.
    pub axes: DMat3,
}

impl Frame {
    /// With two tangents that move with such axes.
    pub fn new(centre: DVec3, normal: DVec3, axes: &DMat3) -> Self {
        let (x, y) = (axes.transpose() * normal).any_orthonormal_pair();
        Self { centre, axes: DMat3::from_cols(*axes * x, *axes * y, normal) }
    }
    /// Coordinates of a point.
    pub fn local(&self, p: DVec3) -> DVec3 {
        self.axes.transpose() * (p - self.centre)
    }
}

impl HeightMap {
    /// Forgets the bins of a map that reaches so far whose middles are such points.
    pub fn forget(&mut self, reach: f64, beyond: &dyn Fn(DVec3) -> bool) {
        let step = reach / RADII as f64;
        for r in 0..RADII {
            for a in 0..ANGLES {
                let turn = (a as f64 + 0.5) / ANGLES as f64 * std::f64::consts::TAU;
                let (at, h) = ((r as f64 + 0.5) * step, f64::from(self.height[r][a]));
                let local = DVec3::new(at * turn.cos(), at * turn.sin(), h);
                if self.known[r] >> a & 1 == 1
                    && beyond(self.frame.centre + self.frame.axes * local)
                {
                    self.known[r] &= !(1 << a);
                }
            }
        }
    }
}

/// Radius and angle bin of a local point; `None` beyond the map.
pub fn bin_of(local: DVec3, radius: f64) -> Option<(usize, usize)> {
    let r = local.truncate().length() / radius * RADII as f64;
    let turn = turn_of(local.x as f32, local.y as f32);
    (r < RADII as f64).then_some((r as usize, angle_bin(turn) as usize))
}

/// The angle bin of a turn.
#[inline(always)]
fn angle_bin(turn: f32) -> f32 {
    // A turn of just below 0 may be rounded to 1.
    (turn * ANGLES as f32).floor().min(ANGLES as f32 - 1.0)
}

/// A whole number from 0 to 2²³ that is stored as a float, read from its bits: a cast, which looks at what is out
/// of range, is not done in vector lanes.
#[inline(always)]
fn whole_number(x: f32) -> u32 {
    const TWO_23: f32 = 8_388_608.0;
    (x + TWO_23).to_bits() - TWO_23.to_bits()
}

/// The angle of (x, y) in turns, 0 to 1, within 2e-6: without branches, so that it runs in vector
/// lanes. (Hastings, "Approximations for digital computers" (1955): an odd polynomial.)
#[inline(always)]
fn turn_of(x: f32, y: f32) -> f32 {
    let (ax, ay) = (x.abs(), y.abs());
    let (least, most) = if ax < ay { (ax, ay) } else { (ay, ax) };
    let q = least / most.max(f32::MIN_POSITIVE);
    let s = q * q;
    let mut p = -0.013_480_47;
    for c in [0.057_477_314, -0.121_239_07, 0.195_635_92, -0.332_994_6, 0.999_995_63] {
        p = p * s + c;
    }
    let octant = p * q * (0.5 / std::f32::consts::PI);
    let quarter = if ax < ay { 0.25 - octant } else { octant };
    let half = if x < 0.0 { 0.5 - quarter } else { quarter };
    if y < 0.0 {
        1.0 - half
    } else {
        half
    }
}

/// Bins of a map; what is on none goes to one more of its lane, so that no branch depends on where points are
/// and no sum waits for another.
const BINS: usize = RADII * ANGLES;
/// With those of the lanes.
type Bins = [f32; BINS + LANES];

/// Where points of a group are on a map.
struct Places {
    /// Radius times [`ANGLES`] plus angle, or [`BINS`] plus the lane.
    bin: [u32; LANES],
    height: Lanes,
    /// 0 where a point is on none.
    roughness: Lanes,
}

/// What is being added up.
struct Sums {
    height: Bins,
    count: Bins,
    tint: Option<Box<Bins>>,
    roughness: [f64; LANES],
    completions: Vec<u32>,
}

impl Sums {
    /// Adds points of a group to those of their bins.
    #[inline(always)]
    fn add(&mut self, places: &Places, tints: Option<&Lanes>) {
        for l in 0..LANES {
            let bin = places.bin[l] as usize;
            self.height[bin] += places.height[l];
            self.count[bin] += 1.0;
            self.roughness[l] += f64::from(places.roughness[l]);
        }
        if let (Some(tint), Some(tints)) = (&mut self.tint, tints) {
            for l in 0..LANES {
                tint[places.bin[l] as usize] += tints[l];
            }
        }
    }

    /// Leaves out the points of one hole's completion, and notes those of others.
    #[inline(never)]
    fn tell_completions(
        &mut self,
        places: &mut Places,
        ids: &[u32; LANES],
        cloud: &Cloud,
        without: u32,
    ) {
        for l in 0..LANES {
            let hole = cloud.thinned.completion_of(ids[l] as usize);
            if hole == NONE || places.bin[l] >= BINS as u32 {
                continue;
            }
            if hole == without {
                (places.bin[l], places.roughness[l]) = ((BINS + l) as u32, 0.0);
            } else if !self.completions.contains(&hole) {
                self.completions.push(hole);
            }
        }
    }

    /// The means, bridged where little is missing.
    fn into_map(mut self, frame: Frame) -> HeightMap {
        let points: f32 = self.count[..BINS].iter().sum();
        // Where there are none the sum is 0.
        let mean = |sums: &mut Bins| {
            sums.iter_mut().zip(&self.count).for_each(|(sum, count)| *sum /= count.max(1.0));
        };
        mean(&mut self.height);
        self.tint.as_deref_mut().map(mean);
        let known = |r: usize| {
            let row = self.count[r * ANGLES..][..ANGLES].iter().enumerate();
            row.fold(0, |bits, (a, &count)| bits | u64::from(count > 0.0) << a)
        };
        let mut known: [u64; RADII] = std::array::from_fn(known);
        let rows = |all: &Bins| -> [Row; RADII] {
            std::array::from_fn(|r| std::array::from_fn(|a| all[r * ANGLES + a]))
        };
        let (mut height, mut tint) =
            (rows(&self.height), self.tint.as_deref().map(|t| Box::new(rows(t))));
        for (r, known) in known.iter_mut().enumerate() {
            if let Some(tint) = &mut tint {
                bridge_gaps(&mut tint[r], &mut known.clone(), widest_gap(r));
            }
            bridge_gaps(&mut height[r], known, widest_gap(r));
        }
        let roughness = self.roughness.iter().sum::<f64>() / f64::max(f64::from(points), 1.0);
        HeightMap { frame, roughness, height, known, completions: self.completions, tint }
    }
}

/// The work of [`HeightMap::new`]. A struct, not a closure: only what is always inlined gets the machine's
/// own vector instructions.
struct Adding<'a> {
    sums: &'a mut Sums,
    cloud: &'a Cloud,
    near: &'a Near,
    frame: Frame,
    radius: f64,
    without: u32,
}

impl WithSimd for Adding<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { sums, cloud, near, frame, radius, without } = self;
        let axes = frame.axes.as_mat3().to_cols_array_2d();
        let (reach, ball) = (radius as f32, (near.radius * near.radius) as f32);
        let bins = (RADII as f64 / radius) as f32;
        cloud.blocks.visit(near, |group, number, origin| {
            let mut places =
                Places { bin: [0; LANES], height: [0.0; LANES], roughness: [0.0; LANES] };
            let (mut radius, mut turn, mut within) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
            for l in 0..LANES {
                let p = [0, 1, 2].map(|k| group.at[k][l] + origin[k]);
                let along = |a: &[f32; 3]| a[0] * p[0] + a[1] * p[1] + a[2] * p[2];
                let [x, y, z] = [along(&axes[0]), along(&axes[1]), along(&axes[2])];
                let n = [0, 1, 2].map(|k| axes[2][k] * group.normal[k][l]);
                radius[l] = (x * x + y * y).sqrt() * bins;
                turn[l] = turn_of(x, y);
                places.height[l] = z;
                let is_within = (n[0] + n[1] + n[2] >= SAME_SIDE)
                    & (z.abs() < reach)
                    & (radius[l] < RADII as f32)
                    & (p[0] * p[0] + p[1] * p[1] + p[2] * p[2] <= ball);
                within[l] = f32::from(u8::from(is_within));
            }
            for l in 0..LANES {
                // Without a choice between two, which would be a branch; NaN is on no bin.
                let r = radius[l].min(RADII as f32 - 0.5).floor();
                let beyond = (BINS + l) as f32;
                let bin = within[l] * (r * ANGLES as f32 + angle_bin(turn[l]));
                places.bin[l] = whole_number((bin + (1.0 - within[l]) * beyond).min(beyond));
                places.roughness[l] = within[l] * group.roughness[l];
            }
            if group.is_completed {
                sums.tell_completions(&mut places, &group.ids, cloud, without);
            }
            sums.add(&places, cloud.blocks.tints_of(number));
        });
    }
}

impl HeightMap {
    /// The map of the cloud's points in a ball around a frame's centre, out to `radius`; without those
    /// of a hole's completion ([`NONE`]: with all).
    pub fn new(cloud: &Cloud, near: &Near, frame: Frame, radius: f64, without: u32) -> Self {
        let tints = cloud.thinned.tints.as_ref();
        let mut sums = Sums {
            height: [0.0; BINS + LANES],
            count: [0.0; BINS + LANES],
            tint: tints.map(|_| Box::new([0.0; BINS + LANES])),
            roughness: [0.0; LANES],
            completions: Vec::new(),
        };
        pulp::Arch::new().dispatch(Adding { sums: &mut sums, cloud, near, frame, radius, without });
        sums.into_map(frame)
    }

    /// Whether something is known there.
    pub fn knows(&self, r: usize, a: usize) -> bool {
        self.known[r] >> a & 1 == 1
    }

    /// Share of the bins within `radii` rings that are known.
    pub fn coverage_inside(&self, radii: usize) -> f64 {
        let known: u32 = self.known[..radii].iter().map(|row| row.count_ones()).sum();
        f64::from(known) / (radii * ANGLES).max(1) as f64
    }
}

/// All angles known.
pub const WHOLE: u64 = (1 << ANGLES) - 1;

/// Close to the centre bins are narrower than points lie apart: gaps of so many are bridged.
fn widest_gap(r: usize) -> usize {
    (ANGLES / (3 * r + 1)).clamp(1, ANGLES / 2)
}

/// Gives unknown bins the height of the nearest known one along the angle, up to `reach` bins off.
fn bridge_gaps(height: &mut Row, known: &mut u64, reach: usize) {
    let before = *known;
    if before == WHOLE || before == 0 {
        return;
    }
    for a in (0..ANGLES).filter(|&a| before >> a & 1 == 0) {
        let near = (1..=reach)
            .flat_map(|d| [(a + d) % ANGLES, (a + ANGLES - d) % ANGLES])
            .find(|&b| before >> b & 1 == 1);
        if let Some(b) = near {
            height[a] = height[b];
            *known |= 1 << a;
        }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// As the library's own arc tangent has it, but at the borders of the bins.
    #[test]
    fn turns_are_the_angles() {
        for k in 0..100_000 {
            let angle = k as f64 / 100_000.0 * std::f64::consts::TAU;
            let (x, y) = (3.0 * angle.cos(), 3.0 * angle.sin());
            let (x, y) = (x as f32, y as f32);
            let truth = f64::from(y).atan2(f64::from(x)) / std::f64::consts::TAU;
            let off = f64::from(turn_of(x, y)) - truth;
            assert!((off - off.round()).abs() < 2e-6, "{k}: {off}");
        }
        assert_eq!([turn_of(0.0, 0.0), turn_of(1.0, 0.0), turn_of(-1.0, 0.0)], [0.0, 0.0, 0.5]);
        assert!(angle_bin(turn_of(1.0, -1e-30)) as usize == ANGLES - 1);
    }

    /// The map around a point.
    pub fn map_at(cloud: &Cloud, p: DVec3, n: DVec3, radius: f64) -> HeightMap {
        let near = cloud.blocks.near(p, 1.5 * radius);
        HeightMap::new(cloud, &near, Frame::new(p, n, &cloud.axes), radius, NONE)
    }
}

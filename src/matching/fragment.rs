//! Bendels, Schnabel and Klein (2005), "Fragment-based surface inpainting", Sec. 4.1 to 4.4: what a
//! surface looks like around a point, as heights over a plane at places of equal density, and how two
//! such fragments are compared, turned and mirrored.
//!
//! Differences from the paper:
//! - Heights are where lines along the frame's normal meet the surface's triangles: a Delaunay
//!   triangulation of the projected points is not needed where there is a mesh.
//! - The diffusion carries the difference of the heights, not the target's heights, into the empty
//!   part ([`spread`]): a fragment that fits is then not bent.

use super::height_map::Frame;
use super::rigid::Rigid;
use glam::{DMat3, DVec2, DVec3};
use std::f64::consts::TAU;
use std::ops::Range;

/// Rings of a fragment.
pub const RINGS: usize = 6;
/// Places of the first ring; ring k has k times as many.
const FIRST: usize = 6;
/// Places of all rings.
pub const PLACES: usize = FIRST * RINGS * (RINGS + 1) / 2;
/// Of so many places one is looked at in a sketch: at least one in each ring, six in the widest.
const SKETCHED: usize = 5;
/// Turns that are tried, 10° apart: within reach of the ICP.
pub const TURNS: usize = 36;
/// Share of the target's places that a source must know.
const COVER: f64 = 0.9;
/// What the coarser layer counts (τ, Sec. 5.3).
const COARSE: f64 = 0.5;
/// What a copy may leave of the known detail, of its square: half its height. The best of thousands of unrelated
/// fragments leave 0.4 to 1.5 on a hide of knobs, flutes of a column 0.05 to 0.3.
const LEFT: f64 = 0.25;

/// Heights by place, and how far each is to be believed: 0 (nothing there) to 1.
#[derive(Clone)]
pub struct Layer {
    /// In radii of the fragment.
    pub height: [f32; PLACES],
    /// 0 to 1.
    pub confidence: [f32; PLACES],
}

impl Layer {
    /// Nothing known.
    pub const EMPTY: Self = Self { height: [0.0; PLACES], confidence: [0.0; PLACES] };

    /// Mean confidence (α of a descriptor, Sec. 4.3).
    pub fn mean_confidence(&self) -> f64 {
        self.confidence.iter().map(|&a| f64::from(a)).sum::<f64>() / PLACES as f64
    }

    /// Standard deviation of the known heights along the rings, in radii (σ, Sec. 4.3): how much there
    /// is to be told apart by.
    pub fn deviation(&self) -> f64 {
        let along = |k: usize| {
            let places = ring(k);
            let weights = || places.clone().map(|i| f64::from(self.confidence[i]));
            let height = |i: usize| f64::from(self.height[i]);
            let sum: f64 = weights().sum();
            let mean = places.clone().zip(weights()).map(|(i, w)| w * height(i)).sum::<f64>();
            let mean = mean / sum.max(f64::MIN_POSITIVE);
            let square = |(i, w): (usize, f64)| w * (height(i) - mean).powi(2);
            let square = places.clone().zip(weights()).map(square).sum::<f64>();
            (square / sum.max(f64::MIN_POSITIVE)).sqrt()
        };
        (1..=RINGS).map(along).sum::<f64>() / RINGS as f64
    }
}

/// The two layers of a descriptor (Sec. 5.3).
#[derive(Clone)]
pub struct Fragment {
    /// The plane; its normal is the surface's, coarsely.
    pub frame: Frame,
    /// Of the surface itself.
    pub fine: Layer,
    /// Of the coarser surface, known in the hole, too.
    pub coarse: Layer,
}

impl Fragment {
    /// From what lies over each place: `meet` gets a place on the plane and the number of the place,
    /// and returns height (mesh units) and confidence of the coarse and of the fine surface.
    pub fn new(
        frame: Frame,
        radius: f64,
        mut meet: impl FnMut(DVec3, usize) -> [Option<(f64, f64)>; 2],
    ) -> Self {
        let (fine, coarse) = (Layer::EMPTY, Layer::EMPTY);
        let mut made = Self { frame, fine, coarse };
        for i in 0..PLACES {
            let at = radius * place(i);
            let origin = frame.centre + frame.axes * at.extend(0.0);
            let met = meet(origin, i);
            for (layer, met) in [&mut made.coarse, &mut made.fine].into_iter().zip(met) {
                if let Some((height, confidence)) = met {
                    layer.height[i] = (height / radius) as f32;
                    layer.confidence[i] = confidence as f32;
                }
            }
        }
        made
    }

    /// δ of the two layers together (Eq. 1 and Sec. 5.3) for a source turned, and mirrored or not;
    /// `None` where the source knows too little. In square radii.
    pub fn distance(&self, source: &Self, turned: &Turned) -> Option<f64> {
        self.compare(source, turned, 1)
    }

    /// About the same, from a fifth of the places.
    pub fn sketched_distance(&self, source: &Self, turned: &Turned) -> Option<f64> {
        self.compare(source, turned, SKETCHED)
    }

    fn compare(&self, source: &Self, turned: &Turned, step: usize) -> Option<f64> {
        let fine = difference(&self.fine, &source.fine, turned, step)?;
        let coarse = difference(&self.coarse, &source.coarse, turned, step)?;
        Some(fine + COARSE * coarse)
    }

    /// δ of the fine layer alone, neither turned nor mirrored.
    pub fn fine_distance(&self, source: &Self) -> Option<f64> {
        difference(&self.fine, &source.fine, &Turned::new(0, false), 1)
    }

    /// Mean square of what the known fine surface has beyond the coarse one, in square radii.
    pub fn detail(&self) -> f64 {
        let (mut sum, mut weight) = (0.0, 0.0);
        for i in 0..PLACES {
            let known = self.fine.confidence[i] * self.coarse.confidence[i];
            sum += f64::from(known * (self.fine.height[i] - self.coarse.height[i]).powi(2));
            weight += f64::from(known);
        }
        sum / f64::max(weight, f64::MIN_POSITIVE)
    }

    /// Whether a source, aligned, tells more of this than the coarser surface does: it leaves little of the known
    /// detail, and as large a part of its way from the coarser surface where nothing is known is no more than
    /// the detail that the coarser surface lacks.
    pub fn is_continued_by(&self, source: &Self) -> bool {
        let plain = self.detail();
        let own = Turned::new(0, false);
        let Some(left) = difference(&self.fine, &source.fine, &own, 1) else { return false };
        let (mut moved, mut weight) = (0.0, 0.0);
        for i in 0..PLACES {
            let unknown = (1.0 - self.fine.confidence[i]) * self.coarse.confidence[i];
            let unknown = unknown * source.fine.confidence[i];
            moved += f64::from(unknown * (source.fine.height[i] - self.coarse.height[i]).powi(2));
            weight += f64::from(unknown);
        }
        let moved = moved / f64::max(weight, f64::MIN_POSITIVE);
        left < LEFT * plain && left * moved < plain * plain
    }

    /// The transform that lays a source turned so over this (source to target).
    pub fn transform(&self, source: &Frame, turn: usize, mirrored: bool) -> Rigid {
        let angle = turn as f64 / TURNS as f64 * TAU;
        let side = if mirrored { -1.0 } else { 1.0 };
        // From this plane to the source's.
        let there =
            DMat3::from_rotation_z(angle) * DMat3::from_diagonal(DVec3::new(1.0, side, 1.0));
        let linear = self.frame.axes * there.transpose() * source.axes.transpose();
        Rigid { linear, translation: self.frame.centre - linear * source.centre }
    }
}

/// The places of a ring, from 1.
fn ring(k: usize) -> Range<usize> {
    FIRST * k * (k - 1) / 2..FIRST * k * (k + 1) / 2
}

/// The ring of a place.
fn ring_of(i: usize) -> usize {
    (1..=RINGS).find(|&k| ring(k).contains(&i)).unwrap_or(RINGS)
}

/// Where a place is, in radii.
pub fn place(i: usize) -> DVec2 {
    let k = ring_of(i);
    let angle = (i - ring(k).start) as f64 / ring(k).len() as f64 * TAU;
    k as f64 / RINGS as f64 * DVec2::from_angle(angle)
}

/// For each place of a target the two places of a source turned so between which it lies.
pub struct Turned([(u8, u8, f32); PLACES]);

impl Turned {
    /// By `turn` times 10°; mirrored first.
    pub fn new(turn: usize, mirrored: bool) -> Self {
        let mut all = [(0, 0, 0.0); PLACES];
        for (i, entry) in all.iter_mut().enumerate() {
            let places = ring(ring_of(i));
            let n = places.len() as f64;
            let j = (i - places.start) as f64;
            let at = if mirrored { n - j } else { j } + turn as f64 * n / TURNS as f64;
            let below = at.floor();
            let index = |x: f64| (places.start + x as usize % places.len()) as u8;
            *entry = (index(below), index(below + 1.0), (at - below) as f32);
        }
        Self(all)
    }

    /// All turns, each as it is, then (if wanted) mirrored.
    pub fn all(mirrored: bool) -> Vec<(usize, bool, Self)> {
        let sides = &[false, true][..1 + usize::from(mirrored)];
        let of = |t: usize| sides.iter().map(move |&m| (t, m, Self::new(t, m)));
        (0..TURNS).flat_map(of).collect()
    }
}

/// Weighted mean square difference of two layers (Eq. 1), at every `step`-th place.
fn difference(target: &Layer, source: &Layer, turned: &Turned, step: usize) -> Option<f64> {
    let (mut sum, mut weight, mut whole) = (0f32, 0f32, 0f32);
    for (i, &(a, b, t)) in turned.0.iter().enumerate().step_by(step) {
        let (a, b) = (a as usize, b as usize);
        let known = target.confidence[i];
        let there = if t == 0.0 {
            source.confidence[a]
        } else {
            source.confidence[a].min(source.confidence[b])
        };
        let off = target.height[i] - source.height[a] - t * (source.height[b] - source.height[a]);
        sum += known * there * off * off;
        weight += known * there;
        whole += known;
    }
    (weight > 0.0 && f64::from(weight) >= COVER * f64::from(whole))
        .then(|| f64::from(sum) / f64::from(weight))
}

/// What of known differences is felt where nothing is known: values by place, and how much of them.
pub struct Spread {
    value: [f64; PLACES],
    share: [f64; PLACES],
}

/// Diffuses known values over r/2 steps into the empty places (Sec. 4.4).
pub fn spread(known: impl Fn(usize) -> Option<f64>) -> Spread {
    let mut now = Spread { value: [0.0; PLACES], share: [0.0; PLACES] };
    let mut fixed = [false; PLACES];
    for i in 0..PLACES {
        if let Some(value) = known(i) {
            (now.value[i], now.share[i], fixed[i]) = (value, 1.0, true);
        }
    }
    for _ in 0..RINGS / 2 {
        let mut next = Spread { value: now.value, share: now.share };
        for i in (0..PLACES).filter(|&i| !fixed[i]) {
            let around = beside(i);
            let share: f64 = around.iter().map(|&j| now.share[j]).sum();
            if share > 0.0 {
                let sum: f64 = around.iter().map(|&j| now.share[j] * now.value[j]).sum();
                (next.value[i], next.share[i]) = (sum / share, share / around.len() as f64);
            }
        }
        now = next;
    }
    now
}

/// The places next to one: along its ring, inward and outward.
fn beside(i: usize) -> Vec<usize> {
    let k = ring_of(i);
    let (own, j) = (ring(k), i - ring(k).start);
    let mut all =
        vec![own.start + (j + 1) % own.len(), own.start + (j + own.len() - 1) % own.len()];
    for other in [k.wrapping_sub(1), k + 1] {
        if (1..=RINGS).contains(&other) {
            let other = ring(other);
            let at = (j as f64 / own.len() as f64 * other.len() as f64).round() as usize;
            all.push(other.start + at % other.len());
        }
    }
    all
}

impl Spread {
    /// The part of the value that is felt at a point of the plane (in radii), bilinearly.
    pub fn at(&self, p: DVec2) -> f64 {
        let r = (p.length() * RINGS as f64).clamp(1.0, RINGS as f64);
        let turn = p.y.atan2(p.x).rem_euclid(TAU) / TAU;
        let k = (r.floor() as usize).clamp(1, RINGS - 1);
        let on = |k: usize| {
            let places = ring(k);
            let at = turn * places.len() as f64;
            let t = at - at.floor();
            let j = at as usize % places.len();
            let felt = |j: usize| {
                let i = places.start + j % places.len();
                self.value[i] * self.share[i]
            };
            (1.0 - t) * felt(j) + t * felt(j + 1)
        };
        let t = r - k as f64;
        (1.0 - t) * on(k) + t * on(k + 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hills(p: DVec2) -> f64 {
        0.2 * (2.0 * p.x + 0.3).sin() * (1.7 * p.y).cos() + 0.1 * p.x * p.y
    }

    /// A fragment of the hills around a centre, its plane turned and perhaps mirrored.
    fn fragment(turn: f64, mirrored: bool, unknown: impl Fn(DVec2) -> bool) -> Fragment {
        let side = if mirrored { -1.0 } else { 1.0 };
        let (x, y) = (DVec2::from_angle(turn), side * DVec2::from_angle(turn).perp());
        let axes = DMat3::from_cols(x.extend(0.0), y.extend(0.0), DVec3::Z);
        let frame = Frame { centre: DVec3::ZERO, axes };
        Fragment::new(frame, 1.0, |p, _| {
            let known = (!unknown(p.truncate())).then(|| (hills(p.truncate()), 1.0));
            [Some((0.0, 1.0)), known]
        })
    }

    /// As many places a unit of area everywhere.
    #[test]
    fn rings_are_equally_dense() {
        for k in 2..=RINGS {
            let (n, before) = (ring(k).len() as f64, ring(k - 1).len() as f64);
            assert!((n / k as f64 - before / (k - 1) as f64).abs() < 1e-12);
        }
        assert_eq!(ring(RINGS).end, PLACES);
        assert!((place(PLACES - 1).length() - 1.0).abs() < 1e-12);
    }

    /// The same surface seen from a plane that is turned or mirrored: the turn is found, the transform
    /// undoes it, and no other turn comes near.
    #[test]
    fn a_turned_and_mirrored_fragment_is_found() {
        let half = |p: DVec2| p.x > 0.3;
        for (turn, mirrored) in [(0, false), (7, false), (25, true)] {
            let target = fragment(0.0, false, half);
            let source = fragment(turn as f64 / TURNS as f64 * TAU, mirrored, |_| false);
            let mut found: Vec<(f64, usize, bool)> = Turned::all(true)
                .iter()
                .filter_map(|(t, m, turned)| Some((target.distance(&source, turned)?, *t, *m)))
                .collect();
            found.sort_by(|a, b| a.0.total_cmp(&b.0));
            let (best, t, m) = found[0];
            assert_eq!(m, mirrored);
            assert!(best < 0.1 * found.iter().find(|f| f.2 != m).unwrap().0, "{found:?}");
            let back = target.transform(&source.frame, t, m).linear;
            for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
                assert!(back.mul_vec3(axis).distance(axis) < 1e-9, "{back}");
            }
            let sketched = |t: &Turned| target.sketched_distance(&source, t).unwrap();
            let own = Turned::new(t, m);
            assert!(Turned::all(true).iter().all(|o| sketched(&own) <= sketched(&o.2)), "sketch");
        }
    }

    /// What is not known on either side costs nothing; a source that knows too little is no source.
    #[test]
    fn only_known_places_count() {
        let target = fragment(0.0, false, |p| p.x > 0.0);
        let source = fragment(0.0, false, |p| p.x > 0.2);
        let same = Turned::new(0, false);
        assert!(target.distance(&source, &same).unwrap() < 1e-12);
        assert!(source.distance(&fragment(0.0, false, |p| p.x > -0.3), &same).is_none());
    }

    /// The same hills continue a half-known fragment; others do not, nor do hills that fit but lead far away where
    /// nothing is known.
    #[test]
    fn a_fragment_is_continued_by_what_tells_more_than_the_coarser_surface() {
        let target = fragment(0.0, false, |p| p.x > 0.0);
        let source = fragment(0.0, false, |_| false);
        assert!(target.is_continued_by(&source));
        assert!(!target.is_continued_by(&fragment(1.5, false, |_| false)));
        let changed = |off: &dyn Fn(DVec2) -> f32| {
            let mut other = source.clone();
            (0..PLACES).for_each(|i| other.fine.height[i] += off(place(i)));
            other
        };
        let detail = target.detail().sqrt() as f32;
        assert!(target.is_continued_by(&changed(&|_| 0.3 * detail)));
        assert!(!target.is_continued_by(&changed(&|_| 0.6 * detail)));
        let away = |p: DVec2| if p.x > 0.0 { 6.0 * detail } else { 0.3 * detail };
        assert!(!target.is_continued_by(&changed(&away)));
        // Nothing is known of the detail: nothing can tell more.
        let plain = Fragment { fine: target.coarse.clone(), ..target.clone() };
        assert!(!plain.is_continued_by(&source));
    }

    #[test]
    fn a_known_difference_fades_into_the_empty_part() {
        let all = spread(|i| (place(i).x < 0.0).then_some(2.0));
        let at = |x: f64| all.at(DVec2::new(x, 0.0));
        assert!((at(-0.5) - 2.0).abs() < 1e-12);
        assert!(at(0.2) < 1.9 && at(0.2) > at(0.4) && at(0.4) > 0.0 && at(0.95) == 0.0);
        let nothing = spread(|_| None);
        assert_eq!(nothing.at(DVec2::new(0.3, 0.1)), 0.0);
    }
}

//! The sums that laying a source map over a target's bins takes, at all turns at once: five correlations of
//! rows in vector lanes, less the target's moments where the source knows nothing.

use super::blocks::{Lanes, LANES};
use super::height_map::{HeightMap, Row, ANGLES, RADII, WHOLE};
use pulp::{Simd, WithSimd};

/// A known bin of a target, for one side.
pub(super) struct Bin {
    pub(super) r: usize,
    pub(super) a: usize,
    /// In the order of the constants below.
    pub(super) moments: Moments,
}

/// Moments of a target's bin: weight 1, position (x, y) and height h.
const MOMENTS: usize = 10;
pub(super) type Moments = [f32; MOMENTS];
pub(super) const W: usize = 0;
pub(super) const X: usize = 1;
pub(super) const Y: usize = 2;
pub(super) const H: usize = 3;
pub(super) const XX: usize = 4;
pub(super) const XY: usize = 5;
pub(super) const YY: usize = 6;
pub(super) const XH: usize = 7;
pub(super) const YH: usize = 8;
pub(super) const HH: usize = 9;

/// Sums over the target's bins that no source changes.
#[derive(Default, Clone, Copy)]
pub(super) struct Sums {
    pub(super) n: f64,
    pub(super) x: f64,
    pub(super) y: f64,
    pub(super) xx: f64,
    pub(super) xy: f64,
    pub(super) yy: f64,
    pub(super) d: f64,
    pub(super) dx: f64,
    pub(super) dy: f64,
    pub(super) dd: f64,
}

/// Sums at all turns over the bins looked at, from the centre out.
pub(super) struct SoFar {
    /// Of source height times weight, x, y and target height, and of its square.
    pub(super) with_height: [[f32; TURNS]; 5],
    /// Of the target's moments where the source knows nothing.
    missing: Option<Box<[[f32; TURNS]; MOMENTS]>>,
    /// Of (tint of the target − of the source)².
    pub(super) tints: [f32; TURNS],
}

impl Default for SoFar {
    fn default() -> Self {
        Self { with_height: [[0.0; TURNS]; 5], missing: None, tints: [0.0; TURNS] }
    }
}

impl SoFar {
    pub(super) fn add_heights(&mut self, bins: &[Bin], height: &Twice) {
        pulp::Arch::new().dispatch(Heights { sums: &mut self.with_height, bins, height });
    }

    /// Adds a row's moments at each turn over the bins that the source does not know.
    pub(super) fn add_missing(&mut self, row: &[Bin], known: u64) {
        if known == WHOLE || row.is_empty() {
            return;
        }
        let missing = self.missing.get_or_insert_with(|| Box::new([[0.0; TURNS]; MOMENTS]));
        let unknown = doubled(&std::array::from_fn(|a| (!known >> a & 1) as f32));
        pulp::Arch::new().dispatch(Missing { sums: missing, bins: row, unknown: &unknown });
    }

    /// Adds a row's squared differences from the source's tints at each turn, where it knows something.
    pub(super) fn add_tints(&mut self, row: &[Bin], tints: &[f32], of_source: &Twice, known: u64) {
        let Some(first) = row.first() else { return };
        let known =
            (known != WHOLE).then(|| doubled(&std::array::from_fn(|a| (known >> a & 1) as f32)));
        let (sums, source) = (&mut self.tints, &of_source[first.r]);
        pulp::Arch::new().dispatch(Tints { sums, bins: row, tints, source, known: known.as_ref() });
    }

    /// At one turn, from those over the target's bins.
    pub(super) fn at(&self, turn: usize, target: &Sums) -> Sums {
        let target = match &self.missing {
            Some(missing) => target.without(std::array::from_fn(|m| missing[m][turn])),
            None => *target,
        };
        target.less(std::array::from_fn(|m| f64::from(self.with_height[m][turn])))
    }
}

impl Sums {
    pub(super) fn without(self, moments: Moments) -> Self {
        let m = |k: usize| f64::from(moments[k]);
        Self {
            n: self.n - m(W),
            x: self.x - m(X),
            y: self.y - m(Y),
            xx: self.xx - m(XX),
            xy: self.xy - m(XY),
            yy: self.yy - m(YY),
            d: self.d - m(H),
            dx: self.dx - m(XH),
            dy: self.dy - m(YH),
            dd: self.dd - m(HH),
        }
    }

    /// With source heights s taken from the target's: sums of s, x s, y s, h s and s².
    pub(super) fn less(self, [s, sx, sy, sh, ss]: [f64; 5]) -> Self {
        let dd = self.dd - 2.0 * sh + ss;
        Self { d: self.d - s, dx: self.dx - sx, dy: self.dy - sy, dd, ..self }
    }
    pub(super) fn add(&mut self, n: f64, x: f64, y: f64, d: f64) {
        self.n += n;
        self.x += x;
        self.y += y;
        self.xx += x * x;
        self.xy += x * y;
        self.yy += y * y;
        self.d += d;
        self.dx += d * x;
        self.dy += d * y;
        self.dd += d * d;
    }
}

/// The turns in whole lanes: the last ones are not used.
pub(super) const TURNS: usize = ANGLES.next_multiple_of(LANES);

/// Rows whose angles run twice around, so that a turned row is a slice.
pub(super) type Twice = [[f32; ANGLES + TURNS]; RADII];

pub(super) struct Doubled {
    pub(super) height: Twice,
    pub(super) known: [u64; RADII],
    /// The tints, if there are colours.
    pub(super) tint: Option<Box<Twice>>,
}

impl Doubled {
    pub(super) fn new(map: &HeightMap) -> Self {
        let tint = |t: &[Row; RADII]| Box::new(twice(t));
        Self { tint: map.tint.as_deref().map(tint), height: twice(&map.height), known: map.known }
    }
}

/// Each row twice, and on to whole lanes.
pub(super) fn twice(rows: &[Row; RADII]) -> Twice {
    let mut all = [[0.0; _]; RADII];
    all.iter_mut().zip(rows).for_each(|(twice, row)| *twice = doubled(row));
    all
}

fn doubled(row: &Row) -> [f32; ANGLES + TURNS] {
    let mut twice = [0.0; _];
    twice[..ANGLES].copy_from_slice(row);
    twice[ANGLES..2 * ANGLES].copy_from_slice(row);
    twice[2 * ANGLES..].copy_from_slice(&row[..TURNS - ANGLES]);
    twice
}

/// The work of [`SoFar::add_heights`]: only what is always inlined gets the machine's own vector instructions.
struct Heights<'a> {
    sums: &'a mut [[f32; TURNS]; 5],
    bins: &'a [Bin],
    height: &'a Twice,
}

impl WithSimd for Heights<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        for turn in (0..TURNS).step_by(LANES) {
            let mut sums = [0, 1, 2, 3, 4].map(|m| lanes(&self.sums[m], turn));
            for b in self.bins {
                let h = lanes(&self.height[b.r], b.a + turn);
                for l in 0..LANES {
                    sums[0][l] += h[l];
                    sums[1][l] += b.moments[X] * h[l];
                    sums[2][l] += b.moments[Y] * h[l];
                    sums[3][l] += b.moments[H] * h[l];
                    sums[4][l] += h[l] * h[l];
                }
            }
            (0..5).for_each(|m| self.sums[m][turn..turn + LANES].copy_from_slice(&sums[m]));
        }
    }
}

/// The work of [`SoFar::add_missing`]: adds the moments of bins by how little is known where they come to lie.
struct Missing<'a> {
    sums: &'a mut [[f32; TURNS]; MOMENTS],
    bins: &'a [Bin],
    unknown: &'a [f32; ANGLES + TURNS],
}

impl WithSimd for Missing<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        for turn in (0..TURNS).step_by(LANES) {
            let mut sums: [Lanes; MOMENTS] = std::array::from_fn(|m| lanes(&self.sums[m], turn));
            for b in self.bins {
                let u = lanes(self.unknown, b.a + turn);
                for m in 0..MOMENTS {
                    for l in 0..LANES {
                        sums[m][l] += b.moments[m] * u[l];
                    }
                }
            }
            (0..MOMENTS).for_each(|m| self.sums[m][turn..][..LANES].copy_from_slice(&sums[m]));
        }
    }
}

/// The work of [`SoFar::add_tints`]. `known`: 1 where the source knows something; `None`: everywhere.
struct Tints<'a> {
    sums: &'a mut [f32; TURNS],
    bins: &'a [Bin],
    tints: &'a [f32],
    source: &'a [f32; ANGLES + TURNS],
    known: Option<&'a [f32; ANGLES + TURNS]>,
}

impl WithSimd for Tints<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { sums, bins, tints, source, known } = self;
        let mut all: [Lanes; TURNS / LANES] = std::array::from_fn(|k| lanes(sums, k * LANES));
        for (b, &t) in bins.iter().zip(tints) {
            let row: &[f32; TURNS] = array(source, b.a);
            match known.map(|known| array::<TURNS>(known, b.a)) {
                None => {
                    for (k, sums) in all.iter_mut().enumerate() {
                        for l in 0..LANES {
                            let off = t - row[k * LANES + l];
                            sums[l] += off * off;
                        }
                    }
                }
                Some(known) => {
                    for (k, sums) in all.iter_mut().enumerate() {
                        for l in 0..LANES {
                            let off = t - row[k * LANES + l];
                            sums[l] += known[k * LANES + l] * off * off;
                        }
                    }
                }
            }
        }
        sums.chunks_exact_mut(LANES).zip(&all).for_each(|(to, sums)| to.copy_from_slice(sums));
    }
}

/// N numbers of a row: one look at its bounds for all of them.
#[inline(always)]
fn array<const N: usize>(row: &[f32], from: usize) -> &[f32; N] {
    row[from..].first_chunk().expect("rows run on to whole lanes")
}

#[inline(always)]
pub(super) fn lanes(row: &[f32], from: usize) -> Lanes {
    let mut out = [0.0; LANES];
    out.copy_from_slice(&row[from..from + LANES]);
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    /// As one sum after another has it, at every turn, where all of a row is known and where some of it is.
    #[test]
    fn tints_are_compared_as_one_by_one() {
        let noise = |k: usize| ((k * 7919) % 1009) as f32 / 1009.0 - 0.5;
        let source: Row = std::array::from_fn(noise);
        let angles = [0, 1, 7, 20, 35];
        let row: Vec<Bin> = angles.map(|a| Bin { r: 3, a, moments: [0.0; MOMENTS] }).into();
        let tints: Vec<f32> = (0..row.len()).map(|k| noise(k + 100)).collect();
        let mut twice = [[0.0; ANGLES + TURNS]; RADII];
        twice[3] = doubled(&source);
        for known in [WHOLE, WHOLE & 0x5a5_f0f0_1234, 0] {
            let mut so_far = SoFar::default();
            so_far.add_tints(&row, &tints, &twice, known);
            for turn in 0..ANGLES {
                let one = |(b, t): (&Bin, &f32)| {
                    let a = (b.a + turn) % ANGLES;
                    (t - source[a]).powi(2) * (known >> a & 1) as f32
                };
                let sum: f32 = row.iter().zip(&tints).map(one).sum();
                assert!((so_far.tints[turn] - sum).abs() < 1e-6, "{turn}");
            }
        }
    }
}

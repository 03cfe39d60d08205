//! Efros and Freeman (2001), "Image quilting for texture synthesis and transfer": values of a hole put together of
//! small pieces of the source, each of which goes on from what is known and from the pieces before it.
//!
//! From the rim inward (as Criminisi, Pérez, Toyama 2004), around the vertex without a value that is nearest to
//! what is known: of all pieces, turned and reflected, the one with the least Σ w (x − s)² over what is there
//! already. It gives the vertices without a value near its middle. Differences from the papers:
//! - On a surface: a patch is a polar grid in its middle's tangent plane, so that turns and reflections are
//!   permutations.
//! - The cuts between the pieces are made at last, all at once ([`super::quilt_cut`]).
//! - One number is compared, the part of a row along an axis; the size of patches comes from the values.

use super::domain::Domain;
use crate::error::Result;
use crate::matching::height_map::Frame;
use crate::matching::point_tree::PointTree;
use crate::matching::rigid::Rigid;
use crate::matching::source::Source;
use crate::mesh::normals::vertex_normals;
use crate::parallel;
use glam::{DMat3, DVec2, DVec3};
use pulp::{Simd, WithSimd};
use std::f64::consts::TAU;

/// Distances and directions of a patch's samples; turns by one direction are tried.
const RADII: usize = 4;
const TURNS: usize = 12;
const SAMPLES: usize = RADII * TURNS;
/// Pieces of the source that are compared, at most: with 400, 800, 1200, 1500 and 2000 the colours of eight
/// holes in a painted head were off by 41.7, 37.8, 34.9, 36.8 and 33.6 of 255.
const MOST: usize = 1200;
/// Pieces worked on between two looks at the wish to stop.
const BATCH: usize = 64;
/// A sample that is farther than this from any vertex, in edges, is beyond the border.
const GAP: f64 = 1.2;
/// A piece gives the vertices within this part of its radius.
const TAKEN: f64 = 0.6;
/// Width of the weights over a patch, in its radii.
const WIDTH: f64 = 0.6;
/// Weight of what was made, to that of what is known.
const MADE: f64 = 0.5;

/// Numbers on a patch: by distance, then direction.
type Row = [f32; SAMPLES];

/// Pieces of a source.
pub struct Pieces<'a> {
    source: &'a Source,
    /// Radius of a patch, in mesh units.
    pub radius: f64,
    /// By source vertex, what is compared.
    tones: Vec<f32>,
    frames: Vec<Frame>,
    rows: Vec<Row>,
    mirrored: bool,
}

/// What a hole's values are put together of.
pub struct Quilt {
    /// From the source to the target, with the middle there.
    pub pieces: Vec<(Rigid, DVec3)>,
    /// The piece of each fill vertex.
    pub labels: Vec<usize>,
}

/// A piece laid onto a patch: which, turned how far, reflected or not, and how much it differs.
#[derive(Clone, Copy)]
struct Laid {
    piece: usize,
    turn: usize,
    flipped: bool,
    cost: f32,
}

/// The part of a row along an axis.
pub fn tone(axis: &[f64], row: &[f64]) -> f64 {
    row.iter().zip(axis).map(|(x, a)| x * a).sum()
}

/// Distance, in a patch's radii, and direction of each sample.
fn grid() -> impl Iterator<Item = (f64, DVec2)> {
    (0..SAMPLES).map(|k| {
        let (r, turn) = (k / TURNS, (k % TURNS) as f64 * TAU / TURNS as f64);
        ((r + 1) as f64 / RADII as f64, DVec2::from_angle(turn))
    })
}

/// Positions of a patch's samples.
fn samples(frame: Frame, radius: f64) -> impl Iterator<Item = DVec3> {
    let [x, y] = [frame.axes.col(0), frame.axes.col(1)];
    grid().map(move |(r, d)| frame.centre + radius * r * (d.x * x + d.y * y))
}

/// Where sample k of a patch comes to lie when it is turned, reflected first.
fn turned(k: usize, turn: usize, flipped: bool) -> usize {
    let (r, d) = (k / TURNS, k % TURNS);
    let d = if flipped { TURNS - d } else { d };
    r * TURNS + (turn + d) % TURNS
}

impl<'a> Pieces<'a> {
    /// Spread over a source with values, which are seen along `axis`. `None` without any.
    pub fn new(
        source: &'a Source,
        axis: &[f64],
        radius: f64,
        mirrored: bool,
        threads: usize,
        check: &dyn Fn() -> Result<()>,
    ) -> Result<Option<Self>> {
        let Some(paint) = &source.paint else { return Ok(None) };
        let of = |v| tone(axis, paint.row(v)) as f32;
        let tones: Vec<f32> = (0..source.positions.len()).map(of).collect();
        let ids = source.points.ids();
        let count = ids.len().min(MOST);
        let one = |i: usize| {
            let v = ids[i * ids.len() / count] as usize;
            let frame = Frame::new(source.positions[v], source.normals[v], &source.axes);
            let mut row = [0.0; SAMPLES];
            for (x, p) in row.iter_mut().zip(samples(frame, radius)) {
                *x = tones[source.points.nearest_within(p, GAP * source.edge)?.0 as usize];
            }
            (source.normals[v] != DVec3::ZERO).then_some((frame, row))
        };
        let batch = |b: usize| -> Vec<_> {
            (b * BATCH..count.min((b + 1) * BATCH)).filter_map(one).collect()
        };
        let found = parallel::map(count.div_ceil(BATCH), threads, check, &batch)?;
        let (frames, rows): (Vec<_>, Vec<_>) = found.into_iter().flatten().unzip();
        let some = !rows.is_empty();
        Ok(some.then_some(Self { source, radius, tones, frames, rows, mirrored }))
    }

    /// Fills a domain, of whose known surface the values along the axis are given; `None` if no piece fits.
    pub fn fill(
        &self,
        domain: &Domain,
        known: &Source,
        of_known: &dyn Fn(u32) -> f64,
        check: &dyn Fn() -> Result<()>,
    ) -> Result<Option<Quilt>> {
        let sheet = &domain.sheet;
        let points = &sheet.positions[domain.fill.clone()];
        let normals = vertex_normals(&sheet.positions, sheet.triangles.iter().copied());
        let normals = &normals[domain.fill.clone()];
        let tree = PointTree::of_all(points, check)?;
        let made = vec![None; points.len()];
        let mut work = Work { radius: self.radius, known, of_known, tree: &tree, made };
        let off = |p: &DVec3| known.points.nearest(*p).map_or(0.0, |n| n.1.sqrt());
        let depths: Vec<f64> = points.iter().map(off).collect();
        let mut order: Vec<usize> = (0..points.len()).collect();
        order.sort_by(|&a, &b| depths[a].total_cmp(&depths[b]).then(a.cmp(&b)));
        let mut quilt = Quilt { pieces: Vec::new(), labels: vec![usize::MAX; points.len()] };
        for v in order {
            if quilt.labels[v] != usize::MAX || normals[v] == DVec3::ZERO {
                continue;
            }
            check()?;
            let frame = Frame::new(points[v], normals[v], &known.axes);
            let (x, w) = work.patch(&frame);
            let Some(laid) = self.best(&x, &w) else { return Ok(None) };
            let transform = self.transform(&laid, &frame);
            let back = transform.inverse();
            for u in tree.within(frame.centre, TAKEN * self.radius) {
                let label = &mut quilt.labels[u as usize];
                if *label == usize::MAX {
                    *label = quilt.pieces.len();
                    let near = self.source.points.nearest(back.point(points[u as usize]));
                    work.made[u as usize] = near.map(|n| self.tones[n.0 as usize]);
                }
            }
            quilt.pieces.push((transform, frame.centre));
        }
        // A vertex without a normal, which no patch reached.
        quilt.labels.iter_mut().filter(|l| **l == usize::MAX).for_each(|l| *l = 0);
        Ok((!quilt.pieces.is_empty()).then_some(quilt))
    }

    fn transform(&self, laid: &Laid, target: &Frame) -> Rigid {
        let from = &self.frames[laid.piece];
        let (sin, cos) = (laid.turn as f64 * TAU / TURNS as f64).sin_cos();
        let side = if laid.flipped { -1.0 } else { 1.0 };
        let (x, y) = (DVec3::new(cos, sin, 0.0), side * DVec3::new(-sin, cos, 0.0));
        let linear = target.axes * DMat3::from_cols(x, y, DVec3::Z) * from.axes.transpose();
        Rigid { linear, translation: target.centre - linear * from.centre }
    }

    /// The piece that differs least from a patch with such weights, turned as it fits.
    fn best(&self, x: &Row, w: &Row) -> Option<Laid> {
        let mut patches = Vec::new();
        for flipped in [false, true].into_iter().take(1 + usize::from(self.mirrored)) {
            for turn in 0..TURNS {
                let [x, w] =
                    [x, w].map(|row| std::array::from_fn(|k| row[turned(k, turn, flipped)]));
                patches.push((turn, flipped, x, w));
            }
        }
        pulp::Arch::new().dispatch(Compared { pieces: &self.rows, patches: &patches })
    }
}

/// The work of [`Pieces::best`], with the machine's own vector instructions. Patches: turn, whether reflected,
/// values and weights.
struct Compared<'a> {
    pieces: &'a [Row],
    patches: &'a [(usize, bool, Row, Row)],
}

impl WithSimd for Compared<'_> {
    type Output = Option<Laid>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Option<Laid> {
        let mut best: Option<Laid> = None;
        for (piece, row) in self.pieces.iter().enumerate() {
            for &(turn, flipped, ref x, ref w) in self.patches {
                // Of equal ones the first.
                let least = best.map_or(f32::INFINITY, |b| b.cost);
                if let Some(cost) = difference(x, w, row, least) {
                    best = Some(Laid { piece, turn, flipped, cost });
                }
            }
        }
        best
    }
}

/// Σ w (x − s)², in lanes that the compiler keeps side by side; `None` if it is not less than `least`.
#[inline(always)]
fn difference(x: &Row, w: &Row, s: &Row, least: f32) -> Option<f32> {
    const LANES: usize = 8;
    const PART: usize = 2 * LANES;
    let (mut sums, mut all) = ([0.0; LANES], 0.0);
    for part in (0..SAMPLES).step_by(PART) {
        for k in (part..part + PART).step_by(LANES) {
            for (i, sum) in sums.iter_mut().enumerate() {
                let off = x[k + i] - s[k + i];
                *sum += w[k + i] * off * off;
            }
        }
        // In halves, as the lanes do it best.
        let four: [f32; LANES / 2] = std::array::from_fn(|i| sums[i] + sums[i + LANES / 2]);
        all = (four[0] + four[2]) + (four[1] + four[3]);
        if all >= least {
            return None;
        }
    }
    Some(all)
}

/// A hole that is being filled.
struct Work<'a> {
    radius: f64,
    known: &'a Source,
    of_known: &'a dyn Fn(u32) -> f64,
    tree: &'a PointTree,
    /// What each fill vertex has got.
    made: Vec<Option<f32>>,
}

impl Work<'_> {
    /// Value and weight of what is nearest to a sample; nothing where nothing is or it has no value yet.
    fn look(&self, p: DVec3) -> Option<(f32, f64)> {
        let limit = GAP * self.known.edge;
        let near = self.known.points.nearest_within(p, limit);
        match self.tree.nearest_within(p, limit) {
            Some((v, square)) if near.is_none_or(|n| square < n.1) => {
                self.made[v as usize].map(|value| (value, MADE))
            }
            _ => near.map(|(v, _)| ((self.of_known)(v) as f32, 1.0)),
        }
    }

    /// Values and weights of a patch's samples.
    fn patch(&self, frame: &Frame) -> (Row, Row) {
        let (mut x, mut w) = ([0.0; SAMPLES], [0.0; SAMPLES]);
        for (k, (p, (r, _))) in samples(*frame, self.radius).zip(grid()).enumerate() {
            if let Some((value, share)) = self.look(p) {
                // A ring's samples stand for its area.
                let own = r * (-0.5 * (r / WIDTH).powi(2)).exp();
                (x[k], w[k]) = (value, (own * share) as f32);
            }
        }
        (x, w)
    }
}

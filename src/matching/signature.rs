//! Park, Guo, Shin and Qin (2006), "Surface completion for shape and appearance", Sec. 5.2.2: patches whose
//! surroundings of the hole have the most similar curvatures or colours (Eq. 7 to 9).
//!
//! Differences from the paper:
//! - Patches lie around points spread over the source, not in the cells of an octree, and are laid out
//!   by distance and direction from their middle instead of a parameterisation.
//! - A signature's values are taken of each of `SECTORS` sectors of the surroundings, and d of Eq. 8 is the
//!   mean of the sectors' differences: those of the whole say hardly anything of a turn.
//! - The mirrored patch is compared, too.
//! - d_max is the greatest difference among the nearer half of all hypotheses: one crease somewhere would
//!   else make all others alike.

use super::height_map::Frame;
use super::rigid::Rigid;
use super::ring_pattern::{blandness, keep_different, Candidate};
use super::source::Source;
use crate::error::Result;
use crate::parallel;
use glam::{DMat3, DVec3};
use std::f64::consts::TAU;

/// Turns that are tried, 15° apart.
const TURNS: usize = 24;
/// Sectors of the surroundings, three turns each: what a turn moves is then seen, and each has enough
/// points for a mean.
const SECTORS: usize = 8;
/// Points of a patch that are looked at, at most about: a mean of thirty a sector.
const SEEN: usize = 300;
/// Patches compared at most.
const MOST_PATCHES: usize = 2500;
/// Candidates kept for the alignment.
const KEPT: usize = 60;
/// Patches worked on between two looks at the wish to stop.
const BATCH: usize = 16;
/// Least cosine between a point's normal and the patch's: the other side of a thin part is left out.
const SAME_SIDE: f64 = 0.1;
/// Part of the radius over which normals are averaged to give a patch its plane.
const PLANE: f64 = 0.7;
/// The exponent r of Eq. 8.
const SENSITIVITY: i32 = 2;

/// What is compared at each vertex: two curvatures, then the colours.
pub struct Features {
    /// Numbers a vertex.
    width: usize,
    rows: Vec<f32>,
}

impl Features {
    /// Of a source with its curvatures.
    pub fn new(source: &Source, curvatures: &[[f64; 2]]) -> Self {
        let width = 2 + source.paint.as_ref().map_or(0, |p| p.channels);
        let mut rows = Vec::with_capacity(width * curvatures.len());
        for (v, own) in curvatures.iter().enumerate() {
            rows.extend(own.map(|k| k as f32));
            rows.extend(source.paint.iter().flat_map(|p| p.row(v)).map(|&x| x as f32));
        }
        Self { width, rows }
    }

    fn row(&self, v: u32) -> &[f32] {
        &self.rows[v as usize * self.width..][..self.width]
    }
}

/// Which of the signature's values are compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum By {
    /// f₁ to f₆: the curvatures.
    Shape,
    /// g₁ to g₉: the colours.
    Colour,
}

/// Mean, greatest and least value of each feature in each sector; `None` where there is no point.
struct Signature(Vec<Option<Vec<[f32; 3]>>>);

/// The sums that make a signature.
#[derive(Clone)]
struct Sums {
    count: [f32; SECTORS],
    /// Sum, greatest and least by sector, then feature.
    values: Vec<[f32; 3]>,
}

impl Sums {
    fn new(width: usize) -> Self {
        let none = [0.0, f32::NEG_INFINITY, f32::INFINITY];
        Self { count: [0.0; SECTORS], values: vec![none; width * SECTORS] }
    }

    fn add(&mut self, sector: usize, row: &[f32]) {
        self.count[sector] += 1.0;
        for (own, &x) in self.values[sector * row.len()..].iter_mut().zip(row) {
            *own = [own[0] + x, own[1].max(x), own[2].min(x)];
        }
    }

    fn finish(self) -> Signature {
        let width = self.values.len() / SECTORS;
        let sector = |s: usize| {
            let count = self.count[s];
            let means = self.values[s * width..(s + 1) * width].iter();
            (count > 0.0)
                .then(|| means.map(|&[sum, most, least]| [sum / count, most, least]).collect())
        };
        Signature((0..SECTORS).map(sector).collect())
    }
}

/// A hole: what is known around it and where its borders are, seen from its middle.
pub struct Hole {
    frame: Frame,
    radius: f64,
    /// For each turn's width of direction how far the fill and how far the known ring reach.
    border: [[f64; 2]; TURNS],
    signature: Signature,
    roughness: f64,
}

/// A point seen from a frame: distance and turn; `None` at the middle.
fn polar(frame: &Frame, p: DVec3) -> (f64, usize) {
    let local = frame.local(p);
    let turn = local.y.atan2(local.x).rem_euclid(TAU) / TAU * TURNS as f64;
    (local.length(), (turn as usize).min(TURNS - 1))
}

impl Hole {
    /// `fill`: points of the fill; `ring`: known points with their vertex in `features`; `roughness`: theirs.
    pub fn new(
        frame: Frame,
        radius: f64,
        fill: &[DVec3],
        ring: &[(DVec3, u32)],
        features: &Features,
        roughness: f64,
    ) -> Self {
        let mut border = [[0.0f64; 2]; TURNS];
        for &p in fill {
            let (r, turn) = polar(&frame, p);
            border[turn][0] = border[turn][0].max(r);
        }
        for &(p, _) in ring {
            let (r, turn) = polar(&frame, p);
            border[turn][1] = border[turn][1].max(r);
        }
        let mut sums = Sums::new(features.width);
        for &(p, v) in ring {
            let (r, turn) = polar(&frame, p);
            if r > border[turn][0] {
                sums.add(turn * SECTORS / TURNS, features.row(v));
            }
        }
        Self { frame, radius, border, signature: sums.finish(), roughness }
    }

    /// How far anything is looked at.
    fn reach(&self) -> f64 {
        self.border.iter().fold(0.0, |r, b| r.max(b[0]).max(b[1]))
    }

    /// The differences d of Eq. 8 to a patch turned and mirrored so: by feature, mean, greatest and
    /// least. `None` if the patch has nothing in a sector that the hole knows.
    fn differences(
        &self,
        patch: &Patch,
        features: &Features,
        turn: usize,
        mirrored: bool,
    ) -> Option<Vec<f32>> {
        let mut sums = Sums::new(features.width);
        for &(r, own, v) in &patch.points {
            let at = match mirrored {
                false => (own + turn) % TURNS,
                true => (2 * TURNS + turn - 1 - own) % TURNS,
            };
            if r > self.border[at][0] && r <= self.border[at][1] {
                sums.add(at * SECTORS / TURNS, features.row(v));
            }
        }
        let mut total = vec![0.0f32; 3 * features.width];
        let mut known = 0.0f32;
        for (own, other) in self.signature.0.iter().zip(sums.finish().0) {
            let Some(own) = own else { continue };
            let other = other?;
            known += 1.0;
            let each =
                own.iter().zip(&other).flat_map(|(a, b)| [0, 1, 2].map(|k| (a[k] - b[k]).abs()));
            total.iter_mut().zip(each).for_each(|(t, d)| *t += d);
        }
        total.iter_mut().for_each(|t| *t /= known.max(1.0));
        (known > 0.0).then_some(total)
    }

    /// From a patch turned and mirrored so to the hole.
    fn transform(&self, patch: &Frame, turn: usize, mirrored: bool) -> Rigid {
        let angle = turn as f64 / TURNS as f64 * TAU;
        let side = DVec3::new(1.0, if mirrored { -1.0 } else { 1.0 }, 1.0);
        let there = DMat3::from_rotation_z(angle) * DMat3::from_diagonal(side);
        let linear = self.frame.axes * there * patch.axes.transpose();
        Rigid { linear, translation: self.frame.centre - linear * patch.centre }
    }
}

/// A place on the source.
struct Patch {
    frame: Frame,
    /// Distance, turn and vertex of its points.
    points: Vec<(f64, usize, u32)>,
}

impl Patch {
    /// Around a vertex; `None` where it has no plane, or a hole of its own in the middle.
    fn new(source: &Source, vertex: u32, radius: f64, reach: f64) -> Option<Self> {
        let (centre, normal) = (source.positions[vertex as usize], source.normals[vertex as usize]);
        let near = source.points.within(centre, reach);
        let normal_of = |v: &u32| source.normals[*v as usize];
        let inner = |v: &&u32| {
            let off = source.positions[**v as usize].distance_squared(centre);
            off < (PLANE * radius).powi(2) && normal_of(v).dot(normal) > SAME_SIDE
        };
        let plane = near.iter().filter(inner).map(normal_of).sum::<DVec3>().try_normalize()?;
        let frame = Frame::new(centre, plane, &source.axes);
        let step = near.len().div_ceil(SEEN).max(1);
        let seen = near.iter().step_by(step).filter(|v| normal_of(v).dot(plane) > SAME_SIDE);
        let points: Vec<(f64, usize, u32)> = seen
            .map(|&v| {
                let (r, turn) = polar(&frame, source.positions[v as usize]);
                (r, turn, v)
            })
            .collect();
        // What covers the hole must be there.
        let mut there = [false; SECTORS];
        let inside = points.iter().filter(|p| p.0 < radius);
        inside.for_each(|p| there[p.1 * SECTORS / TURNS] = true);
        there.iter().all(|&t| t).then_some(Self { frame, points })
    }
}

/// One patch, turned and mirrored so.
struct Hypothesis {
    patch: u32,
    turn: u8,
    mirrored: bool,
    differences: Vec<f32>,
}

/// The most similar patches of a source for a hole, best first.
pub fn most_similar(
    hole: &Hole,
    source: &Source,
    features: &Features,
    by: By,
    mirrored: bool,
    threads: usize,
    check: &dyn Fn(f64) -> Result<()>,
) -> Result<Vec<Candidate>> {
    let ids = source.points.ids();
    let centres: Vec<u32> = spread(source, ids, hole.radius);
    let sides: &[bool] = if mirrored { &[false, true] } else { &[false] };
    let reach = hole.reach();
    let of = |i: usize| {
        let v = centres[i];
        let patch = Patch::new(source, v, hole.radius, reach)?;
        let mut all = Vec::new();
        for &mirrored in sides {
            for turn in 0..TURNS {
                let found = hole.differences(&patch, features, turn, mirrored);
                all.extend(found.map(|d| {
                    let differences = pick(&d, by);
                    Hypothesis { patch: i as u32, turn: turn as u8, mirrored, differences }
                }));
            }
        }
        Some((patch.frame, all))
    };
    let block = |b: usize| {
        let end = centres.len().min((b + 1) * BATCH);
        (b * BATCH..end).map(of).collect::<Vec<_>>()
    };
    let found = parallel::map_part(centres.len().div_ceil(BATCH), threads, check, &block)?;
    let (mut frames, mut all) = (Vec::new(), Vec::new());
    for one in found.into_iter().flatten() {
        let (frame, hypotheses) = one.map_or((None, Vec::new()), |(f, h)| (Some(f), h));
        frames.push(frame);
        all.extend(hypotheses);
    }
    let similar = similarities(&all);
    let candidate = |(h, similarity): (&Hypothesis, f64)| {
        let frame = frames[h.patch as usize].as_ref()?;
        let rough = source.roughness[centres[h.patch as usize] as usize];
        let bland = blandness(hole.roughness, rough);
        let transform = hole.transform(frame, usize::from(h.turn), h.mirrored);
        Some(Candidate { transform, cost: 1.0 - similarity, bland })
    };
    let found = all.iter().zip(similar).filter_map(candidate).collect();
    Ok(keep_different(found, hole.frame.centre, hole.radius, 0.6, KEPT))
}

/// Vertices so spread that each place is near to one of them, or every n-th.
fn spread(source: &Source, ids: &[u32], radius: f64) -> Vec<u32> {
    // A patch has some area; a tenth of it to each.
    let wanted = (10.0 * source.area / (radius * radius)).ceil() as usize;
    let step = ids.len() as f64 / wanted.clamp(1, MOST_PATCHES).min(ids.len().max(1)) as f64;
    let count = (ids.len() as f64 / step) as usize;
    (0..count).map(|k| ids[(k as f64 * step) as usize]).collect()
}

/// The differences that count.
fn pick(all: &[f32], by: By) -> Vec<f32> {
    match by {
        By::Shape => all[..6].to_vec(),
        By::Colour => all[6..].to_vec(),
    }
}

/// Eq. 8 and 9, all weights 1.
fn similarities(all: &[Hypothesis]) -> Vec<f64> {
    let width = all.first().map_or(0, |h| h.differences.len());
    let greatest: Vec<f32> = (0..width)
        .map(|j| {
            let mut d: Vec<f32> = all.iter().map(|h| h.differences[j]).collect();
            let middle = d.len() / 2;
            *d.select_nth_unstable_by(middle, f32::total_cmp).1
        })
        .collect();
    let one = |h: &Hypothesis| {
        let each = h.differences.iter().zip(&greatest).map(|(&d, &most)| {
            let part = f64::from(d) / f64::from(most).max(f64::MIN_POSITIVE);
            (1.0 - part.min(1.0)).powi(SENSITIVITY)
        });
        each.sum::<f64>() / width.max(1) as f64
    };
    all.iter().map(one).collect()
}

#[cfg(test)]
mod tests {
    use super::super::source::tests::{hills, hilly_source, some_transform};
    use super::*;
    use crate::descriptor::voting::voted_curvatures;
    use crate::matching::paint::Paint;
    use crate::matching::point_tree::PointTree;
    use crate::options::Appearance;

    const RADIUS: f64 = 0.3;

    /// By hand: with differences 0 and 2 of 4 (the median of 0, 2, 4, 4 sorted: its third), S is 1 and ¼.
    #[test]
    fn similarities_are_those_of_equation_8() {
        let hypothesis =
            |d: f32| Hypothesis { patch: 0, turn: 0, mirrored: false, differences: vec![d, 0.0] };
        let all: Vec<Hypothesis> = [0.0, 2.0, 4.0, 4.0].map(hypothesis).into_iter().collect();
        // The second value says nothing: all are alike in it.
        assert_eq!(similarities(&all), [1.0, 0.5 * (0.25 + 1.0), 0.5, 0.5]);
    }

    fn hole_at(source: &Source, features: &Features, centre: DVec3, truth: &Rigid) -> Hole {
        let place = |v: u32| truth.point(source.positions[v as usize]);
        let fill: Vec<DVec3> =
            source.points.within(centre, RADIUS).into_iter().map(place).collect();
        let ring: Vec<(DVec3, u32)> = (source.points.within(centre, 1.5 * RADIUS).into_iter())
            .filter(|&v| source.positions[v as usize].distance(centre) > RADIUS)
            .map(|v| (place(v), v))
            .collect();
        let flat = source.normals.iter().all(|n| *n == DVec3::Z);
        let normal = if flat { DVec3::Z } else { hills(centre.x, centre.y).1 };
        let normal = truth.direction(normal);
        let frame = Frame::new(truth.point(centre), normal, &DMat3::IDENTITY);
        Hole::new(frame, RADIUS, &fill, &ring, features, 0.0)
    }

    /// A place on the hills moved, turned and mirrored: it is the most similar, at the right turn.
    #[test]
    fn the_place_itself_is_the_most_similar() {
        let source = hilly_source(60);
        let curvatures =
            voted_curvatures(&source.positions, &source.normals, &source.faces, 1, &|| Ok(()))
                .unwrap();
        let features = Features::new(&source, &curvatures);
        let centre = hills(0.25, 0.2).0;
        for mirrored in [false, true] {
            let truth = some_transform(mirrored);
            let hole = hole_at(&source, &features, centre, &truth);
            let find = |threads| {
                most_similar(&hole, &source, &features, By::Shape, true, threads, &|_| Ok(()))
                    .unwrap()
            };
            let (found, again) = (find(1), find(2));
            assert!(found.iter().zip(&again).all(|(a, b)| a.transform == b.transform));
            let best = &found[0].transform;
            let off = best.point(centre).distance(truth.point(centre));
            let turned = (best.linear - truth.linear).to_cols_array();
            let turned = turned.iter().map(|x| x * x).sum::<f64>().sqrt();
            println!("mirrored {mirrored}: off {off:.3}, turned {turned:.3}");
            assert!(best.is_mirrored() == mirrored && off < 0.3 * RADIUS);
            // A turn of 15° is 0.37, and the planes are not quite the same.
            assert!(turned < 0.6);
        }
    }

    /// On a flat sheet shape says nothing; colours that are the same nowhere else do.
    #[test]
    fn colours_find_their_place_on_a_plane() {
        let mut source = hilly_source(60);
        source.edit().positions.iter_mut().for_each(|p| p.z = 0.0);
        source.edit().normals.fill(DVec3::Z);
        let colour = |p: &DVec3| [p.x, p.y * p.y, (3.0 * p.x * p.y).sin()];
        let values = source.positions.iter().flat_map(colour).collect();
        let appearance =
            Appearance { channels: 3, steering: 3, values, exemplar_values: Vec::new() };
        source = source.painted(&Paint::new(&appearance));
        let features = Features::new(&source, &vec![[0.0; 2]; source.positions.len()]);
        let ids = (0..source.positions.len() as u32).collect();
        let points = PointTree::new(&source.positions, ids, &|_| Ok(())).unwrap();
        source.edit().points = points;
        let centre = DVec3::new(0.5, 0.4, 0.0);
        let turn = DMat3::from_rotation_z(1.0);
        let truth = Rigid { linear: turn, translation: DVec3::new(1.0, 2.0, 0.0) };
        let hole = hole_at(&source, &features, centre, &truth);
        let found =
            most_similar(&hole, &source, &features, By::Colour, true, 1, &|_| Ok(())).unwrap();
        let best = &found[0].transform;
        assert!(best.point(centre).distance(truth.point(centre)) < 0.3 * RADIUS, "{best:?}");
        assert!(best.direction(DVec3::X).distance(turn.x_axis) < 0.3);
    }
}

//! Candidates for one hole: places on the source that look like its ring, aligned.

use super::height_map::{Frame, HeightMap};
use super::icp::{align, align_with, misfit, worth, Hint, Pairing, Partner, RingPoint, KEEP};
use super::maps::{Kept, Maps, REACH};
use super::rigid::Rigid;
use super::ring_pattern::{keep_different, Candidate, RingPattern};
use super::source::Source;
use super::stretch::stretch;
use crate::error::Result;
use crate::fill::sheet::Sheet;
use crate::parallel;
use glam::{DMat3, DVec3};
use std::sync::Arc;

/// Source maps that the smallest hole is compared with: with 400 and with 1000 a twin far off was lost.
const LEAST_MAPS: usize = 2000;
/// Widths of the ring that are compared, in hole radii.
const WIDTHS: [f64; 2] = [0.5, 1.0];
/// Maps worked on between two looks at the wish to cancel.
const BATCH: usize = 32;
/// How much a target is worth. All grow with its fill up to some five hundred vertices, so that many
/// small holes cost no more than a large one. More candidates gain nothing.
struct Effort {
    /// Source maps that it is compared with: half of them the nearest, the others spread over the rest.
    maps: usize,
    /// Widths of the ring that are compared.
    widths: &'static [f64],
    /// Candidates kept for the ICP, of each width.
    kept: usize,
    /// Of these the best after a first alignment are aligned on the surface itself.
    fine: usize,
    /// And of these so many also on a wider ring.
    widened: usize,
}

impl Effort {
    fn of(target: &Target<'_>, targets: usize) -> Self {
        let n = target.fill.len();
        match targets {
            // Colours alone tell at a glance, and a few places of theirs are looked at, see
            // [`align_closely`].
            1 if target.emphasis > 1.0 => Self {
                maps: (6 * n).max(LEAST_MAPS) / 2,
                widths: &WIDTHS[..1],
                kept: (n / 24).clamp(10, 30),
                fine: 12,
                widened: 0,
            },
            1 => Self {
                maps: (6 * n).max(LEAST_MAPS),
                widths: &WIDTHS,
                kept: (n / 8).clamp(10, 80),
                fine: (n / 12).clamp(6, 30),
                widened: (n / 30).clamp(2, 8),
            },
            // The windows along a long hole are many.
            _ => Self { maps: 500, widths: &WIDTHS[..1], kept: 10, fine: 6, widened: 0 },
        }
    }
}

/// A symmetric image is a candidate if its misfit is less than this part of the best other one's. Of 17 meshes
/// a bird's wounds have it at 0.35 to 0.6 and are filled much better by it; from 0.77 on it only takes the
/// place of others.
const IMAGE: f64 = 0.6;
/// What a map costs beside what a vertex of the fill costs to align, for the progress: measured on holes of
/// 48 to 6,434 new vertices.
const MAP_COST: f64 = 0.33;
/// Ring points of the first and of the second alignment, at most.
pub const POINTS: [usize; 2] = [160, 400];

/// The rim of a hole that is only joined in part: what lies beyond that part says nothing of the fill.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Loose {
    /// Rim vertices, and whether each is only joined; empty if none is.
    rim: Arc<[(DVec3, bool)]>,
}

impl Loose {
    /// Of a sheet.
    pub fn new(sheet: &Sheet) -> Self {
        Self { rim: sheet.positions.iter().copied().zip(sheet.loose.iter().copied()).collect() }
    }

    /// Whether a known point lies beyond: the nearest rim vertex is only joined.
    pub fn beyond(&self, p: DVec3) -> bool {
        let off = |r: &&(DVec3, bool)| r.0.distance_squared(p);
        self.rim.iter().min_by(|a, b| off(a).total_cmp(&off(b))).is_some_and(|nearest| nearest.1)
    }
}

/// What is known around a hole, and where the hole is.
pub struct Target<'a> {
    /// Middle of the fill.
    pub centre: DVec3,
    /// Mean direction outward.
    pub normal: DVec3,
    /// Radius of the fill, in mesh units.
    pub radius: f64,
    /// Points of the initial completion.
    pub fill: &'a [DVec3],
    /// Known points of the ring.
    pub ring: &'a [RingPoint],
    /// What of the known says nothing.
    pub loose: Loose,
    /// How many times what colours usually count they do here.
    pub emphasis: f64,
}

/// The best aligned places for each of several targets of one radius, best first: the source's maps
/// are made once for all.
pub fn find_candidates(
    known: &Source,
    source: &Source,
    maps: &Maps,
    targets: &[Target<'_>],
    threads: usize,
    check: &dyn Fn(f64) -> Result<()>,
) -> Result<Vec<Vec<Candidate>>> {
    let efforts: Vec<Effort> = targets.iter().map(|t| Effort::of(t, targets.len())).collect();
    // The part of the search that making and comparing maps takes.
    let compared = |e: &Effort| MAP_COST * e.maps.min(maps.count()) as f64;
    let cost: f64 = efforts.iter().map(compared).sum();
    let aligned: usize = targets.iter().map(|t| t.fill.len()).sum();
    let first = cost / (cost + aligned as f64).max(1.0);
    let early = |part: f64| check(first * part);
    let matches = search_maps(maps, targets, &efforts, source.own, threads, &early)?;
    let mut all = Vec::new();
    for (i, ((target, effort), matches)) in targets.iter().zip(&efforts).zip(matches).enumerate() {
        let done = |part: f64| (i as f64 + part) / targets.len() as f64;
        let check = |part: f64| check(first + (1.0 - first) * done(part));
        let images = (&matches[..], &maps.symmetries[..]);
        all.push(align_all(known, source, target, images, effort, threads, &check)?);
    }
    Ok(all)
}

/// The candidates of one target that were found otherwise, aligned, best first.
pub fn align_candidates(
    known: &Source,
    source: &Source,
    target: &Target<'_>,
    found: &[Candidate],
    threads: usize,
    check: &dyn Fn(f64) -> Result<()>,
) -> Result<Vec<Candidate>> {
    align_all(known, source, target, (found, &[]), &Effort::of(target, 1), threads, check)
}

/// `symmetries`: transforms that may lay the hole onto its image. One is a candidate only if it fits better
/// than all that was found by looking: a place more that fits as well as others gains nothing.
fn align_all(
    known: &Source,
    source: &Source,
    target: &Target<'_>,
    (matches, symmetries): (&[Candidate], &[Rigid]),
    effort: &Effort,
    threads: usize,
    check: &dyn Fn(f64) -> Result<()>,
) -> Result<Vec<Candidate>> {
    let coarse = thin_ring(target.ring, POINTS[0], &known.axes);
    let (radius, paint) = (target.radius, target.emphasis * worth(source));
    // Aligned by one ring, judged by another.
    let improve = |c: &Candidate, by: &[RingPoint], judge: &[RingPoint], partner, steps, keep| {
        let Candidate { transform, bland, .. } = *c;
        let pairing = Pairing { source, partner, radius: 0.5 * radius, keep, paint };
        let mut hints = vec![Hint::NOTHING; by.len()];
        let transform = align_with(by, transform, steps, &pairing, &mut hints);
        let aligned = std::ptr::eq(by, judge).then_some((partner, &hints[..]));
        let cost = bland * misfit(source, judge, &transform, [radius, paint], aligned);
        Candidate { transform, cost, bland }
    };
    let image = |&transform: &Rigid| Candidate { transform, cost: f64::INFINITY, bland: 1.0 };
    let all: Vec<Candidate> = matches.iter().copied().chain(symmetries.iter().map(image)).collect();
    let first = |i: usize| improve(&all[i], &coarse, &coarse, Partner::Vertex, 12, KEEP);
    let mut found = parallel::map_part(all.len(), threads, &|part| check(0.4 * part), &first)?;
    let images = found.split_off(matches.len());
    let best = found.iter().map(|c| c.cost).fold(f64::INFINITY, f64::min);
    found.extend(images.into_iter().filter(|c| c.cost < IMAGE * best));
    let found = merge(found, target, effort.fine);
    if target.emphasis > 1.0 {
        return Ok(found);
    }
    let fine = thin_ring(target.ring, POINTS[1], &known.axes);
    let second = |i: usize| improve(&found[i], &fine, &fine, Partner::Surface, 15, KEEP);
    let found = parallel::map_part(found.len(), threads, &|part| check(0.4 + 0.4 * part), &second)?;
    let mut found = merge(found, target, effort.fine);
    // The best also by a wider ring, whole: where the near one is plain, or not quite alike.
    let wide = wide_ring(known, target, 1.0);
    let third = |i: usize| improve(&found[i], &wide, &fine, Partner::Surface, 15, 1.0);
    let variants = parallel::map(found.len().min(effort.widened), threads, &|| check(0.8), &third)?;
    found.extend(variants);
    found.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    Ok(found)
}

/// Some transforms aligned on the surface itself.
pub fn align_closely(
    known: &Source,
    source: &Source,
    target: &Target<'_>,
    found: &[Rigid],
    threads: usize,
    check: &dyn Fn() -> Result<()>,
) -> Result<Vec<Rigid>> {
    let ring = thin_ring(target.ring, POINTS[1], &known.axes);
    let paint = target.emphasis * worth(source);
    let partner = Partner::Surface;
    let pairing = Pairing { source, partner, radius: 0.5 * target.radius, keep: KEEP, paint };
    parallel::map(found.len(), threads, check, &|i| align(&ring, found[i], 15, &pairing))
}

/// More alignments of the best copies (source to target, best first), for a hole where copies are to be
/// trusted: by a ring of one and a half radii, and stretched to one of a radius.
pub fn realign(
    known: &Source,
    source: &Source,
    target: &Target<'_>,
    best: &[Rigid],
    threads: usize,
    check: &dyn Fn() -> Result<()>,
) -> Result<Vec<Rigid>> {
    let best = &best[..best.len().min((target.fill.len() / 30).clamp(2, 14))];
    let (wide, wider) = (wide_ring(known, target, 1.0), wide_ring(known, target, 1.5));
    let reach = 0.5 * target.radius;
    let (partner, paint) = (Partner::Surface, target.emphasis * worth(source));
    let pairing = |keep| Pairing { source, partner, radius: reach, keep, paint };
    let one = |i: usize| match best.get(i) {
        Some(&start) => align(&wider, start, 15, &pairing(1.0)),
        None => {
            let start = best[i - best.len()];
            let start = align(&wide, start, 15, &pairing(KEEP));
            stretch(source, &wide, &start, 15, reach, KEEP)
        }
    };
    parallel::map(2 * best.len(), threads, check, &one)
}

fn search_maps(
    maps: &Maps,
    targets: &[Target<'_>],
    efforts: &[Effort],
    own: u32,
    threads: usize,
    check: &dyn Fn(f64) -> Result<()>,
) -> Result<Vec<Vec<Candidate>>> {
    let reach = REACH * maps.radius;
    let Some(widths) = efforts.first().map(|e| e.widths) else { return Ok(Vec::new()) };
    let patterns: Vec<RingPattern> = targets
        .iter()
        .map(|target| {
            let frame = Frame::new(target.centre, target.normal, &maps.known.axes);
            let around = maps.known.blocks.near(target.centre, 1.5 * reach);
            let mut known = HeightMap::new(&maps.known, &around, frame, reach, own);
            // Colours alone may come from a smoother place.
            if target.emphasis > 1.0 {
                known.roughness = 0.0;
            }
            if target.loose != Loose::default() {
                known.forget(reach, &|p| target.loose.beyond(p));
            }
            let reaches: Vec<f64> = widths.iter().map(|w| (1.0 + w) * target.radius).collect();
            let paint = target.emphasis * maps.paint;
            RingPattern::new(&known, target.fill, reach, &reaches, paint)
        })
        .collect();
    let chosen: Vec<Vec<u32>> =
        targets.iter().zip(efforts).map(|(t, e)| maps.choose(t, e.maps, own)).collect();
    let kept: Vec<Vec<Kept>> =
        chosen.iter().map(|ids| ids.iter().map(|_| Kept::new()).collect()).collect();
    let jobs: Vec<(usize, usize)> = (0..patterns.len())
        .filter(|&p| patterns[p].is_useful())
        .flat_map(|p| (0..chosen[p].len()).step_by(BATCH).map(move |b| (p, b)))
        .collect();
    let one = |job: usize| {
        let (p, start) = jobs[job];
        let (ids, kept) = (&chosen[p], &kept[p]);
        let mut found = vec![Vec::new(); widths.len()];
        for i in start..ids.len().min(start + BATCH) {
            if let Some(map) = maps.map(ids[i] as usize, (own, &kept[i])) {
                patterns[p].compare(map, maps.mirrored, &mut found);
            }
        }
        found
    };
    let results = parallel::map_part(jobs.len(), threads, check, &one)?;
    // Of each target by width.
    let mut all = vec![vec![Vec::new(); widths.len()]; targets.len()];
    for (&(p, _), found) in jobs.iter().zip(results) {
        all[p].iter_mut().zip(found).for_each(|(of_width, found)| of_width.extend(found));
    }
    let best = |(p, by_width): (usize, Vec<Vec<Candidate>>)| {
        let Target { centre, radius, .. } = targets[p];
        let keep = |found| keep_different(found, centre, radius, 0.6, efforts[p].kept);
        by_width.into_iter().flat_map(keep).collect()
    };
    Ok(all.into_iter().enumerate().map(best).collect())
}

/// Known points up to `width` radii from the hole, on the target's side.
fn wide_ring(known: &Source, target: &Target<'_>, width: f64) -> Vec<RingPoint> {
    let near = known.points.within(target.centre, (1.0 + width) * target.radius);
    let points: Vec<RingPoint> = near
        .iter()
        .map(|&v| v as usize)
        .filter(|&v| v < known.known_vertices || known.completion[v] != known.own)
        .map(|v| (known.positions[v], known.normals[v], known.tint(v)))
        .filter(|(p, n, _)| n.dot(target.normal) > 0.0 && !target.loose.beyond(*p))
        .collect();
    thin_ring(&points, POINTS[1], &known.axes)
}

/// At most about `most` points, evenly spread: the first of each cell along the axes.
pub fn thin_ring(ring: &[RingPoint], most: usize, axes: &DMat3) -> Vec<RingPoint> {
    let along = axes.transpose();
    if ring.len() <= most {
        return ring.to_vec();
    }
    let low = ring.iter().fold(DVec3::INFINITY, |a, p| a.min(along * p.0));
    let high = ring.iter().fold(DVec3::NEG_INFINITY, |a, p| a.max(along * p.0));
    let mut width = (high - low).length() / (most as f64);
    loop {
        let cell = |p: DVec3| ((along * p - low) / width).to_array().map(|x| x as u32);
        let mut cells: Vec<([u32; 3], usize)> =
            ring.iter().enumerate().map(|(i, p)| (cell(p.0), i)).collect();
        cells.sort_unstable();
        cells.dedup_by_key(|c| c.0);
        if cells.len() <= most {
            return cells.iter().map(|c| ring[c.1]).collect();
        }
        width *= 1.1;
    }
}

/// Drops candidates that lie within 0.08 radii and 0.15 in turn of a better one.
fn merge(found: Vec<Candidate>, target: &Target<'_>, most: usize) -> Vec<Candidate> {
    keep_different(found, target.centre, 0.32 * target.radius, 0.15, most)
}

#[cfg(test)]
mod tests {
    use super::super::maps::{
        centre_spacing, centres_on, cloud_at, cloud_scale, radius_at, scale_of,
    };
    use super::super::rigid::Rigid;
    use super::super::source::tests::{hills, hilly_source, some_transform};
    use super::*;
    use crate::error::Error;
    use crate::mesh::MeshView;

    const RADIUS: f64 = 0.35;

    /// The hills, and the same moved with a hole in their middle.
    fn pair(to_target: &Rigid) -> Source {
        let whole = hilly_source(60);
        let n = whole.positions.len() as u32;
        let is_hole = |f: &[u32; 3]| {
            let middle: DVec3 = f.iter().map(|&v| whole.positions[v as usize]).sum();
            middle.truncate().length() < 3.0 * RADIUS
        };
        let mut vertices: Vec<[f64; 3]> = whole.positions.iter().map(|p| p.to_array()).collect();
        vertices.extend(whole.positions.iter().map(|&p| to_target.point(p).to_array()));
        let turned = |f: &[u32; 3]| match to_target.is_mirrored() {
            true => [f[0] + n, f[2] + n, f[1] + n],
            false => f.map(|v| v + n),
        };
        let mut faces = whole.faces.clone();
        faces.extend(whole.faces.iter().filter(|f| !is_hole(f)).map(turned));
        let rim = |f: &[u32; 3]| if is_hole(f) { f.map(|v| v + n) } else { [u32::MAX; 3] };
        let border = (0..2 * n).filter(|v| whole.on_boundary[(v % n) as usize]);
        let in_hole = whole.faces.iter().flat_map(rim).filter(|&v| v != u32::MAX);
        let boundary: Vec<u32> = border.chain(in_hole).collect();
        let mesh = MeshView::new(&vertices[..], &faces[..]);
        Source::new(mesh, boundary.into_iter(), &|_| Ok(())).unwrap()
    }

    fn maps_of(source: &Source) -> Maps {
        let radius = radius_at(source.edge, scale_of(source.edge, RADIUS));
        let cloud = Arc::new(cloud_at(source, cloud_scale(source, radius), &|| Ok(())).unwrap());
        let spacing = centre_spacing(source, radius);
        let centres = Arc::new(centres_on(&cloud, spacing, &|| Ok(())).unwrap());
        Maps::new(source, radius, [cloud.clone(), cloud], centres, true)
    }

    fn polar(t: &Rigid, radii: std::ops::Range<f64>) -> Vec<RingPoint> {
        let at = |k: usize| {
            let (r, turn) = (k as f64 / 1000.0, 0.7 * k as f64);
            let (p, n) = hills(r * turn.cos(), r * turn.sin());
            (t.point(p), t.direction(n), 0.0)
        };
        let inside = |k: &usize| radii.contains(&(*k as f64 / 1000.0));
        (0..2000).filter(inside).map(at).collect()
    }

    /// The twin comes first, to a small part of an edge, whether rotated or mirrored.
    #[test]
    fn the_twin_is_found() {
        for mirrored in [false, true] {
            let truth = some_transform(mirrored);
            let source = pair(&truth);
            let fill: Vec<DVec3> = polar(&truth, 0.0..RADIUS).iter().map(|p| p.0).collect();
            let ring = polar(&truth, RADIUS..1.5 * RADIUS);
            let target = || Target {
                centre: fill.iter().sum::<DVec3>() / fill.len() as f64,
                normal: truth.direction(DVec3::Z),
                radius: RADIUS,
                fill: &fill,
                ring: &ring,
                loose: Loose::default(),
                emphasis: 1.0,
            };
            let check = |_| Ok(());
            let run = |threads| {
                let maps = maps_of(&source);
                assert!(maps.radius >= RADIUS && maps.radius <= 1.081 * RADIUS);
                find_candidates(&source, &source, &maps, &[target()], threads, &check)
                    .unwrap()
                    .remove(0)
            };
            let found = run(1);
            assert!(found.len() <= 38 && found.is_sorted_by(|a, b| a.cost <= b.cost));
            let best = found[0].transform;
            let off =
                ring.iter().chain(&polar(&truth, 0.0..RADIUS)).fold(0.0, |m: f64, (p, ..)| {
                    m.max(best.point(truth.inverse().point(*p)).distance(*p))
                });
            println!("mirrored {mirrored}: {:.4} edges", off / source.edge);
            assert_eq!(best.is_mirrored(), mirrored);
            assert!(off < 0.05 * source.edge, "{off}");
            let same = |a: &Candidate, b: &Candidate| {
                a.transform == b.transform && a.cost.to_bits() == b.cost.to_bits()
            };
            let others = run(3);
            assert!(found.len() == others.len());
            assert!(found.iter().zip(&others).all(|(a, b)| same(a, b)));
        }
    }

    #[test]
    fn cancel_is_heard() {
        let source = hilly_source(30);
        let ring = polar(&Rigid::IDENTITY, 0.35..0.6);
        let fill: Vec<DVec3> = polar(&Rigid::IDENTITY, 0.0..0.35).iter().map(|p| p.0).collect();
        let (centre, normal) = (fill[0], DVec3::Z);
        let target = Target {
            centre,
            normal,
            radius: RADIUS,
            fill: &fill,
            ring: &ring,
            loose: Loose::default(),
            emphasis: 1.0,
        };
        let stop = |_| Err(Error::Cancelled);
        let found = find_candidates(&source, &source, &maps_of(&source), &[target], 1, &stop);
        assert_eq!(found.err(), Some(Error::Cancelled));
    }

    #[test]
    fn a_thinned_ring_is_part_of_the_ring() {
        let ring = polar(&Rigid::IDENTITY, 0.35..0.6);
        let thin = thin_ring(&ring, 100, &DMat3::IDENTITY);
        assert!((50..=100).contains(&thin.len()), "{}", thin.len());
        assert!(thin.iter().all(|p| ring.contains(p)));
        for (p, ..) in &ring {
            let near = thin.iter().map(|q| q.0.distance(*p)).fold(f64::INFINITY, f64::min);
            assert!(near < 0.3);
        }
        assert_eq!(thin_ring(&ring[..90], 100, &DMat3::IDENTITY), ring[..90]);
    }
}

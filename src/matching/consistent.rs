//! From patches that look alike to rigid transforms on which many of them agree (Fischler and
//! Bolles 1981, "Random sample consensus"), and with it where on an object a hole's surroundings
//! are found again.
//!
//! Differences from the papers:
//! - Harary, Tal and Grinspun (2014, section 5) align each target patch to each candidate by heat
//!   kernel signatures, one by one. Patches of a smooth surface leave the rotation open by 10° to
//!   25° even if the right one is chosen; one transform for all has hundreds of pairs to rest on.
//! - Samples are not blind: the second and third pair are drawn among those whose distances fit.
//! - The centres in the known surroundings of the fill vote, too: there the surface is true.

use super::rigid::Rigid;
use crate::descriptor::ball::{Balls, VertexGraph};
use crate::descriptor::heat::TimeScale;
use crate::descriptor::laplacian::lumped_masses;
use crate::descriptor::patch_signature::{
    Index, Moments, Parts, Scale, Surface, SEARCH_DIMENSIONS,
};
use crate::descriptor::spectrum::Random;
use crate::descriptor::Spectral;
use crate::error::Result;
use crate::mesh::normals::vertex_normals;
use crate::progress::Monitor;
use glam::DVec3;

/// A place on a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    /// In mesh units.
    pub point: DVec3,
    /// Unit outward normal.
    pub normal: DVec3,
}

/// A transform from source to target, and how many of the targets agree with it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Proposal {
    /// Takes the source to the target.
    pub transform: Rigid,
    /// Targets one of whose candidates it takes to them.
    pub votes: usize,
}

/// Samples of three pairs. Measured: `docs/spectrum.md`.
const SAMPLES: usize = 8192;
/// How many of the best distinct samples are refined.
const REFINED: usize = 60;
/// Fits to all pairs that agree, each.
const REFITS: usize = 4;
/// Proposals returned at most.
const MOST: usize = 20;
/// Least cosine of the normals of a pair that agrees (60°): the fill's normals are smoothed ones.
const LEAST_COSINE: f64 = 0.5;
/// Least distance between the targets of a sample, in tolerances: nearer ones say nothing about
/// the rotation.
const LEAST_SPAN: f64 = 2.0;
/// Proposals that are in the mean less than this many tolerances apart are the same one.
const SAME: f64 = 2.0;
/// Targets that two proposals are compared at.
const PROBES: usize = 16;
/// Seed of the samples.
const SEED: u64 = 0x5eed;

/// The transforms that take candidates to targets for the most targets, best first, at most 20, no
/// two nearly the same.
///
/// `candidates[i]` are the places that may correspond to `targets[i]`, likely ones first.
/// `tolerance`, in mesh units, is how far a candidate may come to lie from its target. Both
/// rotations and rotations with reflection are found; which of them a pair stands for is told by
/// the normals. Deterministic.
pub fn find_consistent(
    targets: &[Place],
    candidates: &[Vec<Place>],
    tolerance: f64,
    monitor: &Monitor,
) -> Result<Vec<Proposal>> {
    let pairs = Pairs { targets, candidates, tolerance };
    let mut random = Random(SEED);
    let mut found: Vec<Proposal> = Vec::new();
    for i in 0..SAMPLES {
        if i % 256 == 0 {
            monitor.check()?;
        }
        let Some(sample) = pairs.draw(&mut random) else { continue };
        for mirrored in [false, true] {
            let points = sample.iter().map(|(s, t)| (s.point, t.point, 1.0));
            let Some(transform) = Rigid::fit(points, Some(mirrored)) else { continue };
            if sample.iter().all(|(s, t)| pairs.agree(&transform, s, t)) {
                found.push(Proposal { transform, votes: pairs.votes(&transform) });
            }
        }
    }
    // Distinct ones before the refinement, lest all be the same place; and again after it.
    let mut found = pairs.without_repetition(found, REFINED);
    for proposal in &mut found {
        monitor.check()?;
        pairs.refine(proposal);
    }
    Ok(pairs.without_repetition(found, MOST))
}

struct Pairs<'a> {
    targets: &'a [Place],
    candidates: &'a [Vec<Place>],
    tolerance: f64,
}

impl Pairs<'_> {
    /// Three pairs (source, target) whose mutual distances are the same up to the tolerance.
    fn draw(&self, random: &mut Random) -> Option<[(Place, Place); 3]> {
        let mut below = |n: usize| (random.next_bits() % n.max(1) as u64) as usize;
        let mut sample: [Option<(Place, Place)>; 3] = [None; 3];
        for k in 0..3 {
            // A few tries for a target that is far enough from the others.
            let mut chosen = None;
            for _ in 0..8 {
                let i = below(self.targets.len());
                let t = self.targets.get(i)?;
                let is_far = |other: &(Place, Place)| {
                    other.1.point.distance(t.point) >= LEAST_SPAN * self.tolerance
                };
                if sample[..k].iter().flatten().all(is_far) {
                    chosen = Some((i, *t));
                    break;
                }
            }
            let (i, target) = chosen?;
            let fits = |s: &Place| {
                sample[..k].iter().flatten().all(|(s0, t0)| {
                    let (d, d0) = (s.point.distance(s0.point), target.point.distance(t0.point));
                    let bend = s.normal.dot(s0.normal) - target.normal.dot(t0.normal);
                    (d - d0).abs() < self.tolerance && bend.abs() < LEAST_COSINE
                })
            };
            let fitting = self.candidates.get(i)?.iter().filter(|s| fits(s));
            let count = fitting.clone().count();
            if count == 0 {
                return None;
            }
            let source = *fitting.clone().nth(below(count))?;
            sample[k] = Some((source, target));
        }
        let [Some(a), Some(b), Some(c)] = sample else { return None };
        Some([a, b, c])
    }

    fn agree(&self, transform: &Rigid, source: &Place, target: &Place) -> bool {
        let off = transform.point(source.point).distance_squared(target.point);
        off < self.tolerance * self.tolerance
            && transform.direction(source.normal).dot(target.normal) > LEAST_COSINE
    }

    fn votes(&self, transform: &Rigid) -> usize {
        let pairs = self.targets.iter().zip(self.candidates);
        pairs.filter(|(t, c)| c.iter().any(|s| self.agree(transform, s, t))).count()
    }

    /// Fits the transform to the pairs that agree with it, again and again, as long as there are
    /// not fewer of them.
    fn refine(&self, proposal: &mut Proposal) {
        for _ in 0..REFITS {
            let now = proposal.transform;
            // All that agree, not the nearest of each target: that one would confirm the error.
            let agreeing = |(t, all): (&Place, &Vec<Place>)| {
                let agreeing = all.iter().filter(|s| self.agree(&now, s, t));
                agreeing.map(|s| (s.point, t.point, 1.0)).collect::<Vec<_>>()
            };
            let pairs: Vec<_> =
                self.targets.iter().zip(self.candidates).flat_map(agreeing).collect();
            let kind = Some(now.is_mirrored());
            let Some(transform) = Rigid::fit(pairs.into_iter(), kind) else { return };
            let votes = self.votes(&transform);
            if votes < proposal.votes {
                return;
            }
            *proposal = Proposal { transform, votes };
        }
    }

    /// The `most` best ones, most votes first, without what takes the targets to nearly the same
    /// places as a better one does.
    fn without_repetition(&self, mut found: Vec<Proposal>, most: usize) -> Vec<Proposal> {
        // Of equal ones the order stays.
        found.sort_by_key(|p| std::cmp::Reverse(p.votes));
        let probes: Vec<DVec3> = {
            let step = self.targets.len().div_ceil(PROBES).max(1);
            self.targets.iter().step_by(step).map(|t| t.point).collect()
        };
        let mut kept: Vec<(Proposal, Vec<DVec3>)> = Vec::new();
        for proposal in found {
            let back = proposal.transform.inverse();
            let places: Vec<DVec3> = probes.iter().map(|&p| back.point(p)).collect();
            let is_same = |(other, others): &(Proposal, Vec<DVec3>)| {
                let sum: f64 = places.iter().zip(others).map(|(a, b)| a.distance(*b)).sum();
                other.transform.is_mirrored() == proposal.transform.is_mirrored()
                    && sum < SAME * self.tolerance * places.len() as f64
            };
            if !kept.iter().any(is_same) {
                kept.push((proposal, places));
                if kept.len() == most {
                    break;
                }
            }
        }
        kept.into_iter().map(|k| k.0).collect()
    }
}

/// Targets at most. Measured: `docs/spectrum.md`.
const TARGETS: usize = 400;
/// Sources at most; some 3 edges apart on a scan of 134k vertices.
const SOURCES: usize = 12_000;
/// Candidates of each target: 0.1 % of the sources (Harary et al. 2014, section 4), at least this.
const LEAST_CANDIDATES: usize = 8;
/// Tolerance of the consensus in radii of a patch: descriptors do not place better. Measured:
/// `docs/spectrum.md`.
const TOLERANCE: f64 = 0.5;

/// A mesh whose hole is filled, and what is known about it.
#[derive(Clone, Copy)]
pub struct Filled<'a> {
    /// Positions of the object and the fill.
    pub positions: &'a [DVec3],
    /// Faces of both.
    pub faces: &'a [[u32; 3]],
    /// Vertices of the fill that something is sought for.
    pub is_target: &'a [bool],
    /// Vertices that may be copied from: not of any fill.
    pub is_source: &'a [bool],
}

/// Where on the object the surroundings of the fill are found again, by descriptors: rigid
/// transforms from there to the fill, best first.
///
/// `surface` and `faces` are the object with its hole filled smoothly, `is_target` says which
/// vertices are the fill's; `radius`, in mesh units, is that of a patch. Computes the [`Spectral`]
/// of the mesh, the costly part; [`propose_with`] takes one that is there already.
pub fn propose_by_descriptor(
    surface: &[DVec3],
    faces: &[[u32; 3]],
    is_target: &[bool],
    radius: f64,
    monitor: &Monitor,
) -> Result<Vec<Proposal>> {
    let spectral = Spectral::new(surface, faces, monitor)?;
    let is_source: Vec<bool> = is_target.iter().map(|t| !t).collect();
    let filled = Filled { positions: surface, faces, is_target, is_source: &is_source };
    propose_with(&spectral, filled, radius, monitor)
}

/// The same on a spectrum computed before, on this mesh.
pub fn propose_with(
    spectral: &Spectral,
    filled: Filled<'_>,
    radius: f64,
    monitor: &Monitor,
) -> Result<Vec<Proposal>> {
    let (targets, candidates) = match_patches(spectral, filled, radius, monitor)?;
    find_consistent(&targets, &candidates, TOLERANCE * radius, monitor)
}

/// Centres of patches in and around the fill, and for each the centres elsewhere on the object
/// that look most alike. Patches that reach into the fill are no candidates.
pub fn match_patches(
    spectral: &Spectral,
    filled: Filled<'_>,
    radius: f64,
    monitor: &Monitor,
) -> Result<(Vec<Place>, Vec<Vec<Place>>)> {
    let positions = filled.positions;
    let graph = VertexGraph::new(positions.len(), filled.faces);
    monitor.check()?;
    let near = near_target(filled, &graph, radius, monitor)?;
    let has_faces = |v: &u32| !graph.neighbours(*v).is_empty();
    let all = || (0..positions.len() as u32).filter(has_faces);
    let targets = spread(all().filter(|&v| near[v as usize]).collect(), TARGETS);
    let is_source = |v: &u32| filled.is_source[*v as usize] && !near[*v as usize];
    let sources = spread(all().filter(is_source).collect(), SOURCES);
    if targets.is_empty() || sources.is_empty() {
        return Ok((Vec::new(), Vec::new()));
    }
    let mass = lumped_masses(positions, filled.faces);
    let prolongation = &spectral.prolongation;
    let surface = Surface { positions, graph: &graph, mass: &mass, prolongation };
    let heat = spectral.heat(TimeScale::Linear);
    let describe =
        |centres: &[u32]| Moments::new(surface, &heat, centres, radius, Parts::Mean, monitor);
    let index = Index::new(describe(&sources)?.late(), Scale::Spread, SEARCH_DIMENSIONS, monitor)?;
    let k = (sources.len() / 1000).max(LEAST_CANDIDATES);
    let found = index.nearest(&describe(&targets)?.late(), k, monitor)?;
    let normals = vertex_normals(positions, filled.faces.iter().copied());
    let place = |v: u32| Place { point: positions[v as usize], normal: normals[v as usize] };
    let candidates =
        (found.iter()).map(|near| near.iter().map(|n| place(sources[n.source as usize])).collect());
    Ok((targets.iter().map(|&v| place(v)).collect(), candidates.collect()))
}

/// Which vertices are of the fill or within a patch's radius of it.
fn near_target(
    filled: Filled<'_>,
    graph: &VertexGraph,
    radius: f64,
    monitor: &Monitor,
) -> Result<Vec<bool>> {
    let mut near = filled.is_target.to_vec();
    let mut balls = Balls::new(filled.positions, graph);
    let mut patch = Vec::new();
    let is_rim = |v: &u32| {
        let is_target = |w: &u32| filled.is_target[*w as usize];
        is_target(v) && !graph.neighbours(*v).iter().all(is_target)
    };
    for (i, v) in (0..near.len() as u32).filter(is_rim).enumerate() {
        if i % 256 == 0 {
            monitor.check()?;
        }
        balls.gather(v, radius, &mut patch);
        patch.iter().for_each(|&w| near[w as usize] = true);
    }
    Ok(near)
}

/// At most about `most` of the vertices, in no pattern that the mesh may have.
fn spread(vertices: Vec<u32>, most: usize) -> Vec<u32> {
    if vertices.len() <= most {
        return vertices;
    }
    let limit = (u64::MAX as f64 * (most as f64 / vertices.len() as f64)) as u64;
    vertices.into_iter().filter(|&v| Random(u64::from(v)).next_bits() < limit).collect()
}

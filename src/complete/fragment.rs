//! Bendels, Schnabel and Klein (2005), "Fragment-based surface inpainting": holes are filled scale by
//! scale with copies of fragments of the object.
//!
//! Reads as the list of its steps; `docs/fragment.md` explains them. Differences from the paper:
//! - The guidance of the coarsest scale is the smooth completion.
//! - Holes are filled one by one; the fills of the others are no source.
//! - If the finest fill meets itself or the mesh, that of the next coarser scale stands.

use super::harary::{completed_mesh, Initial};
use super::smooth::Story;
use crate::error::Result;
use crate::fill::patch::Patch;
use crate::matching::fragment::Turned;
use crate::matching::object::mean_edge;
use crate::matching::source::Source;
use crate::mesh::MeshView;
use crate::progress::Monitor;
use crate::result::{Origin, SourceReport, NONE};
use crate::synthesis::domain::depth;
use crate::synthesis::evenly::spread_points;
use crate::synthesis::fragments::{Candidates, Filled, Filling, Pasted};
use crate::synthesis::hierarchy::{radius_in_edges, scales, MOST};
use crate::synthesis::sampling::{take_nodes, take_points};

/// Radius of a fragment of the coarsest scale, in greatest distances from the rim: from one side of a
/// round hole it reaches the other.
const ACROSS: f64 = 2.0;
/// Fewer new vertices than this have no room for detail.
const LEAST: usize = 6;

/// The completion of one hole.
pub struct Completed {
    /// The finest first, each with its story. The rim is the initial one's. Not tested for
    /// intersections. Empty if there is no room for detail.
    pub patches: Vec<(Patch, Story)>,
}

/// What all holes share.
pub struct Asked<'a> {
    /// All boundary vertices of the mesh.
    pub rims: &'a [u32],
    /// Whether mirrored copies may be made.
    pub mirrored: bool,
    /// Threads to use.
    pub threads: usize,
}

/// Completes the holes of a mesh from their smooth completions. `progress` is called with the fraction
/// done.
pub fn complete_holes(
    mesh: MeshView<'_>,
    initial: &[Initial<'_>],
    asked: &Asked<'_>,
    monitor: &Monitor,
    progress: &dyn Fn(f64),
) -> Result<Vec<Completed>> {
    let &Asked { rims, mirrored, threads } = asked;
    let (parts, origins) = completed_mesh(mesh, initial);
    let mut open = vec![false; parts.positions.len()];
    rims.iter().for_each(|&v| open[v as usize] = true);
    initial.iter().flat_map(|i| &i.rim).for_each(|&v| open[v as usize] = false);
    let edge = mean_edge(&parts.positions, &parts.faces);
    let wanted: Vec<usize> = initial.iter().map(|i| coarsest(i.patch, edge)).collect();
    let Some(&most) = wanted.iter().max() else { return Ok(Vec::new()) };
    let all = scales(mesh, &parts, rims, &open, most + 2, &|part| {
        progress(BEFORE * part);
        monitor.check()
    })?;
    let turns = Turned::all(mirrored);
    let check = || monitor.check();
    let mut results: Vec<Vec<Filled>> = initial.iter().map(|_| Vec::new()).collect();
    let new = |i: &Initial<'_>| i.patch.new_count();
    let share = Shares { holes: initial.iter().map(new).zip(wanted.iter().copied()).collect() };
    let (whole, mut done) = (share.of_all(most), 0.0);
    // Scale by scale, so that the candidates of one are there at a time.
    for scale in (0..=most).rev() {
        let two = [&all[scale], &all[scale + 1]];
        let radius = radius_in_edges(scale) * edge;
        let candidates = Candidates::new(two, radius, &turns, threads, &check)?;
        done += share.setup();
        for (hole, init) in initial.iter().enumerate().filter(|(h, _)| wanted[*h] >= scale) {
            if init.patch.new_count() < LEAST {
                continue;
            }
            let origin = &origins[hole];
            let before = results[hole].last();
            let guidance = match before {
                Some(filled) => filled.positions.clone(),
                None => origin.iter().map(|&v| two[1].positions[v as usize]).collect(),
            };
            let filling = Filling::new(two, &candidates, init.patch, origin, guidance, threads);
            let part = share.of(hole, scale);
            let filled = filling.run(before, &|fraction| {
                progress(BEFORE + (1.0 - BEFORE) * (done + fraction * part) / whole);
                monitor.check()
            })?;
            done += part;
            results[hole].push(filled);
        }
    }
    let source = &all[0].source;
    let told = |(filled, init): (Vec<Filled>, &Initial<'_>)| {
        let mut patches = Vec::new();
        for Filled { positions, copies, pasted } in filled.into_iter().rev().take(2) {
            let mut patch = init.patch.clone();
            let rim = patch.rim_count;
            patch.positions[rim..].copy_from_slice(&positions[rim..]);
            if let Some(share) = init.share.filter(|_| patches.is_empty()) {
                let even = spread_points(&patch, &copies, share, init.taken, &check)?;
                let (patch, copies) = take_nodes(&even.0, &even.1, source, init.taken)
                    .or_else(|| take_points(&patch, &copies, &pasted, source, init.taken))
                    .unwrap_or(even);
                patches.push(tell(patch, &copies, &pasted, source));
            }
            patches.push(tell(patch, &copies, &pasted, source));
        }
        Ok(Completed { patches })
    };
    results.into_iter().zip(initial).map(told).collect()
}

/// Part of the time that making the scales takes, measured on holes of 400 vertices in 40,000.
const BEFORE: f64 = 0.2;

/// What the holes cost at each scale, in new vertices at the finest one: fragments cover four times as many
/// at each coarser scale.
struct Shares {
    /// New vertices and coarsest scale of each hole.
    holes: Vec<(usize, usize)>,
}

impl Shares {
    fn of(&self, hole: usize, scale: usize) -> f64 {
        let (new, coarsest) = self.holes[hole];
        if scale > coarsest {
            0.0
        } else {
            new as f64 / f64::from(1u32 << (2 * scale))
        }
    }

    /// Looking at the candidates of a scale: as long as laying some fragments.
    fn setup(&self) -> f64 {
        100.0
    }

    fn of_all(&self, most: usize) -> f64 {
        let of = |scale: usize| (0..self.holes.len()).map(|h| self.of(h, scale)).sum::<f64>();
        (0..=most).map(|scale| self.setup() + of(scale)).sum()
    }
}

/// The scale at which a fragment reaches across a hole.
fn coarsest(patch: &Patch, edge: f64) -> usize {
    let depth = depth(patch);
    (0..MOST - 1)
        .find(|&s| radius_in_edges(s) * std::f64::consts::SQRT_2 * edge > ACROSS * depth)
        .unwrap_or(MOST - 1)
}

/// A patch with where each vertex comes from.
fn tell(
    patch: Patch,
    copies: &[Option<u32>],
    pasted: &[Pasted],
    source: &Source,
) -> (Patch, Story) {
    let (rim, positions) = (patch.rim_count, &patch.positions);
    let mut used = vec![0usize; pasted.len()];
    copies[rim..].iter().flatten().for_each(|&c| used[c as usize] += 1);
    let mut order: Vec<usize> = (0..pasted.len()).filter(|&c| used[c] > 0).collect();
    order.sort_by_key(|&c| (std::cmp::Reverse(used[c]), c));
    let mut rank = vec![NONE; pasted.len()];
    order.iter().enumerate().for_each(|(i, &c)| rank[c] = i as u32);
    let origin = |v: usize| {
        let found = copies[v].and_then(|c| {
            let copy = pasted[c as usize];
            let there = copy.transform.inverse().point(positions[v]);
            let hit = source.tree.closest_point(there, f64::INFINITY)?;
            let [left, plain] = copy.errors;
            let ratio = left / plain.max(f64::MIN_POSITIVE);
            Some(Origin {
                face: source.face_ids[hit.face as usize],
                barycentric: source.barycentric(hit.face, hit.point),
                source: rank[c as usize],
                confidence: 1.0 / (1.0 + ratio * ratio),
            })
        });
        found.unwrap_or(Origin::NOWHERE)
    };
    let origins: Vec<Origin> = (rim..positions.len()).map(origin).collect();
    let new = origins.len().max(1) as f64;
    let report = |&c: &usize| SourceReport {
        transform: pasted[c].transform,
        error: pasted[c].errors[0],
        weight: used[c] as f64 / used.iter().sum::<usize>().max(1) as f64,
        vertices: used[c],
        coloured: 0,
    };
    let sources = order.iter().map(report).collect();
    let confidence = origins.iter().map(|o| o.confidence).sum::<f64>() / new;
    let (seams, ring, coherence_error) = (Vec::new(), Vec::new(), None);
    let colours = Vec::new();
    (
        patch,
        Story { origins, colours, sources, seams, ring, confidence, coherence_error, doubt: 0.0 },
    )
}

//! Harary, Tal and Grinspun (2014), "Context-based coherent surface completion", sec. 4: for each
//! target patch the source patches whose heat kernel signatures are most similar, in each of three
//! time domains.
//!
//! Differences from the paper:
//! - On large objects every n-th source vertex is a centre (`MOST_SOURCES`), and k is 0.1 % of
//!   those: as large a part of the surface as with all.
//! - Of candidates that overlap by more than most of their radius only the best is kept
//!   (`APART`), and not more than `MOST_CANDIDATES`: Eq. 4 is where the time goes.

use super::object::Object;
use crate::descriptor::ball::Balls;
use crate::descriptor::patch_signature::{Domain, Index, Moments, Signatures, SEARCH_DIMENSIONS};
use crate::error::Result;
use crate::mesh::neighbourhood::NONE;
use crate::progress::Monitor;
use glam::DVec3;

/// Centres of source patches at most. On a mesh of 134k vertices they lie two edges apart, which
/// is less than a third of a patch's radius.
const MOST_SOURCES: usize = 40_000;
/// Part of the source patches that are candidates in each domain: 0.1 % (sec. 4).
const SHARE: f64 = 1e-3;
/// Fewest candidates in each domain: 0.1 % of the smallest object in the paper is some thirty.
const FEWEST: usize = 8;
/// Distance of two candidates at least, in radii.
const APART: f64 = 0.25;
/// Candidates of a target patch at most.
pub const MOST_CANDIDATES: usize = 40;
/// Patches described at a time: their moments take 1.6 kB each.
const BLOCK: usize = 4096;

/// The patches of the source, described.
pub struct Sources {
    /// Object vertices.
    centres: Vec<u32>,
    /// By time domain.
    index: Vec<Index>,
    /// In mesh units.
    radius: f64,
}

impl Sources {
    /// Describes the patches of this radius around the object's source vertices.
    pub fn new(object: &Object, radius: f64, monitor: &Monitor) -> Result<Self> {
        let is_near_hole = near_holes(object, radius);
        let is_centre = |v: &u32| object.is_source(*v) && !is_near_hole[*v as usize];
        let all: Vec<u32> = (0..object.positions.len() as u32).filter(is_centre).collect();
        let step = all.len().div_ceil(MOST_SOURCES).max(1);
        let centres: Vec<u32> = all.into_iter().step_by(step).collect();
        let index = describe(object, &centres, radius, monitor)?
            .into_iter()
            .map(|signatures| Index::new(signatures, SEARCH_DIMENSIONS, monitor))
            .collect::<Result<_>>()?;
        Ok(Self { centres, index, radius })
    }

    /// Radius of the patches, in mesh units.
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// For the patch around each of the object vertices given the centres of its candidates, best
    /// first: by place in the list of a domain, domain by domain. `is_patch` says whether a patch
    /// is contained in the source.
    pub fn candidates(
        &self,
        object: &Object,
        targets: &[u32],
        mut is_patch: impl FnMut(u32) -> bool,
        monitor: &Monitor,
    ) -> Result<Vec<Vec<u32>>> {
        let k = ((SHARE * self.centres.len() as f64).ceil() as usize).max(FEWEST);
        let mut lists = Vec::new();
        for (index, signatures) in
            self.index.iter().zip(describe(object, targets, self.radius, monitor)?)
        {
            lists.push(index.nearest(&signatures, k, monitor)?);
        }
        let mut candidates = Vec::with_capacity(targets.len());
        for t in 0..targets.len() {
            monitor.check()?;
            let places = lists.iter().map(|l| l[t].len()).max().unwrap_or(0);
            let ranked = (0..places)
                .flat_map(|i| lists.iter().filter_map(move |l| l[t].get(i)))
                .map(|n| self.centres[n.source as usize]);
            candidates.push(thin(object, ranked, APART * self.radius, &mut is_patch));
        }
        Ok(candidates)
    }
}

/// The vertices whose patches reach into a completion, which the object says nothing about: those in
/// the patches of the completions' outermost vertices.
fn near_holes(object: &Object, radius: f64) -> Vec<bool> {
    let mut is_near = vec![false; object.positions.len()];
    let mut balls = Balls::new(&object.positions, &object.graph);
    let mut patch = Vec::new();
    for v in 0..is_near.len() as u32 {
        let is_outermost = object.hole_of_vertex[v as usize] != NONE
            && object.graph.neighbours(v).iter().any(|&w| object.is_source(w));
        if is_outermost {
            balls.gather(v, radius, &mut patch);
            patch.iter().for_each(|&w| is_near[w as usize] = true);
        }
    }
    is_near
}

/// The paper's signatures of patches, a set for each time domain.
fn describe(
    object: &Object,
    centres: &[u32],
    radius: f64,
    monitor: &Monitor,
) -> Result<Vec<Signatures>> {
    let mut all = vec![Signatures::default(); Domain::ALL.len()];
    for block in centres.chunks(BLOCK) {
        let moments = Moments::new(object.surface(), &object.heat, block, radius, monitor)?;
        for (signatures, domain) in all.iter_mut().zip(Domain::ALL) {
            let part = moments.paper(domain);
            signatures.dim = part.dim;
            signatures.rows.extend(part.rows);
        }
    }
    Ok(all)
}

/// Source patches only, none whose centre lies within `apart` of a better one.
fn thin(
    object: &Object,
    ranked: impl Iterator<Item = u32>,
    apart: f64,
    is_patch: &mut dyn FnMut(u32) -> bool,
) -> Vec<u32> {
    let mut kept: Vec<(u32, DVec3)> = Vec::new();
    for v in ranked {
        let p = object.positions[v as usize];
        let is_near = |k: &(u32, DVec3)| k.1.distance_squared(p) < apart * apart;
        if !kept.iter().any(is_near) && is_patch(v) {
            kept.push((v, p));
            if kept.len() == MOST_CANDIDATES {
                break;
            }
        }
    }
    kept.into_iter().map(|k| k.0).collect()
}

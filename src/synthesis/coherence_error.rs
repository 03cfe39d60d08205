//! Harary, Tal and Grinspun (2014), "Context-based coherent surface completion", sec. 3 and 5: how
//! far a completion is from being made of pieces of the object, and which pieces those are.
//!
//! Differences from the paper: the error is divided by the number of vertices, which mesh repair
//! changes, and its root is taken, so that it is a length.

use super::anchors::Match;
use crate::descriptor::ball::Balls;
use crate::error::Result;
use crate::matching::object::Scene;
use crate::matching::patch::LocalPatch;
use crate::mesh::neighbourhood::NONE;
use crate::progress::Monitor;
use std::collections::HashMap;

/// Source patches by the object vertex that is their centre.
pub type SourcePatches = HashMap<u32, LocalPatch>;

/// The most similar candidate of each target patch (Eq. 3), in order of their numbers; `candidates`
/// by number. Patches without candidates have none.
pub fn match_patches<'a>(
    scene: &Scene<'_>,
    candidates: &[Vec<u32>],
    sources: &'a SourcePatches,
    radius: f64,
    monitor: &Monitor,
) -> Result<Vec<Match<'a>>> {
    let mut balls = Balls::new(&scene.positions, &scene.graph);
    let mut centre_of = vec![NONE; candidates.len()];
    for v in scene.target.new_vertices() {
        if let Some(place) = centre_of.get_mut(scene.target.centre[v] as usize) {
            *place = scene.of_patch(v);
        }
    }
    let mut matches = Vec::new();
    for (list, &centre) in candidates.iter().zip(&centre_of) {
        monitor.check()?;
        if centre == NONE {
            continue;
        }
        let target = LocalPatch::gather(scene, &mut balls, centre, radius);
        let mut best: Option<(f64, &LocalPatch)> = None;
        for source in list.iter().filter_map(|v| sources.get(v)) {
            let d = source.dissimilarity(&target);
            if best.is_none_or(|b| d < b.0) {
                best = Some((d, source));
            }
        }
        let Some((dissimilarity, source)) = best else { continue };
        if let Some(transform) = source.align(scene, &target) {
            matches.push(Match { target, source, transform, dissimilarity });
        }
    }
    Ok(matches)
}

/// The coherence error of what was matched (Eq. 3), as a root mean square over the vertices of the
/// target patches, in mesh units. Infinite without any match.
pub fn coherence_error(matches: &[Match<'_>]) -> f64 {
    let vertices: usize = matches.iter().map(|m| m.target.vertices.len()).sum();
    if vertices == 0 {
        return f64::INFINITY;
    }
    (matches.iter().map(|m| m.dissimilarity).sum::<f64>() / vertices as f64).sqrt()
}

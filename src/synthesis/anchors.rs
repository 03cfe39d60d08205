//! Harary, Tal and Grinspun (2014), "Context-based coherent surface completion", sec. 6: where the
//! target's vertices shall go so that its patches become like those of the source.
//!
//! Each target patch m that holds a vertex offers an anchor ũ_m, the closest point of the source
//! patch laid on it, with the weight d_m^-5, where d_m says how much their feature-line fields
//! differ (Eq. 6). What the same weighted mean misses at the rim, where the truth is known, is
//! spread inward and added (Eq. 7).
//!
//! Differences from the paper:
//! - Eq. 6 and 7 divide by Σ d_m; the sum of the weights, Σ d_m^-5, is meant.
//! - "The closest vertex" of the source patch, at which the fields are compared, is the nearest
//!   corner of the face with the closest point.

use super::field::interpolate;
use crate::intersect::Bvh;
use crate::matching::object::{Scene, Target, Traits};
use crate::matching::patch::LocalPatch;
use crate::matching::rigid::Rigid;
use crate::mesh::neighbourhood::NONE;
use glam::DVec3;

/// The least d: d^-5 stays finite, and patches without any field count alike.
const LEAST: f64 = 1e-30;

/// A target patch and the source patch that is laid on it.
pub struct Match<'a> {
    /// The target patch.
    pub target: LocalPatch,
    /// The source patch.
    pub source: &'a LocalPatch,
    /// From source to target.
    pub transform: Rigid,
    /// D of Eq. 4, in square mesh units.
    pub dissimilarity: f64,
}

/// Sum of the weights and of the weighted anchors of a vertex.
#[derive(Clone, Copy, Default)]
struct Sum {
    weight: f64,
    point: DVec3,
}

/// v_d of Eq. 7 for each vertex of the patch; its own position for the rim and for vertices that no
/// target patch holds.
pub fn wanted_positions(scene: &Scene<'_>, matches: &[Match<'_>]) -> Vec<DVec3> {
    let mut sums = vec![Sum::default(); scene.target.patch.positions.len()];
    let mut in_patch = InPatch::new(scene);
    for m in matches {
        add_anchors(scene, m, &mut in_patch, &mut sums);
    }
    let patch = &scene.target.patch;
    let mean = |v: usize| match sums[v].weight > 0.0 {
        true => sums[v].point / sums[v].weight,
        false => patch.positions[v],
    };
    let mut wanted: Vec<DVec3> = (0..patch.positions.len()).map(mean).collect();
    let offset = offset_field(scene.target, &wanted);
    for v in 0..wanted.len() {
        wanted[v] = match v < patch.rim_count {
            true => patch.positions[v],
            false => wanted[v] + offset[v],
        };
    }
    wanted
}

/// How far the rim is from where Eq. 6 wants it, spread over the patch by L δ = 0.
fn offset_field(target: &Target, wanted: &[DVec3]) -> Vec<DVec3> {
    let patch = &target.patch;
    let is_rim: Vec<bool> = (0..wanted.len()).map(|v| v < patch.rim_count).collect();
    let mut offset: Vec<DVec3> = patch.positions.iter().zip(wanted).map(|(p, w)| *p - *w).collect();
    if interpolate(&patch.positions, &patch.triangles, &is_rim, &mut offset).is_none() {
        offset.fill(DVec3::ZERO);
    }
    offset
}

/// Adds the anchors that one match offers to its target patch's vertices.
fn add_anchors(scene: &Scene<'_>, m: &Match<'_>, in_patch: &mut InPatch, sums: &mut [Sum]) {
    let object = scene.object;
    let tree = in_patch.tree(scene, m.source);
    let back = m.transform.inverse();
    let feature_weight = m.target.vertices.len() as f64;
    let (mut difference, mut total) = (0.0, 0.0);
    let mut anchors: Vec<(usize, DVec3)> = Vec::with_capacity(m.target.vertices.len());
    for &v in &m.target.vertices {
        let moved = back.point(scene.positions[v as usize]);
        let Some(closest) = tree.closest_point(moved, f64::INFINITY) else { return };
        let distance = |w: &u32| object.positions[*w as usize].distance_squared(closest.point);
        let corners = object.faces[closest.face as usize];
        let nearest = corners.into_iter().min_by(|a, b| distance(a).total_cmp(&distance(b)));
        let there = nearest.map_or(Traits::default(), |w| object.traits[w as usize]);
        let here = scene.traits(v);
        let weight = if here.is_feature { feature_weight } else { 1.0 };
        let apart = m.transform.direction(there.field) - here.field;
        difference += weight * apart.length_squared();
        total += weight;
        let number = scene.patch_vertex[v as usize];
        if number != NONE {
            anchors.push((number as usize, m.transform.point(closest.point)));
        }
    }
    let weight = (difference / total).max(LEAST).powi(-5);
    for (v, anchor) in anchors {
        sums[v].weight += weight;
        sums[v].point += weight * anchor;
    }
}

/// Which vertices the current source patch has.
struct InPatch {
    mark: Vec<u32>,
    round: u32,
    faces: Vec<u32>,
}

impl InPatch {
    fn new(scene: &Scene<'_>) -> Self {
        Self { mark: vec![0; scene.object.positions.len()], round: 0, faces: Vec::new() }
    }

    /// A tree over the faces of a source patch.
    fn tree(&mut self, scene: &Scene<'_>, source: &LocalPatch) -> Bvh {
        let object = scene.object;
        self.round += 1;
        source.vertices.iter().for_each(|&v| self.mark[v as usize] = self.round);
        self.faces.clear();
        for &v in &source.vertices {
            for &f in object.incidence.faces(v) {
                let face = object.faces[f as usize];
                // Each face once: at its first vertex.
                if face[0] == v
                    && object.hole_of_face[f as usize] == NONE
                    && face.iter().all(|&w| self.mark[w as usize] == self.round)
                {
                    self.faces.push(f);
                }
            }
        }
        Bvh::from_triangles(
            self.faces
                .iter()
                .map(|&f| (f, object.faces[f as usize].map(|v| object.positions[v as usize]))),
        )
    }
}

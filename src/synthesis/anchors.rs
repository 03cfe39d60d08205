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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::descriptor::ball::Balls;
    use crate::descriptor::curvature::tests::grid;
    use crate::matching::object::tests::bare_object;
    use crate::matching::object::Object;
    use crate::synthesis::levels::target_of;

    fn wave(x: f64) -> f64 {
        0.1 * (std::f64::consts::TAU * x).cos()
    }

    /// A sheet four waves long, whose second wave is hidden under a flat completion that is lifted by
    /// `lift`, with a constant field along x.
    fn waves(lift: f64) -> Object {
        let at = |u: f64, v: f64| DVec3::new(4.0 * u, 1.5 * v, wave(4.0 * u));
        let (positions, faces) = grid((121, 46), (false, false), at);
        let is_hole = |p: DVec3| (p.x - 1.5).abs() < 0.3 && (p.y - 0.7).abs() < 0.3;
        let mut object = bare_object(positions, faces, is_hole);
        for (p, hole) in object.positions.iter_mut().zip(&object.hole_of_vertex) {
            p.z = if *hole == 0 { wave(1.2) + lift } else { p.z };
        }
        object.traits.iter_mut().for_each(|t| t.field = DVec3::X);
        object
    }

    /// The patch of the hole matched with the sheet `by` farther along x.
    fn matched<'a>(
        scene: &Scene<'_>,
        by: f64,
        patches: &'a mut Vec<LocalPatch>,
        turned: bool,
    ) -> Match<'a> {
        let mut balls = Balls::new(&scene.positions, &scene.graph);
        let nearest = |p: DVec3, from: u32| {
            let all = from..scene.positions.len() as u32;
            let d = |v: &u32| scene.positions[*v as usize].distance_squared(p);
            all.min_by(|a, b| d(a).total_cmp(&d(b))).unwrap()
        };
        let middle = DVec3::new(1.5, 0.7, 0.0);
        let centre = nearest(middle, scene.object.positions.len() as u32);
        let there = nearest(middle + DVec3::X * by, 0);
        patches.push(LocalPatch::of_source(scene, &mut balls, there, 0.48).unwrap());
        let turn = if turned { -1.0 } else { 1.0 };
        let transform = Rigid {
            linear: glam::DMat3::from_diagonal(DVec3::new(turn, 1.0, 1.0)),
            translation: DVec3::X * if turned { 3.0 + by } else { -by },
        };
        let target = LocalPatch::gather(scene, &mut balls, centre, 0.45);
        Match { target, source: patches.last().unwrap(), transform, dissimilarity: 0.0 }
    }

    /// One patch a wave farther on: every vertex goes to the closest point of that wave, and as
    /// the rim is there already, nothing is added.
    #[test]
    fn one_match_draws_the_target_onto_its_source() {
        let object = waves(0.02);
        let (target, _) = target_of(&object, 0).unwrap();
        let scene = Scene::new(&object, &target);
        let wanted = wanted_positions(&scene, &[matched(&scene, 1.0, &mut vec![], false)]);
        assert!(target.new_vertices().len() > 200);
        for (v, w) in wanted.iter().enumerate() {
            assert!((w.z - wave(w.x)).abs() < 2e-3, "{v}: {w}");
            assert!(w.distance(target.patch.positions[v]) < 0.25);
            assert!(v >= target.patch.rim_count || *w == target.patch.positions[v]);
        }
    }

    /// Where the source misses the rim by a constant, Eq. 7 takes that off everywhere.
    #[test]
    fn the_offset_at_the_rim_is_spread_inward() {
        let object = waves(0.02);
        let (target, _) = target_of(&object, 0).unwrap();
        let scene = Scene::new(&object, &target);
        let mut patches = vec![];
        let mut lifted = matched(&scene, 1.0, &mut patches, false);
        lifted.transform.translation += DVec3::Z * 0.005;
        let wanted = wanted_positions(&scene, &[lifted]);
        for w in &wanted {
            assert!((w.z - wave(w.x)).abs() < 3e-3, "{w}");
        }
    }

    /// Of two sources the one whose field agrees wins, by the fifth power: mirrored, the field along
    /// x is turned round, and half a wave on the surface is another one.
    #[test]
    fn the_field_decides_between_sources() {
        let object = waves(0.0);
        let (target, _) = target_of(&object, 0).unwrap();
        let scene = Scene::new(&object, &target);
        let (mut first, mut second) = (vec![], vec![]);
        let good = matched(&scene, 1.0, &mut first, false);
        let bad = matched(&scene, 1.5, &mut second, true);
        assert!(bad.transform.is_mirrored());
        let wanted = wanted_positions(&scene, &[bad, good]);
        for w in &wanted {
            assert!((w.z - wave(w.x)).abs() < 2e-3, "{w}");
        }
    }
}

//! Harary, Tal and Grinspun (2014), "Context-based coherent surface completion": a fill is moved
//! until each of its patches looks like some patch of the object. As the paper has it, so that it
//! can be compared with; see `docs/harary.md` for what is corrected, and why.
//!
//! Algorithm 1: initial completion (line 1: the smooth completion, given); for the coarse and the
//! fine object (2, sec. 7) candidate patches (3–4, sec. 4), then, while the error decreases (5), the
//! most similar candidate of each target patch (6–7, sec. 5), an update of the target (8, sec. 6),
//! and the coarse result handed to the fine object (9, sec. 7).
//!
//! Differences from the paper:
//! - Not every vertex of a large hole is the centre of a target patch: [`MOST_TARGETS`], spread
//!   evenly. With patches of 100 to 500 vertices each vertex still lies in dozens.
//! - The rounds end after [`MOST_ROUNDS`], and a patch of the fine object has between
//!   [`RADIUS_RANGE`] edges of radius: bounds of the cost.
//! - The holes of an object are completed side by side, the others' fills being no source.

use crate::descriptor::ball::Balls;
use crate::descriptor::mixture::patch_radius;
use crate::error::Result;
use crate::fill::patch::Patch;
use crate::fill::refine::Taken;
use crate::matching::candidates::Sources;
use crate::matching::object::{Object, Scene, Target};
use crate::matching::patch::LocalPatch;
use crate::mesh::neighbourhood::NONE;
use crate::mesh::MeshView;
use crate::progress::Monitor;
use crate::synthesis::anchors::wanted_positions;
use crate::synthesis::coherence_error::{coherence_error, match_patches, SourcePatches};
use crate::synthesis::describe::{describe, Parts};
use crate::synthesis::levels::{coarsen, follow, spread_centres, target_of};
use crate::synthesis::repair::repair;
use glam::DVec3;
use std::collections::HashSet;

/// Target patches of a hole and level at most.
const MOST_TARGETS: usize = 300;
/// Rounds of matching and moving at most; most end after two to five.
const MOST_ROUNDS: usize = 10;
/// Steps of an update (Q, sec. 6).
const STEPS: usize = 10;
/// Area of a coarse patch, in areas of the object (sec. 7).
const COARSE_PATCH: f64 = 0.01;
/// Radius of a fine patch, in mean edges: the paper's objects get 4 and 7; above 12 the cost grows
/// with the fourth power.
const RADIUS_RANGE: (f64, f64) = (3.0, 12.0);
/// Radius where no curvature stands out: between the paper's two.
const USUAL_RADIUS: f64 = 5.0;
/// Rings of the curvature fits on the fine and on the coarse object.
const RINGS: (usize, usize) = (3, 2);

/// The initial completion of one hole.
pub struct Initial<'a> {
    /// Input vertex of each rim vertex of the patch.
    pub rim: Vec<u32>,
    /// The triangles.
    pub patch: &'a Patch,
    /// Edges between rim vertices that the input has already.
    pub taken: Taken<'a>,
}

/// What became of one hole.
pub struct Coherent {
    /// The completion after each round, the last and most coherent first. The rim is the initial
    /// one's. Not tested for intersections. Empty if nothing on the object could be matched.
    pub patches: Vec<Patch>,
    /// Coherence error (Eq. 3) of the fine object before the first round and after each, in
    /// square mesh units.
    pub errors: Vec<f64>,
}

/// Completes the holes of a mesh from their smooth completions. `progress` is called with the
/// fraction done.
pub fn complete_holes_harary(
    mesh: MeshView<'_>,
    initial: &[Initial<'_>],
    monitor: &Monitor,
    progress: &dyn Fn(f64),
) -> Result<Vec<Coherent>> {
    let (parts, origins) = completed_mesh(mesh, initial);
    let fine = describe(parts, RINGS.0, monitor)?;
    progress(0.2);
    let (parts, parent) = coarsen(&fine, monitor)?;
    let coarse = describe(parts, RINGS.1, monitor)?;
    progress(0.25);

    let radius = (COARSE_PATCH * coarse.area() / std::f64::consts::PI).sqrt();
    let sources = Sources::new(&coarse, radius, monitor)?;
    let mut targets = Vec::with_capacity(initial.len());
    let mut matched = HashSet::new();
    for (hole, init) in initial.iter().enumerate() {
        let mut target = Target::new(hole as u32, init.patch.clone(), &origins[hole], &fine);
        if let Some((start, origin)) = target_of(&coarse, hole as u32) {
            let level = Level { object: &coarse, sources: &sources, taken: &[] };
            let rounds = level.run(start, &origin, monitor)?;
            matched.extend(rounds.matched);
            if let Some(best) = rounds.targets.last() {
                follow(&mut target, best);
            }
        }
        targets.push(target);
        progress(0.25 + 0.2 * (hole + 1) as f64 / initial.len() as f64);
    }

    let sources = Sources::new(&fine, fine_radius(&fine, &parent, &matched), monitor)?;
    progress(0.6);
    let mut results = Vec::with_capacity(initial.len());
    for ((target, init), origin) in targets.into_iter().zip(initial).zip(&origins) {
        let level = Level { object: &fine, sources: &sources, taken: init.taken };
        let rounds = level.run(target, origin, monitor)?;
        let patches = rounds.targets.into_iter().rev().map(|t| t.patch).collect();
        results.push(Coherent { patches, errors: rounds.errors });
        progress(0.6 + 0.4 * results.len() as f64 / initial.len() as f64);
    }
    Ok(results)
}

/// Radius of the fine object's patches (sec. 7), from the curvatures at the source patches that
/// were matched on the coarse one.
fn fine_radius(fine: &Object, parent: &[u32], matched: &HashSet<u32>) -> f64 {
    let is_matched = |v: &usize| {
        fine.hole_of_vertex[*v] == NONE && (matched.is_empty() || matched.contains(&parent[*v]))
    };
    let curvatures: Vec<f64> =
        (0..parent.len()).filter(is_matched).map(|v| fine.curvature[v]).collect();
    let edge = fine.mean_edge();
    let radius = patch_radius(&curvatures, edge).unwrap_or(USUAL_RADIUS * edge);
    radius.clamp(RADIUS_RANGE.0 * edge, RADIUS_RANGE.1 * edge)
}

/// One resolution of the object, as one hole sees it.
struct Level<'a> {
    object: &'a Object,
    sources: &'a Sources,
    taken: Taken<'a>,
}

/// What the rounds of a level gave.
struct Rounds {
    /// The target after each round that made it more coherent.
    targets: Vec<Target>,
    /// The error before the first of them and after each.
    errors: Vec<f64>,
    /// Vertices of the source patches that were the most similar to some target patch.
    matched: HashSet<u32>,
}

impl Level<'_> {
    /// Lines 3 to 8 of Algorithm 1. `origin`: object vertex of each vertex of the target.
    fn run(&self, mut target: Target, origin: &[u32], monitor: &Monitor) -> Result<Rounds> {
        let centres = spread_centres(&target, MOST_TARGETS);
        for (i, &v) in centres.iter().enumerate() {
            target.centre[v] = i as u32;
        }
        let origins: Vec<u32> = centres.iter().map(|&v| origin[v]).collect();
        let (candidates, patches) = self.find_candidates(&target, &origins, monitor)?;
        let mut rounds = Rounds { targets: vec![], errors: vec![], matched: HashSet::new() };
        for round in 0..=MOST_ROUNDS {
            let scene = Scene::new(self.object, &target);
            let radius = self.sources.radius();
            let matches = match_patches(&scene, &candidates, &patches, radius, monitor)?;
            let error = coherence_error(&matches);
            // Written so that no matches (an infinite error) end it, too.
            if !(error < rounds.errors.last().copied().unwrap_or(f64::INFINITY)) {
                break;
            }
            rounds.errors.push(error);
            if round > 0 {
                rounds.targets.push(target.clone());
            }
            rounds.matched = matches.iter().flat_map(|m| &m.source.vertices).copied().collect();
            target.patch.offsets = wanted_positions(&scene, &matches);
            for _ in 0..STEPS {
                monitor.check()?;
                step(&mut target.patch);
                repair(&mut target, self.taken);
            }
        }
        Ok(rounds)
    }

    /// The candidates of each target patch, and all their patches (sec. 4).
    fn find_candidates(
        &self,
        target: &Target,
        origins: &[u32],
        monitor: &Monitor,
    ) -> Result<(Vec<Vec<u32>>, SourcePatches)> {
        let scene = Scene::new(self.object, target);
        let mut balls = Balls::new(&scene.positions, &scene.graph);
        let (mut patches, mut refused) = (SourcePatches::new(), HashSet::new());
        let is_patch = |v: u32| {
            if patches.contains_key(&v) || refused.contains(&v) {
                return !refused.contains(&v);
            }
            let patch = LocalPatch::of_source(&scene, &mut balls, v, self.sources.radius());
            match patch {
                Some(patch) => patches.insert(v, patch).is_none(),
                None => !refused.insert(v),
            }
        };
        let candidates = self.sources.candidates(self.object, origins, is_patch, monitor)?;
        Ok((candidates, patches))
    }
}

/// The first of the steps that are left towards the wanted positions.
fn step(patch: &mut Patch) {
    for v in patch.rim_count..patch.positions.len() {
        let left = patch.offsets[v] - patch.positions[v];
        patch.positions[v] += left / STEPS as f64;
    }
}

/// The mesh with all its initial completions, and the vertex of it that each patch vertex is.
fn completed_mesh(mesh: MeshView<'_>, initial: &[Initial<'_>]) -> (Parts, Vec<Vec<u32>>) {
    let mut parts = Parts::default();
    parts.positions = (0..mesh.vertices.len()).map(|v| DVec3::from(mesh.vertices.get(v))).collect();
    let has_corners = |f: &[u32; 3]| f[0] != f[1] && f[1] != f[2] && f[2] != f[0];
    parts.faces = (0..mesh.faces.len()).map(|f| mesh.faces.get(f)).filter(has_corners).collect();
    parts.hole_of_face = vec![NONE; parts.faces.len()];
    parts.hole_of_vertex = vec![NONE; parts.positions.len()];
    let mut origins = Vec::with_capacity(initial.len());
    for (hole, Initial { rim, patch, .. }) in initial.iter().enumerate() {
        let (first, new) = (parts.positions.len() as u32, &patch.positions[patch.rim_count..]);
        let mut origin = rim.clone();
        origin.extend((0..new.len() as u32).map(|i| first + i));
        parts.positions.extend_from_slice(new);
        parts.faces.extend(patch.triangles.iter().map(|t| t.map(|v| origin[v as usize])));
        parts.hole_of_face.resize(parts.faces.len(), hole as u32);
        parts.hole_of_vertex.resize(parts.positions.len(), hole as u32);
        origins.push(origin);
    }
    (parts, origins)
}

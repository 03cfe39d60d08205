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
//! - Algorithm 1 ends at the first update that does not lower the error. The first update stands all
//!   the same, since it raises the error, a little, at half of the holes tried; a later one that
//!   does is undone.
//! - Not every vertex of a large hole is the centre of a target patch: `MOST_TARGETS`, spread
//!   evenly. With patches of 30 to 400 vertices each vertex still lies in dozens.
//! - The rounds end after `MOST_ROUNDS`, and a patch of the fine object has a radius of
//!   `RADIUS_RANGE` edges: bounds of the cost.
//! - The holes of an object are completed one by one; the fills of the others are no source.

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

/// Target patches of a hole and level at most: bounds the cost, which is in proportion.
const MOST_TARGETS: usize = 800;
/// Rounds of matching and moving at most; most holes end after one.
const MOST_ROUNDS: usize = 5;
/// Steps of an update (Q, sec. 6).
const STEPS: usize = 10;
/// Area of a coarse patch, in areas of the object (sec. 7).
const COARSE_PATCH: f64 = 0.01;
/// Radius of a fine patch, in mean edges: the paper's objects get 4 and 7. The cost grows with the
/// third power and more.
const RADIUS_RANGE: (f64, f64) = (3.0, 10.0);
/// Radius where no curvature stands out: between the paper's two.
const USUAL_RADIUS: f64 = 5.0;
/// Rings of the curvature fits.
const RINGS: usize = 2;

/// The initial completion of one hole.
pub struct Initial<'a> {
    /// Input vertex of each rim vertex of the patch.
    pub rim: Vec<u32>,
    /// The triangles.
    pub patch: &'a Patch,
    /// Edges between rim vertices that the input has already.
    pub taken: Taken<'a>,
    /// See [`crate::fill::outline::Outline::share`].
    pub share: Option<f64>,
}

/// What became of one hole.
pub struct Coherent {
    /// The completion after each round, the last and most coherent first. The rim is the initial
    /// one's. Not tested for intersections. Empty if nothing on the object could be matched.
    pub patches: Vec<Patch>,
    /// Coherence error (Eq. 3, root mean square, in mesh units) of the initial completion and of
    /// the first of `patches`, both on the fine object. Infinite where nothing could be matched.
    pub errors: [f64; 2],
}

/// Completes the holes of a mesh from their smooth completions. `progress` is called with the
/// fraction done.
pub fn complete_holes_harary(
    mesh: MeshView<'_>,
    initial: &[Initial<'_>],
    monitor: &Monitor,
    progress: &dyn Fn(f64),
) -> Result<Vec<Coherent>> {
    if initial.is_empty() {
        return Ok(Vec::new());
    }
    let (parts, origins) = completed_mesh(mesh, initial);
    let fine = describe(parts, RINGS, monitor)?;
    progress(0.2);
    let (parts, parent) = coarsen(&fine, monitor)?;
    let coarse = describe(parts, RINGS, monitor)?;
    progress(0.25);

    let radius = (COARSE_PATCH * coarse.area() / std::f64::consts::PI).sqrt();
    let sources = Sources::new(&coarse, radius, monitor)?;
    let mut coarse_results = Vec::with_capacity(initial.len());
    let mut matched = HashSet::new();
    for hole in 0..initial.len() as u32 {
        let mut moved = None;
        if let Some((mut target, origin)) = target_of(&coarse, hole) {
            let level = Level::new(&coarse, &sources, &mut target, &origin, monitor)?;
            let rounds = level.run(target, &[], monitor)?;
            matched.extend(rounds.matched);
            moved = rounds.targets.into_iter().last();
        }
        coarse_results.push(moved);
        progress(0.25 + 0.2 * coarse_results.len() as f64 / initial.len() as f64);
    }

    let sources = Sources::new(&fine, fine_radius(&fine, &parent, &matched), monitor)?;
    progress(0.6);
    let mut results = Vec::with_capacity(initial.len());
    for (hole, (init, moved)) in initial.iter().zip(coarse_results).enumerate() {
        let mut target = Target::new(hole as u32, init.patch.clone(), &origins[hole], &fine);
        let level = Level::new(&fine, &sources, &mut target, &origins[hole], monitor)?;
        let before = level.error(&target, monitor)?;
        if let Some(moved) = moved {
            follow(&mut target, &moved);
        }
        let rounds = level.run(target, init.taken, monitor)?;
        let after = rounds.errors.last().copied().unwrap_or(before);
        let patches = rounds.targets.into_iter().rev().map(|t| t.patch).collect();
        results.push(Coherent { patches, errors: [before, after] });
        progress(0.6 + 0.4 * results.len() as f64 / initial.len() as f64);
    }
    Ok(results)
}

/// Coherence errors (Eq. 3, root mean square, in mesh units) of other surfaces over one hole, each
/// given by the positions of the vertices of its initial completion, which the candidates are
/// found by. Patches are as large as all the object's curvatures say (sec. 7).
pub fn coherence_errors(
    mesh: MeshView<'_>,
    initial: &Initial<'_>,
    surfaces: &[&[DVec3]],
    monitor: &Monitor,
) -> Result<Vec<f64>> {
    let (parts, origins) = completed_mesh(mesh, std::slice::from_ref(initial));
    let object = describe(parts, RINGS, monitor)?;
    let sources = Sources::new(&object, fine_radius(&object, &[], &HashSet::new()), monitor)?;
    let mut target = Target::new(0, initial.patch.clone(), &origins[0], &object);
    let level = Level::new(&object, &sources, &mut target, &origins[0], monitor)?;
    let error = |positions: &&[DVec3]| {
        target.patch.positions.copy_from_slice(positions);
        level.error(&target, monitor)
    };
    surfaces.iter().map(error).collect()
}

/// Radius of the fine object's patches (sec. 7), from the curvatures at the source patches that
/// were matched on the coarse one; at all of the source if none were.
fn fine_radius(fine: &Object, parent: &[u32], matched: &HashSet<u32>) -> f64 {
    let is_matched = |v: usize| matched.is_empty() || matched.contains(&parent[v]);
    let curvatures: Vec<f64> = (0..fine.positions.len())
        .filter(|&v| fine.is_source(v as u32) && is_matched(v))
        .map(|v| fine.curvature[v])
        .collect();
    let edge = fine.mean_edge();
    let radius = patch_radius(&curvatures, edge).unwrap_or(USUAL_RADIUS * edge);
    radius.clamp(RADIUS_RANGE.0 * edge, RADIUS_RANGE.1 * edge)
}

/// One resolution of the object, as one hole sees it.
struct Level<'a> {
    object: &'a Object,
    /// Radius of a patch, in mesh units.
    radius: f64,
    /// Candidates of each target patch.
    candidates: Vec<Vec<u32>>,
    /// The patches of all of them.
    patches: SourcePatches,
}

/// What the rounds of a level gave.
struct Rounds {
    /// The target after each round.
    targets: Vec<Target>,
    /// The error before the first of them and after each; empty without any match.
    errors: Vec<f64>,
    /// Vertices of the source patches that were the most similar to some target patch.
    matched: HashSet<u32>,
}

impl<'a> Level<'a> {
    /// Chooses the target patches and finds their candidates (lines 3 and 4 of Algorithm 1).
    /// `origin`: object vertex of each vertex of the target.
    fn new(
        object: &'a Object,
        sources: &Sources,
        target: &mut Target,
        origin: &[u32],
        monitor: &Monitor,
    ) -> Result<Self> {
        let centres = spread_centres(target, MOST_TARGETS);
        for (i, &v) in centres.iter().enumerate() {
            target.centre[v] = i as u32;
        }
        let centres: Vec<u32> = centres.iter().map(|&v| origin[v]).collect();
        let radius = sources.radius();
        let scene = Scene::new(object, target);
        let mut balls = Balls::new(&scene.positions, &scene.graph);
        let (mut patches, mut refused) = (SourcePatches::new(), HashSet::new());
        let is_patch = |v: u32| {
            if !patches.contains_key(&v) && !refused.contains(&v) {
                match LocalPatch::of_source(&scene, &mut balls, v, radius) {
                    Some(patch) => _ = patches.insert(v, patch),
                    None => _ = refused.insert(v),
                }
            }
            patches.contains_key(&v)
        };
        let candidates = sources.candidates(object, &centres, is_patch, monitor)?;
        Ok(Self { object, radius, candidates, patches })
    }

    /// The coherence error of a target.
    fn error(&self, target: &Target, monitor: &Monitor) -> Result<f64> {
        let scene = Scene::new(self.object, target);
        let (candidates, patches) = (&self.candidates, &self.patches);
        let matches = match_patches(&scene, candidates, patches, self.radius, monitor)?;
        Ok(coherence_error(&matches))
    }

    /// Lines 5 to 8 of Algorithm 1.
    fn run(&self, mut target: Target, taken: Taken<'_>, monitor: &Monitor) -> Result<Rounds> {
        let mut rounds = Rounds { targets: vec![], errors: vec![], matched: HashSet::new() };
        for round in 0..=MOST_ROUNDS {
            let scene = Scene::new(self.object, &target);
            let (candidates, patches) = (&self.candidates, &self.patches);
            let matches = match_patches(&scene, candidates, patches, self.radius, monitor)?;
            let error = coherence_error(&matches);
            let decreases = rounds.errors.last().is_none_or(|&before| error < before);
            if matches.is_empty() || round > 1 && !decreases {
                break;
            }
            rounds.errors.push(error);
            rounds.matched = matches.iter().flat_map(|m| &m.source.vertices).copied().collect();
            if round > 0 {
                rounds.targets.push(target.clone());
            }
            if !decreases || round == MOST_ROUNDS {
                break;
            }
            target.patch.offsets = wanted_positions(&scene, &matches);
            for _ in 0..STEPS {
                monitor.check()?;
                step(&mut target.patch);
                repair(&mut target, taken);
            }
        }
        Ok(rounds)
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
pub(super) fn completed_mesh(
    mesh: MeshView<'_>,
    initial: &[Initial<'_>],
) -> (Parts, Vec<Vec<u32>>) {
    let positions: Vec<DVec3> =
        (0..mesh.vertices.len()).map(|v| DVec3::from(mesh.vertices.get(v))).collect();
    let has_corners = |f: &[u32; 3]| f[0] != f[1] && f[1] != f[2] && f[2] != f[0];
    let faces: Vec<[u32; 3]> =
        (0..mesh.faces.len()).map(|f| mesh.faces.get(f)).filter(has_corners).collect();
    let (hole_of_face, hole_of_vertex) = (vec![NONE; faces.len()], vec![NONE; positions.len()]);
    let mut parts = Parts { positions, faces, hole_of_face, hole_of_vertex };
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
#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Error;
    use crate::sample::{break_mesh, Break, BreakOptions, Sample, SampleMesh};
    use crate::{complete_mesh_with, Method, Options};
    use std::sync::atomic::{AtomicUsize, Ordering};
    use std::time::{Duration, Instant};

    fn broken(sample: Sample, resolution: usize) -> SampleMesh {
        let whole = sample.build(resolution).unwrap();
        let options = BreakOptions { kind: Break::Disc, seed: 0, size: 1.0 };
        break_mesh(sample, &whole, &options).unwrap().mesh
    }

    /// An octahedron without one face, its completion a vertex in the middle: far too small for
    /// any patch.
    #[test]
    fn an_object_without_sources_is_left_as_it_is() {
        let corner = |i: usize, s: f64| {
            let mut p = [0.0; 3];
            p[i] = s;
            p
        };
        let vertices: Vec<[f64; 3]> =
            (0..3).flat_map(|i| [corner(i, 1.0), corner(i, -1.0)]).collect();
        let faces = [[2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
        let positions: Vec<DVec3> =
            [0, 2, 4].map(|v: usize| DVec3::from(vertices[v])).into_iter().collect();
        let middle = positions.iter().sum::<DVec3>() / 3.0;
        let patch = Patch::of_triangles(
            [positions, vec![middle]].concat(),
            vec![1.0; 4],
            3,
            vec![[0, 1, 3], [1, 2, 3], [2, 0, 3]],
        );
        let initial = Initial { rim: vec![0, 2, 4], patch: &patch, taken: &[], share: None };
        let mesh = MeshView::new(&vertices[..], &faces[..]);
        let made = complete_holes_harary(mesh, &[initial], &Monitor::silent(), &|_| {}).unwrap();
        assert!(made[0].patches.is_empty() && made[0].errors[0].is_infinite());
    }

    #[test]
    fn the_wish_to_stop_is_heard_soon() {
        let mesh = broken(Sample::Vessel, 120);
        let options = Options { method: Method::Harary, threads: 1, ..Options::default() };
        let (calls, asked) = (AtomicUsize::new(0), std::sync::Mutex::new(Instant::now()));
        let progress = |_: f64, stage: &str| {
            let go = !stage.starts_with("continuing") || calls.fetch_add(1, Ordering::Relaxed) < 3;
            if go {
                *asked.lock().unwrap() = Instant::now();
            }
            go
        };
        let made = complete_mesh_with(mesh.view(), &options, &Monitor::new(&progress));
        assert_eq!(made, Err(Error::Cancelled));
        // Without optimisation, on a busy machine; the aim is 100 ms.
        assert!(asked.lock().unwrap().elapsed() < Duration::from_secs(2));
    }

    /// Eq. 3 depends on nothing but the surface, and scales with it.
    #[test]
    fn the_coherence_error_is_a_length() {
        let mesh = broken(Sample::Column, 80);
        let smooth = Options::default();
        let made = complete_mesh_with(mesh.view(), &smooth, &Monitor::silent()).unwrap();
        let (vertices, faces) = made.to_mesh_f32(&mesh.vertices, &mesh.faces);
        let known = mesh.vertices.len() as u32;
        let new = &faces[mesh.faces.len()..];
        let mut used: Vec<u32> = new.iter().flatten().copied().collect();
        used.sort_unstable();
        used.dedup();
        let rim: Vec<u32> = used.iter().copied().filter(|&v| v < known).collect();
        let number = |v: u32| used.binary_search(&v).unwrap() as u32;
        let positions: Vec<DVec3> =
            used.iter().map(|&v| DVec3::from(vertices[v as usize].map(f64::from))).collect();
        let patch = Patch::of_triangles(
            positions.clone(),
            vec![0.05; used.len()],
            rim.len(),
            new.iter().map(|t| t.map(number)).collect(),
        );
        let mut moved = positions.clone();
        for p in &mut moved[rim.len()..] {
            *p *= 1.02;
        }
        let all: [&[DVec3]; 3] = [&positions, &moved, &positions];
        let errors = |scale: f64| {
            let scaled =
                |list: &[DVec3]| -> Vec<DVec3> { list.iter().map(|p| *p * scale).collect() };
            let vertices: Vec<[f64; 3]> =
                mesh.vertices.iter().map(|p| p.map(|x| f64::from(x) * scale)).collect();
            let mut patch = patch.clone();
            patch.positions = scaled(&patch.positions);
            let initial = Initial { rim: rim.clone(), patch: &patch, taken: &[], share: None };
            let mesh = MeshView::new(&vertices[..], &mesh.faces[..]);
            let all = all.map(scaled);
            let all = [&all[0][..], &all[1][..], &all[2][..]];
            coherence_errors(mesh, &initial, &all, &Monitor::silent()).unwrap()
        };
        let (once, twice) = (errors(1.0), errors(2.0));
        assert!(once[0] > 0.0 && once[0] == once[2] && once[0] != once[1], "{once:?}");
        for (a, b) in once.iter().zip(&twice) {
            assert!((2.0 * a - b).abs() < 1e-6 * b, "{once:?} {twice:?}");
        }
    }
}

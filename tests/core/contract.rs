//! The contract on the procedural samples.

use crate::checker::{check, components, euler, extent, filled_rims};
use crate::meshes::{flat, sheet, within, Mesh};
use complete_mesh::sample::{break_mesh, Break, BreakOptions, Sample, SampleMesh};
use complete_mesh::{
    complete_mesh, complete_mesh_with, find_holes, Completion, Error, Fairing, Grouping, MeshView,
    Method, Monitor, Options, Selection, Sizing,
};
use glam::{DQuat, DVec3};
use std::collections::HashSet;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::Mutex;

fn double(mesh: &SampleMesh) -> Mesh {
    let vertices = mesh.vertices.iter().map(|p| p.map(f64::from)).collect();
    Mesh { vertices, faces: mesh.faces.clone() }
}

/// The coarsest mesh on which the breaks leave the loops they promise, and its remains.
fn broken(sample: Sample, kind: Break, seed: u64) -> (SampleMesh, SampleMesh) {
    let resolution = (10.0 * sample.longest_side() / sample.site().radius).ceil() as usize;
    let whole = sample.build(resolution).unwrap();
    let left = break_mesh(sample, &whole, &BreakOptions { kind, seed, size: 1.0 }).unwrap();
    (whole, left.mesh)
}

/// Fills all holes and checks everything.
fn fill_and_check(name: &str, mesh: MeshView<'_>, copy: &Mesh, options: &Options) -> Completion {
    let made = complete_mesh_with(mesh, options, &Monitor::silent())
        .unwrap_or_else(|e| panic!("{name}: {e}"));
    let list = find_holes(mesh, &options.grouping, &Monitor::silent()).unwrap();
    check(&copy.vertices, &copy.faces, &made, &filled_rims(&made, &list))
        .unwrap_or_else(|e| panic!("{name}: {e}"));
    made
}

fn same(a: &Completion, b: &Completion) -> bool {
    let bits = |c: &Completion| -> Vec<[u64; 3]> {
        c.vertices.iter().map(|p| p.map(f64::to_bits)).collect()
    };
    bits(a) == bits(b) && a.faces == b.faces && a.face_hole == b.face_hole
}

/// Fills a broken sample; says what is wrong with the result.
fn make_whole(sample: Sample, kind: Break, seed: u64) -> Result<(), String> {
    let (whole, left) = broken(sample, kind, seed);
    let copy = double(&left);
    let made = complete_mesh(&left.vertices[..], &left.faces[..], &Options::default())
        .map_err(|e| e.to_string())?;
    let list = find_holes(left.view(), &Grouping::Automatic, &Monitor::silent()).unwrap();
    let found = (list.loops.len(), list.holes.len());
    if found != kind.promised() {
        return Err(format!("(loops, holes) {found:?}"));
    }
    // f32 in, so what comes out must be f32, too, and the same bits in an f32 mesh.
    if !made.vertices.iter().flatten().all(|&x| f64::from(x as f32) == x) {
        return Err("a new vertex is no f32".into());
    }
    let (single, _) = made.to_mesh_f32(&left.vertices, &left.faces);
    assert_eq!(&single[..left.vertices.len()], &left.vertices[..]);
    let all = check(&copy.vertices, &copy.faces, &made, &filled_rims(&made, &list))?;
    let shape = (components(&all), euler(&all));
    let truth = (1, if sample == Sample::Torus { 0 } else { 2 });
    assert!(whole.faces.len() - left.faces.len() > 50, "nothing was broken off");
    if shape != truth {
        return Err(format!("(components, Euler) {shape:?}, not {truth:?}"));
    }
    Ok(())
}

#[test]
fn every_sample_and_break_is_made_whole() {
    let mut failures = Vec::new();
    for sample in Sample::ALL {
        for kind in Break::ALL {
            for seed in 0..2 {
                if let Err(e) = make_whole(sample, kind, seed) {
                    failures.push(format!("{} {} seed {seed}: {e}", sample.name(), kind.name()));
                }
            }
        }
    }
    assert!(failures.is_empty(), "\n{}", failures.join("\n"));
}

#[test]
fn every_fairing_keeps_the_contract_in_single_and_double() {
    for (sample, kind) in [
        (Sample::Leg, Break::Ring),
        (Sample::Column, Break::Ragged),
        (Sample::Torus, Break::Islands),
        (Sample::Relief, Break::Crack),
    ] {
        let (_, left) = broken(sample, kind, 1);
        let copy = double(&left);
        for fairing in Fairing::ALL {
            let name = format!("{} {} {}", sample.name(), kind.name(), fairing.name());
            let options = Options { method: Method::Smooth, fairing, ..Options::default() };
            // One that cannot be repaired is an error of its own, never a bad mesh.
            for mesh in [left.view(), copy.view()] {
                let may_fail = fairing != Fairing::Auto;
                match complete_mesh_with(mesh, &options, &Monitor::silent()) {
                    Err(Error::HoleFailed { .. }) if may_fail => {}
                    _ => {
                        let made = fill_and_check(&name, mesh, &copy, &options);
                        let used = made.holes[0].fairing;
                        assert!(used != Fairing::Auto, "{name}");
                        assert!(fairing == Fairing::Auto || used == fairing, "{name}");
                    }
                }
            }
        }
    }
}

#[test]
fn bytes_do_not_depend_on_threads_or_run() {
    // Five holes, so that the workers really share them.
    let (_, left) = broken(Sample::Column, Break::Several, 0);
    let run = |threads| {
        let options = Options { threads, ..Options::default() };
        complete_mesh(&left.vertices[..], &left.faces[..], &options).unwrap()
    };
    let first = run(1);
    assert_eq!(first.holes.len(), 5);
    for threads in [1, 2, 3, 0] {
        assert!(same(&first, &run(threads)), "{threads} threads");
    }
}

/// The papers' methods move every new vertex: the contract holds all the same, and the bits on any
/// number of threads.
#[test]
fn the_papers_methods_keep_the_contract_on_any_number_of_threads() {
    for (sample, kind, method) in [
        (Sample::Column, Break::Disc, Method::Harary),
        (Sample::Column, Break::Several, Method::Harary),
        (Sample::Vessel, Break::Disc, Method::Harary),
        (Sample::Column, Break::Several, Method::Fragment),
        (Sample::Vessel, Break::Disc, Method::Fragment),
        (Sample::Column, Break::Several, Method::Warp),
        (Sample::Vessel, Break::Disc, Method::Warp),
    ] {
        let (_, left) = broken(sample, kind, 0);
        let copy = double(&left);
        let run = |threads| {
            let options = Options { method, threads, ..Options::default() };
            fill_and_check(&format!("{sample:?} {kind:?}"), left.view(), &copy, &options)
        };
        let made = run(1);
        assert!(same(&made, &run(2)), "{sample:?} {kind:?}");
        assert!(made.holes.iter().any(|h| h.method == method), "{sample:?} {kind:?}");
        let smooth = Options { method: Method::Smooth, ..Options::default() };
        let smooth = complete_mesh(&left.vertices[..], &left.faces[..], &smooth);
        assert!(!same(&made, &smooth.unwrap()), "{sample:?} {kind:?}");
    }
}

#[test]
fn fill_moves_along_with_the_mesh() {
    let (scale, turn) = (3.7, DQuat::from_axis_angle(DVec3::new(1.0, 2.0, -0.5).normalize(), 1.1));
    let by = DVec3::new(10.0, -5.0, 2.0);
    for (sample, kind) in
        [(Sample::Leg, Break::Ring), (Sample::Column, Break::Ragged), (Sample::Vessel, Break::Disc)]
    {
        let name = format!("{} {}", sample.name(), kind.name());
        let mesh = double(&broken(sample, kind, 1).1);
        // A coherent fill moves along, too, but its search looks along the axes: see coherent.rs.
        let options = Options { method: Method::Smooth, ..Options::default() };
        let here = complete_mesh(&mesh.vertices[..], &mesh.faces[..], &options).unwrap();
        let there = mesh.moved(scale, turn, by);
        let there = complete_mesh(&there.vertices[..], &there.faces[..], &options).unwrap();
        let limit = 1e-6 * scale * extent(&mesh.vertices);
        assert_eq!(here.vertices.len(), there.vertices.len(), "{name}");
        for (p, q) in here.vertices.iter().zip(&there.vertices) {
            let p = turn * (scale * DVec3::from(*p)) + by;
            assert!(p.distance(DVec3::from(*q)) < limit, "{name}: {p} {q:?}");
        }
        // Four points on a circle, as regular meshes have them, may be joined either way.
        let turned = |f: &[u32; 3]| {
            let least = (0..3).min_by_key(|&k| f[k]).unwrap();
            [f[least], f[(least + 1) % 3], f[(least + 2) % 3]]
        };
        let faces: HashSet<[u32; 3]> = here.faces.iter().map(turned).collect();
        let others = there.faces.iter().filter(|f| !faces.contains(&turned(f))).count();
        assert!(others * 100 <= here.faces.len(), "{name}: {others} other triangles");
    }
}

#[test]
fn sizing_sets_the_density() {
    let (_, left) = broken(Sample::Sphere, Break::Disc, 0);
    let copy = double(&left);
    let fill = |sizing| {
        let options = Options { sizing, ..Options::default() };
        fill_and_check(&format!("{sizing:?}"), left.view(), &copy, &options)
    };
    let plain = fill(Sizing::Surroundings);
    let ratio = |made: &Completion| made.vertices.len() as f64 / plain.vertices.len() as f64;
    // Half the edge is a quarter of the face: four times the vertices, a little less as those
    // of the rim do not multiply.
    let half = ratio(&fill(Sizing::Scaled(0.5)));
    assert!((3.0..5.5).contains(&half), "{half}");
    let twice = ratio(&fill(Sizing::Scaled(2.0)));
    assert!((0.1..0.45).contains(&twice), "{twice}");
    assert!(fill(Sizing::None).vertices.is_empty());
    // The same length given in mesh units: the sphere's edges are all about as long.
    let list = find_holes(left.view(), &Grouping::Automatic, &Monitor::silent()).unwrap();
    let edge = list.holes[0].circumference / list.holes[0].edges as f64;
    let length = ratio(&fill(Sizing::EdgeLength(edge)));
    assert!((0.75..1.33).contains(&length), "{length}");
}

#[test]
fn no_sizing_adds_no_vertex() {
    // A pyramid without its floor: four rim edges, no diagonal of which is an edge already.
    let mesh = Mesh {
        vertices: vec![
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [1.0, 1.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.5, 0.5, 1.0],
        ],
        faces: vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]],
    };
    let options = Options { sizing: Sizing::None, ..Options::default() };
    let made = fill_and_check("pyramid", mesh.view(), &mesh, &options);
    assert_eq!((made.vertices.len(), made.faces.len()), (0, 2));
}

/// Found by fuzzing: masses and weights around a lone face without area are beyond all numbers, which was a
/// panic. What comes back is a fill or an error that names the hole.
#[test]
fn a_lone_face_without_area_is_no_panic() {
    let vertices = vec![[-39.0; 3], [-39.0; 3], [-1.0; 3]];
    let mesh = Mesh { vertices, faces: vec![[2, 0, 1]] };
    for fairing in Fairing::ALL {
        let options = Options { fairing, method: Method::Smooth, ..Options::default() };
        match complete_mesh(mesh.view().vertices, mesh.view().faces, &options) {
            Ok(made) => {
                let list =
                    find_holes(mesh.view(), &Grouping::Automatic, &Monitor::silent()).unwrap();
                check(&mesh.vertices, &mesh.faces, &made, &filled_rims(&made, &list)).unwrap();
            }
            Err(error) => assert!(matches!(error, Error::HoleFailed { hole: 0, .. }), "{error}"),
        }
    }
}

#[test]
fn cancel_at_every_step_and_progress_never_falls() {
    let mesh = sheet((12, 12), flat, |i, j| !within(i, j, 2, 4) && !within(i, j, 6, 9));
    let options = Options { selection: Selection::AllButLargest, ..Options::default() };
    for threads in [1, 2] {
        let options = Options { threads, ..options.clone() };
        let seen = Mutex::new(Vec::new());
        let note = |fraction: f64, _: &str| {
            seen.lock().unwrap().push(fraction);
            true
        };
        complete_mesh_with(mesh.view(), &options, &Monitor::new(&note)).unwrap();
        let seen = seen.into_inner().unwrap();
        assert!(seen.windows(2).all(|w| w[0] <= w[1]), "{seen:?}");
        assert!(seen.len() > 5 && seen.last() == Some(&1.0), "{seen:?}");
        for k in 0..seen.len() {
            let calls = AtomicUsize::new(0);
            let stop = |_: f64, _: &str| calls.fetch_add(1, Ordering::Relaxed) < k;
            let monitor = Monitor::new(&stop);
            let made = complete_mesh_with(mesh.view(), &options, &monitor);
            assert_eq!(made.err(), Some(Error::Cancelled), "at call {k}");
            // Not asked again once it has said stop.
            assert_eq!(calls.load(Ordering::Relaxed), k + 1);
        }
    }
}

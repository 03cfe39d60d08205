//! A part that is missing whole, taken from a twin: the truth is the twin.

use crate::checker::{check, filled_rims};
use crate::meshes::{broken_vessel, Mesh};
use crate::sources::moved;
use complete_mesh::matching::rigid::Rigid;
use complete_mesh::sample::{Break, Sample};
use complete_mesh::{
    complete_mesh, complete_mesh_with, find_holes, Completion, Error, Exemplar, Guidance, Initial,
    Method, Monitor, Options, Placement, Sources,
};
use glam::{DMat3, DVec3};
use std::sync::{Arc, Mutex};

/// The bent leg of the samples.
fn leg() -> Mesh {
    let leg = Sample::Leg.build(90).unwrap();
    Mesh { vertices: leg.vertices.iter().map(|p| p.map(f64::from)).collect(), faces: leg.faces }
}

/// What is left of a mesh where `keep` says so of the middles of faces.
fn left(whole: &Mesh, keep: impl Fn(DVec3) -> bool) -> Mesh {
    let middle = |f: &[u32; 3]| {
        f.iter().map(|&v| DVec3::from(whole.vertices[v as usize])).sum::<DVec3>() / 3.0
    };
    let mut faces: Vec<[u32; 3]> =
        whole.faces.iter().filter(|f| keep(middle(f))).copied().collect();
    // Faces that hang on with one edge, or with a corner alone, fall off.
    loop {
        let all: std::collections::HashSet<(u32, u32)> =
            faces.iter().flat_map(|f| [(f[0], f[1]), (f[1], f[2]), (f[2], f[0])]).collect();
        let before = faces.len();
        faces.retain(|f| {
            let edges = [(f[1], f[0]), (f[2], f[1]), (f[0], f[2])];
            edges.iter().filter(|e| all.contains(e)).count() > 1
        });
        if faces.len() == before {
            break;
        }
    }
    let mut number = vec![u32::MAX; whole.vertices.len()];
    let mut vertices = Vec::new();
    for v in faces.iter_mut().flatten() {
        let n = &mut number[*v as usize];
        if *n == u32::MAX {
            *n = vertices.len() as u32;
            vertices.push(whole.vertices[*v as usize]);
        }
        *v = *n;
    }
    Mesh { vertices, faces }
}

/// The way from a mesh that [`moved`] made back to where it was.
fn way_back(mirrored: bool) -> Rigid {
    let axes = Mesh {
        vertices: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        faces: vec![[1, 2, 3]],
    };
    let there = moved(&axes, mirrored).vertices;
    let to = DVec3::from(there[0]);
    let [x, y, z] = [1, 2, 3].map(|i| DVec3::from(there[i]) - to);
    Rigid { linear: DMat3::from_cols(x, y, z), translation: to }.inverse()
}

fn complete(mesh: &Mesh, options: &Options) -> Completion {
    let made = complete_mesh(&mesh.vertices[..], &mesh.faces[..], options).unwrap();
    let list = find_holes(mesh.view(), &options.grouping, &Monitor::silent()).unwrap();
    check(&mesh.vertices, &mesh.faces, &made, &filled_rims(&made, &list)).unwrap();
    made
}

/// How many of the vertices that are missing the fill has, but for so much; and of how many.
fn recovered(made: &Completion, broken: &Mesh, whole: &Mesh, by: f64) -> (usize, usize) {
    let kept: std::collections::HashSet<_> =
        broken.vertices.iter().map(|p| p.map(f64::to_bits)).collect();
    let lost = whole.vertices.iter().filter(|p| !kept.contains(&p.map(f64::to_bits)));
    let there = |p: &&[f64; 3]| {
        made.vertices.iter().any(|q| DVec3::from(*q).distance(DVec3::from(**p)) < by)
    };
    (lost.clone().filter(there).count(), lost.count())
}

fn taken(exemplar: Exemplar, guidance: Guidance) -> Options {
    let sources =
        Sources { exemplar: Some(Arc::new(exemplar)), exemplar_only: true, ..Sources::default() };
    Options { sources, guidance: Guidance { part: true, ..guidance }, ..Options::default() }
}

/// A leg that has lost its foot and half its shin: the twin's, mirrored or not, comes back vertex for vertex,
/// with its triangles; also where the placement is a little off and refined. A smooth fill only closes the
/// stump.
#[test]
fn a_missing_foot_comes_from_the_twin() {
    let whole = leg();
    let broken = left(&whole, |p| p.y < 1.6);
    let smooth = Options { method: Method::Smooth, ..Options::default() };
    let top = |made: &Completion| made.vertices.iter().fold(0.0, |y: f64, p| y.max(p[1]));
    assert!(top(&complete(&broken, &smooth)) < 2.0);
    for mirrored in [false, true] {
        let exact = way_back(mirrored);
        let turn = DMat3::from_axis_angle(DVec3::new(2.0, 1.0, 2.0) / 3.0, 0.02);
        let off = Rigid { linear: turn, translation: DVec3::new(0.01, -0.01, 0.01) };
        for (transform, refined) in [(exact, false), (off.after(&exact), true)] {
            let placement = Some(Placement { transform, refined });
            let guidance = Guidance { placement, ..Guidance::default() };
            let made = complete(&broken, &taken(moved(&whole, mirrored), guidance));
            let highest = whole.vertices.iter().fold(0.0, |y: f64, p| y.max(p[1]));
            assert!((top(&made) - highest).abs() < 1e-6);
            let hole = &made.holes[0];
            assert!(hole.method == Method::Coherent && hole.confidence > 0.99);
            assert_eq!(hole.sources[0].transform.is_mirrored(), mirrored);
            if !refined {
                let (found, lost) = recovered(&made, &broken, &whole, 1e-9);
                println!("{found} of {lost}");
                assert!(found * 100 > lost * 97 && lost > 500, "{found} of {lost}");
            }
            let first = broken.faces.len() as u32;
            assert!(made.origins.iter().all(|o| o.face >= first));
            for (p, origin) in made.vertices.iter().zip(&made.origins) {
                let face = whole.faces[(origin.face - first) as usize];
                let face = if mirrored { [face[0], face[2], face[1]] } else { face };
                let at: DVec3 = (0..3)
                    .map(|k| origin.barycentric[k] * DVec3::from(whole.vertices[face[k] as usize]))
                    .sum();
                assert!(at.distance(DVec3::from(*p)) < 0.3 * whole.mean_edge());
            }
        }
    }
}

/// A bent band whose two ends are one hole: the piece between them has two borders.
#[test]
fn a_missing_band_comes_from_the_twin() {
    let whole = leg();
    let broken = left(&whole, |p| !(0.9..1.7).contains(&p.y));
    let placement = Some(Placement { transform: way_back(false), refined: false });
    let guidance = Guidance { placement, ..Guidance::default() };
    let made = complete(&broken, &taken(moved(&whole, false), guidance));
    let (found, lost) = recovered(&made, &broken, &whole, 1e-9);
    println!("{found} of {lost}");
    assert!(made.holes.len() == 1 && found * 100 > lost * 95, "{found} of {lost}");
}

/// Without a placement the twin is searched for by what is around the hole.
#[test]
fn the_twin_is_found() {
    let (broken, whole) = broken_vessel(Break::Disc);
    let made = complete(&broken, &taken(moved(&whole, false), Guidance::default()));
    let (found, lost) = recovered(&made, &broken, &whole, 1e-3);
    println!("{found} of {lost}");
    assert!(found * 100 > lost * 80, "{found} of {lost}");
}

/// Place after place is tried: each tells how far it is, and can be stopped.
#[test]
fn trying_places_reports_and_can_be_stopped() {
    let (broken, whole) = broken_vessel(Break::Disc);
    // More than there are: all places are tried.
    let guidance = Guidance { candidate: 1000, ..Guidance::default() };
    let options = taken(moved(&whole, false), guidance);
    let run = |until: f64| {
        let seen = Mutex::new(Vec::new());
        let report = |fraction: f64, _: &str| {
            seen.lock().unwrap().push(fraction);
            fraction < until
        };
        let made = complete_mesh_with(broken.view(), &options, &Monitor::new(&report));
        (made.unwrap_err(), seen.into_inner().unwrap())
    };
    let (error, mut seen) = run(2.0);
    assert!(error.to_string().contains("places have a part"), "{error}");
    assert!(seen.is_sorted());
    // The search ends at 0.7 of what filling takes.
    seen.retain(|&x| x > 0.7);
    seen.dedup();
    println!("{} steps", seen.len());
    assert!(seen.len() > 20 && *seen.last().unwrap() > 0.9, "{seen:?}");
    for until in [0.75, 0.85, 0.95] {
        let (error, seen) = run(until);
        assert_eq!(error, Error::Cancelled);
        assert_eq!(seen.iter().filter(|&&x| x >= until).count(), 1, "nothing after the stop");
    }
}

/// What cannot be is said.
#[test]
fn parts_that_are_not_there_are_named() {
    let whole = leg();
    let broken = left(&whole, |p| p.y < 1.6);
    let refused = |options: &Options| {
        complete_mesh(&broken.vertices[..], &broken.faces[..], options).unwrap_err().to_string()
    };
    // The twin is broken at the same place: nothing of it lies beyond the rim.
    let place = |transform| Guidance {
        placement: Some(Placement { transform, refined: false }),
        ..Guidance::default()
    };
    let said = refused(&taken(moved(&broken, false), place(way_back(false))));
    assert!(said.contains("hole 0") && said.contains("nothing of the source"), "{said}");
    let part = Guidance { part: true, ..Guidance::default() };
    for method in [Method::Smooth, Method::Harary, Method::Fragment, Method::Warp] {
        let said = refused(&Options { method, guidance: part.clone(), ..Options::default() });
        assert!(said.contains("part") && said.contains(method.name()), "{said}");
    }
    let initial = Some(Arc::new(Initial::default()));
    let both = Options { initial, guidance: part, ..Options::default() };
    assert!(refused(&both).contains("part"));
}

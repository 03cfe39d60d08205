//! Initial completions from outside, and how little a coherent fill depends on them.

use crate::checker::complete_checked;
use crate::meshes::{broken_vessel, Mesh};
use complete_mesh::intersect::Bvh;
use complete_mesh::sample::Break;
use complete_mesh::{
    complete_mesh, Completion, Error, Fairing, HoleStatus, Initial, Method, Options,
};
use glam::DVec3;
use std::sync::Arc;

fn broken(kind: Break) -> Mesh {
    broken_vessel(kind).0
}

fn initial(made: &Completion) -> Initial {
    Initial { vertices: made.vertices.clone(), faces: made.faces.clone() }
}

fn smooth(fairing: Fairing) -> Options {
    Options { method: Method::Smooth, fairing, ..Options::default() }
}

fn from(initial: Initial, method: Method) -> Options {
    Options { method, initial: Some(Arc::new(initial)), ..Options::default() }
}

/// Root mean square distance of one fill's vertices from another fill, in mean edges of the latter.
fn apart(mesh: &Mesh, a: &Completion, b: &Completion) -> f64 {
    let all = mesh.vertices.iter().chain(&b.vertices);
    let corners: Vec<DVec3> = all.map(|&p| DVec3::from(p)).collect();
    let tree = Bvh::new(&corners, &b.faces);
    let length = |f: &[u32; 3]| corners[f[0] as usize].distance(corners[f[1] as usize]);
    let edge = b.faces.iter().map(length).sum::<f64>() / b.faces.len() as f64;
    let off = |p: &[f64; 3]| tree.closest_point(DVec3::from(*p), f64::INFINITY).unwrap().distance;
    let square: f64 = a.vertices.iter().map(|p| off(p).powi(2)).sum();
    (square / a.vertices.len() as f64).sqrt() / edge
}

/// Of every kind of hole the smooth completion, given back as an initial one, is the smooth result.
#[test]
fn what_is_given_comes_back() {
    for kind in [Break::Ragged, Break::Islands, Break::Several] {
        let mesh = broken(kind);
        let made = complete_checked(&mesh, &smooth(Fairing::Auto));
        let again = complete_checked(&mesh, &from(initial(&made), Method::Smooth));
        let sorted = |c: &Completion| {
            let mut bits: Vec<[u64; 3]> = c.vertices.iter().map(|p| p.map(f64::to_bits)).collect();
            bits.sort_unstable();
            (bits, c.faces.len())
        };
        assert!(sorted(&made) == sorted(&again), "{kind:?}");
    }
}

/// The paper's claim (Sec. 3): different and noisy initial completions give nearly the same fill.
#[test]
fn the_initial_completion_hardly_matters() {
    let mesh = broken(Break::Disc);
    let usual = complete_checked(&mesh, &Options::default());
    assert_eq!(usual.holes[0].method, Method::Coherent);
    let plain = complete_checked(&mesh, &smooth(Fairing::Auto));
    let relief = apart(&mesh, &plain, &usual);
    let edge = mesh.mean_edge();
    let noisy = |share: f64| {
        let mut made = initial(&plain);
        let mut state = 1u64;
        let mut random = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 33) as f64 / f64::from(1u32 << 31) - 0.5
        };
        let moved =
            |p: &[f64; 3], random: &mut dyn FnMut() -> f64| p.map(|x| x + share * edge * random());
        made.vertices = made.vertices.iter().map(|p| moved(p, &mut random)).collect();
        made
    };
    let membrane = initial(&complete_checked(&mesh, &smooth(Fairing::C0)));
    let curved = initial(&complete_checked(&mesh, &smooth(Fairing::C2)));
    for (name, start) in [
        ("membrane", membrane),
        ("curved", curved),
        ("noise", noisy(0.2)),
        ("much noise", noisy(0.5)),
    ] {
        let made = complete_checked(&mesh, &from(start, Method::Coherent));
        let off = apart(&mesh, &made, &usual);
        println!("{name}: {off:.3} edges of {relief:.3}");
        assert_eq!(made.holes[0].method, Method::Coherent, "{name}");
        assert!(off < 0.25 * relief, "{name}: {off} of {relief}");
    }
}

/// What does not fill the hole is refused with the reason.
#[test]
fn what_fills_nothing_is_refused() {
    let mesh = broken(Break::Disc);
    let made = complete_checked(&mesh, &smooth(Fairing::Auto));
    let refused = |start: Initial, words: &str| {
        let options = from(start, Method::Smooth);
        match complete_mesh(&mesh.vertices[..], &mesh.faces[..], &options) {
            Err(Error::HoleFailed { hole: 0, reason }) => {
                assert!(reason.contains(words), "{words}: {reason}")
            }
            other => panic!("{words}: {:?}", other.map(|c| c.vertices.len())),
        }
        let skipped = complete_checked(&mesh, &Options { skip_unsafe: true, ..options });
        assert!(
            matches!(skipped.holes[0].status, HoleStatus::Failed(_)) && skipped.faces.is_empty()
        );
    };
    refused(Initial::default(), "does not reach all of its rim");
    let mut turned = initial(&made);
    turned.faces.iter_mut().for_each(|f| f.swap(0, 1));
    refused(turned, "faces the other way");
    let mut torn = initial(&made);
    let first_new = mesh.vertices.len() as u32;
    let inner = torn.faces.iter().position(|f| f.iter().all(|&v| v >= first_new)).unwrap();
    torn.faces.remove(inner);
    refused(torn, "a hole of its own");
    let mut twice = initial(&made);
    twice.faces.push(twice.faces[0]);
    refused(twice, "not manifold");

    for (start, words) in [
        (Initial { vertices: vec![[0.0, f64::NAN, 0.0]], faces: vec![] }, "vertex 0"),
        (Initial { vertices: vec![], faces: vec![[0, 1, u32::MAX]] }, "face 0"),
    ] {
        let options = from(start, Method::Coherent);
        match complete_mesh(&mesh.vertices[..], &mesh.faces[..], &options) {
            Err(Error::InvalidOption { name: "initial", reason }) => {
                assert!(reason.contains(words), "{reason}")
            }
            other => panic!("{words}: {:?}", other.map(|c| c.vertices.len())),
        }
    }
}

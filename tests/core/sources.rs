//! What may be copied from: part of the mesh, another mesh, nothing mirrored.

use crate::checker::complete_checked;
use crate::meshes::{broken_vessel, off, Mesh};
use complete_mesh::result::NONE;
use complete_mesh::sample::{Break, Sample};
use complete_mesh::{
    complete_mesh, Completer, Completion, Error, Exemplar, Grouping, Method, Monitor, Options,
    Sources,
};
use glam::{DMat3, DVec3};
use std::sync::Arc;

fn vessel() -> (Mesh, Mesh) {
    broken_vessel(Break::Disc)
}

fn fill(mesh: &Mesh, sources: Sources) -> Completion {
    complete_checked(mesh, &Options { sources, ..Options::default() })
}

pub(crate) fn moved(mesh: &Mesh, mirrored: bool) -> Exemplar {
    let turn = DMat3::from_axis_angle(DVec3::new(0.2, 0.9, -0.5).normalize(), 2.1);
    let flip = DMat3::from_diagonal(DVec3::new(if mirrored { -1.0 } else { 1.0 }, 1.0, 1.0));
    let to = DVec3::new(3.0, -7.0, 0.5);
    let place = |p: &[f64; 3]| (turn * flip * DVec3::from(*p) + to).to_array();
    let face = |f: &[u32; 3]| if mirrored { [f[0], f[2], f[1]] } else { *f };
    Exemplar {
        vertices: mesh.vertices.iter().map(place).collect(),
        faces: mesh.faces.iter().map(face).collect(),
        ..Exemplar::default()
    }
}

/// An intact twin, turned and moved, or mirrored: the fill is the twin's piece to a small part of an
/// edge, and says so.
#[test]
fn the_twin_gives_back_what_is_missing() {
    let (broken, whole) = vessel();
    for mirrored in [false, true] {
        let exemplar = Some(Arc::new(moved(&whole, mirrored)));
        let made = fill(&broken, Sources { exemplar, exemplar_only: true, ..Sources::default() });
        let off = off(&made, &whole);
        println!("mirrored {mirrored}: {off:.4} edges");
        assert!(off < 0.02, "{off}");
        let (first, count) = (broken.faces.len() as u32, whole.faces.len() as u32);
        assert!(made.origins.iter().all(|o| (first..first + count).contains(&o.face)));
        let best = &made.holes[0].sources[0];
        assert!(made.holes[0].confidence > 0.95);
        // The vessel may be as symmetric as its mirror image.
        assert!(best.transform.is_mirrored() == mirrored || best.error < 1e-3);
    }
}

/// A missing band bends all around the object, and no window sees it whole: a twin that has all of it in one place
/// gives it back, whether its triangles are the same (then nearly exactly) or others; a smooth fill is far off.
#[test]
fn a_twin_gives_back_a_missing_band() {
    let (broken, whole) = broken_vessel(Break::Ring);
    let other = Sample::Vessel.build(130).unwrap();
    let vertices = other.vertices.iter().map(|p| p.map(f64::from)).collect();
    let other = Mesh { vertices, faces: other.faces };
    let by = |twin: &Mesh, method| {
        let exemplar = Some(Arc::new(moved(twin, false)));
        let sources = Sources { exemplar, exemplar_only: true, ..Sources::default() };
        let made = complete_checked(&broken, &Options { sources, method, ..Options::default() });
        assert!(made.holes[0].sources.len() < 2, "one place, said once");
        (off(&made, &whole), made.holes[0].confidence)
    };
    let (smooth, _) = by(&whole, Method::Smooth);
    let (same, sure) = by(&whole, Method::Coherent);
    let (another, _) = by(&other, Method::Coherent);
    println!("smooth {smooth:.3}, the same {same:.4}, other triangles {another:.3} edges");
    assert!(same < 0.05 && sure > 0.95, "{same} {sure}");
    assert!(another < 0.5 * smooth && smooth > 1.0, "{another} of {smooth}");
}

/// Nothing comes from faces that may not be copied from, and nothing is mirrored that must not be.
#[test]
fn only_what_may_be_copied_from_is() {
    let (broken, _) = vessel();
    let middle = |f: &[u32; 3]| f.iter().map(|&v| broken.vertices[v as usize][0]).sum::<f64>();
    let mut middles: Vec<f64> = broken.faces.iter().map(middle).collect();
    let all: Vec<f64> = middles.clone();
    middles.sort_by(f64::total_cmp);
    let half = middles[middles.len() / 2];
    let mut seen = 0;
    for side in [false, true] {
        let may: Arc<[bool]> = all.iter().map(|&x| (x < half) == side).collect();
        let made = fill(&broken, Sources { faces: Some(may.clone()), ..Sources::default() });
        let used = || made.origins.iter().filter(|o| o.source != NONE);
        seen += used().count();
        assert!(used().all(|o| may[o.face as usize]));
    }
    assert!(seen > 0, "both sides were left out");
    let made = fill(&broken, Sources { unmirrored: true, ..Sources::default() });
    assert!(!made.holes[0].sources.is_empty());
    assert!(made.holes[0].sources.iter().all(|s| !s.transform.is_mirrored()));
}

/// A wrong exemplar is not forced upon the hole.
#[test]
fn a_wrong_exemplar_gets_a_low_confidence() {
    let (broken, whole) = vessel();
    let ball = Sample::Sphere.build(60).unwrap();
    let exemplar = Exemplar {
        vertices: ball.vertices.iter().map(|p| p.map(f64::from)).collect(),
        faces: ball.faces,
        ..Exemplar::default()
    };
    let sources = |exemplar| Sources {
        exemplar: Some(Arc::new(exemplar)),
        exemplar_only: true,
        ..Sources::default()
    };
    let wrong = fill(&broken, sources(exemplar)).holes[0].confidence;
    let right = fill(&broken, sources(moved(&whole, false))).holes[0].confidence;
    println!("wrong {wrong:.2}, right {right:.2}");
    assert!(wrong < 0.7 && wrong < right - 0.2);
}

/// A completer answers to new sources, and to the old ones again, as a new completer would.
#[test]
fn a_completer_follows_its_options() {
    let (broken, whole) = vessel();
    let monitor = Monitor::silent();
    let completer = Completer::new(broken.view(), &Grouping::Automatic, &monitor).unwrap();
    let twin = Sources { exemplar: Some(Arc::new(moved(&whole, false))), ..Sources::default() };
    for sources in [Sources::default(), twin, Sources::default()] {
        let options = Options { sources: sources.clone(), ..Options::default() };
        let kept = completer.complete(&options, &monitor).unwrap();
        assert_eq!(kept.vertices, fill(&broken, sources).vertices);
    }
}

#[test]
fn bad_sources_are_named() {
    let (broken, whole) = vessel();
    let refused = |sources: Sources, method: Method, words: &str| {
        let options = Options { sources, method, ..Options::default() };
        match complete_mesh(&broken.vertices[..], &broken.faces[..], &options) {
            Err(Error::InvalidOption { name: "sources", reason }) => {
                assert!(reason.contains(words), "{reason}")
            }
            other => panic!("{words}: {other:?}"),
        }
    };
    let coherent = Method::Coherent;
    let faces = |list: Vec<bool>| Sources { faces: Some(list.into()), ..Sources::default() };
    refused(faces(vec![true; 3]), coherent, "3 entries");
    refused(faces(vec![false; broken.faces.len()]), coherent, "no face may");
    refused(Sources { exemplar_only: true, ..Sources::default() }, coherent, "there is none");
    let with = |exemplar| Sources { exemplar: Some(Arc::new(exemplar)), ..Sources::default() };
    refused(with(Exemplar::default()), coherent, "no faces");
    let mut bad = moved(&whole, false);
    bad.faces[5][1] = u32::MAX;
    refused(with(bad), coherent, "face 5");
    let mut bad = moved(&whole, false);
    bad.vertices[7][1] = f64::NAN;
    refused(with(bad), coherent, "vertex 7");
    refused(with(moved(&whole, false)), Method::Harary, "harary");
    refused(with(moved(&whole, false)), Method::Fragment, "fragment");
}

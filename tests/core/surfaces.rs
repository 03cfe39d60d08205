//! Holes in surfaces that a formula knows.

use crate::checker::{check, filled_rims};
use crate::meshes::{sheet, tube, within, Mesh};
use complete_mesh::sample::{break_mesh, Break, BreakOptions, Sample};
use complete_mesh::{
    complete_mesh, find_holes, Completion, Fairing, Grouping, HoleKind, Method, Monitor, Options,
    Selection, Sizing,
};
use glam::{DQuat, DVec3};

fn fill(mesh: &Mesh, options: &Options) -> Completion {
    let made = complete_mesh(&mesh.vertices[..], &mesh.faces[..], options).unwrap();
    let list = find_holes(mesh.view(), &options.grouping, &Monitor::silent()).unwrap();
    check(&mesh.vertices, &mesh.faces, &made, &filled_rims(&made, &list)).unwrap();
    made
}

fn with(fairing: Fairing, selection: Selection) -> Options {
    Options { method: Method::Smooth, fairing, selection, ..Options::default() }
}

/// Greatest value of `f` over the new vertices, of which there must be some.
fn worst(made: &Completion, f: impl Fn(DVec3) -> f64) -> f64 {
    assert!(!made.vertices.is_empty());
    made.vertices.iter().map(|p| f(DVec3::from(*p)).abs()).fold(0.0, f64::max)
}

#[test]
fn a_plane_is_filled_in_the_plane() {
    // Uneven in the plane, tilted, and a hole with corners that point inward.
    let uneven = |x: f64, y: f64| [x + 0.2 * (1.7 * y).sin(), y + 0.2 * (2.3 * x).cos(), 0.0];
    let hole = |i: usize, j: usize| within(i, j, 6, 14) && !(i < 9 && j < 9);
    let turn = DQuat::from_euler(glam::EulerRot::XYZ, 0.4, -0.7, 1.3);
    let mesh = sheet((20, 20), uneven, |i, j| !hole(i, j)).moved(1.0, turn, DVec3::splat(3.0));
    let normal = turn * DVec3::Z;
    for fairing in [Fairing::C0, Fairing::C1, Fairing::C2, Fairing::Auto] {
        let made = fill(&mesh, &with(fairing, Selection::AllButLargest));
        let off = worst(&made, |p| normal.dot(p - DVec3::splat(3.0)));
        // 1e-9 of the hole's diameter, which is about 11.
        assert!(off < 1e-8, "{}: {off}", fairing.name());
    }
}

#[test]
fn a_sphere_is_continued() {
    let whole = Sample::Sphere.build(80).unwrap();
    let options = BreakOptions { kind: Break::Disc, seed: 0, size: 1.0 };
    let left = break_mesh(Sample::Sphere, &whole, &options).unwrap().mesh;
    let off = |fairing| {
        let options = with(fairing, Selection::All);
        let made = complete_mesh(&left.vertices[..], &left.faces[..], &options).unwrap();
        worst(&made, |p| p.length() - 1.0)
    };
    let (auto, membrane) = (off(Fairing::Auto), off(Fairing::C0));
    assert!(auto < 0.01 && auto < 0.2 * membrane, "auto {auto}, membrane {membrane}");
}

#[test]
fn a_cylinder_is_continued() {
    // A window of about 60° in a tube of radius 1.
    let mesh = tube(
        48,
        40,
        |r, a| [a.cos(), a.sin(), 0.13 * r as f64],
        |r, i| !((16..24).contains(&r) && i < 8),
    );
    let list = find_holes(mesh.view(), &Grouping::Automatic, &Monitor::silent()).unwrap();
    let window = list.holes.iter().find(|h| h.edges == 32).unwrap().id;
    let off = |fairing| {
        let made = fill(&mesh, &with(fairing, Selection::Ids(vec![window])));
        worst(&made, |p| p.truncate().length() - 1.0)
    };
    let (auto, membrane) = (off(Fairing::Auto), off(Fairing::C0));
    assert!(auto < 0.02 && auto < 0.4 * membrane, "auto {auto}, membrane {membrane}");
}

/// With more than 300 corners not all chords are tried: among those of one's own rim there is none across
/// the band, and both rims were closed with lids.
#[test]
fn a_missing_band_between_long_rims_is_no_lids() {
    let n = 200;
    let edge = std::f64::consts::TAU / n as f64;
    let place = |r: usize, a: f64| [a.cos(), a.sin(), edge * r as f64];
    let mesh = tube(n, 60, place, |r, _| !(14..46).contains(&r));
    let list = find_holes(mesh.view(), &Grouping::Automatic, &Monitor::silent()).unwrap();
    let band = list.holes.iter().find(|h| h.kind == HoleKind::Ring).unwrap();
    assert_eq!(band.edges, 2 * n);
    let made = fill(&mesh, &with(Fairing::Auto, Selection::Ids(vec![band.id])));
    // Of the band's width, which is one radius: lids are one radius off.
    let off = worst(&made, |p| p.truncate().length() - 1.0);
    assert!(off < 0.05, "{off}");
}

#[test]
fn a_rim_of_ten_thousand_edges() {
    let n = 10_000;
    let ring = |wave: f64| {
        tube(
            n,
            2,
            move |r, a| {
                let radius = 1.0 + 6e-4 * (2 - r) as f64;
                [radius * a.cos(), radius * a.sin(), wave * (9.0 * a).sin()]
            },
            |_, _| true,
        )
    };
    for (wave, sizing) in [(0.0, Sizing::None), (0.05, Sizing::Scaled(20.0))] {
        let mesh = ring(wave);
        let options = Options {
            sizing,
            grouping: Grouping::Separate,
            selection: Selection::AllButLargest,
            ..Options::default()
        };
        let made = fill(&mesh, &options);
        let flat = sizing == Sizing::None;
        // A polygon without inner vertices has n - 2 triangles.
        assert!(made.faces.len() == n - 2 || (!flat && made.faces.len() > n - 2));
        assert!(made.vertices.is_empty() == flat);
    }
}

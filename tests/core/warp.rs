//! The warped patch (Park, Guo, Shin, Qin 2006) against surfaces and colours whose truth is known.

use crate::appearance::{off as colours_off, painted};
use crate::checker::complete_checked;
use crate::fragment::{broken_relief, options, rms};
use crate::meshes::{sheet, Mesh};
use crate::sources::moved;
use complete_mesh::io::{Document, Extras, Format};
use complete_mesh::{
    Appearance, Completer, Completion, Error, Grouping, Guidance, Method, Monitor, Options,
    Placement, Selection, Sources,
};
use glam::{DVec2, DVec3};
use std::f64::consts::TAU;
use std::sync::Arc;

/// What repeats itself is found and lies where its source says.
#[test]
fn a_periodic_relief_is_recovered() {
    let mesh = broken_relief();
    let [smooth, warped] =
        [Method::Smooth, Method::Warp].map(|m| complete_checked(&mesh, &options(m)));
    let [bare, own] = [&smooth, &warped].map(rms);
    println!("smooth {bare:.1e}, warped {own:.1e}");
    assert!(own < 0.1 * bare, "{own} {bare}");
    let hole = warped.holes.iter().find(|h| h.method == Method::Warp).unwrap();
    assert!(hole.confidence > 0.9 && hole.sources.len() == 1, "{}", hole.summary());
    for (p, origin) in warped.vertices.iter().zip(&warped.origins) {
        let face = mesh.faces[origin.face as usize].map(|v| DVec3::from(mesh.vertices[v as usize]));
        let there: DVec3 = (0..3).map(|k| origin.barycentric[k] * face[k]).sum();
        let apart = hole.sources[0].transform.point(there).distance(DVec3::from(*p));
        assert!(apart < 0.3 * bare, "{apart} {bare}");
    }
}

/// Another piece of the relief, turned, or mirrored, as exemplar: the fill comes from it alone.
#[test]
fn an_exemplar_gives_back_what_is_missing() {
    let broken = broken_relief();
    let bare = rms(&complete_checked(&broken, &options(Method::Smooth)));
    for mirrored in [false, true] {
        let exemplar = Some(Arc::new(moved(&broken, mirrored)));
        let sources = Sources { exemplar, exemplar_only: true, ..Sources::default() };
        let made = complete_checked(&broken, &Options { sources, ..options(Method::Warp) });
        let own = rms(&made);
        println!("mirrored {mirrored}: {own:.1e}, smooth {bare:.1e}");
        assert!(own < 0.1 * bare, "{own} {bare}");
        let (first, count) = (broken.faces.len() as u32, broken.faces.len() as u32);
        assert!(made.origins.iter().all(|o| (first..first + count).contains(&o.face)));
        let hole = made.holes.iter().find(|h| h.method == Method::Warp).unwrap();
        assert!(hole.confidence > 0.9, "{}", hole.summary());
    }
}

/// A candidate is what it alone makes, and the best of them what comes out without a choice; its transform
/// given by hand makes it again.
#[test]
fn candidates_and_placements_are_heeded() {
    let mesh = broken_relief();
    let with = |guidance| Options { guidance, ..options(Method::Warp) };
    let completer = Completer::new(mesh.view(), &Grouping::Automatic, &Monitor::silent()).unwrap();
    let all = completer.candidates(3, &options(Method::Warp), &Monitor::silent()).unwrap();
    let plain = complete_checked(&mesh, &options(Method::Warp));
    assert!(
        all.len() > 1 && all[0].vertices == plain.vertices && all[1].vertices != plain.vertices
    );
    let hole = all[1].holes.iter().find(|h| h.method == Method::Warp).unwrap();
    let transform = hole.sources[0].transform;
    let placement = Some(Placement { transform, refined: false });
    let placed = complete_checked(&mesh, &with(Guidance { placement, ..Guidance::default() }));
    assert_eq!(placed.vertices, all[1].vertices);
    let scales = with(Guidance { scales: Some([0.5, 2.0]), ..Guidance::default() });
    let refused = complete_mesh::complete_mesh(&mesh.vertices[..], &mesh.faces[..], &scales);
    assert!(matches!(refused, Err(Error::InvalidOption { name: "scales", .. })));
}

/// Middle of the hole of [`wall`], its radius, and that of the disc that has its colours.
const MIDDLE: DVec2 = DVec2::new(-1.9, 0.0);
const RADIUS: f64 = 0.25;
const SAME: f64 = 0.45;

fn relief(p: DVec2) -> f64 {
    match p.x < 1.0 {
        true => {
            0.025 * (TAU * p.x / 0.3).sin() * (TAU * p.y / 0.375).cos()
                + 0.015 * (TAU * (p.x + p.y) / 0.6).sin()
        }
        false => 0.0,
    }
}

fn pattern(p: DVec3) -> Vec<f64> {
    let v = (11.0 * p.x).sin() * (9.0 * p.y).sin();
    vec![0.5 + 0.4 * v, 0.5 - 0.2 * v, 0.3]
}

/// The wall's colours: the pattern around the hole and on the flat part, others wherever the relief is.
fn paint(p: DVec3) -> Vec<f64> {
    match p.x > 1.0 || p.truncate().distance(MIDDLE) < SAME {
        true => pattern(p),
        false => {
            let v = (17.0 * (p.x + 0.3 * p.y)).sin();
            vec![0.5 + 0.4 * v, 0.5 - 0.2 * v, 0.3]
        }
    }
}

/// A wall with a relief on the left and none on the right, and a hole in the relief.
fn wall() -> Mesh {
    let step = 0.03;
    let at = |x: f64, y: f64| DVec2::new(step * x - 2.7, step * y - 1.2);
    let place = |x: f64, y: f64| {
        let p = at(x, y);
        [p.x, p.y, relief(p)]
    };
    let kept = |i: usize, j: usize| at(i as f64 + 0.5, j as f64 + 0.5).distance(MIDDLE) > RADIUS;
    sheet((180, 80), place, kept)
}

/// How far the colours of a file with that fill are off those that the library completes.
fn file_off(mesh: &Mesh, values: &Appearance, made: &Completion, wanted: &[f64]) -> f64 {
    let (vertices, faces) = (mesh.vertices.len(), mesh.faces.len());
    let mut text = format!("ply\nformat ascii 1.0\nelement vertex {vertices}\n");
    for name in ["x", "y", "z", "red", "green", "blue"] {
        text += &format!("property double {name}\n");
    }
    text += &format!("element face {faces}\nproperty list uchar int vertex_indices\nend_header\n");
    for (p, row) in mesh.vertices.iter().zip(values.values.chunks_exact(3)) {
        let [x, y, z] = p;
        text += &format!("{x} {y} {z} {} {} {}\n", row[0], row[1], row[2]);
    }
    mesh.faces.iter().for_each(|f| text += &format!("3 {} {} {}\n", f[0], f[1], f[2]));
    let mut document = Document::parse(text.into_bytes(), Format::Ply).unwrap();
    document.append(made, &Extras::default()).unwrap();
    let written = String::from_utf8(document.to_bytes()).unwrap();
    let header = written.lines().position(|l| l == "end_header").unwrap() + 1;
    let rows = written.lines().skip(header + vertices).take(made.vertices.len());
    let found = rows.flat_map(|row| row.split(' ').skip(3).map(|x| x.parse::<f64>().unwrap()));
    found.zip(wanted).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max)
}

/// The relief is found on the left, its colours on the right, by both methods that copy places whole; and not
/// where that is forbidden.
#[test]
fn shape_and_colours_come_from_different_places() {
    let mesh = wall();
    let values = painted(&mesh, &paint, 3);
    let middle = |f: &[u32; 3]| f.iter().map(|&v| mesh.vertices[v as usize][0]).sum::<f64>() / 3.0;
    let all: Vec<f64> = mesh.faces.iter().map(middle).collect();
    let fill = |method, sources, appearance| {
        let selection = Selection::NearPoint([MIDDLE.x, RADIUS, 0.0]);
        let options = Options { method, selection, sources, appearance, ..Options::default() };
        complete_checked(&mesh, &options)
    };
    let smooth = fill(Method::Smooth, Sources::default(), None);
    let complete = |made: &_| values.complete((&mesh.faces[..]).into(), None, made);
    let inside = |made: &Completion| {
        let square = |p: &[f64; 3]| (p[2] - relief(DVec2::new(p[0], p[1]))).powi(2);
        let sum: f64 = made.vertices.iter().map(square).sum();
        (sum / made.vertices.len() as f64).sqrt()
    };
    let bare = (inside(&smooth), colours_off(&smooth, &complete(&smooth), &pattern).0);
    for method in [Method::Coherent, Method::Warp] {
        let made = fill(method, Sources::default(), Some(Arc::new(values.clone())));
        let own = (inside(&made), colours_off(&made, &complete(&made), &pattern).0);
        println!("{}: {own:?}, smooth {bare:?}", method.name());
        assert!(own.0 < 0.2 * bare.0 && own.1 < 0.2 * bare.1);
        assert!(file_off(&mesh, &values, &made, &complete(&made)) < 1e-6);
        let side = |face: u32| all[face as usize] > 1.0;
        assert!(made.origins.iter().all(|o| !side(o.face)));
        let there = made.colour_origins.iter().filter(|o| side(o.face)).count();
        assert!(there * 10 > 9 * made.vertices.len(), "{there} of {}", made.vertices.len());
        let source = made.holes.iter().flat_map(|h| &h.sources).last().unwrap();
        assert!(source.coloured == there && source.vertices == 0);
        // Not from the right if that is forbidden: then the rim's colours are all there is.
        let faces: Arc<[bool]> = all.iter().map(|&x| x < 0.97).collect();
        let sources = Sources { faces: Some(faces), ..Sources::default() };
        let made = fill(method, sources, Some(Arc::new(values.clone())));
        assert!(made.origins.iter().chain(&made.colour_origins).all(|o| !side(o.face)));
        assert!(colours_off(&made, &complete(&made), &pattern).0 > 0.5 * bare.1);
    }
}

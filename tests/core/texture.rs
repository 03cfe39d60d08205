//! An OBJ fill goes on with the texture and the material of the place that it was copied from.

use crate::appearance::{fill_inner, lathe, painted, pattern};
use crate::meshes::Mesh;
use complete_mesh::io::{Document, Extras, Format};
use complete_mesh::{Completion, Origin};
use std::fmt::Write;

/// Where the wall's second chart begins, and how far off its texture coordinates are.
const SEAM: f64 = 0.0;
const JUMP: f64 = 10.0;

fn middle(mesh: &Mesh, face: usize) -> f64 {
    mesh.faces[face].iter().map(|&v| mesh.vertices[v as usize][0]).sum::<f64>() / 3.0
}

/// Texture coordinates of a place on the wall, in one of its charts.
fn uv(p: [f64; 3], second: bool) -> [f64; 2] {
    let jump = if second { JUMP } else { 0.0 };
    [0.1 * p[0] + 0.02 * p[1] + jump, 0.1 * p[1] + 0.5]
}

/// The wall in two charts and two materials, parted along x = 0.
fn write_wall(mesh: &Mesh) -> String {
    let mut text = String::new();
    mesh.vertices.iter().for_each(|p| writeln!(text, "v {} {} {}", p[0], p[1], p[2]).unwrap());
    for second in [false, true] {
        for &p in &mesh.vertices {
            let [u, v] = uv(p, second);
            writeln!(text, "vt {u} {v}").unwrap();
        }
    }
    for second in [false, true] {
        text += if second { "usemtl right\n" } else { "usemtl left\n" };
        for (f, face) in mesh.faces.iter().enumerate() {
            if (middle(mesh, f) > SEAM) == second {
                let first = if second { mesh.vertices.len() as u32 } else { 0 };
                let [a, b, c] = face.map(|v| format!("{}/{}", v + 1, v + 1 + first));
                writeln!(text, "f {a} {b} {c}").unwrap();
            }
        }
    }
    text
}

/// Texture coordinates and material of each new face's corners.
fn read_fill(text: &str, made: &Completion) -> Vec<([Option<[f64; 2]>; 3], String)> {
    let (mut rows, mut faces, mut material) = (Vec::new(), Vec::new(), String::new());
    for line in text.lines() {
        let words: Vec<&str> = line.split_whitespace().collect();
        match words[0] {
            "vt" => rows.push([1, 2].map(|k| words[k].parse::<f64>().unwrap())),
            "usemtl" => material = words[1].into(),
            "f" => {
                let corner =
                    |w: &str| Some(rows[w.split('/').nth(1)?.parse::<usize>().unwrap() - 1]);
                faces.push(([1, 2, 3].map(|k| corner(words[k])), material.clone()));
            }
            _ => {}
        }
    }
    faces.split_off(made.input_face_count)
}

#[test]
fn each_corner_takes_the_texture_of_its_place() {
    let wall = lathe(true);
    // The faces in the order of the file.
    let mut order: Vec<usize> = (0..wall.faces.len()).collect();
    order.sort_by_key(|&f| middle(&wall, f) > SEAM);
    let mesh = Mesh { faces: order.iter().map(|&f| wall.faces[f]).collect(), ..wall };
    let made = fill_inner(&mesh, Some(painted(&mesh, &pattern(true), 3)));
    assert!(made.origins.iter().all(|o| o.face != Origin::NOWHERE.face));
    let mut document = Document::parse(write_wall(&mesh).into_bytes(), Format::Obj).unwrap();
    document.append(&made, &Extras::default()).unwrap();
    let text = String::from_utf8(document.to_bytes()).unwrap();
    let fill = read_fill(&text, &made);
    assert_eq!(fill.len(), made.faces.len());
    let place = |v: u32| {
        let origin = made.origins[(v as usize).checked_sub(made.input_vertex_count)?];
        let corners = mesh.faces[origin.face as usize].map(|v| mesh.vertices[v as usize]);
        let at = |d: usize| (0..3).map(|k| origin.barycentric[k] * corners[k][d]).sum();
        Some(([0, 1, 2].map(at), origin))
    };
    let (mut compared, mut whole, mut bare) = (0, 0, 0);
    for (face, (corners, material)) in made.faces.iter().zip(&fill) {
        let [Some(a), Some(b), Some(c)] = *corners else {
            // A rim in two charts has no one value to go on from.
            assert_eq!(*corners, [None; 3]);
            bare += 1;
            continue;
        };
        // All corners in one chart: no side runs from one to the other.
        let second = a[0] > JUMP / 2.0;
        assert!([b, c].iter().all(|x| (x[0] > JUMP / 2.0) == second), "{a:?} {b:?} {c:?}");
        assert_eq!(material, if second { "right" } else { "left" });
        let places = face.map(place);
        let sources = places.map(|p| p.map(|p| p.1.source));
        whole += usize::from(
            sources.iter().flatten().all(|s| Some(s) == sources.iter().flatten().next()),
        );
        // Of one of the corners' sources all that have it lie where they were copied from.
        let off = |source: u32| {
            let own = |k: usize| places[k].filter(|(_, o)| o.source == source);
            let off = |k: usize| {
                let wanted = uv(own(k)?.0, second);
                let found = [a, b, c][k];
                Some((found[0] - wanted[0]).hypot(found[1] - wanted[1]))
            };
            (0..3).filter_map(off).fold(0.0, f64::max)
        };
        let least = sources.iter().flatten().map(|&s| off(s)).fold(f64::INFINITY, f64::min);
        assert!(least < 1e-6 || least.is_infinite(), "off by {least}: {a:?} {b:?} {c:?}");
        compared += usize::from(least.is_finite());
        // The image is neither stretched nor turned over on the way.
        let sides = [[a, b], [b, c], [c, a]];
        let flat = |p: [f64; 2]| [10.0 * p[0] - 2.0 * p[1], 10.0 * p[1]];
        for (k, side) in sides.iter().enumerate() {
            let [p, q] = side.map(flat);
            let long = (p[0] - q[0]).hypot(p[1] - q[1]);
            let corner = |v: u32| match (v as usize).checked_sub(made.input_vertex_count) {
                Some(i) => made.vertices[i],
                None => mesh.vertices[v as usize],
            };
            let [x, y] = [corner(face[k]), corner(face[(k + 1) % 3])];
            let wanted = (0..3).map(|d| (x[d] - y[d]).powi(2)).sum::<f64>().sqrt();
            assert!((long - wanted).abs() < 0.02 * wanted, "{long} {wanted}");
        }
    }
    assert!(bare < fill.len() / 100, "{bare} of {} without a source", fill.len());
    assert_eq!(text.contains("# without a source"), bare > 0);
    assert!(compared > fill.len() / 2 && whole > fill.len() / 2, "{compared} {whole}");
}

/// Where only the right half may be copied from, coordinates and material are those of its chart.
#[test]
fn no_texture_of_a_forbidden_place_is_taken() {
    let wall = lathe(true);
    let mut order: Vec<usize> = (0..wall.faces.len()).collect();
    order.sort_by_key(|&f| middle(&wall, f) > SEAM);
    let mesh = Mesh { faces: order.iter().map(|&f| wall.faces[f]).collect(), ..wall };
    for right in [false, true] {
        let may = (0..mesh.faces.len()).map(|f| (middle(&mesh, f) > SEAM) == right).collect();
        let options = complete_mesh::Options {
            sources: complete_mesh::Sources { faces: Some(may), ..Default::default() },
            appearance: Some(std::sync::Arc::new(painted(&mesh, &pattern(true), 3))),
            grouping: complete_mesh::Grouping::Separate,
            selection: complete_mesh::Selection::NearPoint([0.4, 0.3, 0.0]),
            ..Default::default()
        };
        let made =
            complete_mesh::complete_mesh(&mesh.vertices[..], &mesh.faces[..], &options).unwrap();
        let mut document = Document::parse(write_wall(&mesh).into_bytes(), Format::Obj).unwrap();
        document.append(&made, &Extras::default()).unwrap();
        let text = String::from_utf8(document.to_bytes()).unwrap();
        let fill = read_fill(&text, &made);
        let has = |f: &&([Option<[f64; 2]>; 3], String)| f.0.iter().all(Option::is_some);
        assert!(fill.iter().filter(has).count() > fill.len() * 9 / 10);
        for (corners, material) in fill.iter().filter(has) {
            assert_eq!(material, if right { "right" } else { "left" });
            let of_chart = |x: &Option<[f64; 2]>| (x.unwrap()[0] > JUMP / 2.0) == right;
            assert!(corners.iter().all(of_chart), "{corners:?}");
        }
    }
}

/// A smooth fill has no source: the rim's coordinates go on where it has one chart.
#[test]
fn without_a_source_the_rim_goes_on() {
    let mesh = lathe(true);
    let options = complete_mesh::Options {
        method: complete_mesh::Method::Smooth,
        grouping: complete_mesh::Grouping::Separate,
        selection: complete_mesh::Selection::AllButLargest,
        ..Default::default()
    };
    let made = complete_mesh::complete_mesh(&mesh.vertices[..], &mesh.faces[..], &options).unwrap();
    let mut text = String::new();
    for &p in &mesh.vertices {
        let [u, v] = uv(p, false);
        writeln!(text, "v {} {} {}\nvt {u} {v}", p[0], p[1], p[2]).unwrap();
    }
    for face in &mesh.faces {
        let [a, b, c] = face.map(|v| v + 1);
        writeln!(text, "f {a}/{a} {b}/{b} {c}/{c}").unwrap();
    }
    let mut document = Document::parse(text.into_bytes(), Format::Obj).unwrap();
    document.append(&made, &Extras::default()).unwrap();
    let text = String::from_utf8(document.to_bytes()).unwrap();
    for (face, (corners, _)) in made.faces.iter().zip(read_fill(&text, &made)) {
        for (&v, corner) in face.iter().zip(corners) {
            let p = match (v as usize).checked_sub(made.input_vertex_count) {
                Some(i) => made.vertices[i],
                None => mesh.vertices[v as usize],
            };
            let (wanted, found) = (uv(p, false), corner.unwrap());
            let off = (found[0] - wanted[0]).hypot(found[1] - wanted[1]);
            assert!(off < 0.01, "{found:?} {wanted:?}");
        }
    }
}

//! The painted sample vessel with a hole, as an artist or a scanner may have it: as an OBJ with a texture
//! image, with materials, and with values at its vertices.

use complete_mesh::picture::{before_and_after, Image, Shape};
use complete_mesh::sample::{break_mesh, Break, BreakOptions, Sample, SampleMesh};
use complete_mesh::{Appearance, Completer, Grouping, MeshView, Monitor, Options};
use std::collections::HashMap;
use std::f64::consts::TAU;
use std::fmt::Write;
use std::sync::Arc;

type Trouble = Box<dyn std::error::Error>;

/// The vessel is so high, and the image as high as it.
const HEIGHT: f64 = 3.0;
/// The image, once around and from bottom to top.
const IMAGE: [usize; 2] = [2048, 1024];

/// With so many edges from top to bottom.
pub fn broken_vessel(edges: usize) -> Result<SampleMesh, Trouble> {
    let whole = Sample::Vessel.build(edges)?;
    let options = BreakOptions { kind: Break::Disc, seed: 1, size: 1.0 };
    Ok(break_mesh(Sample::Vessel, &whole, &options)?.mesh)
}

/// The paint at a place.
fn paint(p: [f32; 3]) -> [u8; 3] {
    let c = Sample::Vessel.paint(&[p]).unwrap_or_default();
    c.first().map_or([0; 3], |c| [c[0], c[1], c[2]])
}

/// The paint of the outside, unrolled.
pub fn image() -> Image {
    let mut image = Image::new(IMAGE[0], IMAGE[1], [0; 3]);
    for (i, pixel) in image.pixels.iter_mut().enumerate() {
        let share = |i: usize, n: usize| (i as f64 + 0.5) / n as f64;
        let (u, v) = (share(i % IMAGE[0], IMAGE[0]), 1.0 - share(i / IMAGE[0], IMAGE[1]));
        let (s, c) = (TAU * u).sin_cos();
        *pixel = paint([s, HEIGHT * v, c].map(|x| x as f32));
    }
    image
}

/// With texture coordinates, which jump behind the vessel.
pub fn textured(mesh: &SampleMesh) -> String {
    let mut text = String::from("mtllib textured.mtl\nusemtl paint\n");
    mesh.vertices.iter().for_each(|[x, y, z]| _ = writeln!(text, "v {x} {y} {z}"));
    // A vertex has a second row in a face that reaches over the jump.
    let (mut rows, mut faces) = (HashMap::new(), String::new());
    for face in &mesh.faces {
        let around = |v: u32| {
            let [x, _, z] = mesh.vertices[v as usize].map(f64::from);
            (x.atan2(z) / TAU).rem_euclid(1.0)
        };
        let first = around(face[0]);
        faces += "f";
        for &v in face {
            let turns = (first - around(v)).round();
            let number = rows.len() + 1;
            let row = *rows.entry((v, turns as i64)).or_insert_with(|| {
                let height = f64::from(mesh.vertices[v as usize][1]) / HEIGHT;
                let _ = writeln!(text, "vt {:.6} {height:.6}", around(v) + turns);
                number
            });
            let _ = write!(faces, " {}/{row}", v + 1);
        }
        faces += "\n";
    }
    text + &faces
}

/// Of four materials: to each face the one whose colour is nearest to the paint there.
pub fn of_materials(mesh: &SampleMesh) -> (String, String) {
    let all = [
        ("clay", [176, 104, 66]),
        ("slip", [232, 214, 178]),
        ("blue", [38, 66, 128]),
        ("black", [46, 34, 30]),
    ];
    let mut library = String::new();
    for (name, colour) in all {
        let [r, g, b] = colour.map(|c| f64::from(c) / 255.0);
        let _ = writeln!(library, "newmtl {name}\nKd {r:.3} {g:.3} {b:.3}");
    }
    let mut text = String::from("mtllib materials.mtl\n");
    mesh.vertices.iter().for_each(|[x, y, z]| _ = writeln!(text, "v {x} {y} {z}"));
    let mut current = "";
    for face in &mesh.faces {
        let corners = face.map(|v| mesh.vertices[v as usize]);
        let own = paint([0, 1, 2].map(|d| corners.iter().map(|p| p[d]).sum::<f32>() / 3.0));
        let far = |c: [i32; 3]| (0..3).map(|k| (c[k] - i32::from(own[k])).pow(2)).sum::<i32>();
        let nearest = all.iter().min_by_key(|m| far(m.1)).map_or("clay", |m| m.0);
        if nearest != current {
            let _ = writeln!(text, "usemtl {nearest}");
            current = nearest;
        }
        let _ = writeln!(text, "f {} {} {}", face[0] + 1, face[1] + 1, face[2] + 1);
    }
    (text, library)
}

/// Before and after of values at the vertices, N each, in colours.
pub fn picture_of_values<const N: usize>(
    mesh: &SampleMesh,
    value: impl Fn([f32; 3]) -> [f64; N],
    shown: impl Fn(&[f64]) -> [u8; 3],
) -> Result<Image, Trouble> {
    let values: Vec<f64> = mesh.vertices.iter().flat_map(|&p| value(p)).collect();
    let given = Appearance { channels: N, steering: 0, values, exemplar_values: Vec::new() };
    let options = Options { appearance: Some(Arc::new(given.clone())), ..Options::default() };
    let completer = Completer::new(mesh.view(), &Grouping::Automatic, &Monitor::silent())?;
    let made = completer.complete(&options, &Monitor::silent())?;
    let new = given.complete(mesh.view().faces, None, &made);
    let mut vertices = mesh.vertices.clone();
    vertices.extend(made.vertices.iter().map(|p| p.map(|x| x as f32)));
    let mut faces = mesh.faces.clone();
    faces.extend(&made.faces);
    let colours: Vec<[u8; 3]> = [&given.values[..], &new].concat().chunks(N).map(shown).collect();
    let shape = |count: usize| Shape {
        colours: Some(&colours),
        ..Shape::plain(MeshView::new(&vertices[..], &faces[..count]))
    };
    let (before, after) = (shape(mesh.faces.len()), shape(faces.len()));
    Ok(before_and_after(&before, &after, completer.holes(), &[0]))
}

/// How light the paint is, 0 to 1.
pub fn lightness(p: [f32; 3]) -> f64 {
    let [r, g, b] = paint(p).map(f64::from);
    (0.3 * r + 0.6 * g + 0.1 * b) / 255.0
}

/// From dark violet over green to yellow.
pub fn in_colours(x: f64) -> [u8; 3] {
    let stops = [[68.0, 1.0, 84.0], [33.0, 145.0, 140.0], [253.0, 231.0, 37.0]];
    let at = 2.0 * x.clamp(0.0, 1.0);
    let k = (at as usize).min(1);
    let t = at - k as f64;
    [0, 1, 2].map(|c| (stops[k][c] + t * (stops[k + 1][c] - stops[k][c])).round() as u8)
}

/// Blue glass that is the clearer the lighter the paint is: its colour and its alpha.
pub fn glass(p: [f32; 3]) -> [f64; 4] {
    [20.0, 60.0, 150.0, 255.0 * (1.0 - lightness(p))]
}

/// A colour with alpha, laid over white.
pub fn over_white(c: &[f64]) -> [u8; 3] {
    [0, 1, 2].map(|k| (255.0 + c[3] / 255.0 * (c[k] - 255.0)).round() as u8)
}

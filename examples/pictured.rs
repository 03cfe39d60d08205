//! Meshes for the pictures of the manual, each to show one ability:
//! `cargo run --release --example pictured -- DIR` writes
//!
//! - `fold.ply`: two planes at right angles and a hole that ends at the fold;
//!   `fold-loose.txt` has the rim vertices there;
//! - `wall.ply`: a wall with a relief on the left, flat and painted on the right; around a hole in the relief it
//!   has the right side's paint;
//! - `flat.ply`, `pair.ply`, `spots.ply`: flat walls with a hole, whose paint goes on in waves, is the mirror image
//!   of the other side's, and is of spots that lie where chance has them;
//! - `left.ply`, `right.ply`: the two halves of a whole vessel, apart;
//! - `textured.obj`, with `textured.mtl` and `textured.png`: the painted vessel with a hole, its paint in an
//!   image; `materials.obj`, with `materials.mtl`: in four materials;
//! - `value.png` and `alpha.png`: pictures of it before and after, with a number at each vertex, and with alpha.

mod dressed;

use complete_mesh::io::{Document, Format};
use complete_mesh::picture::Image;
use complete_mesh::sample::{Sample, SampleMesh};
use std::f64::consts::TAU;
use std::fmt::Write;
use std::path::Path;

/// A vertex and its colour.
type Painted = ([f64; 3], [u8; 3]);
/// The paint of a flat wall at a place: red, green, blue, 0 to 1.
type Paint = fn(f64, f64) -> [f64; 3];

/// A grid of cells, two triangles each; those that `keep` refuses, given the middle, are missing. Returns the
/// file and, for each corner of the grid, its vertex.
fn grid(
    (nx, ny): (usize, usize),
    at: impl Fn(f64, f64) -> Painted,
    keep: impl Fn(f64, f64) -> bool,
) -> (String, Vec<Option<usize>>) {
    let mut number = vec![None; (nx + 1) * (ny + 1)];
    let (mut vertices, mut faces) = (Vec::new(), Vec::new());
    for j in 0..ny {
        for i in (0..nx).filter(|&i| keep(i as f64 + 0.5, j as f64 + 0.5)) {
            let corner = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)].map(|(i, j)| {
                *number[j * (nx + 1) + i].get_or_insert_with(|| {
                    vertices.push(at(i as f64, j as f64));
                    vertices.len() - 1
                })
            });
            let [a, b, c, d] = corner;
            faces.extend([[a, b, c], [a, c, d]]);
        }
    }
    (ply(&vertices, &faces), number)
}

fn ply(vertices: &[Painted], faces: &[[usize; 3]]) -> String {
    let mut text = format!("ply\nformat ascii 1.0\nelement vertex {}\n", vertices.len());
    ["x", "y", "z"].iter().for_each(|d| text += &format!("property float {d}\n"));
    ["red", "green", "blue"].iter().for_each(|c| text += &format!("property uchar {c}\n"));
    let _ = writeln!(text, "element face {}", faces.len());
    text += "property list uchar int vertex_indices\nend_header\n";
    for ([x, y, z], [r, g, b]) in vertices {
        let _ = writeln!(text, "{x:.6} {y:.6} {z:.6} {r} {g} {b}");
    }
    faces.iter().for_each(|f| _ = writeln!(text, "3 {} {} {}", f[0], f[1], f[2]));
    text
}

/// Waves, which go on the same all over.
fn waves(x: f64, y: f64) -> [f64; 3] {
    let v = (TAU * (x + 0.2 * y) / 0.9).sin() * (TAU * (y - 0.1 * x) / 0.7).cos();
    [0.55 + 0.4 * v, 0.5 - 0.2 * v, 0.35]
}

/// Stripes that wander, so that none goes on as another does but for its mirror image at x = 0.
fn pair(x: f64, y: f64) -> [f64; 3] {
    let x = x.abs();
    let wander = 1.9 * (1.7 * x + 0.3).sin() + 1.3 * (2.9 * x - 1.9 * y).sin();
    let v = (2.0 * (9.0 * y + 1.5 * x * x + wander).sin()).tanh();
    [0.5 + 0.4 * v, 0.5 - 0.2 * v, 0.3 + 0.1 * v]
}

/// Spots, each of its own size and place in a cell of the wall.
fn spots(x: f64, y: f64) -> [f64; 3] {
    let (p, mut v) = ([x, y].map(|c| 3.0 * c), 0.0_f64);
    for (dx, dy) in (-1..=1).flat_map(|dx| (-1..=1).map(move |dy| (dx, dy))) {
        let [a, b] = [p[0].floor() + f64::from(dx), p[1].floor() + f64::from(dy)];
        let random = |k: f64| (k * 1e4 * (12.9898 * a + 78.233 * b + k).sin()).rem_euclid(1.0);
        let [a, b] = [a + 0.2 + 0.6 * random(1.0), b + 0.2 + 0.6 * random(1.3)];
        let size = 0.3 + 0.2 * random(1.7);
        v = v.max((3.0 - 3.0 * (p[0] - a).hypot(p[1] - b) / size).clamp(0.0, 1.0));
    }
    [0.2 + 0.6 * v, 0.6 - 0.4 * v, 0.4]
}

/// The half of a painted mesh where x has this sign, moved away from the other.
fn half(whole: &SampleMesh, sign: f32) -> String {
    let paint = Sample::Vessel.paint(&whole.vertices).unwrap_or_default();
    let (mut number, mut vertices) = (vec![None; whole.vertices.len()], Vec::new());
    let is_here =
        |f: &&[u32; 3]| sign * f.map(|v| whole.vertices[v as usize][0]).iter().sum::<f32>() > 0.0;
    let mut corner = |v: u32| {
        *number[v as usize].get_or_insert_with(|| {
            let [x, y, z] = whole.vertices[v as usize];
            let [r, g, b, _] = paint[v as usize];
            vertices.push(([x + 2.0 * sign, y, z].map(f64::from), [r, g, b]));
            vertices.len() - 1
        })
    };
    let faces: Vec<[usize; 3]> =
        whole.faces.iter().filter(is_here).map(|f| f.map(&mut corner)).collect();
    ply(&vertices, &faces)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let dir = std::env::args().nth(1).ok_or("name a directory")?;
    let dir = Path::new(&dir);
    let clay = [205, 190, 170];
    let fold = |i: f64, j: f64| match i <= 40.0 {
        true => ([i, j, 0.0], clay),
        false => ([40.0, j, i - 40.0], clay),
    };
    let hole = |i: f64, j: f64| (18.0..40.0).contains(&i) && (20.0..44.0).contains(&j);
    let (text, number) = grid((80, 64), fold, |i, j| !hole(i, j));
    save(text, &dir.join("fold.ply"))?;
    let loose: Vec<String> =
        (20..=44).filter_map(|j| Some(number[j * 81 + 40]?.to_string())).collect();
    std::fs::write(dir.join("fold-loose.txt"), loose.join(","))?;

    let place = |i: f64, j: f64| (0.015 * i - 2.7, 0.015 * j - 1.2);
    let off = |x: f64, y: f64| (x + 1.9).hypot(y);
    let wall = |i: f64, j: f64| {
        let (x, y) = place(i, j);
        let relief = 0.025 * (TAU * x / 0.3).sin() * (TAU * y / 0.375).cos()
            + 0.015 * (TAU * (x + y) / 0.6).sin();
        let same = x > 1.0 || off(x, y) < 0.45;
        let v = match same {
            true => (11.0 * x).sin() * (9.0 * y).sin(),
            false => (17.0 * (x + 0.3 * y)).sin(),
        };
        let colour = [0.55 + 0.4 * v, 0.5 - 0.2 * v, 0.35].map(|c| (255.0 * c) as u8);
        ([x, y, if x < 1.0 { relief } else { 0.0 }], colour)
    };
    let keep = |i: f64, j: f64| {
        let (x, y) = place(i, j);
        off(x, y) > 0.25
    };
    save(grid((360, 160), wall, keep).0, &dir.join("wall.ply"))?;

    for (name, paint, hole) in
        [("flat", waves as Paint, 80.0), ("pair", pair, 40.0), ("spots", spots, 80.0)]
    {
        let at = |i: f64, j: f64| {
            let (x, y) = (0.04 * i - 3.2, 0.04 * j - 2.0);
            ([x, y, 0.0], paint(x, y).map(|c| (255.0 * c) as u8))
        };
        let keep = |i: f64, j: f64| (i - hole).hypot(j - 50.0) > 17.0;
        save(grid((160, 100), at, keep).0, &dir.join(format!("{name}.ply")))?;
    }
    let whole = Sample::Vessel.build(150)?;
    save(half(&whole, -1.0), &dir.join("left.ply"))?;
    save(half(&whole, 1.0), &dir.join("right.ply"))?;

    // Coarser than what the image shows.
    let coarse = dressed::broken_vessel(80)?;
    let draw = |name: &str, image: Image| -> std::io::Result<()> {
        image.write_png(std::fs::File::create(dir.join(name))?)
    };
    std::fs::write(dir.join("textured.obj"), dressed::textured(&coarse))?;
    std::fs::write(dir.join("textured.mtl"), "newmtl paint\nmap_Kd textured.png\n")?;
    draw("textured.png", dressed::image())?;
    let vessel = dressed::broken_vessel(240)?;
    let (text, library) = dressed::of_materials(&vessel);
    std::fs::write(dir.join("materials.obj"), text)?;
    std::fs::write(dir.join("materials.mtl"), library)?;
    let value = |p| [dressed::lightness(p)];
    let of_value = dressed::picture_of_values(&vessel, value, |x| dressed::in_colours(x[0]))?;
    draw("value.png", of_value)?;
    draw("alpha.png", dressed::picture_of_values(&vessel, dressed::glass, dressed::over_white)?)?;
    Ok(())
}

fn save(text: String, path: &Path) -> Result<(), Box<dyn std::error::Error>> {
    let document = Document::parse(text.into_bytes(), Format::Ply)?;
    Ok(std::fs::write(path, document.to_bytes())?)
}

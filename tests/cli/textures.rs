//! `--picture` of OBJ files with materials: textures of the input and of the fill.

use crate::place::Place;
use serde_json::Value;
use std::fmt::Write;

const CELLS: usize = 24;
const RED: [u8; 3] = [200, 30, 30];
const BLUE: [u8; 3] = [30, 40, 200];

/// A square from -1 to 1 that faces +z, a hole in its middle; the image lies over all of it. Faces within
/// `bare` of the middle have no texture coordinates.
fn square(head: &str, bare: f64) -> String {
    let (at, n) = (|i: usize| 2.0 * i as f64 / CELLS as f64 - 1.0, CELLS + 1);
    let mut text = format!("{head}\n");
    for k in 0..n * n {
        writeln!(text, "v {} {} 0", at(k % n), at(k / n)).unwrap();
    }
    for k in 0..n * n {
        writeln!(text, "vt {} {}", 0.5 + 0.5 * at(k % n), 0.5 + 0.5 * at(k / n)).unwrap();
    }
    for k in (0..n * n).filter(|k| k % n < CELLS && k / n < CELLS) {
        let off = (at(k % n) + 1.0 / CELLS as f64).hypot(at(k / n) + 1.0 / CELLS as f64);
        if off > 0.35 {
            let corners = [k + 1, k + 2, k + n + 2, k + n + 1];
            let corner = |v: usize| if off < bare { format!(" {v}") } else { format!(" {v}/{v}") };
            writeln!(text, "f{}", corners.map(corner).concat()).unwrap();
        }
    }
    text
}

/// Red on the left, blue on the right, as a PNG of a palette, which has to be looked up.
fn write_image(place: &Place, name: &str) {
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, 16, 8);
    encoder.set_color(png::ColorType::Indexed);
    encoder.set_palette([RED, BLUE].concat());
    let mut writer = encoder.write_header().unwrap();
    let row = [[0u8; 8], [1; 8]].concat();
    writer.write_image_data(&row.repeat(8)).unwrap();
    writer.finish().unwrap();
    std::fs::write(place.path(name), file).unwrap();
}

/// The picture's pixel in the middle of one view, so many pixels to the right of it. Rows: the whole, the
/// hole; columns: before, after.
fn pixel(place: &Place, row: usize, column: usize, right: i64) -> [u8; 3] {
    let file = std::io::BufReader::new(std::fs::File::open(place.path("p.png")).unwrap());
    let mut reader = png::Decoder::new(file).read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let width = reader.next_frame(&mut bytes).unwrap().width as usize;
    let (x, y) = (10 + column * 570 + 280, 10 + row * 470 + 230);
    let at = 3 * (y * width + (x as i64 + right) as usize);
    [bytes[at], bytes[at + 1], bytes[at + 2]]
}

fn is_red([r, g, b]: [u8; 3]) -> bool {
    r > 120 && g < r / 3 && b < r / 3
}

fn is_blue([r, g, b]: [u8; 3]) -> bool {
    b > 120 && r < b / 2 && g < b / 2
}

/// Redder than blue, and not by much.
fn is_clay([r, g, b]: [u8; 3]) -> bool {
    r > b + 20 && g > b && b > r / 2
}

/// Fills the hole in the middle and gives the warnings and what was printed of them.
fn fill(place: &Place, method: &str) -> (Vec<Value>, String) {
    let line = "fill in/square.obj -o out/square.obj --near 0,0,0 --picture p.png --report r.json";
    let (_, stderr) = place.expect(0, &format!("{line} --method {method}"));
    (place.json("r.json")["warnings"].as_array().unwrap().clone(), stderr)
}

fn folders() -> Place {
    let place = Place::new();
    ["in", "out", "in/maps"].iter().for_each(|d| std::fs::create_dir(place.path(d)).unwrap());
    place
}

const HEAD: &str = "mtllib the square.mtl\nusemtl two colours";

#[test]
fn the_image_is_drawn_on_the_input_and_goes_on_over_the_fill() {
    let place = folders();
    place.write("in/square.obj", &square(HEAD, 0.0));
    // From a program on Windows, with options before the name.
    let line = "newmtl other\nKd 0 1 0\nnewmtl two colours\nKd 0.1 0.1 0.1\n\
                map_Kd -s 1 1 -clamp off maps\\red blue.png\n";
    place.write("in/the square.mtl", line);
    write_image(&place, "in/maps/red blue.png");
    let check = |name: &str| {
        let (warnings, stderr) = fill(&place, "smooth");
        assert_eq!((warnings.len(), stderr.as_str()), (0, ""), "{name}: {warnings:?}");
        for (row, column) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            // Beside the hole; over it, in the second column, on the fill.
            for right in [if row == 0 { 150 } else { 200 }, 30] {
                let [l, r] = [-right, right].map(|x| pixel(&place, row, column, x));
                let open = column == 0 && right == 30;
                assert_eq!(is_red(l), !open, "{name}: {l:?} in {row}, {column} at {right}");
                assert_eq!(is_blue(r), !open, "{name}: {r:?} in {row}, {column} at {right}");
            }
        }
    };
    check("PNG");
    let jpeg = include_bytes!("red_blue.jpg");
    place.write("in/the square.mtl", "newmtl two colours\nmap_Kd red_blue.jpg\n");
    std::fs::write(place.path("in/red_blue.jpg"), jpeg).unwrap();
    check("JPEG");
}

/// Half an image further on, and twice as often: what was red is blue, and halves are halved.
#[test]
fn options_of_the_line_move_the_image() {
    let place = folders();
    place.write("in/square.obj", &square(HEAD, 0.0));
    write_image(&place, "in/red_blue.png");
    let draw = |options: &str| {
        let line = format!("newmtl two colours\nmap_Kd {options} red_blue.png\n");
        place.write("in/the square.mtl", &line);
        fill(&place, "smooth");
        [-200, -30, 30, 200].map(|x| is_blue(pixel(&place, 1, 1, x)))
    };
    assert_eq!(draw(""), [false, false, true, true]);
    assert_eq!(draw("-o 0.5"), [true, true, false, false]);
    let [a, b, c, d] = draw("-s 2 2");
    assert!(a != b && c != d && a == c && b == d, "{a} {b} {c} {d}");
}

/// A flat fill may be copied from either side: it shows the part of the image that the written file says.
#[test]
fn a_copied_fill_shows_what_it_was_copied_from() {
    let place = folders();
    place.write("in/square.obj", &square(HEAD, 0.0));
    place.write("in/the square.mtl", "newmtl two colours\nmap_Kd red_blue.png\n");
    write_image(&place, "in/red_blue.png");
    assert_eq!(fill(&place, "coherent").0.len(), 0);
    let text = std::fs::read_to_string(place.path("out/square.obj")).unwrap();
    let (mut vertices, mut rows, mut faces) = (Vec::new(), Vec::new(), Vec::new());
    for line in text.lines() {
        let words: Vec<&str> = line.split_whitespace().collect();
        let numbers = || [1, 2].map(|k| words[k].parse::<f64>().unwrap());
        match words[0] {
            "v" => vertices.push(numbers()),
            "vt" => rows.push(numbers()),
            "f" if words.len() == 4 => faces.push([1, 2, 3].map(|k| {
                let mut parts = words[k].split('/').map(|n| n.parse::<usize>().unwrap() - 1);
                [parts.next().unwrap(), parts.next().unwrap()]
            })),
            _ => {}
        }
    }
    assert_eq!(faces.len() as u64, place.json("r.json")["new_faces"].as_u64().unwrap());
    // 560 pixels are 2.2 diameters.
    let scale = 2.2 * place.json("r.json")["holes"][1]["diameter"].as_f64().unwrap() / 560.0;
    let mut copied = 0;
    for right in (-90..=90).step_by(10) {
        let at = right as f64 * scale;
        let middle = |f: &[[usize; 2]; 3]| {
            [0, 1].map(|d| f.iter().map(|c| vertices[c[0]][d]).sum::<f64>() / 3.0)
        };
        let off = |f: &[[usize; 2]; 3]| {
            let [x, y] = middle(f);
            (x - at).hypot(y)
        };
        let nearest = faces.iter().min_by(|a, b| off(a).total_cmp(&off(b))).unwrap();
        let u = nearest.map(|c| rows[c[1]][0]);
        let blue = u[0] > 0.5;
        // Beside a border there is no telling which face it is.
        if u.iter().any(|&u| (u > 0.45 && u < 0.55) || (u > 0.5) != blue) {
            continue;
        }
        let p = pixel(&place, 1, 1, right);
        assert!(if blue { is_blue(p) } else { is_red(p) }, "{p:?} at {right}, {u:?}");
        copied += usize::from(blue != (at > 0.0));
    }
    assert!(copied > 3, "the fill is not copied from elsewhere: this tests nothing");
}

#[test]
fn materials_without_an_image_have_their_colour() {
    let place = folders();
    place.write("in/square.obj", &square("mtllib a.mtl b.mtl\nusemtl green", 0.0));
    place.write("in/a.mtl", "newmtl blue\nKd 0 0 1\n");
    place.write("in/b.mtl", "newmtl green\nKd 0.1 0.8 0.1\n");
    assert_eq!(fill(&place, "smooth").0.len(), 0);
    let p = pixel(&place, 1, 1, 0);
    assert!(p[1] > 120 && p[0] < p[1] / 2 && p[2] < p[1] / 2, "{p:?}");
}

#[test]
fn what_is_missing_is_drawn_plain_and_named() {
    let place = folders();
    let library = "newmtl two colours\nmap_Kd gone.png\n";
    for (library, content, named) in [
        (None, None, "the square.mtl"),
        (Some(library), None, "gone.png"),
        (Some(library), Some("GIF89a"), "gone.png: it is neither PNG nor JPEG"),
        (Some(library), Some("\u{89}PNG"), "gone.png"),
    ] {
        place.write("in/square.obj", &square(HEAD, 0.0));
        library.iter().for_each(|text| place.write("in/the square.mtl", text));
        content.iter().for_each(|text| place.write("in/gone.png", text));
        let (warnings, stderr) = fill(&place, "smooth");
        assert_eq!(warnings.len(), 1, "{warnings:?}");
        assert_eq!(warnings[0]["kind"], "textures-unread");
        assert!(warnings[0]["elements"][0].as_str().unwrap().contains(named), "{warnings:?}");
        assert!(stderr.contains(named) && stderr.contains("plain"), "{stderr}");
        assert!(is_clay(pixel(&place, 1, 1, 0)) && is_clay(pixel(&place, 1, 0, 200)));
    }
}

/// Around the hole there are no coordinates, so that the fill has none either.
#[test]
fn faces_without_coordinates_are_counted() {
    let place = folders();
    place.write("in/square.obj", &square(HEAD, 0.5));
    place.write("in/the square.mtl", "newmtl two colours\nmap_Kd red_blue.png\n");
    write_image(&place, "in/red_blue.png");
    let (warnings, _) = fill(&place, "smooth");
    let new = place.json("r.json")["new_faces"].as_u64().unwrap();
    assert_eq!(warnings.len(), 1, "{warnings:?}");
    assert_eq!(warnings[0]["kind"], "texture-coordinates-missing");
    let ring = square(HEAD, 0.5).lines().filter(|l| l.starts_with('f') && !l.contains('/')).count();
    assert_eq!(warnings[0]["count"].as_u64().unwrap(), new + 2 * ring as u64);
    assert!(is_clay(pixel(&place, 1, 1, 30)) && is_clay(pixel(&place, 1, 1, -30)));
    assert!(is_red(pixel(&place, 0, 1, -150)), "{:?}", pixel(&place, 0, 1, -150));
}

//! Where fills come from, and what they may be told to start and copy from.

use crate::place::{assert_kept, geometry, Place};
use complete_mesh::intersect::Bvh;
use complete_mesh::io::Document;
use glam::DVec3;

#[test]
fn provenance_marks_the_new_vertices() {
    let place = Place::new();
    place.expect(0, "sample sphere --resolution 40 --break disc -o in.ply");
    place.expect(0, "fill in.ply -o out.ply --provenance");
    let bytes = std::fs::read(place.path("out.ply")).unwrap();
    let header = String::from_utf8_lossy(&bytes[..400]).into_owned();
    assert!(header.contains("completed") && header.contains("hole"), "{header}");
    assert_kept(&place.path("in.ply"), &place.path("out.ply"));
}

/// What the file says of each new vertex, what the report says of the hole and what lies in the
/// input at the place named belong together.
#[test]
fn report_and_columns_lead_to_the_source() {
    let place = Place::new();
    place.expect(0, "sample column --resolution 60 --break disc -o in.ply");
    let line = "fill in.ply -o out.ply --provenance --report r.json --picture p.png --tint";
    let (stdout, _) = place.expect(0, line);
    let hole = place.json("r.json")["holes"][0].clone();
    assert_eq!(hole["method"], "coherent");
    let confidence = hole["confidence"].as_f64().unwrap();
    assert!(confidence > 0.0 && confidence <= 1.0, "{hole:#}");
    let sources = hole["sources"].as_array().unwrap();
    let told = format!("hole 0: coherent, {} source", sources.len());
    assert!(stdout.contains(&told) && stdout.contains("confidence"), "{stdout}");
    let sum: f64 = sources.iter().map(|s| s["weight"].as_f64().unwrap()).sum();
    assert!((sum - 1.0).abs() < 1e-9, "{hole:#}");

    let bytes = std::fs::read(place.path("out.ply")).unwrap();
    let body = bytes.windows(11).position(|w| w == b"end_header\n").unwrap() + 11;
    // Three floats, completed, hole, source_face, source_u, source_v, source, confidence.
    let row = |v: usize| &bytes[body + 37 * v..body + 37 * (v + 1)];
    let int = |v: usize, at: usize| i32::from_le_bytes(row(v)[at..at + 4].try_into().unwrap());
    let float =
        |v: usize, at: usize| f64::from(f32::from_le_bytes(row(v)[at..at + 4].try_into().unwrap()));
    let (vertices, faces) = geometry(&place.path("in.ply"));
    for v in 0..vertices.len() {
        assert_eq!((row(v)[12], int(v, 13), int(v, 17), int(v, 29)), (0, -1, -1, -1));
        assert_eq!(float(v, 33), 0.0);
    }
    let new = hole["new_vertices"].as_u64().unwrap() as usize;
    let diameter = hole["diameter"].as_f64().unwrap();
    let mut copied = 0;
    for v in vertices.len()..vertices.len() + new {
        assert_eq!((row(v)[12], int(v, 13)), (1, 0));
        let Ok(face) = usize::try_from(int(v, 17)) else { continue };
        copied += 1;
        let (a, b) = (float(v, 21), float(v, 25));
        let corners = faces[face].map(|c| vertices[c as usize].map(f64::from_bits));
        let p: [f64; 3] = std::array::from_fn(|k| {
            (1.0 - a - b) * corners[0][k] + a * corners[1][k] + b * corners[2][k]
        });
        let transform = &sources[int(v, 29) as usize]["transform"];
        let entry = |i: usize, k: usize| transform[i][k].as_f64().unwrap();
        let off: f64 = (0..3)
            .map(|i| {
                let to: f64 = (0..3).map(|k| entry(i, k) * p[k]).sum::<f64>() + entry(i, 3);
                (to - float(v, 4 * i)).powi(2)
            })
            .sum();
        assert!(off.sqrt() < 0.25 * diameter, "vertex {v} is {} from its source", off.sqrt());
    }
    assert!(10 * copied > 9 * new, "{copied} of {new}");
}

/// Given an intact twin and nothing else, the fill lies on the twin's surface, which a smooth fill does
/// not: both are of one sample, so the twin is where it was.
#[test]
fn an_exemplar_gives_back_what_is_missing() {
    let place = Place::new();
    place.expect(0, "sample vessel --resolution 90 -q -o whole.ply");
    place.expect(0, "sample vessel --resolution 90 --break disc -q -o in.ply");
    place.expect(0, "fill in.ply --method smooth -q -o smooth.ply");
    place.expect(0, "fill in.ply --exemplar whole.ply --exemplar-only --unmirrored -q -o twin.ply");
    assert_kept(&place.path("in.ply"), &place.path("twin.ply"));
    let off = |name: &str| worst_of_new(&place, "in.ply", name, "whole.ply");
    let (twin, smooth) = (off("twin.ply"), off("smooth.ply"));
    println!("twin {twin:.3} edges, smooth {smooth:.3}");
    assert!(twin < 0.05 && smooth > 0.3, "{twin} {smooth}");
    place.expect(2, "fill in.ply --exemplar-only -o none.ply");
    place.expect(3, "fill in.ply --exemplar missing.ply -o none.ply");
}

/// The greatest distance of a new vertex from the whole mesh, in mean edges of that.
fn worst_of_new(place: &Place, input: &str, output: &str, truth: &str) -> f64 {
    let read = |name: &str| Document::read(&place.path(name)).unwrap();
    let (input, output, truth) = (read(input), read(output), read(truth));
    let corners: Vec<DVec3> =
        (0..truth.vertices().len()).map(|v| DVec3::from(truth.vertices().get(v))).collect();
    let faces: Vec<[u32; 3]> = (0..truth.faces().len()).map(|f| truth.faces().get(f)).collect();
    let length = |f: &[u32; 3]| corners[f[0] as usize].distance(corners[f[1] as usize]);
    let edge = faces.iter().map(length).sum::<f64>() / faces.len() as f64;
    let tree = Bvh::new(&corners, &faces);
    let new = input.vertices().len()..output.vertices().len();
    assert!(!new.is_empty());
    let off = |v| tree.closest_point(DVec3::from(output.vertices().get(v)), f64::INFINITY);
    new.map(|v| off(v).unwrap().distance).fold(0.0, f64::max) / edge
}

/// A membrane comes back as it was given, where a smooth fill would be another.
#[test]
fn an_initial_completion_is_what_is_started_from() {
    let place = Place::new();
    place.expect(0, "sample vessel --resolution 60 --break disc -q -o in.ply");
    place.expect(0, "fill in.ply --method smooth --fairing c0 -q -o flat.ply");
    place.expect(0, "fill in.ply --method smooth -q -o other.ply");
    place.expect(0, "fill in.ply --method smooth --initial flat.ply -q -o again.ply");
    assert_kept(&place.path("in.ply"), &place.path("again.ply"));
    let sorted = |name: &str| {
        let (mut vertices, faces) = geometry(&place.path(name));
        vertices.sort_unstable();
        (vertices, faces.len())
    };
    assert!(sorted("again.ply") == sorted("flat.ply"));
    assert!(sorted("other.ply") != sorted("flat.ply"));
    let (_, stderr) = place.expect(2, "fill in.ply --initial again.ply --holes 0 -o again.ply");
    assert!(stderr.contains("one file"), "{stderr}");
    // Of another mesh.
    place.expect(0, "sample vessel --resolution 60 --break crack -q -o crack.ply");
    let (_, stderr) = place.expect(2, "fill crack.ply --initial flat.ply -o none.ply");
    assert!(stderr.contains("does not begin with"), "{stderr}");
    assert!(!place.names().contains("none.ply"));
}

#[test]
fn the_tinted_picture_shows_the_source_and_a_legend() {
    let place = Place::new();
    place.expect(0, "sample column --resolution 60 --break disc -o in.ply");
    let height = |flags: &str| {
        place.expect(0, &format!("fill in.ply -o out.ply --picture p.png {flags}"));
        let file = std::fs::File::open(place.path("p.png")).unwrap();
        png::Decoder::new(std::io::BufReader::new(file)).read_info().unwrap().info().height
    };
    let (plain, tinted) = (height(""), height("--tint"));
    // A row for the source, a few lines of words.
    assert!((tinted - plain - 470) > 40 && tinted - plain - 470 < 400, "{plain} {tinted}");
}

/// A twin twice as large: placed by numbers or by a file it gives back what is missing, and so it does if
/// it may be scaled.
#[test]
fn an_exemplar_is_placed_by_hand_or_scaled() {
    let place = Place::new();
    place.expect(0, "sample vessel --resolution 90 -q -o whole.ply");
    place.expect(0, "sample vessel --resolution 90 --break disc -q -o in.ply");
    let (vertices, faces) = geometry(&place.path("whole.ply"));
    let mut text = String::from("OFF\n");
    text += &format!("{} {} 0\n", vertices.len(), faces.len());
    for p in &vertices {
        let [x, y, z] = p.map(f64::from_bits);
        text += &format!("{} {} {}\n", 2.0 * y + 1.0, 2.0 * z, 2.0 * x);
    }
    faces.iter().for_each(|f| text += &format!("3 {} {} {}\n", f[0], f[1], f[2]));
    std::fs::write(place.path("twin.off"), text).unwrap();
    let rows = "0 0 0.5 0\n0.5 0 0 -0.5\n0 0.5 0 0\n";
    std::fs::write(place.path("m.txt"), rows).unwrap();
    let off = |name: &str| worst_of_new(&place, "in.ply", name, "whole.ply");
    let numbers = rows.split_whitespace().collect::<Vec<_>>().join(",");
    for flags in
        [format!("--transform {numbers}"), "--transform m.txt".into(), "--scale 0.1,10".into()]
    {
        let line = format!("fill in.ply --exemplar twin.off --exemplar-only {flags} -q -o out.ply");
        place.expect(0, &line);
        assert_kept(&place.path("in.ply"), &place.path("out.ply"));
        println!("{flags}: {:.1e} edges", off("out.ply"));
        assert!(off("out.ply") < 1e-3, "{flags}");
    }
    let (_, stderr) = place.expect(2, "fill in.ply --transform 1,2,3 -o none.ply");
    assert!(stderr.contains("12 or 16"), "{stderr}");
    place.expect(4, "fill in.ply --transform 1,0,0,0,0,2,0,0,0,0,1,0 -o none.ply");
    place.expect(2, "fill in.ply --transform m.txt --candidate 1 -o none.ply");
    place.expect(2, "fill in.ply --refine-transform -o none.ply");
}

/// A file for each candidate, and one report with all of them; one alone is the same file.
#[test]
fn candidates_are_files_side_by_side() {
    let place = Place::new();
    place.expect(0, "sample column --resolution 60 --break disc -q -o in.ply");
    place.expect(0, "fill in.ply --candidates 3 -q -o out.ply --report r.json --picture p.png");
    let report = place.json("r.json");
    let list = report["candidates"].as_array().unwrap();
    assert_eq!(list.len(), 3);
    for (i, one) in list.iter().enumerate() {
        let name = format!("out-{}.ply", i + 1);
        assert_kept(&place.path("in.ply"), &place.path(&name));
        assert!(place.path(&format!("p-{}.png", i + 1)).exists());
        let hole = &one["holes"][0];
        assert_eq!(one["candidate"], i + 1);
        assert_eq!(hole["sources"].as_array().unwrap().len(), 1);
        assert!(hole["confidence"].as_f64().unwrap() > 0.0);
        assert!(one["output"]["path"].as_str().unwrap().ends_with(&name));
        place.expect(0, &format!("fill in.ply --candidate {} -q -o one.ply", i + 1));
        let bytes = |name: &str| std::fs::read(place.path(name)).unwrap();
        assert!(bytes("one.ply") == bytes(&name), "{name}");
    }
    assert!(!place.path("out.ply").exists());
    place.expect(2, "fill in.ply --candidates 0 -o out.ply");
    place.expect(2, "fill out-2.ply --candidates 3 -o out.ply");
    // A tetrahedron without its floor has nothing to copy from.
    let text = "OFF\n4 3 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
    std::fs::write(place.path("bare.off"), text).unwrap();
    let (_, stderr) = place.expect(1, "fill bare.off --candidates 2 -o bare-out.off");
    assert!(stderr.contains("no candidate"), "{stderr}");
}

/// Points of the whole vessel that lie inside the hole: a smooth fill goes through them.
#[test]
fn fills_pass_through_the_points_of_a_file() {
    let place = Place::new();
    place.expect(0, "sample vessel --resolution 90 --break disc -q -o in.ply --truth piece.ply");
    place.expect(0, "fill in.ply --method smooth -q -o plain.ply");
    let (piece, _) = geometry(&place.path("piece.ply"));
    let some: Vec<[f64; 3]> =
        piece.iter().step_by(piece.len() / 15).map(|p| p.map(f64::from_bits)).collect();
    let line = |p: &[f64; 3]| format!("{} {} {}\n", p[0], p[1], p[2]);
    std::fs::write(place.path("some.xyz"), some.iter().map(line).collect::<String>()).unwrap();
    place.expect(0, "fill in.ply --method smooth --points some.xyz -q -o through.ply");
    assert_kept(&place.path("in.ply"), &place.path("through.ply"));
    let off = |name: &str| {
        let (vertices, faces) = geometry(&place.path(name));
        let corners: Vec<DVec3> = vertices.iter().map(|p| p.map(f64::from_bits).into()).collect();
        let tree = Bvh::new(&corners, &faces);
        let of = |p: &[f64; 3]| tree.closest_point((*p).into(), f64::INFINITY).unwrap().distance;
        some.iter().map(of).fold(0.0, f64::max)
    };
    println!("{:.2e} {:.2e}", off("plain.ply"), off("through.ply"));
    assert!(off("through.ply") < 0.05 * off("plain.ply"));
    let text = "OFF\n1 0 0\n0 0 900\n";
    std::fs::write(place.path("far.off"), text).unwrap();
    let (_, stderr) = place.expect(4, "fill in.ply --points far.off -o none.ply");
    assert!(stderr.contains("point 0"), "{stderr}");
    place.expect(2, "fill in.ply --softness 0.1 -o none.ply");
}

/// A ball and a twin on each other: the twin serves.
#[test]
fn exemplars_are_kept_apart() {
    let place = Place::new();
    place.expect(0, "sample vessel --resolution 90 -q -o whole.ply");
    place.expect(0, "sample sphere --resolution 40 -q -o ball.ply");
    place.expect(0, "sample vessel --resolution 90 --break disc -q -o in.ply");
    let line = "fill in.ply --exemplar ball.ply --exemplar whole.ply --exemplar-only -q -o out.ply";
    place.expect(0, line);
    assert_kept(&place.path("in.ply"), &place.path("out.ply"));
    let off = worst_of_new(&place, "in.ply", "out.ply", "whole.ply");
    println!("{off:.3} edges");
    assert!(off < 0.05, "{off}");
}

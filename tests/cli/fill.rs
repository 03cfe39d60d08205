//! `fill`: what is written, reported and drawn.

use crate::place::{
    assert_kept, filled, geometry, hole_count, lines, open_octahedron, ply, Place, EIGHT,
    OCTAHEDRON,
};
use serde_json::Value;

#[test]
fn the_report_says_what_the_file_holds() {
    let place = Place::new();
    place.expect(0, "sample column --resolution 60 --break ragged -o in.ply --truth piece.ply");
    place.expect(0, "fill in.ply -o out.ply --method smooth --report r.json");
    let report = place.json("r.json");
    let ((v, f), (w, g)) = (geometry(&place.path("in.ply")), geometry(&place.path("out.ply")));
    assert_kept(&place.path("in.ply"), &place.path("out.ply"));
    assert_eq!(hole_count(&place.path("in.ply")), 1);
    assert_eq!(hole_count(&place.path("out.ply")), 0);

    assert_eq!(report["version"], env!("CARGO_PKG_VERSION"));
    assert_eq!(report["method"], "smooth");
    assert_eq!(report["input"]["path"], "in.ply");
    assert_eq!(report["output"]["path"], "out.ply");
    for (field, value) in [
        (&report["input"]["vertices"], v.len()),
        (&report["input"]["faces"], f.len()),
        (&report["output"]["vertices"], w.len()),
        (&report["output"]["faces"], g.len()),
        (&report["new_vertices"], w.len() - v.len()),
        (&report["new_faces"], g.len() - f.len()),
        (&report["holes_found"], 1),
        (&report["holes_filled"], 1),
    ] {
        assert_eq!(field.as_u64(), Some(value as u64), "{report:#}");
    }
    let seconds = |v: &Value| v.as_f64().filter(|s| (0.0..600.0).contains(s) && *s > 0.0);
    assert!(seconds(&report["fill_seconds"]).is_some(), "{report:#}");
    assert!(seconds(&report["fill_cpu_seconds"]).is_some(), "{report:#}");
    let hole = &report["holes"][0];
    assert_eq!(
        (&hole["id"], &hole["kind"], &hole["loops"]),
        (&0.into(), &"disc".into(), &1.into())
    );
    assert_eq!(hole["status"], "filled");
    assert_eq!(hole["new_faces"], report["new_faces"]);
    assert!(hole["reason"].is_null() && hole["fairing"].as_str().is_some_and(|f| f != "auto"));
    // The piece is a disc of radius 0.62, to 35 %, on the side of a column of radius about 1.
    let number = |name: &str| hole[name].as_f64().unwrap();
    assert!((0.8..1.9).contains(&number("diameter")), "{hole:#}");
    assert!(number("circumference") > 2.0 * number("diameter"), "{hole:#}");
    assert!((hole["centre"][1].as_f64().unwrap() - 2.4).abs() < 0.4, "{hole:#}");
    // The fill closes the piece's place: as many faces as were taken, to a factor of two.
    let piece = geometry(&place.path("piece.ply")).1.len() as f64;
    assert!((0.5..2.0).contains(&(hole["new_faces"].as_f64().unwrap() / piece)), "{hole:#}");
}

#[test]
fn selection_flags_fill_what_they_name() {
    let place = Place::new();
    place.expect(0, "sample sphere --resolution 60 --break several -o in.ply");
    let (stdout, _) = place.expect(0, "holes in.ply --json");
    let holes: Vec<Value> = lines(&stdout).into_iter().filter(|l| l["event"] == "hole").collect();
    assert_eq!(holes.len(), 5);
    let of = |keep: &dyn Fn(&Value) -> bool| -> Vec<u64> {
        holes.iter().filter(|h| keep(h)).map(|h| h["id"].as_u64().unwrap()).collect()
    };
    let number = |h: &Value, name: &str| h[name].as_f64().unwrap();
    let median = |name: &str| {
        let mut all: Vec<f64> = holes.iter().map(|h| number(h, name)).collect();
        all.sort_by(f64::total_cmp);
        all[2]
    };
    let largest = holes
        .iter()
        .max_by(|a, b| number(a, "circumference").total_cmp(&number(b, "circumference")))
        .unwrap();
    let [x, y, z] = [0, 1, 2].map(|k| holes[2]["centre"][k].as_f64().unwrap());
    let (edges, length, diameter) = (median("edges"), median("circumference"), median("diameter"));
    let cases = [
        ("--holes all".to_owned(), of(&|_| true)),
        ("--holes 1,3".to_owned(), vec![1, 3]),
        ("--holes all-but-largest".to_owned(), of(&|h| h["id"] != largest["id"])),
        (format!("--max-edges {edges}"), of(&|h| number(h, "edges") <= edges)),
        (
            format!("--max-length {}", 1.0001 * length),
            of(&|h| number(h, "circumference") <= 1.0001 * length),
        ),
        (
            format!("--max-diameter {}", 1.0001 * diameter),
            of(&|h| number(h, "diameter") <= 1.0001 * diameter),
        ),
        (format!("--near {x},{y},{z}"), vec![2]),
    ];
    for (flags, expected) in cases {
        place.expect(0, &format!("fill in.ply -o out.ply --report r.json {flags}"));
        assert_eq!(filled(&place.json("r.json")), expected, "{flags}");
        assert_eq!(hole_count(&place.path("out.ply")), 5 - expected.len(), "{flags}");
        assert_kept(&place.path("in.ply"), &place.path("out.ply"));
    }
}

#[test]
fn separate_and_joined_loops() {
    let place = Place::new();
    place.expect(0, "sample leg --resolution 80 --break ring -o in.ply");
    let kinds = |flags: &str| -> Vec<Value> {
        let (stdout, _) = place.expect(0, &format!("holes in.ply --json {flags}"));
        let all = lines(&stdout).into_iter();
        all.filter(|l| l["event"] == "hole").map(|h| h["kind"].clone()).collect()
    };
    assert_eq!(kinds(""), ["ring"]);
    assert_eq!(kinds("--separate-loops"), ["disc", "disc"]);
}

#[test]
fn the_output_may_be_the_input() {
    let place = Place::new();
    place.write("a.ply", &open_octahedron());
    place.write("b.ply", &open_octahedron());
    place.expect(0, "fill a.ply -o out.ply");
    place.expect(0, "fill b.ply -o b.ply");
    let read = |name| std::fs::read(place.path(name)).unwrap();
    assert_eq!(read("b.ply"), read("out.ply"));
    assert_eq!(hole_count(&place.path("b.ply")), 0);
    assert_eq!(place.names().len(), 3, "{:?}", place.names());
}

#[test]
fn a_closed_mesh_comes_back_byte_for_byte() {
    let place = Place::new();
    place.write("in.ply", &ply(&OCTAHEDRON, &EIGHT));
    let (stdout, _) = place.expect(0, "fill in.ply -o out.ply --report r.json");
    assert!(stdout.contains("no holes"), "{stdout}");
    let read = |name| std::fs::read(place.path(name)).unwrap();
    assert_eq!(read("in.ply"), read("out.ply"));
    assert_eq!(place.json("r.json")["holes_found"], 0);
}

#[test]
fn the_bytes_do_not_depend_on_the_threads() {
    let place = Place::new();
    place.expect(0, "sample torus --resolution 80 --break several -o in.ply");
    for n in [1, 2, 3] {
        place.expect(0, &format!("fill in.ply -o {n}.ply --threads {n} --picture {n}.png"));
    }
    let read = |name: &str| std::fs::read(place.path(name)).unwrap();
    for n in ["2", "3"] {
        assert!(read("1.ply") == read(&format!("{n}.ply")), "mesh on {n} threads");
        assert!(read("1.png") == read(&format!("{n}.png")), "picture on {n} threads");
    }
}

#[test]
fn the_picture_has_a_row_for_the_whole_and_one_for_each_hole() {
    let place = Place::new();
    place.expect(0, "sample sphere --resolution 40 --break several -o in.ply");
    let height = |flags: &str| {
        place.expect(0, &format!("fill in.ply -o out.ply --picture p.png {flags}"));
        let file = std::fs::File::open(place.path("p.png")).unwrap();
        let mut reader = png::Decoder::new(std::io::BufReader::new(file)).read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut pixels).unwrap().height
    };
    let (one, two, all) = (height("--holes 0"), height("--holes 0,1"), height(""));
    assert_eq!(two - one, (all - one) / 4);
}

#[test]
fn pipes_are_quiet() {
    let place = Place::new();
    place.write("in.ply", &open_octahedron());
    let (stdout, stderr) = place.expect(0, "fill in.ply -o out.ply");
    assert!(stdout.contains("filled 1 of 1 hole") && stdout.contains("out.ply"), "{stdout}");
    assert_eq!(stderr, "");
    assert!(!stdout.contains('\u{1b}') && !stdout.contains('\r'));
    assert_eq!(place.expect(0, "fill in.ply -o out.ply --quiet"), Default::default());
    let (stdout, stderr) = place.expect(3, "fill none.ply -o out.ply --quiet");
    assert!(stdout.is_empty() && stderr.starts_with("error: "));
}

#[test]
fn json_lines_parse_and_progress_rises() {
    let place = Place::new();
    place.expect(0, "sample sphere --resolution 60 --break several -o in.ply");
    let (stdout, stderr) = place.expect(0, "fill in.ply -o out.ply --json --report r.json");
    assert_eq!(stderr, "");
    let lines = lines(&stdout);
    let progress: Vec<f64> = lines
        .iter()
        .filter(|l| l["event"] == "progress")
        .map(|l| l["fraction"].as_f64().unwrap())
        .collect();
    assert!(progress.len() >= 2 && progress.windows(2).all(|w| w[0] <= w[1]), "{progress:?}");
    assert!(progress.iter().all(|f| (0.0..=1.0).contains(f)), "{progress:?}");
    // The last line is the report.
    let mut last = lines.last().unwrap().clone();
    assert_eq!(last["event"], "done");
    last.as_object_mut().unwrap().remove("event");
    assert_eq!(last, place.json("r.json"));
}

#[test]
fn the_ending_of_the_output_says_the_format() {
    let place = Place::new();
    place.write("in.ply", &open_octahedron());
    for name in ["out.obj", "out.stl", "out.off", "out.ply"] {
        place.expect(0, &format!("fill in.ply -o {name} --report r.json"));
        assert_eq!(hole_count(&place.path(name)), 0, "{name}");
        let report = place.json("r.json");
        let format = name[4..].to_uppercase();
        assert_eq!(
            (&report["input"]["format"], &report["output"]["format"]),
            (&"PLY".into(), &format.into())
        );
    }
    // What a format has no place for is told.
    let (_, told) = place.expect(0, "fill in.ply -o out.stl");
    assert!(
        told.contains("lost in the conversion to STL: the numbering of the vertices"),
        "{told}"
    );
    // Only PLY has a place for it.
    place.expect(3, "fill in.ply -o marked.obj --provenance");
    assert!(!place.path("marked.obj").exists());
}

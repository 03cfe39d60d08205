//! The real binary: exit codes, files, reports, JSON lines, Ctrl-C.
#![cfg(feature = "cli")]

use complete_mesh::intersect::Bvh;
use complete_mesh::io::Document;
use complete_mesh::sample::Sample;
use complete_mesh::{find_holes, Grouping, MeshView, Monitor};
use glam::DVec3;
use serde_json::Value;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use tempfile::TempDir;

/// A folder of its own, and the binary run in it.
struct Place(TempDir);

impl Place {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn command(&self, line: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_complete-mesh"));
        command.args(line.split_whitespace()).current_dir(self.0.path());
        command
    }

    fn run(&self, line: &str) -> Output {
        self.command(line).output().unwrap()
    }

    /// Runs it, expects the exit code, and returns stdout and stderr.
    fn expect(&self, code: i32, line: &str) -> (String, String) {
        let out = self.run(line);
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
        let (stdout, stderr) = (text(out.stdout), text(out.stderr));
        assert_eq!(out.status.code(), Some(code), "{line}\n{stdout}\n{stderr}");
        (stdout, stderr)
    }

    fn write(&self, name: &str, text: &str) {
        std::fs::write(self.path(name), text).unwrap();
    }

    fn names(&self) -> BTreeSet<String> {
        let entries = std::fs::read_dir(self.0.path()).unwrap();
        entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect()
    }

    fn json(&self, name: &str) -> Value {
        serde_json::from_slice(&std::fs::read(self.path(name)).unwrap()).unwrap()
    }
}

/// An ascii PLY.
fn ply(vertices: &[[f32; 3]], faces: &[[u32; 3]]) -> String {
    let mut text = format!(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\n\
         property float z\nelement face {}\nproperty list uchar int vertex_indices\nend_header\n",
        vertices.len(),
        faces.len()
    );
    vertices.iter().for_each(|[x, y, z]| text.push_str(&format!("{x} {y} {z}\n")));
    faces.iter().for_each(|[a, b, c]| text.push_str(&format!("3 {a} {b} {c}\n")));
    text
}

const OCTAHEDRON: [[f32; 3]; 6] = [
    [1.0, 0.0, 0.0],
    [-1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, -1.0, 0.0],
    [0.0, 0.0, 1.0],
    [0.0, 0.0, -1.0],
];
const EIGHT: [[u32; 3]; 8] =
    [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];

/// The octahedron without its first face: one hole, 0-2-4.
fn open_octahedron() -> String {
    ply(&OCTAHEDRON, &EIGHT[1..])
}

/// Positions (as bits) and triangles of a file.
fn geometry(path: &Path) -> (Vec<[u64; 3]>, Vec<[u32; 3]>) {
    let document = Document::read(path).unwrap();
    let (v, f) = (document.vertices(), document.faces());
    (
        (0..v.len()).map(|i| v.get(i).map(f64::to_bits)).collect(),
        (0..f.len()).map(|i| f.get(i)).collect(),
    )
}

fn hole_count(path: &Path) -> usize {
    let document = Document::read(path).unwrap();
    let mesh = MeshView::new(document.vertices(), document.faces());
    find_holes(mesh, &Grouping::Automatic, &Monitor::silent()).unwrap().holes.len()
}

/// The input's elements come first, bit for bit.
fn assert_kept(input: &Path, output: &Path) {
    let ((v, f), (w, g)) = (geometry(input), geometry(output));
    assert_eq!(v[..], w[..v.len()], "vertices");
    assert_eq!(f[..], g[..f.len()], "faces");
}

fn lines(stdout: &str) -> Vec<Value> {
    stdout.lines().map(|l| serde_json::from_str(l).unwrap_or_else(|e| panic!("{e}: {l}"))).collect()
}

/// Ids of the holes that the report says are filled.
fn filled(report: &Value) -> Vec<u64> {
    let holes = report["holes"].as_array().unwrap().iter();
    holes.filter(|h| h["status"] == "filled").map(|h| h["id"].as_u64().unwrap()).collect()
}

// --- exit codes -------------------------------------------------------------------------------

#[test]
fn help_and_version_are_no_errors() {
    let place = Place::new();
    let (stdout, _) = place.expect(0, "--version");
    assert_eq!(stdout.trim(), concat!("complete-mesh ", env!("CARGO_PKG_VERSION")));
    for line in ["--help", "fill --help", "holes --help", "demo --help", "sample --help"] {
        let (stdout, stderr) = place.expect(0, line);
        assert!(stdout.contains("Usage") && stderr.is_empty(), "{line}");
    }
}

#[test]
fn wrong_usage_is_2_and_writes_nothing() {
    let place = Place::new();
    place.write("in.ply", &open_octahedron());
    for line in [
        "",
        "fll in.ply",
        "fill in.ply",
        "fill in.ply -o out.ply --hoels all",
        "fill in.ply -o out.ply --method smoth",
        "fill in.ply -o out.ply --holes 1 --max-edges 9",
        "fill in.ply -o out.ply --edge-length 1 --edge-scale 1",
        "fill in.ply -o out.ply --report in.ply",
        "fill in.ply -o out.ply --report ./out.ply",
        "fill in.ply -o out.ply --picture x --report x",
        "fill in.ply -o out.ply --tint",
        "sample cube -o out.ply",
        "sample column -o out.ply --seed 2",
        "sample column -o out.ply --break disc --truth out.ply",
    ] {
        let (_, stderr) = place.expect(2, line);
        assert!(!stderr.is_empty(), "{line}");
        assert_eq!(place.names().len(), 1, "{line}: {:?}", place.names());
    }
    assert_eq!(std::fs::read_to_string(place.path("in.ply")).unwrap(), open_octahedron());
}

#[test]
fn file_errors_are_3_and_write_nothing() {
    let place = Place::new();
    place.write("in.ply", &open_octahedron());
    let text = open_octahedron();
    place.write("cut.ply", &text[..text.len() - 12]);
    place.write("mesh.xyz", "0 0 0\n");
    let before = place.names();
    for (line, word) in [
        ("fill missing.ply -o out.ply", "missing.ply"),
        ("fill cut.ply -o out.ply", "cut.ply"),
        ("fill mesh.xyz -o out.ply", "mesh.xyz"),
        ("fill in.ply -o out.xyz", "out.xyz"),
        ("fill in.ply -o no/such/folder/out.ply", "no/such/folder/out.ply"),
        ("fill in.ply -o out.ply --report no/such/folder/r.json", "r.json"),
        ("fill in.ply -o out.ply --picture no/such/folder/p.png", "p.png"),
        ("holes missing.ply", "missing.ply"),
        ("sample sphere --resolution 24 -o out.xyz", "out.xyz"),
        ("demo --out-dir in.ply", "in.ply"),
    ] {
        let (_, stderr) = place.expect(3, line);
        assert!(stderr.starts_with("error: ") && stderr.contains(word), "{line}: {stderr}");
        assert_eq!(place.names(), before, "{line}");
    }
}

#[test]
fn invalid_meshes_and_options_are_4_and_write_nothing() {
    let place = Place::new();
    place.write("in.ply", &open_octahedron());
    // In a binary file NaN is a number like any other; in text it is malformed.
    place.expect(0, "sample sphere --resolution 24 -o nan.ply");
    let mut bytes = std::fs::read(place.path("nan.ply")).unwrap();
    let body = bytes.windows(11).position(|w| w == b"end_header\n").unwrap() + 11;
    bytes[body + 12..body + 16].copy_from_slice(&f32::NAN.to_le_bytes());
    std::fs::write(place.path("nan.ply"), bytes).unwrap();
    place.write("empty.ply", &ply(&OCTAHEDRON, &[]));
    let before = place.names();
    for (line, word) in [
        ("fill nan.ply -o out.ply", "vertex 1"),
        ("fill empty.ply -o out.ply", "no faces"),
        ("fill in.ply -o out.ply --method warp --report r.json", "warp"),
        ("fill in.ply -o out.ply --method fragment", "fragment"),
        ("fill in.ply -o out.ply --holes 7", "hole 7"),
        ("fill in.ply -o out.ply --edge-scale 100", "100"),
        ("fill in.ply -o out.ply --max-length -1", "-1"),
        ("sample column -o out.ply --resolution 5", "resolution"),
        ("sample column -o out.ply --break disc --size 9", "size"),
    ] {
        let (_, stderr) = place.expect(4, line);
        assert!(stderr.starts_with("error: ") && stderr.contains(word), "{line}: {stderr}");
        assert_eq!(place.names(), before, "{line}");
    }
}

/// A sphere with two faces missing that share just one vertex, and one far away: the first two
/// rims touch.
fn touching() -> String {
    let mesh = Sample::Sphere.build(24).unwrap();
    let pole = mesh.vertices.len() as u32 - 1;
    let around: Vec<usize> =
        (0..mesh.faces.len()).filter(|&f| mesh.faces[f].contains(&pole)).collect();
    let first = around[0];
    let shared = |f: usize| mesh.faces[f].iter().filter(|v| mesh.faces[first].contains(v)).count();
    let second = around.iter().copied().find(|&f| shared(f) == 1).unwrap();
    let far = mesh.faces.len() / 2;
    let faces: Vec<[u32; 3]> = (0..mesh.faces.len())
        .filter(|f| ![first, second, far].contains(f))
        .map(|f| mesh.faces[f])
        .collect();
    ply(&mesh.vertices, &faces)
}

#[test]
fn a_hole_that_cannot_be_filled_is_1_or_is_skipped_when_asked() {
    let place = Place::new();
    place.write("in.ply", &touching());
    let (_, stderr) = place.expect(1, "fill in.ply -o out.ply --report r.json");
    assert!(stderr.contains("touch") && stderr.contains("--skip-unsafe"), "{stderr}");
    assert_eq!(place.names().len(), 1, "{:?}", place.names());

    let (_, stderr) = place.expect(0, "fill in.ply -o out.ply --report r.json --skip-unsafe");
    assert!(stderr.contains("left open"), "{stderr}");
    let report = place.json("r.json");
    assert_eq!(filled(&report).len(), 1);
    let unsafe_ones: Vec<&Value> =
        report["holes"].as_array().unwrap().iter().filter(|h| h["status"] == "unsafe").collect();
    assert!(!unsafe_ones.is_empty());
    assert!(unsafe_ones.iter().all(|h| h["reason"].as_str().unwrap().contains("touch")));
    assert_kept(&place.path("in.ply"), &place.path("out.ply"));
}

// --- fill -------------------------------------------------------------------------------------

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
    // of another mesh
    let (_, stderr) = place.expect(2, "fill in.ply --initial again.ply --holes 0 -o again.ply");
    assert!(stderr.contains("one file"), "{stderr}");
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

// --- terminals, pipes, machines ---------------------------------------------------------------

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
fn json_errors_have_the_exit_code() {
    let place = Place::new();
    place.write("in.ply", &open_octahedron());
    for (code, line) in [
        (3, "fill none.ply -o out.ply --json"),
        (4, "fill in.ply -o out.ply --json --method warp"),
        (4, "--json fill in.ply -o out.ply --holes 3"),
    ] {
        let (stdout, _) = place.expect(code, line);
        let last = lines(&stdout).pop().unwrap();
        assert_eq!((&last["event"], &last["code"]), (&"error".into(), &code.into()), "{line}");
        assert!(!last["message"].as_str().unwrap().is_empty());
    }
}

#[test]
fn a_reader_that_leaves_does_no_harm() {
    let place = Place::new();
    place.write("in.ply", &open_octahedron());
    for line in ["fill in.ply -o out.ply --json", "holes in.ply", "holes in.ply --json"] {
        let mut child = place.command(line).stdout(Stdio::piped()).spawn().unwrap();
        drop(child.stdout.take());
        assert_eq!(child.wait().unwrap().code(), Some(0), "{line}");
    }
}

#[test]
fn the_table_measures_a_known_hole() {
    let place = Place::new();
    place.write("in.ply", &open_octahedron());
    let (stdout, stderr) = place.expect(0, "holes in.ply");
    // Three edges of √2 each, in a mesh of edges of √2.
    assert!(stdout.contains("4.243 (3.0)"), "{stdout}");
    assert!(stdout.contains("6 vertices, 7 faces, mean edge 1.414"), "{stdout}");
    assert_eq!(stderr, "");
    let (stdout, _) = place.expect(0, "holes in.ply --json");
    let lines = lines(&stdout);
    let hole = lines.iter().find(|l| l["event"] == "hole").unwrap();
    assert_eq!((&hole["edges"], &hole["kind"]), (&3.into(), &"disc".into()));
    assert!((hole["circumference"].as_f64().unwrap() - 18f64.sqrt()).abs() < 1e-6);
    for k in 0..3 {
        assert!((hole["centre"][k].as_f64().unwrap() - 1.0 / 3.0).abs() < 1e-6);
    }
    assert_eq!(lines.last().unwrap()["holes"], 1);
}

#[test]
fn odd_meshes_are_warned_about_and_not_changed() {
    let place = Place::new();
    // One face turned over: three edges whose two faces run the same way, away from the hole.
    let mut faces = EIGHT[1..].to_vec();
    let turned = faces.iter().position(|f| *f == [3, 1, 5]).unwrap();
    faces[turned] = [1, 3, 5];
    place.write("in.ply", &ply(&OCTAHEDRON, &faces));
    let (stdout, stderr) = place.expect(0, "holes in.ply");
    assert!(stderr.contains("oriented against each other"), "{stdout}{stderr}");
    let (stdout, _) = place.expect(0, "holes in.ply --json");
    let last = lines(&stdout).pop().unwrap();
    let warning = &last["warnings"][0];
    assert_eq!(
        (&warning["kind"], &warning["count"]),
        (&"inconsistent-orientation".into(), &3.into())
    );
    assert_eq!(warning["elements"].as_array().unwrap().len(), 3);
}

#[cfg(unix)]
#[test]
fn ctrl_c_ends_with_130_and_leaves_nothing() {
    use std::io::{BufRead, BufReader, Read};
    let place = Place::new();
    place.expect(0, "sample column --resolution 500 --break several -o in.ply");
    let line = "fill in.ply -o out.ply --report r.json --picture p.png --json";
    let mut child =
        place.command(line).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    // The first line of progress: the library is at work.
    let mut stdout = BufReader::new(child.stdout.take().unwrap());
    let mut first = String::new();
    stdout.read_line(&mut first).unwrap();
    assert!(first.contains("progress"), "{first}");
    // SAFETY: sends a signal to a child that has not been waited for, so the id is its own.
    assert_eq!(unsafe { libc::kill(child.id() as libc::pid_t, libc::SIGINT) }, 0);
    let mut rest = String::new();
    stdout.read_to_string(&mut rest).unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(130), "{rest}");
    let last = lines(&rest).pop().unwrap();
    assert_eq!((&last["event"], &last["code"]), (&"error".into(), &130.into()));
    assert_eq!(place.names(), BTreeSet::from(["in.ply".to_owned()]));
}

// --- sample, demo -----------------------------------------------------------------------------

#[test]
fn samples_are_the_same_each_time_and_hold_what_they_promise() {
    let place = Place::new();
    for sample in Sample::ALL {
        let name = sample.name();
        place.expect(0, &format!("sample {name} --resolution 48 -o whole.ply"));
        assert_eq!(hole_count(&place.path("whole.ply")), 0, "{name}");
        let line = format!("sample {name} --resolution 120 --break ragged --seed 3");
        place.expect(0, &format!("{line} -o a.ply --truth t.ply"));
        place.expect(0, &format!("{line} -o b.ply"));
        let read = |name: &str| std::fs::read(place.path(name)).unwrap();
        assert!(read("a.ply") == read("b.ply"), "{name}");
        assert_eq!(hole_count(&place.path("a.ply")), 1, "{name}");
        assert!(!geometry(&place.path("t.ply")).1.is_empty());
    }
}

#[test]
fn the_demo_does_what_the_readme_says() {
    let place = Place::new();
    let (stdout, stderr) = place.expect(0, "demo --out-dir out/here");
    assert_eq!(stderr, "");
    for name in ["broken.ply", "completed.ply", "before_after.png"] {
        let path = place.path("out/here").join(name);
        assert!(path.metadata().unwrap().len() > 1000, "{name}");
        assert!(stdout.contains(name), "{stdout}");
    }
    let (broken, completed) =
        (place.path("out/here/broken.ply"), place.path("out/here/completed.ply"));
    assert_eq!((hole_count(&broken), hole_count(&completed)), (1, 0));
    assert_kept(&broken, &completed);
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
    // Only PLY has a place for it.
    place.expect(3, "fill in.ply -o marked.obj --provenance");
    assert!(!place.path("marked.obj").exists());
}

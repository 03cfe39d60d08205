//! Exit codes, and that nothing is written then.

use crate::place::{assert_kept, filled, lines, open_octahedron, ply, touching, Place, OCTAHEDRON};
use serde_json::Value;
use std::collections::BTreeSet;
use std::process::Stdio;

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
        "fill in.ply -o out.ply --picture x.jpg",
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
    place.write("mesh.3ds", "0 0 0\n");
    let before = place.names();
    for (line, word) in [
        ("fill missing.ply -o out.ply", "missing.ply"),
        ("fill cut.ply -o out.ply", "cut.ply"),
        ("fill mesh.3ds -o out.ply", "mesh.3ds"),
        ("fill in.ply -o out.3ds", "out.3ds"),
        ("fill in.ply -o no/such/folder/out.ply", "no/such/folder/out.ply"),
        ("fill in.ply -o out.ply --report no/such/folder/r.json", "r.json"),
        ("fill in.ply -o out.ply --picture no/such/folder/p.png", "p.png"),
        ("holes missing.ply", "missing.ply"),
        ("sample sphere --resolution 24 -o out.3ds", "out.3ds"),
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
        // Without faces it is a cloud.
        ("fill empty.ply -o out.ply", "6 points lie on no surface"),
        ("fill in.ply -o out.ply --method warp --scale 1,2 --report r.json", "warp"),
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

#[test]
fn json_errors_have_the_exit_code() {
    let place = Place::new();
    place.write("in.ply", &open_octahedron());
    for (code, line) in [
        (3, "fill none.ply -o out.ply --json"),
        (4, "fill in.ply -o out.ply --json --edge-scale 100"),
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

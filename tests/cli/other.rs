//! `holes`, `sample`, `demo`, help.

use crate::place::{
    assert_kept, geometry, hole_count, lines, open_octahedron, ply, Place, EIGHT, OCTAHEDRON,
};
use complete_mesh::sample::Sample;

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

//! Files without faces: point clouds.

use super::place::{assert_kept, geometry, lines, Place};
use complete_mesh::io::{Document, Format};
use complete_mesh::sample::{break_mesh, Break, BreakOptions, Sample};

/// A column with a hole, the faces dropped.
fn cloud(place: &Place, name: &str) -> usize {
    let whole = Sample::Column.build(120).unwrap();
    let options = BreakOptions { kind: Break::Disc, seed: 1, size: 0.8 };
    let broken = break_mesh(Sample::Column, &whole, &options).unwrap().mesh;
    let count = broken.vertices.len();
    let document = Document::from_mesh_f32(broken.vertices, Vec::new()).unwrap();
    let format = Format::from_path(name.as_ref()).unwrap();
    document.convert(format).unwrap().write(&place.path(name)).unwrap();
    count
}

#[test]
fn a_cloud_is_filled_where_a_mesh_would_be() {
    let place = Place::new();
    let count = cloud(&place, "in.ply");
    let (out, _) = place.expect(0, "fill in.ply -o out.ply --provenance --report r.json");
    assert!(out.contains("filled 1 of 1 hole") && out.contains("0 faces new"), "{out}");
    assert_kept(&place.path("in.ply"), &place.path("out.ply"));
    let (points, faces) = geometry(&place.path("out.ply"));
    let report = place.json("r.json");
    assert_eq!(report["new_vertices"].as_u64().unwrap() as usize, points.len() - count);
    assert!(points.len() > count + 20 && faces.is_empty());
    assert_eq!(report["holes"][0]["method"], "coherent");
    let header = std::fs::read(place.path("out.ply")).unwrap();
    let header = String::from_utf8_lossy(&header[..700]).into_owned();
    assert!(header.contains("property int source_point") && !header.contains("source_face"));
    // The same points as text.
    cloud(&place, "in.xyz");
    place.expect(0, "fill in.xyz -o out.xyz");
    assert_kept(&place.path("in.xyz"), &place.path("out.xyz"));
    assert_eq!(geometry(&place.path("out.xyz")).0, points);
}

#[test]
fn holes_of_a_cloud_are_listed() {
    let place = Place::new();
    let count = cloud(&place, "in.ply");
    let (out, _) = place.expect(0, "holes in.ply");
    assert!(out.contains(&format!("{count} points, no faces")) && out.contains("missing"), "{out}");
    let (out, _) = place.expect(0, "holes in.ply --json");
    let all = lines(&out);
    let of = |event: &str| all.iter().filter(|l| l["event"] == event).cloned().collect::<Vec<_>>();
    let (holes, done) = (of("hole"), of("done"));
    assert_eq!((holes.len(), done.len()), (1, 1));
    assert_eq!((&holes[0]["border"], &done[0]["points"]), (&false.into(), &count.into()));
    assert!(holes[0]["missing_points"].as_f64().unwrap() > 20.0, "{holes:?}");
    let probability = holes[0]["boundary_probability"].as_f64().unwrap();
    assert!((0.35..=1.0).contains(&probability), "{probability}");
    assert!(holes.iter().all(|h| h["agreed"] == true), "{holes:?}");
    assert!(holes[0]["boundary_loops"] == true && holes[0]["distance_field"] == true, "{holes:?}");
    assert_eq!(done[0]["only_distance_field"].as_array().map(Vec::len), Some(0));
    let (out, _) = place.expect(0, "holes in.ply");
    assert!(out.contains("mesh loops field"), "{out}");
}

/// A loop of the table's hole and a region around it give the same file as the hole that is found; the
/// report says what the detectors see.
#[test]
fn holes_of_a_cloud_are_given() {
    let place = Place::new();
    let count = cloud(&place, "in.ply");
    place.expect(0, "fill in.ply -o found.ply --method smooth --report r.json");
    let report = place.json("r.json");
    let hole = &report["holes"][0];
    assert!(hole["distance_field"] == true && hole["boundary_loops"] == true, "{hole}");
    assert!(hole["agreed"] == true && hole["border"] == false, "{hole}");
    let (out, _) = place.expect(0, "holes in.ply --json");
    let all = lines(&out);
    let listed = all.iter().find(|l| l["event"] == "hole").unwrap();
    let at = |k: usize| listed["centre"][k].as_f64().unwrap();
    let radius = listed["diameter"].as_f64().unwrap();
    let region = format!("{},{},{},{radius}", at(0), at(1), at(2));
    let rim = complete_mesh::find_point_holes(
        Document::read(&place.path("in.ply")).unwrap().vertices(),
        None,
        &complete_mesh::Options::default(),
        &complete_mesh::Monitor::silent(),
    );
    let rim = rim.unwrap().list.loops[0].vertices.iter().map(u32::to_string).collect::<Vec<_>>();
    let given = [format!("--region {region}"), format!("--loop {}", rim.join(","))];
    for flag in given {
        place.expect(0, &format!("fill in.ply -o given.ply --method smooth {flag}"));
        assert_eq!(geometry(&place.path("given.ply")), geometry(&place.path("found.ply")));
        let (out, _) = place.expect(0, &format!("holes in.ply {flag}"));
        assert!(out.contains("mesh loops field"), "{out}");
    }
    for (flag, words) in [
        ("--loop 1,2", "loop 0 has 2 points".to_owned()),
        ("--loop 1,2,1", "point 1 twice".to_owned()),
        (&format!("--loop 1,2,{count}"), format!("names point {count}")),
        ("--region 9,9,9,0.1", "region 0 has no rim of a gap within 0.1 of 9, 9, 9".to_owned()),
    ] {
        let (_, error) = place.expect(4, &format!("fill in.ply -o no.ply {flag}"));
        assert!(error.contains(&words), "{error}");
        assert!(place.expect(4, &format!("holes in.ply {flag}")).1.contains(&words));
    }
    place.expect(2, "holes in.ply --region 1,2,3");
    place.expect(2, "holes in.ply --loop 1,x");
    // A mesh has rims of its own.
    place.expect(0, "sample column -o mesh.ply --resolution 60");
    let (_, error) = place.expect(2, "holes mesh.ply --region 0,0,0,1");
    assert!(error.contains("take a point cloud"), "{error}");
    assert!(!place.names().contains("no.ply"));
}

/// A slit in a ball, two spacings wide: too narrow for contours of the distance field to meet in it.
#[test]
fn detectors_that_disagree_are_named() {
    let place = Place::new();
    let count = 3000;
    let golden = std::f64::consts::PI * (3.0 - 5f64.sqrt());
    let on_ball = |i: usize| {
        let z = 1.0 - (2 * i + 1) as f64 / count as f64;
        let (r, a) = ((1.0 - z * z).sqrt(), golden * i as f64);
        [r * a.cos(), r * a.sin(), z]
    };
    let in_slit = |p: &[f64; 3]| p[2].abs() < 0.077 && p[1].atan2(p[0]).abs() < 0.8;
    let rows = (0..count).map(on_ball).filter(|p| !in_slit(p));
    let text: String = rows.map(|p| format!("{} {} {}\n", p[0], p[1], p[2])).collect();
    place.write("in.xyz", &text);
    let words = "not seen by all detectors; they may be sparse places, or cracks (the first: 0, seen by: mesh loops)";
    let (out, _) = place.expect(0, "holes in.xyz --json");
    let all = lines(&out);
    let hole = all.iter().find(|l| l["event"] == "hole").unwrap();
    assert!(hole["agreed"] == false && hole["distance_field"] == false, "{hole}");
    assert!(hole["boundary_loops"] == true, "{hole}");
    let (_, told) = place.expect(0, "fill in.xyz -o out.xyz --method smooth --report r.json");
    assert!(told.contains(words), "{told}");
    let report = place.json("r.json");
    assert!(report["holes"][0]["agreed"] == false, "{report}");
    let warning = &report["warnings"][0];
    assert_eq!((&warning["kind"], &warning["count"]), (&"detectors-disagree".into(), &1.into()));
    assert_eq!(warning["elements"], serde_json::json!([0]));
}

/// The input comes back first all the same; the cleaned copy is a file of its own.
#[test]
fn a_cleaned_copy_is_completed_and_written() {
    let place = Place::new();
    let count = cloud(&place, "in.ply");
    let (bits, _) = geometry(&place.path("in.ply"));
    let mut all: Vec<[f64; 3]> = bits.iter().map(|p| p.map(f64::from_bits)).collect();
    for (i, p) in all.iter_mut().enumerate() {
        let wave = 1.0 + 4e-4 * ((i * 7919 % 1009) as f64 / 504.5 - 1.0);
        [p[0], p[2]] = [p[0] * wave, p[2] * wave];
    }
    all.push(all[40].map(|x| 1.3 * x + 0.2));
    let all: Vec<[f32; 3]> = all.iter().map(|p| p.map(|x| x as f32)).collect();
    Document::from_mesh_f32(all, Vec::new()).unwrap().write(&place.path("rough.ply")).unwrap();
    let (told, _) =
        place.expect(0, "fill rough.ply -o out.ply --clean --cleaned clean.ply --method smooth");
    let removed = told.lines().find_map(|l| l.strip_prefix("wrote clean.ply: ")).unwrap();
    let removed: usize = removed.split(' ').next().unwrap().parse().unwrap();
    // The outlier, and what the column has twice at its seams.
    assert!((1..20).contains(&removed), "{told}");
    assert_kept(&place.path("rough.ply"), &place.path("out.ply"));
    let (out, _) = geometry(&place.path("out.ply"));
    let (clean, _) = geometry(&place.path("clean.ply"));
    assert_eq!(clean.len(), out.len() - removed);
    assert!(!clean.contains(&out[count]), "the outlier is gone");
    let new = out.len() - count - 1;
    assert_eq!(clean[clean.len() - new..], out[count + 1..], "new points");
    assert!(clean.iter().filter(|p| !out.contains(p)).count() > count / 2);
    // Nothing is moved in no rounds.
    place.expect(0, "fill rough.ply -o out.ply --clean=0 --cleaned clean.xyz --method smooth");
    let (still, _) = geometry(&place.path("clean.xyz"));
    assert!(still[..count - 20].iter().all(|p| out.contains(p)));
    let (_, why) = place.expect(4, "fill rough.ply -o out.ply --clean=101");
    assert!(why.contains("101 rounds"), "{why}");
    place.expect(2, "fill rough.ply -o out.ply --cleaned clean.ply");
}

#[test]
fn what_takes_a_mesh_is_refused() {
    let place = Place::new();
    cloud(&place, "in.ply");
    let before = place.names();
    for (line, words) in [
        ("fill in.ply -o out.ply --picture p.png", "--picture takes a mesh"),
        ("fill in.ply -o out.ply --initial in.ply", "--initial"),
    ] {
        let (_, error) = place.expect(2, line);
        assert!(error.contains(words), "{error}");
    }
    place.write("line.xyz", "0 0 0\n1 1 1\n2 2 2\n3 3 3\n4 4 4\n");
    let (_, error) = place.expect(4, "fill line.xyz -o out.xyz");
    assert!(error.contains("all 5 points lie on one line"), "{error}");
    place.expect(4, "holes line.xyz");
    assert_eq!(place.names().len(), before.len() + 1);
}

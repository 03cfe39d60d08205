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

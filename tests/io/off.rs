//! OFF.

use super::*;
use complete_mesh::io::Extras;

const PLAIN: Extras = Extras { provenance: false };

fn read(text: &str) -> Document {
    Document::parse(text.as_bytes().to_vec(), Format::Off).unwrap()
}

fn text(d: &Document) -> String {
    String::from_utf8(d.to_bytes()).unwrap()
}

#[test]
fn colours_comments_and_face_colours_are_kept() {
    let file =
        "# first\nCOFF # with colours\n# counts\n5 4 0\n\n0 0 0 0 0 255 255\n1 0 0 254 0 255 255\n\
        1 1 0 254 0 255 255\n0 1 0 0 0 255 255 # corner\n.5 .5 .75 9 9 9 9\n\
        3 0 1 4 0.1 0.2\n3  1 2 4\n3 2 3 4 7\n3 3 0 4";
    let mut d = read(file);
    assert_eq!(text(&d), file);
    assert_eq!(d.vertex_colours().unwrap()[1], [254, 0, 255, 255]);
    d.append(&floor(), &PLAIN).unwrap();
    let expected = file
        .replace("\n5 4 0\n", "\n6 8 0\n")
        .replace("9 9 9 9\n", "9 9 9 9\n0.5 0.5 0 127 0 255 255\n")
        + "\n3 1 0 5 0.1 0.2\n3 2 1 5\n3 3 2 5 7\n3 0 3 5\n";
    assert_eq!(text(&d), expected);
    assert_whole(&d);
}

#[test]
fn normals_are_the_fills_own() {
    let rows: String =
        ROOF.iter().map(|p| format!("{} {} {} 0 0 -1\n", p[0], p[1], p[2])).collect();
    let file = format!("NOFF 5 4 0\r\n{}3 0 1 4\n3 1 2 4\n3 2 3 4\n3 3 0 4\n", rows);
    let mut d = read(&file);
    assert_eq!(text(&d), file);
    d.append(&floor(), &PLAIN).unwrap();
    assert!(text(&d).contains("0.5 0.5 0 0 0 -1\r\n"), "{}", text(&d));
    assert_whole(&d);
}

#[test]
fn polygons_stay() {
    let file = "OFF\n4 1 4\n2 0 0\n0 1 0\n0.5 0 0\n0 -1 0\n4 0 1 2 3 255 0 0\n";
    let d = read(file);
    assert!(faces(&d).len() == 2 && faces(&d).iter().all(|t| t.contains(&0) && t.contains(&2)));
    assert_eq!(text(&d), file);
}

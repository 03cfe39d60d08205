//! OBJ.

use super::*;
use complete_mesh::io::Extras;

const PLAIN: Extras = Extras { provenance: false };

fn read(text: &str) -> Document {
    Document::parse(text.as_bytes().to_vec(), Format::Obj).unwrap()
}

fn text(d: &Document) -> String {
    String::from_utf8(d.to_bytes()).unwrap()
}

/// Two materials, groups, an object, texture coordinates, a line that goes on after a backslash,
/// negative numbers, a comment that ends with a backslash, CR LF; the last line has no end.
const RICH: &str = "# made in C:\\models\\\r\nmtllib a b.mtl\r\no roof\r\n\
    v 0 0 0 1 0 0\r\nv 1.000 0 0 0 0 0\r\nv 1 1 0 0 0 0 # corner\r\nv 0 1 0 0 0.5 0\r\n\
    v .5 5e-1 0.75 \\\r\n 0 0 0\r\nvt 0.5 0.5\r\nvn 0 0 1\r\n\
    g east\r\nusemtl red\r\ns 1\r\nf 1/1/1 2/1/1 5/1/1\r\nf 2//1 3//1 -1//1\r\n\
    g  west wing\r\nusemtl blue\r\nl 1 2\r\nf 3 4 \\\r\n5\r\nf -2 1 5";

#[test]
fn a_rich_file_comes_back_and_only_grows() {
    let mut d = read(RICH);
    assert_eq!(text(&d), RICH);
    assert!(d.vertices().is_single());
    assert_eq!((vertices(&d), faces(&d)), (ROOF.to_vec(), ROOF_FACES.to_vec()));
    assert_eq!(d.vertex_colours().unwrap()[3], [0, 128, 0, 255]);
    d.append(&floor(), &PLAIN).unwrap();
    // The colour is the mean of the rim's. The faces at the east side take its group and
    // material; the object and the smoothing group are in force already.
    let expected = format!(
        "{RICH}\r\nv 0.5 0.5 0 0.25 0.125 0\r\ng east\r\nusemtl red\r\nf 2 1 6\r\nf 3 2 6\r\n\
         g  west wing\r\nusemtl blue\r\nf 4 3 6\r\nf 1 4 6\r\n"
    );
    assert_eq!(text(&d), expected);
    assert_whole(&d);
}

#[test]
fn digits_settle_the_precision() {
    let file = |x: &str| format!("v {x} 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    assert!(read(&file("0.123457")).vertices().is_single());
    let survey = read(&file("500123.123"));
    assert!(!survey.vertices().is_single());
    assert_eq!(survey.vertices().get(0)[0], 500123.123);
}

#[test]
fn polygons_are_cut_for_the_analysis_only() {
    let file = "v 2 0 0\nv 0 1 0\nv 0.5 0 0\nv 0 -1 0\nf 1 2 3 4\n";
    let d = read(file);
    assert!(faces(&d).len() == 2 && faces(&d).iter().all(|t| t.contains(&0) && t.contains(&2)));
    assert_eq!(text(&d), file);
}

#[test]
fn faces_may_come_before_their_vertices() {
    let d = read("f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n");
    assert_eq!(faces(&d), [[0, 1, 2]]);
}

#[test]
fn a_trailing_backslash_does_not_swallow_the_fill() {
    let rows: String = ROOF.iter().map(|p| format!("v {} {} {}\n", p[0], p[1], p[2])).collect();
    let mut d = read(&format!("{rows}f 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5 \\"));
    d.append(&floor(), &PLAIN).unwrap();
    assert_whole(&d);
}

#[test]
fn provenance_has_no_place_here() {
    let error = read(RICH).append(&floor(), &Extras { provenance: true }).unwrap_err();
    assert!(error.to_string().contains("write PLY"), "{error}");
}

/// The roof with texture coordinates and normals, vertex by vertex; the last number may differ.
fn textured(last: &str) -> String {
    let rows: String = ROOF.iter().map(|p| format!("v {} {} {}\n", p[0], p[1], p[2])).collect();
    let uv = "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvt 9 9\nvt 7 7\n";
    let normals = "vn 0 0 1\n".repeat(5);
    format!("{rows}{uv}{normals}f 1/1/1 2/2/2 5/5/5\nf 2/2/2 3/3/3 5/5/5\nf 3/3/3 4/4/4 5/5/5\nf 4/4/4 {last} -1/-2/-1\n")
}

#[test]
fn texture_and_normals_go_on_where_the_rim_has_one_value() {
    let file = textured("1/1/1");
    let mut d = read(&file);
    d.append(&floor(), &PLAIN).unwrap();
    // Harmonic texture coordinates; a normal on the side that the file's are on.
    let added = "v 0.5 0.5 0\nvt 0.5 0.5\nvn 0 0 1\nf 2/2/2 1/1/1 6/7/6\nf 3/3/3 2/2/2 6/7/6\n\
        f 4/4/4 3/3/3 6/7/6\nf 1/1/1 4/4/4 6/7/6\n";
    assert_eq!(text(&d), format!("{file}{added}"));
    assert_whole(&d);
}

#[test]
fn a_texture_seam_at_the_rim_stops_the_texture_only() {
    let file = textured("1/6/1");
    let mut d = read(&file);
    d.append(&floor(), &PLAIN).unwrap();
    let added = "v 0.5 0.5 0\nvn 0 0 1\nf 2//2 1//1 6//6\nf 3//3 2//2 6//6\nf 4//4 3//3 6//6\nf 1//1 4//4 6//6\n";
    assert_eq!(text(&d), format!("{file}{added}"));
}

#[test]
fn a_texture_number_that_names_nothing_is_not_followed() {
    let file = textured("1/1/1").replace("vt 7 7\n", "").replace("4/4/4", "4/99/4");
    let mut d = read(&file);
    d.append(&floor(), &PLAIN).unwrap();
    assert!(text(&d).ends_with("f 4//4 3//3 6//6\nf 1//1 4//4 6//6\n"), "{}", text(&d));
}

#[test]
fn materials_and_coordinates_are_read_by_triangle() {
    let d = read(RICH);
    let found = d.materials().unwrap();
    assert_eq!(found.libraries, ["a b.mtl"]);
    assert_eq!(found.names, ["red", "blue"]);
    // The first face alone has coordinates.
    assert_eq!(found.of_face, [0, 0, 1, 1]);
    assert_eq!(found.coordinates, [Some([[0.5, 0.5]; 3]), None, None, None]);
    let polygon = "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 0\nvt 0 0 7\nvt 2 0\nvt 2 1\nvt 0 1\n\
                   f 1/1 2/2 3/3\nusemtl a\nf 1/-4 3/-2 4/-1 2/9\n";
    let found = read(polygon).materials().unwrap();
    assert_eq!(found.of_face, [complete_mesh::result::NONE, 0, 0]);
    assert_eq!(found.coordinates[0], Some([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0]]));
    // A number beyond the last names nothing.
    assert!(found.coordinates[1..].iter().any(Option::is_none));
    assert!(read("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").materials().is_none());
}

#[test]
fn material_libraries_are_read() {
    use complete_mesh::io::Material;
    let text = "# made by hand\nKd 1 1 1\nnewmtl dark oak\n  Kd 0.5 .25 7 # brown\r\nmap_Kd \
                -blendu on -o 1 2 -mm 0 1 -s 2 oak bark.png\nnewmtl bare\nmap_Bump x.png\nnewmtl odd\n\
                Kd spectral x.rfl\nmap_Kd -unknown y.png\n";
    let found = Material::read_library(text.as_bytes());
    let of = |name: &str, colour, image: Option<&str>| Material {
        name: name.into(),
        colour,
        image: image.map(Into::into),
        scale: [1.0; 2],
        offset: [0.0; 2],
    };
    let oak = of("dark oak", Some([0.5, 0.25, 1.0]), Some("oak bark.png"));
    let expected = [
        Material { scale: [2.0, 1.0], offset: [1.0, 2.0], ..oak },
        of("bare", None, None),
        of("odd", None, Some("-unknown y.png")),
    ];
    assert_eq!(found, expected);
}

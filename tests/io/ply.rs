//! PLY.

use super::*;
use complete_mesh::io::Extras;
use proptest::prelude::*;

const PLAIN: Extras = Extras { provenance: false };
const PROVENANCE: Extras = Extras { provenance: true };

fn read(text: &str) -> Document {
    Document::parse(text.as_bytes().to_vec(), Format::Ply).unwrap()
}

fn text(d: &Document) -> String {
    String::from_utf8(d.to_bytes()).unwrap()
}

/// Colours, a label, a list, an unknown element between the two, comments and odd spacing.
const RICH: &str = "ply\r\nformat ascii 1.0\r\ncomment  kept  as it is\r\nobj_info 7\r\n\
    element vertex 5\r\nproperty float x\r\nproperty float y\r\nproperty float z\r\n\
    property uchar red\r\nproperty uchar green\r\nproperty uchar blue\r\nproperty int label\r\n\
    property list uchar short tags\r\nelement sensor 2\r\nproperty double t\r\n\
    element face 4\r\nproperty uchar flag\r\nproperty list uchar int vertex_indices\r\n\
    property list uchar float uv\r\nelement last 1\r\nproperty char c\r\nend_header\r\n\
    0 0 0 0 10 254 3 2 5 6\r\n1.0  0 0 100 10 0 3 0\r\n1e0 1 0 200 10 254 7 0\r\n\
    0 1 -0 100 10 0 7 1 9\r\n.5 0.50 +0.75 9 9 9 9 0\r\n\
    0.10000000000000001\r\nnan\r\n\
    1 3 0 1 4 2 0.5 0.25\r\n2 3 1 2 4 0\r\n3 3 2 3 4 0\r\n4 3 3 0 4 0\r\n-7\r\n";

#[test]
fn a_rich_file_comes_back_and_only_grows() {
    let mut d = read(RICH);
    assert_eq!(text(&d), RICH);
    assert!(d.vertices().is_single());
    assert_eq!(d.vertex_colours().unwrap()[2], [200, 10, 254, 255]);
    d.append(&floor(), &PLAIN).unwrap();
    // Colours are the mean of the rim's four; the label is one of the rim's, not 5; the list is
    // empty. Each new face has the flag of the face across the rim.
    let expected = RICH
        .replace("vertex 5", "vertex 6")
        .replace("element face 4", "element face 8")
        .replace("9 9 9 9 0\r\n", "9 9 9 9 0\r\n0.5 0.5 0 100 10 127 3 0\r\n")
        .replace(
            "4 3 3 0 4 0\r\n",
            "4 3 3 0 4 0\r\n1 3 1 0 5 0\r\n2 3 2 1 5 0\r\n3 3 3 2 5 0\r\n4 3 0 3 5 0\r\n",
        );
    assert_eq!(text(&d), expected);
    assert_whole(&d);
}

#[test]
fn provenance_adds_its_columns_and_changes_nothing_else() {
    let mut d = read(RICH);
    d.append(&floor(), &PROVENANCE).unwrap();
    let out = text(&d);
    assert!(out.contains(
        "short tags\r\nproperty uchar completed\r\nproperty int hole\r\nproperty int source_face\r\n\
         property float source_u\r\nproperty float source_v\r\nproperty int source\r\n\
         property float confidence\r\nelement sensor"
    ));
    for row in ["0 0 0 0 10 254 3 2 5 6", "1.0  0 0 100 10 0 3 0", ".5 0.50 +0.75 9 9 9 9 0"] {
        assert!(out.contains(&format!("\r\n{row} 0 -1 -1 0 0 -1 0\r\n")), "{out}");
    }
    assert!(out.contains("\r\n0.5 0.5 0 100 10 127 3 0 1 7 2 0.5 0.25 1 0.75\r\n"), "{out}");
    assert_whole(&d);

    // A second run finds the columns: old marks stay, new vertices get theirs.
    let mut again = d.clone();
    let mut second = floor();
    (second.input_vertex_count, second.input_face_count) = (6, 8);
    second.faces = vec![[1, 0, 6]];
    second.vertex_hole = vec![2];
    second.origins = vec![Origin::NOWHERE];
    again.append(&second, &PLAIN).unwrap();
    let rows: Vec<String> = text(&again).lines().map(str::to_owned).collect();
    assert!(
        rows.iter().any(|r| r.ends_with("3 0 1 7 2 0.5 0.25 1 0.75"))
            && rows.iter().any(|r| r.ends_with(" 1 2 -1 0 0 -1 0"))
    );
    assert_eq!(text(&again).matches("property int hole").count(), 1);
}

/// Scanners write a confidence, too: it goes on into a fill like any quantity, unless provenance
/// is asked for; and old values stay in any case.
#[test]
fn a_scanners_confidence_is_not_taken_for_ours() {
    let scan = RICH.replace("property int label", "property float confidence");
    let mut plain = read(&scan);
    plain.append(&floor(), &PLAIN).unwrap();
    assert!(!text(&plain).contains(" 0.75 0\r\n") && !text(&plain).contains("source"));
    let mut marked = read(&scan);
    marked.append(&floor(), &PROVENANCE).unwrap();
    let out = text(&marked);
    assert_eq!(out.matches(" confidence\r\n").count(), 1);
    assert!(out.contains("\r\n0.5 0.5 0 100 10 127 0.75 0 1 7 2 0.5 0.25 1\r\n"), "{out}");
    assert!(out.contains("\r\n0 0 0 0 10 254 3 2 5 6 0 -1 -1 0 0 -1\r\n"), "{out}");
}

#[test]
fn an_empty_completion_changes_no_byte() {
    let mut d = read(RICH);
    let mut nothing = floor();
    (nothing.vertices, nothing.faces, nothing.vertex_hole) = (vec![], vec![], vec![]);
    nothing.origins.clear();
    d.append(&nothing, &PLAIN).unwrap();
    assert_eq!(text(&d), RICH);
}

#[test]
fn normals_point_to_the_side_that_the_file_has() {
    // The floor's normal is -z by its faces' orientation. The second file has them all inward.
    for (up, expected) in [("0 0 -1", "0 0 -1"), ("0 0 1", "0 0 1")] {
        let rows: String =
            ROOF.iter().map(|p| format!("{} {} {} {up}\n", p[0], p[1], p[2])).collect();
        let faces: String =
            ROOF_FACES.iter().map(|f| format!("3 {} {} {}\n", f[0], f[1], f[2])).collect();
        let mut d = read(&format!(
            "ply\nformat ascii 1.0\nelement vertex 5\nproperty double x\nproperty double y\n\
             property double z\nproperty float nx\nproperty float ny\nproperty float nz\n\
             element face 4\nproperty list uchar uint vertex_index\nend_header\n{rows}{faces}"
        ));
        assert!(!d.vertices().is_single());
        d.append(&floor(), &PLAIN).unwrap();
        let new: Vec<f64> = text(&d)
            .lines()
            .find(|l| l.starts_with("0.5 0.5 0 "))
            .unwrap()
            .split(' ')
            .skip(3)
            .map(|w| w.parse().unwrap())
            .collect();
        let expected: Vec<f64> = expected.split(' ').map(|w| w.parse().unwrap()).collect();
        assert_eq!(new, expected);
    }
}

#[test]
fn strips_are_continued_in_the_same_list() {
    let header = |count, n: &str| {
        format!(
            "ply\nformat ascii 1.0\nelement vertex {count}\nproperty float x\nproperty float y\n\
             property float z\nelement tristrips {n}\nproperty list int int vertex_indices\nend_header\n"
        )
    };
    let rows = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n0.5 0.5 0.75\n";
    // The first strip turns its second triangle round; 4 4 joins without area.
    let strips = "0 1 4 2 -1 2 3 4 4 3 3 -1 3 0 4";
    let mut d = read(&format!("{}{rows}15 {strips}\n", header(5, "1")));
    assert_eq!(faces(&d), [[0, 1, 4], [4, 1, 2], [2, 3, 4], [3, 0, 4]]);
    d.append(&floor(), &PLAIN).unwrap();
    let added = "-1 1 0 5 -1 2 1 5 -1 3 2 5 -1 0 3 5";
    let expected = format!("{}{rows}0.5 0.5 0\n31 {strips} {added}\n", header(6, "1"));
    assert_eq!(text(&d), expected);
    assert_eq!(faces(&d)[4..], floor().faces);

    // A list whose count is a full byte has no room: the strips go into a row of their own.
    let long = "0 4".to_owned() + &" 4".repeat(249) + " -1 3 0 4";
    let short = header(5, "1").replace("list int", "list uchar");
    let mut d = read(&format!("{short}{rows}255 {long}\n"));
    let before = faces(&d).len();
    let mut completion = floor();
    completion.input_face_count = before;
    d.append(&completion, &PLAIN).unwrap();
    assert!(text(&d).ends_with(&format!("-1 3 0 4\n15 {}\n", &added[3..])), "{}", text(&d));
    assert!(text(&d).contains("element tristrips 2\n"));
}

#[test]
fn polygons_stay_and_are_cut_for_the_analysis() {
    let file = "ply\nformat ascii 1.0\nelement vertex 5\nproperty double x\nproperty double y\n\
        property double z\nelement face 2\nproperty list uchar int vertex_indices\nproperty int id\nend_header\n\
        2 0 0\n0 1 0\n0.5 0 0\n0 -1 0\n0 0 5\n4 0 1 2 3 11\n3 1 0 4 12";
    let mut d = read(file);
    let f = faces(&d);
    assert!(
        f.len() == 3
            && f[..2].iter().all(|t| t.contains(&0) && t.contains(&2))
            && f[2] == [1, 0, 4]
    );
    let mut fill = floor();
    (fill.input_face_count, fill.vertices, fill.vertex_hole) = (3, vec![], vec![]);
    fill.origins.clear();
    fill.faces = vec![[2, 1, 4], [1, 4, 0]];
    d.append(&fill, &PLAIN).unwrap();
    // The polygon's id for the face at its edge 1-2. The file's last line had no line end.
    assert!(text(&d).contains("\n4 0 1 2 3 11\n3 1 0 4 12\n3 2 1 4 11\n3 1 4 0 1"), "{}", text(&d));
}

#[test]
fn a_fill_that_the_layout_cannot_hold_is_refused() {
    let file = |xyz: &str, index: &str| {
        let rows: String = (0..300).map(|i| format!("{i} {} 0\n", i % 7)).collect();
        read(&format!(
            "ply\nformat ascii 1.0\nelement vertex 300\nproperty {xyz} x\nproperty {xyz} y\n\
             property {xyz} z\nelement face 1\nproperty list uchar {index} vertex_indices\nend_header\n\
             {rows}3 0 1 2\n"
        ))
    };
    let mut fill = floor();
    (fill.input_vertex_count, fill.input_face_count) = (300, 1);
    for (d, reason) in [
        (file("int", "int"), "not all float"),
        (file("float", "uchar"), "type ends at 255, but with the fill there are 301"),
    ] {
        let mut changed = d.clone();
        let error = changed.append(&fill, &PLAIN).unwrap_err().to_string();
        assert!(error.contains(reason), "{error}");
        assert_eq!(changed.to_bytes(), d.to_bytes());
    }
    let error = read(RICH).append(&fill, &PLAIN).unwrap_err().to_string();
    assert!(error.contains("made from 300 vertices and 1 faces, but there are 5 and 4"), "{error}");
}

#[test]
fn samples_are_binary_files() {
    let mut d = Document::from_mesh_f64(ROOF.to_vec(), ROOF_FACES.to_vec()).unwrap();
    let bytes = d.to_bytes();
    let header = bytes.windows(11).position(|w| w == b"end_header\n").unwrap() + 11;
    assert_eq!(bytes.len() - header, 5 * 24 + 4 * 13);
    d.append(&floor(), &PROVENANCE).unwrap();
    assert_whole(&d);
    let single = ROOF.map(|p| p.map(|x| x as f32));
    let d = Document::from_mesh_f32(single.to_vec(), ROOF_FACES.to_vec()).unwrap();
    assert!(d.vertices().is_single());
    assert_eq!((vertices(&d), faces(&d)), (ROOF.to_vec(), ROOF_FACES.to_vec()));
    assert!(Document::from_mesh_f64(ROOF.to_vec(), vec![[0, 1, 5]]).is_err());
}

/// A value type of the format and how this test writes a number in it.
#[derive(Debug, Clone, Copy)]
struct Type(&'static str, fn(f64) -> Vec<u8>);

const TYPES: [Type; 8] = [
    Type("char", |x| (x as i8).to_le_bytes().into()),
    Type("uint8", |x| (x as u8).to_le_bytes().into()),
    Type("short", |x| (x as i16).to_le_bytes().into()),
    Type("uint16", |x| (x as u16).to_le_bytes().into()),
    Type("int", |x| (x as i32).to_le_bytes().into()),
    Type("uint32", |x| (x as u32).to_le_bytes().into()),
    Type("float", |x| (x as f32).to_le_bytes().into()),
    Type("float64", |x| x.to_le_bytes().into()),
];

/// A random file: what stands where, as this test wrote it.
#[derive(Debug)]
struct Written {
    header: [String; 3],
    blocks: [Vec<u8>; 3],
    /// Bytes of a new vertex and of a new face in a binary file.
    new_sizes: [usize; 2],
    ascii: bool,
}

#[derive(Debug, Clone, Copy)]
enum Column {
    Position(usize),
    Corners,
    Scalar(usize),
    List(usize, usize),
}

/// Writes one element: its header lines, its rows, the binary size of a row with empty lists.
fn write_element(
    columns: &[Column],
    rows: usize,
    encoding: u8,
    double: bool,
    seed: &mut u64,
) -> (String, Vec<u8>, usize) {
    let position = if double { TYPES[7] } else { TYPES[6] };
    let (mut header, mut block, mut size) = (String::new(), Vec::new(), 0);
    for (i, c) in columns.iter().enumerate() {
        let line = match *c {
            Column::Position(axis) => format!("{} {}", position.0, ["x", "y", "z"][axis]),
            Column::Corners => "list uint8 int32 vertex_indices".into(),
            Column::Scalar(t) => format!("{} p{i}", TYPES[t].0),
            Column::List(n, t) => format!("list {} {} p{i}", TYPES[n].0, TYPES[t].0),
        };
        header += &format!("property {line}\n");
        size += match *c {
            Column::Position(_) => position.1(0.0).len(),
            Column::Corners => 13,
            Column::Scalar(t) => TYPES[t].1(0.0).len(),
            Column::List(n, _) => TYPES[n].1(0.0).len(),
        };
    }
    for row in 0..rows {
        let mut values: Vec<(Type, f64)> = Vec::new();
        for c in columns {
            *seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            let number = (*seed >> 57) as f64;
            match *c {
                Column::Position(axis) => values.push((position, ROOF[row][axis])),
                Column::Corners => {
                    values.push((TYPES[1], 3.0));
                    values.extend(ROOF_FACES[row].map(|v| (TYPES[4], v.into())));
                }
                Column::Scalar(t) => values.push((TYPES[t], number)),
                Column::List(n, t) => {
                    values.push((TYPES[n], (*seed >> 62) as f64));
                    values.extend((0..*seed >> 62).map(|k| (TYPES[t], number - k as f64)));
                }
            }
        }
        if encoding == 0 {
            let words: Vec<String> = values.iter().map(|(_, x)| x.max(0.0).to_string()).collect();
            block.extend(format!("{}\n", words.join(" ")).into_bytes());
        }
        for (t, x) in values.iter().filter(|_| encoding != 0) {
            let mut raw = t.1(*x);
            if encoding == 2 {
                raw.reverse();
            }
            block.extend(raw);
        }
    }
    (header, block, size)
}

fn columns() -> impl Strategy<Value = Vec<Column>> {
    let column = prop_oneof![
        (0..8usize).prop_map(Column::Scalar),
        (0..6usize, 0..8usize).prop_map(|(n, t)| Column::List(n, t)),
    ];
    proptest::collection::vec(column, 0..5)
}

prop_compose! {
    /// Extra columns anywhere among x, y, z and the corners, a third element, any encoding.
    fn random_file()(
        mut vertex in columns(), mut face in columns(), other in columns(),
        places in proptest::collection::vec(0..9usize, 4), encoding in 0..3u8, double: bool, mut seed: u64,
    ) -> Written {
        let mut at = places[0] % (vertex.len() + 1);
        for axis in 0..3 {
            vertex.insert(at, Column::Position(axis));
            at = (at + 1 + places[1] % 2).min(vertex.len());
        }
        face.insert(places[2] % (face.len() + 1), Column::Corners);
        let parts = [(vertex, 5), (face, 4), (other, places[3])]
            .map(|(c, n)| write_element(&c, n, encoding, double, &mut seed));
        let name = ["ascii", "binary_little_endian", "binary_big_endian"][encoding as usize];
        let [v, f, o] = parts;
        Written {
            header: [
                format!("ply\nformat {name} 1.0\nelement vertex "),
                format!("\n{}element face ", v.0),
                format!("\n{}element other {}\n{}end_header\n", f.0, places[3], o.0),
            ],
            blocks: [v.1, f.1, o.1],
            new_sizes: [v.2, f.2],
            ascii: encoding == 0,
        }
    }
}

impl Written {
    fn header(&self, vertices: usize, faces: usize) -> Vec<u8> {
        let [a, b, c] = &self.header;
        format!("{a}{vertices}{b}{faces}{c}").into_bytes()
    }

    fn file(&self) -> Vec<u8> {
        [self.header(5, 4), self.blocks.concat()].concat()
    }
}

proptest! {
    /// Whatever the layout: the same bytes when nothing is added; otherwise every old row with
    /// its bits, in its place, and rows of the right size between them.
    #[test]
    fn any_layout_keeps_its_rows(written in random_file()) {
        let file = written.file();
        let mut d = Document::parse(file.clone(), Format::Ply).unwrap();
        prop_assert_eq!(vertices(&d), ROOF.to_vec());
        prop_assert_eq!(faces(&d), ROOF_FACES.to_vec());
        prop_assert_eq!(d.to_bytes(), file);
        d.append(&floor(), &PLAIN).unwrap();
        assert_whole(&d);

        let out = d.to_bytes();
        let mut rest = out.as_slice();
        for part in [written.header(6, 8), written.blocks[0].clone()] {
            prop_assert!(rest.starts_with(&part));
            rest = &rest[part.len()..];
        }
        prop_assert!(rest.ends_with(&written.blocks[2]));
        rest = &rest[..rest.len() - written.blocks[2].len()];
        let new_vertex = if written.ascii {
            rest.iter().position(|&c| c == b'\n').unwrap() + 1
        } else {
            written.new_sizes[0]
        };
        rest = &rest[new_vertex..];
        prop_assert!(rest.starts_with(&written.blocks[1]));
        rest = &rest[written.blocks[1].len()..];
        if written.ascii {
            prop_assert_eq!(rest.iter().filter(|&&c| c == b'\n').count(), 4);
        } else {
            prop_assert_eq!(rest.len(), 4 * written.new_sizes[1]);
        }
    }

    /// With provenance the rows get longer, and what they held is still there.
    #[test]
    fn any_layout_takes_provenance(written in random_file()) {
        let mut d = Document::parse(written.file(), Format::Ply).unwrap();
        d.append(&floor(), &PROVENANCE).unwrap();
        assert_whole(&d);
        let added = [written.header(6, 8).len(), 5 + 7 + 7, 4].iter().sum::<usize>();
        prop_assert!(d.to_bytes().len() > added + written.blocks.concat().len());
        prop_assert!(d.to_bytes().ends_with(&written.blocks[2]));
    }
}

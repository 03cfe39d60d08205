//! Point files: the input's bytes come back first, and new points carry all that the others do.

use super::{floor, refusal, vertices, ROOF};
use complete_mesh::io::{Document, Extras, Format, IoError};
use complete_mesh::{Origin, PointCompletion};

/// One new point in the middle of the roof's square.
fn middle() -> PointCompletion {
    let mut completion = floor();
    completion.input_face_count = 0;
    completion.origins[0] =
        Origin { face: u32::MAX, barycentric: [0.0; 3], ..completion.origins[0] };
    PointCompletion {
        completion,
        normals: vec![[0.0, 0.0, -1.0]],
        source_points: vec![4],
        values: Vec::new(),
        copied: Default::default(),
        cleaned: None,
        found: Default::default(),
    }
}

/// The document after [`middle`] was added.
fn added(bytes: &[u8], format: Format, provenance: bool) -> Document {
    let mut d = Document::parse(bytes.to_vec(), format).unwrap();
    assert!(d.is_cloud());
    assert_eq!(vertices(&d), ROOF);
    d.append_points(&middle(), &Extras { provenance }).unwrap();
    let mut all = ROOF.to_vec();
    all.push([0.5, 0.5, 0.0]);
    assert_eq!(vertices(&d), all);
    d
}

fn text(d: &Document) -> String {
    String::from_utf8(d.to_bytes()).unwrap()
}

const XYZ: &str = "# a scan\n0 0 0\n1 0 0\n1 1 0\n0 1.0 0\n.5 .5 75e-2\n";

#[test]
fn xyz_gets_a_line_a_point() {
    assert_eq!(text(&added(XYZ.as_bytes(), Format::Xyz, false)), format!("{XYZ}0.5 0.5 0\n"));
    // Without an end of the last line, with commas, and with the count that PTS has.
    let bare = XYZ.trim_end();
    assert_eq!(text(&added(bare.as_bytes(), Format::Xyz, false)), format!("{bare}\n0.5 0.5 0\n"));
    let commas = XYZ.replace(' ', ",").replace("#,a,scan", "x,y,z");
    let whole = text(&added(commas.as_bytes(), Format::Xyz, false));
    assert_eq!(whole, format!("{commas}0.5,0.5,0\n"));
    let rows: String = XYZ.lines().skip(1).map(|l| format!("{l}\r\n")).collect();
    let whole = text(&added(format!("5\r\n{rows}").as_bytes(), Format::Xyz, false));
    assert_eq!(whole, format!("6\r\n{rows}0.5 0.5 0\r\n"));
}

/// Colours (whole numbers), an intensity and normals, which are told by their length.
#[test]
fn further_columns_of_xyz_are_carried_on() {
    let rows = "0 0 0 100 0 7 0.5 0 0 1\n1 0 0 100 0 7 0.5 0 0.6 0.8\n1 1 0 200 0 7 0.5 1 0 0\n\
                0 1 0 200 0 7 0.5 0 0 1\n.5 .5 .75 9 9 9 9 0 0 1\n";
    let d = added(rows.as_bytes(), Format::Xyz, false);
    let new = text(&d)[rows.len()..].to_owned();
    // The mean of the rim.
    assert_eq!(new, "0.5 0.5 0 150 0 7 0.5 0 0 -1\n");
    assert_eq!(d.vertex_normals().unwrap()[1], [0.0, 0.6, 0.8]);
    assert_eq!(Document::parse(XYZ.into(), Format::Xyz).unwrap().vertex_normals(), None);
}

#[test]
fn a_broken_xyz_is_refused_with_the_line() {
    for (bad, words) in [
        ("0 0 0\n1 2\n", "line 2: point 1 has 2 numbers"),
        ("0 0 0\n1 nan 2\n", "line 2: the coordinate \"nan\" is not finite"),
        ("0 0 0\n1 x 2\n", "line 2: \"x\" is not a number"),
        ("3\n0 0 0\n1 0 0\n", "says 3 points, but there are 2"),
    ] {
        let error = refusal(bad.as_bytes(), Format::Xyz);
        assert!(error.contains(words), "{error}");
    }
}

/// A PCD header with a packed colour, normals and an intensity.
fn pcd(data: &str, width: usize, height: usize) -> String {
    format!(
        "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\n\
         FIELDS x y z rgb normal_x normal_y normal_z label\nSIZE 4 4 4 4 4 4 4 2\n\
         TYPE F F F U F F F I\nCOUNT 1 1 1 1 1 1 1 1\nWIDTH {width}\nHEIGHT {height}\n\
         VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 5\nDATA {data}\n"
    )
}

#[test]
fn ascii_pcd_gets_a_row_and_new_counts() {
    let row = |p: &[f64; 3]| format!("{} {} {} 657930 0 0 1 -3\n", p[0], p[1], p[2]);
    let rows: String = ROOF.iter().map(row).collect();
    let d = added((pcd("ascii", 1, 5) + &rows).as_bytes(), Format::Pcd, false);
    let counted = pcd("ascii", 6, 1).replace("POINTS 5", "POINTS 6");
    assert_eq!(text(&d), format!("{counted}{rows}0.5 0.5 0 657930 0 0 -1 -3\n"));
    assert_eq!(d.vertex_colours().unwrap()[5], [10, 10, 10, 255]);
    assert_eq!(d.vertex_normals().unwrap()[5], [0.0, 0.0, -1.0]);
}

#[test]
fn binary_pcd_gets_a_row_and_new_counts() {
    let row = |p: [f64; 3], rgb: u32, normal: f32| {
        let mut bytes: Vec<u8> = p.iter().flat_map(|&x| (x as f32).to_le_bytes()).collect();
        bytes.extend(rgb.to_le_bytes());
        [0.0, 0.0, normal].iter().for_each(|x: &f32| bytes.extend(x.to_le_bytes()));
        bytes.extend((-3i16).to_le_bytes());
        bytes
    };
    let rgb = |i: usize| if i < 2 { 0x10_20_30 } else { 0x30_20_10 };
    let rows: Vec<u8> = (0..5).flat_map(|i| row(ROOF[i], rgb(i), 1.0)).collect();
    let mut bytes = pcd("binary", 1, 5).into_bytes();
    bytes.extend(&rows);
    let d = added(&bytes, Format::Pcd, false);
    let mut whole = pcd("binary", 6, 1).replace("POINTS 5", "POINTS 6").into_bytes();
    whole.extend(&rows);
    whole.extend(row([0.5, 0.5, 0.0], 0x20_20_20, -1.0));
    assert_eq!(d.to_bytes(), whole);
    let cut = refusal(&bytes[..bytes.len() - 1], Format::Pcd);
    assert!(cut.contains("cut off at point 4 of 5"), "{cut}");
}

/// Fields one after the other, packed: the same points as in a binary file, which is what is written.
#[test]
fn compressed_pcd_is_read_as_the_binary_one() {
    let head =
        |data: &str| pcd(data, 1, 5).replace("COUNT 1 1 1 1 1 1 1 1", "COUNT 1 1 1 1 1 1 1 3");
    let place = |i: usize, axis: usize| (ROOF[i][axis] as f32).to_le_bytes().to_vec();
    let labels = |i: usize| (0..3).flat_map(|k| (100 * i as i16 - k).to_le_bytes()).collect();
    let field = |f: usize, i: usize| -> Vec<u8> {
        match f {
            0..=2 => place(i, f),
            3 => (0x10_20_30 + i as u32).to_le_bytes().to_vec(),
            4..=6 => f32::from(u8::from(f == 6)).to_le_bytes().to_vec(),
            _ => labels(i),
        }
    };
    let mut binary = head("binary").into_bytes();
    binary.extend((0..5).flat_map(|i| (0..8).flat_map(move |f| field(f, i))));
    let columns: Vec<u8> = (0..8).flat_map(|f| (0..5).flat_map(move |i| field(f, i))).collect();
    let mut data = vec![0; 1000];
    let count = lzf_rust::compress(&columns, &mut data).unwrap();
    data.truncate(count);
    let pack = |sizes: [usize; 2], data: &[u8]| {
        let mut bytes = head("binary_compressed").into_bytes();
        sizes.iter().for_each(|&n| bytes.extend((n as u32).to_le_bytes()));
        bytes.extend(data);
        bytes
    };
    let packed = pack([data.len(), columns.len()], &data);
    let d = Document::parse(packed.clone(), Format::Pcd).unwrap();
    assert_eq!(d.to_bytes(), binary);
    let one = added(&packed, Format::Pcd, false).to_bytes();
    assert_eq!(one, added(&binary, Format::Pcd, false).to_bytes());
    for (bytes, words) in [
        (packed[..packed.len() - 1].to_vec(), "cut off at byte"),
        (pack([data.len(), columns.len() + 1], &data), "are not 5 points of 34"),
        (pack([data.len(), columns.len()], &vec![0xff; data.len()]), "damaged"),
        (head("binary_compressed").into_bytes(), "cut off before"),
    ] {
        let error = refusal(&bytes, Format::Pcd);
        assert!(error.contains(words), "{error}");
    }
}

#[test]
fn a_broken_pcd_header_is_refused() {
    for (from, to, words) in [
        ("DATA ascii", "DATA zipped", "write ascii, binary or binary_compressed"),
        ("POINTS 5", "POINTS 6", "are not 6 points"),
        ("SIZE 4", "SIZE 3", "do not fit"),
        ("x y z", "x y w", "not all there"),
        ("WIDTH 1", "WIDTH one", "WIDTH\" takes a number"),
        ("DATA ascii\n", "", "no line DATA"),
    ] {
        let error = refusal(pcd("ascii", 1, 5).replace(from, to).as_bytes(), Format::Pcd);
        assert!(error.contains(words), "{error}");
    }
}

const PLY: &str = "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\n\
    property float z\nproperty float nx\nproperty float ny\nproperty float nz\n\
    property uchar red\nend_header\n";

#[test]
fn ply_gets_normals_colours_and_provenance() {
    let rows: Vec<String> =
        ROOF.iter().map(|p| format!("{} {} {} 0 0 1 40", p[0], p[1], p[2])).collect();
    let file = format!("{PLY}{}\n", rows.join("\n"));
    let d = added(file.as_bytes(), Format::Ply, false);
    let counted = PLY.replace("vertex 5", "vertex 6");
    // The floor's faces look up, as the input's normals do.
    assert_eq!(text(&d), format!("{counted}{}\n0.5 0.5 0 0 0 1 40\n", rows.join("\n")));
    let d = added(file.as_bytes(), Format::Ply, true);
    let columns = "property uchar completed\nproperty int hole\nproperty int source_point\n\
                   property int source\nproperty float confidence\nend_header";
    let counted = counted.replace("end_header", columns);
    let old: String = rows.iter().map(|r| format!("{r} 0 -1 -1 -1 0\n")).collect();
    assert_eq!(text(&d), format!("{counted}{old}0.5 0.5 0 0 0 1 40 1 7 4 1 0.75\n"));
}

#[test]
fn what_has_no_place_is_an_error() {
    for (bytes, format, provenance) in [
        (XYZ.to_owned(), Format::Xyz, true),
        ("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv .5 .5 .75\n".to_owned(), Format::Obj, false),
    ] {
        let mut d = Document::parse(bytes.clone().into_bytes(), format).unwrap();
        let error = d.append_points(&middle(), &Extras { provenance }).unwrap_err();
        assert!(matches!(error, IoError::Unsupported { .. }), "{error}");
        assert!(error.to_string().contains("write PLY"), "{error}");
        assert_eq!(text(&d), bytes);
    }
    let cloud = Document::parse(XYZ.into(), Format::Xyz).unwrap();
    assert!(cloud.convert(Format::Pcd).is_err());
    assert_eq!(vertices(&cloud.convert(Format::Ply).unwrap()), ROOF);
    let ply = format!("{PLY}{}", "0 0 0 0 0 1 40\n".repeat(5));
    let xyz = Document::parse(ply.into_bytes(), Format::Ply).unwrap().convert(Format::Xyz).unwrap();
    assert_eq!(text(&xyz), "0 0 0\n".repeat(5));
}

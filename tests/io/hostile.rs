//! Files that are cut off, lie or mean harm: an error that says where, never a panic, never a
//! reservation that the bytes do not justify.

use super::*;
use complete_mesh::io::Extras;
use proptest::prelude::*;
use Format::{Obj, Off, Ply, Stl};

const XYZ: &str = "property float x\nproperty float y\nproperty float z\n";

/// An ascii PLY of three vertices with the given face part of the header and the given rows.
fn ply(face: &str, rows: &str) -> String {
    format!("ply\nformat ascii 1.0\nelement vertex 3\n{XYZ}{face}\nend_header\n0 0 0\n1 0 0\n0 1 0\n{rows}")
}

const FACE: &str = "element face 1\nproperty list uchar int vertex_indices";

/// A binary PLY whose header claims these counts, with `size` bytes of rows.
fn claims(vertices: &str, faces: &str, size: usize) -> Vec<u8> {
    let header = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex {vertices}\n{XYZ}\
         element face {faces}\nproperty list uchar int vertex_indices\nend_header\n"
    );
    [header.into_bytes(), vec![0; size]].concat()
}

#[test]
fn broken_files_are_refused_with_the_reason() {
    let obj = |faces: &str| format!("v 0 0 0\nv 1 0 0\nv 0 1 0\n{faces}\n");
    let table: Vec<(Format, Vec<u8>, &str)> = vec![
        // Headers.
        (Ply, b"".into(), "line 1: the file does not begin with the line \"ply\""),
        (Ply, b"plyx\n".into(), "does not begin with the line"),
        (Ply, b"ply\nformat ascii 1.0\n".into(), "line 3: the header has no line \"end_header\""),
        (Ply, b"ply\nend_header\n".into(), "no \"format\" line"),
        (Ply, b"ply\nformat ascii 2.0\n".into(), "line 2: the version \"2.0\" is not 1.0"),
        (Ply, b"ply\nformat utf8 1.0\n".into(), "the format \"utf8\" is unknown"),
        (Ply, b"ply\nformat ascii 1.0\nproperty int x\n".into(), "line 3: a property comes before"),
        (Ply, b"ply\nformat ascii 1.0\nelement vertex\n".into(), "needs a name and a count"),
        (Ply, b"ply\nformat ascii 1.0\nelement vertex -3\n".into(), "the count \"-3\" is not"),
        (Ply, b"ply\nformat ascii 1.0\nelement vertex 99999999999999999999\n".into(), "is not a whole number"),
        (Ply, b"ply\nformat ascii 1.0\nelement face 1\nelement face 1\n".into(), "line 4: the element \"face\" comes twice"),
        (Ply, b"ply\nformat ascii 1.0\nelement vertex 1\nproperty quad x\n".into(), "the type \"quad\" is unknown"),
        (Ply, b"ply\nformat ascii 1.0\nelement vertex 1\nproperty float\n".into(), "the property has no name"),
        (Ply, b"ply\nformat ascii 1.0\nelement vertex 1\nproperty list float int a\n".into(), "count of a list is of a float type"),
        (Ply, b"ply\nformat ascii 1.0\nelement vertex 1\nproperty list list int a\n".into(), "a list of lists"),
        (Ply, b"ply\nformat ascii 1.0\nwhat\x1b[2J\n".into(), "\"what\\x1b[2J\" is not a header keyword"),
        (Ply, b"ply\nformat ascii 1.0\nend_header\n".into(), "no element \"vertex\""),
        (Ply, b"ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nend_header\n".into(), "needs the scalar properties x, y and z"),
        (Ply, ply("element face 1\nproperty int a", "1\n").into(), "needs a list vertex_indices"),
        (Ply, ply("element face 1\nproperty list uchar float vertex_indices", "3 0 1 2\n").into(), "not a list of integers"),
        // Rows.
        (Ply, ply(FACE, "").into(), "cannot be in the 0 bytes that are left"),
        (Ply, ply(FACE, "3 0 1\n").into(), "line 13: face 0 of 1 (counted from 0): the line has too few numbers"),
        (Ply, ply(FACE, "3 0 1 2 5\n").into(), "line 13: face 0 of 1 (counted from 0): the line has more numbers than the header says: \"5\""),
        (Ply, ply(FACE, "3 0 1 3\n").into(), "it names vertex 3, but there are only 3"),
        (Ply, ply(FACE, "3 0 1 -1\n").into(), "it names vertex -1"),
        (Ply, ply(FACE, "3 0 1 1.5\n").into(), "\"1.5\" is not a whole number"),
        (Ply, ply(FACE, "0\n3 0 1 2\n").into(), "a face with 0 corners"),
        (Ply, ply(FACE, "1 0\n").into(), "a face with 1 corners"),
        (Ply, ply(FACE, "2 0 1\n").into(), "a face with 2 corners; from 3 to"),
        (Ply, ply(FACE, "-3 0 1 2\n").into(), "a list has the count -3"),
        (Ply, ply(FACE, "4000000000 0 1 2\n").into(), "a face with 4000000000 corners"),
        (Ply, ply(FACE, "3 0 1 2\n3 0 1 2\n").into(), "8 more bytes follow the last element; a count is too small"),
        (Ply, ply("element a 1\nproperty list int int b", "999999999 1\n").into(), "a 0 of 1 (counted from 0): the line has too few"),
        (Ply, ply("", "").replace("1 0 0", "1 nan 0").into(), "line 10: vertex 1 of 3 (counted from 0): the coordinate NaN is not finite"),
        (Ply, ply("", "").replace("1 0 0", "1 x 0").into(), "\"x\" is not a number"),
        (Ply, ply("", "").replace("1 0 0", "1 1e99 0").into(), "the coordinate inf is not finite"),
        // Counts that the bytes belie. None of these may reserve what it claims.
        (Ply, claims("4294967295", "0", 60), "4294967295 rows of element \"vertex\" cannot be in the 60 bytes that are left"),
        (Ply, claims("18446744073709551615", "0", 60), "more than 32-bit indices can name"),
        (Ply, claims("5", "18446744073709551615", 60 + 52), "rows of element \"face\" cannot be"),
        (Ply, claims("5", "52", 60 + 52), "face 0 of 52 (counted from 0): a face with 0 corners"),
        (Ply, claims("5", "0", 60 + 52), "52 more bytes follow"),
        (Ply, [claims("5", "1", 60), vec![200, 0, 0]].concat(), "the file ends here; it is cut off"),
        (Ply, ply("element face 999999999\nproperty list uchar int vertex_indices", "3 0 1 2\n").into(), "cannot be in the 8 bytes"),
        // OBJ.
        (Obj, b"".into(), "there is no \"v\" line"),
        (Obj, b"\x89PNG\r\n\x1a\n".into(), "there is no \"v\" line"),
        (Obj, b"v 0 0\n".into(), "line 1: vertex 1 has fewer than 3 numbers"),
        (Obj, b"v 0 0 zero\n".into(), "\"zero\" is not a number"),
        (Obj, b"v 0 0 nan\n".into(), "the coordinate \"nan\" is not finite"),
        (Obj, obj("f 0 1 2").into(), "line 4: \"0\" is not a vertex number (they begin with 1)"),
        (Obj, obj("f 1 2 4\nf 1 2 3").into(), "line 4: the face names vertex 4, but there are only 3"),
        (Obj, obj("f 1 2 -4").into(), "line 4: \"-4\" names no vertex: 3 were read so far"),
        (Obj, obj("f 1 2 99999999999").into(), "\"99999999999\" names no vertex"),
        (Obj, obj("f 1 2 9223372036854775808").into(), "is not a vertex number"),
        (Obj, obj("f 1 2 -9223372036854775808").into(), "names no vertex"),
        (Obj, obj("f 1/1 2/1").into(), "a face with 2 corners"),
        (Obj, obj("f").into(), "a face with 0 corners"),
        (Obj, obj("f 1 2 x").into(), "\"x\" is not a vertex number"),
        // OFF.
        (Off, b"".into(), "the file is empty"),
        (Off, b"COF\n".into(), "does not begin with the word \"OFF\""),
        (Off, b"4OFF\n1 0 0\n0 0 0 0\n".into(), "not in three dimensions"),
        (Off, b"OFF BINARY\n".into(), "binary OFF is not supported"),
        (Off, b"OFF\n".into(), "counts of vertices and faces are missing"),
        (Off, b"OFF\n3\n".into(), "counts of vertices and faces are missing"),
        (Off, b"OFF\n3 -1 0\n".into(), "the count \"-1\" is not a whole number"),
        (Off, b"OFF\n4000000000 1 0\n0 0 0\n".into(), "cannot be in the 6 bytes"),
        (Off, b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n\n\n\n\n\n\n".into(), "ends at face 0 of 1"),
        (Off, b"OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n".into(), "line 6: more lines follow the last face"),
        (Off, b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n".into(), "face 0 names vertex \"3\", but there are only 3"),
        (Off, b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n2 0 1     \n".into(), "face 0 has \"2\" corners"),
        (Off, b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n4 0 1 2\n".into(), "face 0 has fewer than its 4 corners"),
        (Off, b"OFF\n3 1 0\n0 0 0\n1 0\n0 1 0\n3 0 1 2      \n".into(), "line 4: vertex 1 has fewer than 3 numbers"),
        // STL.
        (Stl, b"".into(), "byte 0: the file ends before the 84 bytes"),
        (Stl, [vec![0; 80], u32::MAX.to_le_bytes().into(), vec![0; 50]].concat(), "byte 80: 4294967295 triangles take 214748364834 bytes, but the file has 134"),
        (Stl, [vec![0; 80], 1u32.to_le_bytes().into(), vec![0; 51]].concat(), "1 triangles take 134 bytes, but the file has 135"),
        (Stl, b"solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0\n".into(), "line 4: a vertex with 2 numbers"),
        (Stl, b"solid\nfacet normal 0 0 1\nouter loop\nendloop\n".into(), "line 4: \"endloop\" stands where \"vertex\" should"),
        (Stl, b"solid\nfacet normal 0 0 1\nouter loop\n".into(), "line 4: the file ends where \"vertex\" should stand; it is cut off"),
        (Stl, b"solid\n".into(), "the file ends where \"endsolid\" should stand"),
        (Stl, b"solid\nendsolid\nfacet\n".into(), "line 3: \"facet\" has no place here"),
        (Stl, b"solid\nfacet normal 0 0 1\nouter loop\nvertex 0 1e39 0\n".into(), "the coordinate \"1e39\" is too large"),
    ];
    for (format, bytes, reason) in table {
        let error = refusal(&bytes, format);
        assert!(
            error.contains(reason),
            "{}\n  says: {error}\n  not:  {reason}",
            bytes.escape_ascii()
        );
    }
}

/// Whole files in every format and encoding, small enough to be cut at every byte.
fn samples() -> Vec<(Format, Vec<u8>)> {
    let binary = Document::from_mesh_f64(ROOF.to_vec(), ROOF_FACES.to_vec()).unwrap();
    let mut all: Vec<_> =
        [Ply, Stl, Obj, Off].map(|f| (f, binary.convert(f).unwrap().to_bytes())).to_vec();
    all.push((Ply, ply(FACE, "3 0 1 2\n").into()));
    let facet = "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n";
    all.push((Stl, format!("solid a\n{facet}endsolid a\n").into()));
    let strips = ply("element tristrips 1\nproperty list int int vertex_indices", "5 0 1 2 -1 0\n");
    all.push((Ply, strips.into()));
    all
}

#[test]
fn a_file_cut_anywhere_is_an_error_or_a_whole_smaller_mesh() {
    for (format, bytes) in samples() {
        let whole = Document::parse(bytes.clone(), format).unwrap();
        for n in 0..bytes.len() {
            match Document::parse(bytes[..n].to_vec(), format) {
                Err(error) => assert!(error.to_string().contains(": "), "{error}"),
                // A text may be cut in its last number or line end; OBJ has no end mark at all.
                Ok(d) => {
                    let text_end = n + 12 > bytes.len() && format != Stl;
                    let stl_name = format == Stl && bytes[..n].ends_with(b"endsolid")
                        || bytes[..n].ends_with(b"endsolid ")
                        || bytes[..n].ends_with(b"endsolid a");
                    assert!(format == Obj || text_end || stl_name, "{format} cut at {n}");
                    assert!(d.faces().len() <= whole.faces().len());
                }
            }
        }
    }
}

/// Uses everything of a document; none of it may panic.
fn exercise(d: &Document) {
    let (vertices, faces) = (d.vertices(), d.faces());
    for f in 0..faces.len() {
        assert!(faces.get(f).iter().all(|&v| (v as usize) < vertices.len()));
    }
    if let Some(colours) = d.vertex_colours() {
        assert_eq!(colours.len(), vertices.len());
    }
    let mut fill = floor();
    (fill.input_vertex_count, fill.input_face_count) = (vertices.len(), faces.len());
    let n = vertices.len() as u32;
    fill.faces = if n >= 2 { vec![[0, n - 1, n]] } else { vec![] };
    let mut grown = d.clone();
    if grown.append(&fill, &Extras::default()).is_err() {
        assert_eq!(grown.to_bytes(), d.to_bytes());
        assert_eq!(grown.faces().len(), faces.len());
    } else if d.format() != Stl {
        assert_eq!(grown.vertices().len(), vertices.len() + 1);
        assert_eq!(grown.faces().len(), faces.len() + fill.faces.len());
    }
    for format in [Ply, Obj, Stl, Off] {
        let _ = d.convert(format);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    /// Bytes changed, inserted and removed in whole files.
    #[test]
    fn damaged_files_never_panic(
        which in 0..7usize,
        damage in proptest::collection::vec((any::<prop::sample::Index>(), any::<u8>(), 0..4u8), 1..6),
    ) {
        let (format, mut bytes) = samples().swap_remove(which);
        for (at, value, kind) in damage {
            let at = at.index(bytes.len());
            match kind {
                0 => bytes[at] = value,
                1 => bytes.insert(at, value),
                2 => { bytes.remove(at); }
                // Digits hurt most: they change counts and indices.
                _ => bytes[at] = b'0' + value % 10,
            }
        }
        if let Ok(d) = Document::parse(bytes, format) {
            exercise(&d);
        }
    }

    /// Pure noise, and noise after a plausible beginning.
    #[test]
    fn noise_never_panics(noise in proptest::collection::vec(any::<u8>(), 0..200), which in 0..6usize) {
        let (format, head): (Format, &[u8]) = [
            (Ply, &b"ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty double z\nproperty short x\nproperty list char int q\nproperty uchar y\nend_header\n"[..]),
            (Ply, b"ply\nformat ascii 1.0\n"),
            (Obj, b"v 0 0 0\nv 1 1 1\nv 0 1 0\nf "),
            (Stl, b"solid\n"),
            (Stl, b""),
            (Off, b"OFF "),
        ][which];
        if let Ok(d) = Document::parse([head, &noise].concat(), format) {
            exercise(&d);
        }
    }
}

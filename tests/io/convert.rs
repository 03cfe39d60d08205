//! One format to another, and files on the disk.

use super::*;
use complete_mesh::io::Extras;

const ALL: [Format; 4] = [Format::Ply, Format::Obj, Format::Stl, Format::Off];

/// Colours, a concave polygon, a property that only PLY has.
fn rich() -> Document {
    let text = "ply\nformat ascii 1.0\nelement vertex 5\nproperty double x\nproperty double y\n\
        property double z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n\
        property float quality\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n\
        2 0 0 255 0 0 .5\n0 1 0 0 255 0 .5\n0.1 0 0 0 0 255 .5\n0 -1 0 1 2 3 .5\n0.30000000000000004 0 5 9 8 7 .5\n\
        4 0 1 2 3\n3 1 0 4\n";
    Document::parse(text.into(), Format::Ply).unwrap()
}

#[test]
fn positions_colours_and_polygons_survive() {
    let source = rich();
    for format in [Format::Obj, Format::Off] {
        let there = source.convert(format).unwrap();
        assert_eq!(there.format(), format);
        assert_eq!(there.dropped(), ["the property \"quality\" of \"vertex\""]);
        let back = there.convert(Format::Ply).unwrap();
        for d in [&there, &back] {
            assert_eq!((vertices(d), faces(d)), (vertices(&source), faces(&source)), "{format}");
            assert_eq!(d.vertex_colours(), source.vertex_colours());
        }
        assert!(String::from_utf8(there.to_bytes())
            .unwrap()
            .lines()
            .any(|l| l.contains("1 2 3 4") || l.contains("4 0 1 2 3")));
    }
    let stl = source.convert(Format::Stl).unwrap();
    assert_eq!(faces(&stl).len(), 3);
    assert!(
        stl.dropped().iter().any(|d| d.contains("colours"))
            && stl.dropped().iter().any(|d| d.contains("f32"))
    );
    let corner = |d: &Document, f: usize| {
        faces(d)[f].map(|v| d.vertices().get(v as usize).map(|x| x as f32))
    };
    for f in 0..3 {
        assert_eq!(corner(&stl, f), corner(&source, f));
    }
}

#[test]
fn a_converted_document_can_be_completed() {
    let source = Document::from_mesh_f64(ROOF.to_vec(), ROOF_FACES.to_vec()).unwrap();
    for format in ALL {
        let mut d = source.convert(format).unwrap();
        if format == Format::Stl {
            assert_eq!(d.faces().len(), 4);
            continue;
        }
        d.append(&floor(), &Extras::default()).unwrap();
        assert_whole(&d);
    }
}

#[test]
fn what_obj_has_alone_is_named() {
    let text = "mtllib m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl a\nf 1/1 2/1 3/1\n";
    let d = Document::parse(text.into(), Format::Obj).unwrap().convert(Format::Ply).unwrap();
    assert_eq!(d.dropped(), ["texture coordinates", "materials", "material libraries"]);
}

#[test]
fn files_are_read_by_name_or_content_and_written_whole() {
    let folder = tempfile::tempdir().unwrap();
    let source = rich();
    for (name, format) in [
        ("a.PLY", Format::Ply),
        ("a.obj", Format::Obj),
        ("a.Stl", Format::Stl),
        ("a.off", Format::Off),
    ] {
        let path = folder.path().join(name);
        let d = source.convert(format).unwrap();
        d.write(&path).unwrap();
        let back = Document::read(&path).unwrap();
        assert_eq!((back.format(), back.to_bytes()), (format, d.to_bytes()));
    }
    let unnamed = folder.path().join("mesh");
    source.write(&unnamed).unwrap();
    assert_eq!(Document::read(&unnamed).unwrap().format(), Format::Ply);
    // Nothing was left aside.
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 5);

    std::fs::write(&unnamed, b"\x00\x01").unwrap();
    let error = Document::read(&unnamed).unwrap_err().to_string();
    assert!(error.contains("mesh: not a known file; use .ply"), "{error}");
    let broken = folder.path().join("broken.ply");
    std::fs::write(&broken, b"ply\nformat ascii 1.0\nelement vertex 1\n").unwrap();
    let error = Document::read(&broken).unwrap_err().to_string();
    assert!(error.contains("broken.ply: line 4: the header has no line \"end_header\""), "{error}");
    let error = Document::read(&folder.path().join("none.ply")).unwrap_err();
    assert!(matches!(error, IoError::Read { .. }), "{error}");
}

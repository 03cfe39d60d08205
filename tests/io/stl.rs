//! STL.

use super::*;
use complete_mesh::io::Extras;

const PLAIN: Extras = Extras { provenance: false };

/// The roof as a binary file: a marked head, odd normals, an attribute each, and in the middle a
/// facet without area.
fn binary() -> Vec<u8> {
    let mut file = vec![0x5a; 80];
    file[..5].copy_from_slice(b"solid");
    file.extend(5u32.to_le_bytes());
    let mut list = ROOF_FACES.to_vec();
    list.insert(2, [2, 2, 3]);
    for (i, f) in list.iter().enumerate() {
        file.extend([9.0f32, 8.0, -7.0].iter().flat_map(|x| x.to_le_bytes()));
        file.extend(
            f.iter().flat_map(|&v| ROOF[v as usize]).flat_map(|x| (x as f32).to_le_bytes()),
        );
        file.extend([i as u8, 0x80]);
    }
    file
}

/// The file's corners in the order they first come up.
const ORDER: [usize; 5] = [0, 1, 4, 2, 3];

/// The floor in the file's numbering.
fn renumbered_floor() -> Completion {
    let mut completion = floor();
    for v in completion.faces.iter_mut().flatten().filter(|v| **v < 5) {
        *v = ORDER.iter().position(|&o| o == *v as usize).unwrap() as u32;
    }
    completion
}

#[test]
fn binary_keeps_head_normals_and_attributes() {
    let file = binary();
    let mut d = Document::parse(file.clone(), Format::Stl).unwrap();
    assert_eq!(d.to_bytes(), file);
    assert_eq!(vertices(&d), ORDER.map(|v| ROOF[v]));
    assert_eq!(faces(&d), [[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2]]);
    d.append(&renumbered_floor(), &PLAIN).unwrap();
    let out = d.to_bytes();
    assert_eq!(out[..80], file[..80]);
    assert_eq!(out[80..84], 9u32.to_le_bytes());
    assert_eq!(out[84..file.len()], file[84..]);
    // Each new facet: the normal is down, the attribute that of the facet across the rim.
    let added: Vec<&[u8]> = out[file.len()..].chunks(50).collect();
    for (facet, attribute) in added.iter().zip([0, 1, 3, 4]) {
        let normal: Vec<f32> =
            facet[..12].chunks(4).map(|raw| f32::from_le_bytes(raw.try_into().unwrap())).collect();
        assert_eq!(normal, [0.0, 0.0, -1.0]);
        assert_eq!(facet[48..], [attribute, 0x80]);
    }
    assert_eq!((added.len(), faces(&d).len(), d.vertices().len()), (4, 8, 6));
    assert_eq!(d.vertices().get(5), [0.5, 0.5, 0.0]);
}

#[test]
fn ascii_grows_inside_its_last_solid() {
    let facet = |f: &[u32; 3]| {
        let corners: String = f
            .iter()
            .map(|&v| ROOF[v as usize])
            .map(|p| format!("   VERTEX {} {:e} {}\n", p[0], p[1], p[2]))
            .collect();
        format!(" facet normal 0 0 0\n  outer loop\n{corners}  endloop\n endfacet\n")
    };
    let [a, b, c, d] = ROOF_FACES.each_ref().map(facet);
    let head = format!("solid one  thing\n{a}{b}endsolid one\n\nsolid two\n{c}{d}");
    let file = format!("{head}endsolid two\n");
    let mut d = Document::parse(file.clone().into_bytes(), Format::Stl).unwrap();
    assert_eq!(d.to_bytes(), file.as_bytes());
    d.append(&renumbered_floor(), &PLAIN).unwrap();
    let out = String::from_utf8(d.to_bytes()).unwrap();
    let new =
        "  facet normal 0 0 -1\n    outer loop\n      vertex 1 0 0\n      vertex 0 0 0\n      \
        vertex 0.5 0.5 0\n    endloop\n  endfacet\n";
    assert!(out.starts_with(&format!("{head}{new}")), "{out}");
    assert!(out.ends_with("endfacet\nendsolid two\n"));
    assert_eq!(faces(&d).len(), 8);
}

#[test]
fn the_two_zeros_are_one_place() {
    let facet = |x: &str| {
        format!("facet normal 0 0 0\nouter loop\nvertex {x} 0 0\nvertex 1 0 0\nvertex 0 1 {x}\nendloop\nendfacet\n")
    };
    let file = format!("solid\n{}{}endsolid\n", facet("0"), facet("-0"));
    let d = Document::parse(file.into_bytes(), Format::Stl).unwrap();
    assert_eq!((d.vertices().len(), faces(&d)), (3, vec![[0, 1, 2]; 2]));
}

//! Mesh files through the public interface: what comes back, what is added, what is refused.
#![cfg(feature = "io")]

mod convert;
mod hostile;
mod obj;
mod off;
mod ply;
mod points;
mod stl;

use complete_mesh::io::{Document, Format, IoError};
use complete_mesh::{Completion, Origin};

/// The roof: four faces around vertex 4, open at the square 0 1 2 3. Every format's sample.
pub const ROOF: [[f64; 3]; 5] =
    [[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.], [0.5, 0.5, 0.75]];
/// Its faces, anticlockwise from outside.
pub const ROOF_FACES: [[u32; 3]; 4] = [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]];

/// The roof's floor, with one new vertex in its middle.
pub fn floor() -> Completion {
    Completion {
        input_vertex_count: 5,
        input_face_count: 4,
        vertices: vec![[0.5, 0.5, 0.0]],
        faces: vec![[1, 0, 5], [2, 1, 5], [3, 2, 5], [0, 3, 5]],
        vertex_hole: vec![7],
        origins: vec![Origin {
            face: 2,
            barycentric: [0.25, 0.5, 0.25],
            source: 1,
            confidence: 0.75,
        }],
        colour_origins: Vec::new(),
        loose: Default::default(),
        face_hole: vec![7; 4],
        holes: Vec::new(),
        seconds: 0.0,
        cpu_seconds: 0.0,
    }
}

/// The reason a file is refused for.
pub fn refusal(bytes: &[u8], format: Format) -> String {
    match Document::parse(bytes.to_vec(), format) {
        Err(error @ IoError::Malformed { .. }) => error.to_string(),
        Err(other) => panic!("another kind of error: {other}"),
        Ok(_) => panic!("read without an error: {}", bytes.escape_ascii()),
    }
}

/// All positions.
pub fn vertices(d: &Document) -> Vec<[f64; 3]> {
    (0..d.vertices().len()).map(|i| d.vertices().get(i)).collect()
}

/// All triangles.
pub fn faces(d: &Document) -> Vec<[u32; 3]> {
    (0..d.faces().len()).map(|i| d.faces().get(i)).collect()
}

/// The roof and its floor, as a document shows them after [`floor`] was appended.
pub fn assert_whole(d: &Document) {
    let completion = floor();
    let (v, f) = completion.to_mesh_f64(&ROOF, &ROOF_FACES);
    assert_eq!(vertices(d), v);
    assert_eq!(faces(d), f);
}

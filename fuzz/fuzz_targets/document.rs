//! Mesh files: whatever the bytes, parsing returns; what it accepts is written back byte for byte
//! and can be converted to every format.
//!
//!     cargo +nightly fuzz run document -- -max_len=4096

#![no_main]

use complete_mesh::io::{Document, Format};
use libfuzzer_sys::fuzz_target;

const FORMATS: [Format; 4] = [Format::Ply, Format::Obj, Format::Stl, Format::Off];

fuzz_target!(|input: (u8, &[u8])| {
    let (choice, bytes) = input;
    let format = FORMATS[choice as usize % FORMATS.len()];
    let Ok(document) = Document::parse(bytes.to_vec(), format) else { return };
    assert_eq!(document.as_bytes(), bytes);
    let (vertices, faces) = (document.vertices(), document.faces());
    assert!((0..vertices.len()).all(|v| vertices.get(v).len() == 3));
    assert!((0..faces.len()).all(|f| faces.get(f).len() == 3));
    for other in FORMATS {
        let _ = document.convert(other);
    }
});

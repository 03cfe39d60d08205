//! The whole call, over all options, on small meshes full of holes, slivers and bad indices: it
//! returns, and what it returns keeps the contract's countable half.
//!
//!     cargo +nightly fuzz run complete -- -max_len=2048

#![no_main]

use arbitrary::Arbitrary;
use complete_mesh::{complete_mesh, Fairing, Grouping, Options, Selection, Sizing};
use libfuzzer_sys::fuzz_target;

#[derive(Debug, Arbitrary)]
struct Input {
    /// Coordinates on a coarse grid: coincidences are what breaks things.
    vertices: Vec<[i8; 3]>,
    /// Now and then out of range.
    faces: Vec<[u8; 3]>,
    single: bool,
    fairing: u8,
    grouping: u8,
    join: Vec<Vec<u8>>,
    selection: u8,
    number: u8,
    sizing: u8,
    skip_unsafe: bool,
    threads: u8,
}

fuzz_target!(|input: Input| {
    let number = f64::from(input.number) / 16.0;
    let join = || input.join.iter().map(|l| l.iter().map(|&v| u32::from(v)).collect()).collect();
    let options = Options {
        fairing: Fairing::ALL[input.fairing as usize % Fairing::ALL.len()],
        grouping: match input.grouping % 3 {
            0 => Grouping::Automatic,
            1 => Grouping::Separate,
            _ => Grouping::Join(join()),
        },
        selection: match input.selection % 8 {
            0 => Selection::All,
            1 => Selection::Ids(vec![input.number as usize]),
            2 => Selection::MaxEdges(input.number as usize),
            3 => Selection::MaxCircumference(number),
            4 => Selection::MaxDiameter(number),
            5 => Selection::AllButLargest,
            6 => Selection::NearPoint([number, -number, 1.0]),
            _ => Selection::NearVertices(vec![u32::from(input.number)]),
        },
        sizing: match input.sizing % 4 {
            0 => Sizing::Surroundings,
            1 => Sizing::Scaled(number),
            // Finer than this only makes the fills large.
            2 => Sizing::EdgeLength(number.max(4.0)),
            _ => Sizing::None,
        },
        skip_unsafe: input.skip_unsafe,
        threads: input.threads as usize % 3,
        ..Options::default()
    };
    let faces: Vec<[u32; 3]> = input.faces.iter().map(|f| f.map(u32::from)).collect();
    let double: Vec<[f64; 3]> = input.vertices.iter().map(|p| p.map(f64::from)).collect();
    let single: Vec<[f32; 3]> = input.vertices.iter().map(|p| p.map(f32::from)).collect();
    let made = match input.single {
        true => complete_mesh(&single[..], &faces[..], &options),
        false => complete_mesh(&double[..], &faces[..], &options),
    };
    let Ok(made) = made else { return };
    assert_eq!((made.input_vertex_count, made.input_face_count), (double.len(), faces.len()));
    let count = double.len() + made.vertices.len();
    assert!(made.faces.iter().flatten().all(|&v| (v as usize) < count));
    assert!(made.faces.iter().all(|&[a, b, c]| a != b && b != c && c != a));
    assert!(made.vertices.iter().flatten().all(|x| x.is_finite()));
});

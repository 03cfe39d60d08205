//! What a smooth fill takes in memory: the most bytes that were allocated at one time during the
//! library call, counted by the allocator, and the caller's arrays.
//!
//! `cargo run --release --example memory -- MESH ...` prints a table in Markdown;
//! `docs/speed.md` has one. The files are read before counting starts.

mod peak;

use complete_mesh::io::Document;
use complete_mesh::{complete_mesh_with, MeshView, Method, Monitor, Options};
use peak::{LIVE, PEAK};
use std::path::Path;
use std::sync::atomic::{AtomicIsize, Ordering::Relaxed};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!("| mesh | vertices | new vertices | arrays KiB | peak KiB | peak / arrays | bytes a new vertex |");
    println!("|---|---|---|---|---|---|---|");
    for path in std::env::args().skip(1) {
        let path = Path::new(&path);
        let document = Document::read(path)?;
        // As a caller has them: packed, in the precision of the file.
        let single = document.vertices().is_single();
        let faces: Vec<[u32; 3]> =
            (0..document.faces().len()).map(|f| document.faces().get(f)).collect();
        let double: Vec<[f64; 3]> =
            (0..document.vertices().len()).map(|v| document.vertices().get(v)).collect();
        drop(document);
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        if single {
            let single: Vec<[f32; 3]> = double.iter().map(|p| p.map(|x| x as f32)).collect();
            drop(double);
            measure(&name, MeshView::new(&single[..], &faces[..]), size_of_val(&single[..]));
        } else {
            measure(&name, MeshView::new(&double[..], &faces[..]), size_of_val(&double[..]));
        }
    }
    Ok(())
}

/// Prints one row of the table.
fn measure(name: &str, mesh: MeshView<'_>, vertex_bytes: usize) {
    let arrays = (vertex_bytes + 12 * mesh.faces.len()) as f64;
    let before = LIVE.load(Relaxed);
    PEAK.store(before, Relaxed);
    // STAGES=1 in the environment: what there is as each stage begins, on the error stream.
    let stages = std::env::var_os("STAGES").is_some();
    let progress = move |fraction: f64, stage: &str| {
        if stages {
            let kib = |x: &AtomicIsize| (x.load(Relaxed) - before) / 1024;
            eprintln!("{fraction:5.3} {stage}: {} KiB, peak {} KiB", kib(&LIVE), kib(&PEAK));
        }
        true
    };
    let monitor = Monitor::new(&progress);
    let options = Options { method: Method::Smooth, threads: 1, ..Options::default() };
    match complete_mesh_with(mesh, &options, &monitor) {
        Ok(made) => {
            let own = (PEAK.load(Relaxed) - before) as f64;
            let (count, new) = (mesh.vertices.len(), made.vertices.len());
            let (kib, peak) = (arrays / 1024.0, (arrays + own) / 1024.0);
            let (ratio, each) = ((arrays + own) / arrays, own / new.max(1) as f64);
            println!(
                "| {name} | {count} | {new} | {kib:.0} | {peak:.0} | {ratio:.2} | {each:.0} |"
            );
        }
        Err(error) => println!("| {name} | {error} |"),
    }
}

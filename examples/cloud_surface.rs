//! The mesh that is laid through a cloud's points and that its fills are joined to, as a PLY file.
//!
//! `cargo run --release --example cloud_surface -- CLOUD OUT.ply`

use complete_mesh::io::Document;
use complete_mesh::{complete_points, Method, Options, Selection};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let [cloud, out] = &words[..] else { return Err("CLOUD OUT.ply, please".into()) };
    let document = Document::read(cloud.as_ref())?;
    let points: Vec<[f64; 3]> =
        (0..document.vertices().len()).map(|v| document.vertices().get(v)).collect();
    let options = Options {
        method: Method::Smooth,
        selection: Selection::Ids(Vec::new()),
        ..Options::default()
    };
    let made = complete_points(&points[..], None, &options)?;
    Ok(Document::from_mesh_f64(points, made.copied.faces)?.write(out.as_ref())?)
}

//! A scan-like point cloud: a decorated vessel with pieces missing, its points noisy and coloured,
//! some of them beside the surface. `cargo run --release --example scan -- scan.ply`

use complete_mesh::io::Document;
use complete_mesh::mesh::normals::vertex_normals;
use complete_mesh::sample::{break_mesh, Break, BreakOptions, Sample};
use glam::DVec3;
use scanned::chance;
use std::fmt::Write;

mod scanned;

/// Noise along the normal, and outliers, as shares of the mean edge and of the points.
const NOISE: f64 = 0.15;
const OUTLIERS: f64 = 0.003;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path = std::env::args().nth(1).ok_or("name the file to write: scan.ply")?;
    let whole = Sample::Vessel.build(220)?;
    let options = BreakOptions { kind: Break::Several, seed: 1, size: 1.0 };
    let mesh = break_mesh(Sample::Vessel, &whole, &options)?.mesh;
    let points: Vec<DVec3> = mesh.vertices.iter().map(|p| DVec3::from(p.map(f64::from))).collect();
    let normals = vertex_normals(&points, mesh.faces.iter().copied());
    let edges = mesh.faces.iter().map(|f| points[f[0] as usize].distance(points[f[1] as usize]));
    let edge = edges.sum::<f64>() / mesh.faces.len() as f64;
    let (low, high) =
        points.iter().fold((f64::MAX, f64::MIN), |(l, h), p| (l.min(p.y), h.max(p.y)));
    let mut rows = String::new();
    let mut row = |p: DVec3| -> std::fmt::Result {
        let t = ((p.y - low) / (high - low)).clamp(0.0, 1.0);
        let band = if (t * 9.0).fract() < 0.3 { 0.55 } else { 1.0 };
        let c = [190.0 - 60.0 * t, 120.0 + 40.0 * t, 80.0 + 90.0 * t].map(|x| (x * band) as u8);
        let p = p.as_vec3();
        writeln!(rows, "{} {} {} {} {} {}", p.x, p.y, p.z, c[0], c[1], c[2])
    };
    for (i, (p, n)) in points.iter().zip(&normals).enumerate() {
        row(*p + NOISE * edge * chance(i as u64) * *n)?;
    }
    let outliers = (OUTLIERS * points.len() as f64) as usize;
    for i in 0..outliers {
        let at = (i * points.len()) / outliers;
        row(points[at] + edge * (6.0 + 4.0 * chance(at as u64)) * normals[at])?;
    }
    let text = format!(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\n\
         property float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n\
         end_header\n{rows}",
        points.len() + outliers
    );
    // Read back: what is written is valid.
    Document::parse(text.into_bytes(), complete_mesh::io::Format::Ply)?.write(path.as_ref())?;
    Ok(())
}

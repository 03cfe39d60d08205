//! What cleaning does to scan-like clouds of the samples, each with a hole: outliers found, noise left, normals
//! turned the right way. `cargo run --release --example cloud_cleaning [-- --list]`

use complete_mesh::intersect::Bvh;
use complete_mesh::mesh::normals::vertex_normals;
use complete_mesh::sample::{break_mesh, Break, BreakOptions, Sample, SampleMesh};
use complete_mesh::{complete_points, Cleaning, Method, Options};
use glam::DVec3;
use scanned::scan;
use std::error::Error;
use std::ops::AddAssign;

mod scanned;

/// Share of outliers, and noise in mean edges.
const OUTLIERS: f64 = 0.005;
const NOISE: [f64; 3] = [0.1, 0.2, 0.3];
/// Edges along the longest side of a sample.
const RESOLUTION: usize = 120;

/// Sums over points.
#[derive(Default, Clone, Copy)]
struct Sums {
    good: f64,
    outliers: f64,
    found: f64,
    falsely: f64,
    kept: f64,
    /// Squared distances from the surface in mean edges, before and after.
    off: [f64; 2],
    /// Points on faces, and those whose normal is on the right side.
    seen: f64,
    right: f64,
}

impl AddAssign for Sums {
    fn add_assign(&mut self, o: Self) {
        self.good += o.good;
        self.outliers += o.outliers;
        self.found += o.found;
        self.falsely += o.falsely;
        self.kept += o.kept;
        (0..2).for_each(|k| self.off[k] += o.off[k]);
        self.seen += o.seen;
        self.right += o.right;
    }
}

impl Sums {
    fn row(&self, noise: f64, name: &str) {
        let [before, after] = self.off.map(|s| (s / self.kept).sqrt());
        println!(
            "| {noise} | {:.0} of {:.0} | {:.0} of {:.0} | {before:.3} | {after:.3} | {:.3} % | {name} |",
            self.found,
            self.outliers,
            self.falsely,
            self.good,
            100.0 * self.right / self.seen
        );
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let list = std::env::args().any(|a| a == "--list");
    println!(
        "| noise | outliers found | falsely named | off before | off after | normals right | of |"
    );
    println!("|---|---|---|---|---|---|---|");
    for noise in NOISE {
        let mut all = Sums::default();
        for sample in Sample::ALL {
            let whole = sample.build(RESOLUTION)?;
            let options = BreakOptions { kind: Break::Disc, seed: 1, size: 1.0 };
            let broken = break_mesh(sample, &whole, &options)?.mesh;
            let sums = measure(&whole, &broken, noise)?;
            if list {
                sums.row(noise, sample.name());
            }
            all += sums;
        }
        all.row(noise, "all samples");
    }
    Ok(())
}

fn measure(whole: &SampleMesh, broken: &SampleMesh, noise: f64) -> Result<Sums, Box<dyn Error>> {
    let cloud = scan(broken.view(), None, noise, OUTLIERS);
    let (points, good) = (&cloud.points, cloud.normals.len());
    let clean = Some(Cleaning::default());
    // What becomes of the holes does not matter here.
    let options =
        Options { method: Method::Smooth, clean, skip_unsafe: true, ..Options::default() };
    let made = complete_points(&points[..], None, &options)?;
    let cleaned = made.cleaned.ok_or("no cleaned copy")?;
    let corner = |v: u32| DVec3::from(whole.vertices[v as usize].map(f64::from));
    let faces = whole.faces.iter().enumerate();
    let truth = Bvh::from_triangles(faces.map(|(i, f)| (i as u32, f.map(corner))));
    let off = |p: [f64; 3]| {
        let hit = truth.closest_point(p.into(), f64::INFINITY);
        hit.map_or(0.0, |h| h.point.distance(p.into()) / cloud.edge)
    };
    let mut sums = Sums { good: good as f64, ..Sums::default() };
    sums.outliers = (points.len() - good) as f64;
    for (i, &p) in points.iter().enumerate() {
        match (i < good, cleaned.removed[i]) {
            (false, removed) => sums.found += f64::from(u8::from(removed)),
            (true, true) => sums.falsely += 1.0,
            (true, false) => {
                sums.kept += 1.0;
                sums.off[0] += off(p).powi(2);
                sums.off[1] += off(cleaned.positions[i]).powi(2);
            }
        }
    }
    // The faces of the mesh through the points are on the side of the normals.
    let places: Vec<DVec3> = cleaned.positions.iter().map(|&p| p.into()).collect();
    let normals = vertex_normals(&places, made.copied.faces.iter().copied());
    for (own, true_one) in normals.iter().zip(&cloud.normals).filter(|n| *n.0 != DVec3::ZERO) {
        sums.seen += 1.0;
        sums.right += f64::from(u8::from(own.dot(*true_one) > 0.0));
    }
    Ok(sums)
}

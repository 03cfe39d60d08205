//! The smooth completion of one hole: triangulation, refinement, fairing.

use crate::fill::fairing::{fair, Plate};
use crate::fill::outline::Outline;
use crate::fill::patch::Patch;
use crate::fill::polygon::join_loops;
use crate::fill::refine::{refine, Relax};
use crate::fill::sheet::{Band, Incidence, Sheet};
use crate::fill::triangulate::triangulate;
use crate::mesh::neighbourhood::Neighbourhood;

pub fn env(name: &str, default: f64) -> f64 {
    std::env::var(name).ok().and_then(|s| s.parse().ok()).unwrap_or(default)
}

/// dev
pub fn fill_hole(near: &Neighbourhood, incidence: &Incidence, loops: &[Vec<u32>]) -> Option<(Outline, Patch)> {
    let t0 = std::time::Instant::now();
    let mut outline = Outline::new(near, incidence, loops);
    let scale = env("CM_SCALE", 1.0);
    outline.sizes.iter_mut().for_each(|s| *s *= scale);
    let polygon = join_loops(&outline.positions, &outline.rims);
    let t1 = std::time::Instant::now();
    let mut patch = triangulate(&outline.positions, &outline.sizes, &polygon);
    let t2 = std::time::Instant::now();
    refine(&mut patch, &outline.taken, Relax::Freely, env("CM_ROUNDS", 4.0) as usize);
    let t3 = std::time::Instant::now();
    let edge = outline.mean_size();
    let rh = {
        let c = outline.positions.iter().copied().sum::<glam::DVec3>() / outline.positions.len() as f64;
        outline.positions.iter().map(|p| p.distance(c)).fold(0.0, f64::max)
    };
    let plate = match env("CM_PLATE", 1.0) as i32 {
        0 => Plate::Membrane,
        1 => Plate::Thin,
        2 => Plate::Triharmonic,
        3 => Plate::LeastSquares,
        _ => Plate::Smoothed((env("CM_S", 0.1) * rh).max(env("CM_SE", 0.0) * edge)),
    };
    let rings = plate.rings() + if plate.is_soft() { (env("CM_BAND", 0.4) * rh / edge).ceil().max(3.0) as usize } else { 0 };
    let band = Band::grow(near, incidence, &outline.vertices, rings);
    let passes = env("CM_PASSES", 2.0) as usize;
    for pass in 0..passes {
        let sheet = Sheet::new(&patch, &band, near);
        let t = std::time::Instant::now();
        let moved = fair(&sheet, plate, edge)?;
        if std::env::var("CM_T").is_ok() { eprintln!("  fair {} unknown {:?}", patch.positions.len()-patch.rim_count, t.elapsed()); }
        let rim = patch.rim_count;
        let n = moved.len();
        let total = patch.positions.len();
        patch.positions[rim..].copy_from_slice(&moved[n - (total - rim)..]);
        if pass + 1 < passes {
            refine(&mut patch, &outline.taken, Relax::InTangentPlane, env("CM_ROUNDS2", 2.0) as usize);
        }
    }
    if std::env::var("CM_T").is_ok() { eprintln!("outline {:?} tri {:?} refine {:?} fair+ {:?}", t1-t0, t2-t1, t3-t2, t3.elapsed()); }
    Some((outline, patch))
}

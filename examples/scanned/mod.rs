#![allow(dead_code)] // Not all examples use all of it.
//! A mesh as a scanner sees it: its vertices, noisy along the normals, and outliers beside the surface.

use complete_mesh::mesh::normals::vertex_normals;
use complete_mesh::MeshView;
use glam::DVec3;
use uneven::{Sample, Uneven};

pub mod uneven;

/// Outliers lie so many mean edges beside the surface.
const ASIDE: [f64; 2] = [2.0, 10.0];

/// Even from -1 to 1, the same at each run.
pub fn chance(seed: u64) -> f64 {
    let mut x = seed.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    (x >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

/// Nearly normal, standard deviation 1: the sum of three even ones.
fn normal(seed: u64) -> f64 {
    (0..3).map(|k| chance(3 * seed + k)).sum()
}

/// Points of a mesh.
pub struct Scanned {
    /// Those on the mesh, then the outliers.
    pub points: Vec<[f64; 3]>,
    /// Unit normals of the mesh at the former: where they end outliers begin.
    pub normals: Vec<DVec3>,
    /// Mean edge of the mesh.
    pub edge: f64,
    low: DVec3,
    size: DVec3,
    uneven: Option<Uneven>,
}

/// The vertices that faces use, or points of uneven density. `noise` in mean edges, `outliers` as a share of
/// the points.
pub fn scan(mesh: MeshView<'_>, uneven: Option<Uneven>, noise: f64, outliers: f64) -> Scanned {
    let mut faces: Vec<[u32; 3]> = (0..mesh.faces.len()).map(|f| mesh.faces.get(f)).collect();
    let at = |v: usize| DVec3::from(mesh.vertices.get(v));
    let all: Vec<DVec3> = (0..mesh.vertices.len()).map(at).collect();
    let edges = faces.iter().map(|f| all[f[0] as usize].distance(all[f[1] as usize]));
    let edge = edges.sum::<f64>() / faces.len() as f64;
    let of_all = vertex_normals(&all, faces.iter().copied());
    let mut number = vec![0; all.len()];
    faces.iter().flatten().for_each(|&v| number[v as usize] = 1);
    let kept: Vec<usize> = (0..all.len()).filter(|&v| number[v] > 0).collect();
    let mut samples: Vec<Sample> = kept.iter().map(|&v| (all[v], of_all[v])).collect();
    // The same noise at a vertex whatever is left out.
    let mut seeds: Vec<u64> = kept.iter().map(|&v| v as u64).collect();
    let low = samples.iter().map(|s| s.0).fold(DVec3::INFINITY, DVec3::min);
    let size = samples.iter().map(|s| s.0 - low).fold(DVec3::ZERO, DVec3::max);
    let mut made = Scanned { points: Vec::new(), normals: Vec::new(), edge, low, size, uneven };
    if let Some(how) = uneven {
        kept.iter().enumerate().for_each(|(i, &v)| number[v] = i as u32);
        faces.iter_mut().flatten().for_each(|v| *v = number[*v as usize]);
        samples = how.points(&samples, &faces, edge, &|p| made.place(p));
        seeds = (0..samples.len() as u64).collect();
    }
    let shaken =
        |(&(p, n), &seed): (&Sample, &u64)| (p + noise * edge * normal(seed) * n).to_array();
    made.points = samples.iter().zip(&seeds).map(shaken).collect();
    let count = (outliers * samples.len() as f64).round() as usize;
    for i in 0..count {
        let k = i * samples.len() / count;
        let [near, far] = ASIDE;
        let t = chance(seeds[k] + 77);
        let aside = t.signum() * (near + (far - near) * t.abs());
        made.points.push((samples[k].0 + edge * aside * samples[k].1).to_array());
    }
    made.normals = samples.iter().map(|s| s.1).collect();
    made
}

impl Scanned {
    /// From 0 to 1 along the longest side.
    fn place(&self, p: DVec3) -> f64 {
        let along = DVec3::select(
            self.size.cmpeq(DVec3::splat(self.size.max_element())),
            DVec3::ONE,
            DVec3::ZERO,
        );
        (p - self.low).dot(along) / self.size.dot(along)
    }

    /// How far apart the points are meant to be at a place.
    pub fn spacing(&self, p: [f64; 3]) -> f64 {
        self.edge * self.uneven.map_or(1.0, |how| how.spacing(self.place(p.into())))
    }
}

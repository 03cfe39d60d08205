#![allow(dead_code)] // Not all examples use all of it.
//! A mesh as a scanner sees it: its vertices, noisy along the normals, and outliers beside the surface.

use complete_mesh::mesh::normals::vertex_normals;
use complete_mesh::MeshView;
use glam::DVec3;

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
    /// The vertices that faces use, then the outliers.
    pub points: Vec<[f64; 3]>,
    /// Unit normals of the mesh at the former: where they end outliers begin.
    pub normals: Vec<DVec3>,
    /// Mean edge of the mesh.
    pub edge: f64,
}

/// `noise` in mean edges, `outliers` as a share of the points.
pub fn scan(mesh: MeshView<'_>, noise: f64, outliers: f64) -> Scanned {
    let faces: Vec<[u32; 3]> = (0..mesh.faces.len()).map(|f| mesh.faces.get(f)).collect();
    let at = |v: usize| DVec3::from(mesh.vertices.get(v));
    let all: Vec<DVec3> = (0..mesh.vertices.len()).map(at).collect();
    let edges = faces.iter().map(|f| all[f[0] as usize].distance(all[f[1] as usize]));
    let edge = edges.sum::<f64>() / faces.len() as f64;
    let of_all = vertex_normals(&all, faces.iter().copied());
    let mut used = vec![false; all.len()];
    faces.iter().flatten().for_each(|&v| used[v as usize] = true);
    let kept: Vec<usize> = (0..all.len()).filter(|&v| used[v]).collect();
    let shaken = |&v: &usize| all[v] + noise * edge * normal(v as u64) * of_all[v];
    let mut points: Vec<[f64; 3]> = kept.iter().map(|v| shaken(v).to_array()).collect();
    let count = (outliers * kept.len() as f64).round() as usize;
    for i in 0..count {
        let v = kept[i * kept.len() / count];
        let [near, far] = ASIDE;
        let t = chance(v as u64 + 77);
        let aside = t.signum() * (near + (far - near) * t.abs());
        points.push((all[v] + edge * aside * of_all[v]).to_array());
    }
    Scanned { points, normals: kept.iter().map(|&v| of_all[v]).collect(), edge }
}

//! Which of the fitted copies to believe, where, and how much.
//!
//! The score of a copy at a vertex is the product of two errors: at known vertices that were hidden
//! from its fit (how well it predicts), and on the ring as seen from the vertex (what is left after
//! the fit and how far the normals disagree, near points first):
//!
//!   U(i)² = Σ_p w (e² + (2 h)² (1 − n·m) + (h/2)² |Δc|²) / Σ_p w,   w = mass · (|p − i|² + (0.08 R)²)^−1.5

use super::domain::Domain;
use super::fit::Fitted;
use super::project::Copy;
use crate::matching::paint::EDGES;
use crate::matching::ring_pattern::blandness;
use crate::mesh::normals::vertex_normals;
use glam::DVec3;

/// Ring points nearer than this to a fill vertex count alike, in hole radii.
const SOFT: f64 = 0.08;
/// Ring points that are looked at, at most about; more change nothing.
const SEEN: usize = 500;

/// The scores of all copies.
pub struct Scores {
    /// By copy, then by fill vertex; in square mesh units, less is better.
    pub local: Vec<Vec<f64>>,
    /// Mean over the fill, by copy.
    pub mean: Vec<f64>,
    /// The copy with the least mean.
    pub best: usize,
}

/// Scores all copies at all fill vertices.
///
/// `roughness`: that of the ring, see [`crate::matching::source::SourceMesh::roughness`].
pub fn score(domain: &Domain, copies: &[Copy], fitted: &Fitted, roughness: f64) -> Scores {
    let soft = (SOFT * domain.radius).powi(2);
    let positions = &domain.sheet.positions;
    let normals = known_normals(domain);
    let step = domain.ring.len().div_ceil(SEEN).max(1);
    let seen: Vec<usize> = domain.ring.iter().copied().step_by(step).collect();
    let paint = (EDGES * domain.edge).powi(2);
    let four_h2 = 4.0 * domain.edge * domain.edge;
    // Squared errors by ring point, then copy: the inner loop below runs over copies.
    let errors: Vec<f64> = seen
        .iter()
        .flat_map(|&v| {
            let n = normals[v];
            copies.iter().enumerate().map(move |(k, copy)| {
                let turned = (1.0 - n.dot(copy.normals[v])).clamp(0.0, 1.0);
                let shape = fitted.leftover[k][v].powi(2) + four_h2 * turned;
                // Nothing is added, not even 0, without colours.
                copy.stain.get(v).map_or(shape, |stain| shape + paint * stain)
            })
        })
        .collect();
    let count = copies.len();
    let blands: Vec<f64> = copies.iter().map(|c| blandness(roughness, c.roughness)).collect();
    let mut local = vec![Vec::with_capacity(domain.fill.len()); count];
    let mut sums: Vec<f64> = vec![0.0; count];
    for v in domain.fill.clone() {
        sums.fill(0.0);
        let mut total = 0.0;
        for (row, &p) in errors.chunks_exact(count).zip(&seen) {
            let r2 = positions[v].distance_squared(positions[p]) + soft;
            let w = domain.laplacian.mass[p] / (r2 * r2.sqrt());
            total += w;
            sums.iter_mut().zip(row).for_each(|(s, e)| *s += w * e);
        }
        for k in 0..count {
            local[k].push((sums[k] / total).sqrt() * fitted.error[k] * blands[k]);
        }
    }
    let mean: Vec<f64> =
        local.iter().map(|l| l.iter().sum::<f64>() / l.len().max(1) as f64).collect();
    let best = (0..count).min_by(|&a, &b| mean[a].total_cmp(&mean[b])).unwrap_or(0);
    Scores { local, mean, best }
}

/// Consensus weights at a fill vertex (index from 0): (score / least score)^−`power`; their sum is 1.
pub fn weights(scores: &Scores, i: usize, power: i32) -> Vec<f64> {
    let least = scores.local.iter().map(|l| l[i]).fold(f64::INFINITY, f64::min);
    let least = least.max(f64::MIN_POSITIVE);
    let raw: Vec<f64> =
        scores.local.iter().map(|l| (l[i].max(least) / least).powi(-power)).collect();
    let sum: f64 = raw.iter().sum();
    raw.into_iter().map(|w| w / sum).collect()
}

/// Unit normals of the known surface, by sheet vertex.
pub fn known_normals(domain: &Domain) -> Vec<DVec3> {
    let sheet = &domain.sheet;
    let band = &sheet.triangles[sheet.triangles.len() - sheet.band_face_count..];
    vertex_normals(&sheet.positions, band.iter().copied())
}

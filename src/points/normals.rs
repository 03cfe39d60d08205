//! Hoppe, DeRose, Duchamp, McDonald and Stuetzle (1992), "Surface reconstruction from unorganized
//! points": normals from the neighbours' covariance, oriented along a minimum spanning tree.
//!
//! Differences from the paper:
//! - Edges of the tree also cost what they leave the tangent planes: the two sides of a thin wall
//!   are near each other, but not along the surface.
//! - Which side is out is voted on by the six extreme points of a component, not by one: there may
//!   be a hole at the top. Normals that the caller has settle it instead.

use super::neighbours::{blocks, Graph, Neighbours};
use crate::error::Result;
use crate::mesh::roots::Roots;
use crate::progress::Monitor;
use glam::DVec3;
use nalgebra::{Matrix3, SymmetricEigen};

/// Neighbours that a normal is made from: two rings of an even cloud less the far ones.
const PLANE: usize = 14;
/// Neighbours that a point passes its side on to.
const LINKS: usize = 8;
/// Rounds at most in which single points are turned round.
const SETTLING: usize = 3;

/// The principal axes of some offsets from a point.
pub struct Axes {
    /// Unit vector along which the offsets are least spread.
    pub normal: DVec3,
    /// The spreads, the greatest first.
    pub spreads: [f64; 3],
}

/// Principal axes of weighted points.
pub fn principal_axes(points: impl Iterator<Item = (DVec3, f64)> + Clone) -> Axes {
    let (sum, weight) =
        points.clone().fold((DVec3::ZERO, 0.0), |(s, w), (p, v)| (s + v * p, w + v));
    let mean = sum / weight.max(f64::MIN_POSITIVE);
    let mut m = Matrix3::<f64>::zeros();
    for (p, w) in points {
        let d = (p - mean).to_array();
        for i in 0..3 {
            for j in 0..3 {
                m[(i, j)] += w * d[i] * d[j];
            }
        }
    }
    let eigen = SymmetricEigen::new(m);
    let mut order = [0, 1, 2];
    let spread = |i: usize| -> f64 { eigen.eigenvalues[i].max(0.0) };
    order.sort_by(|&a, &b| spread(b).total_cmp(&spread(a)));
    let v = eigen.eigenvectors.column(order[2]);
    Axes { normal: DVec3::new(v[0], v[1], v[2]).normalize_or_zero(), spreads: order.map(spread) }
}

/// Unit normals on the same side of the surface all over each component. `given`: those that the
/// caller has, zero where he has none.
pub fn normals(
    points: &[DVec3],
    neighbours: &Neighbours,
    given: Option<&[DVec3]>,
    threads: usize,
    monitor: &Monitor,
) -> Result<Vec<DVec3>> {
    let mut normals = axes(points, neighbours, threads, monitor)?;
    orient(points, &mut normals, neighbours, given);
    Ok(normals)
}

/// Unit normals of points that were smoothed, on the sides that those before are on: a second tree would cross
/// thin walls where noise let the first one pass. Single points go to the side of most around.
pub fn normals_after(
    points: &[DVec3],
    neighbours: &Neighbours,
    before: &[DVec3],
    threads: usize,
    monitor: &Monitor,
) -> Result<Vec<DVec3>> {
    let mut normals = axes(points, neighbours, threads, monitor)?;
    for (now, before) in normals.iter_mut().zip(before) {
        if now.dot(*before) < 0.0 {
            *now = -*now;
        }
    }
    settle(points, &mut normals, neighbours);
    Ok(normals)
}

/// Unit normals on any side.
fn axes(
    points: &[DVec3],
    neighbours: &Neighbours,
    threads: usize,
    monitor: &Monitor,
) -> Result<Vec<DVec3>> {
    blocks(points.len(), threads, monitor, &|i| {
        let near = neighbours.of(i).iter().take(PLANE).map(|&q| points[q as usize]);
        principal_axes(near.chain([points[i]]).map(|p| (p - points[i], 1.0))).normal
    })
}

/// Turns single points round that are not on the side of most of their neighbours, of those beside them more than of
/// those across.
fn settle(points: &[DVec3], normals: &mut [DVec3], neighbours: &Neighbours) {
    for _ in 0..SETTLING {
        let mut turned = false;
        for i in 0..points.len() {
            let n = normals[i];
            let side = |&q: &u32| {
                let m = normals[q as usize];
                let along = (points[q as usize] - points[i]).normalize_or_zero();
                n.dot(m) * (1.0 - 0.5 * (n.dot(along).abs() + m.dot(along).abs()))
            };
            if neighbours.of(i).iter().take(LINKS).map(side).sum::<f64>() < 0.0 {
                normals[i] = -n;
                turned = true;
            }
        }
        if !turned {
            break;
        }
    }
}

fn orient(
    points: &[DVec3],
    normals: &mut [DVec3],
    neighbours: &Neighbours,
    given: Option<&[DVec3]>,
) {
    let tree = spanning_tree(points, normals, neighbours);
    let mut seen = vec![false; points.len()];
    let mut component: Vec<u32> = Vec::new();
    for start in 0..points.len() {
        if seen[start] {
            continue;
        }
        component.clear();
        component.push(start as u32);
        seen[start] = true;
        let mut at = 0;
        while at < component.len() {
            let from = component[at] as usize;
            at += 1;
            for &to in tree.of(from) {
                let to = to as usize;
                if !seen[to] {
                    seen[to] = true;
                    if normals[to].dot(normals[from]) < 0.0 {
                        normals[to] = -normals[to];
                    }
                    component.push(to as u32);
                }
            }
        }
        let vote = match given {
            Some(g) => component.iter().map(|&i| g[i as usize].dot(normals[i as usize])).sum(),
            None => outward_vote(points, normals, &component),
        };
        if vote < 0.0 {
            component.iter().for_each(|&i| normals[i as usize] = -normals[i as usize]);
        }
    }
}

/// Positive if the normals of the points that lie farthest out look out.
fn outward_vote(points: &[DVec3], normals: &[DVec3], component: &[u32]) -> f64 {
    let axes = [DVec3::X, DVec3::Y, DVec3::Z];
    let vote = |axis: DVec3| {
        let far = component.iter().max_by(|&&a, &&b| {
            points[a as usize].dot(axis).total_cmp(&points[b as usize].dot(axis)).then(b.cmp(&a))
        });
        far.map_or(0.0, |&i| normals[i as usize].dot(axis))
    };
    axes.iter().map(|&a| vote(a) + vote(-a)).sum()
}

/// Kruskal's tree over the edges between neighbours, those between like normals first.
fn spanning_tree(points: &[DVec3], normals: &[DVec3], neighbours: &Neighbours) -> Graph {
    let linked = |i: usize| neighbours.of(i).iter().take(LINKS);
    let mut edges: Vec<(u32, u32, u32)> = Vec::with_capacity(points.len() * 5);
    for i in 0..points.len() {
        for &j in linked(i) {
            if (j as usize) < i && linked(j as usize).any(|&k| k as usize == i) {
                continue;
            }
            let (n, m) = (normals[i], normals[j as usize]);
            let along = (points[j as usize] - points[i]).normalize_or_zero();
            let cost = 1.0 - n.dot(m).abs() + n.dot(along).abs() + m.dot(along).abs();
            // A float that is not negative sorts like its bits.
            edges.push(((cost.max(0.0) as f32).to_bits(), i as u32, j));
        }
    }
    edges.sort_unstable();
    let mut roots = Roots::new(points.len());
    let kept = edges.iter().filter(|&&(_, a, b)| roots.join(a, b)).map(|&(_, a, b)| [a, b]);
    let kept: Vec<[u32; 2]> = kept.collect();
    Graph::new(points.len(), &kept)
}

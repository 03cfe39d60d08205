//! Bendels, Schnabel and Klein (2005), "Fragment-based surface inpainting", Sec. 6.2: closed loops of
//! points that are likely to lie on a boundary, through a minimum spanning tree. A second opinion on
//! the rims of the mesh through the points, which knows nothing of that mesh.
//!
//! Differences from the paper:
//! - The cost of an edge is (2 − π(p) − π(q)) d(p, q): as printed, the likelier a boundary the dearer it
//!   is.
//! - Only likely points are in the graph ([`LIKELY`]): elsewhere there is nothing to be closed.
//! - Loops are told from chance ones by being where a rim is ([`agree`]).

use super::neighbours::Neighbours;
use crate::error::Result;
use crate::mesh::roots::Roots;
use crate::progress::Monitor;
use glam::DVec3;
use std::collections::{BTreeMap, VecDeque};

/// Points of less boundary probability are no part of a loop. On a hexagonal lattice a straight edge has
/// 0.6, the points behind it and inside have less than 0.25.
const LIKELY: f64 = 0.38;
/// An edge whose ends are joined already by so many or fewer others closes no hole: the loop has fewer
/// points than the smallest rim.
const SHORT: usize = super::tidy::SMALLEST_RIM - 2;
/// Share of the points of a rim that lie on or beside the loop, and of the loop on or beside the rim.
const SHARED: f64 = 0.6;

/// The loops, each as its points in order.
pub fn loops(
    points: &[DVec3],
    neighbours: &Neighbours,
    probability: &[f64],
    monitor: &Monitor,
) -> Result<Vec<Vec<u32>>> {
    let likely = |v: u32| probability[v as usize] >= LIKELY;
    let mut edges: Vec<(f64, u32, u32)> = Vec::new();
    for p in (0..points.len() as u32).filter(|&p| likely(p)) {
        for &q in neighbours.of(p as usize).iter().filter(|&&q| q > p && likely(q)) {
            // Of two that do not name each other one is beyond a gap.
            if neighbours.of(q as usize).contains(&p) {
                let unlikely = 2.0 - probability[p as usize] - probability[q as usize];
                let length = points[p as usize].distance(points[q as usize]);
                edges.push((unlikely * length, p, q));
            }
        }
    }
    edges.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
    let mut graph: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    let mut roots = Roots::new(points.len());
    let mut rest = Vec::new();
    for (_, p, q) in edges {
        match roots.join(p, q) {
            true => join(&mut graph, p, q),
            false => rest.push((p, q)),
        }
    }
    let mut all = Vec::new();
    for (p, q) in rest {
        monitor.check()?;
        if path(&graph, p, q, SHORT).is_none() {
            all.extend(path(&graph, p, q, usize::MAX));
            join(&mut graph, p, q);
        }
    }
    Ok(all)
}

fn join(graph: &mut BTreeMap<u32, Vec<u32>>, p: u32, q: u32) {
    graph.entry(p).or_default().push(q);
    graph.entry(q).or_default().push(p);
}

/// The path of fewest edges, at most `most`, with both ends.
fn path(graph: &BTreeMap<u32, Vec<u32>>, from: u32, to: u32, most: usize) -> Option<Vec<u32>> {
    let mut before = BTreeMap::from([(from, from)]);
    let mut queue = VecDeque::from([(from, 0)]);
    while let Some((v, steps)) = queue.pop_front() {
        if v == to {
            let mut all = vec![to];
            while let Some(&last) = all.last().filter(|v| **v != from) {
                all.push(before[&last]);
            }
            return Some(all);
        }
        if steps == most {
            continue;
        }
        for &w in graph.get(&v).map_or(&[][..], |list| list) {
            before.entry(w).or_insert_with(|| {
                queue.push_back((w, steps + 1));
                v
            });
        }
    }
    None
}

/// Neighbours that are beside a point: those at one spacing on an even cloud.
const BESIDE: usize = 6;

/// Whether some loop runs where a rim does.
pub fn agree(rim: &[u32], loops: &[Vec<u32>], neighbours: &Neighbours) -> bool {
    let wide = |list: &[u32]| {
        let beside = list.iter().flat_map(|&v| neighbours.of(v as usize).iter().take(BESIDE));
        let mut all: Vec<u32> = list.iter().chain(beside).copied().collect();
        all.sort_unstable();
        all.dedup();
        all
    };
    let shared = |list: &[u32], wide: &[u32]| {
        let count = list.iter().filter(|v| wide.binary_search(v).is_ok()).count();
        count as f64 >= SHARED * list.len() as f64
    };
    let around = wide(rim);
    loops.iter().any(|l| shared(l, &around) && shared(rim, &wide(l)))
}

#[cfg(test)]
mod tests {
    use super::super::boundary::probability;
    use super::*;

    /// A square lattice, a little shaken, with a round hole: one loop around it and one around the
    /// outside, each agreeing with the points that are there by construction.
    #[test]
    fn a_hole_and_the_outside_are_closed() {
        let noise = |k: usize, s: usize| 0.2 * (((k * s) % 1009) as f64 / 1009.0 - 0.5);
        let at = |k: usize| {
            let (i, j) = ((k % 40) as f64, (k / 40) as f64);
            DVec3::new(i + noise(k, 613), j + noise(k, 797), 0.0)
        };
        let centre = DVec3::new(19.5, 19.5, 0.0);
        let points: Vec<DVec3> = (0..1600).map(at).filter(|p| p.distance(centre) > 5.0).collect();
        let normals = vec![DVec3::Z; points.len()];
        let neighbours = Neighbours::new(&points, 1, &Monitor::silent()).unwrap();
        let likely: Vec<f64> =
            (0..points.len()).map(|i| probability(&points, &normals, &neighbours, i)).collect();
        let found = loops(&points, &neighbours, &likely, &Monitor::silent()).unwrap();
        let id = |keep: &dyn Fn(&DVec3) -> bool| -> Vec<u32> {
            (0..points.len()).filter(|&i| keep(&points[i])).map(|i| i as u32).collect()
        };
        let rim = id(&|p| p.distance(centre) < 5.9);
        assert!(agree(&rim, &found, &neighbours), "{} loops", found.len());
        let outside = id(&|p| (*p - centre).abs().max_element() > 19.1);
        assert!(agree(&outside, &found, &neighbours), "{} loops", found.len());
        // A ring of points in the intact part.
        let inside = id(&|p| (11.0..12.0).contains(&p.distance(centre)));
        assert!(inside.len() > 40 && !agree(&inside, &found, &neighbours));
        // Every loop is closed by neighbours.
        for l in &found {
            assert!(l.len() > SHORT);
            for (k, v) in l.iter().enumerate() {
                let next = l[(k + 1) % l.len()];
                assert!(neighbours.of(*v as usize).contains(&next));
            }
        }
    }

    #[test]
    fn without_likely_points_there_is_no_loop() {
        let points: Vec<DVec3> =
            (0..100).map(|k| DVec3::new((k % 10) as f64, (k / 10) as f64, 0.0)).collect();
        let neighbours = Neighbours::new(&points, 1, &Monitor::silent()).unwrap();
        let found = loops(&points, &neighbours, &[0.0; 100], &Monitor::silent()).unwrap();
        assert!(found.is_empty());
    }
}

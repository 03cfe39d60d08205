use super::super::simplify::{simplify, Coarse, Cost};
use super::{area, both, potato, sphere, square, Shape};
use crate::error::Error;
use crate::mesh::neighbourhood::NONE;
use crate::progress::Monitor;
use glam::DVec3;
use std::collections::HashMap;

const COSTS: [Cost; 2] = [Cost::Uniform, Cost::Quadric];

fn coarse((p, f): &Shape, target: usize, cost: Cost) -> Coarse {
    simplify(p, f, target, cost, &Monitor::silent()).unwrap()
}

/// Edges run one way by each of their faces, at most once; returns those with one face only.
fn boundary_edges(faces: &[[u32; 3]]) -> Vec<(u32, u32)> {
    let mut edges = HashMap::new();
    for f in faces {
        for k in 0..3 {
            assert!(edges.insert((f[k], f[(k + 1) % 3]), ()).is_none(), "edge twice");
        }
    }
    let mut open: Vec<_> =
        edges.keys().copied().filter(|&(a, b)| !edges.contains_key(&(b, a))).collect();
    open.sort_unstable();
    open
}

#[test]
fn closed_meshes_stay_manifold_and_keep_their_area() {
    let shape = potato(4);
    for cost in COSTS {
        for target in [300, 100, 30] {
            let c = coarse(&shape, target, cost);
            assert_eq!(c.positions.len(), target);
            assert_eq!(c.faces.len(), 2 * target - 4, "a sphere still");
            assert!(boundary_edges(&c.faces).is_empty());
            let ratio = area(&c.positions, &c.faces) / area(&shape.0, &shape.1);
            let off = if target == 300 { 0.03 } else { 0.25 };
            assert!((ratio - 1.0).abs() < off, "{cost:?} {target}: {ratio}");
            assert!(c.parent.iter().all(|&v| (v as usize) < target));
        }
    }
}

#[test]
fn uniform_means_even_edges() {
    let c = coarse(&potato(5), 400, Cost::Uniform);
    let mut lengths: Vec<f64> = (c.faces.iter())
        .flat_map(|f| [0, 1, 2].map(|k| [f[k], f[(k + 1) % 3]]))
        .map(|[a, b]| c.positions[a as usize].distance(c.positions[b as usize]))
        .collect();
    lengths.sort_by(f64::total_cmp);
    let (low, high) = (lengths[lengths.len() / 20], lengths[lengths.len() * 19 / 20]);
    assert!(high / low < 2.2, "{low} {high}");
}

/// Corners may be cut a little, but no more than that.
#[test]
fn boundaries_stay_where_they_are() {
    let shape = square(30);
    for (cost, off) in COSTS.into_iter().zip([0.01, 1e-3]) {
        let c = coarse(&shape, 60, cost);
        let area = area(&c.positions, &c.faces);
        assert!((area - 1.0).abs() < off, "{cost:?} {area}");
        let rim = boundary_edges(&c.faces);
        assert!(!rim.is_empty());
        for (a, _) in rim {
            let p = c.positions[a as usize];
            let inside = p.x.min(1.0 - p.x).min(p.y).min(1.0 - p.y);
            assert!(inside.abs() < off, "{cost:?} {p}");
        }
    }
}

#[test]
fn components_survive_and_small_meshes_are_untouched() {
    let shape = both(&sphere(3), &sphere(0), DVec3::splat(5.0));
    let c = coarse(&shape, 8, Cost::Uniform);
    assert_eq!(c.faces.len(), 2 * c.positions.len() - 8, "two spheres");
    assert_eq!(c.positions.len(), 8, "two tetrahedra");
    let c = coarse(&shape, 1000, Cost::Quadric);
    assert_eq!((c.positions, c.faces), shape);
    let triangle = (vec![DVec3::ZERO, DVec3::X, DVec3::Y], vec![[0, 1, 2]]);
    assert_eq!(coarse(&triangle, 0, Cost::Uniform).faces, triangle.1);
    assert!(coarse(&(vec![], vec![]), 0, Cost::Uniform).faces.is_empty());
}

/// What scans bring: repeated corners, slivers without area, edges of three faces, fans that touch
/// in a vertex, vertices without faces, and once even coordinates that are no numbers.
#[test]
fn odd_meshes_do_no_harm() {
    let mut shape = potato(3);
    let n = shape.0.len() as u32;
    shape.0.extend([DVec3::splat(3.0), shape.0[0], DVec3::splat(9.0)]);
    shape.1.extend([[0, 0, 1], [0, 6, n], [n + 1, 0, 6], [5, 4, n]]);
    for cost in COSTS {
        let c = coarse(&shape, 20, cost);
        assert!(c.positions.len() < 40, "{}", c.positions.len());
        assert_eq!(c.parent[n as usize + 2], NONE);
        assert!(c.faces.iter().all(|f| f[0] != f[1] && f[1] != f[2] && f[2] != f[0]));
    }
    shape.0[7] = DVec3::NAN;
    shape.0[9] = DVec3::INFINITY;
    coarse(&shape, 20, Cost::Uniform);
    // Faces between arbitrary vertices.
    let mut random = super::super::spectrum::Random(5);
    let mut below = |n: u64| (random.next_bits() % n) as u32;
    for _ in 0..50 {
        let p = (0..12).map(|_| DVec3::new(below(4).into(), below(4).into(), below(4).into()));
        let p: Vec<DVec3> = p.collect();
        let f = (0..30).map(|_| [below(12), below(12), below(12)]).collect();
        coarse(&(p, f), 3, Cost::Quadric);
    }
}

#[test]
fn it_can_be_cancelled() {
    let (p, f) = sphere(4);
    let monitor = Monitor::silent();
    monitor.cancel();
    let result = simplify(&p, &f, 10, Cost::Uniform, &monitor);
    assert_eq!(result.err(), Some(Error::Cancelled));
}

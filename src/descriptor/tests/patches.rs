use super::super::ball::{Balls, VertexGraph};
use super::super::patch_signature::{
    Domain, Index, Moments, Neighbour, Surface, SEARCH_DIMENSIONS,
};
use super::super::{laplacian, Spectral};
use super::{potato, sphere, square, Shape};
use crate::progress::Monitor;
use glam::{DMat3, DVec3};

fn moments((p, f): &Shape, centres: &[u32], radius: f64) -> Moments {
    let monitor = Monitor::silent();
    let spectral = Spectral::with_sizes(p, f, 1500, 100, &monitor).unwrap();
    let surface = Surface {
        positions: p,
        graph: &VertexGraph::new(p.len(), f),
        mass: &laplacian::lumped_masses(p, f),
        prolongation: &spectral.prolongation,
    };
    Moments::new(surface, &spectral.heat(), centres, radius, &monitor).unwrap()
}

#[test]
fn balls_are_connected_and_exact() {
    let (mut p, f) = square(10);
    // The last row is bent back over the first one: near in space, far on the surface.
    for i in 0..11 {
        p[110 + i] = p[i] + DVec3::Z * 0.01;
    }
    let graph = VertexGraph::new(p.len(), &f);
    assert_eq!(graph.neighbours(60), &[48, 49, 59, 61, 71, 72]);
    let mut patch = Vec::new();
    Balls::new(&p, &graph).gather(5, 0.15, &mut patch);
    patch.sort_unstable();
    assert_eq!(patch, vec![4, 5, 6, 15, 16, 17], "not 115, at a distance of 0.01");
}

#[test]
fn signatures_do_not_change_with_the_pose() {
    let shape = potato(4);
    let turn = DMat3::from_axis_angle(DVec3::new(1.0, -2.0, 0.5).normalize(), 1.2)
        * DMat3::from_diagonal(DVec3::new(-1.0, 1.0, 1.0));
    let mut moved = shape.clone();
    moved.0.iter_mut().for_each(|p| *p = turn * *p + DVec3::new(5.0, 3.0, -1.0));
    moved.1.iter_mut().for_each(|f| f.swap(1, 2));
    let centres: Vec<u32> = (0..100).map(|i| i * 10).collect();
    let signatures = |shape| moments(shape, &centres, 0.3).paper(Domain::LowerHalf);
    for (x, y) in signatures(&shape).rows.iter().zip(&signatures(&moved).rows) {
        assert!((x - y).abs() <= 1e-3 * x.abs().max(0.1), "{x} {y}");
    }
}

#[test]
fn the_papers_descriptor_has_its_sizes_and_its_norm() {
    let m = moments(&potato(3), &[0, 7], 0.4);
    for (domain, dim) in Domain::ALL.into_iter().zip([200, 150, 100]) {
        let s = m.paper(domain);
        assert_eq!((s.dim, s.len()), (dim, 2));
        let (mean, variance) = s.row(1).split_at(dim / 2);
        for part in [mean, variance] {
            assert_eq!(part.iter().fold(0.0f32, |m, x| m.max(*x)), 1.0);
        }
    }
    assert!(m.variance(0).iter().all(|&x| x >= 0.0));
}

/// A sphere with the same lopsided bump left and right, mirrored, and another one on top: what is
/// among the five patches most like one on the left is its image on the right (the first of them at 23
/// of 30 places: the paper's signature is ruled by the shortest times).
#[test]
fn the_twin_is_among_the_nearest_patches() {
    let (mut p, f) = sphere(5);
    for q in &mut p {
        let d = *q;
        let bump = |at: DVec3, height: f64, width: f64| {
            height * (-d.distance_squared(at.normalize()) / (width * width)).exp()
        };
        let sides = [-1.0, 1.0].map(|s| {
            bump(DVec3::new(s, 0.3, 0.4), 0.3, 0.25) + bump(DVec3::new(s, 0.6, 0.3), -0.15, 0.2)
        });
        *q = d * (1.0 + sides[0] + sides[1] + bump(DVec3::new(0.0, 0.2, 1.0), 0.25, 0.3));
    }
    // Not quite symmetric as a mesh.
    for (i, q) in p.iter_mut().enumerate() {
        *q += 0.002 * DVec3::new((i as f64).sin(), (2.3 * i as f64).sin(), (3.7 * i as f64).cos());
    }
    let pick = |side: f64| -> Vec<u32> {
        let all = 0..p.len() as u32;
        all.filter(|&v| p[v as usize].x * side > 0.15).collect()
    };
    let (left, right) = (pick(-1.0), pick(1.0));
    let near_bump =
        |v: &u32| p[*v as usize].normalize().distance(DVec3::new(-1.0, 0.4, 0.4).normalize()) < 0.3;
    let targets: Vec<u32> = left.into_iter().filter(near_bump).step_by(3).collect();
    assert!(targets.len() > 20);
    let shape = (p.clone(), f);
    let monitor = Monitor::silent();
    let source = moments(&shape, &right, 0.25).paper(Domain::Whole);
    let target = moments(&shape, &targets, 0.25).paper(Domain::Whole);
    let index = Index::new(source, SEARCH_DIMENSIONS, &monitor).unwrap();
    let found = index.nearest(&target, 5, &monitor).unwrap();
    let mut hits = 0;
    for (t, near) in targets.iter().zip(&found) {
        assert_eq!(near.len(), 5);
        assert!(near.is_sorted());
        let image = p[*t as usize] * DVec3::new(-1.0, 1.0, 1.0);
        let is_twin = |n: &Neighbour| p[right[n.source as usize] as usize].distance(image) < 0.25;
        hits += usize::from(near.iter().any(is_twin));
    }
    assert!(hits * 10 >= targets.len() * 9, "{hits} of {}", targets.len());
}

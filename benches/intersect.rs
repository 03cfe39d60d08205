//! Cost of the exact self-intersection test: a sphere with a cap as its fill.
//!
//! `cargo bench --bench intersect`. One thread of an AMD EPYC shared with other work, best of 200
//! runs: sphere 3.5 ms (20,000 pairs), tree 1.8 ms, closest points 1.0 ms, tilted plane 2.9 ms. Means
//! under that load are 40 to 55 % higher.

#![allow(missing_docs)] // what the macros of criterion make

use complete_mesh::intersect::{find_intersections, Bvh};
use criterion::{criterion_group, criterion_main, Criterion};
use glam::DVec3;
use std::hint::black_box;

/// A sphere of `rings` x `sectors` quads cut in two; the `cap` rings around the pole come last.
fn sphere(rings: u32, sectors: u32, cap: u32) -> (Vec<DVec3>, Vec<[u32; 3]>, usize) {
    let mut positions = Vec::new();
    for i in 0..=rings {
        // Not quite to the poles, which are no part of the test.
        let polar = std::f64::consts::PI * (0.02 + 0.96 * f64::from(i) / f64::from(rings));
        for j in 0..sectors {
            let turn = std::f64::consts::TAU * (f64::from(j) + 0.5 * f64::from(i % 2))
                / f64::from(sectors);
            let p = DVec3::new(polar.sin() * turn.cos(), polar.sin() * turn.sin(), polar.cos());
            // Scan data: f32, with some roughness.
            let rough = 1.0 + 0.003 * (f64::from(i * 7 + j * 13)).sin();
            positions.push((p * rough).as_vec3().as_dvec3());
        }
    }
    let mut faces = Vec::new();
    let mut fill_start = 0;
    for i in (0..rings).rev() {
        if i + 1 == cap {
            fill_start = faces.len();
        }
        for j in 0..sectors {
            let [a, b] = [i * sectors + j, i * sectors + (j + 1) % sectors];
            let [c, d] = [a + sectors, b + sectors];
            if i % 2 == 0 {
                faces.extend([[a, c, b], [b, c, d]]);
            } else {
                faces.extend([[a, c, d], [a, d, b]]);
            }
        }
    }
    (positions, faces, fill_start)
}

/// A flat sheet, tilted: nothing in it is in general position and no coordinate is constant.
fn tilted_sheet(side: u32) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let (u, v) = (DVec3::new(0.8, 0.3, 0.1), DVec3::new(-0.2, 0.9, 0.4));
    let positions = (0..=side)
        .flat_map(|i| (0..=side).map(move |j| u * f64::from(i) + v * f64::from(j)))
        .collect();
    let at = |i: u32, j: u32| i * (side + 1) + j;
    let quads = (0..side).flat_map(|i| (0..side).map(move |j| (i, j)));
    let faces = quads
        .flat_map(|(i, j)| {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            [[a, b, c], [a, c, d]]
        })
        .collect();
    (positions, faces)
}

fn bench(c: &mut Criterion) {
    let (positions, faces, fill_start) = sphere(60, 75, 20);
    assert_eq!((fill_start, faces.len() - fill_start), (6000, 3000));
    assert!(find_intersections(&positions, &faces, fill_start).is_empty());
    c.bench_function("sphere, 3,000 fill faces among 9,000", |b| {
        b.iter(|| find_intersections(black_box(&positions), &faces, fill_start));
    });
    c.bench_function("tree over 9,000 faces", |b| {
        b.iter(|| Bvh::new(black_box(&positions), &faces));
    });
    let tree = Bvh::new(&positions, &faces);
    let queries: Vec<DVec3> = positions.iter().take(1000).map(|&p| p * 1.01).collect();
    c.bench_function("1,000 closest points, 9,000 faces", |b| {
        b.iter(|| {
            let hits = queries.iter().filter_map(|&q| tree.closest_point(q, f64::INFINITY));
            hits.map(|h| h.distance).sum::<f64>()
        });
    });
    let (positions, faces) = tilted_sheet(39);
    assert!(find_intersections(&positions, &faces, 0).is_empty());
    c.bench_function("tilted plane, 3,042 fill faces", |b| {
        b.iter(|| find_intersections(black_box(&positions), &faces, 0));
    });
}

criterion_group!(benches, bench);
criterion_main!(benches);

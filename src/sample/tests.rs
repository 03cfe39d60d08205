//! What the samples promise: closed, manifold, oriented outward, of the right genus, with edges of
//! nearly one length; and the breaks the loops they promise.

use super::*;
use std::collections::HashMap;

/// Half-edges that occur, and how often each.
fn half_edges(mesh: &SampleMesh) -> HashMap<(u32, u32), usize> {
    let mut count = HashMap::new();
    for f in &mesh.faces {
        for k in 0..3 {
            *count.entry((f[k], f[(k + 1) % 3])).or_insert(0) += 1;
        }
    }
    count
}

/// Boundary loops as vertex lists; panics where the rim touches itself.
fn loops(mesh: &SampleMesh) -> Vec<Vec<u32>> {
    let edges = half_edges(mesh);
    assert!(edges.values().all(|&n| n == 1), "an edge runs twice the same way");
    let mut next = HashMap::new();
    for &(a, b) in edges.keys() {
        if !edges.contains_key(&(b, a)) {
            assert!(next.insert(b, a).is_none(), "the rim passes vertex {b} twice");
        }
    }
    let mut loops = Vec::new();
    while let Some(&start) = next.keys().min() {
        let mut line = vec![start];
        let mut at = next.remove(&start);
        while let Some(v) = at.filter(|&v| v != start) {
            line.push(v);
            at = next.remove(&v);
        }
        loops.push(line);
    }
    loops
}

fn volume(mesh: &SampleMesh) -> f64 {
    (0..mesh.faces.len())
        .map(|f| {
            let [a, b, c] = mesh.corners(f);
            (a[0] * (b[1] * c[2] - b[2] * c[1])
                + a[1] * (b[2] * c[0] - b[0] * c[2])
                + a[2] * (b[0] * c[1] - b[1] * c[0]))
                / 6.0
        })
        .sum()
}

fn edge_lengths(mesh: &SampleMesh) -> Vec<f64> {
    let mut lengths: Vec<f64> = half_edges(mesh)
        .keys()
        .map(|&(a, b)| {
            let (p, q) = (mesh.vertices[a as usize], mesh.vertices[b as usize]);
            (0..3).map(|k| f64::from(p[k] - q[k]).powi(2)).sum::<f64>().sqrt()
        })
        .collect();
    lengths.sort_by(f64::total_cmp);
    lengths
}

#[test]
fn samples_are_closed_manifold_and_oriented() {
    for sample in Sample::ALL {
        for resolution in [MIN_RESOLUTION, 61, 120] {
            let mesh = sample.build(resolution).unwrap();
            let edges = half_edges(&mesh);
            let name = format!("{} at {resolution}", sample.name());
            assert!(edges.values().all(|&n| n == 1), "{name}: an edge runs twice the same way");
            assert!(edges.keys().all(|&(a, b)| edges.contains_key(&(b, a))), "{name}: open");
            let euler =
                mesh.vertices.len() as i64 - edges.len() as i64 / 2 + mesh.faces.len() as i64;
            assert_eq!(euler, if sample == Sample::Torus { 0 } else { 2 }, "{name}");
            assert!(volume(&mesh) > 0.1, "{name}: {}", volume(&mesh));
            // One fan around each vertex: as many faces as leaving edges in one closed walk.
            let mut around: HashMap<u32, HashMap<u32, u32>> = HashMap::new();
            for f in &mesh.faces {
                for k in 0..3 {
                    around.entry(f[k]).or_default().insert(f[(k + 1) % 3], f[(k + 2) % 3]);
                }
            }
            for (v, fan) in &around {
                let start = *fan.keys().next().unwrap();
                let steps = std::iter::successors(Some(start), |w| {
                    fan.get(w).copied().filter(|&w| w != start)
                });
                assert_eq!(steps.count(), fan.len(), "{name}: vertex {v} has two fans");
            }
            assert_eq!(around.len(), mesh.vertices.len(), "{name}: isolated vertices");
        }
    }
}

#[test]
fn volumes_are_those_of_the_shapes() {
    let pi = std::f64::consts::PI;
    for (sample, exact) in [
        (Sample::Sphere, 4.0 / 3.0 * pi),
        (Sample::Torus, 2.0 * pi * pi * torus::MAJOR * torus::MINOR * torus::MINOR),
    ] {
        let coarse = (volume(&sample.build(50).unwrap()) / exact - 1.0).abs();
        let fine = (volume(&sample.build(200).unwrap()) / exact - 1.0).abs();
        // An inscribed polyhedron errs by the square of the edge: 16 times less at a quarter.
        assert!(coarse < 0.01 && fine < coarse / 12.0, "{} {coarse} {fine}", sample.name());
    }
}

#[test]
fn edges_are_nearly_of_one_length() {
    for sample in Sample::ALL {
        let lengths = edge_lengths(&sample.build(200).unwrap());
        let aim = sample.longest_side() / 200.0;
        let mean = lengths.iter().sum::<f64>() / lengths.len() as f64;
        let (low, high) = (lengths[lengths.len() / 100], lengths[lengths.len() * 99 / 100]);
        let name = sample.name();
        assert!((0.8..1.25).contains(&(mean / aim)), "{name}: mean {}", mean / aim);
        assert!(low > 0.45 * mean && high < 2.0 * mean, "{name}: {} {}", low / mean, high / mean);
    }
}

#[test]
fn arrises_lie_on_the_plain_shaft() {
    // On an arris the groove has depth 0: radius 1 at mid-height, and only there.
    let mesh = Sample::Column.build(200).unwrap();
    let ring: Vec<f64> = mesh
        .vertices
        .iter()
        .filter(|v| (v[1] - 1.5).abs() < 0.012)
        .map(|v| f64::from(v[0]).hypot(f64::from(v[2])))
        .collect();
    let greatest = ring.iter().copied().fold(0.0, f64::max);
    let least = ring.iter().copied().fold(9.0, f64::min);
    assert!(ring.iter().filter(|&&r| greatest - r < 1e-3).count() >= 20);
    assert!((0.06..0.1).contains(&(1.0 - least / greatest)), "{least} {greatest}");
}

#[test]
fn resolution_is_checked() {
    for bad in [0, MIN_RESOLUTION - 1, MAX_RESOLUTION + 1, usize::MAX] {
        assert!(
            matches!(Sample::Leg.build(bad), Err(Error::InvalidOption { name, .. }) if name == "resolution")
        );
    }
}

#[test]
fn breaks_leave_the_promised_loops() {
    for sample in Sample::ALL {
        // The coarsest mesh that the promise covers.
        let resolution = (10.0 * sample.longest_side() / sample.site().radius).ceil() as usize;
        let whole = sample.build(resolution).unwrap();
        for kind in Break::ALL {
            for seed in 0..3 {
                let options = BreakOptions { kind, seed, size: 1.0 };
                let broken = break_mesh(sample, &whole, &options).unwrap();
                let name = format!("{} {} seed {seed}", sample.name(), kind.name());
                assert_eq!(loops(&broken.mesh).len(), kind.promised().0, "{name}");
                assert!(broken.removed.faces.len() > 50, "{name}");
                let total = broken.mesh.faces.len() + broken.removed.faces.len();
                assert_eq!(total, whole.faces.len(), "{name}");
                for (v, &old) in broken.mesh.vertices.iter().zip(&broken.kept_vertices) {
                    assert_eq!(*v, whole.vertices[old as usize], "{name}");
                }
            }
        }
    }
}

#[test]
fn breaks_are_the_same_for_the_same_seed_and_differ_for_another() {
    let whole = Sample::Column.build(100).unwrap();
    let make = |seed| {
        break_mesh(Sample::Column, &whole, &BreakOptions { kind: Break::Ragged, seed, size: 1.0 })
            .unwrap()
    };
    assert_eq!(make(1), make(1));
    assert_ne!(make(1).mesh, make(2).mesh);
}

#[test]
fn a_thin_wall_breaks_on_one_side_only() {
    // The ball around the vessel's outside also reaches its inside: only the outside goes.
    let whole = Sample::Vessel.build(160).unwrap();
    let options = BreakOptions { kind: Break::Disc, seed: 0, size: 1.0 };
    let broken = break_mesh(Sample::Vessel, &whole, &options).unwrap();
    let site = Sample::Vessel.site();
    let near = |m: &SampleMesh| {
        (0..m.faces.len()).any(|f| {
            let c = m.centroid(f);
            c[2] < 1.0 && (0..3).map(|k| (c[k] - site.point[k]).powi(2)).sum::<f64>() < 0.05
        })
    };
    assert!(near(&broken.mesh) && !near(&broken.removed));
}

#[test]
fn break_size_is_checked() {
    let whole = Sample::Sphere.build(40).unwrap();
    for size in [0.0, -1.0, 2.0, f64::NAN] {
        let options = BreakOptions { kind: Break::Disc, seed: 0, size };
        assert!(matches!(
            break_mesh(Sample::Sphere, &whole, &options),
            Err(Error::InvalidOption { name: "size", .. })
        ));
    }
}

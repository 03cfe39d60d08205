use super::super::heat::{heat_times, Heat};
use super::super::spectrum::Spectrum;
use super::super::Spectral;
use super::{area, both, potato, sphere, square, Shape};
use crate::progress::Monitor;
use glam::DVec3;

fn spectrum((p, f): &Shape, pairs: usize) -> Spectrum {
    Spectrum::new(p, f, None, pairs, &Monitor::silent()).unwrap()
}

/// l (l + 1), each 2 l + 1 times, on the unit sphere.
#[test]
fn eigenvalues_of_the_sphere() {
    let s = spectrum(&sphere(5), 36);
    let mut values = s.values.iter();
    for l in 1..6 {
        for _ in 0..2 * l + 1 {
            let (value, exact) = (*values.next().unwrap(), f64::from(l * (l + 1)));
            assert!((value / exact - 1.0).abs() < 0.02, "{value} {exact}");
        }
    }
    assert_eq!(s.component_mass.len(), 1);
}

/// Of 1,026 vertices the 40 lowest pairs come from Lanczos; a dense solve has to agree. Asking for
/// nearly all pairs makes it dense.
#[test]
fn sparse_and_dense_agree() {
    let shape = potato(4);
    let (sparse, dense) = (spectrum(&shape, 60), spectrum(&shape, 1000));
    assert_eq!((sparse.values.len(), dense.values.len()), (59, 999));
    for i in 0..40 {
        let (a, b) = (sparse.values[i], dense.values[i]);
        assert!((a / b - 1.0).abs() < 1e-6, "pair {i}: {a} {b}");
        let n = shape.0.len();
        let dot: f64 =
            (0..n).map(|v| sparse.mass[v] * sparse.vectors[(v, i)] * dense.vectors[(v, i)]).sum();
        assert!(dot.abs() > 0.999, "pair {i}: {dot}");
    }
}

#[test]
fn vectors_are_orthonormal() {
    let s = spectrum(&potato(4), 60);
    for i in 0..59 {
        for j in 0..=i {
            let dot: f64 =
                (0..s.mass.len()).map(|v| s.mass[v] * s.vectors[(v, i)] * s.vectors[(v, j)]).sum();
            let wanted = if i == j { 1.0 } else { 0.0 };
            assert!((dot - wanted).abs() < 1e-8, "{i} {j}: {dot}");
        }
    }
}

/// Σ m h_t(x, x) = Σ exp(−λ t), with several components, too.
#[test]
fn masses_times_signatures_sum_up_to_the_trace() {
    for shape in [potato(4), both(&potato(3), &square(5), DVec3::splat(4.0))] {
        let s = spectrum(&shape, 50);
        let heat = Heat::new(&s, heat_times(&s, 20));
        for (t, time) in heat.times.iter().enumerate() {
            let sum: f64 = (0..s.mass.len()).map(|v| s.mass[v] * heat.row(v)[t]).sum();
            // The zeros, one a component, count 1.
            let zeros = s.component_mass.len() as f64;
            let trace = zeros + s.values.iter().map(|l| (-l * time).exp()).sum::<f64>();
            assert!((sum / trace - 1.0).abs() < 1e-9);
        }
    }
}

#[test]
fn meshes_of_any_size_have_a_spectrum() {
    let monitor = Monitor::silent();
    let triangle = (vec![DVec3::ZERO, DVec3::X, DVec3::Y], vec![[0, 1, 2]]);
    let flat = (vec![DVec3::ZERO, DVec3::X, 2.0 * DVec3::X], vec![[0, 1, 2]]);
    let pair = both(&triangle, &triangle, DVec3::Z);
    for (shape, values) in [(&triangle, 2), (&flat, 2), (&pair, 4), (&sphere(0), 5)] {
        let spectral = Spectral::new(&shape.0, &shape.1, &monitor).unwrap();
        assert_eq!(spectral.spectrum.values.len(), values);
        let heat = spectral.heat();
        assert!(heat.values.iter().all(|x| x.is_finite()));
    }
    let empty = Spectral::new(&[], &[], &monitor).unwrap();
    assert!(empty.heat().values.is_empty());
    // More components than pairs.
    let p: Vec<DVec3> = (0..60)
        .map(|i| DVec3::new(f64::from(i / 3), f64::from(i % 3), 0.0) + DVec3::Z * f64::from(i % 2))
        .collect();
    let f: Vec<[u32; 3]> = (0..20).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let s = spectrum(&(p, f), 10);
    assert_eq!((s.component_mass.len(), s.values.len()), (20, 9));
}

/// Per component the spectrum is that of the component alone: two spheres give each value twice.
#[test]
fn components_do_not_mix() {
    let one = potato(3);
    let two = both(&one, &one, DVec3::X * 7.0);
    let (a, b) = (spectrum(&one, 30), spectrum(&two, 60));
    for i in 0..20 {
        for k in 0..2 {
            assert!((b.values[2 * i + k] / a.values[i] - 1.0).abs() < 1e-6);
        }
    }
}

/// On a quarter of the vertices signatures are still those of the fine mesh.
#[test]
fn coarse_signatures_are_those_of_the_fine_mesh() {
    let shape = potato(5);
    let monitor = Monitor::silent();
    let spectral = Spectral::with_sizes(&shape.0, &shape.1, 1000, 60, &monitor).unwrap();
    let total: f64 = spectral.spectrum.mass.iter().sum();
    assert!((total / area(&shape.0, &shape.1) - 1.0).abs() < 1e-9);
    let fine = spectrum(&shape, 60);
    let times = heat_times(&fine, 10);
    let exact = Heat::new(&fine, times.clone());
    let heat = Heat::new(&spectral.spectrum, times);
    let mut worst = 0.0f64;
    for v in 0..shape.0.len() {
        let got = heat.at_fine(&spectral.prolongation, v);
        for (a, b) in got.iter().zip(exact.row(v)) {
            worst = worst.max((a / b - 1.0).abs());
        }
    }
    assert!(worst < 0.04, "{worst}");
}

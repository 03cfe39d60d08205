//! Cost of the library call: fills of broken samples at two resolutions, and the search for the
//! holes alone on a large mesh.
//!
//! `cargo bench --bench complete`; how to read it is in `benches/README.md`.

#![allow(missing_docs)] // what the macros of criterion make

use complete_mesh::sample::{break_mesh, Break, BreakOptions, Sample, SampleMesh};
use complete_mesh::{
    complete_mesh_with, find_holes, Appearance, Grouping, HoleStatus, Method, Monitor, Options,
};
use cpu_time::ProcessTime;
use criterion::{criterion_group, criterion_main, BenchmarkId, Criterion, Throughput};
use std::hint::black_box;
use std::sync::Arc;
use std::time::Duration;

/// A disc with sharp features around it, a smooth one, a missing band, five discs in one mesh.
const CASES: [(Sample, Break); 4] = [
    (Sample::Column, Break::Ragged),
    (Sample::Vessel, Break::Disc),
    (Sample::Leg, Break::Ring),
    (Sample::Torus, Break::Several),
];
/// Edges along the longest side. Twice as many are four times the mesh and four times the fill.
const RESOLUTIONS: [usize; 2] = [150, 300];
/// For the search: 1.2 million faces.
const LARGE: usize = 600;

fn broken(sample: Sample, kind: Break, resolution: usize) -> SampleMesh {
    let whole = sample.build(resolution).expect("the resolution is in range");
    let options = BreakOptions { kind, seed: 1, size: 1.0 };
    break_mesh(sample, &whole, &options).expect("the size is in range").mesh
}

fn fill(c: &mut Criterion) {
    let mut group = c.benchmark_group("fill");
    // One thread: criterion measures wall time, and a second thread would hide work.
    let options = Options { threads: 1, method: Method::Smooth, ..Options::default() };
    for (sample, kind) in CASES {
        for resolution in RESOLUTIONS {
            let mesh = broken(sample, kind, resolution);
            let run = || complete_mesh_with(mesh.view(), &options, &Monitor::silent());
            let name = format!("{} {}", sample.name(), kind.name());
            let once = match run() {
                Ok(once) => once,
                // The other cases are still worth their time.
                Err(error) => {
                    eprintln!("fill/{name}/{resolution} not measured: {error}");
                    continue;
                }
            };
            assert!(once.holes.iter().all(|h| h.status == HoleStatus::Filled));
            group.throughput(Throughput::Elements(once.faces.len() as u64));
            group.bench_function(BenchmarkId::new(name, resolution), |b| b.iter(run));
        }
    }
    group.finish();
}

/// Shape and appearance at the sizes of Park et al. (2006): 40,000 and 145,000 points, one hole and five. CPU time
/// of one thread, which other programs hardly change.
fn appearance(c: &mut Criterion) {
    let mut group = c.benchmark_group("appearance");
    for (kind, resolution) in [(Break::Disc, 100), (Break::Several, 190)] {
        let mesh = broken(Sample::Vessel, kind, resolution);
        let paint = Sample::Vessel.paint(&mesh.vertices).expect("the vessel is painted");
        let values = paint.iter().flat_map(|c| c[..3].iter().map(|&x| f64::from(x))).collect();
        let colours = Appearance { channels: 3, steering: 3, values, exemplar_values: Vec::new() };
        let (colours, size) = (Arc::new(colours), mesh.vertices.len());
        for method in [Method::Coherent, Method::Warp] {
            for painted in [false, true] {
                let appearance = painted.then(|| colours.clone());
                let options = Options { threads: 1, method, appearance, ..Options::default() };
                let run = || {
                    let made = complete_mesh_with(mesh.view(), &options, &Monitor::silent())?;
                    let values = options.appearance.as_ref();
                    let values = values.map(|a| a.complete(mesh.view().faces, None, &made));
                    Ok::<_, complete_mesh::Error>((made, values))
                };
                let with = if painted { "with colours" } else { "without" };
                let name = format!("{} {} {with}", method.name(), kind.name());
                let spent = |count: u64| {
                    let clock = ProcessTime::now();
                    (0..count).for_each(|_| _ = black_box(run().expect("filled")));
                    clock.elapsed()
                };
                group.bench_function(BenchmarkId::new(name, size), |b| b.iter_custom(spent));
            }
        }
    }
    group.finish();
}

fn search(c: &mut Criterion) {
    let mut group = c.benchmark_group("find_holes");
    let mesh = broken(Sample::Column, Break::Several, LARGE);
    group.throughput(Throughput::Elements(mesh.faces.len() as u64));
    group.bench_function(BenchmarkId::new("column several", LARGE), |b| {
        b.iter(|| find_holes(black_box(mesh.view()), &Grouping::Automatic, &Monitor::silent()));
    });
    group.finish();
}

// As configuration, not in the groups, where the command line could not change it.
criterion_group! {
    name = quick;
    config = Criterion::default().sample_size(20).measurement_time(Duration::from_secs(4));
    targets = fill, search
}
criterion_group! {
    name = slow;
    config = Criterion::default().sample_size(10).measurement_time(Duration::from_secs(8));
    targets = appearance
}
criterion_main!(quick, slow);

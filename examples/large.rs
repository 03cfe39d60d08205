//! Fills one hole in a sphere of ten million vertices and says what that cost.
//!
//! `cargo run --release --example large [-- EDGES]`, EDGES (default 1000) being how many edges
//! each edge of an icosahedron is cut into: 10 · EDGES² + 2 vertices. The figures are in
//! `docs/speed.md`. The memory figures are read from `/proc/self` and so need Linux.

use complete_mesh::{complete_mesh, HoleStatus, Method, Options};
use std::f64::consts::TAU;

/// Radius of the hole, in edges of the mesh: some 400 edges around, as the rim of a
/// broken-off piece has them. It does not grow with the mesh, so that what grows is the pass.
const HOLE_EDGES: f64 = 60.0;

type Mesh = (Vec<[f32; 3]>, Vec<[u32; 3]>);

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let edges = match std::env::args().nth(1) {
        Some(text) => text.parse::<usize>()?.clamp(80, 10_000),
        None => 1000,
    };
    let (vertices, faces) = broken_sphere(edges);
    let arrays = mib(size_of_val(&vertices[..]) + size_of_val(&faces[..]));
    println!("input      {} vertices, {} faces, {arrays:.1} MiB", vertices.len(), faces.len());

    forget_peak();
    let before = memory("VmRSS");
    let options = Options { method: Method::Smooth, ..Options::default() };
    let completion = complete_mesh(&vertices[..], &faces[..], &options)?;
    let peak = memory("VmHWM");
    for hole in &completion.holes {
        let (v, f) = (hole.vertices.len(), hole.faces.len());
        println!("hole       {:?}: {v} new vertices, {f} new faces", hole.status);
        assert_eq!(hole.status, HoleStatus::Filled);
    }
    println!("time       {:.2} s, CPU {:.2} s", completion.seconds, completion.cpu_seconds);
    let hole_seconds: f64 = completion.holes.iter().map(|h| h.seconds).sum();
    println!("           {hole_seconds:.2} s of it for the hole, the rest for the pass");
    if let (Some(before), Some(peak)) = (before, peak) {
        println!("memory     {before:.1} MiB resident before, {peak:.1} MiB at the peak");
        println!("           peak / input arrays = {:.2}", peak / arrays);
    }
    let (all_vertices, all_faces) = completion.to_mesh_f32(&vertices, &faces);
    assert!(all_vertices[..vertices.len()] == vertices && all_faces[..faces.len()] == faces);
    if let Some(peak) = memory("VmHWM") {
        println!("           {:.2} with the whole mesh put together, too", peak / arrays);
    }
    Ok(())
}

/// The unit sphere without a disc around one point, and without the vertices that no face needs.
fn broken_sphere(edges: usize) -> Mesh {
    let (mut vertices, mut faces) = sphere(edges);
    // An icosahedron's edge sees an angle of 63.4°.
    let least = (HOLE_EDGES * 63.4f64.to_radians() / edges as f64).cos();
    // Some point that is no corner of the icosahedron and looks along no axis.
    let towards = normalised([0.5, 0.3, 0.81]);
    faces.retain(|face| {
        let sum: [f64; 3] = std::array::from_fn(|k| {
            face.iter().map(|&v| f64::from(vertices[v as usize][k])).sum::<f64>()
        });
        let centre = normalised(sum);
        (0..3).map(|k| centre[k] * towards[k]).sum::<f64>() < least
    });
    let mut number = vec![u32::MAX; vertices.len()];
    faces.iter().flatten().for_each(|&v| number[v as usize] = 0);
    let mut kept = 0;
    for v in 0..vertices.len() {
        if number[v] == 0 {
            number[v] = kept as u32;
            vertices[kept] = vertices[v];
            kept += 1;
        }
    }
    vertices.truncate(kept);
    faces.iter_mut().flatten().for_each(|v| *v = number[*v as usize]);
    (vertices, faces)
}

/// An icosahedron, each face cut into `n` by `n` triangles, drawn onto the unit sphere.
fn sphere(n: usize) -> Mesh {
    let (corners, sides) = icosahedron();
    let mut vertices: Vec<[f32; 3]> = Vec::with_capacity(10 * n * n + 2);
    vertices.extend(corners.map(|p| p.map(|x| x as f32)));
    // Vertices inside the edges of the icosahedron belong to two of its faces.
    let mut first_on_edge = std::collections::HashMap::new();
    for [a, b, c] in sides {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            let (from, to) = (from.min(to), from.max(to));
            first_on_edge.entry((from, to)).or_insert_with(|| {
                let first = vertices.len();
                for i in 1..n {
                    vertices.push(between(&corners, [from, to, to], [n - i, i, 0]));
                }
                first
            });
        }
    }
    let mut faces = Vec::with_capacity(20 * n * n);
    for side @ [a, b, c] in sides {
        let inside = vertices.len();
        for i in 1..n {
            for j in 1..n - i {
                vertices.push(between(&corners, side, [n - i - j, i, j]));
            }
        }
        let on_edge = |from: usize, to: usize, i: usize| {
            let first = first_on_edge[&(from.min(to), from.max(to))];
            first + if from < to { i - 1 } else { n - 1 - i }
        };
        // i steps towards b, j towards c. Row i inside begins after those of 1 to i - 1, which
        // have n - 1 - r vertices each.
        let at = |i: usize, j: usize| match (n - i - j, i, j) {
            (_, 0, 0) => a,
            (0, _, 0) => b,
            (0, 0, _) => c,
            (_, i, 0) => on_edge(a, b, i),
            (_, 0, j) => on_edge(a, c, j),
            (0, _, j) => on_edge(b, c, j),
            (_, i, j) => inside + (i - 1) * (n - 1) - i * (i - 1) / 2 + j - 1,
        };
        for i in 0..n {
            for j in 0..n - i {
                faces.push([at(i, j), at(i + 1, j), at(i, j + 1)].map(|v| v as u32));
                if i + j + 1 < n {
                    faces.push([at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)].map(|v| v as u32));
                }
            }
        }
    }
    (vertices, faces)
}

/// Two poles and two rings of five, the lower one turned by half a step.
fn icosahedron() -> ([[f64; 3]; 12], [[usize; 3]; 20]) {
    let height = 1.0 / 5f64.sqrt();
    let ring = |i: usize, turn: f64, z: f64| {
        let (sin, cos) = ((i as f64 + turn) * TAU / 5.0).sin_cos();
        [2.0 * height * cos, 2.0 * height * sin, z]
    };
    let corners = std::array::from_fn(|v| match v {
        0 => [0.0, 0.0, 1.0],
        1..=5 => ring(v - 1, 0.0, height),
        6..=10 => ring(v - 6, 0.5, -height),
        _ => [0.0, 0.0, -1.0],
    });
    let sides = std::array::from_fn(|f| {
        let i = f % 5;
        let (up, next_up) = (1 + i, 1 + (i + 1) % 5);
        let (low, next_low) = (6 + i, 6 + (i + 1) % 5);
        match f / 5 {
            0 => [0, up, next_up],
            1 => [up, low, next_up],
            2 => [low, next_low, next_up],
            _ => [11, next_low, low],
        }
    });
    (corners, sides)
}

fn between(corners: &[[f64; 3]; 12], of: [usize; 3], weights: [usize; 3]) -> [f32; 3] {
    let sum =
        std::array::from_fn(|k| (0..3).map(|i| corners[of[i]][k] * weights[i] as f64).sum::<f64>());
    normalised(sum).map(|x| x as f32)
}

fn normalised(p: [f64; 3]) -> [f64; 3] {
    let length = p.iter().map(|x| x * x).sum::<f64>().sqrt();
    p.map(|x| x / length)
}

fn mib(bytes: usize) -> f64 {
    bytes as f64 / (1024.0 * 1024.0)
}

/// Lets the kernel begin a new peak: making the mesh took more than its arrays.
fn forget_peak() {
    // Where this is not allowed the figure is too large, never too small.
    let _ = std::fs::write("/proc/self/clear_refs", "5");
}

/// A line of `/proc/self/status`, in MiB.
fn memory(name: &str) -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|l| l.starts_with(name))?;
    let kib: f64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(kib / 1024.0)
}

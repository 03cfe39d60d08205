//! Small meshes for the tests of this room and of `matching`.

mod patches;
mod simplify;
mod spectrum;

use glam::DVec3;
use std::collections::HashMap;

pub(crate) type Shape = (Vec<DVec3>, Vec<[u32; 3]>);

/// An octahedron whose faces were split into four `level` times, blown up to the unit sphere:
/// 4^(level + 1) + 2 vertices.
pub(crate) fn sphere(level: usize) -> Shape {
    let mut p = vec![DVec3::X, DVec3::Y, DVec3::Z, -DVec3::X, -DVec3::Y, -DVec3::Z];
    let mut faces: Vec<[u32; 3]> = vec![
        [0, 1, 2],
        [1, 3, 2],
        [3, 4, 2],
        [4, 0, 2],
        [1, 0, 5],
        [3, 1, 5],
        [4, 3, 5],
        [0, 4, 5],
    ];
    for _ in 0..level {
        let mut middle = HashMap::new();
        let mut split = Vec::new();
        for [a, b, c] in faces {
            let mut mid = |u: u32, v: u32| {
                *middle.entry((u.min(v), u.max(v))).or_insert_with(|| {
                    p.push((p[u as usize] + p[v as usize]).normalize());
                    p.len() as u32 - 1
                })
            };
            let (x, y, z) = (mid(a, b), mid(b, c), mid(c, a));
            split.extend([[a, x, z], [x, b, y], [z, y, c], [x, y, z]]);
        }
        faces = split;
    }
    (p, faces)
}

/// A sphere with bumps of different kinds, so that no eigenvalue repeats.
pub(crate) fn potato(level: usize) -> Shape {
    let (mut p, f) = sphere(level);
    for q in &mut p {
        let d = *q;
        let bump = |at: DVec3, height: f64, width: f64| {
            height * (-d.distance_squared(at.normalize()) / (width * width)).exp()
        };
        let r = 1.0
            + bump(DVec3::new(1.0, 0.2, 0.1), 0.4, 0.5)
            + bump(DVec3::new(-0.3, 1.0, 0.5), 0.25, 0.3)
            + bump(DVec3::new(0.1, -0.4, -1.0), -0.2, 0.6);
        *q = d * r * DVec3::new(1.0, 0.9, 1.15);
    }
    (p, f)
}

/// A flat square of n × n cells.
pub(crate) fn square(n: u32) -> Shape {
    let at = |i: u32, j: u32| i * (n + 1) + j;
    let mut p = Vec::new();
    let mut f = Vec::new();
    for i in 0..=n {
        for j in 0..=n {
            p.push(DVec3::new(f64::from(i), f64::from(j), 0.0) / f64::from(n));
            if i < n && j < n {
                f.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
                f.push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
            }
        }
    }
    (p, f)
}

/// Two meshes as one, the second moved.
pub(crate) fn both(a: &Shape, b: &Shape, offset: DVec3) -> Shape {
    let mut all = a.clone();
    let n = a.0.len() as u32;
    all.0.extend(b.0.iter().map(|&p| p + offset));
    all.1.extend(b.1.iter().map(|f| f.map(|v| v + n)));
    all
}

pub(crate) fn area(p: &[DVec3], f: &[[u32; 3]]) -> f64 {
    super::laplacian::lumped_masses(p, f).iter().sum()
}

//! Hand-made meshes.

use complete_mesh::intersect::Bvh;
use complete_mesh::sample::{break_mesh, Break, BreakOptions, Sample, SampleMesh};
use complete_mesh::{Completion, MeshView};
use glam::{DQuat, DVec3};

/// A mesh that owns its arrays.
#[derive(Debug, Clone, Default)]
pub struct Mesh {
    pub vertices: Vec<[f64; 3]>,
    pub faces: Vec<[u32; 3]>,
}

impl Mesh {
    pub fn view(&self) -> MeshView<'_> {
        MeshView::new(&self.vertices[..], &self.faces[..])
    }

    /// Index of the vertex at exactly this place.
    pub fn at(&self, p: [f64; 3]) -> u32 {
        self.vertices.iter().position(|&q| q == p).expect("a vertex there") as u32
    }

    /// Mean length of the faces' first edges.
    pub fn mean_edge(&self) -> f64 {
        let p = |v: u32| DVec3::from(self.vertices[v as usize]);
        let length = |f: &[u32; 3]| p(f[0]).distance(p(f[1]));
        self.faces.iter().map(length).sum::<f64>() / self.faces.len() as f64
    }

    /// Drops vertices that no face uses.
    fn compact(mut self) -> Self {
        let mut new = vec![u32::MAX; self.vertices.len()];
        self.faces.iter().flatten().for_each(|&v| new[v as usize] = 0);
        let mut kept = Vec::new();
        for (v, p) in self.vertices.iter().enumerate() {
            if new[v] == 0 {
                new[v] = kept.len() as u32;
                kept.push(*p);
            }
        }
        self.faces.iter_mut().flatten().for_each(|v| *v = new[*v as usize]);
        self.vertices = kept;
        self
    }

    /// Scaled, then turned, then moved.
    pub fn moved(&self, scale: f64, turn: DQuat, by: DVec3) -> Self {
        let to = |p: &[f64; 3]| (turn * (scale * DVec3::from(*p)) + by).to_array();
        Self { vertices: self.vertices.iter().map(to).collect(), faces: self.faces.clone() }
    }
}

/// A decorated vessel with something broken off, and the vessel whole.
pub fn broken_vessel(kind: Break) -> (Mesh, Mesh) {
    let whole = Sample::Vessel.build(110).unwrap();
    let options = BreakOptions { kind, seed: 1, size: 0.8 };
    let broken = break_mesh(Sample::Vessel, &whole, &options).unwrap().mesh;
    let mesh = |sample: SampleMesh| Mesh {
        vertices: sample.vertices.iter().map(|p| p.map(f64::from)).collect(),
        faces: sample.faces,
    };
    (mesh(broken), mesh(whole))
}

pub fn tetrahedron_without_floor() -> Mesh {
    Mesh {
        vertices: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        faces: vec![[0, 1, 3], [0, 3, 2], [1, 2, 3]],
    }
}

/// A sheet of nx × ny unit cells, two faces each, mapped by `place`; cells that `keep` refuses
/// are missing.
pub fn sheet(
    (nx, ny): (usize, usize),
    place: impl Fn(f64, f64) -> [f64; 3],
    keep: impl Fn(usize, usize) -> bool,
) -> Mesh {
    let mut mesh = Mesh::default();
    for j in 0..=ny {
        for i in 0..=nx {
            mesh.vertices.push(place(i as f64, j as f64));
        }
    }
    let id = |i: usize, j: usize| (j * (nx + 1) + i) as u32;
    for j in 0..ny {
        for i in (0..nx).filter(|&i| keep(i, j)) {
            let (a, b, c, d) = (id(i, j), id(i + 1, j), id(i + 1, j + 1), id(i, j + 1));
            mesh.faces.extend([[a, b, c], [a, c, d]]);
        }
    }
    mesh.compact()
}

pub fn flat(x: f64, y: f64) -> [f64; 3] {
    [x, y, 0.0]
}

/// Whether a cell lies in the square [lo, hi).
pub fn within(i: usize, j: usize, lo: usize, hi: usize) -> bool {
    (lo..hi).contains(&i) && (lo..hi).contains(&j)
}

/// A grid of `rows` × n cells closed around, `place(row, angle)`; faces look away from the axis
/// where the angle turns right-handed about the direction of growing rows.
pub fn tube(
    n: usize,
    rows: usize,
    place: impl Fn(usize, f64) -> [f64; 3],
    keep: impl Fn(usize, usize) -> bool,
) -> Mesh {
    let mut mesh = Mesh::default();
    for r in 0..=rows {
        for i in 0..n {
            mesh.vertices.push(place(r, std::f64::consts::TAU * i as f64 / n as f64));
        }
    }
    let id = |r: usize, i: usize| (r * n + i % n) as u32;
    for r in 0..rows {
        for i in (0..n).filter(|&i| keep(r, i)) {
            let (a, b, c, d) = (id(r, i), id(r, i + 1), id(r + 1, i + 1), id(r + 1, i));
            mesh.faces.extend([[a, b, c], [a, c, d]]);
        }
    }
    mesh.compact()
}

/// Greatest distance of the new vertices from a surface, in mean edges.
pub fn off(made: &Completion, truth: &Mesh) -> f64 {
    let corners: Vec<DVec3> = truth.vertices.iter().map(|&p| DVec3::from(p)).collect();
    let tree = Bvh::new(&corners, &truth.faces);
    let from = |p: &[f64; 3]| tree.closest_point(DVec3::from(*p), f64::INFINITY).unwrap().distance;
    made.vertices.iter().map(from).fold(0.0, f64::max) / truth.mean_edge()
}

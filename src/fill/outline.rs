//! The rim of one hole as the fill sees it: positions, sizes, normals, and edges already taken.

use super::even::share;
use super::polygon::Rim;
use super::sheet::Incidence;
use crate::mesh::neighbourhood::Neighbourhood;
use glam::DVec3;

/// The rim of one hole. Patch vertex i is neighbourhood vertex `vertices[i]`.
#[derive(Clone)]
pub struct Outline {
    /// Neighbourhood vertices of all loops, one after the other.
    pub vertices: Vec<u32>,
    /// Their positions.
    pub positions: Vec<DVec3>,
    /// Mean length of the input's edges around each, in mesh units.
    pub sizes: Vec<f64>,
    /// The loops in patch vertices.
    pub rims: Vec<Rim>,
    /// Edges that the input has between rim vertices: (smaller, larger), sorted.
    pub taken: Vec<(u32, u32)>,
    /// Around a cloud's hole, how many triangles there are for one that is equilateral with edges as they are at
    /// the rim ([`share`]): the fill shall have as many. `None`: as refinement has them.
    pub share: Option<f64>,
    /// Whether refinement gives the fill as many, spread evenly.
    pub is_even: bool,
}

/// Radii of a hole around its middle within which the points say how dense they are.
const AROUND: f64 = 1.5;
/// With fewer triangles there the whole neighbourhood says it.
const FEWEST: usize = 200;

impl Outline {
    /// Collects the rim of the hole whose loops are given in neighbourhood vertices.
    pub fn new(near: &Neighbourhood, incidence: &Incidence, loops: &[Vec<u32>]) -> Self {
        let vertices: Vec<u32> = loops.iter().flatten().copied().collect();
        let positions = vertices.iter().map(|&v| near.positions.get(v)).collect();
        let sizes = vertices.iter().map(|&v| mean_edge(near, incidence, v)).collect();
        let mut first = 0;
        let rims = loops
            .iter()
            .map(|l| {
                let n = l.len();
                let normal = |i: usize| edge_normal(near, incidence, l[i], l[(i + 1) % n]);
                let rim = Rim {
                    vertices: (first..first + n as u32).collect(),
                    normals: (0..n).map(normal).collect(),
                };
                first += n as u32;
                rim
            })
            .collect();
        let taken = taken_edges(near, incidence, &vertices);
        Self { vertices, positions, sizes, rims, taken, share: None, is_even: false }
    }

    /// Measures the share. `sizes` must be the input's.
    pub fn measure_share(&mut self, near: &Neighbourhood) {
        let (middle, radius) = (self.middle(), self.radius());
        let corners = |f: usize| near.corners(f as u32);
        let is_near = |c: &[DVec3; 3]| c[0].distance_squared(middle) < (AROUND * radius).powi(2);
        let all = || (0..near.faces.len()).map(corners);
        let enough = all().filter(is_near).nth(FEWEST).is_some();
        let counted = all().filter(|c| !enough || is_near(c));
        self.share = Some(share(counted, &self.sizes));
    }

    fn middle(&self) -> DVec3 {
        self.positions.iter().copied().sum::<DVec3>() / self.positions.len().max(1) as f64
    }

    /// Greatest distance of a rim vertex from the middle of all, in mesh units.
    pub fn radius(&self) -> f64 {
        let middle = self.middle();
        self.positions.iter().map(|p| p.distance(middle)).fold(0.0, f64::max)
    }

    /// Mean of the sizes.
    pub fn mean_size(&self) -> f64 {
        self.sizes.iter().sum::<f64>() / self.sizes.len().max(1) as f64
    }
}

fn mean_edge(near: &Neighbourhood, incidence: &Incidence, v: u32) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for &f in incidence.faces(v) {
        let p = near.corners(f);
        sum += p[0].distance(p[1]) + p[1].distance(p[2]) + p[2].distance(p[0]);
        count += 3.0;
    }
    sum / f64::max(count, 1.0)
}

/// Unit normal of the input face that runs the edge as b → a; zero if it has no area.
fn edge_normal(near: &Neighbourhood, incidence: &Incidence, a: u32, b: u32) -> DVec3 {
    for &f in incidence.faces(a) {
        let face = near.faces[f as usize];
        if (0..3).any(|k| face[k] == b && face[(k + 1) % 3] == a) {
            let p = near.corners(f);
            return (p[1] - p[0]).cross(p[2] - p[0]).normalize_or_zero();
        }
    }
    DVec3::ZERO
}

fn taken_edges(near: &Neighbourhood, incidence: &Incidence, rim: &[u32]) -> Vec<(u32, u32)> {
    let mut order: Vec<(u32, u32)> = rim.iter().copied().zip(0..).collect();
    order.sort_unstable();
    let patch_vertex = |v: u32| order.binary_search_by_key(&v, |o| o.0).ok().map(|i| order[i].1);
    let mut taken = Vec::new();
    for (i, &v) in rim.iter().enumerate() {
        for w in incidence.faces(v).iter().flat_map(|&f| near.faces[f as usize]) {
            if let Some(j) = patch_vertex(w).filter(|&j| i < j as usize) {
                taken.push((i as u32, j));
            }
        }
    }
    taken.sort_unstable();
    taken.dedup();
    taken
}

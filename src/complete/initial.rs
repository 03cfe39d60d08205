//! Initial completions from outside (Harary et al. 2014, Sec. 3: any will do): the part that fills one
//! hole, checked.

use super::check::Obstacles;
use super::smooth::{Fill, Surroundings};
use crate::error::Result;
use crate::fill::outline::Outline;
use crate::fill::patch::Patch;
use crate::options::{Fairing, Initial, Method};
use glam::DVec3;
use std::collections::{BTreeMap, HashMap};

/// An initial completion, ready to be asked for its parts.
pub struct InitialFaces<'a> {
    initial: &'a Initial,
    input_vertices: u32,
    /// Faces at each vertex that has any.
    at: HashMap<u32, Vec<u32>>,
}

impl<'a> InitialFaces<'a> {
    /// Of a mesh with so many vertices; the faces were checked by [`Initial::check`].
    pub fn new(initial: &'a Initial, input_vertices: usize) -> Self {
        let mut at: HashMap<u32, Vec<u32>> = HashMap::new();
        for (f, face) in initial.faces.iter().enumerate() {
            face.iter().for_each(|&v| at.entry(v).or_default().push(f as u32));
        }
        Self { initial, input_vertices: input_vertices as u32, at }
    }

    /// The fill of the hole whose loops are given in neighbourhood vertices. The inner error says why it
    /// fills the hole not at all, or not as the contract asks.
    pub fn fill_hole(
        &self,
        around: &Surroundings<'_>,
        loops: &[Vec<u32>],
        obstacles: &Obstacles<'_>,
        check: &dyn Fn(f64) -> Result<()>,
    ) -> Result<std::result::Result<Fill, String>> {
        let outline = Outline::new(around.near, &around.incidence.get(), loops);
        let patch = match self.patch(around, &outline) {
            Ok(patch) => patch,
            Err(why) => return Ok(Err(format!("its initial completion {why}"))),
        };
        check(0.5)?;
        let settled = obstacles.settle(around, patch, &|| check(0.9))?;
        Ok(settled.map(|patch| Fill {
            outline,
            patch,
            fairing: Fairing::None,
            method: Method::Smooth,
            coherence_error: None,
            candidates: 0,
            story: None,
        }))
    }

    fn patch(
        &self,
        around: &Surroundings<'_>,
        outline: &Outline,
    ) -> std::result::Result<Patch, String> {
        let rim = outline.vertices.iter().map(|&v| around.near.vertices[v as usize]);
        let mut number: HashMap<u32, u32> = rim.enumerate().map(|(i, v)| (v, i as u32)).collect();
        let mut positions = outline.positions.clone();
        // From the rim inward, through new vertices only.
        let mut queue: Vec<u32> =
            outline.vertices.iter().map(|&v| around.near.vertices[v as usize]).collect();
        let mut faces: BTreeMap<u32, [u32; 3]> = BTreeMap::new();
        while let Some(v) = queue.pop() {
            for &f in self.at.get(&v).map_or(&[][..], |list| list) {
                if faces.contains_key(&f) {
                    continue;
                }
                let corners = self.initial.faces[f as usize];
                for &w in &corners {
                    let Some(new) = w.checked_sub(self.input_vertices) else { continue };
                    number.entry(w).or_insert_with(|| {
                        positions.push(DVec3::from(self.initial.vertices[new as usize]));
                        queue.push(w);
                        positions.len() as u32 - 1
                    });
                }
                faces.insert(f, corners);
            }
        }
        let local = |f: &[u32; 3]| {
            let corner = |v: u32| match number.get(&v) {
                Some(&i) => Ok(i),
                None => Err(format!("uses vertex {v} of the mesh, which is not on the rim")),
            };
            Ok::<_, String>([corner(f[0])?, corner(f[1])?, corner(f[2])?])
        };
        let triangles = faces.values().map(local).collect::<std::result::Result<Vec<_>, _>>()?;
        check_edges(&triangles, outline)?;
        let sizes = sizes(&positions, &triangles, outline);
        Ok(Patch::of_triangles(positions, sizes, outline.vertices.len(), triangles))
    }
}

/// Each inner edge must be there once in each direction, each rim edge once.
pub fn check_edges(triangles: &[[u32; 3]], outline: &Outline) -> std::result::Result<(), String> {
    let mut open: BTreeMap<(u32, u32), u32> = BTreeMap::new();
    for t in triangles {
        for k in 0..3 {
            *open.entry((t[k], t[(k + 1) % 3])).or_default() += 1;
        }
    }
    if open.values().any(|&count| count > 1) {
        return Err("is not manifold or not oriented: two faces run one edge the same way".into());
    }
    for rim in &outline.rims {
        let n = rim.vertices.len();
        for i in 0..n {
            let edge = (rim.vertices[i], rim.vertices[(i + 1) % n]);
            if open.remove(&edge).is_none() {
                return Err("does not reach all of its rim, or faces the other way".into());
            }
        }
    }
    match open.keys().find(|(a, b)| !open.contains_key(&(*b, *a))) {
        Some(_) => Err("has a hole of its own".into()),
        None => Ok(()),
    }
}

/// Wanted edge lengths: those of the rim, and what the initial completion has inside.
fn sizes(positions: &[DVec3], triangles: &[[u32; 3]], outline: &Outline) -> Vec<f64> {
    let mut sums = vec![(0.0, 0.0); positions.len()];
    for t in triangles {
        for k in 0..3 {
            let (a, b) = (t[k] as usize, t[(k + 1) % 3] as usize);
            let length = positions[a].distance(positions[b]);
            for v in [a, b] {
                sums[v].0 += length;
                sums[v].1 += 1.0;
            }
        }
    }
    let mut sizes: Vec<f64> = sums.iter().map(|(sum, n)| sum / f64::max(*n, 1.0)).collect();
    sizes[..outline.sizes.len()].copy_from_slice(&outline.sizes);
    sizes
}

//! What a completion returns.

use crate::error::{Error, Problem};
use crate::options::{Fairing, Method};
use std::ops::Range;

/// What became of one hole.
#[derive(Debug, Clone, PartialEq)]
pub enum HoleStatus {
    /// Filled, the contract kept.
    Filled,
    /// Not asked for.
    NotSelected,
    /// Left open because it cannot be filled safely (only with `skip_unsafe`).
    Unsafe(Problem),
    /// Left open because no fill kept the contract (only with `skip_unsafe`).
    Failed(Error),
}

/// One hole's part of the result.
#[derive(Debug, Clone, PartialEq)]
pub struct HoleReport {
    /// Id of the hole, as in [`crate::HoleList`].
    pub hole: usize,
    /// Boundary loops (indices into [`crate::HoleList::loops`]).
    pub loops: Vec<usize>,
    /// What became of it.
    pub status: HoleStatus,
    /// The method that made the fill: a smooth one where nothing on the object served.
    pub method: Method,
    /// Coherence error (Harary et al. 2014, Eq. 3, root mean square, in mesh units) of the initial
    /// completion and of the fill; `None` where no source was looked for.
    pub coherence_error: Option<[f64; 2]>,
    /// The fairing that was used; never `Auto` on a filled hole.
    pub fairing: Fairing,
    /// Its vertices in [`Completion::vertices`].
    pub vertices: Range<usize>,
    /// Its faces in [`Completion::faces`].
    pub faces: Range<usize>,
    /// Wall seconds.
    pub seconds: f64,
}

/// The new elements. The input is not in it: the caller has it, and it does not change.
#[derive(Debug, Clone, PartialEq)]
pub struct Completion {
    /// How many vertices the input has: the index of the first new one.
    pub input_vertex_count: usize,
    /// How many faces the input has.
    pub input_face_count: usize,
    /// New vertices, in mesh units; exactly representable in f32 if the input is f32.
    pub vertices: Vec<[f64; 3]>,
    /// New faces; an index below `input_vertex_count` names an input vertex.
    pub faces: Vec<[u32; 3]>,
    /// For each new vertex the id of its hole.
    pub vertex_hole: Vec<u32>,
    /// For each new face the id of its hole.
    pub face_hole: Vec<u32>,
    /// One report for each hole of the mesh, by id.
    pub holes: Vec<HoleReport>,
    /// Wall seconds of the call.
    pub seconds: f64,
    /// CPU seconds of the call, all threads of the process.
    pub cpu_seconds: f64,
}

impl Completion {
    /// The whole mesh, the input first, bit for bit.
    pub fn to_mesh_f64(
        &self,
        vertices: &[[f64; 3]],
        faces: &[[u32; 3]],
    ) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
        (join(vertices, self.vertices.iter().copied()), join(faces, self.faces.iter().copied()))
    }

    /// The whole mesh in f32, the input first, bit for bit.
    pub fn to_mesh_f32(
        &self,
        vertices: &[[f32; 3]],
        faces: &[[u32; 3]],
    ) -> (Vec<[f32; 3]>, Vec<[u32; 3]>) {
        let new = self.vertices.iter().map(|p| p.map(|x| x as f32));
        (join(vertices, new), join(faces, self.faces.iter().copied()))
    }
}

fn join<T: Copy>(first: &[T], rest: impl ExactSizeIterator<Item = T>) -> Vec<T> {
    let mut all = Vec::with_capacity(first.len() + rest.len());
    all.extend_from_slice(first);
    all.extend(rest);
    all
}

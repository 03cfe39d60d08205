//! What a completion returns.

use crate::error::{Error, Problem};
use crate::matching::rigid::Rigid;
use crate::options::{Fairing, Method};
use std::ops::Range;
use std::sync::Arc;

/// "No such": of a face or a source in an [`Origin`].
pub const NONE: u32 = u32::MAX;

/// Where a new vertex comes from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Origin {
    /// The input face it was copied from; [`NONE`] if from nowhere (a smooth fill, a gap in the
    /// source).
    pub face: u32,
    /// Barycentric coordinates on that face: the weights of its corners, in the face's order; they
    /// sum to 1. All 0 without a face.
    pub barycentric: [f64; 3],
    /// Index into [`HoleReport::sources`] of the copy that gave the detail; [`NONE`] without one.
    pub source: u32,
    /// 0 (nothing on the object backs it) to 1: how much better than a smooth surface the copy
    /// predicted known surface that was hidden from it, 1 / (1 + ratio²) with the ratio of the
    /// errors.
    pub confidence: f64,
}

impl Origin {
    /// Of a vertex that no source gave.
    pub const NOWHERE: Self =
        Self { face: NONE, barycentric: [0.0; 3], source: NONE, confidence: 0.0 };

    /// Whether no source gave it.
    pub fn is_nowhere(&self) -> bool {
        self.face == NONE
    }
}

/// A confidence in a word. `convincing`, from 0.8: hidden surface was predicted with at most half
/// the error of a smooth surface. `plausible`, from 0.5: not worse than by a smooth surface.
/// `invention`: worse, or nothing backs it. See [`Origin::confidence`].
pub fn confidence_word(confidence: f64) -> &'static str {
    match confidence {
        c if c >= 0.8 => "convincing",
        c if c >= 0.5 => "plausible",
        _ => "invention",
    }
}

/// A place on the object that a fill was continued from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SourceReport {
    /// From the place to the hole: a rotation, or a reflection, a translation, and in some a stretch of a
    /// few per cent; scaled where that was allowed.
    pub transform: Rigid,
    /// Root mean square error at known vertices near the rim that were hidden from the fit, in mesh
    /// units.
    pub error: f64,
    /// Share in the low frequencies of the fill, 0 to 1; they sum to 1.
    pub weight: f64,
    /// New vertices whose detail comes from here.
    pub vertices: usize,
    /// New vertices whose colours and other values come from here and their shape from elsewhere.
    pub coloured: usize,
}

/// Where a copy lies at a vertex that it did not give, but beside one that it did: on the rim, or across
/// the border to another copy. There two surfaces meet, and this says what the copy has on the other
/// side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seam {
    /// The vertex, as faces name it.
    pub vertex: u32,
    /// Index into [`HoleReport::sources`].
    pub source: u32,
    /// The face of the source, as in [`Origin::face`].
    pub face: u32,
    /// Barycentric coordinates on it.
    pub barycentric: [f64; 3],
}

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
    /// The fairing of the smooth fill that it is or comes from: the caller's where that has a say
    /// ([`Fairing`]). Never `Auto` on a filled hole.
    pub fairing: Fairing,
    /// Where the fill was continued from, the greatest weight first; none for a smooth fill.
    pub sources: Vec<SourceReport>,
    /// The copies beyond their borders: what closes the seams of colours and other values.
    pub seams: Vec<Seam>,
    /// The copies on the known ring around the hole, at some hundreds of its vertices: whether they have
    /// there what is known says how far to believe the rest of what they carry.
    pub ring: Vec<Seam>,
    /// How many candidates it had, if one was asked for ([`crate::Guidance::candidate`]); else 0.
    pub candidates: usize,
    /// 0 to 1, see [`Origin::confidence`]; 0 for a smooth fill.
    pub confidence: f64,
    /// Coherence error (Harary et al. 2014, Eq. 3, root mean square, in mesh units) of the initial
    /// completion and of the fill; `None` where no source was looked for.
    pub coherence_error: Option<[f64; 2]>,
    /// Its vertices in [`Completion::vertices`].
    pub vertices: Range<usize>,
    /// Its faces in [`Completion::faces`].
    pub faces: Range<usize>,
    /// Wall seconds.
    pub seconds: f64,
}

impl HoleReport {
    /// How it was filled, for people: the method that won, how many sources it had and how far to
    /// believe it, e.g. "coherent, 4 sources, confidence 0.93 (convincing)".
    pub fn summary(&self) -> String {
        let name = self.method.name();
        match self.sources.len() {
            0 => format!("{name}, no source"),
            n => format!(
                "{name}, {n} source{}, confidence {:.2} ({})",
                if n == 1 { "" } else { "s" },
                self.confidence,
                confidence_word(self.confidence)
            ),
        }
    }
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
    /// For each new vertex where it comes from.
    pub origins: Vec<Origin>,
    /// For each new vertex where its colours and other values come from, if for some that is another place
    /// than where its shape does; else empty. See [`Completion::colours_from`].
    pub colour_origins: Vec<Origin>,
    /// Rim vertices that fills were only joined at, as they were given ([`crate::Guidance::loose`]): values do
    /// not go on from them.
    pub loose: Arc<[u32]>,
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
    /// For each new vertex where its colours and other values come from.
    pub fn colours_from(&self) -> &[Origin] {
        match self.colour_origins.len() == self.origins.len() {
            true => &self.colour_origins,
            false => &self.origins,
        }
    }

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

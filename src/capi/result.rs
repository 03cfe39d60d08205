//! The result of a completion for C: arrays in the input's own number type.

use super::choices::CVertexType;
use super::error::{Failure, Status};
use super::guard::guard_value;
use super::holes::Holes;
use super::input::Input;
use crate::points::{CleanedPoints, PointCompletion};
use crate::result::{Completion, Origin};
use std::ffi::c_void;

/// Packed positions, in the number type of the input.
enum Positions {
    Single(Vec<[f32; 3]>),
    Double(Vec<[f64; 3]>),
}

/// Where the new vertices come from, an array for each question.
struct Origins {
    faces: Vec<u32>,
    barycentrics: Vec<[f64; 3]>,
    sources: Vec<u32>,
    confidences: Vec<f64>,
}

impl Origins {
    fn new(origins: &[Origin]) -> Result<Self, Failure> {
        fn column<T>(origins: &[Origin], of: impl Fn(&Origin) -> T) -> Result<Vec<T>, Failure> {
            let mut all = reserved(origins.len())?;
            all.extend(origins.iter().map(of));
            Ok(all)
        }
        Ok(Self {
            faces: column(origins, |o| o.face)?,
            barycentrics: column(origins, |o| o.barycentric)?,
            sources: column(origins, |o| o.source)?,
            confidences: column(origins, |o| o.confidence)?,
        })
    }
}

/// A completed mesh. Opaque; read by the functions complete_mesh_result_..., from any number of
/// threads; free it with complete_mesh_result_free.
pub struct MeshResult {
    /// The input's, if the whole mesh was asked for, then the new ones.
    positions: Positions,
    faces: Vec<[u32; 3]>,
    /// Where in `positions` and `faces` the new ones start.
    first_new: (usize, usize),
    input_counts: (usize, usize),
    whole_mesh: bool,
    vertex_hole: Vec<u32>,
    origins: Origins,
    /// Of a cloud: source points and normals of the new points.
    source_points: Vec<u32>,
    normals: Vec<[f64; 3]>,
    /// Of a cloud that was cleaned: positions and flags of all input points.
    cleaned: Vec<[f64; 3]>,
    removed: Vec<u8>,
    /// Of the new vertices.
    values: Vec<f64>,
    face_hole: Vec<u32>,
    holes: Holes,
    seconds: f64,
    cpu_seconds: f64,
}

/// A vector that will hold `count` elements, or a failure instead of the abort that running out of
/// memory is otherwise.
fn reserved<T>(count: usize) -> Result<Vec<T>, Failure> {
    let mut vec = Vec::new();
    match vec.try_reserve_exact(count) {
        Ok(()) => Ok(vec),
        Err(_) => Err(Failure::new(
            Status::OutOfMemory,
            "no memory for the whole mesh: ask for the new elements only",
        )),
    }
}

impl MeshResult {
    pub(super) fn new(
        input: &Input,
        holes: Holes,
        completion: Completion,
        values: Vec<f64>,
        whole_mesh: bool,
    ) -> Result<Self, Failure> {
        let input_counts = (completion.input_vertex_count, completion.input_face_count);
        let first_new = if whole_mesh { input_counts } else { (0, 0) };
        let vertex_total = first_new.0 + completion.vertices.len();
        let positions = if input.view.vertices.is_single() {
            let mut all: Vec<[f32; 3]> = reserved(vertex_total)?;
            if whole_mesh {
                input.append_vertices(&mut all);
            }
            // Exact: the new vertices of an f32 mesh are f32 numbers.
            all.extend(completion.vertices.iter().map(|p| p.map(|x| x as f32)));
            Positions::Single(all)
        } else {
            let mut all: Vec<[f64; 3]> = reserved(vertex_total)?;
            if whole_mesh {
                input.append_vertices(&mut all);
            }
            all.extend_from_slice(&completion.vertices);
            Positions::Double(all)
        };
        let mut faces = reserved(first_new.1 + completion.faces.len())?;
        if whole_mesh {
            input.append_faces(&mut faces);
        }
        faces.extend_from_slice(&completion.faces);
        Ok(MeshResult {
            positions,
            faces,
            first_new,
            input_counts,
            whole_mesh,
            values,
            holes,
            vertex_hole: completion.vertex_hole,
            origins: Origins::new(&completion.origins)?,
            source_points: Vec::new(),
            normals: Vec::new(),
            cleaned: Vec::new(),
            removed: Vec::new(),
            face_hole: completion.face_hole,
            seconds: completion.seconds,
            cpu_seconds: completion.cpu_seconds,
        })
    }

    /// Of a cloud: points alone.
    pub(super) fn of_points(
        input: &Input,
        made: PointCompletion,
        whole_mesh: bool,
    ) -> Result<Self, Failure> {
        let PointCompletion {
            mut completion, normals, source_points, values, found, cleaned, ..
        } = made;
        completion.faces.clear();
        completion.face_hole.clear();
        completion.holes.iter_mut().for_each(|h| h.faces = 0..0);
        let holes = Holes::of_points(&found, &completion.holes);
        let made = Self::new(input, holes, completion, values, whole_mesh)?;
        let CleanedPoints { positions, removed } = cleaned.unwrap_or_default();
        let removed = removed.into_iter().map(u8::from).collect();
        Ok(Self { source_points, normals, cleaned: positions, removed, ..made })
    }

    /// The positions from vertex `first` of the array on; NULL if there are none.
    fn positions_from(&self, first: usize) -> *const c_void {
        match &self.positions {
            Positions::Single(v) => start(v.get(first..)).cast(),
            Positions::Double(v) => start(v.get(first..)).cast(),
        }
    }
}

/// C's pointer to a slice: NULL rather than the dangling one of an empty slice.
fn start<T>(slice: Option<&[T]>) -> *const T {
    slice.filter(|s| !s.is_empty()).map_or(std::ptr::null(), <[T]>::as_ptr)
}

/// What an accessor answers; `otherwise` for NULL.
///
/// # Safety
/// `result` is NULL or alive.
unsafe fn ask<T>(result: *const MeshResult, otherwise: T, of: impl FnOnce(&MeshResult) -> T) -> T {
    // SAFETY: by the contract of this function.
    guard_value(otherwise, || unsafe { result.as_ref() }.map(of))
}

/// The number type of the result's vertices, a complete_mesh_vertex_type: that of the input.
#[no_mangle]
pub unsafe extern "C" fn complete_mesh_result_vertex_type(result: *const MeshResult) -> u32 {
    let of = |r: &MeshResult| match r.positions {
        Positions::Single(_) => CVertexType::F32 as u32,
        Positions::Double(_) => CVertexType::F64 as u32,
    };
    // SAFETY: NULL or alive, by the contract of the header; so in all accessors below.
    unsafe { ask(result, CVertexType::F32 as u32, of) }
}

/// How many vertices the input has: the index of the first new vertex in faces.
#[no_mangle]
pub unsafe extern "C" fn complete_mesh_result_input_vertex_count(
    result: *const MeshResult,
) -> usize {
    // SAFETY: as above.
    unsafe { ask(result, 0, |r| r.input_counts.0) }
}

/// How many faces the input has: the index of the first new face in the whole mesh.
#[no_mangle]
pub unsafe extern "C" fn complete_mesh_result_input_face_count(result: *const MeshResult) -> usize {
    // SAFETY: as above.
    unsafe { ask(result, 0, |r| r.input_counts.1) }
}

/// How many vertices the whole mesh has; 0 if only the new elements were asked for.
#[no_mangle]
pub unsafe extern "C" fn complete_mesh_result_vertex_count(result: *const MeshResult) -> usize {
    let of = |r: &MeshResult| if r.whole_mesh { r.input_counts.0 + r.vertex_hole.len() } else { 0 };
    // SAFETY: as above.
    unsafe { ask(result, 0, of) }
}

/// How many faces the whole mesh has; 0 if only the new elements were asked for.
#[no_mangle]
pub unsafe extern "C" fn complete_mesh_result_face_count(result: *const MeshResult) -> usize {
    let of = |r: &MeshResult| if r.whole_mesh { r.faces.len() } else { 0 };
    // SAFETY: as above.
    unsafe { ask(result, 0, of) }
}

/// The whole mesh's vertices: the input's bit for bit, in order, then the new ones. Three numbers a
/// vertex, packed; float or double as complete_mesh_result_vertex_type says. NULL if only the new
/// elements were asked for. The array belongs to the result.
#[no_mangle]
pub unsafe extern "C" fn complete_mesh_result_vertices(result: *const MeshResult) -> *const c_void {
    let of = |r: &MeshResult| if r.whole_mesh { r.positions_from(0) } else { std::ptr::null() };
    // SAFETY: as above.
    unsafe { ask(result, std::ptr::null(), of) }
}

/// The whole mesh's faces: the input's, in order, then the new ones. Three indices a face, packed.
/// NULL if only the new elements were asked for. The array belongs to the result.
#[no_mangle]
pub unsafe extern "C" fn complete_mesh_result_faces(result: *const MeshResult) -> *const u32 {
    let of = |r: &MeshResult| if r.whole_mesh { start(Some(&r.faces)) } else { std::ptr::null() };
    // SAFETY: as above.
    unsafe { ask(result, std::ptr::null(), of) }.cast()
}

/// How many vertices are new.
#[no_mangle]
pub unsafe extern "C" fn complete_mesh_result_new_vertex_count(result: *const MeshResult) -> usize {
    // SAFETY: as above.
    unsafe { ask(result, 0, |r| r.vertex_hole.len()) }
}

/// How many faces are new.
#[no_mangle]
pub unsafe extern "C" fn complete_mesh_result_new_face_count(result: *const MeshResult) -> usize {
    // SAFETY: as above.
    unsafe { ask(result, 0, |r| r.face_hole.len()) }
}

/// The new vertices alone: three numbers a vertex, packed; float or double as
/// complete_mesh_result_vertex_type says. NULL if there are none. The array belongs to the result.
#[no_mangle]
pub unsafe extern "C" fn complete_mesh_result_new_vertices(
    result: *const MeshResult,
) -> *const c_void {
    // SAFETY: as above.
    unsafe { ask(result, std::ptr::null(), |r| r.positions_from(r.first_new.0)) }
}

/// The new faces alone: three indices a face, packed. An index below
/// complete_mesh_result_input_vertex_count is an input vertex; that count less is the index of a
/// new one. NULL if there are none. The array belongs to the result.
#[no_mangle]
pub unsafe extern "C" fn complete_mesh_result_new_faces(result: *const MeshResult) -> *const u32 {
    let of = |r: &MeshResult| start(r.faces.get(r.first_new.1..));
    // SAFETY: as above.
    unsafe { ask(result, std::ptr::null(), of) }.cast()
}

/// For each new vertex the id of the hole that it fills. NULL if there are none. The array belongs
/// to the result.
#[no_mangle]
pub unsafe extern "C" fn complete_mesh_result_new_vertex_holes(
    result: *const MeshResult,
) -> *const u32 {
    // SAFETY: as above.
    unsafe { ask(result, std::ptr::null(), |r| start(Some(&r.vertex_hole))) }
}

/// For each new vertex the input face that its detail was copied from; UINT32_MAX if from nowhere
/// (a smooth fill, a gap in the source). NULL if there are no new vertices. The array belongs to the
/// result.
#[no_mangle]
pub unsafe extern "C" fn complete_mesh_result_new_vertex_source_faces(
    result: *const MeshResult,
) -> *const u32 {
    // SAFETY: as above.
    unsafe { ask(result, std::ptr::null(), |r| start(Some(&r.origins.faces))) }
}

/// For each new vertex where on its source face it was copied from: three numbers, the weights of
/// the face's corners in the face's order, which sum to 1; three zeros without a source face. The
/// source's transform takes that point near the new vertex: what is between them is the smooth
/// deformation that joins the copy to the rim. NULL if there are no new vertices. The array belongs
/// to the result.
#[no_mangle]
pub unsafe extern "C" fn complete_mesh_result_new_vertex_barycentrics(
    result: *const MeshResult,
) -> *const f64 {
    // SAFETY: as above.
    unsafe { ask(result, std::ptr::null(), |r| start(Some(&r.origins.barycentrics))) }.cast()
}

/// For each new vertex the source that gave its detail, an index for complete_mesh_holes_source
/// with the vertex's own hole; UINT32_MAX without one. NULL if there are no new vertices. The array
/// belongs to the result.
#[no_mangle]
pub unsafe extern "C" fn complete_mesh_result_new_vertex_sources(
    result: *const MeshResult,
) -> *const u32 {
    // SAFETY: as above.
    unsafe { ask(result, std::ptr::null(), |r| start(Some(&r.origins.sources))) }
}

/// For each new vertex a confidence, 0 (nothing on the object backs it) to 1. From 0.8 the source
/// predicted known surface that was hidden from it with at most half the error of a smooth surface;
/// below 0.5 it did worse than one. NULL if there are no new vertices. The array belongs to the
/// result.
#[no_mangle]
pub unsafe extern "C" fn complete_mesh_result_new_vertex_confidences(
    result: *const MeshResult,
) -> *const f64 {
    // SAFETY: as above.
    unsafe { ask(result, std::ptr::null(), |r| start(Some(&r.origins.confidences))) }
}

/// For each new point of a cloud the input point nearest to where its detail was copied from;
/// UINT32_MAX if from nowhere. NULL for a mesh, and if there are no new points. The array belongs to
/// the result.
#[no_mangle]
pub unsafe extern "C" fn complete_mesh_result_new_vertex_source_points(
    result: *const MeshResult,
) -> *const u32 {
    // SAFETY: as above.
    unsafe { ask(result, std::ptr::null(), |r| start(Some(&r.source_points))) }
}

/// For each new point of a cloud its unit normal, three numbers, on the side of the normals given, or
/// else outside. NULL for a mesh, and if there are no new points. The array belongs to the result.
#[no_mangle]
pub unsafe extern "C" fn complete_mesh_result_new_vertex_normals(
    result: *const MeshResult,
) -> *const f64 {
    // SAFETY: as above.
    unsafe { ask(result, std::ptr::null(), |r| start(Some(&r.normals)).cast()) }
}

/// For each point of the input, if the option clean was set, where it lies in the cleaned copy that was
/// completed: three numbers; what was removed is where it was. NULL otherwise. The array belongs to the
/// result.
#[no_mangle]
pub unsafe extern "C" fn complete_mesh_result_cleaned_points(
    result: *const MeshResult,
) -> *const f64 {
    // SAFETY: as above.
    unsafe { ask(result, std::ptr::null(), |r| start(Some(&r.cleaned)).cast()) }
}

/// For each point of the input, if the option clean was set, 1 if it is not in the cleaned copy (it lies
/// beside the surface, is a double of an earlier one or has no coordinates), else 0. NULL otherwise. The
/// array belongs to the result.
#[no_mangle]
pub unsafe extern "C" fn complete_mesh_result_removed_points(
    result: *const MeshResult,
) -> *const u8 {
    // SAFETY: as above.
    unsafe { ask(result, std::ptr::null(), |r| start(Some(&r.removed))) }
}

/// For each new vertex the numbers that vertex_values of the options gave the input's, value_channels
/// of them: copied from where the shape was copied from, else carried in from the rim. Between the
/// least and the greatest of the input's. NULL without vertex_values or new vertices. The array belongs
/// to the result.
#[no_mangle]
pub unsafe extern "C" fn complete_mesh_result_new_vertex_values(
    result: *const MeshResult,
) -> *const f64 {
    // SAFETY: as above.
    unsafe { ask(result, std::ptr::null(), |r| start(Some(&r.values))) }
}

/// For each new face the id of the hole that it fills. NULL if there are none. The array belongs to
/// the result.
#[no_mangle]
pub unsafe extern "C" fn complete_mesh_result_new_face_holes(
    result: *const MeshResult,
) -> *const u32 {
    // SAFETY: as above.
    unsafe { ask(result, std::ptr::null(), |r| start(Some(&r.face_hole))) }
}

/// All holes of the input, filled or not, to be read with complete_mesh_holes_.... They belong to
/// the result: do not free them. NULL for NULL.
#[no_mangle]
pub unsafe extern "C" fn complete_mesh_result_holes(result: *const MeshResult) -> *const Holes {
    // SAFETY: as above.
    unsafe { ask(result, std::ptr::null(), |r| std::ptr::from_ref(&r.holes)) }
}

/// How many holes were filled.
#[no_mangle]
pub unsafe extern "C" fn complete_mesh_result_filled_count(result: *const MeshResult) -> usize {
    // SAFETY: as above.
    unsafe { ask(result, 0, |r| r.holes.filled_count()) }
}

/// Wall seconds that the completion took.
#[no_mangle]
pub unsafe extern "C" fn complete_mesh_result_seconds(result: *const MeshResult) -> f64 {
    // SAFETY: as above.
    unsafe { ask(result, 0.0, |r| r.seconds) }
}

/// CPU seconds that the process spent, in all its threads, while the completion ran.
#[no_mangle]
pub unsafe extern "C" fn complete_mesh_result_cpu_seconds(result: *const MeshResult) -> f64 {
    // SAFETY: as above.
    unsafe { ask(result, 0.0, |r| r.cpu_seconds) }
}

/// Frees a result and everything that belongs to it; NULL is allowed.
#[no_mangle]
pub unsafe extern "C" fn complete_mesh_result_free(result: *mut MeshResult) {
    guard_value((), || {
        if !result.is_null() {
            // SAFETY: made by `Box::into_raw` of a completion entry, freed once.
            drop(unsafe { Box::from_raw(result) });
        }
        None
    })
}

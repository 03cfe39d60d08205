//! The holes of a mesh or a cloud for C: measured, with what became of them after a completion.

use super::choices::CMethod;
use super::error::{c_string, Elements};
use super::guard::guard_value;
use super::write_out;
use crate::error::Problem;
use crate::holes::{Hole, HoleKind, HoleList};
use crate::options::{Fairing, Method};
use crate::result::{HoleReport, HoleStatus, SourceReport};
use std::ffi::{c_char, CString};

/// What a hole looks like.
#[repr(C)]
pub enum CHoleKind {
    /// One loop: filled by a disc.
    Disc = 0,
    /// A loop with islands inside, which become part of the fill.
    Islands = 1,
    /// Two loops that face each other: a band is missing.
    Ring = 2,
    /// Several loops that the caller joined, or a branching gap.
    Several = 3,
}

/// What became of a hole.
#[repr(C)]
pub enum CHoleStatus {
    /// Found and measured, and selected; nothing was to be filled.
    Open = 0,
    /// Filled.
    Filled = 1,
    /// Not selected.
    NotSelected = 2,
    /// Left open because it cannot be filled safely (only with skip_unsafe).
    Unsafe = 3,
    /// Left open because no fill kept the contract (only with skip_unsafe).
    Failed = 4,
}

/// One hole. Lengths and positions are in mesh units. Edges of a cloud's hole are those between the
/// points of its rim.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CHole {
    /// How many bytes of the struct the library has written: at most what was asked for.
    pub struct_size: u32,
    /// The hole's id, which is also its index.
    pub id: u32,
    /// A complete_mesh_hole_kind.
    pub kind: u32,
    /// A complete_mesh_hole_status.
    pub status: u32,
    /// The complete_mesh_fairing that was used; COMPLETE_MESH_FAIRING_AUTO if not filled.
    pub fairing: u32,
    /// 1: something at the rim keeps it from being filled safely, see
    /// complete_mesh_holes_reason and complete_mesh_holes_problem_elements. Else 0.
    pub is_unsafe: u32,
    /// Boundary loops.
    pub loop_count: usize,
    /// Boundary edges of all loops.
    pub edge_count: usize,
    /// Length of all loops.
    pub circumference: f64,
    /// Diameter of the longest loop.
    pub diameter: f64,
    /// Centre of the longest loop.
    pub centre: [f64; 3],
    /// The hole's first new vertex, counted among the new vertices.
    pub first_new_vertex: usize,
    /// How many new vertices it has, one after the other.
    pub new_vertex_count: usize,
    /// The hole's first new face, counted among the new faces.
    pub first_new_face: usize,
    /// How many new faces it has, one after the other.
    pub new_face_count: usize,
    /// Wall seconds that its fill took.
    pub seconds: f64,
    /// The complete_mesh_method that made the fill: COMPLETE_MESH_METHOD_SMOOTH where nothing on
    /// the object served, and if not filled.
    pub method: u32,
    /// How many sources the fill was continued from, see complete_mesh_holes_source; 0 for a smooth
    /// fill.
    pub source_count: u32,
    /// 0 to 1, as of complete_mesh_result_new_vertex_confidences; 0 for a smooth fill.
    pub confidence: f64,
    /// Coherence error of the initial, smooth completion (Harary et al. 2014, Eq. 3, root mean
    /// square); NaN where it was not measured.
    pub coherence_error_before: f64,
    /// Coherence error of the fill; NaN where it was not measured.
    pub coherence_error_after: f64,
    /// How many candidates the hole has, if one was asked for by the option candidate; else 0.
    pub candidate_count: u32,
    /// 1: the outer border of an open cloud, which is filled only if it is named. Else 0.
    pub is_border: u32,
    /// Which detectors could judge this hole of a cloud, complete_mesh_detector added up. 0 for a mesh.
    pub detectors_asked: u32,
    /// Which of them find this hole. One that not all agree on may be a sparse place.
    pub detectors_agreed: u32,
    /// Of a cloud: the mean probability, 0 to 1, that the points of the rim lie on a boundary (Bendels et
    /// al. 2005); from 0.4 a rim is plain to see. NaN for a mesh.
    pub boundary_probability: f64,
    /// Of a cloud: an estimate of how many points are missing. NaN for a mesh.
    pub missing_points: f64,
}

/// A place on the object that a hole's fill was continued from. Lengths are in mesh units.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CSource {
    /// How many bytes of the struct the library has written: at most what was asked for.
    pub struct_size: u32,
    /// 1: the transform mirrors. Else 0.
    pub mirrored: u32,
    /// From the place to the hole: a matrix of three rows and four columns, row by row. The first
    /// three columns are a rotation, or a rotation and a reflection, in some with a stretch of a few
    /// per cent, or scaled if that was allowed; the last is the translation.
    pub transform: [f64; 12],
    /// Root mean square error at known vertices near the rim that were hidden from the fit.
    pub error: f64,
    /// Share in the low frequencies of the fill, 0 to 1; a hole's sources sum to 1.
    pub weight: f64,
    /// How many new vertices have their detail from here.
    pub vertex_count: usize,
    /// How many new vertices have their values (vertex_values of the options), but not their shape, from here.
    pub coloured_count: usize,
}

/// One hole, ready to be asked.
pub(super) struct Entry {
    pub(super) info: CHole,
    loops: Vec<Vec<u32>>,
    /// Why it was not filled or cannot be; empty if all is well.
    reason: CString,
    elements: Elements,
    sources: Vec<CSource>,
}

/// The holes of a mesh or a cloud and everything odd that was found there. Opaque; read by the
/// functions complete_mesh_holes_..., from any number of threads.
pub struct Holes {
    pub(super) entries: Vec<Entry>,
    non_manifold_edges: Vec<u32>,
    inconsistent_edges: Vec<u32>,
    degenerate_faces: Vec<u32>,
    duplicate_vertices: Vec<u32>,
    /// Of a cloud; else 0.
    pub(super) spacing: f64,
    /// Of a cloud, by [`super::CIgnored`].
    pub(super) ignored: [Vec<u32>; 4],
    /// Of a cloud: places that only the distance field takes for holes.
    pub(super) only_in_field: Vec<f64>,
}

impl Entry {
    fn new(hole: &Hole, list: &HoleList, report: Option<&HoleReport>) -> Self {
        let problem = match report.map(|r| &r.status) {
            Some(HoleStatus::Unsafe(problem)) => Some(problem),
            _ => hole.problem.as_ref(),
        };
        let reason = match report.map(|r| &r.status) {
            Some(HoleStatus::Failed(error)) => error.to_string(),
            _ => problem.map(Problem::to_string).unwrap_or_default(),
        };
        Entry {
            info: info(hole, problem.is_some(), report),
            loops: hole.loops.iter().map(|&l| list.loops[l].vertices.clone()).collect(),
            reason: c_string(&reason),
            elements: problem.map(Elements::of_problem).unwrap_or_default(),
            sources: report.map_or(&[][..], |r| &r.sources).iter().map(source).collect(),
        }
    }
}

fn info(hole: &Hole, is_unsafe: bool, report: Option<&HoleReport>) -> CHole {
    let coherence_error = report.and_then(|r| r.coherence_error).unwrap_or([f64::NAN; 2]);
    let (vertices, faces) = report.map_or((0..0, 0..0), |r| (r.vertices.clone(), r.faces.clone()));
    CHole {
        struct_size: size_of::<CHole>() as u32,
        id: hole.id as u32,
        kind: match hole.kind {
            HoleKind::Disc => CHoleKind::Disc,
            HoleKind::Islands => CHoleKind::Islands,
            HoleKind::Ring => CHoleKind::Ring,
            HoleKind::Several => CHoleKind::Several,
        } as u32,
        status: match report.map(|r| &r.status) {
            None => CHoleStatus::Open,
            Some(HoleStatus::Filled) => CHoleStatus::Filled,
            Some(HoleStatus::NotSelected) => CHoleStatus::NotSelected,
            Some(HoleStatus::Unsafe(_)) => CHoleStatus::Unsafe,
            Some(HoleStatus::Failed(_)) => CHoleStatus::Failed,
        } as u32,
        fairing: match report {
            Some(HoleReport { status: HoleStatus::Filled, fairing, .. }) => {
                fairing_number(*fairing)
            }
            _ => fairing_number(Fairing::Auto),
        },
        is_unsafe: is_unsafe as u32,
        loop_count: hole.loops.len(),
        edge_count: hole.edges,
        circumference: hole.circumference,
        diameter: hole.diameter,
        centre: hole.centre,
        first_new_vertex: vertices.start,
        new_vertex_count: vertices.len(),
        first_new_face: faces.start,
        new_face_count: faces.len(),
        seconds: report.map_or(0.0, |r| r.seconds),
        method: report.map_or(CMethod::Smooth as u32, |r| method_number(r.method)),
        source_count: report.map_or(0, |r| r.sources.len() as u32),
        confidence: report.map_or(0.0, |r| r.confidence),
        coherence_error_before: coherence_error[0],
        coherence_error_after: coherence_error[1],
        candidate_count: report.map_or(0, |r| r.candidates as u32),
        is_border: 0,
        detectors_asked: 0,
        detectors_agreed: 0,
        boundary_probability: f64::NAN,
        missing_points: f64::NAN,
    }
}

fn source(report: &SourceReport) -> CSource {
    let rows = report.transform.rows();
    CSource {
        struct_size: size_of::<CSource>() as u32,
        mirrored: u32::from(report.transform.is_mirrored()),
        transform: std::array::from_fn(|i| rows[i / 4][i % 4]),
        error: report.error,
        weight: report.weight,
        vertex_count: report.vertices,
        coloured_count: report.coloured,
    }
}

fn method_number(method: Method) -> u32 {
    match method {
        Method::Smooth => CMethod::Smooth as u32,
        Method::Coherent => CMethod::Coherent as u32,
        Method::Harary => CMethod::Harary as u32,
        Method::Fragment => CMethod::Fragment as u32,
        Method::Warp => CMethod::Warp as u32,
    }
}

fn fairing_number(fairing: Fairing) -> u32 {
    // `ALL` has every value in the order of the C constants.
    Fairing::ALL.iter().position(|&f| f == fairing).unwrap_or(0) as u32
}

impl Holes {
    /// All holes of `list`, with what `reports` say became of them, by id.
    pub(super) fn new(list: &HoleList, reports: &[HoleReport]) -> Self {
        let flat = |pairs: &[[u32; 2]]| pairs.as_flattened().to_vec();
        Holes {
            entries: list
                .holes
                .iter()
                .map(|h| Entry::new(h, list, reports.iter().find(|r| r.hole == h.id)))
                .collect(),
            non_manifold_edges: flat(&list.non_manifold_edges),
            inconsistent_edges: flat(&list.inconsistent_edges),
            degenerate_faces: list.degenerate_faces.clone(),
            duplicate_vertices: flat(&list.duplicate_boundary_vertices),
            spacing: 0.0,
            ignored: Default::default(),
            only_in_field: Vec::new(),
        }
    }

    /// Says of a list that nothing was filled of which holes a selection leaves out.
    pub(super) fn mark_selected(&mut self, selected: &[bool]) {
        for (entry, _) in self.entries.iter_mut().zip(selected).filter(|(_, &wanted)| !wanted) {
            entry.info.status = CHoleStatus::NotSelected as u32;
        }
    }

    pub(super) fn filled_count(&self) -> usize {
        let filled = CHoleStatus::Filled as u32;
        self.entries.iter().filter(|e| e.info.status == filled).count()
    }
}

/// What a list's accessor gives: its pointer, and its count of `per_element` numbers each.
///
/// # Safety
/// `holes` is NULL or alive; `count` is NULL or writable.
pub(super) unsafe fn list<'a, T: 'a>(
    holes: *const Holes,
    count: *mut usize,
    per_element: usize,
    of: impl FnOnce(&'a Holes) -> Option<&'a [T]>,
) -> *const T {
    // SAFETY: by the contract of this function.
    unsafe { write_out(count, 0) };
    guard_value(std::ptr::null(), || {
        // SAFETY: as above.
        let numbers = of(unsafe { holes.as_ref() }?)?;
        // SAFETY: as above.
        unsafe { write_out(count, numbers.len() / per_element) };
        (!numbers.is_empty()).then_some(numbers.as_ptr())
    })
}

/// Writes the beginning of a struct that grows at its end: as much as the caller knows of it.
/// Returns `None`, and writes nothing, for NULL and for less than 8 bytes.
///
/// # Safety
/// `out` is NULL or has `size` writable bytes. `T` begins with its struct_size.
unsafe fn write_struct<T>(out: *mut T, size: usize, of_size: impl FnOnce(u32) -> T) -> Option<i32> {
    let size = size.min(size_of::<T>());
    if out.is_null() || size < 8 {
        return None;
    }
    let written = of_size(size as u32);
    // SAFETY: by the contract of this function.
    unsafe {
        std::ptr::copy_nonoverlapping(std::ptr::from_ref(&written).cast(), out.cast::<u8>(), size);
    }
    Some(1)
}

/// How many holes there are; their ids are 0 to this number less one. 0 for NULL.
#[no_mangle]
pub unsafe extern "C" fn complete_mesh_holes_count(holes: *const Holes) -> usize {
    // SAFETY: NULL or alive, by the contract of the header.
    guard_value(0, || unsafe { holes.as_ref() }.map(|h| h.entries.len()))
}

/// One hole's measures and what became of it.
///
/// hole: id of the hole.
/// info: receives them.
/// info_size: sizeof(complete_mesh_hole) as your program was compiled; not a byte beyond is
/// written.
///
/// Returns 1; or 0 for NULL, for a hole that does not exist and for an info_size under 8, and then
/// nothing is written.
#[no_mangle]
pub unsafe extern "C" fn complete_mesh_holes_get(
    holes: *const Holes,
    hole: usize,
    info: *mut CHole,
    info_size: usize,
) -> i32 {
    guard_value(0, || {
        // SAFETY: NULL or alive, by the contract of the header.
        let entry = unsafe { holes.as_ref() }?.entries.get(hole)?;
        // SAFETY: the caller answers for `info_size` writable bytes.
        unsafe { write_struct(info, info_size, |struct_size| CHole { struct_size, ..entry.info }) }
    })
}

/// One of the places that a hole's fill was continued from, the greatest weight first.
///
/// hole: id of the hole.
/// source: 0 to source_count of the hole's complete_mesh_hole, less one.
/// info: receives it.
/// info_size: sizeof(complete_mesh_source) as your program was compiled; not a byte beyond is
/// written.
///
/// Returns 1; or 0 for NULL, for a hole or a source that does not exist and for an info_size under
/// 8, and then nothing is written.
#[no_mangle]
pub unsafe extern "C" fn complete_mesh_holes_source(
    holes: *const Holes,
    hole: usize,
    source: usize,
    info: *mut CSource,
    info_size: usize,
) -> i32 {
    guard_value(0, || {
        // SAFETY: NULL or alive, by the contract of the header.
        let entry = unsafe { holes.as_ref() }?.entries.get(hole)?;
        let known = entry.sources.get(source)?;
        // SAFETY: the caller answers for `info_size` writable bytes.
        unsafe { write_struct(info, info_size, |struct_size| CSource { struct_size, ..*known }) }
    })
}

/// The vertices of one boundary loop of a hole, in the order in which a filling face runs.
///
/// hole: id of the hole.
/// loop_index: 0 to loop_count of the hole's complete_mesh_hole, less one; the longest loop is first.
/// count: receives the number of vertices, 0 if there is no such loop; NULL is allowed.
///
/// Returns indices of input vertices, NULL if there is no such loop. The array belongs to holes.
#[no_mangle]
pub unsafe extern "C" fn complete_mesh_holes_loop(
    holes: *const Holes,
    hole: usize,
    loop_index: usize,
    count: *mut usize,
) -> *const u32 {
    // SAFETY: by the contract of the header.
    unsafe {
        list(holes, count, 1, |h| h.entries.get(hole)?.loops.get(loop_index).map(Vec::as_slice))
    }
}

/// Why a hole was not filled or cannot be filled safely: English, UTF-8; empty if there is no
/// reason. The string belongs to holes; an empty one, never NULL, for a hole that does not exist.
#[no_mangle]
pub unsafe extern "C" fn complete_mesh_holes_reason(
    holes: *const Holes,
    hole: usize,
) -> *const c_char {
    guard_value(c"".as_ptr(), || {
        // SAFETY: NULL or alive, by the contract of the header.
        Some(unsafe { holes.as_ref() }?.entries.get(hole)?.reason.as_ptr())
    })
}

/// The elements of one kind that keep a hole from being filled safely.
///
/// hole: id of the hole.
/// kind: a complete_mesh_element_kind.
/// count: receives how many elements there are; NULL is allowed. Edges take two numbers each.
///
/// Returns NULL if there are none. The array belongs to holes.
#[no_mangle]
pub unsafe extern "C" fn complete_mesh_holes_problem_elements(
    holes: *const Holes,
    hole: usize,
    kind: u32,
    count: *mut usize,
) -> *const u32 {
    let per_element = if kind == super::error::ElementKind::Edge as u32 { 2 } else { 1 };
    // SAFETY: by the contract of the header.
    unsafe {
        list(holes, count, per_element, |h| Some(h.entries.get(hole)?.elements.list(kind)?.0))
    }
}

/// Edges with more than two faces, found at or near the boundary of the mesh.
///
/// count: receives how many edges there are; NULL is allowed.
///
/// Returns two input vertices for each edge, NULL if there are none. The array belongs to holes.
#[no_mangle]
pub unsafe extern "C" fn complete_mesh_holes_non_manifold_edges(
    holes: *const Holes,
    count: *mut usize,
) -> *const u32 {
    // SAFETY: by the contract of the header.
    unsafe { list(holes, count, 2, |h| Some(&h.non_manifold_edges)) }
}

/// Edges whose two faces run the same way: the mesh is not oriented consistently there.
///
/// count: receives how many edges there are; NULL is allowed.
///
/// Returns two input vertices for each edge, NULL if there are none. The array belongs to holes.
#[no_mangle]
pub unsafe extern "C" fn complete_mesh_holes_inconsistent_edges(
    holes: *const Holes,
    count: *mut usize,
) -> *const u32 {
    // SAFETY: by the contract of the header.
    unsafe { list(holes, count, 2, |h| Some(&h.inconsistent_edges)) }
}

/// Faces that name a vertex twice; they are passed through and otherwise ignored.
///
/// count: receives how many faces there are; NULL is allowed.
///
/// Returns indices of input faces, NULL if there are none. The array belongs to holes.
#[no_mangle]
pub unsafe extern "C" fn complete_mesh_holes_degenerate_faces(
    holes: *const Holes,
    count: *mut usize,
) -> *const u32 {
    // SAFETY: by the contract of the header.
    unsafe { list(holes, count, 1, |h| Some(&h.degenerate_faces)) }
}

/// Pairs of boundary vertices at the same position: the mesh is not welded there, and what looks
/// closed is a slit.
///
/// count: receives how many pairs there are; NULL is allowed.
///
/// Returns two input vertices for each pair, NULL if there are none. The array belongs to holes.
#[no_mangle]
pub unsafe extern "C" fn complete_mesh_holes_duplicate_vertices(
    holes: *const Holes,
    count: *mut usize,
) -> *const u32 {
    // SAFETY: by the contract of the header.
    unsafe { list(holes, count, 2, |h| Some(&h.duplicate_vertices)) }
}

/// Frees what complete_mesh_find_holes or complete_mesh_find_point_holes gave; NULL is allowed. Not for
/// the holes of a result or a completer, which free their own: those are const.
#[no_mangle]
pub unsafe extern "C" fn complete_mesh_holes_free(holes: *mut Holes) {
    guard_value((), || {
        if !holes.is_null() {
            // SAFETY: made by `Box::into_raw` in the entry that finds holes, freed once.
            drop(unsafe { Box::from_raw(holes) });
        }
        None
    })
}

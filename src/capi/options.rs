//! The options struct of the C ABI, and how it is read: nothing unknown is ignored.

use super::choices::{CFairing, CGrouping, CMethod, COutput, CSelection, CSizing, CVertexType};
use super::error::{Failure, Status};
use super::guard::guard;
use crate::options::Cleaning;
use std::ffi::{c_char, c_int, c_void};

/// Reports progress and asks whether to go on: return 0 to go on, anything else to cancel. The
/// call then returns COMPLETE_MESH_STATUS_CANCELLED, frees everything and does not call again.
///
/// user: progress_user of the options.
/// fraction: how much is done, 0 to 1, never falling.
/// stage: what is being done, an English word or two; valid during the call only.
///
/// Called on the thread that called the library, at least once by every call. It must not throw an
/// exception or jump out; it may call the library.
pub type CProgressFn =
    Option<unsafe extern "C" fn(user: *mut c_void, fraction: f64, stage: *const c_char) -> c_int>;

/// The options of every call. Initialise with complete_mesh_options_init, then change what you
/// need. Where a call takes options, NULL means the defaults.
///
/// The struct grows at its end in later versions. A program compiled with an older, shorter struct
/// keeps working with a newer library; a newer program with an older library gets
/// COMPLETE_MESH_STATUS_UNSUPPORTED once it sets a field that the library does not know.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct COptions {
    /// sizeof(complete_mesh_options) as your program was compiled; complete_mesh_options_init sets
    /// it.
    pub struct_size: u32,
    /// A complete_mesh_vertex_type. Default: COMPLETE_MESH_VERTEX_TYPE_F32, so double vertices
    /// need this set.
    pub vertex_type: u32,
    /// Bytes from one vertex to the next; any number from 12 (F32) or 24 (F64), alignment does not
    /// matter. Default: 0, packed.
    pub vertex_stride: usize,
    /// Bytes from one face to the next; any number from 12. Default: 0, packed.
    pub face_stride: usize,
    /// A complete_mesh_method. Default: COMPLETE_MESH_METHOD_COHERENT.
    pub method: u32,
    /// A complete_mesh_fairing. Default: COMPLETE_MESH_FAIRING_AUTO.
    pub fairing: u32,
    /// A complete_mesh_sizing. Default: COMPLETE_MESH_SIZING_SURROUNDINGS.
    pub sizing: u32,
    /// A complete_mesh_grouping. Default: COMPLETE_MESH_GROUPING_AUTOMATIC.
    pub grouping: u32,
    /// Read by COMPLETE_MESH_SIZING_SCALED (a factor) and COMPLETE_MESH_SIZING_EDGE_LENGTH (mesh
    /// units). Default: 1.
    pub sizing_value: f64,
    /// A complete_mesh_selection. Default: COMPLETE_MESH_SELECTION_ALL.
    pub selection: u32,
    /// 0: a selected hole that cannot be filled is an error for the whole call. 1: it is left open
    /// and its complete_mesh_hole says why. Default: 0.
    pub skip_unsafe: u32,
    /// Read by COMPLETE_MESH_SELECTION_IDS (ids of holes) and COMPLETE_MESH_SELECTION_NEAR_VERTICES
    /// (indices of vertices): selection_count numbers, yours; NULL if selection_count is 0.
    pub selection_ids: *const u32,
    /// How many numbers selection_ids has. Default: 0.
    pub selection_count: usize,
    /// Read by COMPLETE_MESH_SELECTION_MAX_EDGES. Default: 0.
    pub selection_max_edges: usize,
    /// Read by COMPLETE_MESH_SELECTION_MAX_CIRCUMFERENCE and _MAX_DIAMETER: mesh units, greater
    /// than 0. Default: 0.
    pub selection_length: f64,
    /// Read by COMPLETE_MESH_SELECTION_NEAR_POINT: mesh units. Default: the origin.
    pub selection_point: [f64; 3],
    /// Read by COMPLETE_MESH_GROUPING_JOIN: one list of vertices for each hole, one after the
    /// other; any vertex of a loop stands for the loop. Yours; NULL if join_count is 0.
    pub join_vertices: *const u32,
    /// How many vertices each list has: join_count numbers, yours; NULL if join_count is 0.
    pub join_sizes: *const u32,
    /// How many lists there are. Default: 0.
    pub join_count: usize,
    /// Worker threads, 0 to 1024; 0: as many as the machine has cores. The result is the same, to
    /// the bit, for any number. Default: 0.
    pub threads: u32,
    /// A complete_mesh_output. Default: COMPLETE_MESH_OUTPUT_WHOLE_MESH.
    pub output: u32,
    /// Reports progress and can cancel; NULL: neither. Default: NULL.
    pub progress: CProgressFn,
    /// Handed to progress as it is; the library does not look at it. Default: NULL.
    pub progress_user: *mut c_void,
    /// What coherent fills may copy from: a byte for each face of the mesh, 0 where it may not be
    /// copied from. Yours; NULL: all may. Default: NULL.
    pub source_faces: *const u8,
    /// Another mesh to copy from, in any position and of the same scale, e.g. an intact twin: three
    /// numbers a vertex, of vertex_type, packed. Yours; NULL: none. Origins on it have face numbers
    /// from the mesh's face count on. Default: NULL.
    pub exemplar_vertices: *const c_void,
    /// How many vertices the exemplar has. Default: 0.
    pub exemplar_vertex_count: usize,
    /// Its faces, three 32-bit vertex indices each, packed. Yours. Default: NULL.
    pub exemplar_faces: *const u32,
    /// How many faces the exemplar has. Default: 0.
    pub exemplar_face_count: usize,
    /// 1: copy from the exemplar alone. Default: 0.
    pub exemplar_only: u32,
    /// 1: copy nothing mirrored. Default: 0.
    pub unmirrored: u32,
    /// An initial completion to start from instead of a smooth one, numbered as results are: its new
    /// vertices, three numbers each, of vertex_type, packed. A hole that it does not fill fails. Yours.
    /// Default: NULL.
    pub initial_vertices: *const c_void,
    /// How many vertices it has, those of the mesh not counted. Default: 0.
    pub initial_vertex_count: usize,
    /// Its faces, three 32-bit vertex indices each, packed, those of the mesh not among them; new
    /// vertices are numbered from the mesh's vertex count on. Yours. Default: NULL.
    pub initial_faces: *const u32,
    /// How many faces it has; 0: no initial completion. Default: 0.
    pub initial_face_count: usize,
    /// What the vertices carry besides their place, colours or any numbers, to be completed with the
    /// shape: value_channels numbers a vertex, finite, packed, vertex_stride does not apply. Yours;
    /// NULL: nothing. Read back with complete_mesh_result_new_vertex_values. Default: NULL.
    pub vertex_values: *const f64,
    /// The same of the exemplar's vertices. Yours; NULL: not known. Default: NULL.
    pub exemplar_values: *const f64,
    /// How many numbers a vertex has. Default: 0.
    pub value_channels: u32,
    /// How many of them, from the first on, help to find what is copied: 3 for red, green and blue;
    /// at most value_channels. They share one unit, whichever. Default: 0.
    pub steering_channels: u32,
    /// The one place to copy from, given by hand: a transform from the source to the hole, three rows
    /// and four columns, row by row, as in complete_mesh_source. It may turn, mirror, scale (0.001 to
    /// 1000) and shift; strains of up to 15 % are taken, too. With an exemplar it is the exemplar that
    /// is placed, else the mesh itself; it holds for every hole that is filled. Twelve numbers, yours;
    /// NULL: places are searched for. Default: NULL.
    pub placement: *const f64,
    /// 1: placement is improved by ICP on what is known around the hole, from as far as half a hole's
    /// radius; with its scale, unless that is 1. Default: 0.
    pub refine: u32,
    /// Which of the places found a fill is made from, counted from 1, the best first, in each hole; 0:
    /// all of them together. A hole that has fewer gets a smooth fill; candidate_count of its
    /// complete_mesh_hole says how many there are. A completer searches once for all. Default: 0.
    pub candidate: u32,
    /// Least factor by which sources may be scaled, 0.001 to 1000; 0 as greatest_scale is: they are not
    /// scaled. A search takes as much longer as there are steps of 10 % in the range; an exemplar that
    /// is an exact twin is found at once. Default: 0.
    pub least_scale: f64,
    /// Greatest factor. Default: 0.
    pub greatest_scale: f64,
    /// How many vertices each of several exemplars has that stand one after the other in the
    /// exemplar's arrays, faces in the same order: each may lie anywhere, on top of another, too. Yours;
    /// NULL: they are one. Default: NULL.
    pub exemplar_parts: *const u32,
    /// How many exemplars there are; 0: one. Default: 0.
    pub exemplar_part_count: usize,
    /// Points that fills pass through, smooth ones, too: scan points that float inside a hole. Three
    /// numbers each, packed, always double. Each belongs to the nearest hole that is filled; one that is
    /// farther from its middle than its diameter is refused. Yours; NULL if constraint_count is 0.
    /// Default: NULL.
    pub constraint_points: *const f64,
    /// How many points. Default: 0.
    pub constraint_count: usize,
    /// How far the fill may stay off the points, 0 (it passes through them) to 1; 0.1 halves the height of
    /// a bump over the whole hole. Default: 0.
    pub softness: f64,
    /// 1: each hole is filled with a part taken whole, with the source's own triangles: a missing hand, foot
    /// or spout, which no smooth surface comes near to. The part is what lies over the hole, at placement or
    /// at the first of the places found that has one. Default: 0.
    pub part: u32,
    /// Vertices of rims where the fill need only be joined: neither tangents nor relief nor values go on
    /// from what lies beyond them. Yours; NULL if loose_count is 0. Default: NULL.
    pub loose_vertices: *const u32,
    /// How many there are. Default: 0.
    pub loose_count: usize,
    /// 1: complete_mesh_points completes a cleaned copy of the cloud: points beside the surface and
    /// doubles are left out, noise is smoothed; see complete_mesh_result_cleaned_points. The input stays
    /// what it is. Refused for a mesh. Default: 0.
    pub clean: u32,
    /// Times that noise is smoothed, 0 to 100; each time about half of what is left goes, and relief below
    /// two spacings with it. Read if clean is 1. Default: 3.
    pub clean_rounds: u32,
    /// Holes of a cloud that you give as loops; if any hole is given no others are looked for. One list of
    /// points, 3 or more, for each loop, one list after the other, in order around the hole, either way
    /// round. Where the surface through the points has no edge between two of them the loop follows its rims
    /// and edges, without a detour. Inside is the smaller part; points there stay, and are not looked at.
    /// Refused for a mesh. Yours; NULL if given_loop_count is 0. Default: NULL.
    pub given_loop_points: *const u32,
    /// How many points each loop has: given_loop_count numbers, yours; NULL if given_loop_count is 0.
    /// Default: NULL.
    pub given_loop_sizes: *const u32,
    /// How many loops there are. Default: 0.
    pub given_loop_count: usize,
    /// Regions of a cloud: the holes whose rims lie in one; if there are none, the largest gap that
    /// shows. If any hole is given no others are looked for. Four numbers each: the centre and the radius of a
    /// ball, in cloud units. Refused for a mesh. Yours; NULL if given_region_count is 0. Default: NULL.
    pub given_regions: *const f64,
    /// How many regions there are. Default: 0.
    pub given_region_count: usize,
}

/// No version of the struct comes near this: a greater struct_size is garbage.
const MAX_STRUCT_SIZE: usize = 4096;

/// struct_size and vertex_type: less than the first version could never have had.
const MIN_STRUCT_SIZE: usize = 8;

impl COptions {
    pub(super) fn defaults() -> Self {
        COptions {
            struct_size: size_of::<COptions>() as u32,
            vertex_type: CVertexType::F32 as u32,
            vertex_stride: 0,
            face_stride: 0,
            method: CMethod::Coherent as u32,
            fairing: CFairing::Auto as u32,
            sizing: CSizing::Surroundings as u32,
            grouping: CGrouping::Automatic as u32,
            sizing_value: 1.0,
            selection: CSelection::All as u32,
            skip_unsafe: 0,
            selection_ids: std::ptr::null(),
            selection_count: 0,
            selection_max_edges: 0,
            selection_length: 0.0,
            selection_point: [0.0; 3],
            join_vertices: std::ptr::null(),
            join_sizes: std::ptr::null(),
            join_count: 0,
            threads: 0,
            output: COutput::WholeMesh as u32,
            progress: None,
            progress_user: std::ptr::null_mut(),
            source_faces: std::ptr::null(),
            exemplar_vertices: std::ptr::null(),
            exemplar_vertex_count: 0,
            exemplar_faces: std::ptr::null(),
            exemplar_face_count: 0,
            exemplar_only: 0,
            unmirrored: 0,
            initial_vertices: std::ptr::null(),
            initial_vertex_count: 0,
            initial_faces: std::ptr::null(),
            initial_face_count: 0,
            vertex_values: std::ptr::null(),
            exemplar_values: std::ptr::null(),
            value_channels: 0,
            steering_channels: 0,
            placement: std::ptr::null(),
            refine: 0,
            candidate: 0,
            least_scale: 0.0,
            greatest_scale: 0.0,
            exemplar_parts: std::ptr::null(),
            exemplar_part_count: 0,
            constraint_points: std::ptr::null(),
            constraint_count: 0,
            softness: 0.0,
            part: 0,
            loose_vertices: std::ptr::null(),
            loose_count: 0,
            clean: 0,
            clean_rounds: Cleaning::default().rounds as u32,
            given_loop_points: std::ptr::null(),
            given_loop_sizes: std::ptr::null(),
            given_loop_count: 0,
            given_regions: std::ptr::null(),
            given_region_count: 0,
        }
    }

    /// The caller's options, over the defaults as far as his struct reaches.
    ///
    /// # Safety
    /// `opts` is NULL or has as many readable bytes as its first field says.
    pub(super) unsafe fn read(opts: *const COptions) -> Result<Self, Failure> {
        let mut read = Self::defaults();
        if opts.is_null() {
            return Ok(read);
        }
        // SAFETY: at least the first field is there; nothing is said about alignment.
        let size = unsafe { opts.cast::<u32>().read_unaligned() } as usize;
        if !is_struct_size(size) {
            return Err(Failure::argument(format!(
                "options struct_size is {size}, which no version of complete_mesh_options has had: \
                 call complete_mesh_options_init first"
            )));
        }
        let known = size.min(size_of::<COptions>());
        // SAFETY: `known` bytes are readable there and writable here. Every field is valid for any
        // bytes: numbers, pointers, and a function pointer whose NULL is `None`.
        unsafe {
            std::ptr::copy_nonoverlapping(
                opts.cast::<u8>(),
                std::ptr::from_mut(&mut read).cast(),
                known,
            );
        }
        // SAFETY: the caller says that `size` bytes are his struct.
        let beyond =
            unsafe { std::slice::from_raw_parts(opts.cast::<u8>().add(known), size - known) };
        if beyond.iter().any(|&b| b != 0) {
            return Err(Failure::new(
                Status::Unsupported,
                "an option is set that this older version of the library does not know: \
                 update the library or leave the option at its default",
            ));
        }
        Ok(read)
    }

    /// Whether the vertices are f32, else f64.
    pub(super) fn single(&self) -> Result<bool, Failure> {
        match self.vertex_type {
            0 => Ok(true),
            1 => Ok(false),
            other => Err(unknown("vertex_type", other, "complete_mesh_vertex_type")),
        }
    }

    /// Whether the result shall hold the whole mesh.
    pub(super) fn whole_mesh(&self) -> Result<bool, Failure> {
        match self.output {
            0 => Ok(true),
            1 => Ok(false),
            other => Err(unknown("output", other, "complete_mesh_output")),
        }
    }
}

pub(super) fn unknown(field: &str, value: u32, name: &str) -> Failure {
    Failure::argument(format!("option {field} is {value}, which is no {name}"))
}

pub(super) fn flag(field: &str, value: u32) -> Result<bool, Failure> {
    match value {
        0 => Ok(false),
        1 => Ok(true),
        other => {
            Err(Failure::argument(format!("option {field} is {other}: only 0 and 1 are allowed")))
        }
    }
}

/// Whether a caller's struct may have this size. Every field is 4 or 8 bytes wide and the narrow
/// ones come in pairs, so a multiple of the alignment, which any sizeof is, cuts no field.
fn is_struct_size(size: usize) -> bool {
    (MIN_STRUCT_SIZE..=MAX_STRUCT_SIZE).contains(&size)
        && size.is_multiple_of(align_of::<COptions>())
}

/// Sets an options struct to the defaults.
///
/// opts: receives the defaults; its old content is not read.
/// struct_size: sizeof(complete_mesh_options) as your program was compiled; not a byte beyond is
/// written.
///
/// Returns COMPLETE_MESH_STATUS_OK, or COMPLETE_MESH_STATUS_INVALID_ARGUMENT for NULL or a size
/// that cannot be; then nothing is written.
#[no_mangle]
pub unsafe extern "C" fn complete_mesh_options_init(
    opts: *mut COptions,
    struct_size: usize,
) -> Status {
    guard(|| {
        if opts.is_null() {
            return Err(Failure::argument("opts is NULL"));
        }
        if !is_struct_size(struct_size) {
            return Err(Failure::argument(format!(
                "struct_size is {struct_size}: pass sizeof(complete_mesh_options)"
            )));
        }
        let defaults = COptions { struct_size: struct_size as u32, ..COptions::defaults() };
        let known = struct_size.min(size_of::<COptions>());
        // SAFETY: the caller answers for `struct_size` writable bytes. What a newer caller has
        // beyond the known fields becomes zero, which every later field means as its default.
        unsafe {
            let bytes = opts.cast::<u8>();
            std::ptr::copy_nonoverlapping(std::ptr::from_ref(&defaults).cast(), bytes, known);
            bytes.add(known).write_bytes(0, struct_size - known);
        }
        Ok(())
    })
}

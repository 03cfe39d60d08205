//! The entries that find and fill holes.

use super::error::{Failure, Status};
use super::guard::{guard, guard_value};
use super::holes::Holes;
use super::input::Input;
use super::options::COptions;
use super::progress::with_monitor;
use super::result::MeshResult;
use crate::complete::Completer;
use crate::holes::find_holes;
use crate::holes::select::select_holes;
use std::ffi::c_void;

/// A mesh whose holes are known, for filling them more than once with different options. Opaque;
/// free it with complete_mesh_completer_free.
pub struct MeshCompleter {
    /// Borrows the caller's arrays: the header obliges him to keep them.
    input: Input<'static>,
    completer: Completer<'static>,
    holes: Holes,
}

// Several threads may use one completer, as the header says.
const _: () = {
    const fn shared<T: Send + Sync>() {}
    shared::<MeshCompleter>();
    shared::<MeshResult>();
};

/// Empties an out pointer, so that no failure leaves the caller with something to free.
///
/// # Safety
/// `out` is NULL or writable.
pub(super) unsafe fn empty<T>(name: &str, out: *mut *mut T) -> Result<(), Failure> {
    if out.is_null() {
        return Err(Failure::argument(format!("{name} is NULL")));
    }
    // SAFETY: by the contract of this function.
    unsafe { out.write_unaligned(std::ptr::null_mut()) };
    Ok(())
}

/// Gives a new object to the caller.
///
/// # Safety
/// `out` is writable.
pub(super) unsafe fn give<T>(out: *mut *mut T, object: T) {
    // SAFETY: by the contract of this function.
    unsafe { out.write_unaligned(Box::into_raw(Box::new(object))) };
}

fn completed(
    input: &Input,
    completer: &Completer,
    opts: &COptions,
    options: &crate::options::Options,
    monitor: &crate::progress::Monitor,
) -> Result<MeshResult, Failure> {
    let whole_mesh = opts.whole_mesh()?;
    let completion = completer.complete(options, monitor)?;
    let values = options.appearance.as_ref().map_or_else(Vec::new, |appearance| {
        let exemplar = options.sources.exemplar.as_deref();
        appearance.complete(input.view.faces, exemplar, &completion)
    });
    let holes = Holes::new(completer.holes(), &completion.holes);
    MeshResult::new(input, holes, completion, values, whole_mesh)
}

/// Fills the holes of a triangle mesh. The input is only read, and only while the call lasts.
///
/// vertices: positions, three numbers each; float unless vertex_type of the options says double.
/// Any alignment. NULL if vertex_count is 0.
/// vertex_count: how many vertices.
/// faces: three 32-bit vertex indices each, counter-clockwise seen from outside. Any alignment.
/// NULL if face_count is 0.
/// face_count: how many faces.
/// opts: NULL for the defaults: packed float vertices, every hole, coherent fills.
/// result: receives the new result, to be freed with complete_mesh_result_free; NULL on failure.
///
/// Returns COMPLETE_MESH_STATUS_OK, also for a mesh without holes, or what was wrong. May be called
/// by any number of threads at once.
#[no_mangle]
pub unsafe extern "C" fn complete_mesh(
    vertices: *const c_void,
    vertex_count: usize,
    faces: *const u32,
    face_count: usize,
    opts: *const COptions,
    result: *mut *mut MeshResult,
) -> Status {
    guard(|| {
        // SAFETY: NULL or valid, by the contract of the header; so for all pointers.
        unsafe { empty("result", result) }?;
        // SAFETY: as above.
        let opts = unsafe { COptions::read(opts) }?;
        // SAFETY: as above.
        let options = unsafe { opts.checked(vertex_count, face_count) }?;
        options.check()?;
        // SAFETY: as above.
        let input = unsafe { Input::new(vertices, vertex_count, faces, face_count, &opts) }?;
        let made = with_monitor(&opts, |monitor| {
            let completer = Completer::new(input.view, &options.grouping, monitor)?;
            completed(&input, &completer, &opts, &options, monitor)
        })?;
        // SAFETY: `empty` has written there.
        unsafe { give(result, made) };
        Ok(())
    })
}

/// Finds and measures the holes of a mesh and fills nothing.
///
/// vertices, vertex_count, faces, face_count: as for complete_mesh.
/// opts: vertex_type, the strides, grouping, selection and progress count, but all are checked; NULL
/// for the defaults. Holes outside the selection are listed as COMPLETE_MESH_HOLE_STATUS_NOT_SELECTED.
/// holes: receives the new list, to be freed with complete_mesh_holes_free; NULL on failure.
///
/// Returns COMPLETE_MESH_STATUS_OK or what was wrong. May be called by any number of threads at
/// once.
#[no_mangle]
pub unsafe extern "C" fn complete_mesh_find_holes(
    vertices: *const c_void,
    vertex_count: usize,
    faces: *const u32,
    face_count: usize,
    opts: *const COptions,
    holes: *mut *mut Holes,
) -> Status {
    guard(|| {
        // SAFETY: NULL or valid, by the contract of the header; so for all pointers.
        unsafe { empty("holes", holes) }?;
        // SAFETY: as above.
        let opts = unsafe { COptions::read(opts) }?;
        // SAFETY: as above.
        let options = unsafe { opts.checked(vertex_count, face_count) }?;
        options.check()?;
        opts.whole_mesh()?;
        // SAFETY: as above.
        let input = unsafe { Input::new(vertices, vertex_count, faces, face_count, &opts) }?;
        let found = with_monitor(&opts, |monitor| {
            let list = find_holes(input.view, &options.grouping, monitor)?;
            let mut holes = Holes::new(&list, &[]);
            holes.mark_selected(&select_holes(input.view, &list, &options.selection)?);
            Ok(holes)
        })?;
        // SAFETY: `empty` has written there.
        unsafe { give(holes, found) };
        Ok(())
    })
}

/// Makes a completer: checks a mesh and finds its holes once, for many fills. It keeps pointers to
/// the arrays, not a copy: they must stay as they are until complete_mesh_completer_free.
///
/// vertices, vertex_count, faces, face_count: as for complete_mesh.
/// opts: only vertex_type, the strides, grouping and progress count, but all are checked; NULL for
/// the defaults.
/// completer: receives the new completer, to be freed with complete_mesh_completer_free; NULL on
/// failure.
///
/// Returns COMPLETE_MESH_STATUS_OK or what was wrong.
#[no_mangle]
pub unsafe extern "C" fn complete_mesh_completer_new(
    vertices: *const c_void,
    vertex_count: usize,
    faces: *const u32,
    face_count: usize,
    opts: *const COptions,
    completer: *mut *mut MeshCompleter,
) -> Status {
    guard(|| {
        // SAFETY: NULL or valid, by the contract of the header; so for all pointers.
        unsafe { empty("completer", completer) }?;
        // SAFETY: as above.
        let opts = unsafe { COptions::read(opts) }?;
        // SAFETY: as above.
        let options = unsafe { opts.checked(vertex_count, face_count) }?;
        options.check()?;
        opts.whole_mesh()?;
        // SAFETY: as above; the caller keeps the arrays for as long as the completer.
        let input = unsafe { Input::new(vertices, vertex_count, faces, face_count, &opts) }?;
        let made = with_monitor(&opts, |monitor| {
            Ok(Completer::new(input.view, &options.grouping, monitor)?)
        })?;
        let holes = Holes::new(made.holes(), &[]);
        // SAFETY: `empty` has written there.
        unsafe { give(completer, MeshCompleter { input, completer: made, holes }) };
        Ok(())
    })
}

/// Fills holes of a completer's mesh.
///
/// completer: not NULL. Any number of threads may use one completer at once.
/// opts: as for complete_mesh, but vertex_type, the strides and grouping were settled by
/// complete_mesh_completer_new and are not used; NULL for the defaults.
/// result: receives the new result, to be freed with complete_mesh_result_free, before or after the
/// completer; NULL on failure.
///
/// Returns COMPLETE_MESH_STATUS_OK or what was wrong.
#[no_mangle]
pub unsafe extern "C" fn complete_mesh_completer_complete(
    completer: *const MeshCompleter,
    opts: *const COptions,
    result: *mut *mut MeshResult,
) -> Status {
    guard(|| {
        // SAFETY: NULL or valid, by the contract of the header; so for all pointers.
        unsafe { empty("result", result) }?;
        // SAFETY: as above.
        let opts = unsafe { COptions::read(opts) }?;
        // SAFETY: as above.
        let Some(known) = (unsafe { completer.as_ref() }) else {
            return Err(Failure::argument("completer is NULL"));
        };
        // SAFETY: as above.
        let (vertices, faces) = (known.input.view.vertices.len(), known.input.view.faces.len());
        // SAFETY: as above.
        let options = unsafe { opts.checked(vertices, faces) }?;
        options.check()?;
        opts.single()?;
        let made = with_monitor(&opts, |monitor| {
            completed(&known.input, &known.completer, &opts, &options, monitor)
        })?;
        // SAFETY: `empty` has written there.
        unsafe { give(result, made) };
        Ok(())
    })
}

/// The holes of a completer's mesh, to be read with complete_mesh_holes_.... They belong to the
/// completer: do not free them. NULL for NULL.
#[no_mangle]
pub unsafe extern "C" fn complete_mesh_completer_holes(
    completer: *const MeshCompleter,
) -> *const Holes {
    guard_value(std::ptr::null(), || {
        // SAFETY: NULL or alive, by the contract of the header.
        Some(std::ptr::from_ref(&unsafe { completer.as_ref() }?.holes))
    })
}

/// Frees a completer; NULL is allowed. Its results live on.
#[no_mangle]
pub unsafe extern "C" fn complete_mesh_completer_free(completer: *mut MeshCompleter) {
    guard_value((), || {
        if !completer.is_null() {
            // SAFETY: made by `Box::into_raw` in `complete_mesh_completer_new`, freed once.
            drop(unsafe { Box::from_raw(completer) });
        }
        None
    })
}

//! Point clouds for C: their holes found and filled.

use super::completer::{empty, give};
use super::error::Status;
use super::guard::{guard, guard_value};
use super::holes::{list, Holes};
use super::input::{normals as normals_of, Input};
use super::options::COptions;
use super::progress::with_monitor;
use super::result::MeshResult;
use crate::points::{complete_points_with, find_point_holes, select_point_holes, PointHoles};
use crate::result::HoleReport;
use std::ffi::c_void;

/// What finds the holes of a cloud: one bit each, to be added up.
#[repr(C)]
pub enum CDetector {
    /// The mesh that is laid through the points has a rim there. It finds all holes that are listed.
    Surface = 1,
    /// Points that are likely to lie on a boundary close a loop there (Bendels et al. 2005).
    Boundary = 2,
    /// Contours of the distance field that are inside and outside meet there (Park et al. 2006). Where the
    /// surface is open it cannot say, and counts as not asked.
    Field = 4,
}

/// Why points of a cloud were not looked at. They stay where they are.
#[repr(C)]
pub enum CIgnored {
    /// They have no coordinates: three NaN.
    Missing = 0,
    /// They are at the place of an earlier point, or within a quarter of the spacing of it.
    Duplicate = 1,
    /// They lie beside the surface.
    Outlier = 2,
    /// They lie inside a loop that was given.
    Inside = 3,
}

impl Holes {
    /// All holes and borders of a cloud, with what `reports` say became of them, by id.
    pub(super) fn of_points(found: &PointHoles, reports: &[HoleReport]) -> Self {
        let mut holes = Self::new(&found.list, reports);
        let bit = |detector: CDetector, is: bool| if is { detector as u32 } else { 0 };
        for (i, info) in holes.entries.iter_mut().map(|e| &mut e.info).enumerate() {
            let (always, in_field) = (CDetector::Surface as u32, found.in_field[i]);
            info.is_border = u32::from(found.borders[i]);
            info.detectors_asked =
                always + CDetector::Boundary as u32 + bit(CDetector::Field, in_field.is_some());
            info.detectors_agreed = always
                + bit(CDetector::Boundary, found.in_loops[i])
                + bit(CDetector::Field, in_field == Some(true));
            info.boundary_probability = found.probability[i];
            info.missing_points = found.missing_in[i];
        }
        holes.spacing = found.spacing;
        holes.only_in_field = found.only_in_field.as_flattened().to_vec();
        holes.ignored =
            [&found.missing, &found.doubles, &found.outliers, &found.inside].map(Vec::clone);
        holes
    }
}

/// Fills the holes of a point cloud with new points. Outer borders of open surfaces stay open unless
/// they are selected by id, point or vertices. The input is only read, and only while the call lasts.
///
/// points: positions, three numbers each; float unless vertex_type of the options says double.
/// Three NaN are a point without coordinates, which is passed through. NULL if point_count is 0.
/// point_count: how many points.
/// normals: packed, of the number type of the points, any length, zero where unknown: which side is
/// out; NULL: guessed.
/// opts: as for complete_mesh, vertices being points; source_faces and the initial completion must
/// not be set. NULL for the defaults.
/// result: receives the new result, whose vertices are the points and which has no faces, to be
/// freed with complete_mesh_result_free; NULL on failure.
///
/// Returns COMPLETE_MESH_STATUS_OK, also for a cloud without holes, or what was wrong. May be called
/// by any number of threads at once.
#[no_mangle]
pub unsafe extern "C" fn complete_mesh_points(
    points: *const c_void,
    point_count: usize,
    normals: *const c_void,
    opts: *const COptions,
    result: *mut *mut MeshResult,
) -> Status {
    guard(|| {
        // SAFETY: NULL or valid, by the contract of the header; so for all pointers.
        unsafe { empty("result", result) }?;
        // SAFETY: as above.
        let opts = unsafe { COptions::read(opts) }?;
        // SAFETY: as above.
        let options = unsafe { opts.checked(point_count, 0) }?;
        let whole_mesh = opts.whole_mesh()?;
        // SAFETY: as above.
        let input = unsafe { Input::new(points, point_count, std::ptr::null(), 0, &opts) }?;
        // SAFETY: as above.
        let normals = unsafe { normals_of(normals, point_count, &opts) }?;
        let made = with_monitor(&opts, |monitor| {
            let made = complete_points_with(input.view.vertices, normals, &options, monitor)?;
            MeshResult::of_points(&input, made, whole_mesh)
        })?;
        // SAFETY: `empty` has written there.
        unsafe { give(result, made) };
        Ok(())
    })
}

/// Finds and measures the holes of a point cloud and fills nothing; detectors_agreed of a
/// complete_mesh_hole says which detectors find it.
///
/// points, point_count, normals: as for complete_mesh_points.
/// opts: vertex_type, vertex_stride, grouping, selection, clean, the given holes, threads and progress count,
/// but all are checked; NULL for the defaults. Holes outside the selection, and outer borders that are not named,
/// are listed as COMPLETE_MESH_HOLE_STATUS_NOT_SELECTED.
/// holes: receives the new list, whose vertices are points, to be freed with complete_mesh_holes_free;
/// NULL on failure.
///
/// Returns COMPLETE_MESH_STATUS_OK or what was wrong. May be called by any number of threads at
/// once.
#[no_mangle]
pub unsafe extern "C" fn complete_mesh_find_point_holes(
    points: *const c_void,
    point_count: usize,
    normals: *const c_void,
    opts: *const COptions,
    holes: *mut *mut Holes,
) -> Status {
    guard(|| {
        // SAFETY: NULL or valid, by the contract of the header; so for all pointers.
        unsafe { empty("holes", holes) }?;
        // SAFETY: as above.
        let opts = unsafe { COptions::read(opts) }?;
        // SAFETY: as above.
        let options = unsafe { opts.checked(point_count, 0) }?;
        opts.whole_mesh()?;
        // SAFETY: as above.
        let input = unsafe { Input::new(points, point_count, std::ptr::null(), 0, &opts) }?;
        // SAFETY: as above.
        let normals = unsafe { normals_of(normals, point_count, &opts) }?;
        let found = with_monitor(&opts, |monitor| {
            let cloud = input.view.vertices;
            let found = find_point_holes(cloud, normals, &options, monitor)?;
            let mut holes = Holes::of_points(&found, &[]);
            holes.mark_selected(&select_point_holes(cloud, &found, &options.selection)?);
            Ok(holes)
        })?;
        // SAFETY: `empty` has written there.
        unsafe { give(holes, found) };
        Ok(())
    })
}

/// How far apart the points of a cloud lie: the middle one of the distances to the sixth neighbour. 0
/// for a mesh.
#[no_mangle]
pub unsafe extern "C" fn complete_mesh_holes_spacing(holes: *const Holes) -> f64 {
    // SAFETY: NULL or alive, by the contract of the header.
    guard_value(0.0, || unsafe { holes.as_ref() }.map(|h| h.spacing))
}

/// The places that only the distance field takes for holes of a cloud.
///
/// count: receives how many places there are; NULL is allowed.
///
/// Returns their centres, three numbers each, in cloud units; NULL if there are none. The array belongs to
/// holes.
#[no_mangle]
pub unsafe extern "C" fn complete_mesh_holes_only_in_field(
    holes: *const Holes,
    count: *mut usize,
) -> *const f64 {
    // SAFETY: by the contract of the header.
    unsafe { list(holes, count, 3, |h| Some(&h.only_in_field)) }
}

/// Points of a cloud that were not looked at.
///
/// kind: why, a complete_mesh_ignored.
/// count: receives how many points there are; NULL is allowed.
///
/// Returns indices of input points, NULL if there are none. The array belongs to holes.
#[no_mangle]
pub unsafe extern "C" fn complete_mesh_holes_ignored_points(
    holes: *const Holes,
    kind: u32,
    count: *mut usize,
) -> *const u32 {
    // SAFETY: by the contract of the header.
    unsafe { list(holes, count, 1, |h| h.ignored.get(kind as usize).map(Vec::as_slice)) }
}

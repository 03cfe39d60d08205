//! Status codes, and the message and elements of a thread's last failure.

use super::guard::guard_value;
use super::write_out;
use crate::error::{Error, Problem};
use std::cell::RefCell;
use std::ffi::{c_char, CStr, CString};

/// What a call returns: 0 is success, everything else is negative. A failed call has no result and
/// has changed nothing; complete_mesh_last_error_message() says what was wrong and what to do.
/// Numbers are never given a second meaning.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// Success.
    Ok = 0,
    /// A NULL pointer that must not be, a size or stride that cannot be, a number that is none of
    /// an enum's.
    InvalidArgument = -1,
    /// An option is outside its range.
    InvalidOption = -2,
    /// The mesh has no faces, a coordinate that is not finite, a face that names a vertex that
    /// does not exist, or too many elements for 32-bit indices.
    InvalidMesh = -3,
    /// The selection names a hole that does not exist.
    NoSuchHole = -4,
    /// A selected hole cannot be filled safely, e.g. because loops touch in a vertex. See the
    /// option skip_unsafe.
    UnsafeHole = -5,
    /// No fill that keeps the contract was found for a selected hole. See the option skip_unsafe.
    HoleFailed = -6,
    /// This version cannot do what was asked for.
    Unsupported = -7,
    /// The progress function returned non-zero.
    Cancelled = -8,
    /// There was no memory for the result.
    OutOfMemory = -9,
    /// A fault of this library: please report the message.
    Internal = -99,
}

impl Status {
    const ALL: [Status; 11] = [
        Status::Ok,
        Status::InvalidArgument,
        Status::InvalidOption,
        Status::InvalidMesh,
        Status::NoSuchHole,
        Status::UnsafeHole,
        Status::HoleFailed,
        Status::Unsupported,
        Status::Cancelled,
        Status::OutOfMemory,
        Status::Internal,
    ];

    fn name(self) -> &'static CStr {
        match self {
            Status::Ok => c"ok",
            Status::InvalidArgument => c"invalid argument",
            Status::InvalidOption => c"invalid option",
            Status::InvalidMesh => c"invalid mesh",
            Status::NoSuchHole => c"no such hole",
            Status::UnsafeHole => c"unsafe hole",
            Status::HoleFailed => c"hole failed",
            Status::Unsupported => c"unsupported",
            Status::Cancelled => c"cancelled",
            Status::OutOfMemory => c"out of memory",
            Status::Internal => c"internal error",
        }
    }
}

/// The kinds of elements that an error or a hole's problem can name.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ElementKind {
    /// Indices of input vertices, one number each.
    Vertex = 0,
    /// Edges, two numbers each: the indices of their two input vertices.
    Edge = 1,
    /// Indices of input faces, one number each.
    Face = 2,
    /// Ids of holes, one number each.
    Hole = 3,
}

/// The elements of an error or a problem, by kind; edges are flattened to pairs.
#[derive(Debug, Default, Clone)]
pub(super) struct Elements {
    vertices: Vec<u32>,
    edges: Vec<u32>,
    faces: Vec<u32>,
    holes: Vec<u32>,
}

impl Elements {
    pub(super) fn of_problem(problem: &Problem) -> Self {
        let mut named = Elements::default();
        named.add_problem(problem);
        named
    }

    fn add_problem(&mut self, problem: &Problem) {
        match problem {
            Problem::TouchingLoops { vertices } => self.vertices.extend_from_slice(vertices),
            Problem::NonManifoldEdge { edges } | Problem::InconsistentOrientation { edges } => {
                self.edges.extend(edges.as_flattened())
            }
        }
    }

    fn of_error(error: &Error) -> Self {
        let mut named = Elements::default();
        match error {
            Error::NonFinite { vertex: v } | Error::NonFinitePoint { point: v } => {
                named.vertices.push(*v as u32)
            }
            Error::IndexOutOfRange { face, .. } => named.faces.push(*face as u32),
            Error::NoSuchHole { hole, .. } | Error::HoleFailed { hole, .. } => {
                named.holes.push(*hole as u32)
            }
            Error::UnsafeHole { hole, problem } => {
                named.holes.push(*hole as u32);
                named.add_problem(problem);
            }
            Error::Empty
            | Error::TooFewPoints { .. }
            | Error::PointsOnALine { .. }
            | Error::NoSurface { .. }
            | Error::TooLarge { .. }
            | Error::InvalidOption { .. }
            | Error::Unsupported { .. }
            | Error::Cancelled => {}
        }
        named
    }

    /// The numbers of one kind and how many elements they are; `None` for an unknown kind.
    pub(super) fn list(&self, kind: u32) -> Option<(&[u32], usize)> {
        let numbers: &[u32] = match kind {
            0 => &self.vertices,
            1 => &self.edges,
            2 => &self.faces,
            3 => &self.holes,
            _ => return None,
        };
        Some((numbers, if kind == 1 { numbers.len() / 2 } else { numbers.len() }))
    }
}

/// Why an entry of the C ABI gives no result.
#[derive(Debug)]
pub(super) struct Failure {
    status: Status,
    message: String,
    /// Boxed: a failure is carried by every result on the good way, too.
    elements: Box<Elements>,
}

impl Failure {
    pub(super) fn new(status: Status, message: impl Into<String>) -> Self {
        Failure { status, message: message.into(), elements: Box::default() }
    }

    pub(super) fn argument(message: impl Into<String>) -> Self {
        Self::new(Status::InvalidArgument, message)
    }
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        let status = match &error {
            Error::Empty
            | Error::NonFinite { .. }
            | Error::NonFinitePoint { .. }
            | Error::TooFewPoints { .. }
            | Error::PointsOnALine { .. }
            | Error::NoSurface { .. }
            | Error::IndexOutOfRange { .. }
            | Error::TooLarge { .. } => Status::InvalidMesh,
            Error::NoSuchHole { .. } => Status::NoSuchHole,
            Error::UnsafeHole { .. } => Status::UnsafeHole,
            Error::HoleFailed { .. } => Status::HoleFailed,
            Error::InvalidOption { .. } => Status::InvalidOption,
            Error::Unsupported { .. } => Status::Unsupported,
            Error::Cancelled => Status::Cancelled,
        };
        Failure {
            status,
            message: error.to_string(),
            elements: Box::new(Elements::of_error(&error)),
        }
    }
}

/// A thread's last failure.
#[derive(Default)]
struct Last {
    message: CString,
    elements: Elements,
}

thread_local! {
    static LAST: RefCell<Last> = RefCell::default();
}

/// A C string of any text; C strings end at the first NUL, so one inside becomes a space.
pub(super) fn c_string(text: &str) -> CString {
    CString::new(text.replace('\0', " ")).unwrap_or_default()
}

/// Keeps a failure as the thread's last and gives back its status.
pub(super) fn keep(failure: Failure) -> Status {
    let last = Last { message: c_string(&failure.message), elements: *failure.elements };
    // A host may call from a destructor of a dying thread: the message is lost then, not the call.
    let _ = LAST.try_with(|l| *l.borrow_mut() = last);
    failure.status
}

/// What went wrong in the last call that failed on this thread: what, in which element, what to
/// do about it; English, UTF-8. Empty before the first failure. Calls that succeed leave it alone.
/// The string belongs to the library and is valid until the next failure on this thread.
/// Never NULL.
#[no_mangle]
pub extern "C" fn complete_mesh_last_error_message() -> *const c_char {
    LAST.try_with(|l| l.borrow().message.as_ptr()).unwrap_or(c"".as_ptr())
}

/// The elements of one kind that the last failure on this thread named, so that a host can select
/// or draw them: an unsafe hole names itself and the vertices or edges that are in the way.
///
/// kind: a complete_mesh_element_kind.
/// count: receives how many elements there are, 0 if none; NULL is allowed. Edges take two
/// numbers each, so the array then has 2 * count of them.
///
/// Returns NULL if there are none or kind is unknown. The array belongs to the library and is
/// valid until the next failure on this thread.
#[no_mangle]
pub unsafe extern "C" fn complete_mesh_last_error_elements(
    kind: u32,
    count: *mut usize,
) -> *const u32 {
    // SAFETY: `count` is NULL or writable, by the contract of the header.
    unsafe { write_out(count, 0) };
    guard_value(std::ptr::null(), || {
        LAST.try_with(|l| {
            let last = l.borrow();
            let (numbers, elements) = last.elements.list(kind)?;
            // SAFETY: as above.
            unsafe { write_out(count, elements) };
            (elements > 0).then_some(numbers.as_ptr())
        })
        .ok()?
    })
}

/// A short English name of a status, e.g. "invalid mesh"; "unknown status" for any other number.
/// A static string, never NULL.
#[no_mangle]
pub extern "C" fn complete_mesh_status_name(status: i32) -> *const c_char {
    Status::ALL
        .iter()
        .find(|s| **s as i32 == status)
        .map_or(c"unknown status", |s| s.name())
        .as_ptr()
}

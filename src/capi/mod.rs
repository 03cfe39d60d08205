//! The C ABI: the calls of this crate behind `include/complete_mesh.h`, which is made from these
//! sources by cbindgen; `docs/c-abi.md` has the rules that it keeps. No algorithm lives here.
//!
//! The comments of the exported items are written for readers of the header.

// Their contracts are spelled out parameter by parameter, in C's terms.
#![allow(clippy::missing_safety_doc)]

mod arrays;
mod checked;
mod choices;
mod completer;
mod error;
mod guard;
mod guidance;
mod holes;
mod input;
mod options;
mod points;
mod progress;
mod result;

pub use choices::*;
pub use completer::*;
pub use error::*;
pub use holes::*;
pub use options::*;
pub use points::*;
pub use result::*;

use std::ffi::c_char;

/// Version of this header, first number.
pub const VERSION_MAJOR: u32 = 0;
/// Version of this header, second number.
pub const VERSION_MINOR: u32 = 1;
/// Version of this header, third number.
pub const VERSION_PATCH: u32 = 0;
/// Version of this header as one number that grows: major * 1000000 + minor * 1000 + patch.
pub const VERSION: u32 = VERSION_MAJOR * 1000000 + VERSION_MINOR * 1000 + VERSION_PATCH;
/// Changes when programs must be compiled anew; the number in the shared library's soname. Compare
/// it with complete_mesh_abi_version() when you load the library by hand.
pub const ABI_VERSION: u32 = 0;

/// COMPLETE_MESH_VERSION of the library that is running.
#[no_mangle]
pub extern "C" fn complete_mesh_version() -> u32 {
    VERSION
}

/// The version of the library that is running, e.g. "0.1.0". A static string.
#[no_mangle]
pub extern "C" fn complete_mesh_version_string() -> *const c_char {
    const TEXT: &str = concat!(env!("CARGO_PKG_VERSION"), "\0");
    TEXT.as_ptr().cast()
}

/// COMPLETE_MESH_ABI_VERSION of the library that is running.
#[no_mangle]
pub extern "C" fn complete_mesh_abi_version() -> u32 {
    ABI_VERSION
}

/// Writes to an out parameter that may be NULL.
///
/// # Safety
/// `out` is NULL or writable.
unsafe fn write_out<T>(out: *mut T, value: T) {
    if !out.is_null() {
        // SAFETY: by the contract of this function.
        unsafe { out.write_unaligned(value) };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By value: a macro that is put together wrongly compiles, and is right for 0.0.0.
    #[test]
    fn version_is_the_packages() {
        let parts = [
            env!("CARGO_PKG_VERSION_MAJOR"),
            env!("CARGO_PKG_VERSION_MINOR"),
            env!("CARGO_PKG_VERSION_PATCH"),
        ]
        .map(|p| p.parse::<u32>().unwrap());
        assert_eq!([VERSION_MAJOR, VERSION_MINOR, VERSION_PATCH], parts);
        assert_eq!(VERSION, parts[0] * 1_000_000 + parts[1] * 1000 + parts[2]);
    }
}

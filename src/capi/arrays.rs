//! Copies of the arrays that options point to, which need not be aligned.

use super::error::{Failure, Status};
use std::ffi::c_void;

/// Packed points, of floats if `single`, else of doubles.
///
/// # Safety
/// The array is as long as `count` says.
pub(super) unsafe fn points(
    name: &str,
    data: *const c_void,
    count: usize,
    single: bool,
) -> Result<Vec<[f64; 3]>, Failure> {
    let numbers = count.saturating_mul(3);
    Ok(match single {
        // SAFETY: the caller answers for the array.
        true => unsafe { array::<f32>(name, data.cast(), numbers) }?
            .chunks_exact(3)
            .map(|p| [p[0], p[1], p[2]].map(f64::from))
            .collect(),
        // SAFETY: as above.
        false => unsafe { array::<f64>(name, data.cast(), numbers) }?
            .chunks_exact(3)
            .map(|p| [p[0], p[1], p[2]])
            .collect(),
    })
}

/// Packed triangles.
///
/// # Safety
/// The array is as long as `count` says.
pub(super) unsafe fn corners(
    name: &str,
    data: *const u32,
    count: usize,
) -> Result<Vec<[u32; 3]>, Failure> {
    // SAFETY: the caller answers for the array.
    let numbers = unsafe { array(name, data, count.saturating_mul(3)) }?;
    Ok(numbers.chunks_exact(3).map(|f| [f[0], f[1], f[2]]).collect())
}

/// A copy of a caller's array of numbers.
///
/// # Safety
/// The array is as long as `count` says.
pub(super) unsafe fn array<T: Copy>(
    name: &str,
    data: *const T,
    count: usize,
) -> Result<Vec<T>, Failure> {
    if count == 0 {
        return Ok(Vec::new());
    }
    if data.is_null() {
        return Err(Failure::argument(format!(
            "{name} is NULL, but {count} numbers are asked of it"
        )));
    }
    // Everything is numbered with 32 bits, in threes at most: a longer list is garbage.
    if count > 3 * u32::MAX as usize || count > isize::MAX as usize / size_of::<T>() {
        return Err(Failure::argument(format!("{name} cannot have {count} numbers")));
    }
    let mut copy: Vec<T> = Vec::new();
    copy.try_reserve_exact(count)
        .map_err(|_| Failure::new(Status::OutOfMemory, format!("no memory for {name}")))?;
    // SAFETY: the caller answers for `count` readable numbers; as many are reserved.
    unsafe {
        std::ptr::copy_nonoverlapping(
            data.cast::<u8>(),
            copy.as_mut_ptr().cast(),
            count * size_of::<T>(),
        );
        copy.set_len(count);
    }
    Ok(copy)
}

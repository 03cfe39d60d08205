//! The caller's arrays as views: checked for what can be checked, read where they lie.

use super::error::Failure;
use super::options::COptions;
use crate::mesh::{FaceView, MeshView, VertexView};
use bytemuck::Pod;
use std::ffi::c_void;

/// Bytes of a face: three u32.
const FACE_SIZE: usize = 12;

/// The bytes of an array as a slice.
///
/// # Safety
/// `data` is NULL or has `count` readable elements of `size` bytes, `stride` apart, that nobody
/// writes while `'a` lasts.
unsafe fn bytes<'a>(
    name: &str,
    data: *const c_void,
    count: usize,
    size: usize,
    stride: usize,
) -> Result<&'a [u8], Failure> {
    if count == 0 {
        return Ok(&[]);
    }
    if data.is_null() {
        return Err(Failure::argument(format!("{name} is NULL, but its count is {count}")));
    }
    if stride < size {
        return Err(Failure::argument(format!(
            "the stride of {name} is {stride} bytes, but one element takes {size}"
        )));
    }
    let length = (count - 1).checked_mul(stride).and_then(|n| n.checked_add(size));
    let fits = |n: &usize| *n <= isize::MAX as usize && data.addr().checked_add(*n).is_some();
    let Some(length) = length.filter(fits) else {
        return Err(Failure::argument(format!(
            "{count} {name} of stride {stride} are more than memory can hold"
        )));
    };
    // SAFETY: not NULL, of a length that memory can have, readable by the caller's word; bytes
    // need no alignment.
    Ok(unsafe { std::slice::from_raw_parts(data.cast::<u8>(), length) })
}

/// The caller's normals, one a vertex, packed, in the number type of the vertices; none for NULL.
///
/// # Safety
/// `normals` is NULL or has `count` of them that nobody writes while `'a` lasts.
pub(super) unsafe fn normals<'a>(
    normals: *const c_void,
    count: usize,
    opts: &COptions,
) -> Result<Option<VertexView<'a>>, Failure> {
    if normals.is_null() {
        return Ok(None);
    }
    let single = opts.single()?;
    let size = if single { 12 } else { 24 };
    // SAFETY: the caller of this function answers for the array.
    let bytes = unsafe { bytes("normals", normals, count, size, size)? };
    Ok(VertexView::from_bytes(bytes, count, size, single))
}

/// The caller's mesh: the view that the algorithms read, and the bytes below it, which alone give
/// the input back bit for bit.
#[derive(Clone, Copy)]
pub(super) struct Input<'a> {
    pub view: MeshView<'a>,
    vertices: &'a [u8],
    vertex_stride: usize,
    faces: &'a [u8],
    face_stride: usize,
}

impl<'a> Input<'a> {
    /// Checks and borrows the caller's arrays.
    ///
    /// # Safety
    /// The arrays are NULL or as long as counts, strides and vertex type say, and nobody writes
    /// them while `'a` lasts.
    pub unsafe fn new(
        vertices: *const c_void,
        vertex_count: usize,
        faces: *const u32,
        face_count: usize,
        opts: &COptions,
    ) -> Result<Self, Failure> {
        let single = opts.single()?;
        let vertex_size = if single { 12 } else { 24 };
        let or_packed = |stride, size| if stride == 0 { size } else { stride };
        let vertex_stride = or_packed(opts.vertex_stride, vertex_size);
        let face_stride = or_packed(opts.face_stride, FACE_SIZE);
        // SAFETY: the caller of this function answers for both arrays.
        let (v, f) = unsafe {
            (
                bytes("vertices", vertices, vertex_count, vertex_size, vertex_stride)?,
                bytes("faces", faces.cast(), face_count, FACE_SIZE, face_stride)?,
            )
        };
        let views = VertexView::from_bytes(v, vertex_count, vertex_stride, single)
            .zip(FaceView::from_bytes(f, face_count, face_stride));
        let Some((vertex_view, face_view)) = views else {
            return Err(Failure::argument("a stride is smaller than its element"));
        };
        let view = MeshView { vertices: vertex_view, faces: face_view };
        Ok(Input { view, vertices: v, vertex_stride, faces: f, face_stride })
    }

    /// The positions, packed; `T` is `[f32; 3]` or `[f64; 3]`, as the vertices are.
    pub fn append_vertices<T: Pod>(&self, to: &mut Vec<T>) {
        append(self.vertices, self.view.vertices.len(), self.vertex_stride, to);
    }

    /// The faces, packed.
    pub fn append_faces(&self, to: &mut Vec<[u32; 3]>) {
        append(self.faces, self.view.faces.len(), self.face_stride, to);
    }
}

fn append<T: Pod>(bytes: &[u8], count: usize, stride: usize, to: &mut Vec<T>) {
    let size = size_of::<T>();
    to.extend((0..count).map(|i| bytemuck::pod_read_unaligned::<T>(&bytes[i * stride..][..size])));
}

//! Read-only views of the caller's vertex and face arrays: f32 or f64, any byte stride, no copy.

use bytemuck::Pod;

/// Positions: `count` vertices of three f32 or f64, `stride` bytes from one to the next.
#[derive(Clone, Copy)]
pub struct VertexView<'a> {
    bytes: &'a [u8],
    stride: usize,
    count: usize,
    single: bool,
}

/// Triangles: `count` faces of three u32 vertex indices, `stride` bytes from one to the next.
#[derive(Clone, Copy)]
pub struct FaceView<'a> {
    bytes: &'a [u8],
    stride: usize,
    count: usize,
}

/// A triangle mesh: both views together.
#[derive(Clone, Copy)]
pub struct MeshView<'a> {
    /// The positions.
    pub vertices: VertexView<'a>,
    /// The triangles.
    pub faces: FaceView<'a>,
}

fn load<T: Pod>(bytes: &[u8], at: usize) -> T {
    bytemuck::pod_read_unaligned(&bytes[at..at + std::mem::size_of::<T>()])
}

/// The bytes that `count` elements of `size` bytes take, `stride` apart.
fn needed(count: usize, size: usize, stride: usize) -> Option<usize> {
    match count {
        0 => Some(0),
        _ => (count - 1).checked_mul(stride)?.checked_add(size),
    }
}

impl<'a> VertexView<'a> {
    /// Positions in raw bytes: `single` says f32 (else f64), `stride` is at least the size of
    /// three coordinates. `None` if `bytes` is too short or the stride too small.
    pub fn from_bytes(bytes: &'a [u8], count: usize, stride: usize, single: bool) -> Option<Self> {
        let size = if single { 12 } else { 24 };
        (stride >= size && bytes.len() >= needed(count, size, stride)?).then_some(Self {
            bytes,
            stride,
            count,
            single,
        })
    }

    /// How many vertices.
    pub fn len(&self) -> usize {
        self.count
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Whether the positions are f32: new vertices are then rounded to f32, too.
    pub fn is_single(&self) -> bool {
        self.single
    }

    /// Position of vertex `i`. Panics when `i` is out of range.
    #[inline]
    pub fn get(&self, i: usize) -> [f64; 3] {
        let at = i * self.stride;
        if self.single {
            load::<[f32; 3]>(self.bytes, at).map(f64::from)
        } else {
            load::<[f64; 3]>(self.bytes, at)
        }
    }
}

impl<'a> FaceView<'a> {
    /// Faces in raw bytes, `stride` at least 12. `None` if `bytes` is too short.
    pub fn from_bytes(bytes: &'a [u8], count: usize, stride: usize) -> Option<Self> {
        (stride >= 12 && bytes.len() >= needed(count, 12, stride)?).then_some(Self {
            bytes,
            stride,
            count,
        })
    }

    /// How many faces.
    pub fn len(&self) -> usize {
        self.count
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// The vertices of face `f`. Panics when `f` is out of range.
    #[inline]
    pub fn get(&self, f: usize) -> [u32; 3] {
        load(self.bytes, f * self.stride)
    }
}

impl<'a> From<&'a [[f32; 3]]> for VertexView<'a> {
    fn from(v: &'a [[f32; 3]]) -> Self {
        Self { bytes: bytemuck::cast_slice(v), stride: 12, count: v.len(), single: true }
    }
}

impl<'a> From<&'a [[f64; 3]]> for VertexView<'a> {
    fn from(v: &'a [[f64; 3]]) -> Self {
        Self { bytes: bytemuck::cast_slice(v), stride: 24, count: v.len(), single: false }
    }
}

impl<'a> From<&'a [[u32; 3]]> for FaceView<'a> {
    fn from(f: &'a [[u32; 3]]) -> Self {
        Self { bytes: bytemuck::cast_slice(f), stride: 12, count: f.len() }
    }
}

impl<'a> MeshView<'a> {
    /// Both views together.
    pub fn new(vertices: impl Into<VertexView<'a>>, faces: impl Into<FaceView<'a>>) -> Self {
        Self { vertices: vertices.into(), faces: faces.into() }
    }
}

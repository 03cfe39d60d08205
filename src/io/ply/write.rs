//! Writing rows, and whole files.

use super::header::{Encoding, Scalar};
use crate::io::text::push_real;
use crate::mesh::VertexView;

/// Rows being written.
pub(super) struct Rows {
    encoding: Encoding,
    line_end: &'static [u8],
    pub out: Vec<u8>,
    row_start: usize,
}

impl Rows {
    pub fn new(encoding: Encoding, line_end: &'static [u8]) -> Self {
        Self { encoding, line_end, out: Vec::new(), row_start: 0 }
    }

    /// Adds a value, rounded and clamped to what the type holds.
    pub fn push(&mut self, s: Scalar, value: f64) {
        if self.out.len() > self.row_start && self.encoding == Encoding::Ascii {
            self.out.push(b' ');
        }
        self.put(s, value);
    }

    /// Adds a value to a row that begins elsewhere.
    pub fn continue_row(&mut self, s: Scalar, value: f64) {
        if self.encoding == Encoding::Ascii {
            self.out.push(b' ');
        }
        self.put(s, value);
    }

    fn put(&mut self, s: Scalar, value: f64) {
        // `as` clamps, and NaN becomes 0.
        let whole = value.round() as i64;
        let (low, high) = s.range();
        let whole_in = if s.is_integer() { whole.clamp(low as i64, high as i64) } else { 0 };
        match (self.encoding, s) {
            (Encoding::Ascii, Scalar::F32 | Scalar::F64) => {
                push_real(&mut self.out, value, s == Scalar::F32)
            }
            (Encoding::Ascii, _) => self.out.extend(whole_in.to_string().into_bytes()),
            (_, Scalar::F32) => self.put_bytes((value as f32).to_le_bytes()),
            (_, Scalar::F64) => self.put_bytes(value.to_le_bytes()),
            (_, Scalar::I8 | Scalar::U8) => self.out.push(whole_in as u8),
            (_, Scalar::I16 | Scalar::U16) => self.put_bytes((whole_in as u16).to_le_bytes()),
            (_, Scalar::I32 | Scalar::U32) => self.put_bytes((whole_in as u32).to_le_bytes()),
        }
    }

    fn put_bytes<const N: usize>(&mut self, mut little: [u8; N]) {
        if self.encoding == Encoding::Big {
            little.reverse();
        }
        self.out.extend_from_slice(&little);
    }

    pub fn end_row(&mut self) {
        if self.encoding == Encoding::Ascii {
            self.out.extend_from_slice(self.line_end);
        }
        self.row_start = self.out.len();
    }
}

/// A binary PLY of positions and triangles.
pub(in crate::io) fn from_rows<T: Copy, const SIZE: usize>(
    type_name: &str,
    vertices: &[[T; 3]],
    faces: &[[u32; 3]],
    encode: impl Fn(T) -> [u8; SIZE],
) -> Vec<u8> {
    let index = if i32::try_from(vertices.len()).is_ok() { "int" } else { "uint" };
    let header = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty {type_name} x\n\
         property {type_name} y\nproperty {type_name} z\nelement face {}\n\
         property list uchar {index} vertex_indices\nend_header\n",
        vertices.len(),
        faces.len()
    );
    let size = header.len() + vertices.len() * 3 * SIZE + faces.len() * 13;
    let mut bytes = Vec::with_capacity(size);
    bytes.extend_from_slice(header.as_bytes());
    for &x in vertices.iter().flatten() {
        bytes.extend_from_slice(&encode(x));
    }
    for face in faces {
        bytes.push(3);
        face.iter().for_each(|v| bytes.extend_from_slice(&v.to_le_bytes()));
    }
    bytes
}

/// A binary PLY of polygons: `face_count` faces of at most `largest` corners.
pub(in crate::io) fn from_polygons<'a>(
    vertices: VertexView<'_>,
    single: bool,
    colours: Option<&[[u8; 4]]>,
    face_count: usize,
    largest: usize,
    faces: impl Iterator<Item = &'a [u32]>,
) -> Vec<u8> {
    let real = if single { Scalar::F32 } else { Scalar::F64 };
    let type_name = if single { "float" } else { "double" };
    let (count, count_name) =
        if largest < 256 { (Scalar::U8, "uchar") } else { (Scalar::I32, "int") };
    let index = if i32::try_from(vertices.len()).is_ok() { "int" } else { "uint" };
    let mut header =
        format!("ply\nformat binary_little_endian 1.0\nelement vertex {}\n", vertices.len());
    ["x", "y", "z"].iter().for_each(|axis| header += &format!("property {type_name} {axis}\n"));
    if colours.is_some() {
        let channels = ["red", "green", "blue", "alpha"];
        channels.iter().for_each(|c| header += &format!("property uchar {c}\n"));
    }
    header += &format!(
        "element face {face_count}\nproperty list {count_name} {index} vertex_indices\nend_header\n"
    );
    let mut rows = Rows::new(Encoding::Little, b"\n");
    rows.out = header.into_bytes();
    for i in 0..vertices.len() {
        vertices.get(i).iter().for_each(|&x| rows.push(real, x));
        if let Some(colours) = colours {
            rows.out.extend_from_slice(&colours[i]);
        }
    }
    for face in faces {
        rows.push(count, face.len() as f64);
        face.iter().for_each(|&v| rows.push(Scalar::U32, v.into()));
    }
    rows.out
}

//! Mesh files (PLY, OBJ, STL and OFF) and point files (PLY, XYZ, PCD), read without losing anything.
//!
//! A [`Document`] keeps the file's own bytes. The fill is spliced into them as new rows or lines;
//! nothing else changes but the counts, so whatever else the file holds comes back bit for bit:
//! unknown properties, comments, materials, the way a number was written.
//!
//! ```
//! use complete_mesh::io::{Document, Extras, Format};
//! use complete_mesh::MeshView;
//!
//! let text = b"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
//!     property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n\
//!     0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n".to_vec();
//! let document = Document::parse(text.clone(), Format::Ply)?;
//! let mesh = MeshView::new(document.vertices(), document.faces());
//! assert_eq!((mesh.vertices.len(), mesh.faces.get(0)), (3, [0, 1, 2]));
//! assert_eq!(document.to_bytes(), text);
//! # Ok::<(), complete_mesh::io::IoError>(())
//! ```
//!
//! The readers are our own. `ply-rs-bw`, `tobj` and `stl_io` are good at getting at the geometry,
//! but they parse into structures and write those out: f64 becomes f32, vertices are welded or
//! reordered, unknown content, comments and the digits of the text are gone.

mod attributes;
mod convert;
mod edit;
mod error;
mod mtl;
mod obj;
mod obj_corners;
mod obj_texture;
mod off;
mod pcd;
mod ply;
mod polygon;
mod stl;
mod table;
mod text;
mod xyz;

pub use error::{IoError, Place};
pub use mtl::{Material, Materials};

use crate::mesh::{FaceView, VertexView};
use crate::points::PointCompletion;
use crate::result::Completion;
use polygon::Triangles;
use std::fmt;
use std::path::Path;

/// A mesh file format.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// Polygon File Format (Turk 1994): ascii, binary little and big endian.
    Ply,
    /// Wavefront OBJ.
    Obj,
    /// Stereolithography, ascii or binary.
    Stl,
    /// Object File Format of Geomview, with or without colours and normals.
    Off,
    /// Points as text, one a line: XYZ, ASC, PTS.
    Xyz,
    /// Points of the Point Cloud Library, ascii or binary.
    Pcd,
}

impl Format {
    /// The format that a file name's extension stands for.
    pub fn from_path(path: &Path) -> Option<Self> {
        match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
            "ply" => Some(Format::Ply),
            "obj" => Some(Format::Obj),
            "stl" => Some(Format::Stl),
            "off" | "coff" | "noff" => Some(Format::Off),
            "xyz" | "xyzn" | "xyzrgb" | "asc" | "pts" => Some(Format::Xyz),
            "pcd" => Some(Format::Pcd),
            _ => None,
        }
    }

    /// The format that a file's beginning shows. OBJ and binary STL have no mark: they are never
    /// found this way.
    pub fn from_content(bytes: &[u8]) -> Option<Self> {
        let first = text::words(&bytes[..bytes.len().min(256)]).next()?;
        match first {
            b"ply" => Some(Format::Ply),
            b"solid" => Some(Format::Stl),
            _ if first.ends_with(b"OFF") => Some(Format::Off),
            _ if text::words(&bytes[..bytes.len().min(256)]).nth(1) == Some(b".PCD") => {
                Some(Format::Pcd)
            }
            _ => None,
        }
    }
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Format::Ply => "PLY",
            Format::Obj => "OBJ",
            Format::Stl => "STL",
            Format::Off => "OFF",
            Format::Xyz => "XYZ",
            Format::Pcd => "PCD",
        })
    }
}

/// What is written besides the fill itself.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Extras {
    /// Says of each vertex where it comes from. PLY gets the columns
    ///
    /// - `completed` (uchar): 1 for new vertices, else 0;
    /// - `hole` (int): the hole's id;
    /// - `source_face` (int): the input face that the detail was copied from;
    /// - `source_u`, `source_v` (float): where on it, as the weights of its second and third
    ///   corner; 0 without a source face;
    /// - `source` (int): index into [`crate::HoleReport::sources`];
    /// - `confidence` (float): 0 to 1, see [`crate::Origin::confidence`].
    ///
    /// The integers but `completed` are -1 for none, as of input vertices. A column of such a name
    /// that the file has already is not added again and keeps its values; new vertices get theirs.
    /// The other formats have no place for it: there it is [`IoError::Unsupported`].
    pub provenance: bool,
}

/// A mesh file's content, and where in it the geometry is.
#[derive(Debug, Clone)]
pub struct Document {
    bytes: Vec<u8>,
    layout: Layout,
    mesh: Mesh,
    dropped: Vec<String>,
}

/// Where things lie in the bytes, format by format.
#[derive(Debug, Clone)]
enum Layout {
    Ply(ply::Layout),
    Obj,
    Stl(stl::Layout),
    Off(off::Layout),
    Xyz(xyz::Layout),
    Pcd(pcd::Layout),
}

/// The geometry for the analysis.
#[derive(Debug, Clone)]
struct Mesh {
    positions: Positions,
    triangles: Triangles,
}

#[derive(Debug, Clone)]
enum Positions {
    /// In the file's own bytes.
    InPlace {
        offset: usize,
        stride: usize,
        count: usize,
        single: bool,
    },
    Single(Vec<[f32; 3]>),
    Double(Vec<[f64; 3]>),
}

impl Positions {
    /// Of a text format, which does not say how precise it is: `single` if every number's digits
    /// survive in f32.
    fn from_text(points: Vec<[f64; 3]>, single: bool) -> Self {
        if single {
            Positions::Single(points.into_iter().map(|p| p.map(|x| x as f32)).collect())
        } else {
            Positions::Double(points)
        }
    }

    fn view<'a>(&'a self, bytes: &'a [u8]) -> VertexView<'a> {
        match self {
            &Positions::InPlace { offset, stride, count, single } => {
                // The parser has seen that all rows are there.
                let view = VertexView::from_bytes(&bytes[offset..], count, stride, single);
                view.unwrap_or_else(|| VertexView::from(&[][..] as &[[f64; 3]]))
            }
            Positions::Single(v) => v.as_slice().into(),
            Positions::Double(v) => v.as_slice().into(),
        }
    }
}

impl Mesh {
    fn cut_polygons(&mut self, bytes: &[u8]) {
        let positions = self.positions.view(bytes);
        self.triangles.cut_polygons(|v| positions.get(v as usize));
    }
}

impl Document {
    /// Reads a file. Its name's extension settles the format; without a known one, its content.
    pub fn read(path: &Path) -> Result<Document, IoError> {
        let fail = |source| IoError::Read { path: path.to_owned(), source };
        let bytes = std::fs::read(path).map_err(fail)?;
        let format = Format::from_path(path).or_else(|| Format::from_content(&bytes));
        let format = format.ok_or_else(|| IoError::UnknownFormat { path: path.to_owned() })?;
        Self::parse(bytes, format).map_err(|error| match error {
            IoError::Malformed { format, place, reason, .. } => {
                IoError::Malformed { file: Some(path.to_owned()), format, place, reason }
            }
            other => other,
        })
    }

    /// Takes a file's bytes. Reserves no more memory than the bytes justify, whatever counts they
    /// claim.
    pub fn parse(mut bytes: Vec<u8>, format: Format) -> Result<Document, IoError> {
        if format == Format::Pcd {
            bytes = pcd::unpack(bytes).map_err(|fault| fault.into_error(format))?;
        }
        let read = match format {
            Format::Ply => ply::read(&bytes).map(|(l, m)| (Layout::Ply(l), m)),
            Format::Obj => obj::read(&bytes).map(|m| (Layout::Obj, m)),
            Format::Stl => stl::read(&bytes).map(|(l, m)| (Layout::Stl(l), m)),
            Format::Off => off::read(&bytes).map(|(l, m)| (Layout::Off(l), m)),
            Format::Xyz => xyz::read(&bytes).map(|(l, m)| (Layout::Xyz(l), m)),
            Format::Pcd => pcd::read(&bytes).map(|(l, m)| (Layout::Pcd(l), m)),
        };
        let (layout, mesh) = read.map_err(|fault| fault.into_error(format))?;
        Ok(Document { bytes, layout, mesh, dropped: Vec::new() })
    }

    /// A binary PLY (little endian) of these positions, in mesh units, and triangles.
    pub fn from_mesh_f32(
        vertices: Vec<[f32; 3]>,
        faces: Vec<[u32; 3]>,
    ) -> Result<Document, IoError> {
        let bytes = ply::from_rows("float", &vertices, &faces, f32::to_le_bytes);
        drop((vertices, faces));
        Self::parse(bytes, Format::Ply)
    }

    /// The same with a colour for each vertex: red, green, blue, alpha.
    pub fn from_painted_mesh_f32(
        vertices: &[[f32; 3]],
        faces: &[[u32; 3]],
        colours: &[[u8; 4]],
    ) -> Result<Document, IoError> {
        if colours.len() != vertices.len() {
            let (n, m) = (colours.len(), vertices.len());
            return Err(IoError::Mismatch { reason: format!("{n} colours for {m} vertices") });
        }
        let corners = faces.iter().map(|f| &f[..]);
        let colours = Some(colours);
        let bytes = ply::from_polygons(vertices.into(), true, colours, faces.len(), 3, corners);
        Self::parse(bytes, Format::Ply)
    }

    /// The same in double precision.
    pub fn from_mesh_f64(
        vertices: Vec<[f64; 3]>,
        faces: Vec<[u32; 3]>,
    ) -> Result<Document, IoError> {
        let bytes = ply::from_rows("double", &vertices, &faces, f64::to_le_bytes);
        drop((vertices, faces));
        Self::parse(bytes, Format::Ply)
    }

    /// The format that [`Document::to_bytes`] gives.
    pub fn format(&self) -> Format {
        match self.layout {
            Layout::Ply(_) => Format::Ply,
            Layout::Obj => Format::Obj,
            Layout::Stl(_) => Format::Stl,
            Layout::Off(_) => Format::Off,
            Layout::Xyz(_) => Format::Xyz,
            Layout::Pcd(_) => Format::Pcd,
        }
    }

    /// The positions: f32 if the file holds no more than that, else f64. Binary coordinates may be
    /// NaN or infinite; the completion checks that.
    pub fn vertices(&self) -> VertexView<'_> {
        self.mesh.positions.view(&self.bytes)
    }

    /// The faces as triangles, in file order, every index in range. A polygon of n corners is cut
    /// into n - 2.
    pub fn faces(&self) -> FaceView<'_> {
        self.mesh.triangles.view()
    }

    /// Whether the file holds points alone.
    pub fn is_cloud(&self) -> bool {
        self.faces().is_empty() && !self.vertices().is_empty()
    }

    /// The normals of all vertices as the file has them, if it has any.
    pub fn vertex_normals(&self) -> Option<Vec<[f64; 3]>> {
        match &self.layout {
            Layout::Ply(layout) => layout.vertex_normals(&self.bytes),
            Layout::Xyz(layout) => layout.normals(&self.bytes),
            Layout::Pcd(layout) => layout.normals(&self.bytes),
            _ => None,
        }
    }

    /// Red, green, blue and alpha (0 to 255) of every vertex, if the file has colours.
    pub fn vertex_colours(&self) -> Option<Vec<[u8; 4]>> {
        match &self.layout {
            Layout::Ply(layout) => layout.vertex_colours(&self.bytes),
            Layout::Obj => obj::vertex_colours(&self.bytes),
            Layout::Stl(_) | Layout::Xyz(_) => None,
            Layout::Off(layout) => layout.vertex_colours(&self.bytes),
            Layout::Pcd(layout) => layout.colours(&self.bytes),
        }
    }

    /// The materials and texture coordinates of an OBJ file's faces; `None` if none has a material, and of
    /// other formats.
    pub fn materials(&self) -> Option<Materials> {
        match self.layout {
            Layout::Obj => mtl::materials(&self.bytes, &self.mesh),
            _ => None,
        }
    }

    /// The file's own faces, polygons as they are.
    fn each_face(&self, mut face: impl FnMut(&[u32])) -> error::Parsed<()> {
        match &self.layout {
            Layout::Ply(layout) => layout.each_face(&self.bytes, face),
            Layout::Obj => obj::each_face(&self.bytes, face),
            Layout::Stl(_) => {
                self.mesh.triangles.faces.iter().for_each(|f| face(f));
                Ok(())
            }
            Layout::Off(layout) => layout.each_face(&self.bytes, face),
            Layout::Xyz(_) | Layout::Pcd(_) => Ok(()),
        }
    }

    /// What the file holds besides positions, colours and faces.
    fn extras(&self) -> Vec<String> {
        match &self.layout {
            Layout::Ply(layout) => layout.extras(),
            Layout::Obj => obj::extra_statements(&self.bytes),
            Layout::Stl(layout) => layout.extras(&self.bytes),
            Layout::Off(layout) => layout.extras(&self.bytes),
            Layout::Xyz(layout) => layout.extras(),
            Layout::Pcd(layout) => layout.extras(),
        }
    }

    /// The same mesh in another format, which has to happen before it is completed: STL numbers
    /// the vertices anew. Positions, vertex colours (as 8 bits a channel) and faces are kept;
    /// [`Document::dropped`] of the result lists the rest. In its own format, a plain copy.
    pub fn convert(&self, format: Format) -> Result<Document, IoError> {
        if format == self.format() {
            return Ok(self.clone());
        }
        let (bytes, mut dropped) = convert::convert(self, format)?;
        let mut document = Self::parse(bytes, format)?;
        document.dropped.append(&mut self.dropped.clone());
        document.dropped.append(&mut dropped);
        Ok(document)
    }

    /// What [`Document::convert`] had to leave behind, for the user to read; empty if nothing.
    pub fn dropped(&self) -> &[String] {
        &self.dropped
    }

    /// Adds a completion of [`Document::vertices`] and [`Document::faces`], each new element with
    /// all that the file's elements carry. Colours and other quantities are copied from where the shape
    /// was copied from (`docs/appearance.md`), harmonic from the rim where it was not; labels are those
    /// of the nearest vertex of the rim; normals are the fill's own; faces take after the nearest input
    /// face.
    ///
    /// Errors: [`IoError::Mismatch`] if the completion is another mesh's,
    /// [`IoError::Unsupported`] if the file's layout has no place for it.
    pub fn append(&mut self, completion: &Completion, extras: &Extras) -> Result<(), IoError> {
        self.append_with(completion, extras, None)
    }

    /// The same with the exemplar that the completion copied from: its colours are copied, too.
    pub fn append_with(
        &mut self,
        completion: &Completion,
        extras: &Extras,
        exemplar: Option<&Document>,
    ) -> Result<(), IoError> {
        self.check(completion)?;
        if completion.faces.is_empty() && completion.vertices.is_empty() && !extras.provenance {
            return Ok(());
        }
        let (bytes, mesh) = (&self.bytes, &self.mesh);
        let faces = mesh.triangles.view();
        let patch = || attributes::Patch::with_sources(completion, faces, exemplar);
        let edits = match &self.layout {
            Layout::Ply(layout) => ply::append(layout, bytes, mesh, patch(), extras),
            _ if extras.provenance => {
                let what = "it has no place for the columns of provenance; write PLY".into();
                Err(IoError::Unsupported { format: self.format(), what })
            }
            Layout::Obj => obj::append(bytes, mesh, completion, &patch()),
            Layout::Stl(layout) => stl::append(layout, bytes, mesh, completion),
            Layout::Off(layout) => off::append(layout, bytes, mesh, completion, &patch()),
            Layout::Xyz(_) | Layout::Pcd(_) => {
                let what = "it has no place for faces; write PLY".into();
                Err(IoError::Unsupported { format: self.format(), what })
            }
        }?;
        self.change(edits)
    }

    /// Adds new points to a cloud, each with all that the file's points carry; see
    /// [`Document::append`]. With `extras.provenance` the columns are those listed at
    /// [`Extras::provenance`], but for the three of the source face, in whose place stands
    /// `source_point` (int): the input point that the detail was copied from.
    ///
    /// Errors: as of [`Document::append`]; PLY, XYZ and PCD can hold new points, PLY alone their
    /// provenance.
    pub fn append_points(
        &mut self,
        made: &PointCompletion,
        extras: &Extras,
    ) -> Result<(), IoError> {
        self.append_points_with(made, extras, None)
    }

    /// The same with the exemplar that was copied from: its colours are copied, too.
    pub fn append_points_with(
        &mut self,
        made: &PointCompletion,
        extras: &Extras,
        exemplar: Option<&Document>,
    ) -> Result<(), IoError> {
        self.check(&made.completion)?;
        if made.completion.vertices.is_empty() && !extras.provenance {
            return Ok(());
        }
        let (bytes, mesh) = (&self.bytes, &self.mesh);
        let unsupported =
            |what: &str| Err(IoError::Unsupported { format: self.format(), what: what.into() });
        let completion = made.on_mesh();
        let faces = (&made.copied.faces[..]).into();
        let patch = attributes::Patch::with_sources(&completion, faces, exemplar);
        let edits = match &self.layout {
            Layout::Ply(layout) => {
                ply::append_points(layout, bytes, mesh, &made.source_points, patch, extras)
            }
            _ if extras.provenance => {
                unsupported("it has no place for the columns of provenance; write PLY")
            }
            Layout::Xyz(layout) => Ok(xyz::append(layout, bytes, mesh, made, &patch)),
            Layout::Pcd(layout) => Ok(pcd::append(layout, bytes, made, &patch)),
            _ => unsupported("new points cannot be added to it; write PLY, XYZ or PCD"),
        }?;
        self.change(edits)
    }

    /// The same file with something written into it, read anew: what was appended is valid.
    fn change(&mut self, edits: Vec<edit::Edit>) -> Result<(), IoError> {
        let (format, dropped) = (self.format(), std::mem::take(&mut self.dropped));
        // Not two face lists at a time.
        self.mesh.triangles = Triangles::default();
        edit::splice(&mut self.bytes, edits);
        *self = Self::parse(std::mem::take(&mut self.bytes), format)?;
        self.dropped = dropped;
        Ok(())
    }

    fn check(&self, completion: &Completion) -> Result<(), IoError> {
        let counts = [self.vertices().len(), self.faces().len()];
        let expected = [completion.input_vertex_count, completion.input_face_count];
        let mismatch = |reason: String| Err(IoError::Mismatch { reason });
        if counts != expected {
            let [[v, f], [ev, ef]] = [counts, expected];
            return mismatch(format!(
                "it was made from {ev} vertices and {ef} faces, but there are {v} and {f}"
            ));
        }
        let total = counts[0] + completion.vertices.len();
        if u32::try_from(total).is_err()
            || completion.vertex_hole.len() != completion.vertices.len()
            || completion.origins.len() != completion.vertices.len()
        {
            return mismatch(format!("its arrays do not fit {total} vertices"));
        }
        let single = self.vertices().is_single();
        let finite = |x: &f64| if single { (*x as f32).is_finite() } else { x.is_finite() };
        if let Some(v) = completion.vertices.iter().position(|p| !p.iter().all(finite)) {
            return mismatch(format!("its vertex {v} is not finite"));
        }
        if completion.holes.iter().any(|h| h.ring.iter().any(|s| s.vertex as usize >= counts[0])) {
            return mismatch("its ring names a vertex that there is not".into());
        }
        match completion.faces.iter().position(|f| f.iter().any(|&v| v as usize >= total)) {
            Some(f) => mismatch(format!("its face {f} names a vertex beyond {total}")),
            None => Ok(()),
        }
    }

    /// Writes the document in its own format: aside, in the same folder, then renamed, so that
    /// there is never half a file. See [`Document::convert`] for another format.
    pub fn write(&self, path: &Path) -> Result<(), IoError> {
        edit::save(path, &self.bytes)
    }

    /// The file's content, without a copy.
    pub fn as_bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// The file's content.
    pub fn to_bytes(&self) -> Vec<u8> {
        self.bytes.clone()
    }
}

//! A document in another format: what can be kept is kept, what is left behind is listed.

use super::error::{Fault, IoError};
use super::text::push_real;
use super::{ply, stl, Document, Format};
use crate::mesh::VertexView;

/// What every format can hold.
struct Content<'a> {
    vertices: VertexView<'a>,
    colours: Option<Vec<[u8; 4]>>,
    /// Corners of all faces, and where each face's end.
    corners: Vec<u32>,
    ends: Vec<usize>,
}

impl Content<'_> {
    fn faces(&self) -> impl Iterator<Item = &[u32]> {
        let starts = std::iter::once(0).chain(self.ends.iter().copied());
        starts.zip(&self.ends).map(|(a, &b)| &self.corners[a..b])
    }
}

/// The file's bytes in `format`, and what is not in them.
pub(super) fn convert(d: &Document, format: Format) -> Result<(Vec<u8>, Vec<String>), IoError> {
    let mut content = Content {
        vertices: d.vertices(),
        colours: d.vertex_colours(),
        corners: Vec::new(),
        ends: Vec::new(),
    };
    let (corners, ends) = (&mut content.corners, &mut content.ends);
    d.each_face(|face| {
        corners.extend_from_slice(face);
        ends.push(corners.len());
    })
    .map_err(|f: Fault| f.into_error(d.format()))?;
    let mut dropped = d.extras();
    let bytes = match format {
        Format::Ply => to_ply(&content),
        Format::Obj => to_obj(&content),
        Format::Off => to_off(&content),
        Format::Xyz if content.ends.is_empty() => {
            if content.colours.is_some() {
                dropped.push("the vertices' colours".to_owned());
            }
            to_xyz(&content)
        }
        Format::Xyz | Format::Pcd => {
            let what = "meshes are not written as it, and clouds only from their own format".into();
            return Err(IoError::Unsupported { format, what });
        }
        Format::Stl => {
            let notes = [
                (content.colours.is_some(), "the vertices' colours"),
                (!content.vertices.is_single(), "digits beyond f32"),
                (content.ends.len() != d.faces().len(), "polygons (cut into triangles)"),
                (true, "the numbering of the vertices"),
            ];
            dropped.extend(notes.iter().filter(|n| n.0).map(|n| n.1.to_owned()));
            to_stl(d)?
        }
    };
    Ok((bytes, dropped))
}

fn to_ply(content: &Content<'_>) -> Vec<u8> {
    let single = content.vertices.is_single();
    let largest = content.faces().map(<[u32]>::len).max().unwrap_or(0);
    ply::from_polygons(
        content.vertices,
        single,
        content.colours.as_deref(),
        content.ends.len(),
        largest,
        content.faces(),
    )
}

fn push_point(out: &mut Vec<u8>, vertices: VertexView<'_>, i: usize) {
    for (axis, x) in vertices.get(i).into_iter().enumerate() {
        if axis > 0 {
            out.push(b' ');
        }
        push_real(out, x, vertices.is_single());
    }
}

fn to_xyz(content: &Content<'_>) -> Vec<u8> {
    let mut out = Vec::new();
    for i in 0..content.vertices.len() {
        push_point(&mut out, content.vertices, i);
        out.push(b'\n');
    }
    out
}

fn to_obj(content: &Content<'_>) -> Vec<u8> {
    let mut out = Vec::new();
    for i in 0..content.vertices.len() {
        out.extend_from_slice(b"v ");
        push_point(&mut out, content.vertices, i);
        if let Some(colours) = &content.colours {
            for channel in &colours[i][..3] {
                out.push(b' ');
                push_real(&mut out, f64::from(*channel) / 255.0, true);
            }
        }
        out.push(b'\n');
    }
    for face in content.faces() {
        out.push(b'f');
        face.iter().for_each(|&v| out.extend(format!(" {}", u64::from(v) + 1).into_bytes()));
        out.push(b'\n');
    }
    out
}

fn to_off(content: &Content<'_>) -> Vec<u8> {
    let keyword = if content.colours.is_some() { "COFF" } else { "OFF" };
    let head = format!("{keyword}\n{} {} 0\n", content.vertices.len(), content.ends.len());
    let mut out = head.into_bytes();
    for i in 0..content.vertices.len() {
        push_point(&mut out, content.vertices, i);
        if let Some(colours) = &content.colours {
            colours[i].iter().for_each(|c| out.extend(format!(" {c}").into_bytes()));
        }
        out.push(b'\n');
    }
    for face in content.faces() {
        out.extend(face.len().to_string().into_bytes());
        face.iter().for_each(|&v| out.extend(format!(" {v}").into_bytes()));
        out.push(b'\n');
    }
    out
}

fn to_stl(d: &Document) -> Result<Vec<u8>, IoError> {
    let (vertices, faces) = (d.vertices(), d.faces());
    let Ok(count) = u32::try_from(faces.len()) else {
        let what = format!("{} triangles are more than its count can hold", faces.len());
        return Err(IoError::Unsupported { format: Format::Stl, what });
    };
    let corner = |v: u32| vertices.get(v as usize).map(|x| x as f32);
    Ok(stl::from_triangles(count, (0..faces.len()).map(|f| faces.get(f).map(corner))))
}

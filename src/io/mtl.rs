//! Materials of an OBJ file: which faces have which, and what a material library (MTL) says of them.

use super::obj::{keyword, statements};
use super::obj_texture::Texture;
use super::text::{parse, words, Lines};
use super::Mesh;
use crate::result::NONE;
use std::collections::HashMap;

/// What an OBJ file says of its faces' materials and texture coordinates.
#[derive(Debug, Clone, PartialEq)]
pub struct Materials {
    /// What stands in the `mtllib` lines. Such a line names one file, or several, parted by spaces.
    pub libraries: Vec<String>,
    /// The names of `usemtl` lines, each once.
    pub names: Vec<String>,
    /// For each triangle of [`super::Document::faces`] the index of its material's name; `u32::MAX` without.
    pub of_face: Vec<u32>,
    /// For each triangle the texture coordinates of its corners, if all of them have some.
    pub coordinates: Vec<Option<[[f64; 2]; 3]>>,
}

/// One material of a library.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// After `newmtl`.
    pub name: String,
    /// The diffuse colour, `Kd`: red, green and blue from 0 to 1.
    pub colour: Option<[f64; 3]>,
    /// The file of the diffuse colour's image, `map_Kd`, as it is written: beside the library.
    pub image: Option<String>,
    /// How often the image repeats along u and v (`-s`), and where it begins (`-o`): it is read at
    /// scale · (u, v) + offset. Other options of the line are left away.
    pub scale: [f64; 2],
    /// See `scale`.
    pub offset: [f64; 2],
}

impl Material {
    /// The materials of an MTL file's content; what cannot be understood is passed over.
    pub fn read_library(bytes: &[u8]) -> Vec<Material> {
        let mut all: Vec<Material> = Vec::new();
        for line in Lines::new(bytes) {
            let word = keyword(line.text).to_ascii_lowercase();
            match (&word[..], all.last_mut()) {
                (b"newmtl", _) => {
                    let name = rest(line.text);
                    let (colour, image, scale, offset) = (None, None, [1.0; 2], [0.0; 2]);
                    all.push(Material { name, colour, image, scale, offset });
                }
                (b"kd", Some(material)) => {
                    let numbers: Vec<f64> =
                        words(line.text).skip(1).map_while(parse).take(3).collect();
                    if let [r, g, b] = numbers[..] {
                        material.colour = Some([r, g, b].map(|x| x.clamp(0.0, 1.0)));
                    }
                }
                (b"map_kd", Some(material)) => read_image(line.text, material),
                _ => {}
            }
        }
        all
    }
}

/// All after the keyword, which may have spaces inside.
fn rest(text: &[u8]) -> String {
    let text = text.trim_ascii();
    let end = text.iter().position(u8::is_ascii_whitespace).unwrap_or(text.len());
    String::from_utf8_lossy(text[end..].trim_ascii()).into_owned()
}

/// The file in a map's line, which follows its options and their arguments, and what these say of its place.
fn read_image(text: &[u8], material: &mut Material) {
    let line = rest(text);
    let mut left = &line[..];
    (material.scale, material.offset) = ([1.0; 2], [0.0; 2]);
    while left.starts_with('-') {
        let (option, mut after) = next_word(left);
        let (least, most) = match option {
            "-o" | "-s" | "-t" => (1, 3),
            "-mm" => (2, 2),
            "-blendu" | "-blendv" | "-cc" | "-clamp" | "-bm" | "-boost" | "-texres" | "-type"
            | "-imfchan" => (1, 1),
            _ => break,
        };
        for i in 0..most {
            let (word, further) = next_word(after);
            let number = word.parse::<f64>().ok();
            // Of two or three numbers the last ones may be left out.
            if i >= least && number.is_none() {
                break;
            }
            let placed = match option {
                "-s" => material.scale.get_mut(i),
                "-o" => material.offset.get_mut(i),
                _ => None,
            };
            if let (Some(placed), Some(x)) = (placed, number.filter(|x| x.is_finite())) {
                *placed = x;
            }
            after = further;
        }
        left = after;
    }
    material.image = Some(left.into());
}

fn next_word(text: &str) -> (&str, &str) {
    let end = text.find(char::is_whitespace).unwrap_or(text.len());
    (&text[..end], text[end..].trim_start())
}

/// Of an OBJ file; `None` if no face has a material.
pub(super) fn materials(bytes: &[u8], mesh: &Mesh) -> Option<Materials> {
    let (mut libraries, mut names) = (Vec::new(), Vec::new());
    let (mut of_file_face, mut current) = (Vec::new(), NONE);
    let mut known = HashMap::new();
    for line in statements(bytes) {
        match keyword(line.text) {
            b"mtllib" => libraries.push(rest(line.text)),
            b"usemtl" => {
                let name = rest(line.text);
                current = *known.entry(name.clone()).or_insert_with(|| {
                    names.push(name);
                    names.len() as u32 - 1
                });
            }
            b"f" => of_file_face.push(current),
            _ => {}
        }
    }
    if names.is_empty() {
        return None;
    }
    let triangles = mesh.triangles.faces.len();
    let of_face = (0..triangles).map(|t| of_file_face[mesh.triangles.face_of(t)]).collect();
    let texture = Texture::read(bytes);
    let coordinates =
        (0..triangles as u32).map(|t| texture.as_ref()?.coordinates(t, mesh)).collect();
    Some(Materials { libraries, names, of_face, coordinates })
}

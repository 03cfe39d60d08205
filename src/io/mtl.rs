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
    /// The file of the diffuse colour's image, `map_Kd`, as it is written: beside the library. Options of
    /// the line are left away.
    pub image: Option<String>,
}

impl Material {
    /// The materials of an MTL file's content; what cannot be understood is passed over.
    pub fn read_library(bytes: &[u8]) -> Vec<Material> {
        let mut all: Vec<Material> = Vec::new();
        for line in Lines::new(bytes) {
            let word = keyword(line.text).to_ascii_lowercase();
            match (&word[..], all.last_mut()) {
                (b"newmtl", _) => {
                    all.push(Material { name: rest(line.text), colour: None, image: None });
                }
                (b"kd", Some(material)) => {
                    let numbers: Vec<f64> =
                        words(line.text).skip(1).map_while(parse).take(3).collect();
                    if let [r, g, b] = numbers[..] {
                        material.colour = Some([r, g, b].map(|x| x.clamp(0.0, 1.0)));
                    }
                }
                (b"map_kd", Some(material)) => material.image = Some(image_name(line.text)),
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

/// The file's name in a map's line: what follows its options and their arguments.
fn image_name(text: &[u8]) -> String {
    let line = rest(text);
    let mut left = &line[..];
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
            // Of two or three numbers the last ones may be left out.
            if i >= least && word.parse::<f64>().is_err() {
                break;
            }
            after = further;
        }
        left = after;
    }
    left.into()
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

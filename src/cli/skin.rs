//! What an OBJ file's faces wear in the picture: the images and colours of its material libraries.

use super::report::{Element, Warning, LISTED};
use crate::io::{Document, Material};
use crate::picture::{Image, Paint, Skin, Texture};
use crate::result::NONE;
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// What one material is drawn with.
#[derive(Clone, Copy)]
enum Drawn {
    Plain,
    Colour([u8; 3]),
    /// With scale and offset of the coordinates.
    Image(usize, [[f64; 2]; 2]),
}

/// The materials that an OBJ file uses, with their images, read once.
#[derive(Default)]
pub(super) struct Wardrobe {
    /// By name.
    materials: HashMap<String, Drawn>,
    textures: Vec<Texture>,
    /// Files that cannot be read, and why.
    missing: Vec<String>,
}

impl Wardrobe {
    /// Of the document's libraries, which lie in `folder`, its own.
    pub fn open(document: &Document, folder: &Path) -> Self {
        let mut wardrobe = Self::default();
        let Some(used) = document.materials() else { return wardrobe };
        let mut images = HashMap::new();
        for line in &used.libraries {
            for path in libraries(line, folder) {
                let bytes = match std::fs::read(&path) {
                    Ok(bytes) => bytes,
                    Err(error) => {
                        wardrobe.missing.push(format!("{}: {error}", path.display()));
                        continue;
                    }
                };
                for material in Material::read_library(&bytes) {
                    if used.names.contains(&material.name) {
                        let beside = path.parent().unwrap_or(folder);
                        let drawn = wardrobe.drawn(&material, beside, &mut images);
                        wardrobe.materials.entry(material.name).or_insert(drawn);
                    }
                }
            }
        }
        wardrobe
    }

    fn drawn(
        &mut self,
        material: &Material,
        folder: &Path,
        images: &mut HashMap<PathBuf, Option<usize>>,
    ) -> Drawn {
        let Some(name) = &material.image else {
            let bytes = |c: [f64; 3]| Drawn::Colour(c.map(|x| (255.0 * x).round() as u8));
            return material.colour.map_or(Drawn::Plain, bytes);
        };
        // Written on Windows.
        let path = folder.join(name.replace('\\', "/"));
        let at = *images.entry(path.clone()).or_insert_with(|| {
            let image = std::fs::read(&path).and_then(|bytes| Image::decode(&bytes));
            match image.map(Texture::new) {
                Ok(texture) => {
                    self.textures.push(texture?);
                    Some(self.textures.len() - 1)
                }
                Err(error) => {
                    self.missing.push(format!("{}: {error}", path.display()));
                    None
                }
            }
        });
        let placed = [material.scale, material.offset];
        at.map_or(Drawn::Plain, |image| Drawn::Image(image, placed))
    }

    /// What the faces of the document, or of its completion, wear, and what is missing for it.
    pub fn dress(&self, document: &Document) -> (Option<Skin<'_>>, Vec<Warning>) {
        let mut warnings = Vec::new();
        if let Some(first) = self.missing.first() {
            let count = self.missing.len();
            warnings.push(Warning {
                kind: "textures-unread",
                message: format!(
                    "{count} material libraries or images cannot be read; the picture shows plain colours \
                     in their place (the first: {first})"
                ),
                count,
                elements: self.missing.iter().take(LISTED).cloned().map(Element::Text).collect(),
            });
        }
        let Some(used) = document.materials().filter(|_| !self.materials.is_empty()) else {
            return (None, warnings);
        };
        let drawn: Vec<Drawn> = used
            .names
            .iter()
            .map(|name| self.materials.get(name).copied().unwrap_or(Drawn::Plain))
            .collect();
        let mut bare = Vec::new();
        let paint = |(f, &material): (usize, &u32)| {
            let drawn = if material == NONE { Drawn::Plain } else { drawn[material as usize] };
            match (drawn, used.coordinates[f]) {
                (Drawn::Plain, _) => Paint::None,
                (Drawn::Colour(colour), _) => Paint::Colour(colour),
                (Drawn::Image(image, [scale, offset]), Some(corners)) => {
                    let place = |uv: [f64; 2]| [0, 1].map(|k| scale[k] * uv[k] + offset[k]);
                    Paint::Image { image, corners: corners.map(place) }
                }
                (Drawn::Image(..), None) => {
                    bare.push(f as u32);
                    Paint::None
                }
            }
        };
        let paints = used.of_face.iter().enumerate().map(paint).collect();
        if let Some(first) = bare.first() {
            warnings.push(Warning {
                kind: "texture-coordinates-missing",
                message: format!(
                    "{} faces have an image but no texture coordinates; the picture shows them plain (the \
                     first: {first})",
                    bare.len()
                ),
                count: bare.len(),
                elements: bare.iter().take(LISTED).map(|&f| Element::Face(f)).collect(),
            });
        }
        (Some(Skin { textures: &self.textures, paints }), warnings)
    }
}

/// The files that a `mtllib` line names: one whose name has spaces, or several.
fn libraries(line: &str, folder: &Path) -> Vec<PathBuf> {
    let parts: Vec<PathBuf> = line.split_whitespace().map(|name| folder.join(name)).collect();
    let whole = folder.join(line);
    if whole.is_file() || !parts.iter().any(|path| path.is_file()) {
        return vec![whole];
    }
    parts
}

//! What is painted on faces: images by texture coordinates, and plain colours.
//!
//! Images are averaged to half their size again and again (Williams 1983, "Pyramidal parametrics"); a face
//! is drawn from the level whose texels are about as large as its samples, bilinear. In linear light.

use super::raster::{from_srgb, to_srgb};
use super::Image;
use std::sync::LazyLock;

/// [`from_srgb`] of each byte.
static LINEAR: LazyLock<[f64; 256]> = LazyLock::new(|| std::array::from_fn(|i| from_srgb(i as u8)));

/// A texture image with its smaller versions, the whole one first.
#[derive(Debug, Clone)]
pub struct Texture(Vec<Image>);

impl Texture {
    /// Of an image of at least one pixel; `None` without any.
    pub fn new(image: Image) -> Option<Self> {
        if image.pixels.is_empty() || image.pixels.len() != image.width * image.height {
            return None;
        }
        let mut levels = vec![image];
        while let Some(half) = levels.last().and_then(halved) {
            levels.push(half);
        }
        Some(Self(levels))
    }

    /// The linear colour at texture coordinates (0, 0 is the lower left corner, the image repeats), for
    /// samples that are so many texels apart.
    fn colour(&self, [u, v]: [f64; 2], texels: f64) -> [f64; 3] {
        let level = texels.max(1.0).log2().round() as usize;
        let image = &self.0[level.min(self.0.len() - 1)];
        let (width, height) = (image.width, image.height);
        // The share of the image: also where the coordinates count its repetitions.
        let at = [u - u.floor(), 1.0 - (v - v.floor())];
        let at = [at[0] * width as f64 - 0.5, at[1] * height as f64 - 0.5];
        let (x, y) = (at[0].floor(), at[1].floor());
        let (s, t) = (at[0] - x, at[1] - y);
        let texel = |dx: i64, dy: i64| {
            let column = (x as i64 + dx).rem_euclid(width as i64) as usize;
            let row = (y as i64 + dy).rem_euclid(height as i64) as usize;
            image.pixels[row * width + column].map(|c| LINEAR[c as usize])
        };
        let [a, b, c, d] = [texel(0, 0), texel(1, 0), texel(0, 1), texel(1, 1)];
        [0, 1, 2]
            .map(|k| (1.0 - t) * ((1.0 - s) * a[k] + s * b[k]) + t * ((1.0 - s) * c[k] + s * d[k]))
    }
}

/// An image of half the size, rounded up; `None` of a single pixel.
fn halved(image: &Image) -> Option<Image> {
    let (w, h) = (image.width, image.height);
    if w * h == 1 {
        return None;
    }
    let mut half = Image::new(w.div_ceil(2), h.div_ceil(2), [0; 3]);
    for y in 0..half.height {
        for x in 0..half.width {
            let (right, below) = ((2 * x + 1).min(w - 1), (2 * y + 1).min(h - 1));
            let four = [(2 * x, 2 * y), (right, 2 * y), (2 * x, below), (right, below)]
                .map(|(x, y)| image.pixels[y * w + x]);
            half.pixels[y * half.width + x] = [0, 1, 2]
                .map(|k| to_srgb(four.iter().map(|p| LINEAR[p[k] as usize]).sum::<f64>() / 4.0));
        }
    }
    Some(half)
}

/// What one face wears.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Paint {
    /// The vertices' colours, or clay.
    None,
    /// One colour.
    Colour([u8; 3]),
    /// A part of an image.
    Image {
        /// Which.
        image: usize,
        /// Texture coordinates of the three corners, finite.
        corners: [[f64; 2]; 3],
    },
}

/// What the faces of a shape wear.
#[derive(Debug, Clone)]
pub struct Skin<'a> {
    /// The images that paints name.
    pub textures: &'a [Texture],
    /// One for each face, or more.
    pub paints: Vec<Paint>,
}

impl Skin<'_> {
    /// The linear colour of a face at some weights of its corners; `None` where it has none of its own.
    /// `area` is the face's area in the picture, in samples.
    pub(super) fn colour(&self, face: usize, weights: [f64; 3], area: f64) -> Option<[f64; 3]> {
        match *self.paints.get(face)? {
            Paint::None => None,
            Paint::Colour(colour) => Some(colour.map(from_srgb)),
            Paint::Image { image, corners } => {
                let texture = self.textures.get(image)?;
                let at = [0, 1].map(|d| (0..3).map(|k| weights[k] * corners[k][d]).sum());
                let [a, b, c] = corners;
                let part = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
                let texels = 0.5 * part.abs() * texture.0[0].pixels.len() as f64;
                Some(texture.colour(at, (texels / area).sqrt()))
            }
        }
    }
}

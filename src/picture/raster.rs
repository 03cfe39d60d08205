//! The z-buffer and the shading.

use super::{cross, dot, length, sub, Camera, Image, Skin};
use crate::mesh::MeshView;
use rayon::prelude::*;

/// What is drawn.
#[derive(Clone, Copy)]
pub struct Shape<'a> {
    /// The triangles.
    pub mesh: MeshView<'a>,
    /// Colours of the vertices, if they have any; must be as many.
    pub colours: Option<&'a [[u8; 3]]>,
    /// Colours that are laid over faces, if any; must be as many as the faces or more.
    pub tints: Option<&'a [Option<[u8; 3]>]>,
    /// Textures and materials of the faces, if any: they are drawn in place of the vertices' colours.
    pub skin: Option<&'a Skin<'a>>,
}

impl<'a> Shape<'a> {
    /// Of clay.
    pub fn plain(mesh: MeshView<'a>) -> Self {
        Self { mesh, colours: None, tints: None, skin: None }
    }
}

/// Share of a tint in the colour of a face: the shape and its own colours still show.
const TINT: f64 = 0.72;

/// Light clay, in linear light.
const CLAY: [f64; 3] = [0.62, 0.53, 0.42];
/// The inside of the surface: a dull slate, told apart from clay in shadow also without colour.
const INSIDE: [f64; 3] = [0.10, 0.15, 0.20];
/// Samples a pixel, each way.
const SAMPLES: usize = 2;
/// No face is seen here.
const NOTHING: u32 = u32::MAX;
/// Rows of samples that one task draws: small enough to share, large enough to be worth it.
const BAND: usize = 64;

/// A shape with its normals, ready for many views.
pub(super) struct Prepared<'a> {
    shape: Shape<'a>,
    normals: Vec<[f64; 3]>,
}

/// A vertex as a view sees it; `None` before the near plane.
type Seen = Option<[f64; 3]>;

impl<'a> Prepared<'a> {
    /// Smooth vertex normals, weighted by the corners' angles.
    pub fn new(shape: &Shape<'a>) -> Self {
        let mesh = shape.mesh;
        let mut normals = vec![[0.0; 3]; mesh.vertices.len()];
        for f in 0..mesh.faces.len() {
            let face = mesh.faces.get(f);
            let p = face.map(|v| mesh.vertices.get(v as usize));
            let n = cross(sub(p[1], p[0]), sub(p[2], p[0]));
            let size = length(n);
            if size == 0.0 || !size.is_finite() {
                continue;
            }
            for k in 0..3 {
                let (a, b) = (sub(p[(k + 1) % 3], p[k]), sub(p[(k + 2) % 3], p[k]));
                let angle = size.atan2(dot(a, b));
                let sum = &mut normals[face[k] as usize];
                for x in 0..3 {
                    sum[x] += n[x] / size * angle;
                }
            }
        }
        Self { shape: *shape, normals }
    }

    /// What is drawn.
    pub fn mesh(&self) -> MeshView<'a> {
        self.shape.mesh
    }

    /// How many of some points on the surface are seen, to the precision of a small picture.
    pub fn count_visible(&self, camera: &Camera, points: &[[f64; 3]]) -> usize {
        const SIZE: [usize; 2] = [96, 80];
        let vertices = self.shape.mesh.vertices;
        let seen: Vec<Seen> = (0..vertices.len())
            .into_par_iter()
            .map(|v| camera.project(vertices.get(v), SIZE))
            .collect();
        let mut nearness = Vec::with_capacity(SIZE[0] * SIZE[1]);
        for (i, faces) in self.sort_into_bands(&seen, SIZE).iter().enumerate() {
            let rows = i * BAND..((i + 1) * BAND).min(SIZE[1]);
            nearness.extend(self.cover(&seen, faces, rows, SIZE[0]).1);
        }
        let visible = |p: &[f64; 3]| {
            let Some([x, y, depth]) = camera.project(*p, SIZE) else { return false };
            let (column, row) = (x as usize, y as usize);
            // 1 %: three pixels of depth on a surface seen from 45 degrees.
            x >= 0.0
                && y >= 0.0
                && column < SIZE[0]
                && row < SIZE[1]
                && nearness[row * SIZE[0] + column] * depth < 1.01
        };
        points.iter().filter(|p| visible(p)).count()
    }

    /// One view.
    pub fn draw(&self, camera: &Camera, size: [usize; 2]) -> Image {
        let fine = [size[0] * SAMPLES, size[1] * SAMPLES];
        let vertices = self.shape.mesh.vertices;
        let seen: Vec<Seen> = (0..vertices.len())
            .into_par_iter()
            .map(|v| camera.project(vertices.get(v), fine))
            .collect();
        let by_band = self.sort_into_bands(&seen, fine);
        let bands: Vec<Vec<[u8; 3]>> = by_band
            .par_iter()
            .enumerate()
            .map(|(i, faces)| {
                let rows = i * BAND..((i + 1) * BAND).min(fine[1]);
                let (top, _) = self.cover(&seen, faces, rows.clone(), fine[0]);
                self.shade_band(camera, &seen, &top, rows, fine)
            })
            .collect();
        Image { width: size[0], height: size[1], pixels: bands.concat() }
    }

    /// The faces that reach into each band of rows.
    fn sort_into_bands(&self, seen: &[Seen], fine: [usize; 2]) -> Vec<Vec<u32>> {
        let mut bands = vec![Vec::new(); fine[1].div_ceil(BAND)];
        for f in 0..self.shape.mesh.faces.len() {
            let Some(p) = corners(self.shape.mesh.faces.get(f), seen) else { continue };
            let [x, y] = [0, 1].map(|k| {
                let c = p.map(|q| q[k]);
                [c[0].min(c[1]).min(c[2]), c[0].max(c[1]).max(c[2])]
            });
            if x[1] < 0.0 || y[1] < 0.0 || x[0] > fine[0] as f64 || y[0] > fine[1] as f64 {
                continue;
            }
            let last = (y[1] as usize).min(fine[1] - 1) / BAND;
            for band in &mut bands[y[0].max(0.0) as usize / BAND..=last] {
                band.push(f as u32);
            }
        }
        bands
    }

    /// The nearest face at each sample of some rows, and 1/depth there. Equal depths: the lower index.
    fn cover(
        &self,
        seen: &[Seen],
        faces: &[u32],
        rows: std::ops::Range<usize>,
        width: usize,
    ) -> (Vec<u32>, Vec<f64>) {
        let mut top = vec![NOTHING; rows.len() * width];
        let mut nearness = vec![0.0f64; top.len()];
        for &f in faces {
            let Some(p) = corners(self.shape.mesh.faces.get(f as usize), seen) else { continue };
            let Some(plane) = Plane::of(&p) else { continue };
            let y0 = p.iter().map(|q| q[1]).fold(f64::INFINITY, f64::min);
            let y1 = p.iter().map(|q| q[1]).fold(f64::NEG_INFINITY, f64::max);
            let first = rows.start.max((y0 - 0.5).ceil().max(0.0) as usize);
            let last = rows.end.min((y1 + 0.5).max(0.0) as usize);
            for y in first..last {
                let Some((from, to)) = span(&p, y as f64 + 0.5, width) else { continue };
                for x in from..to {
                    let near = plane.at(x as f64 + 0.5, y as f64 + 0.5);
                    let i = (y - rows.start) * width + x;
                    if near > nearness[i] {
                        nearness[i] = near;
                        top[i] = f;
                    }
                }
            }
        }
        (top, nearness)
    }

    /// Colours the samples of some rows and averages them into pixels.
    fn shade_band(
        &self,
        camera: &Camera,
        seen: &[Seen],
        top: &[u32],
        rows: std::ops::Range<usize>,
        fine: [usize; 2],
    ) -> Vec<[u8; 3]> {
        let width = fine[0] / SAMPLES;
        let share = 1.0 / (SAMPLES * SAMPLES) as f64;
        let mut pixels = Vec::with_capacity(rows.len() / SAMPLES * width);
        for y in (0..rows.len()).step_by(SAMPLES) {
            let ground = background((rows.start + y) as f64 / fine[1] as f64);
            for x in 0..width {
                let mut sum = [0.0; 3];
                for s in 0..SAMPLES * SAMPLES {
                    let (sx, sy) = (x * SAMPLES + s % SAMPLES, y + s / SAMPLES);
                    let face = top[sy * fine[0] + sx];
                    let at = [sx as f64 + 0.5, (rows.start + sy) as f64 + 0.5];
                    let colour = match face {
                        NOTHING => ground,
                        f => self.shade(camera, seen, f as usize, at, fine),
                    };
                    for k in 0..3 {
                        sum[k] += colour[k] * share;
                    }
                }
                pixels.push(sum.map(to_srgb));
            }
        }
        pixels
    }

    /// The light that one sample of a face sends to the eye, linear.
    fn shade(
        &self,
        camera: &Camera,
        seen: &[Seen],
        f: usize,
        at: [f64; 2],
        fine: [usize; 2],
    ) -> [f64; 3] {
        let face = self.shape.mesh.faces.get(f);
        let Some(p) = corners(face, seen) else { return [0.0; 3] };
        let weights = weights(&p, at);
        let mix = |of: &dyn Fn(usize) -> [f64; 3]| -> [f64; 3] {
            let c = face.map(|v| of(v as usize));
            std::array::from_fn(|k| (0..3).map(|i| weights[i] * c[i][k]).sum())
        };
        let normal = camera.turn(mix(&|v| unit(self.normals[v])));
        let eye = camera.sight(at[0], at[1], fine);
        // Counter-clockwise faces show their outside; y runs down in the picture.
        let outside = area(&p) < 0.0;
        let normal = unit(if outside { normal } else { normal.map(|x| -x) });
        let painted = || self.shape.skin?.colour(f, weights, 0.5 * area(&p).abs());
        let colour = match (outside, self.shape.colours) {
            (false, _) => INSIDE,
            (true, colours) => painted().unwrap_or_else(|| match colours {
                Some(c) => mix(&|v| c[v].map(from_srgb)),
                None => CLAY,
            }),
        };
        let tint =
            self.shape.tints.and_then(|t| t[f]).filter(|_| outside).map(|t| t.map(from_srgb));
        let colour = match tint {
            Some(t) => std::array::from_fn(|k| (1.0 - TINT) * colour[k] + TINT * t[k]),
            None => colour,
        };
        light(normal, eye, colour)
    }
}

/// A key light from above left, a cool fill light from the right, a sky, and a faint gloss; in the
/// camera's frame (right, up, towards the eye).
fn light(normal: [f64; 3], eye: [f64; 3], colour: [f64; 3]) -> [f64; 3] {
    let key = unit([-0.55, 0.62, 0.56]);
    let fill = unit([0.85, 0.1, 0.5]);
    // Wrapped a little past the terminator, as light from an area is.
    let wrapped = |l: [f64; 3], wrap: f64| ((dot(normal, l) + wrap) / (1.0 + wrap)).max(0.0);
    let (k, f) = (wrapped(key, 0.12), wrapped(fill, 0.3));
    let sky = 0.5 + 0.5 * normal[1];
    let half = unit(std::array::from_fn(|i| key[i] + eye[i]));
    let gloss = 0.05 * dot(normal, half).max(0.0).powi(24);
    // Grazing surfaces darken: it draws the outline of the relief.
    let facing = 0.72 + 0.28 * dot(normal, eye).max(0.0).sqrt();
    std::array::from_fn(|i| {
        let warm = [1.04, 1.0, 0.95][i];
        let cool = [0.88, 0.97, 1.10][i];
        facing * colour[i] * (1.02 * k * warm + 0.20 * f * cool + (0.05 + 0.11 * sky) * cool)
            + gloss
    })
}

/// A light, neutral ground, a little darker towards the bottom.
fn background(t: f64) -> [f64; 3] {
    [0.80, 0.81, 0.82].map(|x| x * (1.0 - 0.28 * t))
}

fn corners(face: [u32; 3], seen: &[Seen]) -> Option<[[f64; 3]; 3]> {
    Some([seen[face[0] as usize]?, seen[face[1] as usize]?, seen[face[2] as usize]?])
}

/// Twice the signed area in the picture.
fn area(p: &[[f64; 3]; 3]) -> f64 {
    (p[1][0] - p[0][0]) * (p[2][1] - p[0][1]) - (p[2][0] - p[0][0]) * (p[1][1] - p[0][1])
}

/// 1/depth over the picture: linear, unlike depth itself.
struct Plane([f64; 3]);

impl Plane {
    fn of(p: &[[f64; 3]; 3]) -> Option<Self> {
        let twice = area(p);
        // A face seen exactly from its edge covers no sample.
        if twice == 0.0 || !twice.is_finite() {
            return None;
        }
        let near = p.map(|q| 1.0 / q[2]);
        let (d1, d2) = (near[1] - near[0], near[2] - near[0]);
        let gx = (d1 * (p[2][1] - p[0][1]) - d2 * (p[1][1] - p[0][1])) / twice;
        let gy = (d2 * (p[1][0] - p[0][0]) - d1 * (p[2][0] - p[0][0])) / twice;
        Some(Self([near[0] - gx * p[0][0] - gy * p[0][1], gx, gy]))
    }

    fn at(&self, x: f64, y: f64) -> f64 {
        self.0[0] + self.0[1] * x + self.0[2] * y
    }
}

/// The samples (from, to) of a row whose centres lie in the triangle.
fn span(p: &[[f64; 3]; 3], y: f64, width: usize) -> Option<(usize, usize)> {
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for k in 0..3 {
        let (mut a, mut b) = (p[k], p[(k + 1) % 3]);
        // From top to bottom, so that two faces that share the edge get the same crossing.
        if a[1] > b[1] {
            std::mem::swap(&mut a, &mut b);
        }
        if a[1] <= y && y < b[1] {
            let x = a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
            low = low.min(x);
            high = high.max(x);
        }
    }
    let from = (low - 0.5).ceil().max(0.0);
    let to = (high - 0.5).ceil().min(width as f64);
    (from < to).then_some((from as usize, to as usize))
}

/// Barycentric weights in space of a sample in the picture.
fn weights(p: &[[f64; 3]; 3], at: [f64; 2]) -> [f64; 3] {
    let part = |a: [f64; 3], b: [f64; 3]| {
        (a[0] - at[0]) * (b[1] - at[1]) - (b[0] - at[0]) * (a[1] - at[1])
    };
    let w = [part(p[1], p[2]) / p[0][2], part(p[2], p[0]) / p[1][2], part(p[0], p[1]) / p[2][2]];
    let sum: f64 = w.iter().sum();
    if sum == 0.0 {
        [1.0, 0.0, 0.0]
    } else {
        w.map(|x| x / sum)
    }
}

fn unit(a: [f64; 3]) -> [f64; 3] {
    let size = length(a);
    if size > 0.0 {
        a.map(|x| x / size)
    } else {
        [0.0, 0.0, 1.0]
    }
}

/// sRGB transfer function (IEC 61966-2-1).
pub(super) fn to_srgb(x: f64) -> u8 {
    let x = x.clamp(0.0, 1.0);
    let y = if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 };
    (255.0 * y + 0.5) as u8
}

pub(super) fn from_srgb(x: u8) -> f64 {
    let y = f64::from(x) / 255.0;
    if y <= 0.040_45 {
        y / 12.92
    } else {
        ((y + 0.055) / 1.055).powf(2.4)
    }
}

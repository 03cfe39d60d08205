//! Procedural models, whole and broken, for the demo, the tests and the benches.
//!
//! All are our own, deterministic, closed, manifold, oriented outward, with edges of nearly one
//! length, y up, and in coordinates that f32 holds exactly. [`Sample::build`] makes the whole
//! model, [`breakage::break_mesh`] takes a piece out of it and keeps that piece as the truth.

pub mod breakage;
mod column;
mod leg;
mod motif;
mod noise;
mod profile;
mod relief;
mod skin;
mod sphere;
mod torus;
mod vessel;

use crate::error::{Error, Result};
use crate::mesh::MeshView;

pub use breakage::{break_mesh, Break, BreakOptions, Broken};

/// A triangle mesh that owns its arrays.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SampleMesh {
    /// Positions; the models are one to six units long.
    pub vertices: Vec<[f32; 3]>,
    /// Triangles, counter-clockwise seen from outside.
    pub faces: Vec<[u32; 3]>,
}

impl SampleMesh {
    /// The arrays as the library reads them.
    pub fn view(&self) -> MeshView<'_> {
        MeshView::new(&self.vertices[..], &self.faces[..])
    }

    /// Corners of a face, in f64.
    pub(crate) fn corners(&self, face: usize) -> [[f64; 3]; 3] {
        self.faces[face].map(|v| self.vertices[v as usize].map(f64::from))
    }

    /// Centroid of a face.
    pub(crate) fn centroid(&self, face: usize) -> [f64; 3] {
        let [a, b, c] = self.corners(face);
        std::array::from_fn(|k| (a[k] + b[k] + c[k]) / 3.0)
    }
}

/// The procedural models.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Sample {
    /// A fluted column shaft: sharp arrises, entasis, rounded closed ends.
    Column,
    /// A thick-walled vessel, decorated with a braid and a band of stipples.
    Vessel,
    /// A slab with a meander strip between two ridges.
    Relief,
    /// A bent, tapered, closed tube.
    Leg,
    /// The unit sphere.
    Sphere,
    /// A torus of radii 1 and 0.4.
    Torus,
}

/// Fewest edges along the longest side: below, a flute or a strand of the braid is lost.
pub const MIN_RESOLUTION: usize = 24;
/// Most edges along the longest side: about 50 million faces on the column.
pub const MAX_RESOLUTION: usize = 4000;

/// Where a model is broken: chosen so that the break crosses what makes the model worth completing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Site {
    /// A point on (or very near) the surface.
    pub point: [f64; 3],
    /// The outward direction there, a unit vector.
    pub normal: [f64; 3],
    /// Radius of the piece that breaks off.
    pub radius: f64,
    /// Centre of the band that [`Break::Ring`] takes out.
    pub ring_centre: [f64; 3],
    /// Axis of the band, a unit vector.
    pub ring_axis: [f64; 3],
    /// The band takes nothing farther from its centre than this.
    pub ring_reach: f64,
}

impl Sample {
    /// All models.
    pub const ALL: [Sample; 6] = [
        Sample::Column,
        Sample::Vessel,
        Sample::Relief,
        Sample::Leg,
        Sample::Sphere,
        Sample::Torus,
    ];

    /// The name in the command line.
    pub fn name(self) -> &'static str {
        match self {
            Sample::Column => "column",
            Sample::Vessel => "vessel",
            Sample::Relief => "relief",
            Sample::Leg => "leg",
            Sample::Sphere => "sphere",
            Sample::Torus => "torus",
        }
    }

    /// Makes the whole model with about `resolution` edges along the longest side of its bounding
    /// box ([`MIN_RESOLUTION`] to [`MAX_RESOLUTION`]); anything else is
    /// [`Error::InvalidOption`].
    pub fn build(self, resolution: usize) -> Result<SampleMesh> {
        if !(MIN_RESOLUTION..=MAX_RESOLUTION).contains(&resolution) {
            return Err(Error::InvalidOption {
                name: "resolution",
                reason: format!("{resolution} is outside {MIN_RESOLUTION} to {MAX_RESOLUTION}"),
            });
        }
        let edge = self.longest_side() / resolution as f64;
        Ok(match self {
            Sample::Column => column::build(edge),
            Sample::Vessel => vessel::build(edge),
            Sample::Relief => relief::build(edge),
            Sample::Leg => leg::build(edge),
            Sample::Sphere => sphere::build(edge),
            Sample::Torus => torus::build(edge),
        })
    }

    /// A colour (red, green, blue, alpha) for each of these positions on the model; `None` if it is not
    /// painted. Only the vessel is: a braid and stipples that go with the relief, and a band on the neck
    /// that is nothing but paint.
    pub fn paint(self, positions: &[[f32; 3]]) -> Option<Vec<[u8; 4]>> {
        (self == Sample::Vessel).then(|| vessel::paint(positions))
    }

    /// Longest side of the bounding box, to a few per cent.
    pub fn longest_side(self) -> f64 {
        match self {
            Sample::Column => column::LENGTH,
            Sample::Vessel => vessel::HEIGHT,
            Sample::Relief => relief::SIZE[0],
            Sample::Leg => leg::EXTENT,
            Sample::Sphere => 2.0,
            Sample::Torus => 2.0 * (torus::MAJOR + torus::MINOR),
        }
    }

    /// Where it breaks.
    pub fn site(self) -> Site {
        match self {
            Sample::Column => column::site(),
            Sample::Vessel => vessel::site(),
            Sample::Relief => relief::site(),
            Sample::Leg => leg::site(),
            Sample::Sphere => sphere::site(),
            Sample::Torus => torus::site(),
        }
    }
}

#[cfg(test)]
mod tests;

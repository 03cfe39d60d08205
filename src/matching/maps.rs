//! The source at one scale: height maps around centres that are spread over it.

use super::cloud::{thin, Cloud, Grid, Sample, Thinned};
use super::height_map::{Frame, HeightMap};
use super::icp::worth;
use super::rigid::Rigid;
use super::search::Target;
use super::source::Source;
use crate::error::Result;
use crate::mesh::neighbourhood::NONE;
use glam::DVec3;
use std::sync::{Arc, OnceLock};

/// Radius of the height maps, in hole radii: the hole and a ring as wide as its radius.
pub const REACH: f64 = 2.0;
/// Source centres lie this far apart, in hole radii: within reach of the ICP.
const SPACING: f64 = 0.3;
/// And there are about this many at most.
const MOST_CENTRES: f64 = 4000.0;
/// Normals are averaged over this radius, in hole radii, to give a map its plane.
const PLANE: f64 = 0.7;

/// The source at one scale: a thinned cloud and the height maps around centres spread over it, each
/// made when it is first asked for.
pub struct Maps {
    /// Hole radius that they are for, in mesh units.
    pub radius: f64,
    /// Of the source.
    cloud: Arc<Cloud>,
    /// Of the object that is filled: the same where all of it may be copied from.
    pub known: Arc<Cloud>,
    /// Whether mirrored copies may be made.
    pub mirrored: bool,
    /// What a difference of 1 in tint is worth, in mesh units; 0 without colours.
    pub paint: f64,
    /// What may carry the object onto itself.
    pub symmetries: Arc<Vec<Rigid>>,
    centres: Arc<Thinned>,
    maps: Vec<Kept>,
}

/// The ratio of one scale to the next: holes whose radii differ by less share their maps.
const SCALE_STEP: f64 = 1.08;
/// Spacing of the thinned source, in hole radii: two points a bin of the height maps.
const CLOUD_SPACING: f64 = 0.11;
/// The ratio of one cloud's spacing to the next; wider below the mesh's own edges, where a cloud is made of
/// several samples a face, which show nothing new.
const CLOUD_STEPS: [f64; 2] = [1.1, 1.5];

/// The scale that serves a hole radius: the least power of 1.08 (times the object's edge) above it.
pub fn scale_of(edge: f64, radius: f64) -> i32 {
    ((radius / edge).ln() / SCALE_STEP.ln()).ceil() as i32
}

/// The hole radius of a scale.
pub fn radius_at(edge: f64, scale: i32) -> f64 {
    edge * SCALE_STEP.powi(scale)
}

/// The cloud that serves a hole radius: the power of a step of its spacing, in edges.
pub fn cloud_scale(source: &Source, radius: f64) -> i32 {
    let spacing = Cloud::spacing(source, CLOUD_SPACING * radius);
    let step = CLOUD_STEPS[usize::from(spacing < source.edge)];
    ((spacing / source.edge).ln() / step.ln()).round() as i32
}

/// The cloud of a [`cloud_scale`].
pub fn cloud_at(
    source: &Source,
    cloud_scale: i32,
    check: &dyn Fn() -> Result<()>,
) -> Result<Cloud> {
    let step = CLOUD_STEPS[usize::from(cloud_scale < 0)];
    Cloud::of_source(source, source.edge * step.powi(cloud_scale), check)
}

/// How far apart the centres lie that serve a hole radius, in mesh units.
pub fn centre_spacing(source: &Source, radius: f64) -> f64 {
    (SPACING * radius).max((source.area / MOST_CENTRES).sqrt())
}

/// Centres spread over a cloud.
pub fn centres_on(cloud: &Cloud, spacing: f64, check: &dyn Fn() -> Result<()>) -> Result<Thinned> {
    let Thinned { points, normals, .. } = &cloud.thinned;
    let sample = |i: usize| Sample {
        point: points[i],
        normal: normals[i],
        roughness: 0.0,
        tint: 0.0,
        completion: cloud.thinned.completion_of(i),
    };
    let grid = Grid::over(points.iter().copied(), spacing, &cloud.axes);
    thin((0..points.len()).map(sample), &grid, check)
}

impl Maps {
    /// Around centres on a source, for holes of about a radius (mesh units). `cloud`: of the source;
    /// `known`: of the object that the holes are in.
    pub fn new(
        source: &Source,
        radius: f64,
        [cloud, known]: [Arc<Cloud>; 2],
        centres: Arc<Thinned>,
        mirrored: bool,
    ) -> Self {
        let maps = centres.points.iter().map(|_| Kept::new()).collect();
        let (paint, symmetries) = (worth(source), Arc::default());
        Self { radius, cloud, known, mirrored, paint, symmetries, centres, maps }
    }

    /// With transforms that may carry the object onto itself: each hole is laid onto its image, too.
    pub fn with_symmetries(self, symmetries: Arc<Vec<Rigid>>) -> Self {
        Self { symmetries, ..self }
    }

    /// The map around a centre, without the completion of the hole that asks: `own`, which has a place to
    /// keep it. `None` where the surface has no side to be seen from.
    pub fn map<'a>(&'a self, c: usize, (own, place): (u32, &'a Kept)) -> Option<&'a HeightMap> {
        let make = |without: u32| {
            let (centre, normal) = (self.centres.points[c], self.centres.normals[c]);
            let reach = REACH * self.radius;
            let plane = self.cloud.blocks.near(centre, PLANE * self.radius);
            // Moved onto the surface's mean plane.
            let mean = self.cloud.blocks.sum_normals(&plane, normal);
            let frame = (mean != DVec3::ZERO)
                .then(|| Frame::new(centre, mean.normalize(), &self.cloud.axes))?;
            let near = self.cloud.blocks.near(centre, reach);
            Some(Box::new(HeightMap::new(&self.cloud, &near, frame, reach, without)))
        };
        let map = self.maps[c].get_or_init(|| make(NONE)).as_deref()?;
        match map.completions.contains(&own) {
            true => place.get_or_init(|| make(own)).as_deref(),
            false => Some(map),
        }
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.maps.len()
    }

    /// The centres that a target is compared with, in order.
    pub fn choose(&self, target: &Target<'_>, most: usize, own: u32) -> Vec<u32> {
        let of = |i: &u32| self.centres.completion_of(*i as usize);
        let others = |i: &u32| of(i) == NONE || of(i) != own;
        let mut ids: Vec<u32> = (0..self.maps.len() as u32).filter(others).collect();
        // Near means something on the object itself; what was chosen is looked through whole.
        if ids.len() > most && Arc::ptr_eq(&self.cloud, &self.known) {
            let off = |i: &u32| self.centres.points[*i as usize].distance_squared(target.centre);
            ids.sort_by(|a, b| off(a).total_cmp(&off(b)).then(a.cmp(b)));
            let mut far = ids.split_off(most / 2);
            far.sort_unstable();
            let stride = far.len() as f64 / (most - most / 2) as f64;
            let spread = (0..most - most / 2).map(|k| far[(k as f64 * stride) as usize]);
            ids.extend(spread);
        }
        ids
    }
}

/// A map, once it is made: most of the places for them stay empty.
pub type Kept = OnceLock<Option<Box<HeightMap>>>;

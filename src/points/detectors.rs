//! The detectors that do not know the mesh through the points, asked of its rims.

use super::boundary::probability;
use super::field::Field;
use super::neighbours::{blocks, Neighbours};
use super::spanning::{self, agree};
use super::tidy::Rim;
use crate::error::Result;
use crate::progress::Monitor;
use glam::DVec3;

/// What the other detectors look at.
pub struct Seen<'a> {
    /// Positions.
    pub points: &'a [DVec3],
    /// Unit normals on any side.
    pub normals: &'a [DVec3],
    /// The nearest neighbours of each.
    pub neighbours: &'a Neighbours,
}

impl Seen<'_> {
    /// Asks them of each rim. Returns the centres of the places that only the distance field takes for holes.
    pub fn ask(
        &self,
        rims: &mut [Rim],
        spacing: &[f64],
        threads: usize,
        monitor: &Monitor,
    ) -> Result<Vec<[f64; 3]>> {
        let &Self { points, normals, neighbours } = self;
        let each = |v: usize| probability(points, normals, neighbours, v);
        let likely = blocks(points.len(), threads, monitor, &each)?;
        let loops = spanning::loops(points, neighbours, &likely, monitor)?;
        let field = Field::new(points, normals, spacing, threads, monitor)?;
        for rim in rims.iter_mut() {
            let sum: f64 = rim.points.iter().map(|&v| likely[v as usize]).sum();
            rim.probability = sum / rim.points.len() as f64;
            rim.in_loops = agree(&rim.points, &loops, neighbours);
            rim.in_field = field.agrees(&rim.points, neighbours);
        }
        let known: Vec<&[u32]> = rims.iter().map(|r| &r.points[..]).collect();
        let alone = field.others(&known, neighbours).into_iter();
        let at = |v: &u32| points[*v as usize];
        let centre = |o: Vec<u32>| o.iter().map(at).sum::<DVec3>() / o.len() as f64;
        Ok(alone.map(|o| centre(o).to_array()).collect())
    }
}

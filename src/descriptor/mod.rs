//! What the surroundings of a vertex look like, from near to far: heat kernel signatures of
//! vertices and patches, computed once a mesh.
//!
//! [`simplify()`] makes a coarse mesh of even triangles, [`spectrum`] its lowest eigenpairs,
//! [`heat`] the signatures, [`prolong`] takes them back to the fine mesh, and [`patch_signature`]
//! describes and compares patches. [`Spectral`] holds all that does not depend on the patches.

pub mod ball;
pub mod curvature;
mod dense;
pub mod heat;
pub mod laplacian;
pub mod mixture;
pub mod patch_signature;
pub mod principal;
pub mod prolong;
pub mod ridges;
pub mod simplify;
pub mod spectrum;
#[cfg(test)]
pub(crate) mod tests;
pub mod voting;

use crate::error::Result;
use crate::progress::Monitor;
use glam::DVec3;
use heat::{heat_times, Heat, TIME_COUNT};
use prolong::Prolongation;
use simplify::{simplify, Coarse, Cost};
use spectrum::Spectrum;

/// Vertices of the coarse mesh: signatures are within 1 % of the fine mesh's at 99 % of vertices
/// and times (measured, `docs/spectrum.md`).
pub const COARSE_VERTICES: usize = 8000;
/// Eigenpairs; Harary et al. 2014, section 4, after Sun et al. 2009.
pub const PAIRS: usize = 300;

/// The spectrum of a mesh, on a coarse copy of it, and the way back.
#[derive(Debug, Clone)]
pub struct Spectral {
    /// The coarse mesh.
    pub coarse: Coarse,
    /// From it to the fine mesh.
    pub prolongation: Prolongation,
    /// Its eigenpairs, with the masses of the fine mesh.
    pub spectrum: Spectrum,
}

impl Spectral {
    /// [`PAIRS`] eigenpairs on [`COARSE_VERTICES`] vertices.
    pub fn new(positions: &[DVec3], faces: &[[u32; 3]], monitor: &Monitor) -> Result<Self> {
        Self::with_sizes(positions, faces, COARSE_VERTICES, PAIRS, monitor)
    }

    /// The same with other sizes. Face indices must be below `positions.len()`, positions finite.
    pub fn with_sizes(
        positions: &[DVec3],
        faces: &[[u32; 3]],
        vertices: usize,
        pairs: usize,
        monitor: &Monitor,
    ) -> Result<Self> {
        let coarse = simplify(positions, faces, vertices, Cost::Uniform, monitor)?;
        let prolongation = Prolongation::new(positions, &coarse, monitor)?;
        let fine_mass = laplacian::lumped_masses(positions, faces);
        let mass = prolongation.restrict(&fine_mass, coarse.positions.len());
        let spectrum = Spectrum::new(&coarse.positions, &coarse.faces, Some(mass), pairs, monitor)?;
        Ok(Self { coarse, prolongation, spectrum })
    }

    /// Heat kernel signatures at [`TIME_COUNT`] times.
    pub fn heat(&self) -> Heat {
        Heat::new(&self.spectrum, heat_times(&self.spectrum, TIME_COUNT))
    }
}

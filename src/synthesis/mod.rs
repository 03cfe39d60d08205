//! The new surface from what was found: sources projected, fitted, ranked and joined; and the steps of
//! the paper's own method.

pub mod anchors;
pub mod appearance;
pub mod coherence_error;
pub mod constraints;
pub mod describe;
pub mod domain;
pub mod evenly;
pub mod factor;
pub mod field;
pub mod fit;
pub mod fragments;
pub mod hierarchy;
pub mod join;
pub mod labels;
pub mod levels;
pub mod overlap;
pub mod project;
pub mod quilt;
pub mod quilt_cut;
pub mod rank;
pub mod raster;
pub mod repair;
pub mod resemblance;
pub mod sampling;
#[cfg(test)]
mod tests;
pub mod view;
pub mod warp;
pub mod window;

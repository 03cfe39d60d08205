//! Triangulation, refinement and fairing of one hole.

pub mod blocks;
pub mod envelope;
pub mod even;
pub mod fairing;
pub mod outline;
pub mod patch;
pub mod polygon;
pub mod refine;
pub mod sheet;
pub mod solve;
pub mod triangulate;

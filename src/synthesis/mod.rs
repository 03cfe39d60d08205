//! New geometry from what was found to fit.

pub mod anchors;
pub mod coherence_error;
pub mod describe;
pub mod field;
pub mod levels;
pub mod repair;

//! New geometry from what was found to fit.

pub mod anchors;
pub mod coherence_error;
pub mod field;
pub mod repair;

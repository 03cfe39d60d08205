//! New geometry from what was found to fit.

pub mod field;

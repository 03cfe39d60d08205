//! What a point or a patch of the surface looks like, in numbers that can be compared.

pub mod curvature;
pub mod mixture;
pub mod ridges;

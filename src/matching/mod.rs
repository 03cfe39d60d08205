//! Where on the object something like the surroundings of a hole is found, and how it is laid there.

pub mod candidates;
pub mod cloud;
pub mod consistent;
pub mod height_map;
pub mod icp;
pub mod object;
pub mod paint;
pub mod patch;
pub mod rigid;
pub mod search;
pub mod source;
#[cfg(test)]
mod tests;

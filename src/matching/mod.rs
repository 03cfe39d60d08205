//! Where on the object something like the surroundings of a hole is found, and how it is laid there.

pub mod candidates;
pub mod consistent;
pub mod object;
pub mod patch;
pub mod rigid;
#[cfg(test)]
mod tests;

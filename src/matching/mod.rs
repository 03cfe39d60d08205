//! Where on the object something like the surroundings of a hole is found, and how it is laid there.

pub mod consistent;
pub mod rigid;
#[cfg(test)]
mod tests;

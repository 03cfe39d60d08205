//! Where on the object something like the surroundings of a hole is found, and how it is laid there.

pub mod axes;
pub mod blocks;
pub mod candidates;
pub mod cloud;
pub mod correlation;
pub mod fragment;
pub mod height_map;
pub mod icp;
pub mod maps;
pub mod object;
pub mod paint;
pub mod patch;
pub mod point_tree;
pub mod rigid;
pub mod ring_pattern;
pub mod search;
pub mod signature;
pub mod similarity;
pub mod source;
pub mod stretch;
pub mod symmetry;

//! The real binary: exit codes, files, reports, JSON lines, Ctrl-C.
#![cfg(feature = "cli")]

mod failures;
mod fill;
mod other;
mod place;
mod points;
mod sources;
mod textures;

//! The core chain against its contract: holes found, filled, nothing of the input touched.

mod appearance;
mod checker;
mod coherent;
mod contract;
mod fragment;
mod given;
mod guidance;
mod holes;
mod initial;
mod loose;
mod meshes;
mod part;
mod points;
mod progress;
mod provenance;
mod random;
mod sources;
mod surfaces;
mod texture;
mod warp;

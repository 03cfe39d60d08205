//! The core chain against its contract: holes found, filled, nothing of the input touched.

mod checker;
mod contract;
mod holes;
mod meshes;
mod random;
mod surfaces;

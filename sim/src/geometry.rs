//! The exact geometry of programmed moves: paths, and distances from them.
//!
//! A simulated machine is measured against it. No simulated machine uses it, and it is independent
//! of the integer interpolators.

mod curve;
pub mod nurbs;
pub mod path;
pub mod turn;

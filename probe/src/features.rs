//! Features from points, by least squares of the distances at right angles to the feature.
//!
//! Fits are set-up work, far from where the tool goes, so they are made in `f64`: points become
//! differences to the first one (exact up to 2^53 nm), all sums are about the centroid, and results
//! are rounded to integers once. Against an exact fit that is well below 1 nm while the points are
//! within 1 m and determine the feature well. A linear-algebra crate is not worth it here: nothing
//! is larger than five unknowns, and the crates that are `no_std` can panic.

mod corner;
mod line;
mod linear;
mod middle;
mod plane;
mod residuals;
mod round;
mod vector;

pub use corner::corner_nm;
pub use line::Line;
pub use middle::Middle;
pub use plane::Plane;
pub use residuals::{FitError, Residuals};
pub use round::{Circle, Sphere};

pub(crate) use linear::solve;
pub(crate) use residuals::Tally;
pub(crate) use round::{Round, fit_round};
pub(crate) use vector::{Centroid, add, difference, dot, length, outer, projected, to_nm, unit};

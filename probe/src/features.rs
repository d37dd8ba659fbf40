//! Features fitted to points, by least squares of the distances perpendicular to the feature.
//!
//! Fits are set-up work, not part of the tool path, so they use `f64`. Points become differences to
//! the first point (exact up to 2^53 nm), all sums are about the centroid, and results are rounded
//! to integers once. The deviation from an exact fit is well below 1 nm if the points are within 1
//! m and determine the feature well. The crate needs no linear-algebra library: there are at most
//! five unknowns, and the `no_std` libraries can panic.

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

//! The errors of a machine: found from reference lengths, bars and bodies, and corrected.

mod axis_fit;
pub mod backlash;
mod calibrated;
mod face;
mod reference;
mod square_fit;

pub use axis_fit::{AxisFit, Reading};
pub use calibrated::Calibrated;
pub use face::{Face, is_by_axis, surface_nm};
pub use reference::{Body, FoundProbe, ReferenceBody};
pub use square_fit::{Ends, SquareFit};

//! Profile generator of a servo module: one commanded position per servo period.

mod braking;
mod line;
mod motion;
mod profile;

pub use line::ServoLine;
pub use motion::ServoMotion;
pub use profile::{ServoProfile, ServoSetPoint};

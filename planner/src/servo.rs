//! What a servo module is commanded to: a position for each of its servo periods.

mod braking;
mod line;
mod motion;
mod profile;

pub use line::ServoLine;
pub use motion::ServoMotion;
pub use profile::{ServoProfile, ServoSetPoint};

//! Values as readable text.

mod duration;
mod escape;
mod length;
mod number;

pub use duration::duration;
pub use escape::escape;
pub use length::{length, millimetres};
pub use number::shortest;

//! Values as readable text.

mod escape;

pub use escape::escape;
pub use husillo_sim::text::{duration, length, millimetres, shortest};

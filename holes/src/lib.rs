#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]
#![deny(missing_docs)]

mod board;
mod gcode;
mod placement;
mod reader;
mod records;
mod slots;
mod step_and_repeat;
mod visiting_order;

pub use board::Board;
pub use gcode::{Cycle, Work};
pub use placement::{Fit, Mirror, Placement, PlacementError, Shift};
pub use reader::{MOST_FEATURES, MOST_TOOLS, Remark, Setup, read};
pub use records::{RecordsError, ToolRecords, records};
pub use slots::{SlotError, SlotHandling};
pub use visiting_order::{Metric, shortest, travel};

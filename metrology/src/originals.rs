//! The measured tables of the original machines. Beside each measured value is the value of a
//! simulated machine.
//!
//! ```text
//! measured values ──► a few fitted parameters ──► simulated machine ──► rebuilt values
//!        └───────────────────────── Table ◄───────────────────────────────────┘
//! ```
//!
//! No rebuilt value is stored. Each is the result of a simulation or a formula with the parameters
//! that its [`Table`] lists. The part that the parameters do not explain is printed, too.

pub mod cmm;
pub mod drill;
pub mod microfactory;
pub mod micromill;
mod table;

pub use table::{Parameter, Row, Table};

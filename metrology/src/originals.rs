//! The measured tables of the original machines, each beside the values that a simulated machine
//! gives.
//!
//! ```text
//! measured values ──► a few fitted parameters ──► simulated machine ──► rebuilt values
//!        └───────────────────────── Table ◄───────────────────────────────────┘
//! ```
//!
//! No rebuilt value is stored. Each results from a simulation or a formula with the parameters that
//! its [`Table`] lists. What the parameters do not explain is printed with it.

pub mod cmm;
pub mod drill;
pub mod microfactory;
pub mod micromill;
mod table;

pub use table::{Parameter, Row, Table};

//! Experiments that find the gains of a servo axis.
//!
//! ```text
//! Experiment ─► step, ultimate, relay, stepwise ─► Stand ─► Rig ─┬─► Direct  the simulated axis
//!     │            │  swing                        limits         └─► Linked  a line of modules
//!     └─► Outcome  └─► fit ─► moves
//! ```

mod direct;
mod experiment;
mod fit;
#[cfg(test)]
mod linear;
mod linked;
mod moves;
mod outcome;
mod relay;
mod rig;
mod stand;
mod step;
mod stepwise;
mod swing;
mod trial;
mod ultimate;

pub use direct::Direct;
pub use experiment::{Experiment, Failed, Method};
pub use linked::Linked;
pub use moves::Moves;
pub use outcome::{Outcome, RuleRow, UltimateFigures};
pub use relay::{NoRelay, RelayFigures, RelaySettings};
pub use rig::{Rig, Sample};
pub use stand::{Stand, Trace, counts};
pub use step::StepFigures;
pub use trial::Trial;

//! Measuring routines: touches, the features that are fitted to them, and the verdicts on their
//! tolerances.
//!
//! ```text
//! text ─► words ─► line_reader ─► clauses, jobs ─► parser ─► statement ─► runner ─► feature
//! G-code ─► program ─► called_cycle ───────────────────────────────┘  │
//!                               Prober ◄── site ◄── touches ◄─────────┤ moves and touches
//!                                          frame ◄── alignment ◄──────┤
//!                                                    fits ◄───────────┘ husillo-probe
//! ```

mod alignment;
mod called_cycle;
mod clauses;

mod dimension;
mod failure;
mod feature;
mod fits;
mod frame;
mod jobs;
mod line_reader;
mod mistake;
mod parser;
pub mod program;
mod record;
mod runner;
mod site;
mod sketch;
#[cfg(test)]
mod solid;
mod statement;
mod touches;
#[cfg(test)]
mod trials;
pub mod vector;
mod vocabulary;
mod words;

pub use dimension::{Dimension, Figure, Verdict, Wanted, decimal, number, signed};
pub use failure::Failure;
pub use feature::{Feature, Mark, Shape};
pub use frame::Frame;
pub use mistake::{Mistake, Wrong, code};
pub use parser::Parser;
pub use record::{Refusal, Refused, record};
pub use runner::Runner;
pub use site::{Contact, Site};
pub use sketch::{Sketch, SketchedTouch};
pub use statement::Statement;
pub use words::span;

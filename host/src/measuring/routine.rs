//! Measuring routines: `husillo measure run` and `husillo measure record`.
//!
//! ```text
//! text ─► words ─► line_reader ─► clauses ─► parser ─► statement ─► runner ─► feature ─► listing, page
//!                                                                     │
//!                                 prober ◄── site ◄── cycle ◄─────────┤ ways and touches
//!                                            frame ◄── alignment ◄────┤
//!                                                      fits ◄─────────┘ husillo-probe
//! ```

mod alignment;
mod called;
mod clauses;
mod cycle;
mod dimension;
mod failure;
mod feature;
mod fits;
mod frame;
mod job;
mod line_reader;
mod listing;
mod page;
mod parser;
mod picture;
mod program;
mod record;
mod runner;
mod site;
mod statement;
mod words;

pub use job::{Ending, Routine, recorded, run};

#[cfg(test)]
mod solid;
#[cfg(test)]
mod trials;

//! G-code text in, exact commands out.
//!
//! Nothing here knows a machine, a clock or a float: lengths are integer nanometres ([`Nm`]), numbers exact decimals
//! ([`Decimal`]), and a line is `&[u8]`.
//!
//! ```text
//! bytes of a port ──► LineReader ──► Receiver ──► line            or   bytes ──► WordReader ──► Word
//!                     fixed buffer   checksum, N
//!
//! line &[u8] ──► Words ──► Word ──► Block ──► Modal::plan ──► (new Modal, Commands) ──► Command
//!               letters,  decimal   groups,   modes, frames,   all or nothing          Rapid, Linear, Arc, ...
//!               comments            repeats   missing, unused
//! ```
//!
//! ```
//! use husillo_gcode::{Block, Dialect, Modal};
//!
//! let dialect = Dialect::RS274;
//! let mut modal = Modal::<3>::new(dialect);
//! let mut printed = Vec::new();
//! for line in ["G21 G90 F120", "G1 X1.5 Y-2", "G2 X2.5 I0.5"] {
//!     for (_, text) in dialect.blocks(line.as_bytes()) {
//!         let block = Block::parse(text, &dialect)?;
//!         let (next, commands) = modal.plan(&block)?;
//!         printed.extend(commands.map(|command| command.to_string()));
//!         modal = next;
//!     }
//! }
//! assert_eq!(printed, [
//!     "linear X1.5 Y-2 Z0 F120",
//!     "arc cw xy X2.5 Y-2 Z0 centre X2 Y-2 Z0 F120",
//! ]);
//! # Ok::<(), husillo_gcode::Error>(())
//! ```
#![no_std]
#![forbid(unsafe_code)]
#![deny(missing_docs)]

mod nm;
mod wide;

mod decimal;
mod error;
mod fault;
mod numeral;
mod scanner;
mod word;
mod word_reader;

mod framing;
mod line_reader;

mod letters;

mod code;
mod dialect;
mod number;

mod block;

mod arc;
mod command;
#[cfg(feature = "extended")]
mod cycle;
mod kind;
#[cfg(feature = "extended")]
mod thread;
mod tools;

mod commands;
#[cfg(feature = "extended")]
mod compensation;
mod modal;
mod modes;
#[cfg(feature = "extended")]
mod offset;
mod state;

#[cfg(feature = "extended")]
mod canned;
mod drill;
mod frames;
mod motion;
mod settings;
#[cfg(feature = "extended")]
mod special;

mod format;
mod line;

#[cfg(feature = "extended")]
pub mod contour;
#[cfg(feature = "parameters")]
pub mod parameters;

pub use arc::{Arc, Direction, Plane};
pub use block::Block;
pub use code::Side;
pub use command::{Command, Feed, Input, PathMode, SpindleDirection, Spline, Switch, WaitFor};
pub use commands::Commands;
#[cfg(feature = "extended")]
pub use compensation::{Compensated, Compensation};
pub use decimal::Decimal;
pub use dialect::{Blocks, Dialect};
pub use error::{Error, ErrorKind};
pub use format::{Formatted, formatted};
pub use framing::{Framing, FramingError, Receiver, Rule};
pub use kind::Kind as Cycle;
pub use line::Line;
pub use line_reader::{LineReader, LineTooLong};
pub use modal::Modal;
pub use modes::{Distance, FeedMode, Motion, Units};
pub use nm::{Measure, Nm};
pub use tools::Tool;
pub use word::{Token, Tokens, Word, Words, tokens, words};
pub use word_reader::WordReader;

/// The example of the README, compiled.
#[cfg(all(doctest, feature = "extended"))]
#[doc = include_str!("../README.md")]
struct Readme;

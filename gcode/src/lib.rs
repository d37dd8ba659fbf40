//! G-code text in, exact commands out.
//!
//! The crate knows no machine, no clock and no floating point. Lengths are integer nanometres
//! ([`Nm`]), numbers are exact decimals ([`Decimal`]), and a line is `&[u8]`.
//!
//! ```text
//! bytes of a port ──► LineReader ──► Receiver ──► line      or   bytes ──► WordReader ──► Word
//!                     fixed buffer   checksum, N
//!
//! line &[u8] ──► Words ──► Word ──► Block ──► Modal::plan ──► (new Modal, Commands) ──► Command
//!               letters,  decimal   groups,   modes, frames,   all or nothing          Rapid,
//!               comments            repeats   missing, unused                          Linear, ...
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
#![cfg_attr(docsrs, feature(doc_cfg))]
#![no_std]
#![forbid(unsafe_code)]
#![deny(missing_docs)]

#[cfg(any(doc, doctest))]
pub mod docs;

mod blocks;
mod codes;
mod command;
#[cfg(feature = "extended")]
mod compensation;
#[cfg(feature = "extended")]
mod cycles;
mod error;
mod features;
mod modal;
#[cfg(feature = "program")]
mod program;
mod text;
mod values;
mod words;

/// The crate of the fixed-point types.
pub use fixed;

pub use blocks::block::Block;
pub use codes::axes::Axes;
pub use codes::code::Side;
pub use codes::dialect::{Blocks, Dialect};
pub use codes::kind::Kind as Cycle;
pub use command::arc::{Arc, Direction, Plane};
pub use command::{
    Command, Feed, HeatWait, Heater, Input, OrientDirection, PathMode, Shown, SpindleDirection,
    Spline, Switch, WaitFor,
};
#[cfg(feature = "extended")]
pub use compensation::{Compensated, Compensation};
pub use error::framing::FramingError;
pub use error::{Error, ErrorKind};
pub use modal::Modal;
pub use modal::commands::{Commands, PendingCommands};
pub use modal::modes::{Distance, FeedMode, Motion, Units};
pub use modal::tools::Tool;
#[cfg(all(feature = "program", feature = "extended"))]
pub use program::contour;
#[cfg(feature = "program")]
pub use program::format::{Formatted, formatted};
#[cfg(feature = "program")]
pub use program::line::Line;
#[cfg(feature = "program")]
pub use program::parameters;
#[cfg(all(feature = "program", feature = "extended"))]
pub use program::translate::{Translated, Translator, Untranslated};
pub use text::framing::{Framing, Receiver, Rule};
pub use text::line_reader::{LineReader, LineTooLong};
pub use values::decimal::Decimal;
pub use values::nm::{Measure, Nm};
pub use words::word::{Token, Tokens, Word, Words, tokens, words};
pub use words::word_reader::WordReader;

/// The examples of the README, compiled.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

//! Reader of Excellon drill files: lines in, holes and slots out.
//!
//! A drill file is read twice, line by line. [`Inference`] observes all lines and determines the
//! format of coordinates, with the reason of each setting. [`Reader`] then returns the holes and
//! slots of each line in exact nanometres.
//!
//! ```text
//! line &[u8] ──► Inference ──► Settings ─┐        units, zeros, digits, each with its Reason
//! line &[u8] ──────────────────────────► Reader ──► Features: Hole, Slot    (or an error)
//! ```
//!
//! # Examples
//! ```
//! use husillo_excellon::{Feature, Inference, Overrides, Reader, lines};
//!
//! let text = b"M48\nINCH,LZ\nT1C0.0315\n%\nT1\nX015607Y007\nX02Y\nM30\n";
//! let mut inference = Inference::new();
//! for (_, line) in lines(text) {
//!     inference.observe(line);
//! }
//! let mut reader = Reader::<16>::new(&inference.settle(&Overrides::default()));
//! let mut printed = Vec::new();
//! for (number, line) in lines(text) {
//!     match reader.read(line) {
//!         Ok(features) => printed.extend(features.map(|feature| match feature {
//!             Feature::Hole(hole) => format!("{} {}", hole.at_nm[0], hole.at_nm[1]),
//!             Feature::Slot(_) => "slot".to_owned(),
//!         })),
//!         Err(error) => printed.push(format!("{number}:{}: {error}", error.at + 1)),
//!     }
//! }
//! assert_eq!(printed, ["39641780 17780000", "7:4: `Y` without a number"]);
//! ```
//!
//! # Supported files
//! The grammar is Excellon format 2 as layout programs write it. Step and repeat (M25, M01, M02,
//! M08) requires the features of the pattern, and a reader stores no features. The reader therefore
//! rejects it unless the caller stores them ([`Reader::with_patterns`]). The reader rejects by
//! name: hole patterns (G82, G83, G84, G87), cutter compensation (G41, G42), and an origin other
//! than zero (G92, G93).

#![cfg_attr(docsrs, feature(doc_cfg))]
#![no_std]
#![forbid(unsafe_code)]
#![deny(missing_docs)]

mod error;
mod feature;
mod format;
mod hint;
mod inference;
mod length;
mod lines;
mod number;
mod operands;
mod pattern;
mod reader;
mod scanner;
mod state;
mod statement;
mod tool;

pub use error::{Error, ErrorKind, Warning, WarningKind};
pub use feature::{Feature, Features, Hole, Path, Slot};
pub use format::{Digits, Format, Units, Zeros};
pub use inference::{Doubt, Inference, Overrides, Profile, Reason, Settings, Settled};
pub use length::LIMIT_NM;
pub use lines::{Lines, lines};
pub use pattern::{Pattern, Repeat};
pub use reader::Reader;
pub use tool::{Tool, Tools};

/// Runs the README's example as a doctest.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

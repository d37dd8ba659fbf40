#![cfg_attr(docsrs, feature(doc_cfg))]
#![doc = include_str!("../README.md")]
#![no_std]
#![forbid(unsafe_code)]
#![deny(missing_docs)]

mod interpolator;
mod lanes;
mod method;
mod step;
mod straight;

mod dda_line;
mod dda_line_exact;
mod line;

mod arc;
mod narrow_arc;
mod walk;

mod counted;
mod dda_arc;
mod direct_search;
mod direct_search_printed;
mod lattice;
mod quadrant;
mod staircase;
mod timed_direct_search;

mod bezier;
mod chords;
mod conic;
mod conic_move;
mod nurbs;

mod helix;
mod run;

mod path;

mod equal_radii;
mod grid_ellipse;
mod length;
#[cfg(feature = "fixed")]
mod millimetres;
mod programmed_arc;
mod scale;

pub use arc::{Arc, ArcError, ArcMove, Direction, Rim, fraction_bits_for};
pub use bezier::{Bezier, BezierError};
pub use chords::Chords;
pub use conic::Conic;
pub use conic_move::{ConicError, ConicMove, EllipseMove};
pub use dda_arc::{ArcDda, DdaRegisters};
pub use dda_line::LineDda;
pub use dda_line_exact::LineDdaExact;
pub use direct_search::DirectSearch;
pub use direct_search_printed::DirectSearchPrinted;
/// The crate of the fixed-point types.
#[cfg(feature = "fixed")]
pub use fixed;
pub use grid_ellipse::GridEllipse;
pub use helix::Helix;
pub use interpolator::{Interpolator, Moves, Totals};
pub use length::length;
pub use line::Line;
pub use narrow_arc::NarrowArc;
pub use nurbs::{Nurbs, TooManyPoints};
pub use path::Path;
pub use programmed_arc::{GridArc, ProgrammedArc};
pub use run::Run;
pub use scale::Scale;
pub use staircase::Staircase;
pub use step::Step;
pub use timed_direct_search::{TimedDirectSearch, TimedStep};

//! The rules by which controllers choose the speed along a path, compared on one program.
//!
//! All lengths are in mm and all times in s. Every rule knows all moves of the program ahead.

mod chords;
mod course;
mod figures;
mod junctions;
mod profile;
mod rules;

pub use chords::{Chords, Turn};
pub use course::Course;
pub use figures::{Figures, compare};
pub use profile::{Band, Piece, Profile};
pub use rules::{Rule, Settings};

//! The geometry of moves, apart from the integers that make them: paths, and distances from them.

pub mod path;
pub mod turn;

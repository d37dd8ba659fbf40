//! The exact geometry of moves: paths, and distances from them. It is independent of the integer
//! interpolators.

pub mod path;
pub mod turn;

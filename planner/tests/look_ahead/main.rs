//! Look-ahead and ramp from the outside: moves in, events out, and an independent look at what the
//! path does.

mod checker;
mod circle;
mod holds;
mod junctions;
mod moves;
mod promises;
mod runner;
mod speeds;

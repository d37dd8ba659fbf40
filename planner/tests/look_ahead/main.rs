//! Look-ahead and ramp as a black box: moves in, events out, and an independent check of the path.

mod checker;
mod circle;
mod heights;
mod holds;
mod junctions;
mod levels;
mod moves;
mod promises;
mod runner;
mod speeds;

//! Look-ahead with limited jerk as a black box: moves in, slices out, and an independent check.

mod checker;
mod events;
mod limits;
mod moves;
mod overrides;
mod runner;
mod times;

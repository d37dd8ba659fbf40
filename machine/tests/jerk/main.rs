//! Machines that limit the jerk along the path: an independent checker integrates their events.

mod checker;
mod limits;
mod machines;
mod published;
mod stops;
mod times;

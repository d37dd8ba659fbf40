//! A Grbl controller with its machine: what it does at moments that are seldom.

mod laser;
mod mill;
mod outputs;
mod probes;
mod stops;
mod suspended;

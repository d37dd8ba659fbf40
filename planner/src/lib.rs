//! Moves and path length to timer ticks

#![no_std]
#![forbid(unsafe_code)]
#![deny(missing_docs)]

//! Quadrature levels and hardware counters to positions and velocities.
#![no_std]
#![forbid(unsafe_code)]
#![deny(missing_docs)]

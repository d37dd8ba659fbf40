//! Set point and measurement to drive: PID in fixed point and the servo law of a motion module.
#![no_std]
#![forbid(unsafe_code)]
#![deny(missing_docs)]

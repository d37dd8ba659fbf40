//! A simulated machine driven by coil levels alone


#![forbid(unsafe_code)]
#![deny(missing_docs)]

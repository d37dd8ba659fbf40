//! Lines in, step events out: the composition of the husillo crates

#![no_std]
#![forbid(unsafe_code)]
#![deny(missing_docs)]

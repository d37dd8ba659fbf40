//! A move to the axes that step, one event at a time, in integers

#![no_std]
#![forbid(unsafe_code)]
#![deny(missing_docs)]

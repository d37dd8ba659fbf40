//! Bytes to frames and back, without IO: links of motion controllers.
#![no_std]
#![forbid(unsafe_code)]
#![deny(missing_docs)]

//! G/M-code text to words, checked blocks and exact commands

#![no_std]
#![forbid(unsafe_code)]
#![deny(missing_docs)]

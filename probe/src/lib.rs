//! Contacts to measured points: debounce, latch, probing cycle, compensation, features.
#![no_std]
#![forbid(unsafe_code)]
#![deny(missing_docs)]

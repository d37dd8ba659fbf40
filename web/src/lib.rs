//! The simulator as WebAssembly: `husillo.js` calls the functions of [`memory`], and has their
//! types.
//!
//! A request and its answer are bytes: the length of a text in JSON (four bytes, least significant
//! first), the text, and binary data. [`calls::answer`] makes the answer of a request. It fails
//! with a value, `{"error": ...}`.

#![deny(missing_docs)]

pub mod calls;
pub mod memory;
mod message;
mod runs;

//! Benchmarks of the husillo crates


#![forbid(unsafe_code)]
#![deny(missing_docs)]

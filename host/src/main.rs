//! The program husillo: check, simulate and draw G-code programs


#![forbid(unsafe_code)]
#![deny(missing_docs)]
fn main() {}

//! Load position to motor position: take-up before an axis turns round

#![no_std]
#![forbid(unsafe_code)]
#![deny(missing_docs)]

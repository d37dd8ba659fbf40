//! Steps to motor signals: coil phases and step/direction levels

#![no_std]
#![forbid(unsafe_code)]
#![deny(missing_docs)]

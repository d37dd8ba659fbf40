//! Bytes to commands and back, without IO: links of motion controllers.
//!
//! ```text
//!  nmc    Command ──► Frame ──► bytes        host: Startup ──► Step ──► Host ──► bytes out, Outcome
//!         bytes ──► Receiver ──► Command     module: bytes ──► Module ──► Order, then Readings ──► bytes out
//!  microfactory   byte ──► Order      by mode, with a table of bytes
//!  drill  Step ──► Host ──► one byte, its echo     Device: byte ──► echo, Order ──► the machine
//!  micromill  Order ──► string; ──► Host ──► bytes, echoes     Device: byte ──► echo, Order ──► the machine ──► steps told, Done
//!  link   payloads ──► Frame, numbered and checked ──► bytes     Master, Station, Peer: sent again until they arrive
//!  rs485  Turnaround: when to drive the line; Echo: what of the received bytes is one's own
//! ```
//!
//! Nothing here owns a port or a clock: bytes go in and come out, time is an argument in microseconds (`u32`, wrapping). The features
//! `embedded-hal-nb` and `embedded-io` put [`rs485`] on a serial port with a driver-enable pin.
//!
//! ```
//! use husillo_transports::nmc::{Command, Module, Readings, Status};
//!
//! let mut module = Module::new(4);
//! module.set_enabled(true); // ADDR_IN is low
//! for byte in Command::NoOperation.frame(0).bytes() {
//!     module.push(*byte);
//! }
//! assert_eq!(module.take(), None); // nothing for the servo to do
//! module.reply(Status(0x19), &Readings::default());
//! assert_eq!([module.transmit(), module.transmit()], [Some(0x19), Some(0x19)]);
//! ```

#![no_std]
#![forbid(unsafe_code)]
#![deny(missing_docs)]

mod buffer;
pub mod drill;
pub mod link;
pub mod microfactory;
pub mod micromill;
pub mod nmc;
pub mod rs485;

/// The README's example, as a doctest.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

//! The links of motion controllers without IO: bytes to commands, and commands to bytes.
//!
//! ```text
//!  nmc           Command ─► Frame ─► bytes       bytes ─► Receiver ─► Command
//!        host:   Startup ─► Step ─► Host ─► bytes, Outcome
//!        module: bytes ─► Module ─► Order, then Readings ─► bytes
//!  microfactory  byte ─► Order, by mode, with a table of bytes
//!  drill
//!        host:   Step ─► Host ─► one byte, its echo
//!        device: byte ─► Device ─► echo, Order for the machine
//!  micromill     Order ─► string
//!        host:   Order ─► Host ─► bytes, echoes
//!        device: byte ─► Device ─► echo, Order for the machine, then step reports, Done
//!  grbl
//!        sender: line ─► Window; reply ─► Message
//!        controller: byte ─► Receiver ─► LineReader ─► line; Message ─► reply
//!  link          payloads ─► Frame, numbered and checked ─► bytes
//!                Master, Station, Peer: repeat a frame until it arrives
//!  rs485         Turnaround: when to drive the line
//!                Echo: which of the received bytes are one's own
//! ```
//!
//! The crate owns neither a port nor a clock. Bytes are passed in and out. Time is an argument in
//! microseconds (`u32`, wrapping). The features `embedded-hal-nb`, `embedded-io` and
//! `embedded-io-async` connect [`rs485`] to a serial port with a driver-enable pin.
//!
//! # Examples
//!
//! ```
//! use husillo_transports::nmc::{Command, Module, Readings, Status};
//!
//! let mut module = Module::new(4);
//! module.set_enabled(true); // ADDR_IN is low
//! for byte in Command::NoOperation.frame(0).bytes() {
//!     module.push(*byte);
//! }
//! assert_eq!(module.take(), None); // no order for the servo
//! module.reply(Status(0x19), &Readings::default());
//! assert_eq!([module.transmit(), module.transmit()], [Some(0x19), Some(0x19)]);
//! ```

#![cfg_attr(docsrs, feature(doc_cfg))]
#![no_std]
#![forbid(unsafe_code)]
#![deny(missing_docs)]

mod buffer;
pub mod drill;
pub mod grbl;
pub mod link;
pub mod microfactory;
pub mod micromill;
pub mod nmc;
pub mod rs485;

/// The example of the README, as a doctest.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

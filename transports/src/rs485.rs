//! Half-duplex lines: when to drive the line, when to release it, and which of the received bytes
//! are the echo of one's own.
//!
//! ```text
//!  received ──────██████                               ██████  a request, the next request
//!  turnaround           |◄──────►|                             at least one character of silence
//!  driver enable                 ┌─────────────────────┐       start bit to stop bit (TC)
//!  sent                          │██████ ██████ ██████ │
//!  echo                           ██████ ██████ ██████         received, compared, dropped
//! ```
//!
//! The driver is released on **transmission complete** (the shift register is empty), not when the
//! buffer is empty. An earlier release cuts the last byte. A release one character later collides
//! with the answer. Only the master transmits without being asked. An end that receives a byte
//! other than the one it sends stops at once, and only the master tries again.
//!
//! [`Turnaround`] and [`Echo`] own neither a port nor a clock. `EnablePin` drives the pin, `NbPort`
//! is a complete port on `embedded-hal-nb`, `IoPort` is one on `embedded-io`, and `AsyncIoPort` is
//! one on `embedded-io-async`. Each of these four exists only with its feature.
//!
//! # Source
//!
//! TIA-485 practice; `SER_RS485` of Linux; `XMT_EN` of the servo modules of [`nmc`](crate::nmc). On
//! two wires, these modules need a turnaround that their original does not have.

mod echo;
#[cfg(feature = "embedded-io")]
mod io;
#[cfg(feature = "embedded-io-async")]
mod io_async;
#[cfg(feature = "embedded-hal-nb")]
mod nb;
#[cfg(feature = "embedded-hal")]
mod pin;
mod turnaround;

pub use echo::{Echo, Heard};
#[cfg(feature = "embedded-io")]
pub use io::{IoError, IoPort};
#[cfg(feature = "embedded-io-async")]
pub use io_async::AsyncIoPort;
#[cfg(feature = "embedded-hal-nb")]
pub use nb::{NbError, NbPort};
#[cfg(feature = "embedded-hal")]
pub use pin::EnablePin;
pub use turnaround::Turnaround;

//! Half-duplex lines: when to drive, when to let go, and what of the received bytes is one's own.
//!
//! ```text
//!  received ──────██████                                        ██████   the request, the next request
//!  turnaround           |◄──────►|                                       at least one character of silence
//!  driver enable                 ┌──────────────────────┐                from the first start bit ...
//!  sent                          │██████ ██████ ██████ █│                ... to the end of the last stop bit: TC
//!  echo                           ██████ ██████ ██████ █                 heard back, compared, dropped
//! ```
//!
//! The driver is released on **transmission complete** (the shift register is empty), not when the buffer is: earlier cuts the last
//! byte, and a character later collides with who answers. Nobody speaks unless asked; whoever hears a byte that differs from the one
//! sent stops at once, and only the master tries again.
//!
//! [`Turnaround`] and [`Echo`] own neither port nor clock. Behind features, `EnablePin` drives the pin, `NbPort` puts all of it on an
//! `embedded-hal-nb` port and `IoPort` on an `embedded-io` one.
//!
//! Sources: TIA-485 practice; `SER_RS485` of Linux; `XMT_EN` of the servo modules of [`nmc`](crate::nmc), which on two wires need a
//! turnaround that their original does not have.

mod echo;
#[cfg(feature = "embedded-io")]
mod io;
#[cfg(feature = "embedded-hal-nb")]
mod nb;
#[cfg(feature = "embedded-hal")]
mod pin;
mod turnaround;

pub use echo::{Echo, Heard};
#[cfg(feature = "embedded-io")]
pub use io::{IoError, IoPort};
#[cfg(feature = "embedded-hal-nb")]
pub use nb::{NbError, NbPort};
#[cfg(feature = "embedded-hal")]
pub use pin::EnablePin;
pub use turnaround::Turnaround;

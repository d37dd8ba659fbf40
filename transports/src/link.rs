//! A link of frames for our own controllers. Frames are numbered, checked and repeated, between one
//! master and one or several stations on a line.
//!
//! ```text
//!  frame    COBS( address | kind, flags | number, acknowledged | payload | CRC-16 ) 00
//!  shared   Master ──► DATA 1 to station 1     half duplex, RS-485: one asks, one answers
//!                  ◄── DATA 1, acknowledges 1  one frame at a time
//!                  ──► DATA to all: start      all receive it at once; then each is asked
//!  alone    Peer   ──► DATA 1, 2, 3 ...        full duplex: up to seven frames in flight
//!                  ◄── acknowledges 3
//! ```
//!
//! A payload arrives once, whole and in order. Otherwise the link goes down and reports how many
//! frames are in doubt. A station that has restarted reports this, and accepts nothing until it is
//! called again. The answer to a call repeats the number of the call. A broadcast is sent only
//! once, because a repetition would start some stations later than others. Every answer of a
//! station reports whether it received the last broadcast, so the master knows which stations
//! missed it.
//!
//! | field | bytes | |
//! | --- | --- | --- |
//! | address | 1 | of the station, in both directions; [`BROADCAST`] = all |
//! | control | 1 | kind in the high half: 0 data, 1 acknowledgement, 2 gap (send again from here), 3 call. Low half: bit 0 = from the station; bits 1 to 3: number of the master's last broadcast, cyclic from 1 to 7; from a station 0 if it did not receive it |
//! | sequence | 1 | number in the high half, from 1 at a call, modulo 16; in the low half the number of the last frame accepted |
//! | payload | 0 to 120 | in a call and its answer: the number of the call |
//! | check | 2 | CRC-16/IBM-SDLC of all bytes before it, low byte first |
//!
//! The link owns neither a port nor a clock. Time is an argument in microseconds (`u32`, wrapping;
//! calls at most 2^31 us apart). On a half-duplex line, [`rs485`](crate::rs485) drives the enable
//! pin and removes the echo of one's own bytes. The link ignores such an echo as well.
//!
//! # Undetected errors
//!
//! The CRC detects up to three wrong bits in a frame and any burst of 16 (Koopman's tables:
//! distance 4 up to 32 751 bits). A wrong code byte of COBS shifts the bytes after it. Of such
//! frames, one in 65 536 is accepted.
//!
//! # Source
//!
//! Cheshire and Baker, *Consistent Overhead Byte Stuffing*, SIGCOMM 1997. CRC-16/IBM-SDLC of
//! ISO/IEC 13239. Numbers and repetition as in the serial protocol of Klipper, with
//! acknowledgements in both directions.

mod conversation;
mod frame;
mod master;
#[cfg(feature = "nb")]
mod nb;
mod peer;
mod station;
mod timing;

pub use conversation::Refused;
pub use frame::{Frame, Kind, Receiver, Sent};
pub use master::{Event, Master};
pub use peer::Peer;
pub use station::{Received, Station};
pub use timing::Timing;

/// Longest payload of a frame, bytes.
pub const PAYLOAD_BYTES: usize = 120;

/// The address of all stations.
pub const BROADCAST: u8 = 0xFF;

/// Largest number of frames in flight. It is one less than half of the numbers, so that a repeated
/// frame is never taken for a new one.
pub const WINDOW_FRAMES: usize = 7;

/// Why a link is down.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Lost {
    /// The other end did not answer any try.
    NoAnswer,
    /// The other end has restarted since it was called.
    Restarted,
    /// Nothing was received for [`Timing::silence_us`].
    Silence,
}

//! A link of frames for our own controllers: numbered, checked, sent again, by one master to one station or to several on a line.
//!
//! ```text
//!  frame    COBS( address | kind, flags | number, acknowledged | payload, up to 120 bytes | CRC-16 ) 00
//!  shared   Master ──► DATA 1 to station 1     half duplex, RS-485: one asks, one answers, one frame at a time
//!                  ◄── DATA 1, acknowledges 1
//!                  ──► DATA to all: start      heard by all at the same instant, then each is asked whether it was
//!  alone    Peer   ──► DATA 1, 2, 3 ...        full duplex: up to seven frames on the way
//!                  ◄── acknowledges 3
//! ```
//!
//! What is sent arrives once, whole and in order, or the link goes down and says how many frames may or may not have arrived. A
//! station that has restarted takes nothing until it is called again, and tells so; the number of a call comes back in its answer.
//! A broadcast is sent once only, because a second one would start some later than others; every answer of a station says whether
//! it heard the last one, so the master knows who missed it.
//!
//! | field | bytes | |
//! | --- | --- | --- |
//! | address | 1 | of the station, in both directions; [`BROADCAST`] = all |
//! | control | 1 | kind in the high half: 0 data, 1 acknowledgement, 2 gap (send again from here), 3 call. Low half: bit 0 = from the station; bits 1 to 3: number of the master's last broadcast, from 1 to 7 and round again; from a station 0 if it did not hear it |
//! | sequence | 1 | number in the high half, from 1 at a call, modulo 16; in the low half the number of the last frame taken |
//! | payload | 0 to 120 | of a call and its answer: the number of the call |
//! | check | 2 | CRC-16/IBM-SDLC of all before it, low byte first |
//!
//! Nothing here owns a port or a clock: time is an argument in microseconds (`u32`, wrapping; calls at most 2^31 us apart).
//! On a half-duplex line [`rs485`](crate::rs485) drives the enable pin and takes out one's own echo, which is ignored here too.
//!
//! **What is not seen.** The CRC finds up to three wrong bits in a frame and any burst of 16 (Koopman's tables: distance 4 up to
//! 32 751 bits). A wrong code byte of COBS moves what follows, so of such frames one in 65 536 passes.
//!
//! Sources: Cheshire and Baker, *Consistent Overhead Byte Stuffing*, SIGCOMM 1997; CRC-16/IBM-SDLC of ISO/IEC 13239; numbers and
//! repeats as in the serial protocol of Klipper, with acknowledgements in both directions.

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

/// Most frames on the way at a time: half the numbers less one, so that a repeat is never taken for something new.
pub const WINDOW_FRAMES: usize = 7;

/// Why a link is down.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Lost {
    /// The other end did not answer, however often it was asked.
    NoAnswer,
    /// The other end has restarted since it was called.
    Restarted,
    /// Nothing came for [`Timing::silence_us`].
    Silence,
}

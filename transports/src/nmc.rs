//! The servo network of the PIC-SERVO modules: one host, up to 32 modules on an RS-485 line.
//!
//! # Packets
//!
//! ```text
//!  command  AA | address | (n << 4) + code | n data bytes, 0..=15 | sum
//!  reply    status | items in force, in the order of their bits | sum
//! ```
//!
//! The sum of a command includes all its bytes except AA. The sum of a reply includes all bytes
//! before it. Both are modulo 256. A byte has 8 data bits, no parity and 1 stop bit. The rate is
//! 19200 baud after power-up. Integers have the low byte first. There is no byte stuffing. There
//! are two pairs of wires. The host always drives its own pair. A module drives the other pair
//! while it replies. Any byte on the host's pair makes a module stop its reply.
//!
//! | code | command | data | | code | command | data |
//! | --- | --- | --- | --- | --- | --- | --- |
//! | 0 | Reset Position | - | | 8 | I/O Control | 1 |
//! | 1 | Set Address | own, group | | 9 | Set Homing Mode | 1 |
//! | 2 | Define Status | items | | A | Set Baud Rate | divisor |
//! | 3 | Read Status | items | | B | Clear Bits | - |
//! | 4 | Load Trajectory | 1 to 14, by the first | | C | Save Home | - |
//! | 5 | Start Motion | - | | D | Add Path Points | 0 to 14 (version 5) |
//! | 6 | Set Gain | 14 | | E | No Operation | - |
//! | 7 | Stop Motor | 1 or 5 | | F | Hard Reset | - |
//!
//! # Source
//!
//! The original machine's description of its KAE-T0V4 modules (version 4), corrected by the
//! vendor's client library and by recorded traffic. Corrections and additions to the description:
//!
//! | the description | here |
//! | --- | --- |
//! | individual addresses 0 to 255 | 0 to 127, 0 = not yet addressed; 128 to 255 are groups; anything else is refused |
//! | the sum "from address to data" | of address, command and data, eight bits |
//! | byte order, fraction, sign of the velocity: not stated | low byte first; 16.16; the reported velocity is the negative of the motion |
//! | a divisor by formula | a table, because clients differ by one |
//! | unknown commands, wrong lengths: not stated | nothing is executed, a reply is sent |
//!
//! # Faults
//!
//! A sum of eight bits detects every single wrong bit. It misses pairs of wrong bits at the rate of
//! [`unseen_pairs_in_halves`]. A reply has neither address nor number. Therefore, after a lost
//! reply it is not known whether the command was executed. [`Command::repeat`] states which
//! commands may simply be sent again. The [`Host`] repeats the others only if readings before and
//! after show that nothing happened. Otherwise it reports [`Failure::Uncertain`].
//!
//! The caller must do the rest. Read a touched position twice ([`Step::ReadTwice`]). After a move,
//! compare the position with the goal, because a trajectory cannot be read back before it starts.
//! After a group command, ask each member.

mod baud;
mod command;
mod damage;
mod flags;
mod frame;
mod gains;
mod host;
mod module;
mod outcome;
mod repeat;
mod reply;
mod residual;
mod startup;
mod timing;
mod trajectory;

pub use baud::Baud;
pub use command::{Command, EVERY_GROUP, Group, Reset};
pub use damage::{FLUSH_LENGTH, flush_byte};
pub use flags::{Auxiliary, Homing, Items, Status};
pub use frame::{Frame, HEADER, LONGEST_DATA, LONGEST_FRAME, Receiver, Verdict};
pub use gains::Gains;
pub use host::{Host, LAST_ADDRESS};
pub use module::{Module, Order};
pub use outcome::{Failure, Outcome, Progress, Refused, Step};
pub use repeat::{Finding, Repeat};
pub use reply::{LONGEST_REPLY, Readings, Reply, reported_velocity};
pub use residual::unseen_pairs_in_halves;
pub use startup::{Network, Next, Startup};
pub use timing::{CYCLE_US, Polling, Timing};
pub use trajectory::{Mode, PathPoints, Stop, StopMode, Trajectory};

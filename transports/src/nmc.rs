//! The servo network of the PIC-SERVO modules: one host, up to 32 modules on an RS-485 line.
//!
//! # Packets
//!
//! ```text
//!  command  AA | address | (n << 4) + code | n data bytes, 0..=15 | sum        sum = all but AA, modulo 256
//!  reply    status | items in force, in the order of their bits | sum         sum = all before, modulo 256
//! ```
//!
//! 8 data bits, no parity, 1 stop bit, 19200 baud after power-up; integers low byte first; nothing stuffed. Two pairs of wires: the
//! host always drives its own, a module drives the other while it replies. Any byte on the host's pair makes a module stop its reply.
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
//! Sources: the original machine's description of its KAE-T0V4 modules (version 4), corrected by the vendor's client library and
//! by recorded traffic. Where the description is wrong or silent:
//!
//! | the description | here |
//! | --- | --- |
//! | individual addresses 0 to 255 | 0 to 127, 0 = not yet addressed; 128 to 255 are groups; anything else is refused |
//! | the sum "from address to data" | of address, command and data, eight bits |
//! | byte order, fraction, velocity's sign | low byte first; 16.16; the reported velocity is the negative of the motion |
//! | a divisor by formula | a table, since clients differ by one |
//! | unknown commands, wrong lengths | nothing is done, a reply is sent |
//!
//! # Faults
//!
//! An eight-bit sum sees every single wrong bit; a pair of them is missed at the rate of [`unseen_pairs_in_halves`]. A reply has neither
//! address nor number, so a command whose reply is lost was executed or not. [`Command::repeat`] says which commands may simply be
//! sent again; the others the [`Host`] repeats only where readings before and after show that nothing happened, and otherwise reports
//! [`Failure::Uncertain`]. What is left to its user: read a touch twice ([`Step::ReadTwice`]); after a move compare the position with
//! the goal, since a trajectory cannot be read back before it starts; after a group command ask each member.

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
pub use startup::{Chain, Next, Startup};
pub use timing::{CYCLE_US, Polling, Timing};
pub use trajectory::{Mode, PathPoints, Stop, StopWay, Trajectory};

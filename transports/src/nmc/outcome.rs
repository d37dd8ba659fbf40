//! The steps of the host, and their outcomes.

use core::fmt;

use super::{Baud, Command, Items, Reply};

/// One thing to do on the line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Step {
    /// Send a command and await its reply.
    Request {
        /// An individual address, 0 to 32, or a group, 0x80 to 0xFF.
        address: u8,
        /// What to send.
        command: Command,
    },
    /// Reads a standing axis until two readings in a row agree. A wrong position must then pass the
    /// checksum twice with the same value.
    ReadTwice {
        /// 0 to 32.
        address: u8,
        /// What to read.
        items: Items,
        /// The largest difference of the two positions, in counts: the jitter of the servo. All
        /// other items must be equal, also the home position. Velocity, current and position error
        /// are not compared.
        jitter_counts: u32,
    },
    /// Complete half-received packets, and drop the answers to them.
    Flush,
    /// Keep silent, in microseconds.
    Wait {
        /// At most 2^31 - 1.
        us: u32,
    },
    /// Continue at another rate. The caller owns the port.
    Switch(Baud),
}

/// Why a [`Step`] cannot begin.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Refused {
    /// The step before is not done.
    Busy,
    /// A number is not permitted for the module.
    OutOfRange,
    /// Individual addresses end at 32 here.
    NoSuchAddress,
    /// The reply to a change of the rate would come at another rate, so only a group without leader
    /// can receive this command.
    WouldAnswer,
    /// One wrong bit would make another command of the packet: Reset Position relative to home
    /// (version 10) at address 1. Set the position instead.
    Fragile,
}

impl fmt::Display for Refused {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(match self {
            Refused::Busy => "the previous step is not done",
            Refused::OutOfRange => "a number outside the range of the command",
            Refused::NoSuchAddress => "no such address: 0 to 32, or a group from 128",
            Refused::WouldAnswer => "only a group without leader can change its rate",
            Refused::Fragile => "one wrong bit would make another command of it",
        })
    }
}

impl core::error::Error for Refused {}

/// The outcome of a [`Step`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Outcome {
    /// Executed once. In a group: by its leader; the other members must be queried.
    Answered(Reply),
    /// No reply came, but a reading shows that it was executed once: this reading.
    Confirmed(Reply),
    /// Sent, flushed, waited or switched: steps without an answer.
    Sent,
    /// It did not go well.
    Failed(Failure),
}

impl Outcome {
    /// What was read, when it went well.
    pub fn reply(&self) -> Option<&Reply> {
        match self {
            Outcome::Answered(reply) | Outcome::Confirmed(reply) => Some(reply),
            _ => None,
        }
    }
}

/// How a [`Step`] failed, after all its tries.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Failure {
    /// No byte was received: a dead module, the end of the daisy chain, or a broken line. A command
    /// that may be repeated may have been executed.
    Silent,
    /// Bytes were received, but no valid reply: noise, two modules that answer, or items other than
    /// those set. A command that may be repeated may have been executed.
    Garbled,
    /// The module received the command damaged each time, or readings show that nothing happened.
    /// The command was certainly not executed.
    NotExecuted,
    /// Executed once or not at all, which the readings do not show. It was not sent again.
    Uncertain,
    /// No two readings agreed.
    Unsteady,
}

impl fmt::Display for Failure {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(match self {
            Failure::Silent => "no answer",
            Failure::Garbled => "every answer was damaged",
            Failure::NotExecuted => "the command was not executed",
            Failure::Uncertain => "no answer, and the readings do not show whether it was executed",
            Failure::Unsteady => "two readings of a standing axis never agreed",
        })
    }
}

impl core::error::Error for Failure {}

/// The progress of the host.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Progress {
    /// There is no step.
    Idle,
    /// Bytes wait to be sent.
    Sending,
    /// The host waits for a byte. After this time the caller polls again.
    Waiting {
        /// Microseconds.
        us: u32,
    },
    /// The step is done.
    Done(Outcome),
}

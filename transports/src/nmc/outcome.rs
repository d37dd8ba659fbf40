//! The steps of the host, and their outcomes.

use core::fmt;

use super::{Baud, Command, Items, Reply};

/// One action on the line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Step {
    /// Sends a command and waits for its reply.
    Request {
        /// An individual address, 0 to 32, or a group, 0x80 to 0xFF.
        address: u8,
        /// The command to send.
        command: Command,
    },
    /// Reads an axis at rest until two readings in a row agree. A wrong position is then accepted
    /// only if it passes the checksum twice with the same value.
    ReadTwice {
        /// 0 to 32.
        address: u8,
        /// The items to read.
        items: Items,
        /// The largest difference of the two positions, in counts, which allows for the jitter of
        /// the servo. All other items must be equal, including the home position. Velocity, current
        /// and position error are not compared.
        jitter_counts: u32,
    },
    /// Completes half-received packets and drops the answers to them.
    Flush,
    /// Keeps the line silent for this time.
    Wait {
        /// At most 2^31 - 1.
        us: u32,
    },
    /// Continues at another rate. The caller owns the port.
    Switch(Baud),
}

/// Why a [`Step`] cannot begin.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Refused {
    /// The previous step is not done.
    Busy,
    /// A number is not permitted for the module.
    OutOfRange,
    /// The host supports individual addresses up to 32.
    NoSuchAddress,
    /// The reply to a change of the rate would be sent at another rate. Therefore only a group
    /// without a leader can receive this command.
    WouldAnswer,
    /// One wrong bit would make another command of the packet. This is Reset Position relative to
    /// home (version 10) at address 1. Set the position instead.
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
    /// The command was executed once. In a group this is known only for the leader. The other
    /// members must be queried.
    Answered(Reply),
    /// No reply arrived, but this reading shows that the command was executed once.
    Confirmed(Reply),
    /// The step was done. It is one without an answer: a command, flush, wait or switch.
    Sent,
    /// The step has failed.
    Failed(Failure),
}

impl Outcome {
    /// Returns the reply or the reading of a step that has not failed.
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
    /// No byte was received, because of a dead module, the end of the daisy chain, or a broken
    /// line. A command that may be repeated may have been executed.
    Silent,
    /// Bytes were received, but no valid reply. Causes are noise, two modules that answer, or items
    /// other than those set. A command that may be repeated may have been executed.
    Garbled,
    /// The module received the command damaged each time, or readings show that nothing happened.
    /// The command was certainly not executed.
    NotExecuted,
    /// The command was executed once or not at all. The readings do not show which. It was not sent
    /// again.
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

//! What the host is asked to do, and what came of it.

use core::fmt;

/// One thing to do on the line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Step {
    /// Brings a device in an unknown state to rest: ends any record, any program and the manual
    /// mode, and tests the link. It runs nothing, with one exception: a device whose full memory
    /// waits for its next byte runs what it holds.
    Resync,
    /// The link test.
    Test,
    /// An empty program; the present place becomes X 0, Y 0.
    Clear,
    /// Home all axes.
    Home,
    /// Begin a program.
    Begin,
    /// A byte of it.
    Store(u8),
    /// The end of it.
    End,
    /// Run it.
    Execute,
    /// The manual mode, with an advance in steps; homes first.
    Manual(u8),
    /// The same on a device with extras, whose program is kept.
    ManualKept(u8),
    /// A key of the manual mode.
    Key(u8),
    /// A new advance in the manual mode.
    Advance(u8),
    /// Adds a hole at the present position to the end of the program; in the manual mode of a
    /// device with extras.
    Teach,
    /// Leave the manual mode.
    Quit,
    /// Spindle on or off outside of the manual mode, on a device with extras.
    Spindle(bool),
    /// Reads the record with this number, from 0, of the program in a device with extras:
    /// [`Host::record`](super::Host::record). [`COUNT`](super::COUNT) asks how many holes were
    /// drilled.
    Read(u16),
    /// Reads the text of a device with extras, up to [`END_OF_TEXT`](super::END_OF_TEXT). The
    /// caller keeps it.
    Help,
    /// The device was reset by hand: wait for its `B`.
    AwaitBoot,
}

/// Why a [`Step`] cannot begin.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Refused {
    /// The step before is not done.
    Busy,
    /// Not in this mode; after a failure only [`Step::Resync`] and [`Step::AwaitBoot`].
    Mode,
    /// A program without a record, or with part of one.
    Incomplete,
    /// A program that was not cleared away first would be run again before this one.
    NotCleared,
}

impl fmt::Display for Refused {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(match self {
            Refused::Busy => "the step before is not done",
            Refused::Mode => "the device is in another mode, or in an unknown one",
            Refused::Incomplete => "the program has no record, or part of one",
            Refused::NotCleared => "the device still holds a program",
        })
    }
}

impl core::error::Error for Refused {}

/// What came of a [`Step`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Outcome {
    /// Done.
    Done,
    /// Stopped on request; how far it came is not known.
    Stopped,
    /// It did not go well, and the device is in an unknown state.
    Failed(Failure),
}

/// How a [`Step`] failed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Failure {
    /// No answer in time.
    Silent,
    /// Another byte than the answer: this one.
    Wrong(u8),
    /// A byte that nothing was sent for, this one: something arrived twice.
    Unasked(u8),
    /// The device says that it was reset.
    Restarted,
    /// The device stands because of a fault: a switch, a sensor, lost steps, or a position off the
    /// table. Until a reset it does nothing.
    Fault,
    /// The memory of the device has no room for another hole. Only this outcome and the next one
    /// leave the device in a known state.
    Full,
    /// The axis came to its end before all steps of a key were made.
    NotAll,
}

impl fmt::Display for Failure {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Failure::Silent => out.write_str("no answer"),
            Failure::Wrong(byte) => write!(out, "a wrong answer, {byte:02x}"),
            Failure::Unasked(byte) => write!(out, "a byte that nothing was sent for, {byte:02x}"),
            Failure::Restarted => out.write_str("the device was reset"),
            Failure::Fault => out.write_str("the device stands for a fault"),
            Failure::NotAll => out.write_str("the axis came to its end"),
            Failure::Full => out.write_str("the device's memory is full"),
        }
    }
}

impl core::error::Error for Failure {}

/// How far the host is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Progress {
    /// Nothing to do.
    Idle,
    /// A byte waits to be sent.
    Sending,
    /// For a byte, at most so many microseconds: then ask again.
    Waiting {
        /// Microseconds.
        us: u32,
    },
    /// The step is done.
    Done(Outcome),
}

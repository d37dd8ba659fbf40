//! The steps of the host, and their outcomes.

use core::fmt;

/// A step on the line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Step {
    /// Brings a device in an unknown state to rest. It ends any record, any program and the manual
    /// mode, and tests the link. It runs nothing, with one exception: a device whose full memory
    /// waits for its next byte runs what it holds.
    Resync,
    /// Tests the link.
    Test,
    /// Requests a lease, in units of [`LEASE_UNIT_MS`](super::LEASE_UNIT_MS), for all work from now
    /// on. 0 ends the lease. Only a device with extras has a lease. While a step lasts,
    /// [`Host::ask_at_work`](super::Host::ask_at_work) renews the lease. When the lease expires,
    /// the step ends with [`Failure::Expired`].
    Lease(u8),
    /// Empties the program of a device with extras, and keeps the zero.
    Empty,
    /// Empties the program. The present position becomes X 0, Y 0.
    Clear,
    /// Homes all axes.
    Home,
    /// Begins a program.
    Begin,
    /// Sends a byte of the program.
    Store(u8),
    /// Ends the program.
    End,
    /// Runs the program.
    Execute,
    /// Homes, then enters the manual mode with an advance in steps.
    Manual(u8),
    /// Homes, then enters the manual mode of a device with extras, and keeps the program. The
    /// number is the advance in steps.
    ManualKept(u8),
    /// Sends a key of the manual mode.
    Key(u8),
    /// Changes the advance in the manual mode.
    Advance(u8),
    /// Adds a hole at the present position to the end of the program. This is possible in the
    /// manual mode of a device with extras.
    Teach,
    /// Leaves the manual mode.
    Quit,
    /// Switches the spindle outside of the manual mode, on a device with extras.
    Spindle(bool),
    /// Reads the record with this number, from 0, of the program in a device with extras:
    /// [`Host::record`](super::Host::record). The number of a [`Reading`](super::Reading) reads
    /// this value instead. For example, [`COUNT`](super::COUNT) reads the number of holes that were
    /// drilled.
    Read(u16),
    /// Reads the text of a device with extras, up to [`END_OF_TEXT`](super::END_OF_TEXT). The
    /// caller keeps it.
    Help,
    /// Waits for the `B` of a device that was reset by hand.
    AwaitBoot,
}

/// Why a [`Step`] cannot begin.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Refused {
    /// The previous step is not done.
    Busy,
    /// The mode does not allow it. After a failure only [`Step::Resync`] and [`Step::AwaitBoot`]
    /// are allowed.
    Mode,
    /// The program has no record, or ends within one.
    Incomplete,
    /// An earlier program was not cleared. It would run again before this one.
    NotCleared,
    /// The memory is full. With a lease the device cannot run it before it takes the next byte,
    /// because the host would have to be silent meanwhile.
    Leased,
}

impl fmt::Display for Refused {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(match self {
            Refused::Busy => "the previous step is not done",
            Refused::Mode => "the device is in another mode, or in an unknown one",
            Refused::Incomplete => "the program has no record, or part of one",
            Refused::NotCleared => "the device still holds a program",
            Refused::Leased => "the memory is full, and a lease does not allow a wait in silence",
        })
    }
}

impl core::error::Error for Refused {}

/// The outcome of a [`Step`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Outcome {
    /// Done.
    Done,
    /// Stopped on request. Its progress is not known.
    Stopped,
    /// It failed, and the state of the device is unknown.
    Failed(Failure),
}

/// Why a [`Step`] failed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Failure {
    /// No answer in time.
    Silent,
    /// This byte arrived instead of the answer.
    Wrong(u8),
    /// This byte arrived although nothing was sent, so a byte was doubled.
    Unasked(u8),
    /// The device reports that it was reset.
    Restarted,
    /// The device has stopped because of a fault: a switch, a sensor, lost steps, or a position off
    /// the table. It does nothing until a reset.
    Fault,
    /// The lease expired before the work was done, because the device received nothing for that
    /// time. X and Y have stopped. If their positions were known, they still are. If Z was
    /// drilling, it is up. The spindle is at rest.
    Expired,
    /// The memory of the device has no room for another hole. Only this outcome and the next one
    /// leave the device in a known state.
    Full,
    /// The axis reached its end before all steps of a key were made.
    NotAll,
}

impl fmt::Display for Failure {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Failure::Silent => out.write_str("no answer"),
            Failure::Wrong(byte) => write!(out, "a wrong answer, {byte:02x}"),
            Failure::Unasked(byte) => write!(out, "an unexpected byte, {byte:02x}"),
            Failure::Restarted => out.write_str("the device was reset"),
            Failure::Fault => out.write_str("the device has stopped with a fault"),
            Failure::Expired => out.write_str("the lease has expired"),
            Failure::NotAll => out.write_str("the axis reached its end"),
            Failure::Full => out.write_str("the device's memory is full"),
        }
    }
}

impl core::error::Error for Failure {}

/// The progress of the host.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Progress {
    /// There is no step.
    Idle,
    /// A byte waits to be sent.
    Sending,
    /// The host waits for a byte. After this time the caller polls again.
    Waiting {
        /// Microseconds.
        us: u32,
    },
    /// The step is done.
    Done(Outcome),
}

//! The interface to an axis under test, simulated or real.

use crate::error::Error;
use husillo_transports::nmc::{Gains, Status};

/// A reading of an axis.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sample {
    /// Time, us.
    pub us: u64,
    /// Position, counts.
    pub position: i32,
    /// Motor current, units of the module's converter.
    pub current: u8,
    /// Status bits of the module.
    pub status: Status,
}

/// An axis behind the servo law of a module.
pub trait Rig {
    /// Sets gains and limits.
    ///
    /// # Errors
    ///
    /// The link fails.
    fn set_gains(&mut self, gains: &Gains) -> Result<(), Error>;

    /// Switches the servo on at the present position and clears all faults.
    ///
    /// # Errors
    ///
    /// The link fails.
    fn engage(&mut self) -> Result<(), Error>;

    /// Commands a position without a profile: a step.
    ///
    /// # Errors
    ///
    /// The link fails.
    fn hold(&mut self, position: i32) -> Result<(), Error>;

    /// Moves to a goal, rate in counts/s and acceleration in counts/s^2.
    ///
    /// # Errors
    ///
    /// The link fails.
    fn go_to(&mut self, goal: i32, rate: u32, acceleration: u32) -> Result<(), Error>;

    /// Drives the motor with this duty, -255 to 255, until the next command. On a line the axis
    /// stops at `end`, in counts, even without the host.
    ///
    /// # Errors
    ///
    /// The link fails.
    fn drive(&mut self, pwm: i16, end: i32) -> Result<(), Error>;

    /// Switches the drive of the motor off.
    ///
    /// # Errors
    ///
    /// The link fails.
    fn release(&mut self) -> Result<(), Error>;

    /// Waits for the next reading and returns it.
    ///
    /// # Errors
    ///
    /// The link fails.
    fn sample(&mut self) -> Result<Sample, Error>;

    /// Time since the start, us.
    fn now_us(&self) -> u64;
}

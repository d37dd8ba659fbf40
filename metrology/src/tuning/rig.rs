//! An axis to experiment on, simulated or real.

use crate::trouble::Trouble;
use husillo_transports::nmc::{Gains, Status};

/// What is read of an axis at a time.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sample {
    /// When, us.
    pub us: u64,
    /// Where it is, counts.
    pub position: i32,
    /// Motor current, units of the module's converter.
    pub current: u8,
    /// The bits of the module.
    pub status: Status,
}

/// An axis behind the servo law of a module.
pub trait Rig {
    /// Gains and limits from now on.
    ///
    /// # Errors
    ///
    /// The link fails.
    fn set_gains(&mut self, gains: &Gains) -> Result<(), Trouble>;

    /// Servo on where the axis is, all faults forgotten.
    ///
    /// # Errors
    ///
    /// The link fails.
    fn engage(&mut self) -> Result<(), Trouble>;

    /// Commands a position at once, without a profile: a step.
    ///
    /// # Errors
    ///
    /// The link fails.
    fn hold(&mut self, position: i32) -> Result<(), Trouble>;

    /// Moves to a goal, rate in counts/s and acceleration in counts/s^2.
    ///
    /// # Errors
    ///
    /// The link fails.
    fn go_to(&mut self, goal: i32, rate: u32, acceleration: u32) -> Result<(), Trouble>;

    /// Drives the motor with this duty, -255 to 255, until something else is commanded; on a line
    /// at most as far as `end`, in counts, whatever becomes of the host.
    ///
    /// # Errors
    ///
    /// The link fails.
    fn drive(&mut self, pwm: i16, end: i32) -> Result<(), Trouble>;

    /// Motor without drive.
    ///
    /// # Errors
    ///
    /// The link fails.
    fn release(&mut self) -> Result<(), Trouble>;

    /// The next reading, as soon as the axis gives one.
    ///
    /// # Errors
    ///
    /// The link fails.
    fn sample(&mut self) -> Result<Sample, Trouble>;

    /// Time since the start, us.
    fn now_us(&self) -> u64;
}

/// Counts/s and counts/s^2 as the module has them: 16.16 counts a sample of the loop of `cycle_s`,
/// at least the least.
pub fn profile(rate: u32, acceleration: u32, cycle_s: f64) -> [u32; 2] {
    let velocity = f64::from(rate) * cycle_s * 65536.0;
    let acceleration = f64::from(acceleration) * cycle_s * cycle_s * 65536.0;
    // 2^31 is beyond what any motor makes, so the casts' saturation does no harm.
    [velocity, acceleration].map(|value| (value.round() as u32).max(1))
}

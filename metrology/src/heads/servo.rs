//! An axis of the machine: a servo that is on, and the origin of its counts.

use super::machine::AxisSettings;
use super::wiring::End;
use crate::error::Error;
use crate::scale::Scale;
use husillo_transports::nmc::{Reply, Status};

/// An axis behind a module. Counts are those of the module, which are 0 at its position at the
/// reset.
#[derive(Clone, Copy, Debug)]
pub struct Servo {
    /// The settings of the axis.
    pub settings: AxisSettings,
    /// Counts at position 0.
    pub origin: i32,
    /// The last commanded position, counts.
    pub held: i32,
    /// Whether it has been homed, so that its origin is at home.
    pub is_homed: bool,
    /// Whether the operator was informed that it is not homed.
    pub is_announced: bool,
    /// Whether it stands at an end switch, or leaves it.
    pub is_at_end: bool,
    /// The end of that switch, if it is known.
    pub end: Option<End>,
    /// The end to which its last move leads.
    pub heading: Option<End>,
    /// Consecutive readings with an open end switch.
    pub open_readings: u32,
    /// Whether its end switch is searched for, so that a closed switch is not a fault.
    pub is_end_sought: bool,
    /// Whether its module watches the end switch.
    pub is_end_armed: bool,
}

impl Servo {
    /// An axis at its reset position.
    pub const fn new(settings: AxisSettings) -> Self {
        Self {
            settings,
            origin: 0,
            held: 0,
            is_homed: false,
            is_announced: false,
            is_at_end: false,
            end: None,
            heading: None,
            open_readings: 0,
            is_end_sought: false,
            is_end_armed: false,
        }
    }

    /// Counts as a position, an amount of the scale.
    pub fn position(&self, scale: Scale, counts: i32) -> i64 {
        scale.of_counts(i64::from(counts) - i64::from(self.origin))
    }

    /// A position as counts, rounded to the nearest. The result saturates far outside of any
    /// travel.
    pub fn counts(&self, scale: Scale, position: i64) -> i32 {
        let counts = scale.to_counts(position).saturating_add(self.origin.into());
        i32::try_from(counts).unwrap_or(if counts < 0 { i32::MIN } else { i32::MAX })
    }

    /// Both ends of the travel, counts. They count from home or, before the axis is homed, from its
    /// position at the reset.
    pub fn travel_counts(&self) -> [i32; 2] {
        let ends = self.settings.travel;
        ends.map(|end| end.saturating_add(self.origin))
    }

    /// The travel as positions.
    pub fn travel(&self, scale: Scale) -> [i64; 2] {
        self.travel_counts().map(|end| self.position(scale, end))
    }

    /// The highest speed, counts/s. Before homing the axis moves as slowly as in a search, because
    /// its travel may lie elsewhere than in the machine file. It leaves an end switch at the same
    /// low speed.
    pub fn rate(&self, search_rate: u32) -> u32 {
        match self.is_homed && !self.is_at_end {
            true => self.settings.rate,
            false => self.settings.rate.min(search_rate),
        }
    }

    /// Whether two positions are within the distance at which a move may end.
    pub const fn is_near(&self, counts: i32, other: i32) -> bool {
        counts.abs_diff(other) <= self.settings.in_position
    }

    /// Registers that an end switch is closed. If its input has only one switch, this determines
    /// the end. Otherwise it is the end to which the axis moved, or else the nearer one.
    pub(super) fn meet_end(&mut self, reply: &Reply) {
        let counts = reply.readings.position.saturating_sub(self.origin);
        let nearer = self.is_homed.then(|| self.settings.nearer_end(counts));
        self.is_at_end = true;
        self.end = (self.settings.wired_end(reply)).or(self.heading).or(nearer);
    }

    /// Checks the status of the axis. `at` is its position as text.
    ///
    /// # Errors
    ///
    /// The fault that the module reports.
    pub fn check(&self, reply: &Reply, at: impl FnOnce() -> String) -> Result<(), Error> {
        if !reply.status.contains(Status::POWER_ON) {
            let axis = self.settings.letter;
            Err(Error::NoPower { axis })
        } else if reply.status.contains(Status::OVERCURRENT) {
            Err(Error::OverCurrent { at: at() })
        } else if reply.status.contains(Status::POSITION_ERROR) {
            Err(Error::PositionError { at: at() })
        } else {
            Ok(())
        }
    }
}

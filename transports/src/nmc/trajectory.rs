//! The data of Load Trajectory, Stop Motor and Add Path Points.

use crate::buffer::{Buffer, Fields};

use super::frame::LONGEST_DATA;

/// The motion that the servo follows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Mode {
    /// Trapezoidal profile to a position. In version 4 it starts only from standstill.
    Trapezoid,
    /// Velocity profile. It may change at any time.
    Velocity,
    /// Plain PWM, servo off.
    #[default]
    Pwm,
}

/// Data of Load Trajectory: a control byte, then the fields that it announces.
///
/// | bit | meaning | | bit | meaning |
/// | --- | --- | --- | --- | --- |
/// | 0 | position `i32` follows | | 4 | servo on, 0 = PWM mode |
/// | 1 | velocity `u32` follows | | 5 | velocity profile, 0 = trapezoid |
/// | 2 | acceleration `u32` follows | | 6 | reverse; relative for a trapezoid of version 10 |
/// | 3 | PWM `u8` follows | | 7 | start now, 0 = at Start Motion |
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Trajectory {
    /// Goal in counts, above `i32::MIN`; at most 2^31 - 1 from the present position.
    pub position: Option<i32>,
    /// Counts per servo cycle, 16.16, 0 to 2^31 - 1.
    pub velocity: Option<u32>,
    /// Counts per servo cycle squared, 16.16, 0 to 2^31 - 1.
    pub acceleration: Option<u32>,
    /// Duty, 0 to 255.
    pub pwm: Option<u8>,
    /// The motion that the servo follows.
    pub mode: Mode,
    /// In velocity and PWM modes: the negative direction. In a trapezoid of version 10: the
    /// position is relative to the last goal. In a trapezoid of older versions it has no effect.
    pub reverse: bool,
    /// Whether it starts at once. Otherwise it starts at Start Motion.
    pub start_now: bool,
}

impl Trajectory {
    /// Whether a second execution would move the axis further.
    pub const fn is_relative(&self) -> bool {
        matches!(self.mode, Mode::Trapezoid) && self.reverse
    }

    pub(super) fn write(&self, to: &mut Buffer<LONGEST_DATA>) {
        let mut control = match self.mode {
            Mode::Trapezoid => 0x10,
            Mode::Velocity => 0x30,
            Mode::Pwm => 0x00,
        };
        for (bit, is_set) in [
            (0x01, self.position.is_some()),
            (0x02, self.velocity.is_some()),
            (0x04, self.acceleration.is_some()),
            (0x08, self.pwm.is_some()),
            (0x40, self.reverse),
            (0x80, self.start_now),
        ] {
            if is_set {
                control |= bit;
            }
        }
        to.push(control);
        if let Some(position) = self.position {
            to.extend(&position.to_le_bytes());
        }
        if let Some(velocity) = self.velocity {
            to.extend(&velocity.to_le_bytes());
        }
        if let Some(acceleration) = self.acceleration {
            to.extend(&acceleration.to_le_bytes());
        }
        if let Some(pwm) = self.pwm {
            to.push(pwm);
        }
    }

    /// Returns `None` if the length differs from the one that the control byte requires.
    pub(super) fn read(data: &[u8]) -> Option<Trajectory> {
        let mut fields = Fields(data);
        let control = fields.u8()?;
        let has = |bit: u8| control & bit != 0;
        let mut trajectory = Trajectory {
            mode: match (has(0x10), has(0x20)) {
                (true, false) => Mode::Trapezoid,
                (true, true) => Mode::Velocity,
                (false, _) => Mode::Pwm,
            },
            reverse: has(0x40),
            start_now: has(0x80),
            ..Trajectory::default()
        };
        if has(0x01) {
            trajectory.position = Some(fields.u32()? as i32); // the same bits
        }
        if has(0x02) {
            trajectory.velocity = Some(fields.u32()?);
        }
        if has(0x04) {
            trajectory.acceleration = Some(fields.u32()?);
        }
        if has(0x08) {
            trajectory.pwm = Some(fields.u8()?);
        }
        fields.0.is_empty().then_some(trajectory)
    }

    pub(super) fn is_in_range(&self) -> bool {
        let fits = |value: Option<u32>| value.is_none_or(|value| value <= 0x7FFF_FFFF);
        self.position != Some(i32::MIN) && fits(self.velocity) && fits(self.acceleration)
    }
}

/// Modes of Stop Motor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum StopMode {
    /// Servo off, PWM 0.
    Off,
    /// The present position becomes the commanded one, servo on.
    Abrupt,
    /// Decelerates at the set acceleration, servo on.
    Smooth,
    /// This position becomes the commanded one without a profile, servo on.
    Here(i32),
}

/// Data of Stop Motor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Stop {
    /// Level of the amplifier's enable output, always applied.
    pub amplifier: bool,
    /// How to stop. `None` only sets the output.
    pub mode: Option<StopMode>,
}

impl Stop {
    pub(super) fn write(&self, to: &mut Buffer<LONGEST_DATA>) {
        let bit = match self.mode {
            None => 0x00,
            Some(StopMode::Off) => 0x02,
            Some(StopMode::Abrupt) => 0x04,
            Some(StopMode::Smooth) => 0x08,
            Some(StopMode::Here(_)) => 0x10,
        };
        to.push(bit | u8::from(self.amplifier));
        if let Some(StopMode::Here(position)) = self.mode {
            to.extend(&position.to_le_bytes());
        }
    }

    /// Returns `None` if the length is wrong. Only one of the bits should be set. If several are
    /// set, the quickest stop takes effect.
    pub(super) fn read(data: &[u8]) -> Option<Stop> {
        let mut fields = Fields(data);
        let control = fields.u8()?;
        let has = |bit: u8| control & bit != 0;
        let here = if has(0x10) {
            Some(StopMode::Here(fields.u32()? as i32)) // the same bits
        } else {
            None
        };
        let mode = if has(0x02) {
            Some(StopMode::Off)
        } else if has(0x04) {
            Some(StopMode::Abrupt)
        } else if has(0x08) {
            Some(StopMode::Smooth)
        } else {
            here
        };
        fields.0.is_empty().then_some(Stop {
            amplifier: has(0x01),
            mode,
        })
    }
}

/// Data of Add Path Points (version 5 and later): up to seven increments, or none to start the
/// path.
///
/// A point is |delta| times 4, 8 or 16 (for 30, 60, 120 Hz). Bit 0 means reverse, and bit 1 means
/// slow rate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PathPoints {
    points: [u16; 7],
    /// At most 7.
    count: u8,
}

impl PathPoints {
    /// Creates a path of these points. Only the first seven are used.
    pub fn new(points: &[u16]) -> PathPoints {
        let mut path = PathPoints::default();
        for (place, point) in path.points.iter_mut().zip(points) {
            *place = *point;
            path.count = path.count.wrapping_add(1); // 7 at most
        }
        path
    }

    /// Returns the points, as on the line.
    pub fn points(&self) -> &[u16] {
        self.points.get(..usize::from(self.count)).unwrap_or(&[])
    }

    pub(super) fn write(&self, to: &mut Buffer<LONGEST_DATA>) {
        for point in self.points() {
            to.extend(&point.to_le_bytes());
        }
    }

    /// `None` for an odd number of bytes or more than 14.
    pub(super) fn read(data: &[u8]) -> Option<PathPoints> {
        let mut fields = Fields(data);
        let mut path = PathPoints::default();
        for place in &mut path.points {
            if fields.0.is_empty() {
                break;
            }
            *place = fields.u16()?;
            path.count = path.count.wrapping_add(1); // 7 at most
        }
        fields.0.is_empty().then_some(path)
    }
}

//! What a servo module can be told to do.

/// A motion of a servo module, with the values of its Load Trajectory command.
///
/// Positions are in encoder counts; velocities in 2^-16 counts a servo period, accelerations in
/// 2^-16 counts a servo period a servo period; velocities and accelerations above 2^31 - 1 are
/// taken as that. For a disc of 2000 counts a turn and 1953.125 periods a second, a turn a second
/// is 67109 and 4 turns/s^2 are 137 (PIC-SERVO data sheet, "Load trajectory"; J. R. Kerr, 1999).
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ServoMotion {
    /// To a goal with a trapezoidal profile, at rest at both ends.
    Trapezoid {
        /// Where to, in counts. The way there is taken modulo 2^32: at most 2^31 - 1 counts, on
        /// either side.
        goal: i32,
        /// Highest velocity, 2^-16 counts a period.
        velocity: u32,
        /// Acceleration and deceleration, 2^-16 counts a period^2.
        acceleration: u32,
    },
    /// At a velocity, for ever.
    Velocity {
        /// Velocity, 2^-16 counts a period.
        velocity: u32,
        /// How fast the velocity changes, 2^-16 counts a period^2.
        acceleration: u32,
        /// Towards smaller counts.
        reverse: bool,
    },
    /// No position and no servo: this duty of the output is all there is.
    Pwm {
        /// Part of 255 of the time that the motor is driven.
        duty: u8,
        /// Driven towards smaller counts.
        reverse: bool,
    },
}

//! Commands for the profile generator of a servo module.

/// A motion of a servo module, with the values of its Load Trajectory command.
///
/// Positions are in encoder counts, velocities in 2^-16 counts per servo period, accelerations in
/// 2^-16 counts per servo period^2. Larger velocities and accelerations are limited to 2^31 - 1.
/// For an encoder of 2000 counts per turn and 1953.125 periods per second, 1 turn/s is 67109 and
/// 4 turns/s^2 are 137 (PIC-SERVO data sheet, "Load trajectory"; J. R. Kerr, 1999).
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ServoMotion {
    /// Moves to a goal with a trapezoidal profile, at rest at both ends.
    Trapezoid {
        /// Goal in counts. The distance is taken modulo 2^32: at most 2^31 - 1 counts in either
        /// direction.
        goal: i32,
        /// Highest velocity in 2^-16 counts per period.
        velocity: u32,
        /// Acceleration and deceleration in 2^-16 counts per period^2.
        acceleration: u32,
    },
    /// Moves at a velocity without end.
    Velocity {
        /// Velocity in 2^-16 counts per period.
        velocity: u32,
        /// Change of velocity in 2^-16 counts per period^2.
        acceleration: u32,
        /// Towards smaller counts.
        reverse: bool,
    },
    /// Drives the motor at a fixed duty, without position and without servo.
    Pwm {
        /// Duty in units of 1/255.
        duty: u8,
        /// Drives towards smaller counts.
        reverse: bool,
    },
}

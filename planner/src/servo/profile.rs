//! Commanded position of one axis.

use super::braking::fastest;
use super::motion::ServoMotion;

/// Velocities and accelerations have 31 bits.
const LARGEST: u32 = i32::MAX as u32;

/// Set point of a servo module for one period.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ServoSetPoint {
    /// Commanded position in counts: the upper 32 bits of an accumulator of 48 bits, so rounded
    /// down.
    pub position: i32,
    /// Change of the position in this period, in 2^-16 counts.
    pub velocity: i32,
    /// Whether no motion is in progress: a goal is reached, a velocity is reached, or the servo is
    /// off.
    pub is_done: bool,
}

#[derive(Copy, Clone, Debug, PartialEq, Eq)]
enum Mode {
    /// The servo is off and the motor is driven at this duty.
    Off(i16),
    /// Moves towards a goal in counts with this top velocity.
    Goal { counts: i32, top: u32 },
    /// Changes to this velocity.
    Velocity(i32),
}

/// Profile generator of a servo module: trapezoid, velocity and fixed duty; abrupt, smooth and
/// at-position stops.
///
/// ```text
/// velocity      ________            every period: velocity +- acceleration, position + velocity,
///          ____/        \____       in an accumulator of 32.16 bits
/// ```
///
/// Call [`tick`](Self::tick) once per servo period: 0.512 ms in the module of J. R. Kerr (PIC-SERVO
/// data sheet, 1999). A servo-rate divisor ticks once in several periods. The data sheet leaves
/// open when deceleration starts. Here each period takes **the largest velocity from which the goal
/// can still be reached without passing it** if the velocity then falls by the acceleration every
/// period. This velocity is within the top velocity and within one acceleration of the last
/// velocity. So deceleration begins as late as possible, the rounding of the distance is spread
/// over it, and the goal is reached exactly and at rest, without a creep at the end. No move with
/// this acceleration and top velocity takes fewer periods.
///
/// Goal, top velocity and acceleration may change at any time. A limit that cannot be kept at once
/// is kept as soon as possible. If the top velocity was lowered, or the goal is too near, the
/// velocity falls by the acceleration every period. A goal that was passed is returned to. With an
/// acceleration of 0 the velocity never changes.
///
/// Size: 32 bytes.
///
/// # Cost
/// A period of a move to a goal takes 143 instructions on a Cortex-M4F and 380 on a Cortex-M0; on
/// ramps it takes 176 and 637, with up to three divisions.
///
/// # Examples
/// ```
/// use husillo_planner::{ServoMotion, ServoProfile};
///
/// let mut profile = ServoProfile::new(100);
/// profile.start(ServoMotion::Trapezoid {
///     goal: 110,
///     velocity: 2 << 16,
///     acceleration: 1 << 16,
/// });
/// let positions: Vec<i32> = core::iter::from_fn(|| {
///     let set_point = profile.tick();
///     (!set_point.is_done).then_some(set_point.position)
/// })
/// .collect();
/// assert_eq!(positions, [101, 103, 105, 107, 109]); // and 110, which ends it
/// assert_eq!(profile.position(), 110);
/// ```
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct ServoProfile {
    /// Counts times 2^16, modulo 2^48, sign extended.
    position: i64,
    /// At most 2^31 in magnitude.
    velocity: i32,
    acceleration: u32,
    mode: Mode,
    is_done: bool,
    is_acceleration_done: bool,
    is_slew_done: bool,
}

impl ServoProfile {
    /// Creates a profile at rest at this position in counts, with the servo on.
    pub const fn new(position: i32) -> Self {
        Self {
            position: (position as i64) << 16,
            velocity: 0,
            acceleration: 0,
            mode: Mode::Goal {
                counts: position,
                top: 0,
            },
            is_done: true,
            is_acceleration_done: false,
            is_slew_done: false,
        }
    }

    /// Starts a motion from the present commanded position and velocity. When the servo was off,
    /// set the position first with [`stop_abruptly`](Self::stop_abruptly).
    pub fn start(&mut self, motion: ServoMotion) {
        self.is_done = false;
        self.is_acceleration_done = false;
        self.is_slew_done = false;
        match motion {
            ServoMotion::Trapezoid {
                goal,
                velocity,
                acceleration,
            } => {
                self.acceleration = acceleration.min(LARGEST);
                self.mode = Mode::Goal {
                    counts: goal,
                    top: velocity.min(LARGEST),
                };
            }
            ServoMotion::Velocity {
                velocity,
                acceleration,
                reverse,
            } => {
                self.acceleration = acceleration.min(LARGEST);
                let velocity = velocity.min(LARGEST) as i32;
                self.mode = Mode::Velocity(signed(velocity, reverse));
            }
            ServoMotion::Pwm { duty, reverse } => {
                self.switch_off();
                self.mode = Mode::Off(if reverse {
                    i16::from(duty).wrapping_neg()
                } else {
                    duty.into()
                });
            }
        }
    }

    /// Switches the servo off, with no current in the motor.
    pub const fn switch_off(&mut self) {
        self.velocity = 0;
        self.is_done = true;
        self.mode = Mode::Off(0);
    }

    /// Holds the actual position in counts at once and switches the servo on. The command makes a
    /// step if the axis was elsewhere.
    pub const fn stop_abruptly(&mut self, actual: i32) {
        self.hold(actual);
    }

    /// Holds this position in counts at once, without a profile, and switches the servo on.
    pub const fn stop_at(&mut self, position: i32) {
        self.hold(position);
    }

    /// Decelerates to rest with the present acceleration. Does not switch the servo on.
    pub const fn stop_smoothly(&mut self) {
        if self.is_servo_on() {
            self.mode = Mode::Velocity(0);
            self.is_done = self.velocity == 0;
        }
    }

    /// Sets the commanded position to `position` without a change of velocity. The number of a goal
    /// stays unchanged.
    pub const fn set_position(&mut self, position: i32) {
        self.position = (position as i64) << 16;
        // After a finished move the goal is the held position.
        if let (Mode::Goal { counts, .. }, true) = (&mut self.mode, self.is_done) {
            *counts = position;
        }
    }

    /// Advances by one period and returns its set point.
    pub fn tick(&mut self) -> ServoSetPoint {
        match self.mode {
            Mode::Off(_) => {}
            Mode::Velocity(target) => {
                self.velocity = self.towards(target);
                if self.velocity == target {
                    self.is_done = true;
                    self.is_acceleration_done = true;
                }
            }
            Mode::Goal { .. } if self.is_done => {}
            Mode::Goal { counts, top } => self.approach(counts, top),
        }
        let velocity = self.velocity;
        // Modulo 2^48.
        self.position = wrapped(self.position.wrapping_add(velocity.into()));
        self.arrive();
        ServoSetPoint {
            position: self.position(),
            velocity,
            is_done: self.is_done,
        }
    }

    /// The commanded position in counts, rounded down.
    pub const fn position(&self) -> i32 {
        (self.position >> 16) as i32
    }

    /// The commanded position in 2^-16 counts: 48 bits, signed.
    pub const fn position_48(&self) -> i64 {
        self.position
    }

    /// The present commanded velocity in 2^-16 counts per period; 0 at a goal and while the servo
    /// is off.
    pub const fn velocity(&self) -> i32 {
        self.velocity
    }

    /// Whether no motion is in progress, as in [`ServoSetPoint::is_done`].
    pub const fn is_done(&self) -> bool {
        self.is_done
    }

    /// Whether a position is held. It is not after [`ServoMotion::Pwm`] and
    /// [`switch_off`](Self::switch_off), until a motion starts or a stop holds.
    pub const fn is_servo_on(&self) -> bool {
        !matches!(self.mode, Mode::Off(_))
    }

    /// Duty in units of 1/255 while the servo is off, negative towards smaller counts; 0 otherwise.
    pub const fn duty(&self) -> i16 {
        match self.mode {
            Mode::Off(duty) => duty,
            _ => 0,
        }
    }

    /// Whether the last motion has stopped accelerating.
    pub const fn is_acceleration_done(&self) -> bool {
        self.is_acceleration_done
    }

    /// Whether the last motion has begun to decelerate towards its goal. Never true for
    /// [`ServoMotion::Velocity`].
    pub const fn is_slew_done(&self) -> bool {
        self.is_slew_done
    }

    const fn hold(&mut self, position: i32) {
        self.position = (position as i64) << 16;
        self.velocity = 0;
        self.is_done = true;
        self.mode = Mode::Goal {
            counts: position,
            top: 0,
        };
    }

    /// The velocity nearest to `target` within one acceleration of the present one.
    fn towards(&self, target: i32) -> i32 {
        let most = i64::from(self.acceleration);
        let now = i64::from(self.velocity);
        let change = i64::from(target)
            .wrapping_sub(now)
            .clamp(most.wrapping_neg(), most);
        // Between `now` and `target`, which both have 32 bits.
        now.wrapping_add(change) as i32
    }

    /// Sets the velocity of a period of a move to a goal.
    fn approach(&mut self, goal: i32, top: u32) {
        if self.acceleration == 0 {
            return;
        }
        let way = self.way_to(goal);
        let is_backward = way < 0 || way == 0 && self.velocity < 0;
        // Velocities towards the goal are positive from here on.
        let now = signed(self.velocity, is_backward);
        let next = match u32::try_from(now) {
            Ok(now) => {
                let low = now.saturating_sub(self.acceleration);
                // Both are at most 2^31 - 1.
                let high = now.wrapping_add(self.acceleration).min(top.max(low));
                let next = fastest(low, high, self.acceleration, way.unsigned_abs());
                self.is_acceleration_done |= next <= now;
                self.is_slew_done |= next < now.min(top);
                next as i32
            }
            // Moving away from the goal: reverse first.
            Err(_) => match u32::try_from(i64::from(now).wrapping_add(self.acceleration.into())) {
                Ok(high) => fastest(0, high.min(top), self.acceleration, way.unsigned_abs()) as i32,
                // now < 0 and the sum is still negative.
                Err(_) => now.wrapping_add(self.acceleration as i32),
            },
        };
        self.velocity = signed(next, is_backward);
    }

    /// Ends the motion at the goal if it is slow enough to stand in the next period.
    fn arrive(&mut self) {
        let Mode::Goal { counts, .. } = self.mode else {
            return;
        };
        if self.way_to(counts) == 0 && self.velocity.unsigned_abs() <= self.acceleration {
            self.is_acceleration_done |= !self.is_done;
            self.is_slew_done |= !self.is_done;
            self.velocity = 0;
            self.is_done = true;
        }
    }

    /// Distance from the commanded position to a goal in counts, in 2^-16 counts, in the shorter
    /// direction modulo 2^48.
    const fn way_to(&self, goal: i32) -> i64 {
        wrapped(((goal as i64) << 16).wrapping_sub(self.position))
    }
}

/// Sign-extends a number of 48 bits.
const fn wrapped(number: i64) -> i64 {
    number << 16 >> 16
}

/// Negates `number` if `is_negative`; numbers are above -2^31.
const fn signed(number: i32, is_negative: bool) -> i32 {
    if is_negative {
        number.wrapping_neg()
    } else {
        number
    }
}

//! The servo law of a motion module, in the module's integers.

/// Gains and limits of a module, as in its Set Gain command.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ServoGains {
    /// Kp, 0 to 0x7FFF.
    pub proportional: u16,
    /// Kd, 0 to 0x7FFF.
    pub derivative: u16,
    /// Ki, 0 to 0x7FFF. Has no effect without an integration limit.
    pub integral: u16,
    /// IL, 0 to 0x7FFF: bound of the running total of errors. 0 clears the total.
    pub integral_limit: u16,
    /// OL: bound of the PWM.
    pub output_limit: u8,
    /// CL: bound of the measured current. Odd: the reading increases with the current. Even: it
    /// decreases. 0: no limit.
    pub current_limit: u8,
    /// EL, 0 to 0x3FFF counts (0x7FFF in later versions). A larger position error switches the
    /// servo off.
    pub error_limit: u16,
    /// SR: servo ticks per sample, see [`RateRule`]. 0 counts as 1.
    pub rate_divisor: u8,
    /// DB: added to every PWM other than 0, to overcome stiction.
    pub dead_band: u8,
}

/// What the servo-rate divisor applies to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum RateRule {
    /// The whole loop with its profile: a module of version 4.
    #[default]
    Loop,
    /// Only the sampling of the derivative: version 10. The derivative is held between two samples.
    Derivative,
}

/// The value that the integration limit bounds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum TotalLimit {
    /// The total itself, as in the description.
    #[default]
    BeforeScaling,
    /// The total divided by 256.
    AfterScaling,
}

/// PWM and direction of a motor.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Drive {
    /// The duty, 0 to 255.
    pub pwm: u8,
    /// The direction output: high for a negative drive. Low at 0, which the description leaves
    /// open.
    pub is_reverse: bool,
}

impl Drive {
    /// Returns the drive as a signed number, -255 to 255.
    pub const fn signed(self) -> i16 {
        let pwm = self.pwm as i16;
        if self.is_reverse {
            pwm.wrapping_neg()
        } else {
            pwm
        }
    }
}

/// The settings of the servo law of the PIC-SERVO module (tick 0.512 ms). Each axis has its own
/// [`ServoState`].
///
/// ```text
/// e      = command - actual, saturated to 16 bits       |e| > EL: off, until switched on again
/// total += e, within +-IL
/// out    = Kp e + Kd (e - e before) + Ki (total / 256)                     division towards 0
/// pwm    = min(|out| / 256 + (DB if out is not 0), OL) - cut
/// cut    : +1 per sample while the current exceeds CL, else -1
/// ```
///
/// The description prints `- Kd (e - e before)`, which feeds oscillation instead of damping it.
/// This law has the sign of the data sheet, `+ Kd (e - e before)`.
///
/// # Source
/// PIC-SERVO data sheet (J. R. Kerr), with the corrections that the README lists.
///
/// # Examples
/// ```
/// use husillo_pid::{Drive, RateRule, ServoGains, ServoLaw, ServoState, TotalLimit};
///
/// let gains = ServoGains {
///     proportional: 100,
///     derivative: 1000,
///     output_limit: 255,
///     error_limit: 4000,
///     ..ServoGains::default()
/// };
/// let law = ServoLaw::new(&gains, RateRule::Loop, TotalLimit::BeforeScaling);
/// let mut axis = ServoState::on();
/// assert_eq!(law.tick(&mut axis, 100, 0, 0), Drive { pwm: 255, is_reverse: false });
/// assert_eq!(law.tick(&mut axis, 100, 0, 0), Drive { pwm: 39, is_reverse: false });
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ServoLaw {
    proportional: i32,
    derivative: i32,
    integral: i32,
    total_limit: i32,
    error_limit: u32,
    output_limit: u8,
    current_limit: u8,
    rate_divisor: u8,
    dead_band: u8,
    rate_rule: RateRule,
}

/// The state of one axis from tick to tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ServoState {
    is_on: bool,
    is_over_current: bool,
    /// Ticks until the next sample.
    wait_ticks: u8,
    cut: u8,
    error: i16,
    sampled_error: i16,
    slope: i32,
    total: i32,
    output: i32,
    drive: Drive,
}

impl ServoLaw {
    /// Creates the law with these gains. Values out of range are limited to their range.
    pub const fn new(gains: &ServoGains, rate_rule: RateRule, limit: TotalLimit) -> Self {
        let integral_limit = fifteen_bits(gains.integral_limit);
        Self {
            proportional: fifteen_bits(gains.proportional),
            derivative: fifteen_bits(gains.derivative),
            integral: fifteen_bits(gains.integral),
            total_limit: match limit {
                TotalLimit::BeforeScaling => integral_limit,
                // Below 2^23.
                TotalLimit::AfterScaling => integral_limit << 8,
            },
            error_limit: fifteen_bits(gains.error_limit) as u32,
            output_limit: gains.output_limit,
            current_limit: gains.current_limit,
            rate_divisor: gains.rate_divisor,
            dead_band: gains.dead_band,
            rate_rule,
        }
    }

    /// Whether the next tick is a sample of the loop. The profile advances only in such a tick.
    /// Always true unless the divisor applies to the whole loop.
    pub const fn is_due(&self, state: &ServoState) -> bool {
        matches!(self.rate_rule, RateRule::Derivative) || state.wait_ticks == 0
    }

    /// Computes one servo tick. `command` and `actual` are in counts; their difference may wrap.
    /// `current` is a reading of the motor current.
    pub fn tick(&self, state: &mut ServoState, command: i32, actual: i32, current: u8) -> Drive {
        let is_sample = state.wait_ticks == 0;
        state.wait_ticks = if is_sample {
            self.rate_divisor.saturating_sub(1)
        } else {
            state.wait_ticks.saturating_sub(1)
        };
        if is_sample || self.rate_rule == RateRule::Derivative {
            let error = command.wrapping_sub(actual);
            // Tests the whole error: saturated to 16 bits it could be within a limit of 0x7FFF.
            if error.unsigned_abs() > self.error_limit {
                state.is_on = false;
            }
            state.error = error.clamp(i16::MIN.into(), i16::MAX.into()) as i16;
            state.drive = self.sample(state, is_sample, current);
        }
        state.drive
    }

    fn sample(&self, state: &mut ServoState, is_derivative_due: bool, current: u8) -> Drive {
        let error = i32::from(state.error);
        if !state.is_on {
            state.output = 0;
            return self.open_loop(state, Drive::default(), current);
        }
        // The total is within 2^23, the error within 2^15.
        let total = state.total.wrapping_add(error);
        state.total = total
            .min(self.total_limit)
            .max(self.total_limit.wrapping_neg());
        if is_derivative_due {
            // Within 65535.
            state.slope = error.wrapping_sub(i32::from(state.sampled_error));
            state.sampled_error = state.error;
        }
        // Gains are below 2^15, so the products are within 2^30, 2^31 - 2^16 and 2^30. A sum that
        // saturates is far beyond 255 * 256 with or without saturation.
        let output = self
            .proportional
            .wrapping_mul(error)
            .saturating_add(self.derivative.wrapping_mul(state.slope))
            .saturating_add(self.integral.wrapping_mul(state.total / 256));
        state.output = output;
        let mut pwm = output.unsigned_abs() >> 8;
        if output != 0 {
            // Below 2^23 and 2^8.
            pwm = pwm.wrapping_add(self.dead_band.into());
        }
        let drive = Drive {
            pwm: pwm.min(self.output_limit.into()) as u8,
            is_reverse: output < 0,
        };
        self.open_loop(state, drive, current)
    }

    /// Computes one sample without the loop (the PWM mode of the module), under the current limit.
    pub fn open_loop(&self, state: &mut ServoState, drive: Drive, current: u8) -> Drive {
        state.is_over_current = match self.current_limit {
            0 => false,
            limit if limit & 1 == 1 => current > limit,
            limit => current < limit,
        };
        state.cut = if state.is_over_current {
            state.cut.saturating_add(1).min(drive.pwm)
        } else {
            state.cut.saturating_sub(1)
        };
        let pwm = drive.pwm.saturating_sub(state.cut);
        state.drive = Drive { pwm, ..drive };
        state.drive
    }
}

/// Limits a value to 0..=0x7FFF.
const fn fifteen_bits(value: u16) -> i32 {
    if value > 0x7fff { 0x7fff } else { value as i32 }
}

impl ServoState {
    /// The state of a servo that is just switched on. The command should equal the actual position.
    pub const fn on() -> Self {
        Self {
            is_on: true,
            ..Self::off()
        }
    }

    /// The state of a servo that is switched off, as after power-up and after loss of motor power.
    pub const fn off() -> Self {
        Self {
            is_on: false,
            is_over_current: false,
            wait_ticks: 0,
            cut: 0,
            error: 0,
            sampled_error: 0,
            slope: 0,
            total: 0,
            output: 0,
            drive: Drive {
                pwm: 0,
                is_reverse: false,
            },
        }
    }

    /// Whether the servo is on. A position error beyond its limit switches it off.
    pub const fn is_on(&self) -> bool {
        self.is_on
    }

    /// Whether the current exceeded its limit in the last sample.
    pub const fn is_over_current(&self) -> bool {
        self.is_over_current
    }

    /// Returns the position error of the last sample, in counts, saturated.
    pub const fn error_counts(&self) -> i16 {
        self.error
    }

    /// Returns the running total of errors, in counts.
    pub const fn total_counts(&self) -> i32 {
        self.total
    }

    /// Returns the output of the last sample before scaling and limits, saturated to 32 bits.
    pub const fn output(&self) -> i32 {
        self.output
    }
}

//! The servo law of a motion module, in its integers.

/// The gains and limits of a module, as its Set Gain command gives them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ServoGains {
    /// Kp, 0 to 0x7FFF.
    pub proportional: u16,
    /// Kd, 0 to 0x7FFF.
    pub derivative: u16,
    /// Ki, 0 to 0x7FFF. Without an integration limit it does nothing.
    pub integral: u16,
    /// IL, 0 to 0x7FFF: bound of the running total of errors. 0 empties the total.
    pub integral_limit: u16,
    /// OL: bound of the PWM.
    pub output_limit: u8,
    /// CL: bound of the measured current. Odd: the reading grows with the current; even: it
    /// shrinks; 0: no limit.
    pub current_limit: u8,
    /// EL, 0 to 0x3FFF counts (later versions 0x7FFF): a larger position error turns the servo off.
    pub error_limit: u16,
    /// SR: servo ticks a sample, see [`RateRule`]. 0 counts as 1.
    pub rate_divisor: u8,
    /// DB: added to a PWM that is not 0, to overcome stiction.
    pub dead_band: u8,
}

/// What the servo-rate divisor divides.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum RateRule {
    /// The whole loop, profile included: a module of version 4.
    #[default]
    Loop,
    /// Only the sampling of the derivative, whose value is held in between: version 10.
    Derivative,
}

/// Where the integration limit bounds the total.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum TotalLimit {
    /// The total itself, as the description says.
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
    /// The direction output: the drive is negative. Low at 0, where the description leaves it open.
    pub is_reverse: bool,
}

impl Drive {
    /// The drive as a number, -255 to 255.
    pub const fn signed(self) -> i16 {
        let pwm = self.pwm as i16;
        if self.is_reverse {
            pwm.wrapping_neg()
        } else {
            pwm
        }
    }
}

/// The law of the PIC-SERVO module (tick 0.512 ms), its settings; what an axis remembers is its
/// [`ServoState`].
///
/// ```text
/// e      = command - actual, saturated to 16 bits       |e| > EL: off, until turned on again
/// total += e, within +-IL
/// out    = Kp e + Kd (e - e before) + Ki (total / 256)             division towards 0
/// pwm    = min(|out| / 256 + (DB if out is not 0), OL) - cut
/// cut    : +1 per sample while the current is over CL, else -1
/// ```
///
/// The description prints `- Kd (e - e before)`, which feeds oscillation instead of damping it; the
/// data sheet subtracts the other way round, and so does this. Source: PIC-SERVO data sheet (J. R.
/// Kerr), with the corrections that the README lists.
///
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

/// What an axis remembers from tick to tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ServoState {
    is_on: bool,
    is_over_current: bool,
    /// Ticks before the next sample.
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
    /// The law with these gains; values beyond their range count as its end.
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

    /// Whether the next tick is a sample of the loop: only then the profile moves on. Always so
    /// unless the divisor divides the whole loop.
    pub const fn is_due(&self, state: &ServoState) -> bool {
        matches!(self.rate_rule, RateRule::Derivative) || state.wait_ticks == 0
    }

    /// One servo tick in which the axis is to be at `command` and is at `actual`, in counts (their
    /// difference may wrap), with a reading of the motor current.
    pub fn tick(&self, state: &mut ServoState, command: i32, actual: i32, current: u8) -> Drive {
        let is_sample = state.wait_ticks == 0;
        state.wait_ticks = if is_sample {
            self.rate_divisor.saturating_sub(1)
        } else {
            state.wait_ticks.saturating_sub(1)
        };
        if is_sample || self.rate_rule == RateRule::Derivative {
            let error = command.wrapping_sub(actual);
            // The whole error, as 16 bits can be saturated and still within a limit of 0x7FFF.
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
        // Gains are below 2^15: products within 2^30, 2^31 - 2^16 and 2^30. Where the sum saturates
        // it is far beyond 255 * 256 with and without.
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

    /// A drive without the loop (the module's PWM mode), under the current limit: one sample of it.
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

/// A value of 0 to 0x7FFF.
const fn fifteen_bits(value: u16) -> i32 {
    if value > 0x7fff { 0x7fff } else { value as i32 }
}

impl ServoState {
    /// The servo turned on, with nothing remembered. The command should be where the axis is.
    pub const fn on() -> Self {
        Self {
            is_on: true,
            ..Self::off()
        }
    }

    /// The servo turned off: the state after power-up, and after loss of motor power.
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

    /// Whether the servo is on; a position error beyond its limit has turned it off.
    pub const fn is_on(&self) -> bool {
        self.is_on
    }

    /// Whether the current was over its limit in the last sample.
    pub const fn is_over_current(&self) -> bool {
        self.is_over_current
    }

    /// The position error of the last sample, in counts, saturated.
    pub const fn error_counts(&self) -> i16 {
        self.error
    }

    /// The running total of errors, in counts.
    pub const fn total_counts(&self) -> i32 {
        self.total
    }

    /// The output of the last sample before it was scaled and limited, saturated to 32 bits.
    pub const fn output(&self) -> i32 {
        self.output
    }
}

//! Figures of tuning experiments, and gains computed from them. In floating point, for a host or a
//! start-up routine, not for the interrupt.

use fixed::traits::Fixed;

use crate::servo::ServoGains;
use crate::settings::Gains;

/// Figures of a step response.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct StepResponse {
    /// Time from 10 % to 90 % of the step, in seconds.
    pub rise_s: f64,
    /// Overshoot of the peak beyond the target, as a fraction of the step. 0 without overshoot.
    pub overshoot: f64,
    /// Time after which the response stays within the band around the target, in seconds.
    pub settling_s: f64,
}

/// Returns the figures of a step from `start` to `target`. `samples` begin at the step and are
/// `period_s` seconds apart. `band` is the fraction of the step within which the response counts as
/// settled, usually 0.02 or 0.05.
///
/// Returns `None` if the response never rises to 90 %, if it does not settle, or if the step is 0.
///
/// # Source
/// Definitions: Franklin, Powell, Emami-Naeini, *Feedback Control of Dynamic Systems*, 6th ed.,
/// 3.4.
///
/// # Examples
/// ```
/// use husillo_pid::tuning::step_response;
///
/// let figures = step_response(&[0.0, 5.0, 12.0, 11.0, 10.0, 10.1], 0.5, 0.0, 10.0, 0.02).unwrap();
/// assert_eq!((figures.rise_s, figures.settling_s), (0.5, 2.0));
/// assert!((figures.overshoot - 0.2).abs() < 1e-12);
/// ```
pub fn step_response(
    samples: &[f64],
    period_s: f64,
    start: f64,
    target: f64,
    band: f64,
) -> Option<StepResponse> {
    let step = target - start;
    if step == 0.0 || !step.is_finite() {
        return None;
    }
    let (mut ten, mut ninety, mut settled) = (None, None, None);
    let (mut peak, mut time_s) = (0.0_f64, 0.0);
    for sample in samples {
        let part = (sample - start) / step;
        if part >= 0.1 && ten.is_none() {
            ten = Some(time_s);
        }
        if part >= 0.9 && ninety.is_none() {
            ninety = Some(time_s);
        }
        if part - 1.0 <= band && 1.0 - part <= band {
            settled = settled.or(Some(time_s));
        } else {
            settled = None;
        }
        if part > peak {
            peak = part;
        }
        time_s += period_s;
    }
    Some(StepResponse {
        rise_s: ninety? - ten?,
        overshoot: if peak > 1.0 { peak - 1.0 } else { 0.0 },
        settling_s: settled?,
    })
}

/// A relay in place of the controller. Its output makes the axis oscillate at its ultimate
/// frequency.
///
/// # Source
/// Astrom and Hagglund, *Automatic tuning of simple regulators with specifications on phase and
/// amplitude margins*, Automatica 20 (1984).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Relay {
    amplitude: f64,
    hysteresis: f64,
    is_high: bool,
}

impl Relay {
    /// Creates a relay with the outputs `amplitude` and `-amplitude`. It switches when the error
    /// exceeds `hysteresis` with the opposite sign. Both values are positive.
    pub const fn new(amplitude: f64, hysteresis: f64) -> Self {
        Self {
            amplitude,
            hysteresis,
            is_high: true,
        }
    }

    /// Returns the output for an error.
    pub fn update(&mut self, error: f64) -> f64 {
        if error > self.hysteresis {
            self.is_high = true;
        } else if error < -self.hysteresis {
            self.is_high = false;
        }
        if self.is_high {
            self.amplitude
        } else {
            -self.amplitude
        }
    }

    /// Returns the ultimate point of an axis with this oscillation, by the describing function:
    /// `Ku = 4 d / (pi sqrt(a^2 - h^2))`. Returns `None` if the oscillation is within the
    /// hysteresis.
    pub fn ultimate(&self, oscillation: &Oscillation) -> Option<Ultimate> {
        let (a, h) = (oscillation.amplitude, self.hysteresis);
        let square = a * a - h * h;
        (square > 0.0).then(|| Ultimate {
            gain: 4.0 * self.amplitude / (core::f64::consts::PI * square_root(square)),
            period_s: oscillation.period_s,
        })
    }
}

/// Computes a square root by Newton's method, because `core` has none. `square` is positive.
fn square_root(square: f64) -> f64 {
    // The iteration falls from above the root. A start 2^500 too large is halved 500 times.
    let mut root = if square > 1.0 { square } else { 1.0 };
    for _ in 0..1100 {
        let next = 0.5 * (root + square / root);
        if next >= root {
            break;
        }
        root = next;
    }
    root
}

/// A steady oscillation.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Oscillation {
    /// Half the distance from the lowest to the highest value.
    pub amplitude: f64,
    /// The mean period, in seconds.
    pub period_s: f64,
    /// Number of whole periods measured.
    pub periods: u32,
}

/// Returns the oscillation of `samples` about `middle`. `samples` are `period_s` seconds apart and
/// should not include the start of the experiment. Returns `None` without a whole period.
///
/// Periods are counted between upward zero crossings. The crossings are interpolated between
/// samples, so the mean period is exact to a small fraction of a sample.
///
/// # Examples
/// ```
/// use husillo_pid::tuning::oscillation;
///
/// let triangle = [0.0, 1.0, 0.0, -1.0].repeat(10);
/// let found = oscillation(&triangle, 0.25, 0.0).unwrap();
/// assert_eq!((found.amplitude, found.period_s, found.periods), (1.0, 1.0, 8));
/// ```
pub fn oscillation(samples: &[f64], period_s: f64, middle: f64) -> Option<Oscillation> {
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    let (mut first, mut last, mut passages) = (None, 0.0, 0_u32);
    let (mut before, mut time) = (f64::NAN, 0.0_f64);
    for sample in samples {
        let sample = sample - middle;
        (low, high) = (low.min(sample), high.max(sample));
        if before < 0.0 && sample >= 0.0 {
            last = time - sample / (sample - before);
            first = first.or(Some(last));
            passages = passages.saturating_add(1);
        }
        before = sample;
        time += 1.0;
    }
    let periods = passages.saturating_sub(1);
    (periods > 0).then(|| Oscillation {
        amplitude: (high - low) / 2.0,
        period_s: (last - first.unwrap_or(last)) * period_s / f64::from(periods),
        periods,
    })
}

/// The ultimate point: an axis under proportional control alone oscillates steadily there.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Ultimate {
    /// Ku, the proportional gain.
    pub gain: f64,
    /// Tu, the period, in seconds.
    pub period_s: f64,
}

/// A rule that computes gains from an ultimate point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Rule {
    /// `0.5 Ku`. Ziegler and Nichols, *Optimum settings for automatic controllers*, Trans. ASME 64
    /// (1942).
    ZieglerNicholsP,
    /// `0.45 Ku, Ti = Tu / 1.2`. The same.
    ZieglerNicholsPi,
    /// `0.6 Ku, Ti = Tu / 2, Td = Tu / 8`. The same.
    ZieglerNicholsPid,
    /// `Ku / 3.2, Ti = 2.2 Tu`. Tyreus and Luyben, *Tuning PI controllers for integrator/dead time
    /// processes*, Ind. Eng. Chem. Res. 31 (1992).
    TyreusLuybenPi,
    /// `Ku / 2.2, Ti = 2.2 Tu, Td = Tu / 6.3`. Luyben and Luyben, *Essentials of Process Control*
    /// (1997).
    TyreusLuybenPid,
}

impl Ultimate {
    /// Returns the gains of a rule, per second: Kp, Ki = Kp / Ti, Kd = Kp Td.
    pub fn gains(&self, rule: Rule) -> Gains<f64> {
        // Kp / Ku, Tu / Ti, Td / Tu
        let [gain, integral, derivative] = match rule {
            Rule::ZieglerNicholsP => [0.5, 0.0, 0.0],
            Rule::ZieglerNicholsPi => [0.45, 1.2, 0.0],
            Rule::ZieglerNicholsPid => [0.6, 2.0, 0.125],
            Rule::TyreusLuybenPi => [1.0 / 3.2, 1.0 / 2.2, 0.0],
            Rule::TyreusLuybenPid => [1.0 / 2.2, 1.0 / 2.2, 1.0 / 6.3],
        };
        let proportional = gain * self.gain;
        Gains {
            proportional,
            integral: proportional * integral / self.period_s,
            derivative: proportional * derivative * self.period_s,
        }
    }
}

impl Gains<f64> {
    /// Converts gains per second to gains per sample: `Ki T`, `Kd / T`.
    pub fn per_sample(self, period_s: f64) -> Self {
        Self {
            integral: self.integral * period_s,
            derivative: self.derivative / period_s,
            ..self
        }
    }

    /// Converts gains per sample, in PWM per count, to the integers of the servo law: `256 Kp`,
    /// `256 Kd` and `65536 Ki`, rounded to the nearest. The law divides its total by 256, hence the
    /// larger factor of Ki. Limits stay 0. Returns `None` if a gain is negative, above 0x7FFF or
    /// not finite.
    ///
    /// # Examples
    /// ```
    /// use husillo_pid::Gains;
    ///
    /// let gains = Gains {
    ///     proportional: 7.8125,
    ///     integral: 0.003,
    ///     derivative: 62.5,
    /// }.to_servo().unwrap();
    /// assert_eq!((gains.proportional, gains.integral, gains.derivative), (2000, 197, 16000));
    /// ```
    pub fn to_servo(self) -> Option<ServoGains> {
        let whole = |gain: f64, unit: f64| {
            let scaled = gain * unit + 0.5;
            // Also false for NaN. The cast drops the fraction.
            (gain >= 0.0 && scaled < 32_768.0).then_some(scaled as u16)
        };
        Some(ServoGains {
            proportional: whole(self.proportional, 256.0)?,
            derivative: whole(self.derivative, 256.0)?,
            integral: whole(self.integral, 65_536.0)?,
            ..ServoGains::default()
        })
    }

    /// Converts to the nearest gains of a fixed-point type. Returns `None` if one does not fit or
    /// is not finite.
    pub fn to_fixed<G: Fixed>(self) -> Option<Gains<G>> {
        let fixed = |gain: f64| gain.is_finite().then(|| G::checked_from_num(gain))?;
        Some(Gains {
            proportional: fixed(self.proportional)?,
            integral: fixed(self.integral)?,
            derivative: fixed(self.derivative)?,
        })
    }
}

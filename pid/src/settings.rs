//! Settings of a controller: gains, integration rule, limits.

use core::fmt;

use crate::number::{Number, Word};

/// Gains per sample of the parallel form `u = proportional e + integral sum(e) + derivative (e - e
/// before)`.
///
/// With gains per second and the period T in seconds: `integral = Ki T`, `derivative = Kd / T`. The
/// unit is the last digit of the output per last digit of the error, because signal and output have
/// the same type.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Gains<G> {
    /// Kp.
    pub proportional: G,
    /// Ki T: the weight of one sample in the sum.
    pub integral: G,
    /// Kd / T: the weight of the difference of two samples.
    pub derivative: G,
}

impl<G: Number> Gains<G> {
    /// Converts gains per second to gains per sample: `proportional` is Kp, `integral` is Ki in
    /// 1/s, `derivative` is Kd in s. Each is rounded to the last digit of its type. `Gains<f64>`
    /// has [`per_sample`](Gains::per_sample).
    ///
    /// # Errors
    /// [`SettingsError::GainsTooLarge`] if a gain per sample does not fit in its type, or if the
    /// period is 0.
    ///
    /// # Examples
    /// ```
    /// use fixed::types::I16F16;
    /// use husillo_pid::Gains;
    ///
    /// let gains = Gains {
    ///     proportional: I16F16::from_num(2),
    ///     integral: I16F16::from_num(500), // 1/s
    ///     derivative: I16F16::lit("0.0078125"), // s
    /// };
    /// let each_512_us = gains.per_sample_ns(512_000)?;
    /// assert_eq!(each_512_us.integral, I16F16::lit("0.256"));
    /// assert_eq!(each_512_us.derivative, I16F16::lit("15.2587890625"));
    /// # Ok::<(), husillo_pid::SettingsError>(())
    /// ```
    pub fn per_sample_ns(self, period_ns: u32) -> Result<Gains<G>, SettingsError> {
        let scaled = |gain: G, by, over| {
            let word = gain.to_word().scaled(by, over);
            let word = word.ok_or(SettingsError::GainsTooLarge)?;
            let scaled = G::from_word(word);
            // A type of fewer bits than its register saturates.
            if scaled.to_word() == word {
                Ok(scaled)
            } else {
                Err(SettingsError::GainsTooLarge)
            }
        };
        if period_ns == 0 {
            return Err(SettingsError::GainsTooLarge);
        }
        Ok(Gains {
            proportional: self.proportional,
            integral: scaled(self.integral, period_ns, 1_000_000_000)?,
            derivative: scaled(self.derivative, 1_000_000_000, period_ns)?,
        })
    }
}

/// The integration rule.
///
/// Textbooks disagree on the names. Kuo, *Digital Control Systems*, and the original controller
/// call T/(z-1) the backward difference. The names here are the current ones, and each rule has a
/// constant named after its formula.
///
/// # Source
/// Franklin, Powell, Workman, *Digital Control of Dynamic Systems*, 3rd ed., 6.1; Astrom and
/// Wittenmark, *Computer-Controlled Systems*, 3rd ed., 8.2.
///
/// # Examples
/// ```
/// use husillo_pid::Integration;
///
/// assert_eq!(Integration::T_OVER_Z_MINUS_1, Integration::Forward);
/// assert_eq!(Integration::Bilinear.formula(), "T/2 (z+1)/(z-1)");
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Integration {
    /// Euler forward, T/(z-1): `I[k] = I[k-1] + Ki T e[k-1]`. An error takes effect in the next
    /// sample.
    Forward,
    /// Euler backward, T z/(z-1): `I[k] = I[k-1] + Ki T e[k]`. An error takes effect in the same
    /// sample.
    #[default]
    Backward,
    /// Bilinear (Tustin, trapezoidal), T/2 (z+1)/(z-1): `I[k] = I[k-1] + Ki T/2 (e[k] + e[k-1])`.
    /// The mean of the two others.
    Bilinear,
}

impl Integration {
    /// T/(z-1), [`Forward`](Self::Forward).
    pub const T_OVER_Z_MINUS_1: Self = Self::Forward;
    /// T z/(z-1), [`Backward`](Self::Backward).
    pub const TZ_OVER_Z_MINUS_1: Self = Self::Backward;
    /// T/2 (z+1)/(z-1), [`Bilinear`](Self::Bilinear).
    pub const HALF_T_Z_PLUS_1_OVER_Z_MINUS_1: Self = Self::Bilinear;

    /// Returns the transfer function without its gain.
    pub const fn formula(self) -> &'static str {
        match self {
            Self::Forward => "T/(z-1)",
            Self::Backward => "Tz/(z-1)",
            Self::Bilinear => "T/2 (z+1)/(z-1)",
        }
    }
}

impl fmt::Display for Integration {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.formula())
    }
}

/// The lowest and the highest value of an output, in the output's unit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Limits<S> {
    /// The lowest.
    pub low: S,
    /// The highest.
    pub high: S,
}

/// Error of settings that are out of range.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum SettingsError {
    /// The magnitudes of the gains, in units of their last digit, add up to more than 2^29 (of
    /// 64 bits: 2^61; `f32`: a gain is not finite).
    GainsTooLarge,
    /// The gains have more than 29 fractional bits, or those of 64 bits more than 61.
    FractionTooFine,
    /// The low limit is above the high one, or one is not a number.
    LimitsCrossed,
}

impl fmt::Display for SettingsError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::GainsTooLarge => "gains too large for their type",
            Self::FractionTooFine => "gains with too many fractional bits",
            Self::LimitsCrossed => "low limit above high limit",
        })
    }
}

impl core::error::Error for SettingsError {}

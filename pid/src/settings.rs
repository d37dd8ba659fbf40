//! Settings of a controller: gains, integration rule, limits.

use core::fmt;

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
    /// The magnitudes of the gains, in units of their last digit, add up to more than 2^29 (`f32`:
    /// a gain is not finite).
    GainsTooLarge,
    /// The gains have more than 29 fractional bits.
    FractionTooFine,
    /// The low limit is above the high one, or one is not a number.
    LimitsCrossed,
}

impl fmt::Display for SettingsError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::GainsTooLarge => "gains too large for their type",
            Self::FractionTooFine => "gains with more than 29 fractional bits",
            Self::LimitsCrossed => "low limit above high limit",
        })
    }
}

impl core::error::Error for SettingsError {}

//! Coefficients of a filter from those in s.

use core::f64::consts::PI;
use core::fmt;

use super::tangent::tangent;

/// A transfer function of up to second order in s, in rad/s, ascending powers:
///
/// ```text
///        n0 + n1 s + n2 s^2
/// H(s) = ------------------
///        d0 + d1 s + d2 s^2
/// ```
///
/// All functions are `const`: computed in a constant, they cost the chip nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SecondOrder {
    /// n0, n1, n2.
    pub numerator: [f64; 3],
    /// d0, d1, d2.
    pub denominator: [f64; 3],
}

/// The coefficients of a [`Biquad`](super::Biquad): integers, with a common number of fractional
/// bits from 0 to 30.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Coefficients {
    numerator: [i32; 3],
    denominator: [i32; 2],
    bits: u32,
}

/// Why a filter cannot be made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum FilterError {
    /// A value is not finite, the sample rate is not above 0, or the denominator is 0.
    NotFinite,
    /// The matched frequency is not between 0 and half of the sample rate.
    AboveHalfTheRate,
    /// A pole is outside of the unit circle.
    Unstable,
    /// The magnitudes of the coefficients add up to 2^31 or more.
    TooLarge,
}

impl fmt::Display for FilterError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            FilterError::NotFinite => "a value is not finite, or no sample rate",
            FilterError::AboveHalfTheRate => "matched frequency not below half of the sample rate",
            FilterError::Unstable => "a pole outside of the unit circle",
            FilterError::TooLarge => "coefficients too large",
        })
    }
}

impl core::error::Error for FilterError {}

impl SecondOrder {
    /// A notch: gain 1, and 0 at `centre_hz`. `width_hz` is its width at a gain of 0.71.
    pub const fn notch(centre_hz: f64, width_hz: f64) -> SecondOrder {
        let [centre, width] = [2.0 * PI * centre_hz, 2.0 * PI * width_hz];
        SecondOrder {
            numerator: [centre * centre, 0.0, 1.0],
            denominator: [centre * centre, width, 1.0],
        }
    }

    /// A lead-lag: gain 1 at low frequencies, `pole_hz / zero_hz` at high ones. A zero below the
    /// pole is a lead, which adds phase between them.
    pub const fn lead_lag(zero_hz: f64, pole_hz: f64) -> SecondOrder {
        SecondOrder {
            numerator: [1.0, 1.0 / (2.0 * PI * zero_hz), 0.0],
            denominator: [1.0, 1.0 / (2.0 * PI * pole_hz), 0.0],
        }
    }

    /// A low-pass of second order. A damping of 0.71 is the flattest (Butterworth).
    pub const fn low_pass(corner_hz: f64, damping: f64) -> SecondOrder {
        let corner = 2.0 * PI * corner_hz;
        SecondOrder {
            numerator: [corner * corner, 0.0, 0.0],
            denominator: [corner * corner, 2.0 * damping * corner, 1.0],
        }
    }

    /// Samples the filter by the bilinear rule, s = K (z - 1) / (z + 1).
    ///
    /// With `matched_hz`, K is chosen so that the response is exact at that frequency
    /// (pre-warping). Without it, K is twice the sample rate: exact at 0 only.
    ///
    /// Coefficients are rounded to the last digit. Where n0 = d0, the gain at 0 stays exactly 1.
    ///
    /// # Errors
    /// See [`FilterError`].
    ///
    /// # Source
    /// Franklin, Powell, Workman, *Digital Control of Dynamic Systems*, 3rd ed., 6.1.
    pub const fn bilinear(
        self,
        sample_hz: f64,
        matched_hz: Option<f64>,
    ) -> Result<Coefficients, FilterError> {
        if !sample_hz.is_finite() || sample_hz <= 0.0 {
            return Err(FilterError::NotFinite);
        }
        let factor = match matched_hz {
            None => 2.0 * sample_hz,
            Some(matched) => {
                if !(matched > 0.0 && matched < sample_hz / 2.0) {
                    return Err(FilterError::AboveHalfTheRate);
                }
                2.0 * PI * matched / tangent(PI * matched / sample_hz)
            }
        };
        let [b0, b1, b2] = in_z(self.numerator, factor);
        let [a0, a1, a2] = in_z(self.denominator, factor);
        let real = [b0 / a0, b1 / a0, b2 / a0, a1 / a0, a2 / a0];
        let mut sum = 0.0;
        let mut index = 0;
        while index < 5 {
            sum += magnitude(real, index);
            index += 1;
        }
        if !sum.is_finite() {
            return Err(FilterError::NotFinite);
        }
        let has_unit_gain = self.numerator[0] == self.denominator[0] && self.numerator[0] != 0.0;
        Coefficients::rounded(real, sum, has_unit_gain)
    }
}

/// The polynomial in z (descending powers) of p0 + p1 s + p2 s^2 times (z + 1)^2.
const fn in_z([p0, p1, p2]: [f64; 3], factor: f64) -> [f64; 3] {
    let [first, second] = [p1 * factor, p2 * factor * factor];
    [
        p0 + first + second,
        2.0 * (p0 - second),
        p0 - first + second,
    ]
}

const fn magnitude([b0, b1, b2, a1, a2]: [f64; 5], index: usize) -> f64 {
    match index {
        0 => b0.abs(),
        1 => b1.abs(),
        2 => b2.abs(),
        3 => a1.abs(),
        _ => a2.abs(),
    }
}

impl Coefficients {
    /// Rounds to as many fractional bits as the bound of the arithmetic allows: magnitudes add up
    /// to less than 2^31.
    const fn rounded(
        [b0, b1, b2, a1, a2]: [f64; 5],
        sum: f64,
        has_unit_gain: bool,
    ) -> Result<Coefficients, FilterError> {
        // Five roundings and the change of b1 add less than 8 digits.
        const MOST: f64 = ((1_u32 << 31) - 8) as f64;
        let (mut bits, mut scale) = (0, 1.0);
        if sum >= MOST {
            return Err(FilterError::TooLarge);
        }
        while bits < 30 && sum * scale * 2.0 < MOST {
            bits += 1;
            scale *= 2.0;
        }
        let [a1, a2] = [nearest(a1 * scale), nearest(a2 * scale)];
        let one = 1_i64 << bits;
        let at_0 = one.wrapping_add(a1 as i64).wrapping_add(a2 as i64);
        let at_half = one.wrapping_sub(a1 as i64).wrapping_add(a2 as i64);
        // The triangle of stability. Poles on the circle are integrators.
        if at_0 < 0 || at_half < 0 || a2 as i64 > one {
            return Err(FilterError::Unstable);
        }
        let [b0, b2] = [nearest(b0 * scale), nearest(b2 * scale)];
        let b1 = if has_unit_gain {
            at_0.wrapping_sub(b0 as i64).wrapping_sub(b2 as i64) as i32
        } else {
            nearest(b1 * scale)
        };
        Ok(Coefficients {
            numerator: [b0, b1, b2],
            denominator: [a1, a2],
            bits,
        })
    }

    /// b0, b1 and b2 in digits of 2^-[`bits`](Coefficients::bits).
    pub const fn numerator(&self) -> [i32; 3] {
        self.numerator
    }

    /// a1 and a2 in digits of 2^-[`bits`](Coefficients::bits); a0 is 1.
    pub const fn denominator(&self) -> [i32; 2] {
        self.denominator
    }

    /// The fractional bits.
    pub const fn bits(&self) -> u32 {
        self.bits
    }
}

/// The nearest integer of a number within `i32`.
const fn nearest(value: f64) -> i32 {
    // A conversion truncates, and saturates.
    if value < 0.0 {
        (value - 0.5) as i32
    } else {
        (value + 0.5) as i32
    }
}

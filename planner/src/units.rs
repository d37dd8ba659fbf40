//! Speeds, accelerations and lengths in units of a `fixed` type.

use core::num::NonZeroU32;

use fixed::traits::Fixed;
use fixed::types::I32F32;

use crate::Rates;
use crate::wide::divide;

/// Nanometres of a millimetre.
const MILLIMETRE: i64 = 1_000_000;

/// Nanoseconds of a second.
const SECOND: u32 = 1_000_000_000;

/// The nanometres of a length in millimetres, rounded to nearest. Speeds in mm/s, accelerations in
/// mm/s^2 and jerks in mm/s^3 convert in the same way, for [`Stretch`](crate::Stretch),
/// [`Junction`](crate::Junction) and [`JerkLimits`](crate::JerkLimits). `None` beyond 2^31 mm.
///
/// Digits below 2^-32 mm are dropped.
///
/// # Cost
/// Two products of 64 bits.
///
/// # Examples
/// ```
/// use husillo_planner::{fixed::types::I16F16, nanometres};
///
/// assert_eq!(nanometres(I16F16::lit("12.5")), Some(12_500_000)); // 12.5 mm/s
/// ```
pub fn nanometres<F: Fixed>(millimetres: F) -> Option<i64> {
    let bits = millimetres.checked_to_num::<I32F32>()?.to_bits();
    // The whole part times 10^6 is below 2^51, the fraction below 2^52.
    let whole = (bits >> 32).wrapping_mul(MILLIMETRE);
    let fraction = (bits & 0xffff_ffff).wrapping_mul(MILLIMETRE);
    Some(whole.wrapping_add(fraction.wrapping_add(1 << 31) >> 32))
}

/// The limits of a single move in units per second: millimetres, degrees, or turns.
///
/// # Examples
/// ```
/// use husillo_planner::{Trapezoid, UnitRates, fixed::types::U16F16};
///
/// let limits = UnitRates {
///     start: U16F16::ZERO,
///     top: U16F16::lit("12.5"), // mm/s
///     end: U16F16::ZERO,
///     acceleration: U16F16::lit("250"), // mm/s^2
/// };
/// // A timer of 1 MHz, and 400 steps per millimetre.
/// let rates = limits.rates(1_000_000, U16F16::lit("400")).unwrap();
/// assert_eq!((rates.top_rate_hz, rates.acceleration_hz_per_s), (5_000, 100_000));
/// assert_eq!(Trapezoid::new(&rates, 2_000)?.count(), 2_000);
/// # Ok::<(), husillo_planner::RatesError>(())
/// ```
#[derive(Copy, Clone, PartialEq, Eq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct UnitRates<F> {
    /// Speed at which the move begins; 0 is standstill.
    pub start: F,
    /// Highest speed.
    pub top: F,
    /// Highest speed at the end; 0 is standstill.
    pub end: F,
    /// Change of speed per second, both up and down.
    pub acceleration: F,
}

impl<F: Fixed> UnitRates<F> {
    /// The same limits in steps, each rounded to the nearest step per second. `None` if one of them
    /// is negative, or has no place in 32 bits.
    ///
    /// A top speed or an acceleration below half a step per second becomes 0, which the profiles
    /// refuse with [`RatesError::Zero`](crate::RatesError::Zero).
    ///
    /// # Cost
    /// Four products of 64 bits.
    pub fn rates<S: Fixed>(&self, timer_hz: u32, steps_per_unit: S) -> Option<Rates> {
        let scale = magnitude(steps_per_unit)?;
        let steps = |units: F| {
            // Below 2^126; it has 64 binary digits after its point.
            let product = u128::from(magnitude(units)?).wrapping_mul(scale.into());
            u32::try_from(product.wrapping_add(1 << 63) >> 64).ok()
        };
        Some(Rates {
            timer_hz,
            start_rate_hz: steps(self.start)?,
            top_rate_hz: steps(self.top)?,
            end_rate_hz: steps(self.end)?,
            acceleration_hz_per_s: steps(self.acceleration)?,
        })
    }
}

/// The period of a servo: converts counts per second to the units of [`ServoMotion`] and back.
///
/// [`ServoMotion`]: crate::ServoMotion
///
/// # Examples
/// ```
/// use husillo_planner::{ServoPeriod, fixed::types::I32F32};
///
/// // 2000 counts per turn: 1 turn/s and 4 turns/s^2, as in the data sheet of the PIC-SERVO.
/// let period = ServoPeriod::PIC_SERVO;
/// assert_eq!(period.velocity(I32F32::lit("2000")), Some(67_109));
/// assert_eq!(period.acceleration(I32F32::lit("8000")), Some(137));
/// assert_eq!(period.counts_per_s::<I32F32>(67_109), Some(I32F32::lit("2000.003815")));
/// ```
#[derive(Copy, Clone, PartialEq, Eq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ServoPeriod {
    ns: NonZeroU32,
}

impl ServoPeriod {
    /// The period of a PIC-SERVO module: 512 us.
    pub const PIC_SERVO: ServoPeriod = match ServoPeriod::new(512_000) {
        Some(period) => period,
        None => ServoPeriod {
            ns: NonZeroU32::MIN,
        },
    };

    /// A period of this many nanoseconds. `None` for 0.
    #[must_use]
    pub const fn new(ns: u32) -> Option<ServoPeriod> {
        match NonZeroU32::new(ns) {
            Some(ns) => Some(ServoPeriod { ns }),
            None => None,
        }
    }

    /// A velocity in counts per second as 2^-16 counts per period, rounded to nearest. `None` if it
    /// is negative, or has no place in 32 bits.
    ///
    /// # Cost
    /// A product and a division of 128 bits.
    pub fn velocity<F: Fixed>(self, counts_per_s: F) -> Option<u32> {
        // Below 2^95, with 32 binary digits after its point, of which 16 stay.
        let product = u128::from(magnitude(counts_per_s)?).wrapping_mul(self.ns.get().into());
        let half = u128::from(SECOND) << 15;
        u32::try_from(divide(product.wrapping_add(half), SECOND) >> 16).ok()
    }

    /// An acceleration in counts per second^2 as 2^-16 counts per period^2, rounded to nearest.
    /// `None` if it is negative, or has no place in 32 bits.
    ///
    /// # Cost
    /// Two products and two divisions of 128 bits.
    pub fn acceleration<F: Fixed>(self, counts_per_s2: F) -> Option<u32> {
        // Below 2^127.
        let product = u128::from(magnitude(counts_per_s2)?).wrapping_mul(self.square());
        // A division by each of two factors, rounded down, is one by their product.
        let half = (u128::from(SECOND) * u128::from(SECOND)) << 15;
        let quotient = divide(divide(product.wrapping_add(half), SECOND), SECOND);
        u32::try_from(quotient >> 16).ok()
    }

    /// A velocity of a servo in counts per second, to the nearest 2^-32, then down to the last
    /// digit of the type. `None` if it does not fit.
    ///
    /// # Cost
    /// A product and a division of 128 bits.
    pub fn counts_per_s<F: Fixed>(self, velocity: u32) -> Option<F> {
        let ns = self.ns.get();
        // Below 2^78.
        let product = (u128::from(velocity) * u128::from(SECOND)) << 16;
        value(divide(product.wrapping_add(u128::from(ns / 2)), ns))
    }

    /// An acceleration of a servo in counts per second^2, to the nearest 2^-32, then down to the
    /// last digit of the type. `None` if it does not fit.
    ///
    /// # Cost
    /// Two products and two divisions of 128 bits.
    pub fn counts_per_s2<F: Fixed>(self, acceleration: u32) -> Option<F> {
        let ns = self.ns.get();
        // Below 2^108.
        let second = u128::from(SECOND);
        let product = u128::from(acceleration)
            .wrapping_mul(second)
            .wrapping_mul(second)
            << 16;
        let half = self.square() >> 1;
        value(divide(divide(product.wrapping_add(half), ns), ns))
    }

    /// Its square, nanoseconds^2.
    fn square(self) -> u128 {
        u128::from(u64::from(self.ns.get()).wrapping_mul(self.ns.get().into()))
    }
}

/// A value that is not negative, in 2^-32. It is below 2^63.
fn magnitude<F: Fixed>(value: F) -> Option<u64> {
    u64::try_from(value.checked_to_num::<I32F32>()?.to_bits()).ok()
}

/// The value of this many 2^-32.
fn value<F: Fixed>(bits: u128) -> Option<F> {
    F::checked_from_num(I32F32::from_bits(i64::try_from(bits).ok()?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use fixed::types::{I8F8, I16F16, I48F16, U32F32};
    use proptest::prelude::*;

    /// Whether `given` is `exact / divisor` to the nearest whole number.
    fn is_nearest(given: u128, exact: u128, divisor: u128) -> bool {
        (given * divisor).abs_diff(exact) * 2 <= divisor
    }

    proptest! {
        #[test]
        fn millimetres_become_the_nearest_nanometre(bits: i64) {
            let nm = nanometres(I32F32::from_bits(bits)).unwrap();
            let error = (i128::from(nm) << 32) - i128::from(bits) * 1_000_000;
            prop_assert!(error.abs() <= 1 << 31);
        }

        #[test]
        fn rates_are_the_nearest_steps(units in 0_i64.., scale in 0_i64..) {
            let [top, scale] = [units, scale].map(I32F32::from_bits);
            let exact = top.to_bits() as u128 * scale.to_bits() as u128;
            let limits = UnitRates {
                start: I32F32::ZERO,
                top,
                end: I32F32::ZERO,
                acceleration: top,
            };
            match limits.rates(1, scale) {
                Some(rates) => {
                    prop_assert!(is_nearest(rates.top_rate_hz.into(), exact, 1 << 64));
                    prop_assert_eq!(rates.acceleration_hz_per_s, rates.top_rate_hz);
                    prop_assert_eq!((rates.start_rate_hz, rates.end_rate_hz), (0, 0));
                }
                None => prop_assert!(exact >> 63 >= (1 << 33) - 1),
            }
        }

        #[test]
        fn velocities_are_nearest_and_come_back(bits in 0_i64.., ns in 1_u32..) {
            let period = ServoPeriod::new(ns).unwrap();
            let exact = bits as u128 * u128::from(ns);
            let divisor = u128::from(SECOND) << 16;
            match period.velocity(I32F32::from_bits(bits)) {
                Some(velocity) => prop_assert!(is_nearest(velocity.into(), exact, divisor)),
                None => prop_assert!(exact / divisor >= u128::from(u32::MAX)),
            }
        }

        #[test]
        fn accelerations_are_nearest(bits in 0_i64.., ns in 1_u32..100_000_000) {
            let period = ServoPeriod::new(ns).unwrap();
            let exact = bits as u128 * u128::from(ns).pow(2);
            let divisor = u128::from(SECOND).pow(2) << 16;
            match period.acceleration(I32F32::from_bits(bits)) {
                Some(given) => {
                    let error = (u128::from(given) * divisor).abs_diff(exact);
                    prop_assert!(error <= divisor / 2);
                }
                None => prop_assert!(exact / divisor >= u128::from(u32::MAX)),
            }
        }

        /// A period of at most a second has no coarser units than a count per second.
        #[test]
        fn velocities_come_back(velocity: u32, ns in 1_000_u32..=SECOND) {
            let period = ServoPeriod::new(ns).unwrap();
            if let Some(rate) = period.counts_per_s::<I32F32>(velocity) {
                prop_assert_eq!(period.velocity(rate), Some(velocity));
            }
        }

        #[test]
        fn accelerations_come_back(acceleration: u32, ns in 100_000_u32..=SECOND) {
            let period = ServoPeriod::new(ns).unwrap();
            if let Some(rate) = period.counts_per_s2::<I32F32>(acceleration) {
                prop_assert_eq!(period.acceleration(rate), Some(acceleration));
            }
        }
    }

    #[test]
    fn what_has_no_place_is_none() {
        assert_eq!(nanometres(I48F16::from_num(1_i64 << 31)), None);
        assert_eq!(nanometres(I16F16::lit("-2.5")), Some(-2_500_000));
        let limits = UnitRates {
            start: I16F16::ZERO,
            top: I16F16::from_num(30_000),
            end: I16F16::ZERO,
            acceleration: I16F16::ONE,
        };
        assert_eq!(limits.rates(1_000_000, U32F32::from_num(200_000)), None);
        let backwards = UnitRates {
            end: I16F16::NEG_ONE,
            ..limits
        };
        assert_eq!(backwards.rates(1_000_000, U32F32::ONE), None);
        assert_eq!(limits.rates(1_000_000, I16F16::NEG_ONE), None);
        assert_eq!(ServoPeriod::new(0), None);
        let slow = ServoPeriod::new(u32::MAX).unwrap();
        assert_eq!(slow.velocity(I16F16::from_num(30_000)), None);
        assert_eq!(slow.velocity(I16F16::NEG_ONE), None);
        assert_eq!(ServoPeriod::PIC_SERVO.counts_per_s::<I8F8>(67_109), None);
        assert_eq!(
            ServoPeriod::new(1).unwrap().counts_per_s::<I32F32>(1 << 20),
            None
        );
    }
}

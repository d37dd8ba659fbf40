//! Order, sums and products of decimals: all exact.

use super::{Decimal, power};
use core::cmp::Ordering;
use core::ops::Neg;

/// By value. Equal values with other places, as `1.5` and `1.50`, are ordered by their places,
/// because they are not equal; [`Decimal::value_cmp`] compares values alone.
impl Ord for Decimal {
    fn cmp(&self, other: &Decimal) -> Ordering {
        self.value_cmp(*other).then(self.places.cmp(&other.places))
    }
}

impl PartialOrd for Decimal {
    fn partial_cmp(&self, other: &Decimal) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl From<i32> for Decimal {
    fn from(whole: i32) -> Decimal {
        Decimal {
            digits: whole.into(),
            places: 0,
        }
    }
}

/// The negative; that of 0 is 0.
impl Neg for Decimal {
    type Output = Decimal;

    fn neg(self) -> Decimal {
        Decimal {
            // Never `i64::MIN`.
            digits: self.digits.wrapping_neg(),
            places: self.places(),
        }
    }
}

impl Decimal {
    /// Compares values: `1.5` and `1.50` are equal.
    ///
    /// # Examples
    /// ```
    /// use core::cmp::Ordering;
    /// use husillo_gcode::Decimal;
    ///
    /// let [one, other] = [Decimal::new(15, 1), Decimal::new(150, 2)].map(Option::unwrap);
    /// assert_eq!(one.value_cmp(other), Ordering::Equal);
    /// assert!(one < Decimal::from(2) && one < other);
    /// ```
    pub fn value_cmp(self, other: Decimal) -> Ordering {
        match (self.aligned(other), other.aligned(self)) {
            (Some(one), Some(other)) => one.cmp(&other),
            // At most one of them is too large to be aligned: its magnitude is the larger one.
            (None, _) => 0.cmp(&self.digits).reverse(),
            (_, None) => 0.cmp(&other.digits),
        }
    }

    /// The exact sum, with the places of the number that has more. `None` if it does not fit.
    pub fn checked_add(self, other: Decimal) -> Option<Decimal> {
        let sum = self.aligned(other)?.checked_add(other.aligned(self)?)?;
        Decimal::new(i64::try_from(sum).ok()?, self.places().max(other.places()))
    }

    /// The exact difference, with the places of the number that has more. `None` if it does not
    /// fit.
    pub fn checked_sub(self, other: Decimal) -> Option<Decimal> {
        let difference = self.aligned(other)?.checked_sub(other.aligned(self)?)?;
        let places = self.places().max(other.places());
        Decimal::new(i64::try_from(difference).ok()?, places)
    }

    /// The exact product, with the places of both. `None` if it does not fit, or if it has more
    /// than [`Decimal::MAX_PLACES`] places.
    pub fn checked_mul(self, other: Decimal) -> Option<Decimal> {
        // At most 60.
        let places = self.places().wrapping_add(other.places());
        Decimal::new(self.digits.checked_mul(other.digits)?, places)
    }

    /// The digits with the places of `other`, if these are more. `None` only above 10^19, beyond
    /// all numbers with these places.
    fn aligned(self, other: Decimal) -> Option<i128> {
        let missing = other.places().saturating_sub(self.places());
        if missing == 0 || self.digits == 0 {
            return Some(self.digits.into());
        }
        // 10^19 is ten times 10^18: below 2^63 * 2^60 * 10 < 2^127.
        let (power, tens) = match power(missing) {
            Some(power) => (power, 1),
            None if missing == 19 => (power(18)?, 10),
            None => return None,
        };
        Some(
            i128::from(self.digits)
                .wrapping_mul(power.into())
                .wrapping_mul(tens),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn decimals() -> impl Strategy<Value = Decimal> {
        (any::<i64>(), 0_u32..64, 0_u8..=Decimal::MAX_PLACES)
            .prop_filter_map("no minimum", |(digits, shift, places)| {
                Decimal::new(digits >> shift, places)
            })
    }

    /// The value times 10^60, as digits in base 10^15 with a sign: compared without rounding.
    fn exact(value: Decimal) -> (bool, [u64; 6]) {
        let mut digits = [0_u64; 6];
        digits[5] = value.digits().unsigned_abs() % 1_000_000_000_000_000;
        digits[4] = value.digits().unsigned_abs() / 1_000_000_000_000_000;
        for _ in value.places()..60 {
            let mut carry = 0;
            for digit in digits.iter_mut().rev() {
                let tenfold = *digit * 10 + carry;
                carry = tenfold / 1_000_000_000_000_000;
                *digit = tenfold % 1_000_000_000_000_000;
            }
        }
        (value.digits() < 0, digits)
    }

    fn order(one: Decimal, other: Decimal) -> Ordering {
        match (exact(one), exact(other)) {
            ((false, one), (false, other)) => one.cmp(&other),
            ((true, one), (true, other)) => other.cmp(&one),
            ((true, _), _) => Ordering::Less,
            (_, (true, _)) => Ordering::Greater,
        }
    }

    proptest! {
        /// The order of values is exact, for any places.
        #[test]
        fn values_are_compared_exactly(one in decimals(), other in decimals()) {
            prop_assert_eq!(one.value_cmp(other), order(one, other));
            prop_assert_eq!(other.value_cmp(one), order(one, other).reverse());
            prop_assert_eq!(one.cmp(&other) == Ordering::Equal, one == other);
        }

        /// A sum can be taken back, and lies on the right side.
        #[test]
        fn sums_are_exact(one in decimals(), other in decimals()) {
            if let Some(sum) = one.checked_add(other) {
                let back = sum.checked_sub(other).unwrap();
                prop_assert_eq!(back.value_cmp(one), Ordering::Equal);
                prop_assert_eq!(sum.value_cmp(one), 0.cmp(&other.digits()).reverse());
                prop_assert_eq!(other.checked_add(one), Some(sum));
            }
            if let Some(product) = one.checked_mul(other) {
                let digits = i128::from(one.digits()) * i128::from(other.digits());
                prop_assert_eq!(i128::from(product.digits()), digits);
                prop_assert_eq!(product.places(), one.places() + other.places());
            }
            prop_assert_eq!((-one).value_cmp(-other), other.value_cmp(one));
        }
    }

    #[test]
    fn the_borders() {
        let [least, tiny, large] = [
            Decimal::new(1, 30),
            Decimal::new(i64::MAX, 30),
            Decimal::new(i64::MAX, 0),
        ]
        .map(Option::unwrap);
        assert_eq!(large.value_cmp(tiny), Ordering::Greater);
        assert_eq!((-large).value_cmp(tiny), Ordering::Less);
        assert_eq!(least.value_cmp(Decimal::ZERO), Ordering::Greater);
        assert_eq!(large.checked_add(Decimal::from(1)), None);
        assert_eq!(large.checked_add(least), None);
        assert_eq!(least.checked_mul(Decimal::new(1, 1).unwrap()), None);
        assert_eq!(Decimal::from(-3).digits(), -3);
    }
}

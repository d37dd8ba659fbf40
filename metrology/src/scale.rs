//! The length of a count of an encoder.

use crate::quantity::{self, Fraction, Quantity};
use husillo_sim::text::position;

/// The length of a count, if it is known. Amounts are then in nanometres, otherwise in counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Scale {
    count: Option<Fraction>,
}

impl Scale {
    /// `count` is the length of a count in nanometres. `None`: it is not known.
    pub const fn new(count: Option<Fraction>) -> Self {
        Self { count }
    }

    /// The length of a count in mm, if it is known.
    pub fn count_mm(self) -> Option<f64> {
        self.count.map(|nm| nm.num as f64 / nm.den as f64 / 1e6)
    }

    /// The unit of numbers that are read and printed.
    pub const fn unit(self) -> &'static str {
        match self.count {
            Some(_) => "mm",
            None => "counts",
        }
    }

    /// Reads a number. A number without a unit is in [`unit`](Self::unit).
    ///
    /// # Errors
    ///
    /// A sentence about the text.
    pub fn parse(self, text: &str) -> Result<Quantity, String> {
        if text.ends_with(|c: char| c.is_ascii_digit() || c == '.') {
            quantity::parse(&format!("{text} {}", self.unit()))
        } else {
            quantity::parse(text)
        }
    }

    /// A position or a length in counts, rounded to the nearest. `None`: the quantity is not a
    /// length, or does not fit.
    pub fn counts(self, quantity: Quantity) -> Option<i32> {
        match quantity {
            Quantity::Length(length) => i32::try_from(length.over(self.count?)?).ok(),
            Quantity::Steps(counts) => i32::try_from(counts.rounded()).ok(),
            _ => None,
        }
    }

    /// A length as an amount, rounded to the nearest.
    pub fn amount(self, quantity: Quantity) -> Option<i64> {
        match (quantity, self.count) {
            (Quantity::Length(length), Some(_)) => Some(length.rounded()),
            (Quantity::Steps(counts), None) => Some(counts.rounded()),
            (Quantity::Steps(counts), Some(count)) => Fraction::new(
                i128::from(counts.num) * i128::from(count.num),
                i128::from(counts.den) * i128::from(count.den),
            )
            .map(Fraction::rounded),
            _ => None,
        }
    }

    /// Counts as an amount.
    pub fn of_counts(self, counts: i64) -> i64 {
        let counts = Fraction {
            num: counts,
            den: 1,
        };
        self.amount(Quantity::Steps(counts)).unwrap_or(counts.num)
    }

    /// An amount in counts, rounded to the nearest.
    pub fn to_counts(self, amount: i64) -> i64 {
        let amount = Fraction {
            num: amount,
            den: 1,
        };
        self.count
            .and_then(|count| amount.over(count))
            .unwrap_or(amount.num)
    }

    /// A rate in counts/s as text with its unit.
    pub fn text_of_rate(self, rate: i64) -> String {
        format!("{}/s", self.text(self.of_counts(rate)))
    }

    /// A speed in counts/s, at least 1. `None`: the quantity is not a speed, or does not fit.
    pub fn rate(self, quantity: Quantity) -> Option<u32> {
        let rate = match quantity {
            Quantity::Rate(rate) => rate.rounded(),
            Quantity::Speed(nm_per_min) => {
                let count = self.count?;
                nm_per_min.over(Fraction {
                    num: count.num.checked_mul(60)?,
                    den: count.den,
                })?
            }
            _ => return None,
        };
        u32::try_from(rate).ok().filter(|rate| *rate > 0)
    }

    /// An acceleration in counts/s^2, at least 1. `None`: the quantity is not an acceleration, or
    /// does not fit.
    pub fn acceleration(self, quantity: Quantity) -> Option<u32> {
        let acceleration = match quantity {
            Quantity::Acceleration(acceleration) => acceleration.rounded(),
            Quantity::AxisAcceleration(nm_per_s2) => nm_per_s2.over(self.count?)?,
            _ => return None,
        };
        u32::try_from(acceleration).ok().filter(|value| *value > 0)
    }

    /// An amount as a number in the unit.
    pub fn number(self, amount: i64) -> f64 {
        match self.count {
            // Below 2^53 nm: exact before the division.
            Some(_) => amount as f64 / 1e6,
            None => amount as f64,
        }
    }

    /// An amount as text with its unit.
    pub fn text(self, amount: i64) -> String {
        match self.count {
            Some(_) => format!("{:.4} mm", self.number(amount)),
            None => position(amount, "count"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_units() {
        let known = Scale::new(Fraction::new(2000, 1));
        assert_eq!(known.parse("12.5").map(|q| known.counts(q)), Ok(Some(6250)));
        assert_eq!(
            known.parse("3 counts").map(|q| known.amount(q)),
            Ok(Some(6000))
        );
        assert_eq!(known.text(12_500_000), "12.5000 mm");
        let unknown = Scale::new(None);
        assert_eq!(
            unknown.parse("-300").map(|q| unknown.counts(q)),
            Ok(Some(-300))
        );
        assert_eq!(unknown.parse("3 mm").map(|q| unknown.counts(q)), Ok(None));
        assert_eq!((unknown.of_counts(7), known.of_counts(7)), (7, 14_000));
    }
}

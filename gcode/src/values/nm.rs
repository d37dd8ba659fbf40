//! Lengths and positions.

mod arithmetic;

use core::fmt::{self, Write};

/// A length or a position in nanometres. `Display` prints millimetres without trailing zeros.
#[derive(Copy, Clone, Eq, PartialEq, Ord, PartialOrd, Hash, Debug, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Nm(pub i64);

impl Nm {
    /// The largest magnitude of a coordinate: 2^50 nm, about 1126 km.
    ///
    /// The difference of two coordinates is then below 2^52 and the sum of two squares below 2^105,
    /// so all terms of the arc geometry fit in 128 bits.
    pub const LIMIT: Nm = Nm(1 << 50);

    /// The same length if its magnitude is at most [`Nm::LIMIT`].
    pub(crate) const fn within_limit(self) -> Option<Nm> {
        // One comparison: a value below -LIMIT wraps.
        let above = self.0.wrapping_add(Nm::LIMIT.0) as u64;
        if above <= 2 * Nm::LIMIT.0 as u64 {
            Some(self)
        } else {
            None
        }
    }
}

/// One coordinate; 0 for an axis that does not exist.
pub(crate) fn coordinate<const N: usize>(point: &[Nm; N], axis: usize) -> Nm {
    point.get(axis).copied().unwrap_or_default()
}

/// A length in an error: up to 4.29 m, or "more than that". Four bytes, where an [`Nm`] takes
/// eight.
#[derive(Copy, Clone, Eq, PartialEq, Ord, PartialOrd, Hash, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Measure(u32);

impl Measure {
    /// The magnitude of a length, limited to 2^32 - 1 nm.
    pub const fn of(length: Nm) -> Measure {
        let nm = length.0.unsigned_abs();
        Measure(if nm >> 32 == 0 { nm as u32 } else { u32::MAX })
    }

    /// Converts back to a length.
    pub const fn length(self) -> Nm {
        Nm(self.0 as i64)
    }
}

impl fmt::Display for Measure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0 == u32::MAX {
            f.write_str("more than ")?;
        }
        self.length().fmt(f)
    }
}

impl fmt::Display for Nm {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let magnitude = self.0.unsigned_abs();
        let sign = if self.0 < 0 { "-" } else { "" };
        let (whole, mut rest) = (magnitude / 1_000_000, magnitude % 1_000_000);
        write!(f, "{sign}{whole}")?;
        if rest == 0 {
            return Ok(());
        }
        f.write_str(".")?;
        while rest != 0 {
            // Below 10,000,000, so the digit is below 10.
            let tenfold = rest.wrapping_mul(10);
            let digit = b'0'.wrapping_add((tenfold / 1_000_000) as u8);
            f.write_char(char::from(digit))?;
            rest = tenfold % 1_000_000;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::string::ToString;

    #[test]
    fn prints_millimetres() {
        for (nm, text) in [
            (0, "0"),
            (1, "0.000001"),
            (-1_500_000, "-1.5"),
            (120_000_000, "120"),
            (1_010_000, "1.01"),
        ] {
            assert_eq!(Nm(nm).to_string(), text);
        }
        assert_eq!(Nm(i64::MIN).to_string(), "-9223372036854.775808");
    }
}

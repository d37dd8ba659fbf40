//! Exact conversion between nanometres and steps.

/// Travel per motor step as a reduced fraction of nanometres: `nm / steps`.
///
/// 140 nm per step is `140 / 1`; 107 steps per millimetre are `1_000_000 / 107`. Both are exact,
/// unlike "steps per millimetre" in binary floating point.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Scale {
    nm: u32,
    steps: u32,
}

impl Scale {
    /// Creates the scale on which `steps` motor steps move the load by `nm` nanometres. `None` if
    /// either is zero.
    pub const fn new(nm: u32, steps: u32) -> Option<Self> {
        let (mut a, mut b) = (nm, steps);
        while let Some(rest) = a.checked_rem(b) {
            a = b;
            b = rest;
        }
        // `a` is the greatest common divisor. It divides both, and is zero only when both are.
        match (nm.checked_div(a), steps.checked_div(a)) {
            (Some(nm), Some(steps)) if nm > 0 && steps > 0 => Some(Self { nm, steps }),
            _ => None,
        }
    }

    /// Numerator: nanometres of the reduced fraction.
    pub const fn nm(self) -> u32 {
        self.nm
    }

    /// Denominator: steps of the reduced fraction.
    pub const fn steps(self) -> u32 {
        self.steps
    }

    /// The step nearest to a position in nanometres, halves away from zero; `None` outside the
    /// range of `i32`.
    ///
    /// # Cost
    /// One multiplication and one division of 64 bits.
    #[inline]
    pub const fn nearest(self, at_nm: i64) -> Option<i32> {
        let Some(doubled) = at_nm.unsigned_abs().checked_mul(2 * self.steps as u64) else {
            return None;
        };
        let Some(sum) = doubled.checked_add(self.nm as u64) else {
            return None;
        };
        // `nm` is at least 1, so the division succeeds.
        let Some(magnitude) = sum.checked_div(2 * self.nm as u64) else {
            return None;
        };
        if magnitude > i32::MAX as u64 {
            return None;
        }
        Some(if at_nm < 0 {
            -(magnitude as i32)
        } else {
            magnitude as i32
        })
    }

    /// The position of a step in nanometres, halves away from zero.
    ///
    /// `|step| * nm <= 2^31 * 2^32 = 2^63` is formed in `u64`, so it cannot overflow.
    pub const fn position(self, step: i32) -> i64 {
        let product = step.unsigned_abs() as u64 * self.nm as u64;
        let divisor = self.steps as u64;
        let magnitude = match product.saturating_add(divisor / 2).checked_div(divisor) {
            Some(magnitude) => magnitude as i64,
            None => 0,
        };
        if step < 0 {
            magnitude.wrapping_neg()
        } else {
            magnitude
        }
    }

    /// Converts a position in nanometres to steps with `fraction_bits` (at most 31) bits after the
    /// point, halves away from zero; `None` where the result takes more than 62 bits.
    pub const fn nearest_fraction(self, at_nm: i64, fraction_bits: u8) -> Option<i64> {
        let magnitude = at_nm.unsigned_abs();
        let unit = self.nm as u64;
        // Whole millimetre-sized chunks first: `(magnitude % unit) * steps < 2^64`. The remainder
        // `< unit < 2^32` leaves room for up to 31 more fraction bits.
        let (Some(chunks), Some(rest)) = (magnitude.checked_div(unit), magnitude.checked_rem(unit))
        else {
            return None;
        };
        let part = rest * self.steps as u64;
        let (Some(whole), Some(rest)) = (part.checked_div(unit), part.checked_rem(unit)) else {
            return None;
        };
        let Some(steps) = chunks.checked_mul(self.steps as u64) else {
            return None;
        };
        let Some(steps) = steps.checked_add(whole) else {
            return None;
        };
        let bits = if fraction_bits > 31 {
            31
        } else {
            fraction_bits
        };
        if steps >> (62 - bits) != 0 {
            return None;
        }
        // rest < 2^32, so the shifted value is below 2^63.
        let Some(fraction) = (rest << bits).wrapping_add(unit / 2).checked_div(unit) else {
            return None;
        };
        // Below 2^62 and at most 2^31, so nothing wraps.
        let value = (steps << bits).wrapping_add(fraction) as i64;
        Some(if at_nm < 0 {
            value.wrapping_neg()
        } else {
            value
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reduces_and_refuses_zero() {
        assert_eq!(Scale::new(280, 2), Scale::new(140, 1));
        assert_eq!(Scale::new(0, 1), None);
        assert_eq!(Scale::new(1, 0), None);
    }

    #[test]
    fn rounds_halves_away_from_zero() {
        let micromill = Scale::new(140, 1).unwrap();
        assert_eq!(micromill.nearest(69), Some(0));
        assert_eq!(micromill.nearest(70), Some(1));
        assert_eq!(micromill.nearest(-70), Some(-1));
        assert_eq!(micromill.nearest(i64::MAX), None);
        assert_eq!(micromill.nearest(i64::MIN), None);
    }

    #[test]
    fn inverts_exact_positions_of_every_machine() {
        for scale in [
            Scale::new(140, 1),
            Scale::new(1_000_000, 107),
            Scale::new(1, 1),
        ] {
            let scale = scale.unwrap();
            for step in [0, 1, -1, 71_429, -71_429, i32::MAX, -i32::MAX] {
                let there = scale.position(step);
                assert_eq!(scale.nearest(there), Some(step), "{scale:?} {step}");
            }
        }
    }

    #[test]
    fn fractions_agree_with_whole_steps() {
        let drill = Scale::new(1_000_000, 107).unwrap();
        assert_eq!(drill.nearest_fraction(1_000_000, 16), Some(107 << 16));
        assert_eq!(drill.nearest_fraction(-500_000, 1), Some(-107));
        assert_eq!(drill.nearest_fraction(i64::MAX, 16), None);
    }
}

//! Lengths of vectors.

/// Length of a move that covers `straight` along these axes and `around` in the plane of two others
/// (0 for a straight line), in the same unit.
///
/// Accurate to half a unit or 2^-28 of the length, whichever is larger. At most 15 axes.
///
/// # Examples
/// ```
/// assert_eq!(husillo_interp::length(&[3_000, 4_000], 0), 5_000);
/// ```
#[cfg_attr(not(target_pointer_width = "64"), inline(never))]
pub fn length(straight: &[u64], around: u64) -> u64 {
    let largest = straight.iter().copied().fold(around, u64::max);
    let bits = 64 - largest.leading_zeros();
    // Every component is scaled to at most 30 bits: 16 squares of 60 bits fit in 64 bits. Small
    // components get extra bits below the point, so that the root rounds to nearest.
    let (down, up) = (bits.saturating_sub(30), 30_u32.saturating_sub(bits).min(8));
    let sum = straight
        .iter()
        .chain([&around])
        .fold(0u64, |sum, component| {
            let part = component >> down << up;
            sum.saturating_add(part.saturating_mul(part))
        });
    let half = (1u64 << up) >> 1;
    let root = square_root(sum).saturating_add(half) >> up;
    root.checked_shl(down).unwrap_or(u64::MAX)
}

/// floor(sqrt(`square`)). On 32-bit processors one bit at a time: at most 32 rounds, a sixth of the
/// code.
pub(crate) const fn square_root(square: u64) -> u64 {
    if cfg!(target_pointer_width = "64") {
        return square.isqrt();
    }
    digits(square)
}

/// The same root, digit by digit.
const fn digits(square: u64) -> u64 {
    let mut root = 0_u64;
    let mut rest = square;
    let mut bit = 1_u64 << 62;
    while bit > square && bit != 0 {
        bit >>= 2;
    }
    while bit != 0 {
        // root + bit <= square, except where rest is compared with it: below 2^63 in any case.
        let trial = root.wrapping_add(bit);
        root >>= 1;
        if rest >= trial {
            rest = rest.wrapping_sub(trial);
            root = root.wrapping_add(bit);
        }
        bit >>= 2;
    }
    root
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths() {
        assert_eq!(length(&[3], 4), 5);
        assert_eq!(length(&[1], 1), 1);
        assert_eq!(length(&[140, 140], 0), 198);
        assert_eq!(length(&[3 << 40], 4 << 40), 5 << 40);
        assert_eq!(length(&[], 0), 0);
    }

    #[test]
    fn both_roots_are_the_same() {
        let mut square = u64::MAX;
        while square > 0 {
            for square in [
                square,
                square.isqrt().pow(2),
                square.isqrt().pow(2).wrapping_sub(1),
            ] {
                assert_eq!(digits(square), square.isqrt(), "{square}");
            }
            square -= square.div_ceil(97);
        }
        assert_eq!(digits(0), 0);
    }
}

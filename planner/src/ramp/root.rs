//! Square root and reciprocal in one.

/// A speed and its reciprocal, from the square of the speed.
#[derive(Copy, Clone, Debug, Default)]
pub(crate) struct Root {
    /// The root, rounded to nearest, at most one unit off.
    pub(crate) speed: u32,
    /// 2^62 / (`speed` 2^`shift`), with a relative error of 2^-23; at most 2^31.
    pub(crate) inverse: u32,
    /// Leading zeros of the speed.
    pub(crate) shift: u8,
}

impl Root {
    /// Computes the root of `square`.
    ///
    /// # Cost
    /// Six 32-bit products, no division.
    ///
    /// # Source
    /// A third-order iteration for y = 1 / sqrt(x): with h = 1 - x y^2, the step is y (h / 2 + 3
    /// h^2 / 8), and the remaining error is 5 h^3 / 16 of y.
    pub(crate) fn of(square: u64) -> Root {
        if square == 0 {
            return Root {
                speed: 0,
                inverse: 1 << 31,
                shift: 31,
            };
        }
        let shift = square.leading_zeros() >> 1;
        // x = scaled / 2^64 is at least 1/4.
        let scaled = square.wrapping_shl(shift.wrapping_mul(2));
        let x = (scaled >> 32) as u32;
        let y = reciprocal(x);
        // At most 2^32 2^31.
        let root = (u64::from(x).wrapping_mul(y.into()) >> 30).min(u32::MAX.into());
        // The estimate has a relative error of 2^-23, so the remainder is below 2^42.
        let rest = scaled.wrapping_sub(root.wrapping_mul(root)) as i64;
        // rest / (2 root) = rest y 2^-63.
        let correction = (rest >> 12).wrapping_mul(y.into()) >> 51;
        let root = root.saturating_add_signed(correction).min(u32::MAX.into());
        let half = 1_u64.wrapping_shl(shift) >> 1;
        Root {
            speed: (root.wrapping_add(half).wrapping_shr(shift)) as u32,
            inverse: y,
            // At most 31.
            shift: shift as u8,
        }
    }
}

/// The root of `square`, rounded down.
///
/// # Cost
/// That of [`Root::of`] and one or two products, a third of that of `u64::isqrt` on a processor
/// without a division of 64 bits.
pub(crate) fn whole_root(square: u64) -> u32 {
    // At most a unit off.
    let root = Root::of(square).speed;
    let squared = |root: u32| u64::from(root).wrapping_mul(root.into());
    if squared(root) > square {
        return root.wrapping_sub(1);
    }
    match root.checked_add(1) {
        Some(next) if squared(next) <= square => next,
        _ => root,
    }
}

/// Returns 2^30 / sqrt(x / 2^32). `x` is at least 2^30.
fn reciprocal(x: u32) -> u32 {
    // The line 2.1328 - 1.2187 x, in units of 2^-15. Its error is at most 8.6 %.
    let high = x >> 16;
    let line = 69_887_u32.wrapping_sub(high.wrapping_mul(39_935) >> 16);
    // h = 1 - x y^2 in units of 2^-14 is at most 0.18. The remaining error is 1.9e-3.
    let square = line.wrapping_mul(line.min(65_535)) >> 16;
    let h = (1_i32 << 14).wrapping_sub((high.wrapping_mul(square.min(65_535)) >> 16) as i32);
    let part = (h >> 1).wrapping_add(h.wrapping_mul(h).wrapping_mul(3) >> 17);
    let first = (line as i32).wrapping_add((line as i32).wrapping_mul(part) >> 14);
    let y = (first as u32).min(65_535).wrapping_shl(15);
    // h in units of 2^-29 is at most 6e-3. The remaining error is 7e-8.
    let square = u64::from(y).wrapping_mul(y.into()) >> 31;
    let product = u64::from(x).wrapping_mul(square) >> 32;
    let h = (1_i32 << 29).wrapping_sub(product as i32);
    let short = h >> 14;
    let part = (h >> 1).wrapping_add(short.wrapping_mul(short).wrapping_mul(3) >> 4);
    let y = i64::from(y).wrapping_add(i64::from(y).wrapping_mul(part.into()) >> 29);
    y.clamp(1 << 30, 1 << 31) as u32
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::{Root, whole_root};

    fn check(square: u64) {
        let root = Root::of(square);
        let exact = square.isqrt();
        assert_eq!(u64::from(whole_root(square)), exact, "{square}");
        assert!(
            u64::from(root.speed).abs_diff(exact) <= 1,
            "{square}: {root:?} {exact}"
        );
        if square == 0 {
            return;
        }
        let scaled = (square as f64).sqrt() * f64::from(1_u32 << root.shift);
        let inverse = f64::from(root.inverse) * scaled / 62_f64.exp2();
        assert!(
            (inverse - 1.0).abs() < (-23_f64).exp2(),
            "{square}: {root:?} {inverse}"
        );
        assert!(root.inverse <= 1 << 31 && root.shift <= 31);
    }

    /// Random squares of all sizes, and all squares near powers of two and of whole numbers.
    #[test]
    fn roots_are_exact_to_a_unit() {
        let mut random = oorandom::Rand64::new(1);
        for _ in 0..1_000_000 {
            let number = random.rand_u64();
            check(number >> (random.rand_u64() % 64));
            let root = (number >> 32) >> (number % 32);
            for off in [u64::MAX, 0, 1] {
                check((root * root).wrapping_add(off));
            }
        }
        for bits in 0..64 {
            for off in 0..5 {
                check((1_u64 << bits).wrapping_add(off).wrapping_sub(2));
            }
        }
    }
}

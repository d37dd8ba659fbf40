//! Arcs: their centre, and how far the end is off the circle through the start. All in integers.

use crate::error::ErrorKind;
use crate::nm::Nm;

/// A plane of arcs.
#[derive(Copy, Clone, Eq, PartialEq, Debug, Default)]
pub enum Plane {
    /// G17.
    #[default]
    Xy,
    /// G18.
    Zx,
    /// G19.
    Yz,
}

impl Plane {
    /// Its axes in the order that makes clockwise clockwise: seen from the positive end of the third axis.
    pub const fn axes(self) -> [usize; 2] {
        match self {
            Plane::Xy => [0, 1],
            Plane::Zx => [2, 0],
            Plane::Yz => [1, 2],
        }
    }

    /// The axis across it.
    pub(crate) const fn across(self) -> usize {
        match self {
            Plane::Xy => 2,
            Plane::Zx => 1,
            Plane::Yz => 0,
        }
    }

    /// The letters of its centre words, in the order of [`Plane::axes`].
    pub(crate) const fn centre_letters(self) -> [u8; 2] {
        match self {
            Plane::Xy => [b'I', b'J'],
            Plane::Zx => [b'K', b'I'],
            Plane::Yz => [b'J', b'K'],
        }
    }

    /// Its name in lower case: `xy`, `zx` or `yz`.
    pub const fn name(self) -> &'static str {
        match self {
            Plane::Xy => "xy",
            Plane::Zx => "zx",
            Plane::Yz => "yz",
        }
    }
}

/// The sense of an arc, seen from the positive end of the axis across its plane.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
pub enum Direction {
    /// G2.
    Clockwise,
    /// G3.
    CounterClockwise,
}

/// An arc or a helix from the position before it. Start and end equal in the plane mean one full turn.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
pub struct Arc<const N: usize> {
    /// The end, machine frame.
    pub to: [Nm; N],
    /// The centre, machine frame, rounded once; entries outside the plane are those of the start.
    pub centre: [Nm; N],
    /// Its plane.
    pub plane: Plane,
    /// Its sense.
    pub direction: Direction,
    /// Complete extra turns: `P` less one.
    pub turns: u32,
    /// The radius where the program gives it (`R`), without sign; `None` with a centre, or for a half circle whose `R`
    /// was stretched to reach the end.
    pub radius: Option<Nm>,
    /// How far the radii at start and end differ, rounded to nm; for a stretched half circle how much `R` was short.
    pub mismatch: Nm,
    /// One unit of the last printed digit of the arc's words, the finest of them.
    pub resolution: Nm,
}

/// Rounds `value / 2^bits` to the nearest, halves away from zero; `bits` in 1..=100, |value| < 2^126.
pub(crate) fn shift_rounded(value: i128, bits: u32) -> i128 {
    let magnitude = value
        .unsigned_abs()
        .wrapping_add(1u128.wrapping_shl(bits.wrapping_sub(1)))
        .wrapping_shr(bits) as i128;
    if value < 0 {
        magnitude.wrapping_neg()
    } else {
        magnitude
    }
}

/// The largest integer whose square is at most `value`, by digits of two bits: no division.
pub(crate) fn root(value: u128) -> u64 {
    if let Ok(small) = u64::try_from(value) {
        return small.isqrt();
    }
    let (mut rest, mut result) = (value, 0u128);
    let mut bit = 1u128.wrapping_shl(126);
    while bit > value {
        bit >>= 2;
    }
    while bit != 0 {
        // result + bit <= rest whenever it is subtracted; both below 2^127.
        let trial = result.wrapping_add(bit);
        result >>= 1;
        if rest >= trial {
            rest = rest.wrapping_sub(trial);
            result = result.wrapping_add(bit);
        }
        bit >>= 2;
    }
    result as u64
}

/// `value / divisor` rounded down, by shifting and subtracting where it is wide; 0 for a divisor of 0.
pub(crate) fn divide(value: u128, divisor: u128) -> u128 {
    if let (Ok(value), Ok(divisor)) = (u64::try_from(value), u64::try_from(divisor)) {
        return u128::from(value.checked_div(divisor).unwrap_or(0));
    }
    if divisor == 0 || value < divisor {
        return 0;
    }
    let mut shift = divisor
        .leading_zeros()
        .saturating_sub(value.leading_zeros());
    let (mut rest, mut quotient) = (value, 0u128);
    loop {
        // divisor << shift has no more bits than value.
        let part = divisor.wrapping_shl(shift);
        quotient <<= 1;
        if rest >= part {
            rest = rest.wrapping_sub(part);
            quotient |= 1;
        }
        match shift.checked_sub(1) {
            Some(next) => shift = next,
            None => return quotient,
        }
    }
}

/// `x^2 + y^2` for components below 2^53.
pub(crate) fn square(x: i64, y: i64) -> u128 {
    let (x, y) = (x.unsigned_abs(), y.unsigned_abs());
    if (x | y) < 1 << 31 {
        // Two squares below 2^62.
        return u128::from(x.wrapping_mul(x).wrapping_add(y.wrapping_mul(y)));
    }
    let (x, y) = (u128::from(x), u128::from(y));
    x.wrapping_mul(x).wrapping_add(y.wrapping_mul(y))
}

/// The difference of two coordinates; both lie within [`Nm::LIMIT`], or the number was too large.
fn difference(to: Nm, from: Nm) -> Result<i64, ErrorKind> {
    let delta = to.0.checked_sub(from.0).ok_or(ErrorKind::NumberTooLarge)?;
    if delta.unsigned_abs() > 1 << 52 {
        Err(ErrorKind::NumberTooLarge)
    } else {
        Ok(delta)
    }
}

/// `| |start - centre| - |end - centre| |` rounded to nm, and the start radius rounded down.
///
/// It is the exact `|E^2 - S^2| / (e + s)`: nothing cancels, and the exact difference of squares corrects the last unit.
fn mismatch(start: [i64; 2], end: [i64; 2]) -> (Nm, Nm) {
    let [start, end] = [square(start[0], start[1]), square(end[0], end[1])];
    let radius = root(start);
    let apart = start.abs_diff(end);
    let nearest = if apart == 0 {
        0
    } else {
        let sum = u128::from(radius).wrapping_add(u128::from(root(end)));
        // The radii are rounded down, so the estimate is at most a little high: walk down while d - 1/2 > exact.
        let mut nearest = divide(apart, sum.max(1)).wrapping_add(1) as u64;
        while nearest > 0 && !reaches(start.min(end), apart, nearest) {
            nearest = nearest.wrapping_sub(1);
        }
        nearest
    };
    (Nm(nearest as i64), Nm(radius as i64))
}

/// Whether `sqrt(least + apart) - sqrt(least) >= d - 1/2` for d >= 1, exactly while it fits 128 bits.
///
/// With t = 2d - 1: 4 apart - t^2 >= 4 t sqrt(least), squared.
fn reaches(least: u128, apart: u128, d: u64) -> bool {
    let t = u128::from(d).wrapping_mul(2).wrapping_sub(1);
    let Some(left) = apart.wrapping_mul(4).checked_sub(t.wrapping_mul(t)) else {
        return false;
    };
    let exact = t
        .checked_mul(t)
        .and_then(|square| square.checked_mul(16))
        .and_then(|x| x.checked_mul(least));
    match (left.checked_mul(left), exact) {
        (Some(left), Some(right)) => left >= right,
        // 4 t sqrt(least) with the root rounded down, good to 4 t.
        _ => left >= t.wrapping_mul(4).wrapping_mul(u128::from(root(least))),
    }
}

/// What the geometry makes of an arc with a centre: the mismatch, or the verdict against it.
///
/// Refused when the radii differ by more than 0.5 mm, or by more than 5 um and 0.1 % of the radius: what other
/// controllers accept is accepted.
pub(crate) fn with_centre(from: [Nm; 2], to: [Nm; 2], centre: [Nm; 2]) -> Result<Nm, ErrorKind> {
    let start = [
        difference(from[0], centre[0])?,
        difference(from[1], centre[1])?,
    ];
    let end = [difference(to[0], centre[0])?, difference(to[1], centre[1])?];
    let (off, radius) = mismatch(start, end);
    if start == [0, 0] {
        return Err(ErrorKind::NoCentre);
    }
    // radius < 2^53, off < 2^53: no overflow.
    let refused = off.0 > 500_000 || (off.0 > 5_000 && off.0.wrapping_mul(1000) > radius.0);
    if refused {
        Err(ErrorKind::EndOffArc(off))
    } else {
        Ok(off)
    }
}

/// An arc given by its radius: the centre rounded once to nm, how short the radius was, and the mismatch left.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
pub(crate) struct ByRadius {
    pub(crate) centre: [Nm; 2],
    pub(crate) short: bool,
    pub(crate) mismatch: Nm,
}

/// The centre of the arc of this signed radius: negative radii mean the longer way round.
///
/// A radius up to 5 um and 1 % short of half the distance (a half circle printed with few digits) is stretched to it.
pub(crate) fn with_radius(
    from: [Nm; 2],
    to: [Nm; 2],
    radius: Nm,
    direction: Direction,
) -> Result<ByRadius, ErrorKind> {
    let chord = [difference(to[0], from[0])?, difference(to[1], from[1])?];
    if chord == [0, 0] {
        return Err(ErrorKind::RadiusToSamePoint);
    }
    let chord_square = square(chord[0], chord[1]);
    let magnitude = u128::from(radius.0.unsigned_abs());
    let four = magnitude.wrapping_mul(magnitude).wrapping_mul(4); // radius <= 2^50
    let (numerator, short) = match four.checked_sub(chord_square) {
        Some(rest) => (rest, Nm(0)),
        None => {
            // Half the chord, rounded up.
            let mut twice = u128::from(root(chord_square));
            if twice.wrapping_mul(twice) < chord_square {
                twice = twice.wrapping_add(1);
            }
            let least = twice.wrapping_add(1) >> 1;
            let missing = least.wrapping_sub(magnitude) as i64;
            // missing <= 5000 where it is multiplied.
            if missing > 5_000 || missing.wrapping_mul(100) > radius.0.saturating_abs() {
                return Err(ErrorKind::RadiusTooSmall(Nm(least as i64)));
            }
            (0, Nm(missing))
        }
    };
    // Left of the chord for the short way counter-clockwise; each of the other choice turns it over.
    let left = (direction == Direction::CounterClockwise) != (radius.0 < 0);
    let across = if left {
        [chord[1].wrapping_neg(), chord[0]]
    } else {
        [chord[1], chord[0].wrapping_neg()]
    };
    let mut centre = from;
    for ((centre, along), across) in centre.iter_mut().zip(chord).zip(across) {
        let side = scaled_by_root(across, numerator, chord_square);
        // along in 2^-6 like side, and both halved: 7 bits.
        let twice = i128::from(along).wrapping_shl(6).wrapping_add(side);
        let offset =
            i64::try_from(shift_rounded(twice, 7)).map_err(|_| ErrorKind::NumberTooLarge)?;
        *centre = centre
            .0
            .checked_add(offset)
            .and_then(|sum| Nm(sum).within_limit())
            .ok_or(ErrorKind::NumberTooLarge)?;
    }
    let start = [
        difference(from[0], centre[0])?,
        difference(from[1], centre[1])?,
    ];
    let end = [difference(to[0], centre[0])?, difference(to[1], centre[1])?];
    let off = if short.0 > 0 {
        short
    } else {
        mismatch(start, end).0
    };
    Ok(ByRadius {
        centre,
        short: short.0 > 0,
        mismatch: off,
    })
}

/// `factor * sqrt(numerator / denominator)` in 2^-6, truncated; the result is below 2^52 (twice a radius).
///
/// Both roots are taken of numbers shifted up to 126 or 127 bits, so they have 63 bits and the product is good to
/// 2^-61 of itself: far below the rounding that follows.
pub(crate) fn scaled_by_root(factor: i64, numerator: u128, denominator: u128) -> i128 {
    if factor == 0 || numerator == 0 || denominator == 0 {
        return 0;
    }
    let up = numerator.leading_zeros().saturating_sub(1) & !1;
    let down = denominator.leading_zeros().saturating_sub(1) & !1;
    let product = u128::from(factor.unsigned_abs())
        .wrapping_mul(u128::from(root(numerator.wrapping_shl(up))));
    let divisor = u128::from(root(denominator.wrapping_shl(down)));
    // value = product / divisor * 2^((down - up) / 2) <= 2^52, divisor < 2^64: the shifted product stays below 2^122,
    // the shifted divisor (at most 2^53 more) below 2^117.
    let magnitude = match down.checked_sub(up) {
        Some(more) => divide(
            product.wrapping_shl(more.wrapping_div(2).wrapping_add(6)),
            divisor,
        ),
        None => divide(
            product.wrapping_shl(6),
            divisor.wrapping_shl(up.wrapping_sub(down).wrapping_div(2)),
        ),
    } as i128;
    if factor < 0 {
        magnitude.wrapping_neg()
    } else {
        magnitude
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const fn point(x: i64, y: i64) -> [Nm; 2] {
        [Nm(x), Nm(y)]
    }

    #[test]
    fn roots_and_quotients() {
        for value in [
            0u128,
            1,
            2,
            3,
            4,
            u64::MAX as u128,
            1 << 64,
            (1 << 100) + 12345,
            (1 << 126) - 1,
        ] {
            let r = u128::from(root(value));
            assert!(r * r <= value && (r + 1) * (r + 1) > value, "{value}");
        }
        for (value, divisor) in [
            (1 << 100, 3),
            (u128::MAX, 1 << 90),
            ((1 << 90) - 1, 1 << 90),
            (12345, 0),
            (77, 7),
        ] {
            assert_eq!(
                divide(value, divisor),
                value.checked_div(divisor).unwrap_or(0)
            );
        }
    }

    #[test]
    fn mismatch_is_the_difference_of_radii() {
        // The micro mill's own example: 362.00 um against 362.5617 um.
        let off = with_centre(
            point(2_650_000, 3_040_000),
            point(2_969_000, 3_400_000),
            point(3_012_000, 3_040_000),
        );
        assert_eq!(off, Ok(Nm(559)));
        assert_eq!(
            with_centre(point(0, 0), point(2_000, 0), point(1_000, 0)),
            Ok(Nm(0))
        );
        assert_eq!(
            with_centre(point(0, 0), point(2_600_001, 0), point(1_000_000, 0)),
            Err(ErrorKind::EndOffArc(Nm(600_001)))
        );
        // 100 m radius, 0.4 mm off: within 0.1 %.
        let far = 100_000_000_000;
        assert_eq!(
            with_centre(point(far, 0), point(0, far + 400_000), point(0, 0)),
            Ok(Nm(400_000))
        );
        // 1000 km: still no overflow.
        let limit = Nm::LIMIT.0;
        assert!(with_centre(point(limit, limit), point(-limit, -limit), point(0, 0)) == Ok(Nm(0)));
        assert!(with_centre(point(i64::MAX, 0), point(i64::MIN, 0), point(0, 0)).is_err());
    }

    #[test]
    fn radius_gives_the_centre() {
        let centre = |to, radius, direction| {
            with_radius(point(0, 0), to, Nm(radius), direction).map(|arc| arc.centre)
        };
        let quarter = point(10, 10);
        assert_eq!(
            centre(quarter, 10, Direction::CounterClockwise),
            Ok(point(0, 10))
        );
        assert_eq!(centre(quarter, 10, Direction::Clockwise), Ok(point(10, 0)));
        assert_eq!(
            centre(quarter, -10, Direction::CounterClockwise),
            Ok(point(10, 0))
        );
        assert_eq!(
            centre(point(20, 0), 10, Direction::Clockwise),
            Ok(point(10, 0))
        );
        // 3-4-5: half chord 3, height 4, in metres and in hundreds of kilometres.
        for scale in [1_000_000_000, 100_000_000_000_000] {
            let to = point(6 * scale, 0);
            assert_eq!(
                centre(to, 5 * scale, Direction::CounterClockwise),
                Ok(point(3 * scale, 4 * scale))
            );
        }
        // A large radius and a chord of 1 nm: 1/2 rounds away from zero.
        assert_eq!(
            centre(point(1, 0), 1 << 49, Direction::CounterClockwise),
            Ok(point(1, 1 << 49))
        );
    }

    #[test]
    fn short_radius() {
        let arc = |radius| {
            with_radius(
                point(0, 0),
                point(2_000_000, 0),
                Nm(radius),
                Direction::Clockwise,
            )
        };
        assert_eq!(arc(900_000), Err(ErrorKind::RadiusTooSmall(Nm(1_000_000))));
        assert_eq!(arc(0), Err(ErrorKind::RadiusTooSmall(Nm(1_000_000))));
        assert_eq!(
            arc(999_000),
            Ok(ByRadius {
                centre: point(1_000_000, 0),
                short: true,
                mismatch: Nm(1_000)
            })
        );
        let same = with_radius(point(1, 1), point(1, 1), Nm(5), Direction::Clockwise);
        assert_eq!(same, Err(ErrorKind::RadiusToSamePoint));
    }
}

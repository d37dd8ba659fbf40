//! Arcs: their centre, and how far the end is off the circle through the start. All in integers.

use crate::error::ErrorKind;
use crate::nm::{Measure, Nm};
use crate::wide::{Ratio, product, root, square};

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
    #[cfg(feature = "extended")]
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

/// From one point to another; both lie within [`Nm::LIMIT`], or a number was too large.
#[cfg_attr(not(target_pointer_width = "64"), inline(never))]
fn between(from: [Nm; 2], to: [Nm; 2]) -> Result<[i64; 2], ErrorKind> {
    let mut delta = [0; 2];
    for (delta, (to, from)) in delta.iter_mut().zip(to.into_iter().zip(from)) {
        *delta = to.0.checked_sub(from.0).ok_or(ErrorKind::NumberTooLarge)?;
        if delta.unsigned_abs() > 1 << 52 {
            return Err(ErrorKind::NumberTooLarge);
        }
    }
    Ok(delta)
}

/// `| |start - centre| - |end - centre| |` in whole nanometres, off by at most 0.502 nm, and the start radius rounded down.
#[cfg_attr(not(target_pointer_width = "64"), inline(never))]
fn mismatch(start: [i64; 2], end: [i64; 2]) -> (Nm, Nm) {
    /// Places behind the point of the two roots.
    const BITS: u32 = 9;
    // Squares of at most 2^105 leave room for them.
    let [start, end] = [start, end].map(|[x, y]| root(square(x, y) << (2 * BITS)));
    let off = start.abs_diff(end).wrapping_add(1 << (BITS - 1)) >> BITS;
    (Nm(off as i64), Nm((start >> BITS) as i64))
}

/// What the geometry makes of an arc with a centre: the mismatch, or the verdict against it.
///
/// Refused when the radii differ by more than 0.5 mm, or by more than 5 um and 0.1 % of the radius: what other
/// controllers accept is accepted.
pub(crate) fn with_centre(from: [Nm; 2], to: [Nm; 2], centre: [Nm; 2]) -> Result<Nm, ErrorKind> {
    let (start, end) = (between(centre, from)?, between(centre, to)?);
    let (off, radius) = mismatch(start, end);
    if start == [0, 0] {
        return Err(ErrorKind::NoCentre);
    }
    // radius < 2^53, off < 2^53: no overflow.
    let refused = off.0 > 500_000 || (off.0 > 5_000 && off.0.wrapping_mul(1000) > radius.0);
    if refused {
        Err(ErrorKind::EndOffArc(Measure::of(off)))
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
    let chord = between(from, to)?;
    if chord == [0, 0] {
        return Err(ErrorKind::RadiusToSamePoint);
    }
    let chord_square = square(chord[0], chord[1]);
    let magnitude = radius.0.unsigned_abs();
    let diameter = magnitude << 1;
    let four = product(diameter, diameter); // radius <= 2^50
    let (numerator, short) = match four.checked_sub(chord_square) {
        Some(rest) => (rest, Nm(0)),
        None => {
            // Half the chord, rounded up.
            let mut twice = root(chord_square);
            if product(twice, twice) < chord_square {
                twice = twice.wrapping_add(1);
            }
            let least = twice.wrapping_add(1) >> 1;
            let missing = least.wrapping_sub(magnitude) as i64;
            // missing <= 5000 where it is multiplied.
            if missing > 5_000 || missing.wrapping_mul(100) > radius.0.saturating_abs() {
                return Err(ErrorKind::RadiusTooSmall(Measure::of(Nm(least as i64))));
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
    let ratio = Ratio::of_roots(numerator, chord_square);
    let mut centre = from;
    for ((centre, along), across) in centre.iter_mut().zip(chord).zip(across) {
        // Both below 2^53, in 2^-6: halved and rounded, halves away from zero.
        let twice = (along << 6).wrapping_add(ratio.of(across));
        let half = (twice.unsigned_abs().wrapping_add(1 << 6) >> 7) as i64;
        let offset = if twice < 0 { half.wrapping_neg() } else { half };
        *centre = centre
            .0
            .checked_add(offset)
            .and_then(|sum| Nm(sum).within_limit())
            .ok_or(ErrorKind::NumberTooLarge)?;
    }
    let (start, end) = (between(centre, from)?, between(centre, to)?);
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

#[cfg(test)]
mod tests {
    use super::*;

    const fn point(x: i64, y: i64) -> [Nm; 2] {
        [Nm(x), Nm(y)]
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
            Err(ErrorKind::EndOffArc(Measure::of(Nm(600_001))))
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
        assert_eq!(
            arc(900_000),
            Err(ErrorKind::RadiusTooSmall(Measure::of(Nm(1_000_000))))
        );
        assert_eq!(
            arc(0),
            Err(ErrorKind::RadiusTooSmall(Measure::of(Nm(1_000_000))))
        );
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

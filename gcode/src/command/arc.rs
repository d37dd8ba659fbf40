//! Arcs: the centre, and the distance of the end from the circle through the start. Everything is
//! in integers.

use crate::blocks::fault::{Fault, Reason};
use crate::codes::letters::Letters;
use crate::modal::modes::Units;
use crate::values::nm::{Nm, coordinate};
use crate::values::wide::{Ratio, WHOLE_DIGITS, product, root, root_to, square};

/// A plane of arcs.
#[derive(Copy, Clone, Eq, PartialEq, Debug, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
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
    /// Its two axes, in the order in which clockwise has its usual meaning if one looks from the
    /// positive end of the third axis.
    pub const fn axes(self) -> [usize; 2] {
        match self {
            Plane::Xy => [0, 1],
            Plane::Zx => [2, 0],
            Plane::Yz => [1, 2],
        }
    }

    /// The axis perpendicular to it.
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

    /// The letters of its centre words.
    pub(crate) const fn centre(self) -> Letters {
        match self {
            Plane::Xy => const { Letters::new(b"IJ") },
            Plane::Zx => const { Letters::new(b"IK") },
            Plane::Yz => const { Letters::new(b"JK") },
        }
    }

    /// The letter of the offset perpendicular to it.
    pub(crate) const fn offset_aside(self) -> u8 {
        match self {
            Plane::Xy => b'K',
            Plane::Zx => b'J',
            Plane::Yz => b'I',
        }
    }

    /// The letters that define an arc in it, and those of them that are axes.
    pub(crate) const fn shape(self) -> (Letters, Letters) {
        match self {
            Plane::Xy => const { (Letters::new(b"XYIJR"), Letters::new(b"XY")) },
            Plane::Zx => const { (Letters::new(b"ZXIKR"), Letters::new(b"ZX")) },
            Plane::Yz => const { (Letters::new(b"YZJKR"), Letters::new(b"YZ")) },
        }
    }

    /// The letters of an arc in it other than those of axes.
    pub(crate) const fn arc_letters(self) -> Letters {
        match self {
            Plane::Xy => const { Letters::new(b"IJRP") },
            Plane::Zx => const { Letters::new(b"IKRP") },
            Plane::Yz => const { Letters::new(b"JKRP") },
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

/// Sense of rotation of an arc, seen from the positive end of the axis perpendicular to its plane.
///
/// The same as `Direction` of `husillo-interp`. Crates of this level do not depend on each other,
/// so a `bool` connects them: [`Direction::is_clockwise`].
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Direction {
    /// G2.
    Clockwise,
    /// G3.
    CounterClockwise,
}

impl Direction {
    /// Whether it is G2.
    pub const fn is_clockwise(self) -> bool {
        matches!(self, Direction::Clockwise)
    }
}

/// An arc or a helix from the previous position. Equal start and end in the plane give one full
/// turn.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Arc<const N: usize> {
    /// The end, machine frame.
    pub to: [Nm; N],
    /// The centre, machine frame, rounded once; entries outside the plane are those of the start.
    pub centre: [Nm; N],
    /// Its plane.
    pub plane: Plane,
    /// Its sense.
    pub direction: Direction,
    /// Complete extra turns: `P` minus one.
    pub turns: u32,
    /// The programmed radius (`R`) without its sign. `None` with a centre, and for a half circle
    /// whose `R` was stretched to reach the end.
    pub radius: Option<Nm>,
    /// Difference of the radii at start and end, rounded to nm. For a stretched half circle, the
    /// amount by which `R` was too short.
    pub mismatch: Nm,
    /// One unit of the last printed digit of the words of the arc, the finest of them.
    pub resolution: Nm,
}

impl<const N: usize> Arc<N> {
    /// Creates a flat arc around a centre, all in the machine frame, as a line with `I` and `J` in
    /// these units does, including its checks. Returns `None` where such a line is refused: the end
    /// is not on the circle, or the start is the centre. Equal start and end give one full turn.
    ///
    /// The digits of the words are not known here, so they do not widen the tolerance
    /// ([`Arc::resolution`]).
    pub fn around(
        from: &[Nm; N],
        to: [Nm; N],
        centre: [Nm; N],
        plane: Plane,
        direction: Direction,
        units: Units,
    ) -> Option<Arc<N>> {
        let mut mismatch = Nm(0);
        with_centre(
            from,
            &to,
            &centre,
            plane.axes(),
            slack(units),
            &mut mismatch,
        )
        .ok()?;
        Some(Arc {
            to,
            centre,
            plane,
            direction,
            turns: 0,
            radius: None,
            mismatch,
            resolution: Nm(1),
        })
    }

    /// Start, end and centre in the two axes of its plane, in nanometres of the machine frame, as
    /// an interpolator takes them. `from` is the position before the arc.
    pub fn in_plane(&self, from: &[Nm; N]) -> [[i64; 2]; 3] {
        let axes = self.plane.axes();
        [from, &self.to, &self.centre].map(|at| axes.map(|axis| coordinate(at, axis).0))
    }
}

/// The distances between two points in the plane of two axes; false if one of the points is beyond
/// [`Nm::LIMIT`].
#[cfg_attr(not(target_pointer_width = "64"), inline(never))]
pub(crate) fn between<const N: usize>(
    from: &[Nm; N],
    to: &[Nm; N],
    axes: [usize; 2],
    way: &mut [i64; 2],
) -> bool {
    for (way, &axis) in way.iter_mut().zip(&axes) {
        let (from, to) = (coordinate(from, axis), coordinate(to, axis));
        let Some(delta) = to.0.checked_sub(from.0) else {
            return false;
        };
        *way = delta;
        if delta.unsigned_abs() > 1 << 52 {
            return false;
        }
    }
    true
}

/// Binary places of a distance.
const BITS: u32 = 9;

/// The distance of two points in 2^-9 nm, rounded down; 2^64 - 1 where one is beyond [`Nm::LIMIT`].
#[cfg_attr(not(target_pointer_width = "64"), inline(never))]
fn distance<const N: usize>(from: &[Nm; N], to: &[Nm; N], axes: [usize; 2]) -> u64 {
    let mut way = [0; 2];
    if !between(from, to, axes, &mut way) {
        return u64::MAX;
    }
    // The square is at most 2^105, its root below 2^53.
    root_to(square(way[0], way[1]), WHOLE_DIGITS + BITS).0
}

/// The difference of two distances in whole nanometres, off by at most 0.502 nm.
const fn apart(start: u64, end: u64) -> Nm {
    Nm((start.abs_diff(end).wrapping_add(1 << (BITS - 1)) >> BITS) as i64)
}

/// The slack of an arc in millimetres, nm: 2 x 0.01 mm x sqrt 2.
///
/// # Source
/// LinuxCNC, `interp_internal.hh`, `CENTER_ARC_RADIUS_TOLERANCE_MM`.
pub(crate) const SLACK_MM: i64 = 28_284;
/// The slack of an arc in inches, nm: 2 x 0.001 inch x sqrt 2.
///
/// # Source
/// LinuxCNC, `interp_internal.hh`, `CENTER_ARC_RADIUS_TOLERANCE_INCH`.
pub(crate) const SLACK_INCH: i64 = 71_842;
/// The most that one and a half printed digits count, nm: half a millimetre.
pub(crate) const SLACK_DIGITS: i64 = 500_000;
/// The slack of Grbl, and of lengths in micrometres, nm.
///
/// # Source
/// Grbl 1.1, `gcode.c`, error 33: 0.005 mm.
pub(crate) const SLACK_NARROW: i64 = 5_000;

/// The slack of an arc in these units, nm.
pub(crate) const fn slack(units: Units) -> i64 {
    match units {
        Units::Millimetres => SLACK_MM,
        Units::Inches => SLACK_INCH,
        Units::Micrometres => SLACK_NARROW,
    }
}

/// Checks the geometry of an arc with a centre: returns the mismatch, or an error.
///
/// An arc is refused when its radii differ by more than 100 times the slack, or by more than the
/// slack and 0.1 % of the radius at the start. This is the rule of Grbl. LinuxCNC takes 0.1 % of
/// the larger radius (`SPIRAL_RELATIVE_TOLERANCE`), which differs by 0.0001 % of the radius.
#[cfg_attr(not(target_has_atomic = "32"), inline(never))]
pub(crate) fn with_centre<const N: usize>(
    from: &[Nm; N],
    to: &[Nm; N],
    centre: &[Nm; N],
    axes: [usize; 2],
    slack: i64,
    mismatch: &mut Nm,
) -> Result<(), Fault> {
    let (start, end) = (distance(centre, from, axes), distance(centre, to, axes));
    // For a start out of range the difference is too large in any case.
    if end == u64::MAX {
        return Err(Fault::at_motion(Reason::NumberTooLarge));
    }
    if start == 0 {
        return Err(Fault::at_motion(Reason::NoCentre));
    }
    let off = apart(start, end);
    *mismatch = off;
    // start < 2^62 and off < 2^53, so there is no overflow.
    let radius = (start >> BITS) as i64;
    // A slack is below 2^40, a few digits of a word.
    if off.0 > slack.wrapping_mul(100) || (off.0 > slack && off.0.wrapping_mul(1000) > radius) {
        // Without axis words in the plane the arc is a full circle, which always fits.
        return Err(Fault::at_axes(Reason::EndOffArc));
    }
    Ok(())
}

/// Distance of the centre of an arc of this radius from the middle between its ends, as a multiple
/// of half the distance between the ends.
///
/// A radius up to 5 um and 1 % short of half the distance (a half circle printed with few digits)
/// is stretched to it; `short` is then the difference. With an error about the radius, it is the
/// least radius that reaches the end.
#[cfg_attr(not(target_has_atomic = "32"), inline(never))]
pub(crate) fn beside(
    chord: &[i64; 2],
    radius: Nm,
    short: &mut Nm,
    ratio: &mut Ratio,
) -> Result<(), Fault> {
    if chord[0] == 0 && chord[1] == 0 {
        return Err(Fault::at_motion(Reason::RadiusToSamePoint));
    }
    let chord_square = square(chord[0], chord[1]);
    let diameter = radius.0.unsigned_abs() << 1;
    let four = product(diameter, diameter); // radius <= 2^50
    let numerator = match four.checked_sub(chord_square) {
        Some(rest) => rest,
        None => {
            // Half the chord, rounded up: the least m with (2 m)^2 > chord^2 - 1.
            let least = (root(chord_square.wrapping_sub(1)) >> 1).wrapping_add(1) as i64;
            let missing = least.wrapping_sub(radius.0);
            // missing <= 5000 where it is multiplied.
            if missing > 5_000 || missing.wrapping_mul(100) > radius.0 {
                *short = Nm(least);
                return Err(Fault::at(Reason::RadiusTooSmall, b'R'));
            }
            *short = Nm(missing);
            0
        }
    };
    *ratio = Ratio::of_roots(numerator, chord_square);
    Ok(())
}

/// Converts the vector from the start to the end of an arc into the vector to its centre, rounded
/// once to nm. The centre is to the left of the vector to the end if `left`, otherwise to its
/// right.
#[cfg_attr(not(target_has_atomic = "32"), inline(never))]
pub(crate) fn turn(chord: &mut [i64; 2], ratio: &Ratio, left: bool) {
    let [x, y] = *chord;
    let (mut right, mut up) = (ratio.of(y), ratio.of(x));
    if left {
        right = right.wrapping_neg();
    } else {
        up = up.wrapping_neg();
    }
    for (way, across) in chord.iter_mut().zip(&[right, up]) {
        // Both below 2^53, in 2^-6: halved and rounded, halves away from zero.
        let twice = (*way << 6).wrapping_add(*across);
        *way = twice.wrapping_add(1 << 6).wrapping_add(twice >> 63) >> 7;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const fn point(x: i64, y: i64) -> [Nm; 2] {
        [Nm(x), Nm(y)]
    }

    fn centred(from: [Nm; 2], to: [Nm; 2], centre: [Nm; 2]) -> (Result<(), Fault>, Nm) {
        let mut off = Nm(0);
        let done = with_centre(&from, &to, &centre, [0, 1], SLACK_MM, &mut off);
        (done, off)
    }

    #[test]
    fn mismatch_is_the_difference_of_radii() {
        // The example of the micro mill: 362.00 um against 362.5617 um.
        let off = centred(
            point(2_650_000, 3_040_000),
            point(2_969_000, 3_400_000),
            point(3_012_000, 3_040_000),
        );
        assert_eq!(off, (Ok(()), Nm(559)));
        assert_eq!(
            centred(point(0, 0), point(2_000, 0), point(1_000, 0)),
            (Ok(()), Nm(0))
        );
        assert_eq!(
            centred(point(0, 0), point(2_600_001, 0), point(1_000_000, 0)),
            (Err(Fault::at_axes(Reason::EndOffArc)), Nm(600_001))
        );
        // 100 m radius, 0.4 mm off: within 0.1 %.
        let far = 100_000_000_000;
        assert_eq!(
            centred(point(far, 0), point(0, far + 400_000), point(0, 0)),
            (Ok(()), Nm(400_000))
        );
        // 1000 km: still without overflow.
        let limit = Nm::LIMIT.0;
        assert_eq!(
            centred(point(limit, limit), point(-limit, -limit), point(0, 0)),
            (Ok(()), Nm(0))
        );
        let (done, _) = centred(point(i64::MAX, 0), point(i64::MIN, 0), point(0, 0));
        assert!(done.is_err());
    }

    /// The centre, and the amount by which the radius was too short.
    fn by_radius(
        from: [Nm; 2],
        to: [Nm; 2],
        radius: i64,
        direction: Direction,
    ) -> (Result<[Nm; 2], Fault>, Nm) {
        let (mut way, mut short) = ([0; 2], Nm(0));
        assert!(between(&from, &to, [0, 1], &mut way));
        let left = (direction == Direction::CounterClockwise) != (radius < 0);
        let mut ratio = Ratio::NONE;
        let done = beside(&way, Nm(radius.abs()), &mut short, &mut ratio);
        turn(&mut way, &ratio, left);
        let centre = [Nm(from[0].0 + way[0]), Nm(from[1].0 + way[1])];
        (done.map(|()| centre), short)
    }

    #[test]
    fn radius_gives_the_centre() {
        let centre = |to, radius, direction| by_radius(point(0, 0), to, radius, direction).0;
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
            by_radius(
                point(0, 0),
                point(2_000_000, 0),
                radius,
                Direction::Clockwise,
            )
        };
        let small = Err(Fault::at(Reason::RadiusTooSmall, b'R'));
        assert_eq!(arc(900_000), (small, Nm(1_000_000)));
        assert_eq!(arc(0), (small, Nm(1_000_000)));
        assert_eq!(arc(999_000), (Ok(point(1_000_000, 0)), Nm(1_000)));
        // Half of an odd chord, rounded up, and of one whose square is none.
        let (_, least) = by_radius(point(0, 0), point(2_000_001, 0), 0, Direction::Clockwise);
        assert_eq!(least, Nm(1_000_001));
        let (_, least) = by_radius(point(0, 0), point(3, 3), 0, Direction::Clockwise);
        assert_eq!(least, Nm(3));
        let (same, _) = by_radius(point(1, 1), point(1, 1), 5, Direction::Clockwise);
        assert_eq!(same, Err(Fault::at_motion(Reason::RadiusToSamePoint)));
    }
}

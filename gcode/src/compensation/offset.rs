//! Plane geometry of compensated contours, in integers: unit vectors in 2^-58, points in
//! nanometres.

use crate::values::wide::{Ratio, divide, root, shift_rounded, square};

/// A point or a vector of the plane, nm; components below 2^52.
pub(crate) type Vector = [i64; 2];

/// Bits behind the point of a unit vector.
const BITS: u32 = 58;

pub(crate) fn minus(a: Vector, b: Vector) -> Vector {
    [a[0].saturating_sub(b[0]), a[1].saturating_sub(b[1])]
}

pub(crate) fn plus(a: Vector, b: Vector) -> Vector {
    [a[0].saturating_add(b[0]), a[1].saturating_add(b[1])]
}

/// A quarter turn counter-clockwise.
pub(crate) const fn left(a: Vector) -> Vector {
    [a[1].wrapping_neg(), a[0]]
}

pub(crate) const fn opposite(a: Vector) -> Vector {
    [a[0].wrapping_neg(), a[1].wrapping_neg()]
}

/// Products of components below 2^59: below 2^119.
pub(crate) fn dot(a: Vector, b: Vector) -> i128 {
    let product = |a: i64, b: i64| i128::from(a).wrapping_mul(i128::from(b));
    product(a[0], b[0]).wrapping_add(product(a[1], b[1]))
}

pub(crate) fn cross(a: Vector, b: Vector) -> i128 {
    dot(left(a), b)
}

pub(crate) fn length(a: Vector) -> i64 {
    root(square(a[0], a[1])) as i64
}

/// The unit vector of a direction; zero for no direction.
pub(crate) fn unit(a: Vector) -> Vector {
    let whole = square(a[0], a[1]);
    a.map(|part| {
        // 2^52 in 2^-6 is 2^58.
        let magnitude = if part == 0 {
            0
        } else {
            Ratio::of_roots(square(part, 0), whole).of(1 << 52)
        };
        if part < 0 {
            magnitude.wrapping_neg()
        } else {
            magnitude
        }
    })
}

/// A unit vector times a length below 2^52, rounded once.
pub(crate) fn along(direction: Vector, by: i64) -> Vector {
    direction.map(|part| shift_rounded(i128::from(part).wrapping_mul(i128::from(by)), BITS) as i64)
}

/// Sine and cosine of the turn from one unit vector to another, in 2^-58.
pub(crate) fn turn(from: Vector, to: Vector) -> (i64, i64) {
    let narrow = |wide: i128| shift_rounded(wide, BITS) as i64;
    (narrow(cross(from, to)), narrow(dot(from, to)))
}

/// From a corner to the point at this distance from both of its sides:
/// `(n1 + n2) * by / (1 + n1 n2)`, rounded once. `None` where the path reverses.
pub(crate) fn mitre(first: Vector, second: Vector, by: i64) -> Option<Vector> {
    let (_, cosine) = turn(first, second);
    let below = (1i64 << BITS).saturating_add(cosine);
    // Farther than 2^10 times the distance is not reachable for a tool.
    let divisor = u64::try_from(below)
        .ok()
        .filter(|&below| below >> 40 != 0)?;
    let sum = plus(first, second);
    Some(sum.map(|part| {
        let product = i128::from(part).wrapping_mul(i128::from(by));
        let magnitude = divide(
            product
                .unsigned_abs()
                .wrapping_add(u128::from(divisor >> 1)),
            divisor,
        ) as i64;
        if product < 0 {
            magnitude.wrapping_neg()
        } else {
            magnitude
        }
    }))
}

/// The leg of a right triangle with this hypotenuse and this other leg. A slightly negative square
/// counts as zero.
fn rest(whole: i64, part: i64) -> Option<i64> {
    let (whole, part) = (whole.saturating_abs(), part.saturating_abs());
    if part > whole {
        // Tangent, to the rounding of both.
        return (part.saturating_sub(whole) <= 3).then_some(0);
    }
    Some(root(square(whole, 0).saturating_sub(square(part, 0))) as i64)
}

/// The common point of a line and a circle that is nearest to `near`.
pub(crate) fn line_and_circle(
    point: Vector,
    direction: Vector,
    centre: Vector,
    radius: i64,
    near: Vector,
) -> Option<Vector> {
    let to_centre = minus(centre, point);
    let narrow = |wide: i128| shift_rounded(wide, BITS) as i64;
    let foot = narrow(dot(to_centre, direction));
    let half = rest(radius, narrow(cross(to_centre, direction)))?;
    let [one, other] = [foot.saturating_sub(half), foot.saturating_add(half)]
        .map(|by| plus(point, along(direction, by)));
    Some(nearest(one, other, near))
}

/// The common point of two circles that is nearest to `near`.
pub(crate) fn circles(first: (Vector, i64), second: (Vector, i64), near: Vector) -> Option<Vector> {
    let between = minus(second.0, first.0);
    let distance = length(between);
    if distance == 0 {
        return None;
    }
    // (r1^2 - r2^2 + d^2) / 2d, all squares below 2^106.
    let sum = (square(first.1, 0).wrapping_add(square(between[0], between[1]))) as i128;
    let above = sum.wrapping_sub(square(second.1, 0) as i128);
    let below = distance.unsigned_abs().wrapping_mul(2);
    let magnitude = divide(
        above.unsigned_abs().wrapping_add(u128::from(below >> 1)),
        below,
    ) as i64;
    let foot = if above < 0 {
        magnitude.wrapping_neg()
    } else {
        magnitude
    };
    let half = rest(first.1, foot)?;
    let direction = unit(between);
    let middle = plus(first.0, along(direction, foot));
    let aside = along(left(direction), half);
    Some(nearest(plus(middle, aside), minus(middle, aside), near))
}

fn nearest(one: Vector, other: Vector, near: Vector) -> Vector {
    let distance = |point: Vector| {
        let [x, y] = minus(point, near);
        square(x, y)
    };
    if distance(one) <= distance(other) {
        one
    } else {
        other
    }
}

/// Whether a direction lies within the counter-clockwise turn from one direction to another; equal
/// directions are a whole turn.
pub(crate) fn is_between(from: Vector, to: Vector, what: Vector) -> bool {
    if from == to {
        return true;
    }
    let wide = cross(from, to) < 0 || (cross(from, to) == 0 && dot(from, to) < 0);
    let after = cross(from, what) >= 0;
    let before = cross(what, to) >= 0;
    if wide {
        after || before
    } else {
        after && before
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_of_known_figures() {
        assert_eq!(along(unit([3, 4]), 5_000), [3_000, 4_000]);
        let [east, north] = [unit([7, 0]), unit([0, 9])];
        assert_eq!(mitre(left(east), left(north), 1_000), Some([-1_000, 1_000]));
        assert_eq!(mitre(left(east), opposite(left(east)), 1_000), None);
        assert_eq!(
            line_and_circle([0, 3_000], east, [0, 0], 5_000, [9_000, 0]),
            Some([4_000, 3_000])
        );
        assert_eq!(
            line_and_circle([0, 6_000], east, [0, 0], 5_000, [0, 0]),
            None
        );
        assert_eq!(
            circles(([0, 0], 5_000), ([6_000, 0], 5_000), [0, 9_000]),
            Some([3_000, 4_000])
        );
        assert!(is_between([1, 0], [0, 1], [1, 1]) && !is_between([1, 0], [0, 1], [-1, 1]));
        assert!(is_between([0, 1], [1, 0], [-1, -1]) && !is_between([0, 1], [1, 0], [1, 1]));
    }

    /// A turn contains its ends and everything counter-clockwise between them: less than half a
    /// turn, half a turn, and more.
    #[test]
    fn directions_within_a_turn() {
        // Eight directions in counter-clockwise order.
        let ways = [
            [1, 0],
            [1, 1],
            [0, 1],
            [-1, 1],
            [-1, 0],
            [-1, -1],
            [0, -1],
            [1, -1],
        ];
        for from in 0..8usize {
            for turn in 1..8usize {
                for ahead in 0..8usize {
                    let [one, to, what] =
                        [from, from + turn, from + ahead].map(|place| ways[place % 8]);
                    let expected = ahead <= turn;
                    assert_eq!(
                        is_between(one, to, what),
                        expected,
                        "{one:?} {to:?} {what:?}"
                    );
                }
            }
            assert!(is_between(ways[from], ways[from], ways[(from + 3) % 8]));
        }
    }

    /// Ends in the same direction are no turn, whatever their lengths.
    #[test]
    fn ends_of_one_direction() {
        assert!(!is_between([1000, 0], [1001, 0], [0, 1]));
        assert!(!is_between([1000, 0], [1001, 0], [0, -1]));
    }

    #[test]
    fn figures_on_the_other_side() {
        // The centre of the smaller circle is beyond their common line.
        assert_eq!(
            circles(([6_000, 0], 3_000), ([0, 0], 5_196), [6_000, 9_000]).map(|at| at[1] > 0),
            Some(true)
        );
        assert_eq!(
            circles(([0, 0], 3_000), ([4_000, 0], 5_000), [0, 9_000]),
            Some([0, 3_000])
        );
        assert_eq!(
            circles(([0, 0], 5_000), ([2_000, 0], 6_708), [0, -9_000]).map(|at| at[0] < 0),
            Some(true)
        );
        assert_eq!(circles(([0, 0], 5_000), ([0, 0], 5_000), [0, 0]), None);
        // Tangent to three nanometres.
        let east = unit([7, 0]);
        let line = |height| line_and_circle([0, height], east, [0, 0], 5_000, [0, 0]);
        assert_eq!(line(5_000), Some([0, 5_000]));
        assert_eq!(line(5_003), Some([0, 5_003]));
        assert_eq!(line(5_004), None);
        // To the right of both sides.
        let [east, south] = [unit([7, 0]), unit([0, -9])];
        assert_eq!(
            mitre(left(east), left(south), -1_000),
            Some([-1_000, -1_000])
        );
        assert_eq!(mitre(left(east), left(south), 0), Some([0, 0]));
    }
}

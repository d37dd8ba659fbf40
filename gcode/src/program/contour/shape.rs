//! The contour of a turning cycle, and the extent of a cut at a given depth.

use crate::compensation::offset::{Vector, cross, minus};
use crate::values::wide::{divide, root, square};

/// One move of a contour: X as a radius, and Z, in the machine frame.
#[derive(Copy, Clone, Debug)]
pub(super) struct Segment {
    pub(super) to: Vector,
    /// The centre, and whether the arc is clockwise (G2); `None` for a straight move.
    pub(super) arc: Option<(Vector, bool)>,
}

/// The directions of a cycle.
///
/// X and Z become *deep* and *far*: deep grows into the material, far grows along the cut. The
/// mapping mirrors and swaps axes, so circles and lengths are preserved.
#[derive(Copy, Clone, Debug)]
pub(super) struct Ways {
    /// G72: deep is Z and far is X; otherwise deep is X and far is Z.
    pub(super) facing: bool,
    /// Whether deep and far grow in the direction of their axes.
    pub(super) deep_up: bool,
    pub(super) far_up: bool,
}

impl Ways {
    /// Converts X and Z of a point or a vector to deep and far.
    pub(super) const fn course(self, point: Vector) -> Vector {
        let [deep, far] = if self.facing {
            [point[1], point[0]]
        } else {
            point
        };
        [signed(deep, self.deep_up), signed(far, self.far_up)]
    }

    /// Converts deep and far to X and Z.
    pub(super) const fn point(self, course: Vector) -> Vector {
        let (deep, far) = (
            signed(course[0], self.deep_up),
            signed(course[1], self.far_up),
        );
        if self.facing {
            [far, deep]
        } else {
            [deep, far]
        }
    }

    /// The letters of deep and far.
    pub(super) const fn letters(self) -> [u8; 2] {
        if self.facing { *b"ZX" } else { *b"XZ" }
    }

    /// The letter of the axis along which a move goes back. A contour that can be roughed rises out
    /// of the material and goes far. An arc that crosses an end of a diameter by less than 2 nm of
    /// height does not count as going back.
    pub(super) fn goes_back(self, from: Vector, segment: &Segment) -> Option<u8> {
        let [deep, far] = self.letters();
        let [sinks, advances] = self.course(minus(segment.to, from));
        if sinks > 0 {
            return Some(deep);
        }
        if advances < 0 {
            return Some(far);
        }
        let (centre, clockwise) = segment.arc?;
        let (start, end) = (minus(from, centre), minus(segment.to, centre));
        // From X to Z is clockwise, seen in the plane of G18.
        let turn = cross(start, end);
        if turn == 0 || (turn > 0) != clockwise {
            return Some(far);
        }
        // Less than half a turn: it reverses at most once per axis, at the end of a diameter.
        let radius = u128::from(root(square(start[0], start[1])));
        let passes = |one: i64, other: i64| {
            let least = u128::from(one.unsigned_abs().min(other.unsigned_abs()));
            // s^2 / 2r > 2 nm.
            (one < 0) != (other < 0) && least.wrapping_mul(least) > radius.wrapping_mul(4)
        };
        let [start, end] = [self.course(start), self.course(end)];
        if passes(start[1], end[1]) {
            Some(deep)
        } else if passes(start[0], end[0]) {
            Some(far)
        } else {
            None
        }
    }
}

const fn signed(value: i64, up: bool) -> i64 {
    if up { value } else { value.wrapping_neg() }
}

/// A contour that rises throughout: `from`, then its moves.
#[derive(Clone, Debug)]
pub(super) struct Shape<const CAPACITY: usize> {
    pub(super) from: Vector,
    segments: [Segment; CAPACITY],
    count: usize,
}

impl<const CAPACITY: usize> Shape<CAPACITY> {
    pub(super) const fn new(from: Vector) -> Self {
        Shape {
            from,
            segments: [Segment {
                to: [0, 0],
                arc: None,
            }; CAPACITY],
            count: 0,
        }
    }

    /// Adds a move; `false` when there is no room.
    pub(super) fn push(&mut self, segment: Segment) -> bool {
        match self.segments.get_mut(self.count) {
            Some(place) => {
                *place = segment;
                // At most CAPACITY.
                self.count = self.count.wrapping_add(1);
                true
            }
            None => false,
        }
    }

    pub(super) fn get(&self, index: usize) -> Option<Segment> {
        self.segments.get(..self.count)?.get(index).copied()
    }

    /// The moves with their starts.
    pub(super) fn moves(&self) -> impl Iterator<Item = (Vector, &Segment)> {
        let mut from = self.from;
        let segments = self.segments.get(..self.count).unwrap_or_default();
        segments.iter().map(move |segment| {
            let before = from;
            from = segment.to;
            (before, segment)
        })
    }

    pub(super) fn end(&self) -> Vector {
        self.moves()
            .last()
            .map_or(self.from, |(_, segment)| segment.to)
    }

    /// The extent of a cut at this depth: where the contour rises above it, rounded towards the
    /// cut.
    pub(super) fn reach(&self, ways: Ways, deep: i64) -> i64 {
        for (from, segment) in self.moves() {
            let [start, end] = [ways.course(from), ways.course(segment.to)];
            if end[0] >= deep {
                continue;
            }
            let far = match segment.arc {
                None => {
                    // deep lies within the move, or above its start because of rounding;
                    // differences are below 2^52.
                    let sunk = start[0].saturating_sub(deep).max(0).unsigned_abs();
                    let rise = start[0].saturating_sub(end[0]).max(1).unsigned_abs();
                    let run = end[1].saturating_sub(start[1]).max(0).unsigned_abs();
                    let product = u128::from(sunk).wrapping_mul(u128::from(run));
                    start[1].saturating_add(divide(product, rise) as i64)
                }
                Some((centre, _)) => {
                    let middle = ways.course(centre);
                    let [a, b] = [minus(start, middle), minus(end, middle)];
                    let height = square(deep.saturating_sub(middle[0]), 0);
                    let rest = square(a[0], a[1]).saturating_sub(height);
                    let low = root(rest);
                    if a[1].saturating_add(b[1]) >= 0 {
                        middle[1].saturating_add(low as i64)
                    } else {
                        let exact = u128::from(low).wrapping_mul(u128::from(low)) == rest;
                        let high = low.wrapping_add(u64::from(!exact));
                        middle[1].saturating_sub(high as i64)
                    }
                }
            };
            return far.clamp(start[1].min(end[1]), end[1]);
        }
        ways.course(self.end())[1]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WAYS: Ways = Ways {
        facing: false,
        deep_up: false,
        far_up: false,
    };

    #[test]
    fn cuts_end_on_lines_and_arcs() {
        let mut shape = Shape::<4>::new([10_000, 0]);
        for (to, arc) in [
            ([10_000, -5_000], None),
            ([20_000, -15_000], Some(([20_000, -5_000], true))),
            ([30_000, -25_000], None),
        ] {
            assert!(shape.push(Segment { to, arc }));
        }
        let far = |x: i64| shape.reach(WAYS, -x);
        assert_eq!(far(10_000), 5_000);
        assert_eq!(far(12_000), 5_000 + 6_000);
        assert_eq!(far(20_000), 15_000);
        assert_eq!(far(25_001), 20_001);
        assert_eq!(far(31_000), 25_000);
    }

    #[test]
    fn what_goes_back_is_reported_with_its_axis() {
        let back = |to, arc| WAYS.goes_back([10_000, 0], &Segment { to, arc });
        assert_eq!(back([9_000, -1_000], None), Some(b'X'));
        assert_eq!(back([11_000, 1_000], None), Some(b'Z'));
        assert_eq!(back([11_000, -1_000], None), None);
        // A fillet, the same sense on the outside, and a bowl.
        assert_eq!(back([11_000, -1_000], Some(([11_000, 0], true))), None);
        assert_eq!(
            back([11_000, -1_000], Some(([11_000, 0], false))),
            Some(b'Z')
        );
        assert_eq!(
            back([10_000, -8_000], Some(([13_000, -4_000], true))),
            Some(b'X')
        );
    }

    #[test]
    fn an_arc_may_pass_the_end_of_a_diameter_by_two_nanometres() {
        let back = |from, to, clockwise| {
            let arc = Some(([0, 0], clockwise));
            WAYS.goes_back(from, &Segment { to, arc })
        };
        // The square of the height below the end, against four radii of 100 and 99.
        assert_eq!(back([98, 20], [98, -20], false), None);
        assert_eq!(back([97, 21], [97, -21], false), Some(b'X'));
        // Completely before it, in both axes.
        assert_eq!(back([2_000, 9_798], [9_798, 2_000], false), None);
        // Completely beyond it, rising to the far end of the other diameter.
        assert_eq!(back([-9_798, -2_000], [-2_000, -9_798], true), None);
    }
}

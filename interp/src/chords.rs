//! A curve in a plane as short straight lines.

use crate::Nurbs;

/// Most chords of a cubic curve.
const MOST: u32 = 1 << 20;

/// Most chords of a span of a NURBS.
const MOST_IN_SPAN: u32 = 1 << 12;

/// The ends of the chords of a curve, each chord within a tolerance of the curve. The last one is
/// the end of the curve. Coordinates are in any unit, below 2^52, for example nanometres.
///
/// With h = 1/n a chord of a curve C is at most h^2 max |C''| / 8 from it, and the second
/// derivative of a cubic curve is largest at its ends: six times the second difference of the
/// control points. For a NURBS, n is doubled until the middle of each chord is near enough.
///
/// The ends are points of the curve, rounded to within 3 units in each axis.
///
/// # Examples
/// ```
/// use husillo_interp::Chords;
///
/// let corner = [[0, 0], [2_000, 0], [3_000, 1_000], [3_000, 3_000]];
/// let chords = Chords::of_cubic(corner, 35);
/// assert_eq!(chords.total(), 7);
/// assert_eq!(chords.last(), Some([3_000, 3_000]));
/// ```
#[derive(Clone, Debug)]
pub struct Chords {
    shape: Shape,
    end: [i64; 2],
    count: u32,
    done: u32,
}

#[derive(Clone, Debug)]
#[expect(clippy::large_enum_variant, reason = "a box would need an allocator")]
enum Shape {
    /// Start, two control points and end.
    Cubic([[i64; 2]; 4]),
    /// A NURBS, with so many chords in each span.
    Nurbs(Nurbs, u32),
}

impl Shape {
    /// The point at `done / count`; `done` is below `count`.
    fn point(&self, done: u32, count: u32) -> [i64; 2] {
        match self {
            Shape::Cubic(points) => cubic(points, part_of(done, count)),
            Shape::Nurbs(nurbs, in_span) => {
                let span = done.checked_div(*in_span).unwrap_or(0);
                let within = done.checked_rem(*in_span).unwrap_or(0);
                nurbs.point(span, part_of(within, *in_span))
            }
        }
    }
}

impl Chords {
    /// The chords of a cubic Bezier curve: start, two control points and end. A tolerance of 0 is
    /// taken as 1. There are at most 2^20 chords, also where the tolerance would need more.
    pub fn of_cubic(points: [[i64; 2]; 4], tolerance: u64) -> Self {
        let [a, b, c, d] = points;
        // Coordinates are below 2^52, so a second difference of two axes is below 2^55.
        let bend = |before: [i64; 2], at: [i64; 2], after: [i64; 2]| {
            let axes = before.into_iter().zip(at).zip(after);
            axes.fold(0_u64, |sum, ((before, at), after)| {
                let bend = before.wrapping_add(after).wrapping_sub(at.wrapping_mul(2));
                sum.saturating_add(bend.unsigned_abs())
            })
        };
        let most = bend(a, b, c).max(bend(b, c, d));
        // Rounded to nearest.
        let eight = tolerance.max(1).saturating_mul(8);
        let sum = most.saturating_mul(6).saturating_add(eight / 2);
        let square = sum.checked_div(eight).unwrap_or(0);
        let count = square.isqrt().saturating_add(1).min(MOST.into());
        Chords {
            shape: Shape::Cubic(points),
            end: d,
            count: count as u32,
            done: 0,
        }
    }

    /// The chords of a NURBS. There are at most 2^12 chords in each span, also where the tolerance
    /// would need more.
    ///
    /// # Cost
    /// Two points of the curve for each chord, and half as many for each attempt before.
    pub fn of_nurbs(nurbs: &Nurbs, tolerance: u64) -> Self {
        let nurbs = nurbs.scaled();
        let spans = nurbs.spans();
        let mut in_span = 4;
        while in_span < MOST_IN_SPAN && !is_near(&nurbs, in_span, tolerance.max(1)) {
            in_span = in_span.saturating_mul(2);
        }
        Chords {
            end: nurbs.end(),
            shape: Shape::Nurbs(nurbs, in_span),
            count: spans.saturating_mul(in_span),
            done: 0,
        }
    }

    /// Number of all chords of the curve.
    pub const fn total(&self) -> u32 {
        self.count
    }

    /// Number of chords still to come.
    pub const fn remaining(&self) -> u32 {
        self.count.saturating_sub(self.done)
    }
}

impl Iterator for Chords {
    type Item = [i64; 2];

    fn next(&mut self) -> Option<[i64; 2]> {
        if self.done >= self.count {
            return None;
        }
        self.done = self.done.saturating_add(1);
        Some(if self.done < self.count {
            self.shape.point(self.done, self.count)
        } else {
            self.end
        })
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        let remaining = self.remaining() as usize;
        (remaining, Some(remaining))
    }
}

/// Whether the middle of each chord is near enough with so many of them in each span.
fn is_near(nurbs: &Nurbs, in_span: u32, tolerance: u64) -> bool {
    let count = nurbs.spans().saturating_mul(in_span);
    let halves = in_span.saturating_mul(2);
    let at = |half: u32| {
        let span = half.checked_div(halves).unwrap_or(0);
        nurbs.point(span, part_of(half.checked_rem(halves).unwrap_or(0), halves))
    };
    (0..count.saturating_sub(1)).all(|chord| {
        let half = chord.saturating_mul(2);
        let [start, middle, end] = [
            at(half),
            at(half.saturating_add(1)),
            at(half.saturating_add(2)),
        ];
        let axes = start.into_iter().zip(middle).zip(end);
        let off = axes.fold(0_u64, |off, ((start, middle), end)| {
            let mean = start.saturating_add(end) / 2;
            off.saturating_add(middle.abs_diff(mean))
        });
        off <= tolerance
    })
}

/// `done / count` in 2^-32; `done` is below `count`.
fn part_of(done: u32, count: u32) -> u64 {
    let done = u64::from(done) << 32;
    done.checked_div(count.into()).unwrap_or(0)
}

/// The point of a cubic curve at `u` in 2^-32.
fn cubic(&[a, b, c, d]: &[[i64; 2]; 4], u: u64) -> [i64; 2] {
    let between = |a: [i64; 2], b: [i64; 2]| {
        let mut point = a;
        for (point, b) in point.iter_mut().zip(b) {
            *point = point.saturating_add(share(b.saturating_sub(*point), u));
        }
        point
    };
    let [ab, bc, cd] = [between(a, b), between(b, c), between(c, d)];
    between(between(ab, bc), between(bc, cd))
}

/// value * u / 2^32 for u up to 2^32, rounded down, without a product of 128 bits.
pub(crate) fn share(value: i64, u: u64) -> i64 {
    // Both halves are below 2^32 and u is at most 2^32, so each product fits.
    let high = (value >> 32).wrapping_mul(u as i64);
    let low = (value as u64 & 0xffff_ffff).wrapping_mul(u) >> 32;
    high.wrapping_add(low as i64)
}

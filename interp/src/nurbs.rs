//! A NURBS in a plane: its control points come one by one.

use crate::chords::share;
use core::fmt;

/// Most control points of one curve.
const MOST_POINTS: usize = 64;

/// Largest order of a curve.
const MOST_ORDER: usize = 16;

/// Bits of the largest weight. Its product with a parameter of 32 bits fits in 64.
const WEIGHT_BITS: u32 = 30;

/// A control point and its weight.
type Point = ([i64; 2], u64);

/// A curve has 64 control points already.
#[derive(Copy, Clone, PartialEq, Eq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct TooManyPoints;

impl fmt::Display for TooManyPoints {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str("a curve has at most 64 control points")
    }
}

impl core::error::Error for TooManyPoints {}

/// The control points of a NURBS in the plane of two axes; [`Chords::of_nurbs`] makes the curve.
///
/// The knots are whole numbers, and the first and the last one count as often as the order. So the
/// curve begins at its first point and ends at its last one. A span lies between two knots.
/// Coordinates are in any unit, below 2^52.
///
/// [`Chords::of_nurbs`]: crate::Chords::of_nurbs
///
/// # Examples
/// A quarter circle is a NURBS of order 3 with the weight sqrt(1/2) in its corner:
/// ```
/// use husillo_interp::{Chords, Nurbs};
///
/// let mut nurbs = Nurbs::new(3);
/// nurbs.push([30_000_000, 0], 1_000_000)?;
/// nurbs.push([30_000_000, 30_000_000], 707_107)?;
/// nurbs.push([0, 30_000_000], 1_000_000)?;
/// for [x, y] in Chords::of_nurbs(&nurbs, 100) {
///     assert!(((x as f64).hypot(y as f64) - 30e6).abs() < 15.0);
/// }
/// # Ok::<(), husillo_interp::TooManyPoints>(())
/// ```
#[derive(Clone, Debug)]
pub struct Nurbs {
    order: u8,
    used: usize,
    points: [Point; MOST_POINTS],
}

impl Nurbs {
    /// A curve without points. Its order is 2 to 16; other values are taken as the nearest of
    /// these. A curve with fewer points than its order has the order of their number.
    pub const fn new(order: u8) -> Self {
        let order = match order {
            0..2 => 2,
            2..=16 => order,
            _ => 16,
        };
        Nurbs {
            order,
            used: 0,
            points: [([0; 2], 1); MOST_POINTS],
        }
    }

    /// Appends a control point. Only the ratios of the weights matter; 0 is taken as the least
    /// weight above it.
    ///
    /// # Errors
    /// [`TooManyPoints`] after 64 points; the curve is unchanged.
    pub fn push(&mut self, at: [i64; 2], weight: u64) -> Result<(), TooManyPoints> {
        let place = self.points.get_mut(self.used);
        *place.ok_or(TooManyPoints)? = (at, weight);
        self.used = self.used.saturating_add(1);
        Ok(())
    }

    /// The last control point; zero without any.
    pub(crate) fn end(&self) -> [i64; 2] {
        let last = self.points.iter().take(self.used).next_back();
        last.map_or([0; 2], |point| point.0)
    }

    /// The same curve for [`point`](Nurbs::point): its largest weight has 30 bits.
    pub(crate) fn scaled(&self) -> Nurbs {
        let mut scaled = self.clone();
        let used = u8::try_from(self.used).unwrap_or(u8::MAX);
        scaled.order = self.order.min(used).max(1);
        let largest = self.points.iter().take(self.used).map(|point| point.1);
        let bits = 64_u32.saturating_sub(largest.max().unwrap_or(1).leading_zeros());
        for (_, weight) in &mut scaled.points {
            let shifted = match bits.checked_sub(WEIGHT_BITS) {
                Some(over) => weight.wrapping_shr(over),
                None => weight.wrapping_shl(WEIGHT_BITS.saturating_sub(bits)),
            };
            *weight = shifted.max(1);
        }
        scaled
    }

    /// Number of spans.
    pub(crate) fn spans(&self) -> u32 {
        let spans = self.used.saturating_sub(self.order.into());
        u32::try_from(spans).unwrap_or(0).saturating_add(1)
    }

    /// The point of a scaled curve in a span, at `u` in 2^-32 of it: the algorithm of de Boor with
    /// weights, in 136 divisions at most.
    ///
    /// # Source
    /// C. de Boor, "On calculating with B-splines", 1972.
    pub(crate) fn point(&self, span: u32, u: u64) -> [i64; 2] {
        let degree = usize::from(self.order).saturating_sub(1).min(MOST_ORDER);
        let first = span as usize;
        let mut active = [([0; 2], 1_u64); MOST_ORDER];
        for (active, point) in active.iter_mut().zip(self.points.iter().skip(first)) {
            *active = *point;
        }
        let knot = |number: usize| {
            let whole = number.saturating_sub(degree).min(self.spans() as usize);
            whole as u64
        };
        for round in 1..=degree {
            for place in (round..=degree).rev() {
                let low = knot(place.saturating_add(first));
                // place + 1 + first + degree - round
                let high = place.saturating_add(first).saturating_add(degree);
                let high = knot(high.saturating_add(1).saturating_sub(round));
                let part = u64::from(span).saturating_sub(low) << 32;
                let part = part.saturating_add(u);
                let part = part.checked_div(high.saturating_sub(low)).unwrap_or(0);
                let (Some(before), Some(after)) = (
                    active.get(place.saturating_sub(1)).copied(),
                    active.get_mut(place),
                ) else {
                    continue;
                };
                *after = between(before, *after, part.min(1 << 32));
            }
        }
        active.get(degree).map_or([0; 2], |point| point.0)
    }
}

/// The point at `part` in 2^-32 between two weighted points.
fn between(before: Point, after: Point, part: u64) -> Point {
    let rest = (1_u64 << 32).saturating_sub(part);
    // Weights have 30 bits, so each product has 62.
    let (first, second) = (before.1.wrapping_mul(rest), after.1.wrapping_mul(part));
    let weight = (first.wrapping_add(second) >> 32).max(1);
    // The share of the second point, at most 2^32.
    let share_of = second.checked_div(weight).unwrap_or(0).min(1 << 32);
    let mut at = before.0;
    for (at, to) in at.iter_mut().zip(after.0) {
        *at = at.saturating_add(share(to.saturating_sub(*at), share_of));
    }
    (at, weight)
}

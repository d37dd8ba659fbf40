//! A NURBS (G5.2, G5.3): its control points come one by one, and it is made when the last one is
//! there.

use husillo_gcode::{Command, Feed, Nm};

use crate::lines::chords::{Chords, share};
use crate::{Config, MoveError};

/// Most control points of one curve.
const MOST_POINTS: usize = 64;

/// Largest order of a curve.
const MOST_ORDER: usize = 16;

/// Bits of the largest weight. Its product with a parameter of 32 bits fits in 64.
const WEIGHT_BITS: u32 = 30;

/// A control point: X and Y, and its weight.
type Point = ([Nm; 2], u64);

/// The control points of a curve.
///
/// The knots are whole numbers, and the first and the last one count as often as the order. A span
/// lies between two knots.
#[derive(Clone, Debug)]
pub(crate) struct Nurbs {
    order: u8,
    feed: Feed,
    used: usize,
    points: [Point; MOST_POINTS],
}

impl Nurbs {
    pub(crate) const EMPTY: Nurbs = Nurbs {
        order: 3,
        feed: Feed::PerMinute(Nm(1)),
        used: 0,
        points: [([Nm(0); 2], 1); MOST_POINTS],
    };

    /// Takes a command of a curve that begins at `from`. Returns the chords of the curve with its
    /// last command.
    ///
    /// # Errors
    /// [`MoveError::TooManyPoints`] for more than 64 control points.
    pub(crate) fn take<const N: usize>(
        &mut self,
        config: &Config<N>,
        from: &[Nm; N],
        command: &Command<N>,
    ) -> Result<Option<Chords<N>>, MoveError> {
        match *command {
            Command::NurbsBegin {
                order,
                micro_weight,
                feed,
            } => {
                (self.order, self.feed, self.used) = (order, feed, 0);
                let mut at = [Nm(0); 2];
                for (at, from) in at.iter_mut().zip(from) {
                    *at = *from;
                }
                self.add((at, micro_weight))?;
            }
            Command::NurbsPoint { at, micro_weight } => self.add((at, micro_weight))?,
            Command::NurbsEnd { to } => {
                let mut curve = self.clone();
                curve.scale();
                return Ok(Some(config.chords_of_nurbs(*from, to, curve)));
            }
            _ => {}
        }
        Ok(None)
    }

    fn add(&mut self, point: Point) -> Result<(), MoveError> {
        let place = self.points.get_mut(self.used);
        *place.ok_or(MoveError::TooManyPoints)? = point;
        self.used = self.used.saturating_add(1);
        Ok(())
    }

    /// Scales the weights to 30 bits; only their ratios matter.
    fn scale(&mut self) {
        let largest = self.points.iter().take(self.used).map(|point| point.1);
        let bits = 64_u32.saturating_sub(largest.max().unwrap_or(1).leading_zeros());
        for (_, weight) in &mut self.points {
            let scaled = match bits.checked_sub(WEIGHT_BITS) {
                Some(over) => weight.wrapping_shr(over),
                None => weight.wrapping_shl(WEIGHT_BITS.saturating_sub(bits)),
            };
            *weight = scaled.max(1);
        }
    }

    pub(crate) const fn feed(&self) -> Feed {
        self.feed
    }

    /// Number of spans.
    pub(crate) fn spans(&self) -> u32 {
        let spans = self.used.saturating_sub(self.order.into());
        u32::try_from(spans).unwrap_or(0).saturating_add(1)
    }

    /// The point of the curve in a span, at `u` in 2^-32 of it: the algorithm of de Boor with
    /// weights, in 136 divisions at most.
    ///
    /// # Source
    /// C. de Boor, "On calculating with B-splines", 1972.
    pub(crate) fn point(&self, span: u32, u: u64) -> [Nm; 2] {
        let degree = usize::from(self.order).saturating_sub(1).min(MOST_ORDER);
        let first = span as usize;
        let mut active = [([Nm(0); 2], 1_u64); MOST_ORDER];
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
        active.get(degree).map_or([Nm(0); 2], |point| point.0)
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
        at.0 =
            at.0.saturating_add(share(to.0.saturating_sub(at.0), share_of));
    }
    (at, weight)
}

//! Cubic and quadratic Bezier curves in N axes.

use crate::Step;
use crate::counted::Counted;
use crate::method::interpolator;
use core::fmt;

/// Fraction bits of positions on the curve: 2^-20 BLU.
const PLACE_BITS: u32 = 20;
/// Largest distance of a control point from the first one in any axis: 2^22 BLU.
const MAX_WAY: u64 = 1 << 42;
/// Distance between two samples: 15/16 BLU, so that no axis makes two steps.
const STRIDE: u64 = 15 << 16;
/// Chords within 1/128 of the stride are not corrected.
const TOLERANCE: u64 = STRIDE >> 7;
/// Sweep per BLU of path, in bits.
const UNIT_BITS: u32 = 16;
/// The parameter u = 1.
const ONE: u64 = 1 << 32;

/// Reason why a curve cannot be made.
#[derive(Copy, Clone, PartialEq, Eq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum BezierError {
    /// More than 20 fraction bits.
    FractionBits,
    /// A control point is at least 2^22 BLU from the first one in some axis, or an end is beyond
    /// 2^31 BLU.
    TooLarge,
    /// More than eight axes.
    Axes,
}

impl fmt::Display for BezierError {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(match self {
            BezierError::FractionBits => "the control points have more than 20 fraction bits",
            BezierError::TooLarge => "a control point is 2^22 steps or more from the first one",
            BezierError::Axes => "a curve has at most eight axes",
        })
    }
}

impl core::error::Error for BezierError {}

/// A cubic (G5) or quadratic (G5.1) Bezier curve in up to eight axes. It begins and ends on the
/// lattice points nearest to its end points (halves are rounded towards +infinity).
///
/// The curve is followed in samples 15/16 BLU apart. An event is a sample at which the rounded
/// position has changed. The parameter u advances by the second-order Taylor step u + w - w^2
/// (C'.C'') / (2 |C'|^2) with w = v / |C'|, corrected by the measured chord. Near a cusp, where C'
/// vanishes, u advances by at most sqrt(2 v / max |C''|). It always advances by at least 1/2 BLU /
/// max |C'|.
///
/// | | |
/// | --- | --- |
/// | error | at every event at most 1/2 BLU + 2^-18 per axis from the sample; the curve itself is at most 1/2 BLU from the chord of two samples in a cusp, and much less elsewhere |
/// | events | at most 6 times the largest distance of consecutive control points in an axis; about 1 to 1.07 per BLU of length |
/// | speed ripple | samples are even within 1 % except in cusps; the sweep of an event is its projection on the chord of the sample, so the path speed is constant; least sweep 1/16 BLU |
/// | state | 64 bits, 48 bytes per axis (polynomial, position and end) plus 48; control points up to 2^22 BLU from the first |
/// | cost | instructions per event on Cortex-M4F / M0: 1730 / 5720 for two axes, 1980 / 6570 for three (on the S curve of the tests). Four divisions and three roots of 64 bits per sample, for which these processors have no instruction; no division of 128 bits |
/// | source | Taylor step of parametric interpolators (Shpitalni, Koren, Lo 1994) with a chord corrector; rounding per axis |
///
/// Sum of the sweeps: a step counts as its projection on the tangent, and the lattice is within
/// sqrt(N)/2 of the curve. So the sum is the length within sqrt(N)/2 (2 + total turning in radians)
/// BLU, plus the least sweeps, which are below 0.1 % per axis.
///
/// Positions are the polynomial c1 u + c2 u^2 + c3 u^3 in 2^-20 BLU. Its coefficients are integer
/// combinations of the control points, with c3 = 0 for the quadratic curve. The quadratic curve is
/// therefore exact; it is not raised to a cubic, which would require a division by three.
///
/// # Examples
/// ```
/// use husillo_interp::Bezier;
///
/// let corner = Bezier::quadratic([[0, 0], [4, 0], [4, 4]], 0)?;
/// let deltas: Vec<[i8; 2]> = corner.map(|step| step.deltas()).collect();
/// assert_eq!(deltas, [[1, 0], [1, 0], [1, 1], [1, 1], [0, 1], [0, 1]]);
/// # Ok::<(), husillo_interp::BezierError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Bezier<const N: usize> {
    counted: Counted<Walk<N>>,
}

impl<const N: usize> Bezier<N> {
    /// Creates the curve of four control points in 2^-`fraction_bits` BLU (0 to 20 bits). Walks it
    /// once to count its events.
    ///
    /// # Errors
    /// See [`BezierError`].
    pub fn cubic(control: [[i64; N]; 4], fraction_bits: u8) -> Result<Bezier<N>, BezierError> {
        let [first, second, third, last] = control;
        let first = Origin::new(first, fraction_bits)?;
        let [b, c, d] = [
            first.way_to(second)?,
            first.way_to(third)?,
            first.way_to(last)?,
        ];
        // The distances are below 2^42, so sums are below 2^46.
        let polynomial = zip3(b, c, d, |b, c, d| {
            let twice = |value: i64| value.wrapping_mul(2);
            let thrice = |value: i64| value.wrapping_mul(3);
            Cubic {
                start: 0,
                first: thrice(b),
                second: thrice(c.wrapping_sub(twice(b))),
                third: d.wrapping_sub(thrice(c)).wrapping_add(thrice(b)),
            }
        });
        let legs = zip3(b, c, d, |b, c, d| {
            b.unsigned_abs()
                .max(c.wrapping_sub(b).unsigned_abs())
                .max(d.wrapping_sub(c).unsigned_abs())
        });
        let bends = zip3(b, c, d, |b, c, d| {
            let bend = |before: i64, at: i64, after: i64| {
                before.wrapping_add(after).wrapping_sub(at.wrapping_mul(2))
            };
            bend(0, b, c)
                .unsigned_abs()
                .max(bend(b, c, d).unsigned_abs())
        });
        // max |C'| is three times the longest leg, max |C''| is six times the largest bend.
        let steepest = legs.into_iter().max().unwrap_or(0).wrapping_mul(3);
        let bend = bends.into_iter().fold(0_u64, u64::saturating_add);
        Bezier::prepare(&first, polynomial, d, steepest, bend.saturating_mul(6))
    }

    /// Creates the curve of three control points in 2^-`fraction_bits` BLU, as [`Bezier::cubic`]
    /// does.
    ///
    /// # Errors
    /// See [`BezierError`].
    pub fn quadratic(control: [[i64; N]; 3], fraction_bits: u8) -> Result<Bezier<N>, BezierError> {
        let [first, second, last] = control;
        let first = Origin::new(first, fraction_bits)?;
        let [b, c] = [first.way_to(second)?, first.way_to(last)?];
        let polynomial = zip3(b, c, c, |b, c, _| Cubic {
            start: 0,
            first: b.wrapping_mul(2),
            second: c.wrapping_sub(b.wrapping_mul(2)),
            third: 0,
        });
        let steepest = zip3(b, c, c, |b, c, _| {
            b.unsigned_abs().max(c.wrapping_sub(b).unsigned_abs())
        });
        let bend = polynomial.iter().fold(0_u64, |sum, axis| {
            sum.saturating_add(axis.second.unsigned_abs())
        });
        let steepest = steepest.into_iter().max().unwrap_or(0);
        Bezier::prepare(
            &first,
            polynomial,
            c,
            steepest.wrapping_mul(2),
            bend.saturating_mul(2),
        )
    }

    /// `steepest` is the largest |C'| of an axis; `bend` is at least the largest |C''|.
    fn prepare(
        origin: &Origin<N>,
        mut polynomial: [Cubic; N],
        way: [i64; N],
        steepest: u64,
        bend: u64,
    ) -> Result<Bezier<N>, BezierError> {
        for (axis, start) in polynomial.iter_mut().zip(origin.fraction) {
            axis.start = start;
        }
        // 1/2 BLU at the fastest point: at least 2^51 / 2^45.6 = 42. If nothing moves, one step
        // covers all.
        let least = (ONE << (PLACE_BITS - 1))
            .checked_div(steepest)
            .unwrap_or(ONE);
        // sqrt(2 v / bend), in 2^-20 and then 2^-32.
        let most = ((STRIDE * 2) << 40)
            .checked_div(bend)
            .unwrap_or(1 << 40)
            .min(1 << 40)
            .isqrt()
            << 12;
        let least = least.clamp(1, ONE);
        let mut walk = Walk {
            u: 0,
            least,
            most: most.max(least),
            place: [0; N],
            end: way,
            axes: polynomial,
        };
        walk.place = origin.fraction;
        for (end, start) in walk.end.iter_mut().zip(origin.fraction) {
            *end = end.wrapping_add(start);
        }
        // At most 2^32 / least samples, and as many events.
        Ok(Bezier {
            counted: Counted::new(walk).ok_or(BezierError::TooLarge)?,
        })
    }

    /// Number of events of the whole curve.
    pub const fn events(&self) -> u32 {
        self.counted.events()
    }

    /// Sweep per BLU of path: `total_sweep / unit` is the length in BLU.
    pub const fn unit(&self) -> u32 {
        1 << UNIT_BITS
    }
}

interpolator!(Bezier<N>, counted);

/// The first control point.
struct Origin<const N: usize> {
    control: [i64; N],
    /// Offset from the lattice point below plus half a step, in 2^-20 BLU. Rounding is then a
    /// shift.
    fraction: [i64; N],
    /// Shift from 2^-f to 2^-20 BLU.
    shift: u32,
}

impl<const N: usize> Origin<N> {
    fn new(control: [i64; N], fraction_bits: u8) -> Result<Origin<N>, BezierError> {
        let bits = u32::from(fraction_bits);
        let shift = PLACE_BITS
            .checked_sub(bits)
            .ok_or(BezierError::FractionBits)?;
        if N > 8 {
            return Err(BezierError::Axes);
        }
        // 31 bits before the point and up to 20 after it.
        let limit = 1_u64.wrapping_shl(bits.wrapping_add(31));
        if control.iter().any(|at| at.unsigned_abs() >= limit) {
            return Err(BezierError::TooLarge);
        }
        let half = 1_i64.wrapping_shl(PLACE_BITS - 1);
        let fraction = control.map(|at| {
            let below = at.wrapping_shr(bits).wrapping_shl(bits);
            let place = at
                .wrapping_sub(below)
                .wrapping_shl(shift)
                .wrapping_add(half);
            // The lattice point to which it rounds becomes 0.
            place & ((1 << PLACE_BITS) - 1)
        });
        Ok(Origin {
            control,
            fraction,
            shift,
        })
    }

    /// Vector from here to another control point, in 2^-20 BLU.
    fn way_to(&self, control: [i64; N]) -> Result<[i64; N], BezierError> {
        let mut way = control;
        for (way, from) in way.iter_mut().zip(self.control) {
            *way = way
                .checked_sub(from)
                .filter(|way| way.unsigned_abs() < MAX_WAY >> self.shift)
                .ok_or(BezierError::TooLarge)?
                .wrapping_shl(self.shift);
        }
        Ok(way)
    }
}

fn zip3<const N: usize, T: Copy>(
    b: [i64; N],
    c: [i64; N],
    d: [i64; N],
    of: impl Fn(i64, i64, i64) -> T,
) -> [T; N] {
    let mut c = c.into_iter();
    let mut d = d.into_iter();
    b.map(|b| of(b, c.next().unwrap_or(0), d.next().unwrap_or(0)))
}

/// One axis of the curve: start + first u + second u^2 + third u^3, in 2^-20 BLU. Coefficients are
/// below 2^46.
#[derive(Copy, Clone, Debug)]
struct Cubic {
    start: i64,
    first: i64,
    second: i64,
    third: i64,
}

impl Cubic {
    /// Position at u <= 1. Three floors make it up to 3 2^-20 BLU too low.
    #[inline]
    fn place(&self, u: u64) -> i64 {
        let bend = share(self.third, u).wrapping_add(self.second);
        let slope = share(bend, u).wrapping_add(self.first);
        share(slope, u).wrapping_add(self.start)
    }

    /// C': below 3 2^46.
    #[inline]
    fn slope(&self, u: u64) -> i64 {
        let third = share(self.third, u).wrapping_mul(3);
        let bend = third.wrapping_add(self.second.wrapping_mul(2));
        share(bend, u).wrapping_add(self.first)
    }

    /// C'': below 6 2^47.
    #[inline]
    fn bend(&self, u: u64) -> i64 {
        let third = share(self.third, u).wrapping_mul(3);
        third.wrapping_add(self.second).wrapping_mul(2)
    }
}

/// floor(value u 2^-32) for u <= 2^32 and |value| < 2^62, without a product of 128 bits.
#[inline]
fn share(value: i64, u: u64) -> i64 {
    let high = (value >> 32).wrapping_mul(u as i64);
    // The low half times u is below 2^64.
    let low = (value as u64 & 0xffff_ffff).wrapping_mul(u) >> 32;
    high.wrapping_add(low as i64)
}

/// State of the walk.
#[derive(Clone, Debug)]
struct Walk<const N: usize> {
    /// The parameter u, 0 to 2^32.
    u: u64,
    /// Least and greatest increment of u.
    least: u64,
    most: u64,
    /// Position of the curve at u, plus half a step.
    place: [i64; N],
    /// Position of the end.
    end: [i64; N],
    axes: [Cubic; N],
}

impl<const N: usize> Walk<N> {
    /// Position of the curve at `ahead` beyond u, limited to its end at 1.
    #[inline]
    fn ahead(&self, ahead: u64) -> [i64; N] {
        let u = self.u.wrapping_add(ahead);
        if u >= ONE {
            return self.end;
        }
        let mut places = self.end;
        for (place, axis) in places.iter_mut().zip(&self.axes) {
            *place = axis.place(u);
        }
        places
    }

    /// Length of the chord from here in 2^-20 BLU; components are limited to 2^29.
    #[inline]
    fn chord(&self, places: &[i64; N]) -> u64 {
        let mut sum = 0_u64;
        for (to, from) in places.iter().zip(&self.place) {
            let way = to.wrapping_sub(*from).unsigned_abs().min(1 << 29);
            // Sum of eight squares of 2^58.
            sum = sum.wrapping_add(way.wrapping_mul(way));
        }
        sum.isqrt()
    }

    /// Increment of u for one stride: the second-order Taylor step.
    #[inline]
    fn stride(&self) -> u64 {
        let mut slopes = [0_i64; N];
        let mut largest = 0;
        for (slope, axis) in slopes.iter_mut().zip(&self.axes) {
            *slope = axis.slope(self.u);
            largest |= slope.unsigned_abs();
        }
        // Scales to 28 bits: the sum of eight squares has 59. Slopes are below 2^48, so shift
        // <= 20.
        let shift = 36_u32.saturating_sub(largest.leading_zeros());
        let mut square = 0_u64;
        let mut dot = 0_i64;
        for (slope, axis) in slopes.iter().zip(&self.axes) {
            let slope = slope.wrapping_shr(shift);
            square = square.wrapping_add(slope.unsigned_abs().wrapping_mul(slope.unsigned_abs()));
            // C'' is below 2^50. Shifted by 20 it has 30 bits, and the sum of eight products
            // has 61.
            let bend = axis.bend(self.u).wrapping_shr(BEND_SHIFT);
            dot = dot.wrapping_add(slope.wrapping_mul(bend));
        }
        let speed = square.isqrt();
        // v 2^32 / |C'|: at most 2^52. If the curve does not move here, the bend limits the step.
        let Some(first) = (STRIDE << 32).checked_div(speed.wrapping_shl(shift)) else {
            return self.most;
        };
        if first > self.most {
            return self.most;
        }
        // w (C'.C'') / (2 |C'|^2) in 2^-16. |dot| / |C'| <= |C''| is below 2^50 when shifted back.
        // Its product with w <= sqrt(2 v / max |C''|) is below sqrt(2 v max |C''|) < 2^36. Beyond
        // 1/2 the series is meaningless.
        let along = dot.checked_div(speed as i64).unwrap_or(0);
        let along = share(along.wrapping_shl(BEND_SHIFT), first);
        let ratio = along
            .wrapping_shl(15)
            .checked_div(speed.wrapping_shl(shift) as i64)
            .unwrap_or(0)
            .clamp(-1 << 15, 1 << 15);
        let change = share(first as i64, ratio.unsigned_abs().wrapping_shl(16)) as u64;
        if ratio > 0 {
            first.wrapping_sub(change)
        } else {
            first.wrapping_add(change)
        }
    }

    /// Whether no axis would make two steps. Always true for the least step of u.
    #[inline]
    fn is_one_step(&self, places: &[i64; N]) -> bool {
        places.iter().zip(&self.place).all(|(to, from)| {
            let steps = (to >> PLACE_BITS).wrapping_sub(from >> PLACE_BITS);
            steps.unsigned_abs() <= 1
        })
    }

    /// The next sample: its position, and the chord to it.
    #[inline]
    fn sample(&mut self) -> ([i64; N], u64) {
        let mut ahead = self.stride().min(self.most).max(self.least);
        let mut places = self.ahead(ahead);
        let mut chord = self.chord(&places);
        let is_last = self.u.wrapping_add(ahead) >= ONE && chord <= STRIDE;
        if !is_last && chord.abs_diff(STRIDE) > TOLERANCE {
            // ahead <= 2^32 and STRIDE < 2^20; the correction at most doubles the step.
            let corrected = ahead.wrapping_mul(STRIDE).checked_div(chord);
            let most = ahead.wrapping_mul(2).min(self.most);
            ahead = corrected.unwrap_or(most).min(most).max(self.least);
            places = self.ahead(ahead);
            chord = self.chord(&places);
        }
        // At most 32 halvings, and only in cusps.
        while !self.is_one_step(&places) && ahead > self.least {
            ahead = (ahead / 2).max(self.least);
            places = self.ahead(ahead);
            chord = self.chord(&places);
        }
        self.u = self.u.wrapping_add(ahead).min(ONE);
        (places, chord)
    }
}

/// Shift of C'' in its product with C'.
const BEND_SHIFT: u32 = 20;

impl<const N: usize> Iterator for Walk<N> {
    type Item = Step;

    /// Takes samples until the rounded position changes. u grows by at least `least` per sample.
    #[inline]
    fn next(&mut self) -> Option<Step> {
        while self.u < ONE {
            let (places, chord) = self.sample();
            let (mut axes, mut negative, mut bit) = (0_u8, 0_u8, 1_u8);
            let mut along = 0_i64;
            for (to, from) in places.iter().zip(&mut self.place) {
                let way = to.wrapping_sub(*from);
                let steps = (to >> PLACE_BITS).wrapping_sub(*from >> PLACE_BITS);
                if steps != 0 {
                    axes |= bit;
                    // A step has the direction of its axis, so it adds its part of the chord.
                    along = along.wrapping_add(way.wrapping_abs());
                }
                if steps < 0 {
                    negative |= bit;
                }
                bit = bit.wrapping_shl(1);
                *from = *to;
            }
            if axes != 0 {
                // A few BLU at most: 2^25 2^16.
                let sweep = (along as u64)
                    .wrapping_shl(UNIT_BITS)
                    .checked_div(chord)
                    .unwrap_or(0);
                return Some(Step {
                    axes,
                    negative,
                    sweep: (sweep as u32).max(1 << (UNIT_BITS - 4)),
                });
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    extern crate std;
    use std::vec::Vec;

    /// Without degeneration the samples are one stride apart within 1 %, except the last one.
    #[test]
    fn samples_are_even() {
        let mut walk = Bezier::cubic([[0, 0], [900, 0], [-600, 400], [300, 400]], 0)
            .map(|curve| curve.counted.walk)
            .unwrap();
        let mut chords = Vec::new();
        while walk.u < ONE {
            let (places, chord) = walk.sample();
            walk.place = places;
            chords.push(chord);
        }
        chords.pop();
        for chord in chords {
            assert!(chord.abs_diff(STRIDE) * 100 < STRIDE, "{chord}");
        }
    }
}

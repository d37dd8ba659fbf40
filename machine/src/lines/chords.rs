//! A curve as short straight moves.

use husillo_gcode::{Command, Feed, Nm, Spline};
use husillo_interp::length;

use crate::lines::duration::mul_div;
use crate::{Config, MoveError, Segment};

/// Most chords of a curve. A curve of 2^31 steps has fewer.
const MOST: u32 = 1 << 20;

/// The chords of a cubic curve, each at most a quarter of a step from it.
///
/// With h = 1/n a chord of a curve C is at most h^2 max |C''| / 8 from it, and the second derivative
/// of a cubic curve is largest at its ends: six times the second difference of the control points.
/// The ends of the chords are points of the curve, rounded to within 3 nm. The steps are those of
/// lines between the nearest steps of these points, so they are within 1.46 steps of the curve.
#[derive(Clone, Debug)]
pub struct Chords<const N: usize> {
    /// The curve.
    pub(crate) segment: Segment<N>,
    spline: Spline<N>,
    feed: Feed,
    count: u32,
    done: u32,
    /// Largest distance of a chord from the curve.
    pub(crate) tolerance: Nm,
}

impl<const N: usize> Chords<N> {
    /// The chords of a curve from `from` that are at most `tolerance` from it.
    pub(crate) fn new(from: [Nm; N], spline: &Spline<N>, feed: Feed, tolerance: Nm) -> Self {
        let [a, b, c, d] = spline.points;
        // Coordinates are below 2^52, so a second difference of two axes is below 2^55.
        let bend = |before: [Nm; 2], at: [Nm; 2], after: [Nm; 2]| {
            let axes = before.into_iter().zip(at).zip(after);
            axes.fold(0_u64, |sum, ((before, at), after)| {
                let twice = at.0.wrapping_mul(2);
                let bend = before.0.wrapping_add(after.0).wrapping_sub(twice);
                sum.saturating_add(bend.unsigned_abs())
            })
        };
        let most = bend(a, b, c).max(bend(b, c, d));
        let tolerance_nm = tolerance.0.max(1).unsigned_abs();
        let square = mul_div(most, 6, tolerance_nm.saturating_mul(8));
        let count = square.isqrt().saturating_add(1).min(MOST.into());
        Chords {
            segment: Segment {
                from,
                command: Command::Spline {
                    spline: *spline,
                    feed,
                },
            },
            spline: *spline,
            feed,
            count: count as u32,
            done: 0,
            tolerance,
        }
        .timed()
    }

    /// Converts an inverse time of the curve to a path speed.
    fn timed(mut self) -> Self {
        if let Feed::InverseTime { micro_per_minute } = self.feed {
            let mut before = self.segment.from;
            let mut whole = 0_u64;
            for to in self.clone().map(|(to, _)| to) {
                let mut ways = [0; N];
                for (way, (from, to)) in ways.iter_mut().zip(before.iter().zip(to)) {
                    *way = to.0.abs_diff(from.0);
                }
                whole = whole.saturating_add(length(&ways, 0));
                before = to;
            }
            let rate = mul_div(whole, micro_per_minute, 1_000_000).max(1);
            self.feed = Feed::PerMinute(Nm(i64::try_from(rate).unwrap_or(i64::MAX)));
        }
        self
    }

    /// Whether no chord has been taken.
    pub(crate) const fn is_first(&self) -> bool {
        self.done == 0
    }

    /// The point of the curve at `done / count`.
    fn point(&self, done: u32) -> [Nm; N] {
        if done >= self.count {
            return self.spline.to;
        }
        // Below 2^32: done < count.
        let u = u64::from(done) << 32;
        let u = u.checked_div(self.count.into()).unwrap_or(0);
        let [a, b, c, d] = self.spline.points;
        let between = |a: [Nm; 2], b: [Nm; 2]| {
            let mut point = a;
            for (point, b) in point.iter_mut().zip(b) {
                point.0 = point
                    .0
                    .saturating_add(share(b.0.saturating_sub(point.0), u));
            }
            point
        };
        let [ab, bc, cd] = [between(a, b), between(b, c), between(c, d)];
        let at = between(between(ab, bc), between(bc, cd));
        let mut point = self.spline.to;
        for (point, at) in point.iter_mut().zip(at) {
            *point = at;
        }
        point
    }
}

impl<const N: usize> Iterator for Chords<N> {
    type Item = ([Nm; N], Feed);

    fn next(&mut self) -> Option<Self::Item> {
        if self.done >= self.count {
            return None;
        }
        self.done = self.done.saturating_add(1);
        Some((self.point(self.done), self.feed))
    }
}

/// value * u / 2^32 for u < 2^32, rounded down, without a product of 128 bits.
fn share(value: i64, u: u64) -> i64 {
    // Both halves are below 2^32, so each product fits.
    let high = (value >> 32).wrapping_mul(u as i64);
    let low = (value as u64 & 0xffff_ffff).wrapping_mul(u) >> 32;
    high.wrapping_add(low as i64)
}

impl<const N: usize> Config<N> {
    /// The chords of a curve on this machine: at most a quarter of the shorter step from it.
    pub(crate) fn chords(&self, from: [Nm; N], spline: &Spline<N>, feed: Feed) -> Chords<N> {
        let steps = self.axes.iter().take(2).map(|axis| {
            let step = axis.scale.nm() / axis.scale.steps().max(1);
            i64::from(step / 4)
        });
        let tolerance = steps.min().unwrap_or(1).max(1);
        Chords::new(from, spline, feed, Nm(tolerance))
    }

    /// Checks a curve, as [`Config::check`] does, along its whole length.
    pub(crate) fn check_curve(
        &self,
        from: &[Nm; N],
        spline: &Spline<N>,
        feed: Feed,
    ) -> Result<(), MoveError> {
        let mut before = *from;
        for (to, _) in self.chords(*from, spline, feed) {
            self.check_point(&to)?;
            self.check_length(&before, &to)?;
            before = to;
        }
        Ok(())
    }
}

//! A curve as short straight moves.

use husillo_gcode::{Command, Feed, Nm, Spline};
use husillo_interp::length;

use crate::lines::duration::mul_div;
use crate::lines::nurbs::Nurbs;
use crate::{Config, MoveError, Segment};

/// Most chords of a curve. A curve of 2^31 steps has fewer.
const MOST: u32 = 1 << 20;

/// Most chords of a span of a NURBS.
const MOST_IN_SPAN: u32 = 1 << 12;

/// The chords of a curve, each at most a quarter of a step from it.
///
/// With h = 1/n a chord of a curve C is at most h^2 max |C''| / 8 from it, and the second
/// derivative of a cubic curve is largest at its ends: six times the second difference of the
/// control points. For a NURBS, n is doubled until the middle of each chord is near enough.
///
/// The ends of the chords are points of the curve, rounded to within 3 nm. The steps are those of
/// lines between the nearest steps of these points, so they are within 1.46 steps of the curve.
#[derive(Clone, Debug)]
pub struct Chords<const N: usize> {
    /// The curve.
    pub(crate) segment: Segment<N>,
    shape: Shape,
    to: [Nm; N],
    feed: Feed,
    count: u32,
    done: u32,
    /// Largest distance of a chord from the curve.
    pub(crate) tolerance: Nm,
}

/// The curve in X and Y.
#[derive(Clone, Debug)]
#[expect(clippy::large_enum_variant, reason = "a box would need an allocator")]
enum Shape {
    /// Start, two control points and end.
    Cubic([[Nm; 2]; 4]),
    /// A NURBS, with so many chords in each span.
    Nurbs(Nurbs, u32),
}

impl Shape {
    /// The point at `done / count`; `done` is below `count`.
    fn point(&self, done: u32, count: u32) -> [Nm; 2] {
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

/// `done / count` in 2^-32; `done` is below `count`.
fn part_of(done: u32, count: u32) -> u64 {
    let done = u64::from(done) << 32;
    done.checked_div(count.into()).unwrap_or(0)
}

/// The point of a cubic curve at `u` in 2^-32.
fn cubic(&[a, b, c, d]: &[[Nm; 2]; 4], u: u64) -> [Nm; 2] {
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
    between(between(ab, bc), between(bc, cd))
}

impl<const N: usize> Chords<N> {
    /// The chords of a cubic curve from `from` that are at most `tolerance` from it.
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
        let command = Command::Spline {
            spline: *spline,
            feed,
        };
        Chords {
            segment: Segment { from, command },
            shape: Shape::Cubic(spline.points),
            to: spline.to,
            feed,
            count: count as u32,
            done: 0,
            tolerance,
        }
        .timed()
    }

    /// The chords of a NURBS.
    fn of_nurbs(from: [Nm; N], to: [Nm; N], nurbs: Nurbs, tolerance: Nm) -> Self {
        let (feed, spans) = (nurbs.feed(), nurbs.spans());
        let mut chords = Chords {
            segment: Segment {
                from,
                command: Command::NurbsEnd { to },
            },
            shape: Shape::Nurbs(nurbs, 1),
            to,
            feed,
            count: spans,
            done: 0,
            tolerance,
        };
        let mut in_span = 4;
        while in_span < MOST_IN_SPAN && !chords.split(spans, in_span) {
            in_span = in_span.saturating_mul(2);
        }
        chords.timed()
    }

    /// Makes so many chords in each span. Returns whether the middle of each is near enough.
    fn split(&mut self, spans: u32, in_span: u32) -> bool {
        let Shape::Nurbs(nurbs, chords_in_span) = &mut self.shape else {
            return true;
        };
        *chords_in_span = in_span;
        self.count = spans.saturating_mul(in_span);
        let halves = in_span.saturating_mul(2);
        let at = |half: u32| {
            let span = half.checked_div(halves).unwrap_or(0);
            nurbs.point(span, part_of(half.checked_rem(halves).unwrap_or(0), halves))
        };
        (0..self.count.saturating_sub(1)).all(|chord| {
            let half = chord.saturating_mul(2);
            let [start, middle, end] = [
                at(half),
                at(half.saturating_add(1)),
                at(half.saturating_add(2)),
            ];
            let axes = start.into_iter().zip(middle).zip(end);
            let off = axes.fold(0_i64, |off, ((start, middle), end)| {
                let mean = start.0.saturating_add(end.0) / 2;
                off.saturating_add(middle.0.saturating_sub(mean).saturating_abs())
            });
            off <= self.tolerance.0
        })
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
        let mut point = self.to;
        if done < self.count {
            let at = self.shape.point(done, self.count);
            for (point, at) in point.iter_mut().zip(at) {
                *point = at;
            }
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

/// value * u / 2^32 for u up to 2^32, rounded down, without a product of 128 bits.
pub(crate) fn share(value: i64, u: u64) -> i64 {
    // Both halves are below 2^32 and u is at most 2^32, so each product fits.
    let high = (value >> 32).wrapping_mul(u as i64);
    let low = (value as u64 & 0xffff_ffff).wrapping_mul(u) >> 32;
    high.wrapping_add(low as i64)
}

impl<const N: usize> Config<N> {
    /// The chords of a curve on this machine: at most a quarter of the shorter step from it.
    pub(crate) fn chords(&self, from: [Nm; N], spline: &Spline<N>, feed: Feed) -> Chords<N> {
        Chords::new(from, spline, feed, self.chord_tolerance())
    }

    /// The same for a NURBS.
    pub(crate) fn chords_of_nurbs(&self, from: [Nm; N], to: [Nm; N], nurbs: Nurbs) -> Chords<N> {
        Chords::of_nurbs(from, to, nurbs, self.chord_tolerance())
    }

    fn chord_tolerance(&self) -> Nm {
        let steps = self.axes.iter().take(2).map(|axis| {
            let step = axis.scale.nm() / axis.scale.steps().max(1);
            i64::from(step / 4)
        });
        Nm(steps.min().unwrap_or(1).max(1))
    }

    /// Checks a curve, as [`Config::check`] does, along its whole length.
    pub(crate) fn check_chords(&self, chords: Chords<N>) -> Result<(), MoveError> {
        let mut before = chords.segment.from;
        for (to, _) in chords {
            self.check_point(&to)?;
            self.check_length(&before, &to)?;
            before = to;
        }
        Ok(())
    }
}

/// Checks the commands of a program one after the other: [`Config::check`], also for curves that
/// take several commands (G5.2, G5.3).
#[derive(Clone, Debug)]
pub struct Checker {
    nurbs: Nurbs,
}

impl Default for Checker {
    fn default() -> Self {
        Self::new()
    }
}

impl Checker {
    /// No command has been checked.
    pub const fn new() -> Self {
        Checker {
            nurbs: Nurbs::EMPTY,
        }
    }

    /// Checks whether the machine can execute a command that begins at `from`.
    ///
    /// # Errors
    /// See [`MoveError`].
    pub fn check<const N: usize>(
        &mut self,
        config: &Config<N>,
        from: &[Nm; N],
        command: &Command<N>,
    ) -> Result<(), MoveError> {
        config.check(from, command)?;
        match self.nurbs.take(config, from, command)? {
            Some(chords) => config.check_chords(chords),
            None => Ok(()),
        }
    }
}

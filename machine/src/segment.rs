//! One command that moves, as steps and ticks.

use husillo_gcode::{Command, Feed, Nm};
use husillo_interp::Moves;
use husillo_planner::Timer;

use crate::{
    Axis, Config, MoveError,
    arc::{Course, course, extent, from_centre, in_plane, radius},
    duration::{length, mul_div},
};

/// Events of one arc at most: what `i32` steps and the interpolator's `u32` counts hold.
const MAX_EVENTS: u64 = 1 << 31;

/// The move that is being executed, as it was programmed.
#[derive(Copy, Clone, Debug, PartialEq)]
pub struct Segment<const N: usize> {
    /// Where it begins, machine frame.
    pub from: [Nm; N],
    /// What it is.
    pub command: Command<N>,
}

/// Nearest steps of a position.
///
/// # Errors
/// The first axis that would be beyond 2^31 steps.
pub(crate) fn lattice<const N: usize>(
    axes: &[Axis; N],
    at: &[Nm; N],
) -> Result<[i32; N], MoveError> {
    let mut steps = [0; N];
    // Not `enumerate`: its count could overflow for all the compiler knows.
    for (number, ((axis, at), step)) in (0..N).zip(axes.iter().zip(at).zip(&mut steps)) {
        *step = axis
            .scale
            .nearest(*at)
            .ok_or(MoveError::Reach { axis: number })?;
    }
    Ok(steps)
}

impl<const N: usize> Config<N> {
    /// Everything that can be wrong with a command on this machine.
    ///
    /// # Errors
    /// See [`MoveError`].
    pub fn check(&self, from: &[Nm; N], command: &Command<N>) -> Result<(), MoveError> {
        match command {
            Command::Rapid { to } | Command::Linear { to, .. } => {
                self.check_point(to)?;
                self.check_length(from, to).map(|_| ())
            }
            Command::Arc { arc, .. } => {
                self.check_point(&arc.to)?;
                let longest = self.check_length(from, &arc.to)?;
                let plane = arc.plane.axes();
                for (number, [low, high]) in plane.into_iter().zip(extent(from, arc)) {
                    self.check_travel(number, low)?;
                    self.check_travel(number, high)?;
                }
                let mismatch = arc.mismatch;
                match self.arc_tolerance {
                    Some(tolerance) if mismatch.0 > tolerance.0 => {
                        return Err(MoveError::ArcTolerance {
                            mismatch,
                            tolerance,
                        });
                    }
                    _ => {}
                }
                let [start, end] = [lattice(&self.axes, from)?, lattice(&self.axes, &arc.to)?];
                let course = self.course(from, arc, start, end)?;
                // A turn has less than 6 (r + 4) events, a helix as many more as its longest axis has steps.
                let events = match course {
                    Course::Round(_, radius) => u64::from(radius)
                        .saturating_add(4)
                        .saturating_mul(6)
                        .saturating_mul(u64::from(arc.turns).saturating_add(1)),
                    Course::Straight => 0,
                };
                if events.saturating_add(longest) > MAX_EVENTS {
                    return Err(MoveError::ArcTooLarge);
                }
                Ok(())
            }
            _ => Ok(()),
        }
    }

    /// The most steps of one axis.
    fn check_length(&self, from: &[Nm; N], to: &[Nm; N]) -> Result<u64, MoveError> {
        let mut longest = 0;
        let ends = lattice(&self.axes, from)?
            .into_iter()
            .zip(lattice(&self.axes, to)?);
        for (axis, (start, end)) in (0..N).zip(ends) {
            let steps = end.checked_sub(start).ok_or(MoveError::Reach { axis })?;
            longest = u64::from(steps.unsigned_abs()).max(longest);
        }
        Ok(longest)
    }

    fn check_point(&self, to: &[Nm; N]) -> Result<(), MoveError> {
        lattice(&self.axes, to)?;
        to.iter()
            .enumerate()
            .try_for_each(|(number, at)| self.check_travel(number, *at))
    }

    fn check_travel(&self, number: usize, position: Nm) -> Result<(), MoveError> {
        let Some([low, high]) = self.axes.get(number).and_then(|axis| axis.travel) else {
            return Ok(());
        };
        // Half a step: a rim that touches the limit touches it by rounding, too.
        let slack = self.axes.get(number).map_or(0, |axis| {
            let step = axis.scale.nm().div_ceil(axis.scale.steps().max(1));
            i64::from(step.div_ceil(2))
        });
        let axis = number;
        if position.0 < low.0.saturating_sub(slack) {
            return Err(MoveError::Travel {
                axis,
                position,
                limit: low,
            });
        }
        if position.0 > high.0.saturating_add(slack) {
            return Err(MoveError::Travel {
                axis,
                position,
                limit: high,
            });
        }
        Ok(())
    }

    fn course(
        &self,
        from: &[Nm; N],
        arc: &husillo_gcode::Arc<N>,
        start: [i32; N],
        end: [i32; N],
    ) -> Result<Course, MoveError> {
        let plane = arc.plane.axes();
        let [Some(first), Some(second)] = plane.map(|number| self.axes.get(number)) else {
            return Err(MoveError::UnequalSteps);
        };
        if first.scale != second.scale {
            return Err(MoveError::UnequalSteps);
        }
        let lattice = [in_plane(&start, plane), in_plane(&end, plane)];
        course(from, arc, first.scale, lattice)
    }

    /// The interpolator and the timer of a move that has passed [`Config::check`].
    ///
    /// `start` is where the axes stand, `end` where they shall stand; the path begins at `from` exactly.
    pub(crate) fn begin<P: Moves<N>>(
        &self,
        segment: &Segment<N>,
        start: [i32; N],
        end: [i32; N],
    ) -> (P, u64, Option<Timer>) {
        let mut delta = [0; N];
        for ((delta, start), end) in delta.iter_mut().zip(start).zip(end) {
            *delta = end.wrapping_sub(start);
        }
        let path = match &segment.command {
            Command::Arc { arc, .. } => match self.course(&segment.from, arc, start, end) {
                Ok(Course::Round(round, _)) => P::arc(&round, arc.plane.axes(), delta).ok(),
                _ => None,
            },
            _ => None,
        };
        // What is too small to go round is a line: the interpolator says so. It has no other reason left after
        // `check`: the radius, the events and the plane were looked at.
        let path = path.unwrap_or_else(|| P::line(delta));
        let ticks = self.ticks(segment, &path);
        let timer = (path.remaining() > 0)
            .then(|| Timer::new(ticks, path.total_sweep(), path.largest_sweep().into()));
        (path, ticks, timer)
    }

    /// Timer ticks of the whole move: of the way as programmed, not of the steps it rounds to, so that many
    /// moves shorter than a step take the time of their sum.
    fn ticks<P: Moves<N>>(&self, segment: &Segment<N>, path: &P) -> u64 {
        let hz = u64::from(self.timer_hz);
        let (feed, to, plane) = match &segment.command {
            Command::Rapid { to } => (None, to, None),
            Command::Linear { to, feed } => (Some(feed), to, None),
            Command::Arc { arc, feed } => (Some(feed), &arc.to, Some(arc.plane.axes())),
            _ => return 0,
        };
        // What the circle of an arc does; one too small to go round is the line between its ends.
        let plane = plane.and_then(|[a, b]| {
            let axes = [self.axes.get(a)?, self.axes.get(b)?];
            Some(([a, b], axes, path.radius()?))
        });
        let is_round = |number: &usize| plane.is_some_and(|(plane, ..)| plane.contains(number));
        let ways = segment
            .from
            .iter()
            .zip(to)
            .map(|(from, to)| to.0.abs_diff(from.0));
        let straight = ways
            .enumerate()
            .filter(|(number, _)| !is_round(number))
            .map(|(_, way)| way);
        // No axis steps faster than it can, on the average of the move.
        let mut least = 0;
        let ways = (0..N).zip(segment.from.iter().zip(to).zip(&self.axes));
        for (number, ((from, to), axis)) in ways {
            if !is_round(&number) {
                least = axis.least_ticks(to.0.abs_diff(from.0), hz).max(least);
            }
        }
        let mut around = 0;
        if let Some((_, [first, second], radius)) = plane {
            // The area swept, divided by the radius, is the length of the arc in steps.
            around = mul_div(
                path.total_sweep(),
                u64::from(first.scale.nm()),
                radius.saturating_mul(u64::from(first.scale.steps())),
            );
            // Somewhere on a quarter turn one axis makes the whole speed.
            for axis in [first, second] {
                least = axis.least_ticks(around, hz).max(least);
            }
        }
        if let (Command::Arc { arc, .. }, None) = (&segment.command, plane) {
            // Whole turns that are too small for the grid take their time all the same; pi is 355 / 113.
            let [a, b] = arc.plane.axes();
            let centre = in_plane(&arc.centre, [a, b]);
            let [start, end] = [&segment.from, &arc.to].map(|at| in_plane(at, [a, b]));
            let turns = u64::from(arc.turns).saturating_add(u64::from(start == end));
            let rim = radius(from_centre(start, centre));
            around = mul_div(rim.saturating_mul(turns), 710, 113);
        }
        let whole = length(straight.chain([around]));
        let at_speed = |speed: Nm| ticks_of(&Feed::PerMinute(speed), whole, hz);
        let (programmed, top) = match feed {
            Some(feed) => (ticks_of(feed, whole, hz), self.top_feed),
            None => (0, self.rapid),
        };
        programmed.max(top.map_or(0, at_speed)).max(least)
    }
}

impl Axis {
    /// Ticks of a timer of `hz` that this axis needs at least for a way in nanometres.
    fn least_ticks(&self, way_nm: u64, hz: u64) -> u64 {
        // nm and rate are below 2^32 each.
        let nm_per_s = u64::from(self.scale.nm()).wrapping_mul(u64::from(self.max_rate_hz));
        mul_div(
            way_nm.saturating_mul(u64::from(self.scale.steps())),
            hz,
            nm_per_s,
        )
    }
}

/// Ticks of a path of this length at the programmed feed.
fn ticks_of(feed: &Feed, length_nm: u64, hz: u64) -> u64 {
    match feed {
        Feed::PerMinute(nm) => mul_div(length_nm, 60 * hz, nm.0.unsigned_abs()),
        Feed::InverseTime { micro_per_minute } => mul_div(60_000_000, hz, *micro_per_minute),
    }
}

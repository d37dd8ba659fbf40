//! One command that moves, as steps and ticks.

use husillo_gcode::{Command, Feed, Nm};
use husillo_interp::Interpolator;
use husillo_planner::Timer;

use crate::{
    Axis, Config, MoveError,
    arc::{Course, course, extent, in_plane},
    duration::{length, mul_div},
};

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
            Command::Rapid { to } | Command::Linear { to, .. } => self.check_point(to),
            Command::Arc { arc, .. } => {
                self.check_point(&arc.to)?;
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
                self.course(from, arc, start, end).map(|_| ())
            }
            _ => Ok(()),
        }
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
            i64::from(axis.scale.nm() / axis.scale.steps().max(1) / 2)
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
    pub(crate) fn begin<P: Interpolator<N>>(
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
                Ok(Course::Round(round)) => P::arc(&round, arc.plane.axes(), delta).ok(),
                _ => None,
            },
            _ => None,
        };
        // What is too small to go round is a line: the interpolator says so.
        let path = path.unwrap_or_else(|| P::line(delta));
        let ticks = self.ticks(segment, &path);
        let timer = (path.remaining() > 0)
            .then(|| Timer::new(ticks, path.total_sweep(), path.largest_sweep()));
        (path, ticks, timer)
    }

    /// Timer ticks of the whole move: of the way as programmed, not of the steps it rounds to, so that many
    /// moves shorter than a step take the time of their sum.
    fn ticks<P: Interpolator<N>>(&self, segment: &Segment<N>, path: &P) -> u64 {
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

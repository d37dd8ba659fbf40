//! From a line of G-code to timed step events with `gcode`, `interp` and `planner` alone.
//!
//! `gcode` reads the line, `interp` decides which axes step, `planner` decides when. No crate
//! depends on another: nanometres and steps pass between them as integers and arrays. A controller
//! without ramps and backlash needs no more; `husillo-machine` does the rest.

#![no_std]

use husillo_gcode::{Arc, Block, Command, Commands, Dialect, Error, Feed, Modal, Nm};
use husillo_interp::{
    ArcError, Direction, Interpolator, Moves, Path, ProgrammedArc, Scale, Step, length,
};
use husillo_planner::Timer;

/// A controller of three axes with the same step length, at constant speed.
#[derive(Clone, Debug)]
pub struct Controller {
    modal: Modal<3>,
    dialect: Dialect,
    scale: Scale,
    timer_hz: u32,
    rapid_nm_per_min: u64,
    /// The end of the last move.
    at: [Nm; 3],
}

/// Why a line or a command of it cannot be carried out.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Failure {
    /// The line is wrong; the error has the position in it.
    Program(Error),
    /// A position is beyond 2^31 steps.
    TooFar,
    /// The arc cannot be made.
    Arc(ArcError),
    /// The feed is not a length per minute.
    Feed,
}

/// A move in progress: an iterator of events, each with the ticks to wait before it.
#[derive(Clone, Debug)]
pub struct Move {
    path: Path<3>,
    timer: Timer,
}

impl Controller {
    /// Starts at machine zero. The timer has `timer_hz` ticks per second.
    pub fn new(dialect: Dialect, scale: Scale, timer_hz: u32, rapid_nm_per_min: u64) -> Self {
        Controller {
            modal: Modal::new(dialect),
            dialect,
            scale,
            timer_hz,
            rapid_nm_per_min,
            at: [Nm(0); 3],
        }
    }

    /// Reads a line. The caller begins its commands one after the other.
    ///
    /// # Errors
    ///
    /// [`Failure::Program`]; the state is unchanged.
    pub fn line(&mut self, text: &[u8]) -> Result<Commands<3>, Failure> {
        let (mut block, mut commands) = (Block::new(), Commands::new());
        block
            .read(text, &self.dialect)
            .and_then(|()| self.modal.apply(&block, &mut commands))
            .map_err(Failure::Program)?;
        Ok(commands)
    }

    /// Begins a command. Returns `None` if it is not a move.
    ///
    /// # Errors
    ///
    /// Any [`Failure`] except `Program`; nothing moves.
    pub fn begin(&mut self, command: &Command<3>) -> Result<Option<Move>, Failure> {
        let (to, nm_per_min) = match command {
            Command::Rapid { to } => (*to, self.rapid_nm_per_min),
            Command::Linear { to, feed } => (*to, per_minute(feed)?),
            Command::Arc { arc, feed } => (arc.to, per_minute(feed)?),
            _ => return Ok(None),
        };
        let [start, end] = [self.steps(self.at)?, self.steps(to)?];
        let mut delta = [0; 3];
        let mut straight = [0; 3];
        for axis in 0..3 {
            delta[axis] = end[axis].checked_sub(start[axis]).ok_or(Failure::TooFar)?;
            straight[axis] = to[axis].0.abs_diff(self.at[axis].0);
        }
        let round = match command {
            Command::Arc { arc, .. } => self.round(arc, start, end, delta)?,
            _ => None,
        };
        let (path, around_nm) = match (round, command) {
            (Some((path, around_nm)), Command::Arc { arc, .. }) => {
                for axis in arc.plane.axes() {
                    straight[axis] = 0;
                }
                (path, around_nm)
            }
            _ => (Path::line(delta), 0),
        };
        let ticks_per_nm = (
            u128::from(self.timer_hz) * 60,
            u128::from(nm_per_min.max(1)),
        );
        let ticks = u128::from(length(&straight, around_nm)) * ticks_per_nm.0 / ticks_per_nm.1;
        self.at = to;
        Ok(Some(Move {
            timer: Timer::new(
                u64::try_from(ticks).unwrap_or(u64::MAX),
                path.total_sweep(),
                path.largest_sweep(),
            ),
            path,
        }))
    }

    /// The path of an arc and its length in its plane; `None` where a line is equivalent.
    fn round(
        &self,
        arc: &Arc<3>,
        start: [i32; 3],
        end: [i32; 3],
        delta: [i32; 3],
    ) -> Result<Option<(Path<3>, u64)>, Failure> {
        let plane = arc.plane.axes();
        let [from, to, centre] = arc.in_plane(&self.at);
        let programmed = ProgrammedArc {
            from,
            to,
            centre,
            direction: Direction::from_clockwise(arc.direction.is_clockwise()),
            turns: arc.turns,
            mismatch_nm: arc.mismatch.0.unsigned_abs(),
        };
        let steps = [start, end].map(|at| plane.map(|axis| at[axis]));
        let path = programmed
            .on_grid(self.scale, steps)
            .and_then(|grid| Path::arc(&grid.arc, plane, delta));
        let path = match path {
            Err(ArcError::Degenerate) => return Ok(None),
            other => other.map_err(Failure::Arc)?,
        };
        let radius = u128::from(path.radius().unwrap_or(1));
        let nm = u128::from(path.total_sweep()) * u128::from(self.scale.nm())
            / (radius * u128::from(self.scale.steps()));
        Ok(Some((path, u64::try_from(nm).unwrap_or(u64::MAX))))
    }

    fn steps(&self, at: [Nm; 3]) -> Result<[i32; 3], Failure> {
        let mut steps = [0; 3];
        for (step, at) in steps.iter_mut().zip(at) {
            *step = self.scale.nearest(at.0).ok_or(Failure::TooFar)?;
        }
        Ok(steps)
    }
}

fn per_minute(feed: &Feed) -> Result<u64, Failure> {
    match feed {
        Feed::PerMinute(nm) => Ok(nm.0.unsigned_abs()),
        _ => Err(Failure::Feed),
    }
}

impl Iterator for Move {
    type Item = (u64, Step);

    fn next(&mut self) -> Option<(u64, Step)> {
        let step = self.path.next()?;
        Some((self.timer.wait(step.sweep), step))
    }
}

//! The moves of a path as the machine plans them, without their events.

use husillo_gcode::{Command, Nm};
use husillo_interp::{Moves, Path};
use husillo_planner::{Ramp, Stretch};

use crate::lines::schedule::Schedule;
use crate::{Config, MoveError, Segment};

/// A move, or a part of an arc between two stops, with the limits that the queue of a
/// [`Machine`](crate::Machine) keeps.
#[derive(Copy, Clone, Debug, PartialEq)]
pub struct PlannedMove<const N: usize> {
    /// Length, speeds and acceleration, and the highest speed at the junction before it.
    pub stretch: Stretch,
    /// The whole programmed move.
    pub segment: Segment<N>,
}

/// Plans moves as a [`Machine`](crate::Machine) does, to compare rules of motion without making
/// events.
///
/// It plans lines and arcs, with their stops at take-ups. It has no splines, and plans a tap as the
/// line to its end.
///
/// # Examples
/// ```
/// use husillo_machine::gcode::{Command, Nm};
/// # use husillo_machine::{Axis, AxisRamp, Config, Equipment, Plan, Scale, gcode::Dialect};
/// # let axis = Axis {
/// #     scale: Scale::new(2_500, 1).unwrap(),
/// #     travel: None,
/// #     max_rate_hz: 20_000,
/// #     backlash_steps: 0,
/// #     ramp: Some(AxisRamp {
/// #         acceleration_hz_per_s: 200_000,
/// #         start_rate_hz: 0,
/// #         jerk_hz_per_s2: None,
/// #         junction_hz: None,
/// #     }),
/// # };
/// # let config = Config {
/// #     axes: [axis; 3],
/// #     timer_hz: 1_000_000,
/// #     dialect: Dialect::GRBL,
/// #     arc_tolerance: None,
/// #     rapid: None,
/// #     top_feed: None,
/// #     spindle_counts: None,
/// #     corner_deviation: Some(Nm(10_000)),
/// #     equipment: Equipment::NONE,
/// # };
/// let mut plan: Plan<3> = Plan::new(config, [Nm(0); 3])?;
/// plan.push(Command::Rapid { to: [Nm(1_000_000), Nm(0), Nm(0)] });
/// let planned = plan.next_move().unwrap();
/// assert_eq!(planned.stretch.length_nm, 1_000_000);
/// assert_eq!(planned.stretch.acceleration_nm_per_s2, 500_000_000);
/// assert_eq!(plan.next_move(), None);
/// # Ok::<(), husillo_machine::MoveError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Plan<const N: usize, P = Path<N>> {
    config: Config<N>,
    has_backlash: [bool; N],
    /// Whether the path stops before the next move, for a command that is not a move.
    stops: bool,
    schedule: Schedule<N, P, Segment<N>, Ramp, 1>,
}

impl<const N: usize, P: Moves<N>> Plan<N, P> {
    /// Creates a plan that begins at a position in the machine frame.
    ///
    /// # Errors
    /// [`MoveError::Reach`] if the position is beyond 2^31 steps.
    pub fn new(config: Config<N>, from: [Nm; N]) -> Result<Self, MoveError> {
        let mut schedule = Schedule::new(&config);
        schedule.clear(from, config.nearest_steps(&from)?);
        Ok(Plan {
            has_backlash: config.axes.map(|axis| axis.backlash_steps != 0),
            stops: false,
            schedule,
            config,
        })
    }

    /// Plans a command that [`Config::check`] accepts. Call [`next_move`](Plan::next_move) until it
    /// returns `None` before the next command.
    pub fn push(&mut self, command: Command<N>) {
        match command {
            Command::Path { mode } => self.schedule.set_mode(mode),
            command if command.end().is_some() => {
                self.schedule
                    .push(&self.config, &command, self.has_backlash);
            }
            _ => {
                self.schedule.end_thread();
                self.stops = true;
            }
        }
    }

    /// Returns the next move of the last command.
    pub fn next_move(&mut self) -> Option<PlannedMove<N>> {
        if self.schedule.moves.is_empty() && !self.schedule.is_whole() {
            self.schedule.push_part(true, self.has_backlash);
        }
        let (mut stretch, work) = self.schedule.moves.pop()?;
        if self.stops {
            stretch.entry_limit_nm_per_s = 0;
            self.stops = false;
        }
        Some(PlannedMove {
            stretch,
            segment: work.kept,
        })
    }
}

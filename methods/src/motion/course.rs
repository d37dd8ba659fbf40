//! A program as a list of planned moves.

use husillo_gcode::{Command, Nm};
use husillo_machine::{Config, MoveError, Plan, PlannedMove, interp::Path};

use crate::motion::chords::Turn;

/// The moves of a program as the machine plans them.
#[derive(Clone, Debug)]
pub struct Course<const N: usize> {
    pub(crate) config: Config<N>,
    pub(crate) moves: Vec<PlannedMove<N>>,
    /// Whether each move begins after a command that is not a move.
    pub(crate) rests: Vec<bool>,
    is_at_rest: bool,
    plan: Plan<N, Path<N>>,
    /// Number of curves and threads that were left out.
    pub left_out: usize,
}

impl<const N: usize> Course<N> {
    /// A program that begins at this position in the machine frame.
    ///
    /// # Errors
    ///
    /// The position is out of reach.
    pub fn new(config: Config<N>, from: [Nm; N]) -> Result<Self, MoveError> {
        Ok(Course {
            config,
            moves: Vec::new(),
            rests: Vec::new(),
            is_at_rest: true,
            plan: Plan::new(config, from)?,
            left_out: 0,
        })
    }

    /// Adds a command. Splines become the line to their end, and are counted.
    pub fn push(&mut self, command: &Command<N>) {
        let command = match command {
            Command::Spline { spline, feed } => {
                self.left_out += 1;
                Command::Linear {
                    to: spline.to,
                    feed: *feed,
                }
            }
            Command::NurbsEnd { to } | Command::Tap { to, .. } | Command::Thread { to, .. } => {
                self.left_out += 1;
                Command::Rapid { to: *to }
            }
            other => *other,
        };
        let is_mode = matches!(command, Command::Path { .. });
        self.is_at_rest |= command.end().is_none() && !is_mode;
        self.plan.push(command);
        while let Some(planned) = self.plan.next_move() {
            if planned.stretch.length_nm != 0 {
                self.moves.push(planned);
                self.rests.push(std::mem::take(&mut self.is_at_rest));
            }
        }
    }

    /// Number of moves.
    #[must_use]
    pub fn len(&self) -> usize {
        self.moves.len()
    }

    /// Whether there is no move.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.moves.is_empty()
    }

    /// The geometry of each move.
    pub(crate) fn turns(&self) -> Vec<Turn<N>> {
        self.moves
            .iter()
            .map(|planned| Turn::of(&planned.segment))
            .collect()
    }
}

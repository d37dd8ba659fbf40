//! Moves without lines, for controllers that have a modal state of their own.

use husillo_backlash::BacklashModel;
use husillo_gcode::{Command, Nm};
use husillo_interp::Moves;

use super::Machine;
use crate::Refused;
use crate::lines::path_ramp::{MoveQueue, PathRamp};

impl<const N: usize, P: Moves<N>, L: BacklashModel<N>, const QUEUE: usize, R: PathRamp>
    Machine<N, P, L, QUEUE, (), R>
{
    /// Appends one move. The modal state is not used and not changed. `tag` is what
    /// [`Machine::executing_tag`] returns while the move is executed.
    ///
    /// The caller has checked the move with [`Machine::check`], or wants it without regard to the
    /// travel, as homing does. A move that is not checked has to be within the reach of the axes.
    ///
    /// # Errors
    /// [`Refused::Busy`] where there is no room; the state is unchanged. A command that is no move
    /// has no effect.
    pub fn push(&mut self, command: Command<N>, tag: u32) -> Result<(), Refused> {
        if !self.can_push() {
            return Err(Refused::Busy);
        }
        self.schedule.set_tag(tag);
        self.schedule
            .push(&self.config, &command, self.take_up.stops());
        Ok(())
    }

    /// Whether [`Machine::push`] has room for a move.
    pub fn can_push(&self) -> bool {
        let has_room = !self.schedule.is_full() && self.schedule.is_whole();
        has_room && self.next.is_none() && self.waiting.is_none()
    }

    /// Position at the end of the last move in the queue.
    pub const fn end_position(&self) -> [Nm; N] {
        self.schedule.programmed()
    }

    /// Number of moves in the queue, the executing one included.
    pub fn queued(&self) -> usize {
        self.schedule.moves.len()
    }

    /// The tag of the executing move, or of the next one. `None` without a move.
    pub fn executing_tag(&self) -> Option<u32> {
        self.schedule.moves.front().map(|(_, work)| work.tag)
    }

    /// The programmed speed of the executing move, or of the next one, in nm/s, without the
    /// override. For a rapid, and without a feed, it is the limit of the machine. `None` without a
    /// move.
    pub fn executing_feed_nm_per_s(&self) -> Option<u32> {
        let front = self.schedule.moves.front();
        front.map(|(stretch, _)| stretch.top_nm_per_s)
    }

    /// Present speed along the path in nm/s; 0 where there are no ramps.
    pub fn speed_nm_per_s(&self) -> u32 {
        self.ramp.speed_nm_per_s(&self.schedule.moves)
    }
}

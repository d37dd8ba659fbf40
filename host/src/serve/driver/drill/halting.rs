//! STOP: nothing more is sent, so that the controller ends the motion with its lease.

use super::jogging::Jogging;
use super::stepping::Trouble;
use super::{Driver, From};

impl Driver<'_> {
    /// Ends what somebody has stopped. Nothing moves any more: a step that was being made has ended
    /// with the lease of the controller, or by itself.
    pub(super) fn halt(&mut self) -> Result<(), Trouble> {
        let why = self.bench.halting.unwrap_or("stopped");
        self.bench.machine.lease.end();
        let had_jog = self.bench.jogging.is_active();
        self.bench.jogging = Jogging::default();
        self.bench.drop_placing(why);
        let had_program = self.bench.running.course.is_active();
        self.bench.stop_program();
        self.spindle(false).or_else(Trouble::unless_lost)?;
        if had_program {
            self.empty()?;
        }
        if had_jog {
            self.read_place()?;
        }
        // What was asked for meanwhile is refused, not made now.
        self.bench.attend();
        self.bench.machine.lease.end();
        self.bench.halting = None;
        self.bench.machine.stop.clear();
        self.bench.end_program(why);
        let text = format!("the machine has stopped: {why}");
        self.bench.machine.tell(From::Server, text);
        Ok(())
    }
}

//! STOP, and the emergency stop.

use super::Driver;
use crate::serve::console_lines::From;
use crate::serve::tool_path::Motion as Drawn;

impl Driver<'_> {
    /// Stops what somebody wants to be stopped. The controller stops at once, between two steps.
    ///
    /// # Errors
    ///
    /// The controller is lost.
    pub(super) fn stop_if_due(&mut self) -> Result<(), String> {
        if self.machine.take_emergency() {
            return self.stop_for_good();
        }
        let has_left = self.machine.take_left() && !self.running.course.is_active();
        let why = match () {
            () if self.machine.stop.is_asked() => "stopped",
            () if has_left && self.is_at_work() => "its operator has gone",
            () => return Ok(()),
        };
        self.is_stopping = true;
        self.show();
        self.status = self.client.halt()?;
        self.is_stopping = false;
        self.ended(why);
        self.machine.stop.clear();
        let text = format!("the machine has stopped: {why}");
        self.machine.tell(From::Server, text);
        Ok(())
    }

    /// The emergency stop: nothing moves until the reset of the panel.
    fn stop_for_good(&mut self) -> Result<(), String> {
        let how = self.client.stop_for_good()?;
        self.status = self.client.status()?;
        self.ended("emergency stop");
        self.machine.stop.clear();
        self.machine
            .tell(From::Server, format!("EMERGENCY STOP: {how}"));
        Ok(())
    }

    /// Nothing moves any more.
    pub(super) fn ended(&mut self, why: &str) {
        self.machine.lease.end();
        self.draw(Drawn::Jog);
        self.held = None;
        self.drop_task(why);
        self.stop_figure();
        // The report has the move at which it was stopped.
        self.note_run();
        self.end_figure(why);
    }
}

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
        if self.machine.is_emergency_asked() {
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
        self.ended(why);
        self.refuse_waiting()?;
        let text = format!("the machine has stopped: {why}");
        self.machine.tell(From::Server, text);
        Ok(())
    }

    /// Whether somebody wants the machine to be stopped, and it does not stand yet.
    pub(super) fn is_halting(&self) -> bool {
        self.is_stopping || self.machine.stop.is_asked() || self.machine.is_emergency_asked()
    }

    /// The emergency stop: nothing moves until the reset of the panel. If it is not confirmed, it
    /// is asked for again when the controller answers.
    fn stop_for_good(&mut self) -> Result<(), String> {
        self.is_stopping = true;
        let stopped = self.client.stop_for_good();
        let stopped = stopped.and_then(|how| Ok((how, self.client.status()?)));
        let (how, status) = stopped.inspect_err(|why| {
            let text = format!("{why}. It is asked for again when the controller answers");
            self.machine.emergency_waits(&text);
        })?;
        self.status = status;
        self.was_latched = self.is_latched();
        self.ended("emergency stop");
        self.refuse_waiting()?;
        self.machine.emergency_made();
        self.machine
            .tell(From::Server, format!("EMERGENCY STOP: {how}"));
        Ok(())
    }

    /// The machine stands after a stop. What was asked for before, and still waits, is refused.
    fn refuse_waiting(&mut self) -> Result<(), String> {
        self.is_stopping = true;
        while let Ok(asked) = self.requests.try_recv() {
            self.carry_out(asked)?;
        }
        self.is_stopping = false;
        self.machine.stop.clear();
        Ok(())
    }

    /// Notes that an emergency stop has begun to hold, for example that of the panel, or was reset.
    /// Returns whether it was so.
    ///
    /// # Errors
    ///
    /// The controller is lost.
    pub(super) fn look_at_latch(&mut self) -> Result<bool, String> {
        let is_latched = self.is_latched();
        let was_latched = std::mem::replace(&mut self.was_latched, is_latched);
        match (was_latched, is_latched) {
            (true, false) => self.begin_again()?,
            (false, true) => {
                self.ended("emergency stop");
                self.machine.tell(From::Controller, "EMERGENCY STOP");
            }
            _ => return Ok(false),
        }
        Ok(true)
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

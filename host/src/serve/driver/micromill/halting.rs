//! STOP: the controller ends any motion at once, and its position stays valid.

use super::orders::{Purpose, Sent};
use super::{Driver, From};
use husillo_transports::micromill::{Order, Outcome};

/// A stop is sent at most this often.
const TRIES: u8 = 5;

/// A stop that is being carried out.
#[derive(Debug)]
pub(super) struct Halting {
    tries: u8,
}

impl Driver<'_> {
    /// Begins a stop that somebody has requested, or that is due because the operator has gone.
    pub(super) fn halt(&mut self) {
        if self.halting.is_some() {
            return;
        }
        let has_left = self.machine.take_left();
        if self.machine.stop.is_asked() {
            self.begin_halt("stopped");
        } else if has_left && !self.running.course.is_active() && self.is_busy() {
            self.begin_halt("its operator has gone");
        }
    }

    fn begin_halt(&mut self, why: &str) {
        self.machine.lease.end();
        self.drop_orders(why);
        self.stop_program();
        self.halting = Some(Halting { tries: TRIES });
        self.send_halt();
    }

    fn send_halt(&mut self) {
        self.session.interrupt();
        self.tell_sent(Order::Stop);
        self.current = Some(Sent::started(Order::Stop, Purpose::Halt));
    }

    /// The controller has answered a stop.
    ///
    /// # Errors
    ///
    /// It does not confirm it.
    pub(super) fn halted(&mut self, outcome: Outcome) -> Result<(), String> {
        if outcome == Outcome::Done {
            self.halting = None;
            self.machine.stop.clear();
            self.ask_place(Order::Stop)?;
            self.end_program("stopped");
            self.machine.tell(From::Server, "the machine has stopped");
            return Ok(());
        }
        // The stop has completed a string that was dropped, or a bit was wrong.
        match &mut self.halting {
            Some(halting) if halting.tries > 0 => {
                halting.tries -= 1;
                self.send_halt();
                Ok(())
            }
            _ => Err(
                "the stop was sent and is not confirmed: be ready to switch off the \
                      machine"
                    .into(),
            ),
        }
    }
}

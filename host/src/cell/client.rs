//! The host's side of the microfactory's link.

use super::action::Action;
use super::device::Device;
use crate::wire::Wire;
use husillo_transports::byte_commands::{ByteTable, REJECTED};
use std::time::Duration;

/// Longest wait for an answer: two bytes of 1.04 ms, and a computer that is busy.
const ANSWER: Duration = Duration::from_millis(200);
/// Between two questions whether it stands.
const ASK: Duration = Duration::from_millis(50);
/// Between two times a jog is said, well within the dead-man's time.
const AGAIN: Duration = Duration::from_millis(100);
/// The longest a homing or a figure may take: 20 000 steps at 100 a second, three times; and of a figure that long.
const LONGEST: Duration = Duration::from_secs(900);
/// What a device that does not answer is given for homing.
const HOMING: Duration = Duration::from_secs(120);

/// The host's side.
pub struct Client {
    wire: Wire<Device>,
    answers: bool,
}

/// How a byte was answered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Answer {
    Taken,
    Rejected,
}

impl Client {
    /// On a wire to a device that answers, or to one that does not.
    pub const fn new(wire: Wire<Device>, answers: bool) -> Self {
        Self { wire, answers }
    }

    /// What a simulated device told.
    pub fn told(&mut self) -> Vec<String> {
        self.wire.told()
    }

    /// Carries out an action and waits until it has ended: the seconds it took.
    ///
    /// # Errors
    ///
    /// A sentence about the link, or that the device does not take a command.
    pub fn carry_out(&mut self, action: &Action) -> Result<f64, String> {
        let table = ByteTable::DEFAULT;
        let start = self.wire.elapsed();
        match *action {
            Action::Home => {
                self.command(&[table.home])?;
                self.stand(HOMING)?;
            }
            Action::Figure => {
                self.command(&[table.figure])?;
                self.stand(LONGEST)?;
            }
            Action::Steps { motor, steps } => self.steps(&table, motor, steps)?,
            Action::Jog {
                motor,
                forward,
                time,
            } => {
                self.command(&[table.manual])?;
                let end = self.wire.elapsed() + time;
                while self.wire.elapsed() < end {
                    if self.send(letter(&table, motor, forward))? == Answer::Rejected {
                        // A switch has ended it.
                        break;
                    }
                    self.pause(AGAIN.min(end.saturating_sub(self.wire.elapsed())))?;
                }
                self.send(table.stop)?;
                self.stand(ANSWER)?;
            }
            Action::Stop => {
                self.send(table.stop)?;
            }
            Action::Emergency => {
                // Twice: after a motor's letter the first one would be its count.
                for _ in 0..2 {
                    self.send(table.emergency)?;
                }
            }
        }
        Ok((self.wire.elapsed() - start).as_secs_f64())
    }

    /// Counted steps, 255 at most at a time.
    fn steps(&mut self, table: &ByteTable, motor: u8, steps: i32) -> Result<(), String> {
        let forward = steps > 0;
        let mut left = steps.unsigned_abs();
        while left > 0 {
            let count = u8::try_from(left.min(255)).unwrap_or(u8::MAX);
            self.command(&[table.steps, letter(table, motor, forward), count, table.run])?;
            // 64 steps a second at least, and a take-up of 200 steps before them.
            self.stand(Duration::from_secs_f64((f64::from(count) + 250.0) / 64.0))?;
            left -= u32::from(count);
        }
        Ok(())
    }

    /// Bytes that must all be taken.
    fn command(&mut self, bytes: &[u8]) -> Result<(), String> {
        for byte in bytes {
            if self.send(*byte)? == Answer::Rejected {
                return Err(format!(
                    "the device does not take `{}` now: it moves, or was stopped by an emergency stop (then reset it)",
                    char::from(*byte).escape_default()
                ));
            }
        }
        Ok(())
    }

    /// A byte and its answer; to a device that does not answer, the time of the byte.
    fn send(&mut self, byte: u8) -> Result<Answer, String> {
        self.wire.send(byte).map_err(|error| error.to_string())?;
        if !self.answers {
            self.pause(Duration::from_millis(2))?;
            return Ok(Answer::Taken);
        }
        match self.wire.receive(ANSWER).map_err(|error| error.to_string())? {
            Some(answer) if answer == byte && byte != REJECTED => Ok(Answer::Taken),
            Some(REJECTED) => Ok(Answer::Rejected),
            Some(other) => Err(format!(
                "sent {byte:#04x} and {other:#04x} came back: the line is noisy, or the device is another one; nothing more was sent"
            )),
            None => Err("no answer: no device there, unplugged, or one that does not answer (then --without-answers)".into()),
        }
    }

    /// Waits until nothing moves. A device that answers is asked: it takes a mode only then. Otherwise all of the time passes.
    fn stand(&mut self, longest: Duration) -> Result<(), String> {
        if !self.answers {
            return self.pause(longest);
        }
        let end = self.wire.elapsed() + LONGEST.max(longest);
        while self.send(ByteTable::DEFAULT.steps)? == Answer::Rejected {
            if self.wire.elapsed() > end {
                return Err("the device still does not stand".into());
            }
            self.pause(ASK)?;
        }
        Ok(())
    }

    fn pause(&mut self, time: Duration) -> Result<(), String> {
        let end = self.wire.elapsed() + time;
        while self.wire.elapsed() < end {
            let left = end - self.wire.elapsed();
            if let Some(byte) = self.wire.receive(left).map_err(|error| error.to_string())? {
                return Err(format!("{byte:#04x} came without being asked for"));
            }
        }
        Ok(())
    }
}

fn letter(table: &ByteTable, motor: u8, forward: bool) -> u8 {
    let [plus, minus] = table
        .motors
        .get(usize::from(motor))
        .copied()
        .unwrap_or([0; 2]);
    if forward { plus } else { minus }
}

//! Commands: each is begun, followed by questions, and answered when it has ended.

use super::Driver;
use crate::serve::console_lines::From;
use crate::serve::reply::Reply;
use crate::serve::tool_path::Motion as Drawn;
use husillo_clients::microfactory::Motion;
use husillo_sim::device::microfactory as device;
use husillo_transports::microfactory::Report;
use std::time::Duration;

/// Interval of the questions while something moves.
const ASK: Duration = Duration::from_millis(40);
/// Interval of the questions at rest.
const ASK_AT_REST: Duration = Duration::from_millis(500);

/// A command that is carried out.
#[derive(Debug)]
pub(super) struct Task {
    pub(super) motion: Motion,
    /// Where the answer goes. None: it is the figure.
    reply: Option<Reply>,
    /// Steps before it.
    from: [i32; 4],
}

impl Driver<'_> {
    /// Begins a command by hand.
    ///
    /// # Errors
    ///
    /// The controller is lost.
    pub(super) fn by_hand(&mut self, motion: Motion, reply: Reply) -> Result<(), String> {
        match self.is_free() {
            Ok(()) => self.begin(motion, Some(reply)),
            Err(why) => {
                reply.error(why);
                Ok(())
            }
        }
    }

    /// Begins a command.
    ///
    /// # Errors
    ///
    /// The controller is lost.
    pub(super) fn begin(&mut self, motion: Motion, reply: Option<Reply>) -> Result<(), String> {
        self.task = Some(Task {
            motion,
            reply,
            from: self.status.position_steps,
        });
        self.machine.tell(From::Host, motion.to_string());
        if let Err(why) = self.client.begin(motion) {
            // It may have begun, or know why not.
            self.status = self.client.halt()?;
            let why = match self.status.report {
                Some(report @ (Report::NoFigure | Report::Emergency)) => device::text(report),
                _ => why,
            };
            return self.finish(Err(why));
        }
        self.asked_at = self.client.elapsed();
        self.status.is_moving = true;
        Ok(())
    }

    /// Asks where the machine is, if that is due.
    ///
    /// # Errors
    ///
    /// The controller is lost.
    pub(super) fn follow(&mut self) -> Result<(), String> {
        let is_moving = self.is_at_work() || self.status.is_moving;
        let every = if is_moving { ASK } else { ASK_AT_REST };
        // Nobody asks in the middle of a figure that is being stored.
        let is_due = self.client.elapsed() >= self.asked_at + every;
        if !is_due || self.running.stored().is_some() {
            return Ok(());
        }
        self.asked_at = self.client.elapsed();
        self.status = self.client.status()?;
        if self.look_at_latch()? {
            return Ok(());
        }
        let Some(task) = &self.task else {
            // A jog, or an axis that backs off a switch.
            self.draw(Drawn::Jog);
            return Ok(());
        };
        self.draw(match task.motion {
            Motion::Figure if self.has_contact => Drawn::Feed,
            Motion::Figure | Motion::Home => Drawn::Rapid,
            _ => Drawn::Jog,
        });
        let motion = task.motion;
        if motion == Motion::Figure {
            self.cut();
        }
        if self.status.is_moving {
            return Ok(());
        }
        let wanted = match motion {
            Motion::Home => Report::Homed,
            _ => Report::Done,
        };
        let result = match self.status.report {
            Some(report) if report == wanted => self.as_asked(),
            Some(report) => Err(device::text(report)),
            None => Err("the controller was reset".into()),
        };
        let result = match (motion, result) {
            (Motion::Home, Ok(())) => {
                self.draw(Drawn::Begin);
                if let Some(lost) = self.client.lost_steps()? {
                    self.machine.tell(From::Controller, lost);
                }
                Ok(())
            }
            (_, result) => result,
        };
        self.finish(result)
    }

    /// Whether the motors have made what they should.
    fn as_asked(&self) -> Result<(), String> {
        let Some(task) = &self.task else {
            return Ok(());
        };
        let to = self.status.position_steps;
        let moved = |motor: usize| {
            let at = |steps: &[i32; 4]| steps.get(motor).copied().unwrap_or_default();
            at(&to).wrapping_sub(at(&task.from))
        };
        match task.motion {
            Motion::Steps {
                motor,
                forward,
                count,
            } => {
                let delta = if forward { 1 } else { -1 } * i32::from(count);
                let made = moved(usize::from(motor));
                match made == delta {
                    true => Ok(()),
                    false => Err(format!("the motor made {made} steps instead of {delta}")),
                }
            }
            Motion::Figure if [moved(0), moved(2)] != self.running.cutting.end() => {
                Err("the figure ended at a wrong position: another figure was cut".into())
            }
            _ => Ok(()),
        }
    }

    /// A command has ended.
    fn finish(&mut self, result: Result<(), String>) -> Result<(), String> {
        let Some(task) = self.task.take() else {
            return Ok(());
        };
        let text = result.as_ref().map_or_else(String::as_str, |()| "done");
        let text = format!("{}: {text}", task.motion);
        self.machine.tell(From::Controller, text);
        match task.reply {
            Some(reply) => reply.with(result),
            None => self.figure_ended(result),
        }
        Ok(())
    }

    /// What was asked for is not carried out to its end.
    pub(super) fn drop_task(&mut self, why: &str) {
        if let Some(reply) = self.task.take().and_then(|task| task.reply) {
            reply.error(why);
        }
    }
}

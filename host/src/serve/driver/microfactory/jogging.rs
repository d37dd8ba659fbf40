//! Jogs and steps. A motor turns while the page renews its lease, and this driver repeats its
//! letter.

use super::Driver;
use crate::serve::axes::Axes;
use crate::serve::console_lines::From;
use crate::serve::reply::Reply;
use crate::serve::tool_path::Motion as Drawn;
use husillo_clients::microfactory::Motion;
use husillo_sim::device::microfactory as device;
use serde_json::{Value, json};
use std::time::{Duration, Instant};

/// The controller ends a jog that is not repeated for half a second.
const AGAIN: Duration = Duration::from_millis(100);
/// Most steps of one command, as in the original.
const MOST_STEPS: f64 = 255.0;

/// A jog that a page holds.
#[derive(Clone, Copy, Debug)]
pub(super) struct Held {
    client: u64,
    number: u64,
    motor: u8,
    forward: bool,
    /// When its letter was sent. None: not yet.
    sent_at: Option<Duration>,
}

impl Held {
    /// The jog in the state of the machine.
    pub(super) fn shown(&self) -> Value {
        json!({"client": self.client, "jog": self.number})
    }

    pub(super) const fn motion(&self) -> Motion {
        Motion::Jog {
            motor: self.motor,
            forward: self.forward,
        }
    }
}

/// The motor of a request, and its part: X, Y, Z, or C for the spindle. One motor turns at a time.
fn of_motor(axes: &Axes) -> Result<(u8, f64), String> {
    // The letters of axes are x, y, z, a, b, c.
    let axes = axes.checked(6)?.into_iter();
    let mut moving = axes.filter(|(_, part)| *part != 0.0);
    match (moving.next(), moving.next()) {
        (Some((axis @ 0..=2, part)), None) => Ok((axis as u8, part)),
        (Some((5, part)), None) => Ok((3, part)),
        (Some(_), None) => Err("the motors are x, y, z and c".into()),
        (None, _) => Err("a motion needs a motor".into()),
        _ => Err("a microfactory turns one motor at a time".into()),
    }
}

impl Driver<'_> {
    /// Begins a jog.
    ///
    /// # Errors
    ///
    /// A sentence about why not.
    pub(super) fn begin_jog(
        &mut self,
        client: u64,
        number: u64,
        axes: &Axes,
    ) -> Result<(), String> {
        self.is_free()?;
        let (motor, part) = of_motor(axes)?;
        self.held = Some(Held {
            client,
            number,
            motor,
            forward: part > 0.0,
            sent_at: None,
        });
        Ok(())
    }

    /// Goes on with a jog, or ends it.
    ///
    /// # Errors
    ///
    /// The controller is lost.
    pub(super) fn jog(&mut self) -> Result<(), String> {
        let Some(mut held) = self.held else {
            return Ok(());
        };
        let (lease, now) = (&self.machine.lease, Instant::now());
        if !lease.holds(held.client, held.number, now) {
            let why = match lease.has_run_out(held.client, held.number, now) {
                true => "the page did not renew it",
                false => "released",
            };
            if held.sent_at.is_some() {
                self.status = self.client.halt()?;
            }
            self.end_jog(&held, why);
            return Ok(());
        }
        let time = self.client.elapsed();
        match held.sent_at {
            None => {
                self.machine.tell(From::Host, held.motion().to_string());
                if let Err(why) = self.client.begin(held.motion()) {
                    self.status = self.client.halt()?;
                    self.end_jog(&held, &why);
                    return Ok(());
                }
                self.status.is_moving = true;
            }
            Some(at) if time < at + AGAIN => return Ok(()),
            Some(_) => {
                if let Err(why) = self.repeat(&held)? {
                    self.end_jog(&held, &why);
                    return Ok(());
                }
            }
        }
        held.sent_at = Some(time);
        self.held = Some(held);
        Ok(())
    }

    /// Repeats the letter of a jog. The inner error is why it has ended.
    fn repeat(&mut self, held: &Held) -> Result<Result<(), String>, String> {
        Ok(match self.client.repeat_jog(held.motor, held.forward) {
            Ok(true) => Ok(()),
            Ok(false) => {
                // A switch has ended it. The axis backs off, and reports that.
                self.status = self.client.status()?;
                let why = self.status.report.map(device::text);
                Err(why.unwrap_or_else(|| "it was refused".into()))
            }
            Err(why) => {
                // A byte was lost. The jog ends, and not the link.
                self.status = self.client.halt()?;
                Err(why)
            }
        })
    }

    fn end_jog(&mut self, held: &Held, why: &str) {
        self.held = None;
        self.machine.lease.release(held.client, held.number);
        self.draw(Drawn::Jog);
        let text = format!("jog {} ends: {why}", held.number);
        self.machine.tell(From::Server, text);
    }

    /// Turns a motor by counted steps.
    ///
    /// # Errors
    ///
    /// The controller is lost.
    pub(super) fn steps(&mut self, steps: &Axes, reply: Reply) -> Result<(), String> {
        let (motor, steps) = match of_motor(steps) {
            Ok(asked) => asked,
            Err(why) => {
                reply.error(why);
                return Ok(());
            }
        };
        if steps.fract() != 0.0 || steps.abs() > MOST_STEPS {
            reply.error("1 to 255 whole steps");
            return Ok(());
        }
        let motion = Motion::Steps {
            motor,
            forward: steps > 0.0,
            count: steps.abs() as u8,
        };
        self.by_hand(motion, reply)
    }
}

//! STOP: the axes brake, then the controller is reset.
//!
//! After the hold the position is still valid. A second request resets the controller during the
//! motion, and the position is lost.

use super::{Driver, From};
use husillo_clients::grbl::Heard;
use husillo_transports::grbl::Realtime;
use std::time::{Duration, Instant};

/// After a hold a motion has stopped within this time. Ramps take a second or two.
const HOLD: Duration = Duration::from_secs(10);
/// Requests within this time are one: a key that repeats, or several pages.
const ONE_PRESS: Duration = Duration::from_millis(400);
/// A controller has started within this time after a reset.
const START: Duration = Duration::from_secs(5);

/// A stop that is being carried out.
#[derive(Debug)]
pub(super) struct Halting {
    begun: Instant,
    /// Requests when it began.
    requests: u32,
    /// Status reports since then.
    reports: u32,
    /// Reset at once.
    at_once: bool,
    /// When the reset was sent.
    reset_at: Option<Instant>,
    /// What those are told whose lines are dropped.
    why: &'static str,
}

impl Driver<'_> {
    /// Begins and goes on with a stop.
    ///
    /// # Errors
    ///
    /// The controller is lost, or does not confirm the stop.
    pub(super) fn halt(&mut self) -> Result<(), String> {
        if self.machine.stop.is_asked() && self.halting.is_none() {
            self.begin_halt(false, "stopped")?;
        }
        let Some(halting) = &mut self.halting else {
            return Ok(());
        };
        if halting.begun.elapsed() < ONE_PRESS {
            halting.requests = self.machine.stop.count();
        }
        if let Some(reset_at) = halting.reset_at {
            return match reset_at.elapsed() > START {
                true => Err(
                    "the stop was sent and is not confirmed: be ready to switch off the \
                             machine"
                        .into(),
                ),
                false => Ok(()),
            };
        }
        // The controller may have sent the first report before it received the hold.
        let stands = halting.reports >= 2 && !self.session.is_in_motion();
        let is_pressed_again = self.machine.stop.count() > halting.requests;
        if stands || is_pressed_again || halting.at_once || halting.begun.elapsed() > HOLD {
            self.put(Realtime::Reset)?;
            if let Some(halting) = &mut self.halting {
                halting.reset_at = Some(Instant::now());
            }
        }
        Ok(())
    }

    /// Begins a stop. Lines that wait are dropped when the controller has started again.
    ///
    /// # Errors
    ///
    /// The controller is lost.
    pub(super) fn begin_halt(&mut self, at_once: bool, why: &'static str) -> Result<(), String> {
        // Homing has no hold, so a reset ends it.
        let is_homing = self.is_homing();
        self.machine.lease.end();
        self.stop_program();
        self.halting = Some(Halting {
            begun: Instant::now(),
            requests: self.machine.stop.count(),
            reports: 0,
            at_once: at_once || is_homing,
            reset_at: None,
            why,
        });
        if !at_once {
            self.put(Realtime::Hold)?;
            self.put(Realtime::JogCancel)?;
            self.session.put(&[Realtime::Status.byte()])?;
        }
        Ok(())
    }

    /// Counts what was heard during a stop.
    pub(super) fn hear_halt(&mut self, heard: &Heard) {
        match (&mut self.halting, heard) {
            (Some(halting), Heard::Status(_)) => halting.reports += 1,
            (Some(halting), Heard::Started(_)) if halting.reset_at.is_some() => {
                let why = halting.why;
                self.halting = None;
                self.machine.stop.clear();
                self.drop_lines(why);
                self.machine.tell(From::Server, "the machine has stopped");
                self.modes_are_due = true;
            }
            _ => {}
        }
    }
}

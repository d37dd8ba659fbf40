//! Jogs that go on while the page renews their lease.
//!
//! Grbl has no jog without an end. The motion is made of short jogs, one after the other. So few of
//! them wait in the controller that it stops by itself if this program is lost: those of 200 ms,
//! and of the distance in which the axes brake.

use super::{Driver, From, Purpose};
use crate::serve::axes::{Axes, feed, words};
use husillo_transports::grbl::{Realtime, State};
use serde_json::{Value, json};
use std::time::{Duration, Instant};

/// Time of motion that is sent ahead, s, in addition to the time in which the axes brake.
const AHEAD_S: f64 = 0.2;
/// Parts of the distance that is sent ahead.
const PARTS: f64 = 4.0;
/// Shortest part, mm.
const SHORTEST_MM: f64 = 0.01;
/// A jog that goes on after its end is cancelled again after this time.
const AGAIN: Duration = Duration::from_millis(100);

/// Accelerations and rates of a controller that does not report its settings, mm/s^2 and mm/min.
const ACCELERATION: f64 = 10.0;
const RATE: f64 = 500.0;

/// A jog that a page holds.
#[derive(Clone, Debug)]
struct Held {
    client: u64,
    number: u64,
    /// Direction, of length 1.
    direction: Vec<(usize, f64)>,
    /// Speed along the path, mm/min.
    feed: f64,
    /// Way that is sent ahead, mm.
    ahead_mm: f64,
    /// Machine or work position at its start, mm.
    start: Vec<f64>,
    /// Way that was sent, mm.
    sent_mm: f64,
}

/// The jog of a machine.
#[derive(Debug, Default)]
pub(super) struct Jogging {
    held: Option<Held>,
    /// The jog that follows when the machine stands.
    next: Option<Held>,
    /// When a jog was cancelled that has not ended yet.
    cancelled_at: Option<Instant>,
}

impl Jogging {
    /// Whether a jog runs or ends.
    pub(super) const fn is_active(&self) -> bool {
        self.held.is_some() || self.next.is_some() || self.cancelled_at.is_some()
    }

    /// The jog in the state of the machine.
    pub(super) fn shown(&self) -> Option<Value> {
        // While the direction changes, the jog goes on.
        let held = self.held.as_ref().or(self.next.as_ref())?;
        Some(json!({"client": held.client, "jog": held.number}))
    }

    /// Forgets everything, after a reset of the controller.
    pub(super) fn forget(&mut self) {
        *self = Self::default();
    }
}

impl Driver<'_> {
    /// Begins a jog, or changes the one that runs.
    ///
    /// # Errors
    ///
    /// A sentence about why not.
    pub(super) fn begin_jog(
        &mut self,
        client: u64,
        number: u64,
        axes: &Axes,
        speed: f64,
    ) -> Result<(), String> {
        if !self.jogging.is_active() {
            self.is_free()?;
        }
        let axes = axes.checked(self.state.axes.len())?;
        let length = axes.iter().map(|(_, part)| part * part).sum::<f64>().sqrt();
        if length < 1e-3 {
            return Err("a jog needs a direction".into());
        }
        let direction: Vec<_> = axes
            .iter()
            .map(|(axis, part)| (*axis, part / length))
            .collect();
        let (feed, ahead_mm) = self.pace(&direction, feed(speed)?);
        let text = format!("jog {number}: {} at F{feed:.0}", words(&direction));
        self.machine.tell(From::Server, text);
        self.jogging.next = Some(Held {
            client,
            number,
            direction,
            feed,
            ahead_mm,
            start: Vec::new(),
            sent_mm: 0.0,
        });
        Ok(())
    }

    /// The speed that the axes reach, mm/min, and the distance that is sent ahead, mm.
    fn pace(&self, direction: &[(usize, f64)], speed: f64) -> (f64, f64) {
        let setting = |first: u16, axis: usize, default: f64| {
            let number = first + u16::try_from(axis).unwrap_or(0);
            let value = self
                .settings
                .get(&number)
                .and_then(|text| text.parse().ok());
            value.filter(|value: &f64| *value > 0.0).unwrap_or(default)
        };
        let least = |first, default| {
            let moving = direction.iter().filter(|(_, part)| *part != 0.0);
            moving
                .map(|(axis, part)| setting(first, *axis, default) / part.abs())
                .fold(f64::INFINITY, f64::min)
        };
        let feed = speed.min(least(110, RATE));
        let per_s = feed / 60.0;
        let braking = per_s * per_s / (2.0 * least(120, ACCELERATION));
        (feed, per_s * AHEAD_S + braking)
    }

    /// Goes on with a jog, or ends it.
    ///
    /// # Errors
    ///
    /// The controller is lost.
    pub(super) fn jog(&mut self) -> Result<(), String> {
        let is_by_hand = !self.running.course.is_active() || self.is_changing();
        let is_by_hand = is_by_hand && self.halting.is_none();
        if self.machine.take_left() && is_by_hand {
            match self.sequence.is_some() {
                true => self.begin_halt(false, "its operator has gone")?,
                // A move that has just been sent may not be in a report yet.
                false => self.cancel_jog("its operator has gone")?,
            }
        }
        if self.halting.is_some() {
            self.jogging.next = None;
            return Ok(());
        }
        if let Some(held) = &self.jogging.held {
            let now = Instant::now();
            let (client, number) = (held.client, held.number);
            if self.machine.lease.has_run_out(client, number, now) {
                self.cancel_jog("the page did not renew it")?;
            } else if !self.machine.lease.holds(client, number, now) {
                self.cancel_jog("released")?;
            }
        }
        self.finish_jog()?;
        self.start_jog();
        self.extend_jog();
        Ok(())
    }

    /// Cancels what runs of a jog.
    fn cancel_jog(&mut self, why: &str) -> Result<(), String> {
        if let Some(held) = self.jogging.held.take() {
            let text = format!("jog {} ends: {why}", held.number);
            self.machine.tell(From::Server, text);
        }
        self.waiting
            .retain(|(_, purpose)| !matches!(purpose, Purpose::Jog));
        self.jogging.cancelled_at = Some(Instant::now());
        self.put(Realtime::JogCancel)
    }

    /// Waits for the end of a jog that was cancelled. A part that the controller receives
    /// after the byte that cancels is carried out, so that byte is sent again.
    fn finish_jog(&mut self) -> Result<(), String> {
        let Some(cancelled_at) = self.jogging.cancelled_at else {
            return Ok(());
        };
        if cancelled_at.elapsed() < AGAIN || self.has_parts() {
            return Ok(());
        }
        if self.session.state() == Some(State::Jog) {
            self.jogging.cancelled_at = Some(Instant::now());
            return self.put(Realtime::JogCancel);
        }
        self.jogging.cancelled_at = None;
        Ok(())
    }

    /// Begins the next jog when the one before has ended.
    fn start_jog(&mut self) {
        let Some(next) = &self.jogging.next else {
            return;
        };
        let now = Instant::now();
        if !self.machine.lease.holds(next.client, next.number, now) {
            self.jogging.next = None;
        } else if self.jogging.held.is_some() {
            // Another direction: the machine stands first.
            self.jogging.held = None;
            self.jogging.cancelled_at = Some(now);
            // A failure is found at the next turn.
            let _ = self.put(Realtime::JogCancel);
        } else if self.jogging.cancelled_at.is_none()
            && matches!(self.session.state(), Some(State::Idle | State::Tool))
        {
            let start = self.place();
            self.jogging.held = self.jogging.next.take().map(|next| Held { start, ..next });
        }
    }

    /// Sends the next part if little of the distance is left.
    fn extend_jog(&mut self) {
        // An answered part is in the queue. So at most one part is sent and not answered.
        if self.has_parts() {
            return;
        }
        let place = self.place();
        let Some(held) = &mut self.jogging.held else {
            return;
        };
        let made = held
            .direction
            .iter()
            .map(|(axis, part)| {
                let at = |place: &[f64]| place.get(*axis).copied().unwrap_or(0.0);
                (at(&place) - at(&held.start)) * part
            })
            .sum::<f64>();
        let part_mm = (held.ahead_mm / PARTS).max(SHORTEST_MM);
        if held.sent_mm - made + part_mm > held.ahead_mm + SHORTEST_MM {
            return;
        }
        let rounded = |distance: f64, part: f64| (distance * part * 1e3).round() / 1e3;
        let end_mm = held.sent_mm + part_mm;
        let by: Vec<_> = held
            .direction
            .iter()
            .map(|(axis, part)| (*axis, rounded(end_mm, *part) - rounded(held.sent_mm, *part)))
            .collect();
        held.sent_mm = end_mm;
        let line = format!("$J=G21G91{}F{:.1}", words(&by), held.feed);
        self.send(line, Purpose::Jog);
    }

    /// Handles the answer to a part of a jog.
    pub(super) fn jog_answered(&mut self, result: Result<(), String>) {
        let Err(why) = result else { return };
        if let Some(held) = self.jogging.held.take() {
            self.machine.lease.release(held.client, held.number);
            let text = format!("jog {} ends: {why}", held.number);
            self.state.why = Some(text.clone());
            self.machine.tell(From::Server, text);
        }
    }

    /// Whether a part waits or is not answered.
    fn has_parts(&self) -> bool {
        let is_part = |purpose: &Purpose| matches!(purpose, Purpose::Jog);
        self.stream.purposes().any(is_part) || self.waiting.iter().any(|(_, of)| is_part(of))
    }

    /// The reported position, mm. Only differences of it are used.
    fn place(&self) -> Vec<f64> {
        let known = self
            .state
            .machine_mm
            .as_ref()
            .or(self.state.work_mm.as_ref());
        known.cloned().unwrap_or_default()
    }
}

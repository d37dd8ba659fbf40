//! Jogs that go on while the page renews their lease.
//!
//! A jog of the mill has no end of its own. It ends when this driver sends a stop: when the page
//! lets go, does not renew its lease in time, or is gone. If this program is lost, the controller
//! ends the jog, because nothing renews its own lease of 250 ms.

use super::orders::{Purpose, Sent};
use super::{Driver, From};
use crate::serve::axes::Axes;
use husillo_transports::micromill::{Axis, Order};
use serde_json::{Value, json};
use std::time::Instant;

/// Steps per second of a jog at its begin.
const JOG_HZ: u16 = 170;
/// Change of the speed of a jog, steps per second.
const CHANGE_HZ: u16 = 10;
/// The fastest jog, steps per second.
const TOP_HZ: u16 = 390;
/// Changes of the speed that wait.
const MOST_CHANGES: i8 = 40;

/// A jog that a page holds.
#[derive(Clone, Copy, Debug)]
struct Held {
    client: u64,
    number: u64,
    order: Order,
}

/// The jog of a mill.
#[derive(Debug, Default)]
pub(super) struct Jogging {
    held: Option<Held>,
    /// The jog that follows when the mill stands.
    next: Option<Held>,
    /// Why the jog ends. The stop waits for room on the link.
    ending: Option<&'static str>,
    /// The stop is on the link.
    is_stopping: bool,
    /// Changes of the speed that wait: positive ones are faster.
    changes: i8,
    /// Steps per second.
    hz: u16,
}

impl Jogging {
    /// Whether a jog runs or ends.
    pub(super) const fn is_active(&self) -> bool {
        self.held.is_some() || self.next.is_some()
    }

    /// Whether another jog follows.
    pub(super) const fn has_next(&self) -> bool {
        self.next.is_some()
    }

    /// The jog in the state of the machine.
    pub(super) fn shown(&self) -> Option<Value> {
        // While the direction changes, the jog goes on.
        let held = self.held.as_ref().or(self.next.as_ref())?;
        Some(json!({"client": held.client, "jog": held.number}))
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
        hz: Option<u16>,
    ) -> Result<(), String> {
        if !self.jogging.is_active() {
            self.is_free()?;
        }
        let mut ways = [0_i8; 3];
        for (axis, part) in axes.checked(3)? {
            if let Some(way) = ways.get_mut(axis).filter(|_| part != 0.0) {
                *way = if part > 0.0 { 1 } else { -1 };
            }
        }
        let moving = Axis::ALL.into_iter().zip(ways).filter(|(_, way)| *way != 0);
        let order = match (&moving.collect::<Vec<_>>()[..], hz) {
            ([], _) => return Err("a jog needs a direction".into()),
            (_, None) => Order::Jog(ways),
            (_, Some(hz)) if !(1..=TOP_HZ).contains(&hz) => {
                return Err(format!("the mill runs at 1 to {TOP_HZ} steps per second"));
            }
            ([(axis, way)], Some(hz)) => Order::Run(*axis, i16::from(*way) * hz as i16),
            _ => return Err("only one axis runs at a speed of its own".into()),
        };
        self.jogging.next = Some(Held {
            client,
            number,
            order,
        });
        Ok(())
    }

    /// Makes the jog faster or slower.
    ///
    /// # Errors
    ///
    /// Nothing jogs, or the jog has a rate of its own.
    pub(super) fn change_pace(&mut self, is_faster: bool) -> Result<(), &'static str> {
        let jogging = &mut self.jogging;
        match jogging.held.as_ref().map(|held| held.order) {
            Some(Order::Jog(_)) => {}
            Some(_) => return Err("a jog with a rate of its own keeps it"),
            None => return Err("nothing jogs"),
        }
        let by = if is_faster { 1 } else { -1 };
        jogging.changes = (jogging.changes + by).clamp(-MOST_CHANGES, MOST_CHANGES);
        Ok(())
    }

    /// Goes on with a jog, or ends it.
    pub(super) fn jog(&mut self) {
        if self.halting.is_some() {
            return;
        }
        let now = Instant::now();
        if let Some(held) = self.jogging.held {
            let lease = &self.machine.lease;
            let why = match () {
                () if self.jogging.next.is_some() => Some("another one follows"),
                () if lease.has_run_out(held.client, held.number, now) => {
                    Some("the page did not renew it")
                }
                () if !lease.holds(held.client, held.number, now) => Some("released"),
                () => None,
            };
            self.jogging.ending = self.jogging.ending.or(why);
        }
        self.end_jog();
        self.pace_jog();
        let is_free = self.jogging.held.is_none() && !self.is_busy();
        if let Some(next) = self.jogging.next.take_if(|_| is_free) {
            if !self.machine.lease.holds(next.client, next.number, now) {
                return;
            }
            self.jogging = Jogging {
                held: Some(next),
                hz: match next.order {
                    Order::Run(_, hz) => hz.unsigned_abs(),
                    _ => JOG_HZ,
                },
                ..Jogging::default()
            };
            self.waiting.push_back(Sent::new(next.order, Purpose::Jog));
        }
        let hz = self.jogging.held.is_some().then_some(self.jogging.hz);
        if let Some(mill) = &mut self.state.mill {
            mill.jog_hz = hz;
        }
    }

    /// Sends the stop of a jog that ends.
    fn end_jog(&mut self) {
        let Some(why) = self.jogging.ending.filter(|_| !self.jogging.is_stopping) else {
            return;
        };
        if !self.is_sent() {
            // A jog that was not sent yet is not sent.
            let is_other = |sent: &Sent| !matches!(sent.purpose, Purpose::Jog);
            self.current.take_if(|sent| !is_other(sent));
            self.waiting.retain(is_other);
            self.jogging.held = None;
            self.jogging.ending = None;
        } else if self.session.start(Order::Stop) {
            self.jogging.is_stopping = true;
            let number = self.jogging.held.map_or(0, |held| held.number);
            self.tell_sent(Order::Stop);
            self.machine
                .tell(From::Server, format!("jog {number} ends: {why}"));
        }
    }

    /// Sends a change of the speed.
    fn pace_jog(&mut self) {
        let jogging = &self.jogging;
        if jogging.changes == 0 || jogging.held.is_none() || jogging.ending.is_some() {
            return;
        }
        let (order, by) = match jogging.changes > 0 {
            true => (Order::Faster, 1),
            false => (Order::Slower, -1),
        };
        // Only beside the jog: its string is on the link, and no other one.
        if self.is_sent() && self.session.start(order) {
            let jogging = &mut self.jogging;
            jogging.changes -= by;
            jogging.hz = match by > 0 {
                true => (jogging.hz + CHANGE_HZ).min(TOP_HZ),
                false => jogging.hz.saturating_sub(CHANGE_HZ).max(CHANGE_HZ),
            };
            self.machine.tell(From::Host, super::orders::text(order));
        }
    }

    /// The controller has ended a jog.
    pub(super) fn jog_ended(&mut self, result: Result<(), &str>) {
        let Some(held) = self.jogging.held.take() else {
            return;
        };
        let is_ours = std::mem::take(&mut self.jogging.is_stopping);
        self.jogging.ending = None;
        self.jogging.changes = 0;
        if !is_ours {
            self.machine.lease.release(held.client, held.number);
            let why = result.err().unwrap_or("the controller has ended it");
            let text = format!("jog {} ends: {why}", held.number);
            self.machine.tell(From::Server, text);
        }
    }
}

//! Jogs that go on while the page renews their lease: one key of the manual mode after the other.
//!
//! A key makes so few steps that a jog ends within a tenth of a second after its lease. If this
//! program is lost, no further key is sent.

use super::bench::{Bench, Work};
use super::stepping::Trouble;
use super::{Driver, From};
use crate::serve::axes::Axes;
use serde_json::{Value, json};
use std::time::Instant;

/// Steps of one key of a jog: a tenth of a second at 247 Hz.
const KEY_STEPS: u8 = 25;

/// A jog that a page holds.
#[derive(Clone, Copy, Debug)]
struct Held {
    client: u64,
    number: u64,
    /// Direction of each axis.
    ways: [i8; 3],
}

/// The jog of a drill.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Jogging {
    held: Option<Held>,
    /// The axis whose turn it is.
    axis: usize,
}

impl Jogging {
    /// Whether a jog goes on.
    pub(super) const fn is_active(&self) -> bool {
        self.held.is_some()
    }

    /// The page that jogs.
    pub(super) fn client(&self) -> u64 {
        self.held.map_or(0, |held| held.client)
    }

    /// The jog in the state of the machine.
    pub(super) fn shown(&self) -> Option<Value> {
        let held = self.held?;
        Some(json!({"client": held.client, "jog": held.number}))
    }
}

impl Bench<'_> {
    /// Begins a jog, or changes the one that goes on.
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
        let begun = self.ways(axes).map(|ways| Held {
            client,
            number,
            ways,
        });
        match begun {
            Ok(held) => {
                self.jogging.held = Some(held);
                Ok(())
            }
            Err(why) => {
                self.machine.lease.release(client, number);
                Err(why)
            }
        }
    }

    fn ways(&self, axes: &Axes) -> Result<[i8; 3], String> {
        if !self.jogging.is_active() {
            self.is_free()?;
        }
        self.expect_manual()?;
        let mut ways = [0_i8; 3];
        for (axis, part) in axes.checked(3)? {
            if let Some(way) = ways.get_mut(axis).filter(|_| part != 0.0) {
                *way = if part > 0.0 { 1 } else { -1 };
            }
        }
        match ways {
            [0, 0, 0] => Err("a jog needs a direction".into()),
            ways => Ok(ways),
        }
    }

    /// Expects the manual mode, which has the keys.
    ///
    /// # Errors
    ///
    /// The drill is in another mode.
    pub(super) fn expect_manual(&self) -> Result<(), String> {
        match self.is_manual {
            true => Ok(()),
            false => Err("enter the manual mode first: the drill homes then".into()),
        }
    }
}

impl Driver<'_> {
    /// Goes on with a jog by one key, or ends it. Returns whether one goes on.
    pub(super) fn jog(&mut self) -> Result<bool, Trouble> {
        let Some(held) = self.bench.jogging.held else {
            return Ok(false);
        };
        let (lease, now) = (&self.bench.machine.lease, Instant::now());
        if !lease.holds(held.client, held.number, now) {
            let why = match lease.has_run_out(held.client, held.number, now) {
                true => "the page did not renew it",
                false => "released",
            };
            return self.end_jog(why).map(|()| true);
        }
        let axis = (self.bench.jogging.axis + 1) % 3;
        self.bench.jogging.axis = axis;
        let way = held.ways.get(axis).copied().unwrap_or_default();
        if way == 0 {
            return Ok(true);
        }
        match self.keys(axis, i64::from(way) * i64::from(KEY_STEPS)) {
            Ok(()) => Ok(true),
            Err(trouble @ Trouble::Lost(_)) => Err(trouble),
            Err(Trouble::AtEnd) if held.ways.iter().filter(|way| **way != 0).count() > 1 => {
                // The other axes go on.
                Ok(true)
            }
            Err(trouble) => self.end_jog(&trouble.text()).map(|()| true),
        }
    }

    fn end_jog(&mut self, why: &str) -> Result<(), Trouble> {
        let Some(held) = self.bench.jogging.held.take() else {
            return Ok(());
        };
        let lease = &self.bench.machine.lease;
        lease.release(held.client, held.number);
        let text = format!("jog {} ends: {why}", held.number);
        self.bench.machine.tell(From::Server, text);
        self.read_place()
    }

    /// What works while an axis moves.
    pub(super) const fn of_axis(axis: usize) -> Work {
        match axis {
            0 => Work::X,
            1 => Work::Y,
            _ => Work::Z,
        }
    }
}

//! The work zero, and the work zeros before it.

use super::{Driver, Purpose};
use crate::serve::axes::Axes;
use crate::serve::reply::Reply;
use husillo_transports::grbl::State;
use serde_json::Value;
use std::collections::VecDeque;

/// Work zeros that can be restored.
const KEPT: usize = 10;

/// A work zero before a change.
#[derive(Clone, Debug)]
pub(super) struct Zero {
    /// Work coordinate system, such as `G54`.
    system: String,
    /// The changed axes, and their work zero in machine coordinates, mm.
    axes: Vec<(usize, f64)>,
}

/// The work zeros of a machine that can be restored.
#[derive(Debug, Default)]
pub(super) struct Zeroing(VecDeque<Zero>);

impl Zeroing {
    /// How many there are.
    pub(super) fn count(&self) -> usize {
        self.0.len()
    }

    /// Keeps one.
    pub(super) fn keep(&mut self, zero: Zero) {
        if self.0.len() == KEPT {
            self.0.pop_front();
        }
        self.0.push_back(zero);
    }

    /// The last one was restored.
    pub(super) fn restored(&mut self) {
        self.0.pop_back();
    }
}

impl Driver<'_> {
    /// Gives the present position new work coordinates.
    pub(super) fn zero(&mut self, at: &Axes, reply: Reply) {
        match at.checked(self.state.axes.len()) {
            Ok(at) => self.zero_axes(&at, Value::Null, reply),
            Err(why) => reply.error(why),
        }
    }

    /// Gives the present position new work coordinates. `data` is the answer.
    pub(super) fn zero_axes(&mut self, at: &[(usize, f64)], data: Value, reply: Reply) {
        let asked = self.is_at_rest().and_then(|(system, zero, _)| {
            let before = at
                .iter()
                .filter_map(|(axis, _)| Some((*axis, *zero.get(*axis)?)))
                .collect();
            let line = self.set_position(&system, at)?;
            Ok((
                line,
                Zero {
                    system,
                    axes: before,
                },
            ))
        });
        match asked {
            Ok((line, before)) => self.send(line, Purpose::Zero(reply, before, data)),
            Err(why) => reply.error(why),
        }
    }

    /// Restores the last work zero.
    pub(super) fn undo_zero(&mut self, reply: Reply) {
        let line = self.is_at_rest().and_then(|(_, _, at)| {
            let last = self.zeroing.0.back().cloned();
            let last = last.ok_or("there is no work zero to restore")?;
            // The machine may have moved since: its position from the work zero of then.
            let values: Vec<_> = last
                .axes
                .iter()
                .filter_map(|(axis, zero)| Some((*axis, at.get(*axis)? - zero)))
                .collect();
            self.set_position(&last.system, &values)
        });
        match line {
            Ok(line) => self.send(line, Purpose::Undo(reply)),
            Err(why) => reply.error(why),
        }
    }

    /// The work coordinate system, the work zero and the position of a machine at rest, mm.
    fn is_at_rest(&self) -> Result<(String, Vec<f64>, Vec<f64>), String> {
        self.takes_lines()?;
        if self.session.state() != Some(State::Idle) || !self.is_quiet() {
            return Err("the machine is not at rest".into());
        }
        let system = self.state.offset.clone();
        let (zero, at) = (self.state.zero_mm.clone(), self.state.machine_mm.clone());
        match (system, zero, at) {
            (Some(system), Some(zero), Some(at)) => Ok((system, zero, at)),
            _ => Err("the controller has not reported its work zero yet: try again".into()),
        }
    }

    /// The line that gives the present position these coordinates in a work coordinate system, in
    /// the units that are active.
    fn set_position(&self, system: &str, values: &[(usize, f64)]) -> Result<String, String> {
        let number = system
            .strip_prefix('G')
            .and_then(|number| number.split('.').next()?.parse::<u8>().ok())
            .and_then(|number| number.checked_sub(53))
            .ok_or_else(|| format!("{system} is no work coordinate system"))?;
        let is_inch = self.state.modal.iter().any(|code| code == "G20");
        let mut line = format!("G10L20P{number}");
        for (axis, mm) in values {
            let letter = crate::serve::axes::LETTERS
                .get(*axis)
                .map_or('?', char::to_ascii_uppercase);
            line += &match is_inch {
                true => format!("{letter}{:.5}", mm / 25.4 + 0.0),
                false => format!("{letter}{:.3}", (mm * 1e3).round() / 1e3 + 0.0),
            };
        }
        Ok(line)
    }
}

//! The values that the expressions of a measuring program can use.

use crate::routine::called_cycle;
use husillo_gcode::parameters::{SavedModes, System, Value};
use husillo_gcode::{Modal, Nm, Units};
use std::collections::HashMap;

/// The values that expressions can use: the state of the program, and measured figures.
pub(super) struct State {
    /// The state of the program.
    pub(super) modal: Modal<3>,
    /// Result of the last probe move: a point in the machine frame, and whether there was a
    /// contact.
    pub(super) probed: ([Nm; 3], bool),
    /// Figures of the cycles by their names in capitals, without the leading `_`. The flag is true
    /// for a length in nm, and false for an angle in millionths of a degree.
    pub(super) found: HashMap<Vec<u8>, (i64, bool)>,
}

impl System for State {
    /// #5061 to #5069 are the last probed point in the work frame. #5070 is 1 if there was a
    /// contact. All others come from the modal state.
    fn numbered(&self, number: u16) -> Option<Value> {
        let (at, is_contact) = self.probed;
        match number {
            5061..=5069 => {
                let axis = usize::from(number - 5061);
                let zero = self.zero();
                let place = at.get(axis).zip(zero.get(axis));
                place.map_or(Some(Value::ZERO), |(at, zero)| {
                    self.length(at.0.saturating_sub(*zero))
                })
            }
            5070 => Some(Value::from(i32::from(is_contact))),
            _ => self.modal.numbered(number),
        }
    }

    fn named(&self, name: &[u8]) -> Option<Value> {
        match self.found.get(name) {
            Some((nm, true)) => self.length(*nm),
            Some((micro, false)) => Value::new(*micro, 6),
            None => self.modal.named(name),
        }
    }

    fn has_subroutine(&self, name: &[u8]) -> bool {
        called_cycle::by_name(name).is_some()
    }

    fn modes(&self) -> Option<SavedModes> {
        self.modal.modes()
    }
}

impl State {
    /// The zero of the work frame, tool length included, nm.
    pub(super) fn zero(&self) -> [i64; 3] {
        let (offset, tool) = (self.modal.work_offset(), self.modal.tool_length());
        std::array::from_fn(|axis| offset[axis].0.saturating_add(tool[axis].0))
    }

    /// A length in the units in effect. Inches are rounded to 10^-9.
    fn length(&self, nm: i64) -> Option<Value> {
        match self.modal.units() {
            Units::Millimetres => Value::new(nm, 6),
            Units::Micrometres => Value::new(nm, 3),
            Units::Inches => {
                let nano = i128::from(nm) * 1_000_000_000;
                let rounded = (nano + nano.signum() * 12_700_000) / 25_400_000;
                Value::new(i64::try_from(rounded).ok()?, 9)
            }
        }
    }

    /// A value in the units in effect as a length, nm.
    pub(super) fn nm(&self, value: Value) -> Option<i64> {
        let (factor, exponent) = match self.modal.units() {
            Units::Millimetres => (1, 6),
            Units::Micrometres => (1, 3),
            Units::Inches => (254, 5),
        };
        value.to_decimal().scaled(factor, exponent)
    }
}

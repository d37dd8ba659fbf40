//! What expressions of a program can read: the modal state, the probe and the inputs.

use husillo_gcode::parameters::{SavedModes, System, Value};
use husillo_gcode::{Command, Input, Modal, Nm, Units, WaitFor};

/// Results of the last probing move and of the last wait for an input.
#[derive(Clone, Copy, Debug)]
pub struct Results<const N: usize> {
    /// Position of the contact in the work frame of the move: #5061 to #5069.
    probed: [Nm; N],
    /// Whether there was a contact: #5070.
    is_touched: bool,
    /// The input in millionths: #5399.
    input_micro: i64,
}

impl<const N: usize> Results<N> {
    /// The results before any probing move and any wait.
    pub const NONE: Self = Self {
        probed: [Nm(0); N],
        is_touched: false,
        input_micro: 0,
    };

    /// The results of a machine.
    pub const fn new(probed: [Nm; N], is_touched: bool, input_micro: i64) -> Self {
        Self {
            probed,
            is_touched,
            input_micro,
        }
    }

    /// Sets the results that a check assumes after a command: a contact at the end of the move, and
    /// an input that meets the condition.
    pub fn assume(&mut self, command: &Command<N>, modal: &Modal<N>) {
        match command {
            Command::Probe { to, .. } => {
                self.is_touched = true;
                let mut touched = modal.clone();
                touched.set_position(*to);
                self.probed = touched.work_position();
            }
            Command::Wait { input, until, .. } => self.input_micro = simulated(*input, *until),
            _ => {}
        }
    }
}

/// The value of a simulated input, which always meets the condition, in millionths.
pub const fn simulated(_: Input, until: WaitFor) -> i64 {
    match until {
        WaitFor::Rise | WaitFor::High => 1_000_000,
        WaitFor::Nothing | WaitFor::Fall | WaitFor::Low => 0,
    }
}

/// The state of a machine as expressions read it.
#[derive(Clone, Copy, Debug)]
pub struct Reading<'a, const N: usize> {
    /// The modal state.
    pub modal: &'a Modal<N>,
    /// Probe and inputs.
    pub results: Results<N>,
}

/// A length in a unit.
fn length(Nm(nm): Nm, units: Units) -> Option<Value> {
    match units {
        Units::Millimetres => Value::new(nm, 6),
        Units::Micrometres => Value::new(nm, 3),
        // 25.4 mm, to nine places.
        Units::Inches => Value::new((nm.checked_mul(10_000)? + 127).div_euclid(254), 9),
    }
}

impl<const N: usize> System for Reading<'_, N> {
    fn numbered(&self, number: u16) -> Option<Value> {
        match number {
            5061..=5069 => {
                let at = self.results.probed.get(usize::from(number - 5061));
                length(at.copied().unwrap_or(Nm(0)), self.modal.units())
            }
            5070 => Value::new(self.results.is_touched.into(), 0),
            5399 => Value::new(self.results.input_micro, 6),
            _ => self.modal.numbered(number),
        }
    }

    fn named(&self, name: &[u8]) -> Option<Value> {
        self.modal.named(name)
    }

    fn has_subroutine(&self, name: &[u8]) -> bool {
        self.modal.has_subroutine(name)
    }

    fn modes(&self) -> Option<SavedModes> {
        self.modal.modes()
    }
}

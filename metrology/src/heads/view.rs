//! What readings of a machine are called.

use husillo_backlash::{Calibration, Flank, Knot};
use std::rc::Rc;

/// The errors of a machine, with as many knots as were measured.
pub type Errors = Calibration<Vec<Knot>>;

/// Positions by readings: the errors that are taken off, and what is called 0. Results, goals and
/// messages all come through it.
#[derive(Clone, Debug)]
pub struct View {
    /// The errors in force.
    pub errors: Rc<Errors>,
    /// The direction each axis was moved in last.
    pub flanks: [Flank; 3],
    /// The position that is called 0.
    pub zero: [i64; 3],
}

impl View {
    /// Nothing moved yet, with these errors.
    pub fn new(errors: Errors) -> Self {
        Self {
            errors: Rc::new(errors),
            flanks: [Flank::Unknown; 3],
            zero: [0; 3],
        }
    }

    /// The position at these readings.
    pub fn position(&self, readings: [i64; 3]) -> [i64; 3] {
        self.position_from(readings, self.flanks)
    }

    /// The same after ways in these directions.
    pub fn position_from(&self, readings: [i64; 3], flanks: [Flank; 3]) -> [i64; 3] {
        let place = self.errors.position_nm(readings, flanks);
        [0, 1, 2].map(|axis: usize| place[axis].saturating_sub(self.zero[axis]))
    }
}

//! The view of a machine: conversion of its readings to positions.

use husillo_backlash::{Calibration, Flank, Knot};
use std::rc::Rc;

/// The errors of a machine, with any number of knots.
pub type Errors = Calibration<Vec<Knot>>;

/// Converts readings to positions: removes the errors and subtracts the zero. Results, goals and
/// messages all use it.
#[derive(Clone, Debug)]
pub struct View {
    /// The errors in use.
    pub errors: Rc<Errors>,
    /// The direction of the last move of each axis.
    pub flanks: [Flank; 3],
    /// The true position that counts as 0.
    pub zero: [i64; 3],
}

impl View {
    /// A view with these errors. No axis has moved yet.
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

    /// The position at these readings, after moves in these directions.
    pub fn position_from(&self, readings: [i64; 3], flanks: [Flank; 3]) -> [i64; 3] {
        let place = self.errors.position_nm(readings, flanks);
        [0, 1, 2].map(|axis: usize| place[axis].saturating_sub(self.zero[axis]))
    }
}

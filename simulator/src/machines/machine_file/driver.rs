//! `driver` of an axis in a machine file.

use crate::machines::table::Table;

/// Drivers by their name in machine files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Driver {
    /// One PBL3717A per phase.
    Pbl3717a,
    /// A3988, two motors per chip.
    A3988,
    /// L297 sequencer.
    L297,
    /// Four-bit unipolar motor.
    Unipolar,
    /// Step and direction, one pulse per step.
    StepDirection,
    /// Step and direction for drivers that count both edges of STEP.
    StepToggle,
}

impl Driver {
    /// Reads `driver`.
    pub(super) fn read(table: &mut Table<'_, '_>) -> Self {
        table
            .choice("driver", &DRIVERS)
            .unwrap_or(Self::StepDirection)
    }
}

const DRIVERS: [(&str, Driver); 6] = [
    ("pbl3717a", Driver::Pbl3717a),
    ("a3988", Driver::A3988),
    ("l297", Driver::L297),
    ("unipolar", Driver::Unipolar),
    ("step-direction", Driver::StepDirection),
    ("step-toggle", Driver::StepToggle),
];

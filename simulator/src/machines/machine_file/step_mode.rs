//! `mode` of an axis in a machine file.

use crate::machines::table::Table;

/// Step modes by their name in machine files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StepMode {
    /// Full step, one phase on.
    Wave,
    /// Full step, two phases on.
    Full,
    /// Half step.
    Half,
    /// Quarter step.
    Quarter,
}

impl StepMode {
    /// Reads `mode`.
    pub(super) fn read(table: &mut Table<'_, '_>) -> Self {
        table.choice("mode", &MODES).unwrap_or(Self::Full)
    }
}

const MODES: [(&str, StepMode); 4] = [
    ("wave", StepMode::Wave),
    ("full", StepMode::Full),
    ("half", StepMode::Half),
    ("quarter", StepMode::Quarter),
];

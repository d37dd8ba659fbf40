//! `[axis.x.home]` of a machine file.

use crate::machines::table::Table;
use husillo_metrology::quantity::{Fraction, Quantity};

/// Homing of one axis.
#[allow(dead_code)] // homing is not simulated yet
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Home {
    /// Number of this axis in the order of homing, from 1.
    pub order: u32,
    /// -1 or +1: the direction towards the switch.
    pub direction: i8,
    /// Motor steps that the axis moves back off the switch.
    pub pull_off: u32,
}

impl Home {
    /// Reads the table of an axis with this step in nm.
    pub(super) fn read(table: &mut Table<'_, '_>, step: Fraction) -> Self {
        Self {
            order: table
                .integer("order", 1..=6)
                .and_then(|order| u32::try_from(order).ok())
                .unwrap_or(1),
            direction: table
                .choice("direction", &[("-", -1), ("+", 1)])
                .unwrap_or(-1),
            pull_off: table
                .quantity("pull_off", "steps or a length", |quantity| match quantity {
                    Quantity::Steps(steps) => u32::try_from(steps.rounded()).ok(),
                    Quantity::Length(length) => length
                        .over(step)
                        .and_then(|steps| u32::try_from(steps).ok()),
                    _ => None,
                })
                .unwrap_or(0),
        }
    }
}

//! Slots: how they are cut, and slots that are drilled.

use crate::Board;
use husillo_excellon::{Hole, Path, Slot};
use std::error::Error;
use std::fmt;

/// How a slot is cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SlotHandling {
    /// The tool moves along the slot.
    Rout,
    /// Holes at both ends, and overlapping holes between them.
    Drill,
    /// A slot is an error.
    Refuse,
}

/// Why the slots of a board cannot be cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SlotError {
    /// Slots are refused. The board has this number of slots.
    Refused(usize),
    /// The drill cannot rout.
    CannotRout,
    /// A curved slot cannot be drilled.
    Curved,
    /// A slot cannot be drilled without its diameter.
    NoDiameter,
}

impl fmt::Display for SlotError {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Refused(1) => out.write_str("the file has 1 slot"),
            Self::Refused(slots) => write!(out, "the file has {slots} slots"),
            Self::CannotRout => out.write_str("this drill cannot rout"),
            Self::Curved => out.write_str("a curved slot cannot be drilled"),
            Self::NoDiameter => out.write_str("a slot cannot be drilled without its diameter"),
        }
    }
}

impl Error for SlotError {}

/// Checks that all slots of a board can be cut. `can_rout` states whether the machine can move
/// along them.
pub(crate) fn check(
    board: &Board,
    handling: SlotHandling,
    can_rout: bool,
) -> Result<(), SlotError> {
    let slots = &board.slots;
    match handling {
        _ if slots.is_empty() => Ok(()),
        SlotHandling::Rout if can_rout => Ok(()),
        SlotHandling::Rout => Err(SlotError::CannotRout),
        SlotHandling::Refuse => Err(SlotError::Refused(slots.len())),
        SlotHandling::Drill if slots.iter().any(|slot| slot.path != Path::Straight) => {
            Err(SlotError::Curved)
        }
        SlotHandling::Drill if slots.iter().any(|slot| slot.tool.diameter_nm.is_none()) => {
            Err(SlotError::NoDiameter)
        }
        SlotHandling::Drill => Ok(()),
    }
}

/// The two ends of a straight slot and holes between them, no further apart than 0.7 of its width.
pub(crate) fn overlapping(slot: &Slot) -> Vec<Hole> {
    let [dx, dy] = [0, 1].map(|axis: usize| i128::from(slot.to_nm[axis] - slot.from_nm[axis]));
    let width = slot
        .tool
        .diameter_nm
        .map_or(1, |nm| nm.max(1))
        .unsigned_abs();
    let length = ((dx * dx + dy * dy).unsigned_abs()).isqrt() + 1;
    let pieces = (10 * length)
        .div_ceil(7 * u128::from(width))
        .clamp(1, 10_000) as i128;
    // Both ends first: a drill is guided where the position of the slot matters.
    let between = 1..pieces;
    [0, pieces]
        .into_iter()
        .chain(between)
        .map(|piece| {
            let along = |from: i64, way: i128| {
                // To the nearest nanometre, halves up.
                let part = (2 * way * piece + pieces).div_euclid(2 * pieces);
                from + part as i64
            };
            Hole {
                at_nm: [along(slot.from_nm[0], dx), along(slot.from_nm[1], dy)],
                tool: slot.tool,
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use husillo_excellon::Tool;

    #[test]
    fn a_drilled_slot_has_its_ends_and_overlaps() {
        let tool = Tool {
            number: 1,
            diameter_nm: Some(1_000_000),
            plated: None,
        };
        let slot = Slot {
            from_nm: [0, 0],
            to_nm: [3_000_000, -4_000_000],
            path: Path::Straight,
            tool,
        };
        let mut at: Vec<_> = overlapping(&slot).iter().map(|hole| hole.at_nm).collect();
        assert_eq!(at[..2], [slot.from_nm, slot.to_nm]);
        at.sort();
        assert_eq!(at.len(), 9);
        for pair in at.windows(2) {
            let [dx, dy] = [0, 1].map(|axis: usize| pair[1][axis] - pair[0][axis]);
            assert!(dx * dx + dy * dy <= 700_000_i64.pow(2));
        }
        let point = Slot {
            to_nm: slot.from_nm,
            ..slot
        };
        assert_eq!(overlapping(&point).len(), 2);
    }
}

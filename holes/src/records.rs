//! A board as the records of the circuit-board drill, tool by tool.

use crate::Board;
use crate::slots::{self, SlotError, SlotHandling, overlapping};
use husillo_excellon::{Hole, Tool};
use husillo_transports::drill::{OffTable, Record, Table};
use std::error::Error;
use std::fmt;

/// The holes of one tool as records, three per hole.
#[derive(Clone, Debug)]
pub struct ToolRecords {
    /// The tool.
    pub tool: Tool,
    /// Number of holes, including those of slots.
    pub holes: usize,
    /// Its records.
    pub records: Vec<Record>,
}

/// Why there are no records.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RecordsError {
    /// The slots cannot be drilled.
    Slots(SlotError),
    /// So many holes are off the table.
    OffTable {
        /// How many.
        holes: usize,
        /// The first of them.
        first: OffTable,
    },
}

impl fmt::Display for RecordsError {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Slots(error) => error.fmt(out),
            Self::OffTable { holes: 1, first } => write!(out, "1 hole off the table: {first}"),
            Self::OffTable { holes, first } => {
                write!(out, "{holes} holes off the table, the first: {first}")
            }
        }
    }
}

impl Error for RecordsError {}

/// The records of each tool, tools in the order of their first hole.
///
/// # Errors
///
/// Slots that cannot be drilled, holes off the table.
pub fn records(
    board: &Board,
    table: Table,
    handling: SlotHandling,
) -> Result<Vec<ToolRecords>, RecordsError> {
    slots::check(board, handling, false).map_err(RecordsError::Slots)?;
    let (mut off, mut first) = (0, None);
    let mut all = Vec::new();
    for number in board.tools_in_use() {
        let holes = board.holes.iter().copied();
        let mut holes: Vec<Hole> = holes.filter(|hole| hole.tool.number == number).collect();
        let slots = board.slots.iter();
        let slots = slots.filter(|slot| slot.tool.number == number);
        holes.extend(slots.flat_map(overlapping));
        let Some(tool) = holes.first().map(|hole| hole.tool) else {
            continue;
        };
        let mut records = Vec::with_capacity(3 * holes.len());
        for hole in &holes {
            match table.hole(hole.at_nm) {
                Ok(hole) => records.extend(hole),
                Err(error) => {
                    off += 1;
                    first = first.or(Some(error));
                }
            }
        }
        all.push(ToolRecords {
            tool,
            holes: holes.len(),
            records,
        });
    }
    match first {
        Some(first) => Err(RecordsError::OffTable { holes: off, first }),
        None => Ok(all),
    }
}

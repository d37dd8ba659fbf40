//! A board as the records of the circuit-board drill: options, errors, and what is printed.

use crate::cli::Layout;
use husillo_gcode::Nm;
use husillo_holes::{Board, RecordsError, SlotError, SlotHandling, ToolRecords, records};
use husillo_sim::text::counted;
use husillo_simulator::diagnostics::{Finding, Severity};
use husillo_simulator::text::json::{self, Millimetres};
use husillo_transports::drill::{OffTable, Record, Table, record_bytes};
use serde::Serialize;
use std::io::{self, Write};

/// How records are made.
#[derive(Debug)]
pub struct Compiler {
    table: Table,
    slots: SlotHandling,
    /// The tools were chosen on the command line.
    chosen: bool,
}

/// Why there are no records.
#[derive(Debug)]
pub enum Refusal {
    /// The command line requests something impossible.
    Usage(String),
    /// The board does not fit.
    Finding(Box<Finding>),
}

impl From<String> for Refusal {
    fn from(message: String) -> Self {
        Refusal::Usage(message)
    }
}

impl From<io::Error> for Refusal {
    fn from(error: io::Error) -> Self {
        Refusal::Usage(error.to_string())
    }
}

impl Compiler {
    /// Reads the options.
    pub fn new(args: &Layout) -> Self {
        Self {
            table: if args.unbounded {
                Table::UNBOUNDED
            } else {
                Table::DRILL
            },
            slots: args.slots.map_or(SlotHandling::Drill, Into::into),
            chosen: !args.only.is_empty(),
        }
    }

    /// The records of each tool, tools in the order of their first hole.
    ///
    /// # Errors
    ///
    /// Slots that cannot be drilled, holes off the table.
    pub fn compile(&self, board: &Board, file: &str) -> Result<Vec<ToolRecords>, Refusal> {
        records(board, self.table, self.slots).map_err(|error| match error {
            RecordsError::Slots(error @ SlotError::NoDiameter) => {
                Refusal::Usage(format!("{error}: see --tool"))
            }
            RecordsError::Slots(error) => Refusal::Usage(error.to_string()),
            RecordsError::OffTable { holes, first } => {
                Refusal::Finding(Box::new(self.off_table(file, holes, first)))
            }
        })
    }

    fn off_table(&self, file: &str, off: usize, first: OffTable) -> Finding {
        let message = format!("{} of {file} off the table", counted(off, "hole"));
        let finding = Finding::general(Severity::Error, "E0401", message).note(first.to_string());
        finding.help(if self.table == Table::UNBOUNDED {
            "a record counts to 65535 steps: --shift moves the board"
        } else {
            "--shift moves the board (--shift corner to 0,0); --unbounded goes to 612 mm"
        })
    }

    /// Writes the bytes of one program: of one tool, or of the selected tools.
    ///
    /// # Errors
    ///
    /// There are several tools and no selection, or there is no hole.
    pub fn bytes(&self, tools: &[ToolRecords], file: &str) -> Result<Vec<u8>, String> {
        match tools {
            [] => return Err(format!("{file}: no hole, and a program needs one record")),
            [_, _, ..] if !self.chosen => {
                let list: Vec<_> = tools.iter().map(described).collect();
                return Err(format!(
                    "{file} has {} tools: {}. One program is for one tool: choose with --only N \
                     (several: in their order, \
                     without a stop)",
                    tools.len(),
                    list.join(", ")
                ));
            }
            _ => {}
        }
        let records = tools.iter().flat_map(|tool| tool.records.iter().copied());
        Ok(record_bytes(records).collect())
    }

    /// Writes the records of all tools as one JSON object.
    ///
    /// # Errors
    ///
    /// The error of the writer.
    pub fn print_json(&self, tools: &[ToolRecords], out: &mut impl Write) -> io::Result<()> {
        let listing = Listing {
            table_steps: [self.table.x, self.table.y],
            tools: tools.iter().map(ListedTool::new).collect(),
        };
        json::write_line("husillo.holes.records/1", &listing, out)
    }
}

/// The records of all tools.
#[derive(Serialize)]
struct Listing {
    table_steps: [u16; 2],
    tools: Vec<ListedTool>,
}

#[derive(Serialize)]
struct ListedTool {
    number: u16,
    diameter: Option<Millimetres>,
    holes: usize,
    /// Axis and steps of each.
    records: Vec<(&'static str, u16)>,
}

impl ListedTool {
    fn new(of: &ToolRecords) -> Self {
        let listed = |record: &Record| match *record {
            Record::X(steps) => ("X", steps),
            Record::Y(steps) => ("Y", steps),
            Record::Drill(steps) => ("Z", steps),
        };
        Self {
            number: of.tool.number,
            diameter: of.tool.diameter_nm.map(Millimetres),
            holes: of.holes,
            records: of.records.iter().map(listed).collect(),
        }
    }
}

fn described(tool: &ToolRecords) -> String {
    let holes = counted(tool.holes, "hole");
    match tool.tool.diameter_nm.map(Nm) {
        Some(diameter) => format!("T{} ({diameter} mm, {holes})", tool.tool.number),
        None => format!("T{} ({holes})", tool.tool.number),
    }
}

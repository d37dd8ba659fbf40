//! A drill file as the records of the circuit-board drill, tool by tool.

use crate::cli::{Layout, SlotHandling};
use crate::diagnostics::{Finding, Severity};
use crate::holes::drill_code::overlapping;
use crate::holes::{Board, count};
use crate::text::json::{self, Millimetres};
use husillo_excellon::{Hole, Path, Tool};
use husillo_gcode::Nm;
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

/// The holes of one tool as records, three per hole.
#[derive(Debug)]
pub struct ToolRecords {
    /// The tool.
    pub tool: Tool,
    /// Number of holes, including those of slots.
    pub holes: usize,
    /// Its records.
    pub records: Vec<Record>,
}

/// Why there are no records.
#[derive(Debug)]
pub enum Refusal {
    /// The command line requests something impossible.
    Usage(String),
    /// The board does not fit.
    Finding(Box<Finding>),
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
            slots: args.slots.unwrap_or(SlotHandling::Drill),
            chosen: !args.only.is_empty(),
        }
    }

    /// The records of each tool, tools in the order of their first hole.
    ///
    /// # Errors
    ///
    /// Slots that cannot be drilled, holes off the table.
    pub fn compile(&self, board: &Board, file: &str) -> Result<Vec<ToolRecords>, Refusal> {
        self.check_slots(board).map_err(Refusal::Usage)?;
        let (mut off, mut first) = (0, None);
        let mut all = Vec::new();
        for number in board.tools_in_use() {
            let holes = board.holes.iter().copied();
            let mut holes: Vec<Hole> = holes.filter(|hole| hole.tool.number == number).collect();
            let slots = board.slots.iter();
            holes.extend(
                slots
                    .filter(|slot| slot.tool.number == number)
                    .flat_map(overlapping),
            );
            let Some(tool) = holes.first().map(|hole| hole.tool) else {
                continue;
            };
            let mut records = Vec::with_capacity(3 * holes.len());
            for hole in &holes {
                match self.table.hole(hole.at_nm) {
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
            Some(first) => Err(Refusal::Finding(Box::new(self.off_table(file, off, first)))),
            None => Ok(all),
        }
    }

    fn check_slots(&self, board: &Board) -> Result<(), String> {
        let slots = &board.slots;
        let refused = match self.slots {
            _ if slots.is_empty() => return Ok(()),
            SlotHandling::Rout => "this drill cannot rout",
            SlotHandling::Refuse => {
                return Err(format!("the file has {}", count(slots.len(), "slot")));
            }
            SlotHandling::Drill if slots.iter().any(|slot| slot.path != Path::Straight) => {
                "a curved slot cannot be drilled"
            }
            SlotHandling::Drill if slots.iter().any(|slot| slot.tool.diameter_nm.is_none()) => {
                "a slot cannot be drilled without its diameter: see --tool"
            }
            SlotHandling::Drill => return Ok(()),
        };
        Err(refused.to_owned())
    }

    fn off_table(&self, file: &str, off: usize, first: OffTable) -> Finding {
        let message = format!("{} of {file} off the table", count(off, "hole"));
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
        json::write_line(&listing, out)
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
    let holes = count(tool.holes, "hole");
    match tool.tool.diameter_nm.map(Nm) {
        Some(diameter) => format!("T{} ({diameter} mm, {holes})", tool.tool.number),
        None => format!("T{} ({holes})", tool.tool.number),
    }
}

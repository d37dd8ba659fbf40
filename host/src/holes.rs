//! Drill files: reads, checks and lists them.

pub mod drill_code;
pub mod drill_file;
mod explain;
mod listing;
mod options;
pub mod placement;
mod reader;
pub mod step_and_repeat;

use crate::diagnostics::{Finding, Findings, Severity};
use crate::holes::placement::Fit;
use crate::machines::machine_file::{MachineFile, Travel};
use husillo_clients::drill::visiting_order::{self, Metric};
use husillo_excellon::{Hole, Settings, Slot, Tool};
use husillo_gcode::Nm;
use std::collections::{HashMap, HashSet};

pub use options::{Options, length};
pub use reader::read;

/// Ends of the names of drill files.
const ENDS: [&str; 6] = [".drl", ".xln", ".exc", ".drd", ".ncd", ".drill"];

/// Whether a file is a drill file, by the options or by its name.
pub fn is_drill_file(dialect: Option<&str>, file: &str) -> bool {
    let lower = file.to_ascii_lowercase();
    match dialect {
        Some(dialect) => dialect == "excellon",
        None => ENDS.iter().any(|end| lower.ends_with(end)),
    }
}

/// A drill file, read.
#[derive(Debug)]
pub struct Board {
    /// The settings of its coordinates, with their reasons.
    pub settings: Settings,
    /// Its tools in the order of the file.
    pub tools: Vec<Tool>,
    /// Its holes.
    pub holes: Vec<Hole>,
    /// Its slots.
    pub slots: Vec<Slot>,
}

impl Board {
    /// Keeps the requested tools, and places the board. Returns the fit to the measured holes.
    ///
    /// # Errors
    ///
    /// A tool without holes and slots, or a position that is out of reach.
    pub fn apply(&mut self, options: &Options) -> Result<Option<Fit>, String> {
        let in_use = self.tools_in_use();
        if let Some(tool) = options.only.iter().find(|tool| !in_use.contains(tool)) {
            return Err(format!(
                "--only {tool}: the file makes nothing with that tool"
            ));
        }
        if !options.only.is_empty() {
            self.holes
                .retain(|hole| options.only.contains(&hole.tool.number));
            self.slots
                .retain(|slot| options.only.contains(&slot.tool.number));
            self.tools
                .retain(|tool| options.only.contains(&tool.number));
        }
        options.placement.apply(self)
    }

    /// Reports what is beyond the travel of a machine whose zero is that of the file.
    pub fn check_travel(&self, file: &str, machine: &MachineFile, findings: &mut Findings) {
        let Some([low, high]) = self.extent() else {
            return;
        };
        for (axis, name) in ["X", "Y"].into_iter().enumerate() {
            let Travel::Range([from, to]) = machine.axes[axis].travel else {
                continue;
            };
            let is_off = |at_nm: &[i64; 2]| !(from..=to).contains(&at_nm[axis]);
            let holes = self.holes.iter().filter(|hole| is_off(&hole.at_nm)).count();
            let ends = |slot: &&Slot| is_off(&slot.from_nm) || is_off(&slot.to_nm);
            let slots = self.slots.iter().filter(ends).count();
            let off = match (holes, slots) {
                (0, 0) => continue,
                (_, 0) => count(holes, "hole"),
                (0, _) => count(slots, "slot"),
                _ => format!("{} and {}", count(holes, "hole"), count(slots, "slot")),
            };
            let message = format!("{off} of {file} beyond the travel of {name}");
            let note = format!(
                "{name} {} to {} mm; {} goes from {} to {} mm",
                low[axis],
                high[axis],
                machine.name,
                Nm(from),
                Nm(to)
            );
            let finding = Finding::general(Severity::Error, "E0401", message).note(note);
            let fits = high[axis].0 - low[axis].0 <= to - from;
            findings.add(finding.help(if fits {
                "it fits after a shift: see --shift of `husillo holes`"
            } else {
                "it is too large for a shift to help"
            }));
        }
    }

    /// Puts the holes of each tool into the order of a short path, tool after tool.
    pub fn sort_shortest(&mut self, metric: Metric) {
        let mut sorted = Vec::with_capacity(self.holes.len());
        let mut at = [0; 2];
        // A file may have nearly as many tools as holes.
        let mut by_tool = HashMap::<u16, Vec<_>>::new();
        for hole in &self.holes {
            by_tool.entry(hole.tool.number).or_default().push(*hole);
        }
        for tool in self.tools_in_use() {
            let of_tool = by_tool.remove(&tool).unwrap_or_default();
            let points: Vec<_> = of_tool.iter().map(|hole| hole.at_nm).collect();
            let path = visiting_order::shortest(&points, at, metric);
            if metric == Metric::Straight {
                at = path.last().map_or(at, |&last| points[last]);
            } // The drill goes home for another tool.
            sorted.extend(path.iter().map(|&index| of_tool[index]));
        }
        self.holes = sorted;
    }

    /// The numbers of the tools with holes or slots, in the order of their first one.
    pub fn tools_in_use(&self) -> Vec<u16> {
        let holes = self.holes.iter().map(|hole| hole.tool.number);
        let slots = self.slots.iter().map(|slot| slot.tool.number);
        let mut seen = HashSet::new();
        holes
            .chain(slots)
            .filter(|tool| seen.insert(*tool))
            .collect()
    }

    /// Length of the path from the origin over all holes in their order, in nm.
    pub fn travel_nm(&self, metric: Metric) -> f64 {
        visiting_order::travel(self.holes.iter().map(|hole| hole.at_nm), [0; 2], metric)
    }

    /// Smallest and largest coordinates of the centres of holes and the ends of slots.
    pub fn extent(&self) -> Option<[[Nm; 2]; 2]> {
        let ends = self
            .slots
            .iter()
            .flat_map(|slot| [slot.from_nm, slot.to_nm]);
        self.holes
            .iter()
            .map(|hole| hole.at_nm)
            .chain(ends)
            .map(|at_nm| [at_nm.map(Nm); 2])
            .reduce(|[low, high], [at, _]| {
                [
                    [low[0].min(at[0]), low[1].min(at[1])],
                    [high[0].max(at[0]), high[1].max(at[1])],
                ]
            })
    }
}

/// `1 hole`, `2 holes`.
pub fn count(number: usize, name: &str) -> String {
    match number {
        1 => format!("1 {name}"),
        _ => format!("{number} {name}s"),
    }
}

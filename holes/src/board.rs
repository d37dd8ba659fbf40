//! A board: its tools, holes and slots.

use crate::visiting_order::{self, Metric};
use husillo_excellon::{Hole, Settings, Slot, Tool};
use husillo_gcode::Nm;
use std::collections::{HashMap, HashSet};

/// A drill file, read.
#[derive(Clone, Debug)]
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
    /// Keeps only the holes and slots of these tools.
    ///
    /// # Errors
    ///
    /// The number of a tool without holes and slots. The board is unchanged.
    pub fn keep_only(&mut self, tools: &[u16]) -> Result<(), u16> {
        let in_use = self.tools_in_use();
        if let Some(tool) = tools.iter().find(|tool| !in_use.contains(tool)) {
            return Err(*tool);
        }
        self.holes.retain(|hole| tools.contains(&hole.tool.number));
        self.slots.retain(|slot| tools.contains(&slot.tool.number));
        self.tools.retain(|tool| tools.contains(&tool.number));
        Ok(())
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
pub(crate) fn count(number: usize, name: &str) -> String {
    match number {
        1 => format!("1 {name}"),
        _ => format!("{number} {name}s"),
    }
}

//! The tool table: lengths and radii by number.

use crate::features::EXTENDED;
use crate::values::nm::Nm;

/// One tool.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Tool<const N: usize> {
    /// Offset that G43 adds to the work frame, per axis.
    pub offset: [Nm; N],
    /// Tool radius, for G41 and G42.
    pub radius: Nm,
}

impl<const N: usize> Default for Tool<N> {
    fn default() -> Self {
        Tool {
            offset: [Nm(0); N],
            radius: Nm(0),
        }
    }
}

/// Capacity of the table; 0 where no code uses it.
const CAPACITY: usize = if EXTENDED { 8 } else { 0 };

/// At most eight tools of any number. Tool 0 means no tool and has no entry.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
pub(crate) struct Tools<const N: usize> {
    entries: [(u32, Tool<N>); CAPACITY],
}

impl<const N: usize> Tools<N> {
    pub(crate) const fn new() -> Self {
        Tools {
            entries: [(0, Tool::of_radius(Nm(0))); CAPACITY],
        }
    }

    pub(crate) fn get(&self, number: u32) -> Option<Tool<N>> {
        self.entries
            .iter()
            .find(|entry| number != 0 && entry.0 == number)
            .map(|entry| entry.1)
    }

    /// Writes an entry; `false` when there is no room, or the number is 0.
    pub(crate) fn set(&mut self, number: u32, tool: Tool<N>) -> bool {
        let place = self.place(number);
        place.is_some_and(|place| self.put(place, number, tool).is_some())
    }

    /// The place for a tool; `None` when there is no room, or the number is 0.
    pub(crate) fn place(&self, number: u32) -> Option<usize> {
        let there = self.entries.iter().position(|entry| entry.0 == number);
        let free = || self.entries.iter().position(|entry| entry.0 == 0);
        there.or_else(free).filter(|_| number != 0)
    }

    /// Writes a place; returns the number and the tool that it had.
    pub(crate) fn put(
        &mut self,
        place: usize,
        number: u32,
        tool: Tool<N>,
    ) -> Option<(u32, Tool<N>)> {
        let entry = self.entries.get_mut(place)?;
        Some(core::mem::replace(entry, (number, tool)))
    }
}

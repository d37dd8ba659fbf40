//! Data beyond those of Grbl that are kept while the power is off.

use super::setting::{EXTRA_COUNT, EXTRAS};

/// Tools of the table.
pub(super) const TOOLS: usize = 8;

/// One tool of the table. Number 0 means none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct StoredTool {
    pub(super) number: u32,
    /// Offset of each axis, and the radius, in nanometres.
    pub(super) nm: [i64; 4],
}

/// Further settings, frames and tools.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in super::super) struct HalMemory {
    /// Settings in thousandths, in the order of their list.
    pub(super) extras: [u32; EXTRA_COUNT],
    /// Positions of G59.1 to G59.3, and the shift of G92, in nanometres.
    pub(super) places: [[i64; 3]; 4],
    pub(super) tools: [StoredTool; TOOLS],
    /// Tool in the spindle at the last power-off.
    pub(super) tool: u32,
}

impl HalMemory {
    /// Length of the stored form.
    pub(in super::super) const BYTES: usize = 4 * EXTRA_COUNT + 4 * 3 * 8 + TOOLS * (4 + 4 * 8) + 4;

    pub(in super::super) const FACTORY: HalMemory = {
        let mut extras = [0; EXTRA_COUNT];
        let mut index = 0;
        while index < EXTRA_COUNT {
            extras[index] = EXTRAS[index].1;
            index += 1;
        }
        HalMemory {
            extras,
            places: [[0; 3]; 4],
            tools: [StoredTool {
                number: 0,
                nm: [0; 4],
            }; TOOLS],
            tool: 0,
        }
    };

    pub(in super::super) const fn restore_settings(&mut self) {
        self.extras = Self::FACTORY.extras;
    }

    /// Restores frames, shift and tools. The tool in the spindle is the same.
    pub(in super::super) const fn restore_places(&mut self) {
        self.places = Self::FACTORY.places;
        self.tools = Self::FACTORY.tools;
    }

    /// Returns the stored form.
    pub(in super::super) fn bytes(&self) -> impl Iterator<Item = u8> + '_ {
        let extras = self.extras.iter().flat_map(|value| value.to_le_bytes());
        let places = self.places.iter().flatten();
        let places = places.flat_map(|nm| nm.to_le_bytes());
        let tools = self.tools.iter().flat_map(|tool| {
            let nm = tool.nm.into_iter().flat_map(i64::to_le_bytes);
            tool.number.to_le_bytes().into_iter().chain(nm)
        });
        extras
            .chain(places)
            .chain(tools)
            .chain(self.tool.to_le_bytes())
    }

    /// Reads the stored form, which is all of `bytes`.
    pub(in super::super) fn from_bytes(bytes: &[u8]) -> Option<HalMemory> {
        let mut memory = HalMemory::FACTORY;
        let mut rest = bytes;
        for slot in &mut memory.extras {
            *slot = take_u32(&mut rest)?;
        }
        for slot in memory.places.iter_mut().flatten() {
            *slot = take_i64(&mut rest)?;
        }
        for tool in &mut memory.tools {
            tool.number = take_u32(&mut rest)?;
            for slot in &mut tool.nm {
                *slot = take_i64(&mut rest)?;
            }
        }
        memory.tool = take_u32(&mut rest)?;
        rest.is_empty().then_some(memory)
    }

    /// Returns the whole value of the extra setting with a number. 0 if there is none.
    #[cfg(feature = "drivers")]
    pub(in super::super) fn whole(&self, number: u16) -> u32 {
        let index = EXTRAS.iter().position(|(known, _)| *known == number);
        index.map_or(0, |index| self.milli(index) / 1000)
    }

    /// Returns the value of an extra setting in thousandths.
    pub(super) fn milli(&self, index: usize) -> u32 {
        self.extras.get(index).copied().unwrap_or(0)
    }
}

fn take_u32(rest: &mut &[u8]) -> Option<u32> {
    let (bytes, others) = rest.split_first_chunk()?;
    *rest = others;
    Some(u32::from_le_bytes(*bytes))
}

fn take_i64(rest: &mut &[u8]) -> Option<i64> {
    let (bytes, others) = rest.split_first_chunk()?;
    *rest = others;
    Some(i64::from_le_bytes(*bytes))
}

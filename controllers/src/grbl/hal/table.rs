//! The table of tools, further frames, and the shift of G92: what is kept while the power is off.

use husillo_gcode::{Nm, Tool};
use husillo_transports::grbl::Text;

use super::super::Grbl;
use super::memory::StoredTool;
use super::setting::{FORGETS_SHIFT, KEEPS_TOOL};

impl<const QUEUE: usize> Grbl<QUEUE> {
    /// Stores the tool in the spindle, if `$485` is set.
    pub(super) fn hal_keep_tool(&mut self) {
        if self.hal_is_set(KEEPS_TOOL) && self.memory.hal.tool != self.hal.change.tool {
            self.memory.hal.tool = self.hal.change.tool;
            self.store();
        }
    }

    /// Stores frames, shift and tools that have changed.
    pub(in super::super) fn hal_keep(&mut self) {
        let mut kept = self.memory.hal;
        for (system, slot) in (6_u8..9).zip(&mut kept.places) {
            let zero = self.modal.work_zero(system).unwrap_or_default();
            *slot = zero.map(|nm| nm.0);
        }
        if !self.hal_is_set(FORGETS_SHIFT) {
            let shift = self.shift();
            if let Some(slot) = kept.places.get_mut(3) {
                *slot = shift;
            }
        }
        if kept != self.memory.hal {
            self.memory.hal = kept;
            self.store();
        }
    }

    /// Stores a tool after G10 has written it.
    pub(in super::super) fn hal_keep_entry(&mut self, number: u32) {
        let Some(tool) = self.modal.tool_data(number) else {
            return;
        };
        let [x, y, z] = tool.offset.map(|nm| nm.0);
        let entry = StoredTool {
            number,
            nm: [x, y, z, tool.radius.0],
        };
        let tools = &mut self.memory.hal.tools;
        let there = tools.iter().position(|tool| tool.number == number);
        let place = there.or_else(|| tools.iter().position(|tool| tool.number == 0));
        if let Some(slot) = place.and_then(|place| tools.get_mut(place)) {
            *slot = entry;
        }
        self.store();
    }

    /// Copies the stored tools to the modal state.
    pub(super) fn hal_load_tools(&mut self) {
        for tool in self.memory.hal.tools {
            let [x, y, z, radius] = tool.nm.map(Nm);
            let data = Tool {
                offset: [x, y, z],
                radius,
            };
            // Number 0 has no entry.
            self.modal.set_tool(tool.number, data);
        }
    }

    /// Loads frames, shift and tools at the start.
    pub(in super::super) fn hal_load(&mut self) {
        for (system, place) in (6_u8..9).zip(self.memory.hal.places) {
            self.modal.set_work_zero(system, place.map(Nm));
        }
        self.hal_load_tools();
        let [_, _, _, shift] = self.memory.hal.places;
        if shift != [0; 3] {
            let mut text = Text::new();
            text.put(b"G92");
            let work = self
                .modal
                .position()
                .into_iter()
                .zip(self.modal.work_offset());
            for ((at, zero), (shift, letter)) in work.zip(shift.into_iter().zip(*b"XYZ")) {
                text.put(&[letter]);
                // Each is below 2^52.
                let value = at.0.saturating_sub(zero.0).saturating_sub(shift);
                text.put_decimal(value, 6);
            }
            self.change_modes(text.bytes());
        }
    }
}

//! Data that the host reads: records, and the state of the device.

use super::super::{MachineState, Reading};
use super::{Device, Mode, check};

impl<const N: usize> Device<N> {
    /// Sets the state that the host may read. The caller does this before [`push`](Device::push).
    pub const fn set_machine(&mut self, state: MachineState) {
        self.machine = state;
    }

    pub(super) fn ask(&mut self, is_manual: bool) {
        self.mode = Mode::Asked {
            low: None,
            is_manual,
        };
        self.out.push(b'n');
    }

    /// Sends the record of this number, or a [`Reading`], with the complement of its sum.
    pub(super) fn read_back(&mut self, number: u16) {
        let at = usize::from(number).wrapping_mul(3); // below 2^18
        let stored = self.memory.bytes().get(at..).unwrap_or_default();
        let record = match (Reading::of(number), stored.first_chunk()) {
            (Some(reading), _) => self.reading(reading),
            // Without the records before them, these records are not a program.
            (None, Some(record)) if !self.is_tail => *record,
            (None, _) => [b'f', 0, 0],
        };
        self.out.extend(&record);
        self.out.push(check(record));
    }

    fn reading(&self, reading: Reading) -> [u8; 3] {
        let MachineState {
            place_steps: [x, y],
            zero_steps: [zero_x, zero_y],
            ..
        } = self.machine;
        let records = self.memory.bytes().len() / 3;
        let (letter, value) = match reading {
            Reading::Drillings => (if self.was_cleared { b'c' } else { b'B' }, self.drillings),
            Reading::X => (b'X', x),
            Reading::Y => (b'Y', y),
            Reading::ZeroX => (b'x', zero_x),
            Reading::ZeroY => (b'y', zero_y),
            Reading::State => (b's', self.machine.bits()),
            Reading::Records => (
                if self.is_tail { b't' } else { b'n' },
                u16::try_from(records).unwrap_or(u16::MAX),
            ),
        };
        let [low, high] = value.to_le_bytes();
        [letter, low, high]
    }
}

//! The drivers of the motors: two PH inputs for each motor. In full steps, I0 and I1 stay low.

use husillo_controllers::MicromillConfig;

/// The machine. For another machine, use another constant.
static MACHINE: MicromillConfig = MicromillConfig::MICROMILL;

/// X, Y and Z, stepped together.
pub struct Motors {
    /// The state of each motor in its cycle of four states: two bits per motor, X lowest. Bit 6 is
    /// always set, so this is an index of [`TABLE`].
    at: u8,
}

/// Two tables with one address, because each address takes instructions. From 0, the change of `at`
/// for each pair of masks: the axes that step, and from bit 3 the axes that step backwards. From
/// [`LEVELS`], the levels for each value of `at`.
static TABLE: [u8; 128] = {
    let mut table = [0; 128];
    let mut index = 0;
    while index < 64 {
        table[index] = change(index as u8);
        table[LEVELS | index] = levels(index);
        index += 1;
    }
    table
};

/// The place of the levels in [`TABLE`].
const LEVELS: usize = 64;

/// The two bits of an axis are 1 for a step forwards and 3 for a step backwards.
const fn change(masks: u8) -> u8 {
    spread(masks) | spread(masks >> 3) << 1
}

/// Spreads three bits: above each of them is an empty bit.
const fn spread(bits: u8) -> u8 {
    bits & 1 | (bits & 2) << 1 | (bits & 4) << 2
}

/// PH of both phases of X, Y and Z, from bit 0, for the states of the three motors.
const fn levels(at: usize) -> u8 {
    /// PH of both phases in each state.
    const CYCLE: [u8; 4] = [0b01, 0b11, 0b10, 0b00];
    CYCLE[at & 3] | CYCLE[at >> 2 & 3] << 2 | CYCLE[at >> 4] << 4
}

impl Motors {
    /// All motors are at the first state of their cycle.
    pub const fn at_start() -> Self {
        Motors { at: LEVELS as u8 }
    }

    /// The machine with these motors.
    pub const fn machine(&self) -> &'static MicromillConfig {
        &MACHINE
    }

    /// Makes a step of the axes of the first mask. Those of the second mask step backwards. Returns
    /// the levels of the pins.
    #[inline]
    pub fn step(&mut self, [axes, negative]: [u8; 2]) -> u8 {
        let step = TABLE[usize::from(axes | negative << 3) % LEVELS];
        // Adds within each pair of bits. No carry reaches the next pair, and bit 6 stays.
        const LOW: u8 = 0b010101;
        self.at = ((self.at & LOW) + (step & LOW)) ^ ((self.at ^ step) & !LOW);
        TABLE[usize::from(self.at) % TABLE.len()]
    }
}

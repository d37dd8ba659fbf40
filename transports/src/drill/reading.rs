//! Readings of the state of a device with extras.

/// A value that [`Step::Read`](super::Step::Read) reads with [`number`](Reading::number). The
/// answer is a letter and a number of 16 bits. Older devices with extras know only the first value
/// and answer `f` 00 00 to the others.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Reading {
    /// Drillings of programs done since the program was cleared, modulo 2^16. The letter is `c`, or
    /// `B` if the program was not cleared since the reset.
    Drillings,
    /// Steps of X from zero: `X`.
    X,
    /// Steps of Y from zero: `Y`.
    Y,
    /// Steps of X from its switch to zero: `x`.
    ZeroX,
    /// Steps of Y from its switch to zero: `y`.
    ZeroY,
    /// The state: `s` and the bits of [`MachineState::bits`].
    State,
    /// Records in the memory: `n`, or `t` if they are the end of a longer program.
    Records,
}

impl Reading {
    /// All of them.
    pub const ALL: [Reading; 7] = [
        Reading::Drillings,
        Reading::X,
        Reading::Y,
        Reading::ZeroX,
        Reading::ZeroY,
        Reading::State,
        Reading::Records,
    ];

    /// Returns the number for [`Step::Read`](super::Step::Read): ff ff for the first reading, and
    /// one less for each further one. No memory has a record with such a number.
    pub const fn number(self) -> u16 {
        u16::MAX - self as u16
    }

    /// Returns the reading with this number. Returns `None` for the number of a record.
    pub(super) fn of(number: u16) -> Option<Reading> {
        Reading::ALL
            .into_iter()
            .find(|reading| reading.number() == number)
    }
}

/// State of the machine behind a device.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct MachineState {
    /// Steps of X and Y from zero.
    pub place_steps: [u16; 2],
    /// Steps of X and Y from their switches to zero.
    pub zero_steps: [u16; 2],
    /// Whether positions count from the switches.
    pub is_homed: bool,
    /// Whether the spindle turns.
    pub spindle_turns: bool,
    /// Whether the upper sensor of Z sees the spindle.
    pub is_up: bool,
    /// Whether the lower sensor of Z sees the spindle.
    pub is_down: bool,
}

impl MachineState {
    /// The state of a machine that was just switched on.
    pub const UNKNOWN: MachineState = MachineState {
        place_steps: [0; 2],
        zero_steps: [0; 2],
        is_homed: false,
        spindle_turns: false,
        is_up: false,
        is_down: false,
    };

    /// Returns the flags from bit 0: homed, spindle turns, Z up, Z down.
    pub fn bits(&self) -> u16 {
        let flags = [self.is_homed, self.spindle_turns, self.is_up, self.is_down];
        let flags = flags.into_iter().rev();
        flags.fold(0, |bits, flag| bits << 1 | u16::from(flag))
    }

    /// Sets the flags from [`bits`](Self::bits).
    pub fn set_bits(&mut self, bits: u16) {
        self.is_homed = bits & 1 != 0;
        self.spindle_turns = bits & 2 != 0;
        self.is_up = bits & 4 != 0;
        self.is_down = bits & 8 != 0;
    }
}

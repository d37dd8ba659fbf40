//! Motors whose drivers have inputs for step and direction.

use board::Pins;

/// Motors' pins 0 to 2: the steps of X, Y and Z, a pulse each. Pins 3 to 5 are their directions,
/// high for backwards.
pub const STEPS: Pins = 0b111;
/// Motors' pin 6: mist coolant. The boards have four other outputs.
pub const MIST: Pins = 1 << 6;

/// The levels of the motors' pins.
pub struct Motors(Pins);

impl Motors {
    /// All directions forwards.
    pub const fn new() -> Self {
        Motors(0)
    }

    /// The levels between two steps.
    pub const fn levels(&self) -> Pins {
        self.0
    }

    /// Begins a step. Returns the levels before it, with its directions, and those at the step. The
    /// direction of an axis that stands is kept.
    pub fn step(&mut self, delta: [i8; 3]) -> [Pins; 2] {
        let Motors(levels) = self;
        let mut steps = 0;
        for (bit, delta) in (0_u32..).zip(delta) {
            let (step, direction) = (1 << bit, 8 << bit);
            if delta != 0 {
                steps |= step;
                *levels &= !direction;
            }
            if delta < 0 {
                *levels |= direction;
            }
        }
        [*levels, *levels | steps]
    }

    /// Nothing: the drivers count steps at the pulse, and a dropped step has none.
    pub const fn undo(&mut self, _: [i8; 3]) {}

    /// Nothing: an output of the board switches the drivers off.
    pub const fn set_enabled(&mut self, _: bool) {}
}

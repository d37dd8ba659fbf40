//! The L297 as a chip: input pins in, output pins out.

use crate::{CoilDriver, Levels, Mode, PulseTiming, Sequencer};

/// The levels at the inputs of an [`L297`].
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct L297Inputs {
    /// CLOCK: a rising edge is a step.
    pub clock: bool,
    /// CW/CCW: high counts the states up.
    pub clockwise: bool,
    /// HALF/FULL: high is half step.
    pub half: bool,
    /// RESET: low holds state 1, whatever CLOCK does.
    pub reset: bool,
    /// ENABLE: low sets A, B, C, D and both inhibit lines low. The state still follows CLOCK.
    pub enable: bool,
}

impl L297Inputs {
    /// All pins high.
    pub const HIGH: L297Inputs = L297Inputs {
        clock: true,
        clockwise: true,
        half: true,
        reset: true,
        enable: true,
    };
}

/// The step sequencer L297 pin by pin, for simulators and for tests of a controller.
///
/// A board with this chip needs only CLOCK and CW/CCW, which
/// [`StepDirection`](crate::StepDirection) makes with [`L297::timing`]. A controller without the
/// chip uses a [`Sequencer`], which has the same outputs.
///
/// The chip has eight states. Odd states have two phases on, even states have one. A half step goes
/// to the next state, and a full step skips one state. If HALF/FULL falls in an odd state, normal
/// drive follows; in an even state, wave drive follows. The outputs are those of
/// [`Driver::L297`](crate::Driver::L297): A, B, C, D, INH1 = A or B, INH2 = C or D, and HOME in
/// state 1. The chopper is not modelled. In the chip it lowers the inhibit lines (CONTROL low) or
/// the phases (CONTROL high) while a winding has its current.
///
/// # Source
/// ST, L297 data sheet, pin functions and figures 8 to 10.
///
/// # Examples
/// ```
/// use husillo_stepper::{L297, L297Inputs, Levels};
///
/// let mut chip = L297::new();
/// assert!(chip.set(L297Inputs { clock: false, ..L297Inputs::HIGH }).contains(Levels::HOME));
/// assert_eq!(chip.set(L297Inputs::HIGH), Levels(0b10_1000)); // state 2: D alone
/// ```
#[derive(Copy, Clone, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct L297 {
    states: Sequencer,
    inputs: L297Inputs,
}

impl L297 {
    /// In state 1 as after RESET, all inputs high.
    #[must_use]
    pub const fn new() -> L297 {
        L297 {
            states: Sequencer::l297(),
            inputs: L297Inputs::HIGH,
        }
    }

    /// Sets the levels of all inputs at once, and returns the outputs. An edge of CLOCK counts with
    /// the direction and mode of the same call.
    pub fn set(&mut self, inputs: L297Inputs) -> Levels {
        let rises = inputs.clock && !self.inputs.clock;
        self.inputs = inputs;
        if !inputs.reset {
            self.states.reset();
        } else if rises {
            let mode = if inputs.half { Mode::Half } else { Mode::Full };
            // The chip has both modes, so this is no error.
            let _ = self.states.set_mode(mode);
            self.states.step(if inputs.clockwise { 1 } else { -1 });
        }
        self.outputs()
    }

    /// A, B, C, D, INH1, INH2 and HOME, as in [`Levels`].
    #[must_use]
    pub fn outputs(&self) -> Levels {
        let Levels(bits) = self.states.levels();
        Levels(if self.inputs.enable {
            bits
        } else {
            bits & Levels::HOME.0
        })
    }

    /// The number of the state as the data sheet counts, 1 to 8.
    #[must_use]
    pub const fn state(&self) -> u8 {
        // State 1 is at 10 sixteenths; a sum of at most 21, and at most 7 of its half.
        ((self.states.sixteenth().wrapping_add(6) & 15) >> 1).wrapping_add(1)
    }

    /// Returns the times that its inputs require, in ticks of a timer of `timer_hz`, rounded up: 1
    /// us of set-up, 4 us of hold, 0.5 us of CLOCK high and low. RESET requires 1 us, and another 1
    /// us before the next clock.
    ///
    /// A timer above 1 GHz counts as one of 1 GHz.
    #[must_use]
    pub const fn timing(timer_hz: u32) -> PulseTiming {
        // At most 1000 ticks a microsecond, and four of them.
        let us = timer_hz.div_ceil(1_000_000);
        let us = if us > 1000 { 1000 } else { us };
        PulseTiming {
            setup_ticks: us,
            hold_ticks: us.wrapping_mul(4),
            high_ticks: us.div_ceil(2),
            low_ticks: us.div_ceil(2),
        }
    }
}

impl Default for L297 {
    fn default() -> Self {
        L297::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LOW: L297Inputs = L297Inputs {
        clock: false,
        ..L297Inputs::HIGH
    };

    #[test]
    fn only_a_rising_edge_counts() {
        let mut chip = L297::new();
        let high = L297Inputs::HIGH;
        let states = [high, high, LOW, LOW, high, high, LOW, high].map(|inputs| {
            chip.set(inputs);
            chip.state()
        });
        assert_eq!(states, [1, 1, 1, 1, 2, 2, 2, 3]);
    }

    #[test]
    fn reset_wins_over_the_clock() {
        let mut chip = L297::new();
        for _ in 0..3 {
            chip.set(LOW);
            chip.set(L297Inputs::HIGH);
        }
        assert_eq!(chip.state(), 4);
        for clock in [false, true] {
            let outputs = chip.set(L297Inputs {
                clock,
                reset: false,
                ..L297Inputs::HIGH
            });
            assert_eq!(outputs, Levels(0b111_1010));
        }
        // An edge during RESET is not made up for.
        assert!(chip.set(L297Inputs::HIGH).contains(Levels::HOME));
    }

    #[test]
    fn times_round_up() {
        assert_eq!(L297::timing(1_000_000).hold_ticks, 4);
        assert_eq!(L297::timing(1).setup_ticks, 1);
        assert_eq!(L297::timing(72_000_000).high_ticks, 36);
        assert_eq!(L297::timing(u32::MAX).hold_ticks, 4000);
    }
}

//! The input levels of the driver of one motor.

/// The logic levels at the inputs of the driver of one motor, one bit per input. 1 is high.
///
/// The meaning of a bit depends on the [`Driver`](crate::Driver):
///
/// | driver | bit 0 | 1 | 2 | 3 | 4 | 5 | 6 |
/// | --- | --- | --- | --- | --- | --- | --- | --- |
/// | `Pbl3717a`, `A3988` | PH of A | I0 of A | I1 of A | PH of B | I0 of B | I1 of B | |
/// | `L297` | A | B | C | D | INH1 | INH2 | HOME (an output of the chip) |
/// | `Unipolar` | coil 0 | coil 1 | coil 2 | coil 3 | | | |
/// | `PhasePair` | PH of A | PH of B | inhibit | | | | |
/// | step and direction | STEP | DIR | ENABLE (high = on) | | | | |
///
/// [`Driver::pins`](crate::Driver::pins) gives the names in this order.
#[derive(Copy, Clone, Eq, PartialEq, Hash, Debug, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Levels(pub u8);

impl Levels {
    /// STEP of a step and direction drive.
    pub const STEP: Levels = Levels(1);
    /// DIR of a step and direction drive: high = positive.
    pub const DIR: Levels = Levels(2);
    /// ENABLE of a step and direction drive: high = on.
    pub const ENABLE: Levels = Levels(4);
    /// HOME of the L297: high in the state after reset.
    pub const HOME: Levels = Levels(1 << 6);

    /// Whether every input that is set in `inputs` is high.
    #[must_use]
    pub const fn contains(self, inputs: Levels) -> bool {
        self.0 & inputs.0 == inputs.0
    }

    /// The level of input `bit` (0 to 7); low for any other number.
    #[must_use]
    pub const fn is_high(self, bit: u32) -> bool {
        bit < 8 && self.0 & (1 << bit) != 0
    }

    /// The inputs whose levels differ from `shown`; all of them if that is unknown.
    #[cfg(feature = "embedded-hal")]
    pub(crate) fn changed(shown: Option<Levels>, levels: Levels) -> Levels {
        Levels(shown.map_or(0xFF, |shown| levels.0 ^ shown.0))
    }
}

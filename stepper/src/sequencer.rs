//! Phase sequencing: the order of the levels.

use core::fmt;

use crate::tables::{self, Cycle};
use crate::{CoilDriver, Driver, Levels};

/// The size of a step, and the states that it uses.
#[derive(Copy, Clone, Eq, PartialEq, Hash, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Mode {
    /// Full step, one phase on.
    Wave,
    /// Full step, two phases on (the L297's "normal").
    Full,
    /// Half step: one and two phases in turn.
    Half,
    /// Quarter step. On the PBL3717A it uses the 60 % level, with an angle at most 8.5 degrees off.
    Quarter,
    /// Quarter step of the PBL3717A with its 20 % level. The angle is at most 11.2 degrees off.
    QuarterLow,
}

impl Mode {
    /// Returns the steps of this mode per full step: 1, 2 or 4.
    #[must_use]
    pub const fn steps_per_full(self) -> u8 {
        match self {
            Mode::Wave | Mode::Full => 1,
            Mode::Half => 2,
            Mode::Quarter | Mode::QuarterLow => 4,
        }
    }

    /// Reads the names of machine files: `wave`, `full`, `half`, `quarter`, `quarter-low`.
    #[must_use]
    pub fn by_name(name: &str) -> Option<Mode> {
        Some(match name {
            "wave" => Mode::Wave,
            "full" => Mode::Full,
            "half" => Mode::Half,
            "quarter" => Mode::Quarter,
            "quarter-low" => Mode::QuarterLow,
            _ => return None,
        })
    }

    /// Returns one step in sixteenths of an electrical cycle.
    const fn stride(self) -> i8 {
        match self {
            Mode::Wave | Mode::Full => 4,
            Mode::Half => 2,
            Mode::Quarter | Mode::QuarterLow => 1,
        }
    }
}

/// The driver cannot do this step mode.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Unsupported {
    /// The driver.
    pub driver: Driver,
    /// The mode that it lacks.
    pub mode: Mode,
}

impl fmt::Display for Unsupported {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?} has no {:?} step mode", self.driver, self.mode)
    }
}

impl core::error::Error for Unsupported {}

/// Steps one motor through the states of its driver, in both directions from any state.
///
/// A step is one addition and one table look-up. The start state depends on the driver. It is state
/// 1 (the state after reset) for the L297, the levels 3 for the unipolar driver, (A, not B) as on
/// the micro mill for the PBL3717A and `PhasePair`, and (A, B) for the A3988. In [`Mode::Wave`] it
/// is one state further.
#[derive(Copy, Clone, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Sequencer {
    cycle: &'static Cycle,
    /// Position in the cycle, 0 to 15.
    at: u8,
    /// Sixteenths of a cycle a step; negative when reversed, 0 while disabled.
    stride: i8,
    keep: u8,
    set: u8,
    driver: Driver,
    mode: Mode,
    reversed: bool,
}

impl Sequencer {
    /// Creates an enabled sequencer in the start state of `driver` for `mode`.
    ///
    /// # Errors
    /// [`Unsupported`]: quarter steps need current levels (PBL3717A, A3988), only the PBL3717A has
    /// the 20 % level, and `PhasePair` cannot turn a single phase off.
    pub const fn new(driver: Driver, mode: Mode) -> Result<Sequencer, Unsupported> {
        let cycle: &'static Cycle = match (driver, mode) {
            (Driver::Pbl3717a, Mode::QuarterLow) => &tables::PBL3717A_LOW,
            (Driver::Pbl3717a, _) => &tables::PBL3717A,
            (Driver::A3988, Mode::Wave | Mode::Full | Mode::Half | Mode::Quarter) => &tables::A3988,
            (Driver::L297, Mode::Wave | Mode::Full | Mode::Half) => &tables::L297,
            (Driver::Unipolar, Mode::Wave | Mode::Full | Mode::Half) => &tables::UNIPOLAR,
            (Driver::PhasePair, Mode::Full) => &tables::PHASE_PAIR,
            _ => return Err(Unsupported { driver, mode }),
        };
        Ok(Sequencer {
            cycle,
            at: start(driver, mode),
            stride: mode.stride(),
            keep: 0xFF,
            set: 0,
            driver,
            mode,
            reversed: false,
        })
    }

    /// Creates the sequencer of an L297 in state 1, half step.
    pub(crate) const fn l297() -> Sequencer {
        Sequencer {
            cycle: &tables::L297,
            at: start(Driver::L297, Mode::Half),
            stride: Mode::Half.stride(),
            keep: 0xFF,
            set: 0,
            driver: Driver::L297,
            mode: Mode::Half,
            reversed: false,
        }
    }

    /// Exchanges the directions, for a motor or screw that is mounted in reverse (the micro mill's
    /// X).
    #[must_use]
    pub const fn reversed(mut self) -> Sequencer {
        self.reversed = !self.reversed;
        self.stride = self.stride.wrapping_neg(); // 4 at most, never wraps
        self
    }

    /// Changes the mode in any state. The state stays, with full current. The following steps have
    /// the new size.
    ///
    /// As on the L297, a full step adds 2 to the number of any state. Full steps from a one-phase
    /// state are therefore wave drive, and full steps from a two-phase state are normal drive.
    ///
    /// # Errors
    /// [`Unsupported`] as for [`Sequencer::new`]. Nothing changes then.
    pub const fn set_mode(&mut self, mode: Mode) -> Result<(), Unsupported> {
        let fresh = match Sequencer::new(self.driver, mode) {
            Ok(fresh) => fresh,
            Err(unsupported) => return Err(unsupported),
        };
        self.cycle = fresh.cycle;
        self.mode = mode;
        if self.is_enabled() {
            // The levels of a reduced current are those of a quarter step.
            self.set = 0;
            self.stride = self.signed_stride();
        }
        Ok(())
    }

    /// Returns to the start state of the driver (RESET of the L297), and returns its levels.
    pub fn reset(&mut self) -> Levels {
        self.at = start(self.driver, self.mode);
        self.levels()
    }

    /// Goes to the state at `sixteenth` of the electrical cycle (taken modulo 16), to restore a
    /// phase that was stored over a power failure. Returns the levels. Only real states of the
    /// driver are useful.
    pub fn restore(&mut self, sixteenth: u8) -> Levels {
        self.at = sixteenth & 15;
        self.levels()
    }

    /// Returns the position in the electrical cycle, in sixteenths. 2 is 45 degrees: coils A and B
    /// both forward.
    #[must_use]
    pub const fn sixteenth(&self) -> u8 {
        self.at
    }

    /// Whether it is in the start state: the HOME output of the L297, for any driver.
    #[must_use]
    pub const fn is_home(&self) -> bool {
        self.at == start(self.driver, Mode::Full)
    }

    /// Whether the coils are driven.
    #[must_use]
    pub const fn is_enabled(&self) -> bool {
        self.keep == 0xFF
    }

    /// Returns the driver.
    #[must_use]
    pub const fn driver(&self) -> Driver {
        self.driver
    }

    /// Returns the step mode.
    #[must_use]
    pub const fn mode(&self) -> Mode {
        self.mode
    }

    const fn signed_stride(&self) -> i8 {
        let stride = self.mode.stride();
        // A stride is a few sixteenths, so the negation never wraps.
        if self.reversed {
            stride.wrapping_neg()
        } else {
            stride
        }
    }
}

impl CoilDriver for Sequencer {
    #[inline]
    fn step(&mut self, delta: i8) -> Levels {
        // Modulo 16, and 16 divides 256: wrapping loses nothing.
        self.at = self
            .at
            .wrapping_add(delta.wrapping_mul(self.stride).cast_unsigned())
            & 15;
        self.levels()
    }

    #[inline]
    fn levels(&self) -> Levels {
        // Four bits index sixteen entries.
        Levels(self.cycle[usize::from(self.at & 15)] & self.keep | self.set)
    }

    fn set_enabled(&mut self, on: bool) -> Levels {
        (self.keep, self.set) = if on { (0xFF, 0) } else { off(self.driver) };
        self.stride = if on { self.signed_stride() } else { 0 };
        self.levels()
    }

    /// Reduces 100 % to 60 % in every phase of the PBL3717A in full and half steps, with I0 high.
    /// Quarter steps and the A3988 need their levels for the angle. The other drivers have none.
    fn set_reduced(&mut self, on: bool) -> Levels {
        if let (Driver::Pbl3717a, Mode::Wave | Mode::Full | Mode::Half, true) =
            (self.driver, self.mode, self.is_enabled())
        {
            self.set = if on { 0b010_010 } else { 0 };
        }
        self.levels()
    }
}

/// The start position of a driver.
const fn start(driver: Driver, mode: Mode) -> u8 {
    let two_phase = match driver {
        Driver::Pbl3717a | Driver::PhasePair | Driver::Unipolar => 14,
        Driver::A3988 => 2,
        Driver::L297 => 10,
    };
    match mode {
        Mode::Wave => (two_phase + 2) & 15,
        _ => two_phase,
    }
}

/// The levels to keep and to set so that no coil has current.
const fn off(driver: Driver) -> (u8, u8) {
    match driver {
        // I0 and I1 of both bridges high.
        Driver::Pbl3717a | Driver::A3988 => (0x7F, 0b110_110),
        // ENABLE low: all levels are low except HOME, which still shows the state.
        Driver::L297 => (Levels::HOME.0, 0),
        Driver::Unipolar => (0, 0),
        Driver::PhasePair => (0x03, 0b100),
    }
}

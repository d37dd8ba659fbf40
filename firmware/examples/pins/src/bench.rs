//! Stands in for an A4988, its motor and an encoder, and for the delay of a HAL. The driver counts
//! pulses and pauses that are shorter than its data sheet allows.

use core::cell::Cell;
use core::convert::Infallible;

use embedded_hal::delay::DelayNs;
use embedded_hal::digital::{ErrorType, InputPin, OutputPin};

/// The least times of an A4988: STEP high, STEP low, and DIR stable before and after its rise.
const HIGH_NS: u64 = 1_000;
const LOW_NS: u64 = 1_000;
const STABLE_NS: u64 = 200;

/// The driver, its motor and the encoder, at one time.
#[derive(Default)]
pub struct Bench {
    now_ns: Cell<u64>,
    /// STEP and DIR, and when they changed last.
    step: Cell<(bool, u64)>,
    direction: Cell<(bool, u64)>,
    rose_ns: Cell<u64>,
    position: Cell<i32>,
    held: Cell<u32>,
    violations: Cell<u32>,
}

impl Bench {
    /// The motor's position in steps.
    pub fn position(&self) -> i32 {
        self.position.get()
    }

    /// Holds the motor for this many steps, as a hand would.
    pub fn hold(&self, steps: u32) {
        self.held.set(steps);
    }

    /// How many times were too short for the driver.
    pub fn violations(&self) -> u32 {
        self.violations.get()
    }

    /// Counts a violation if less time than this has passed since then.
    fn require(&self, since_ns: u64, least_ns: u64) {
        if self.now_ns.get() - since_ns < least_ns {
            self.violations.set(self.violations.get() + 1);
        }
    }

    fn set_step(&self, is_high: bool) {
        let (was_high, changed_ns) = self.step.get();
        if is_high == was_high {
            return;
        }
        let now_ns = self.now_ns.get();
        self.step.set((is_high, now_ns));
        if !is_high {
            self.require(changed_ns, HIGH_NS);
            return;
        }
        let (is_forward, turned_ns) = self.direction.get();
        // Before the first pulse STEP has been low for any time.
        if self.rose_ns.get() != 0 {
            self.require(changed_ns, LOW_NS);
        }
        self.require(turned_ns, STABLE_NS);
        self.rose_ns.set(now_ns);
        match self.held.get() {
            0 => {
                let delta = if is_forward { 1 } else { -1 };
                self.position.set(self.position.get() + delta);
            }
            steps => self.held.set(steps - 1),
        }
    }

    fn set_direction(&self, is_high: bool) {
        if self.direction.get().0 == is_high {
            return;
        }
        if self.rose_ns.get() != 0 {
            self.require(self.rose_ns.get(), STABLE_NS);
        }
        self.direction.set((is_high, self.now_ns.get()));
    }
}

impl DelayNs for &Bench {
    fn delay_ns(&mut self, ns: u32) {
        self.now_ns.set(self.now_ns.get() + u64::from(ns));
    }
}

/// STEP of the driver.
pub struct StepPin<'a>(pub &'a Bench);

/// DIR of the driver.
pub struct DirectionPin<'a>(pub &'a Bench);

/// A level of the encoder: bit 1 is A, bit 0 is B.
pub struct EncoderPin<'a>(pub &'a Bench, pub u8);

impl ErrorType for StepPin<'_> {
    type Error = Infallible;
}

impl OutputPin for StepPin<'_> {
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.0.set_step(false);
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        self.0.set_step(true);
        Ok(())
    }
}

impl ErrorType for DirectionPin<'_> {
    type Error = Infallible;
}

impl OutputPin for DirectionPin<'_> {
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.0.set_direction(false);
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        self.0.set_direction(true);
        Ok(())
    }
}

impl ErrorType for EncoderPin<'_> {
    type Error = Infallible;
}

impl InputPin for EncoderPin<'_> {
    fn is_high(&mut self) -> Result<bool, Infallible> {
        // A leads B: 00, 10, 11, 01.
        let levels = [0b00, 0b10, 0b11, 0b01][self.0.position().rem_euclid(4) as usize];
        Ok(levels >> self.1 & 1 != 0)
    }

    fn is_low(&mut self) -> Result<bool, Infallible> {
        Ok(!self.is_high()?)
    }
}

//! Pulses of two motors at pins of different types: prints each edge with its time.
//!
//! On a chip, the pins and the delay are those of its HAL.

use std::cell::{Cell, RefCell};
use std::convert::Infallible;

use embedded_hal::delay::DelayNs;
use embedded_hal::digital::{ErrorType, OutputPin};
use husillo_stepper::{PinError, PulseNanoseconds, StepDirectionPins, StepPulses, Unwired};

/// A clock that stands still unless the program waits, with a line of text for each edge.
#[derive(Default)]
struct Scope {
    now_ns: Cell<u32>,
    lines: RefCell<Vec<String>>,
}

impl DelayNs for &Scope {
    fn delay_ns(&mut self, ns: u32) {
        self.now_ns.set(self.now_ns.get() + ns);
    }
}

/// A pin of X. Pins of different ports have different types.
struct PinX<'a>(&'static str, &'a Scope);

/// A pin of Y.
struct PinY<'a>(PinX<'a>);

impl ErrorType for PinX<'_> {
    type Error = Infallible;
}

impl OutputPin for PinX<'_> {
    fn set_low(&mut self) -> Result<(), Infallible> {
        let line = format!("{:>6} ns  {} low", self.1.now_ns.get(), self.0);
        self.1.lines.borrow_mut().push(line);
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        let line = format!("{:>6} ns  {} high", self.1.now_ns.get(), self.0);
        self.1.lines.borrow_mut().push(line);
        Ok(())
    }
}

impl ErrorType for PinY<'_> {
    type Error = Infallible;
}

impl OutputPin for PinY<'_> {
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.0.set_low()
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        self.0.set_high()
    }
}

fn main() -> Result<(), PinError> {
    let scope = Scope::default();
    let mut delay = &scope;
    let x = StepDirectionPins::active_low(PinX("X STEP", delay), PinX("X DIR", delay), Unwired);
    let y = StepDirectionPins::active_low(
        PinY(PinX("Y STEP", delay)),
        PinY(PinX("Y DIR", delay)),
        PinY(PinX("Y ENABLE", delay)),
    );
    let times = [PulseNanoseconds::A4988, PulseNanoseconds::DRV8825];
    let mut motors = StepPulses::new((x, y), times);
    for delta in [[1, 1], [1, -1], [1, 0]] {
        let taken_ns = motors.step(&delta, &mut delay)?;
        println!("step by {delta:?}, {taken_ns} ns:");
        for line in scope.lines.take() {
            println!("{line}");
        }
        delay.delay_ns(20_000 - taken_ns); // the next step comes 20 us later
    }
    Ok(())
}

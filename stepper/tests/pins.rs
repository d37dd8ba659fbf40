//! The `embedded-hal` adapters on recording pins.
#![cfg(feature = "embedded-hal")]

use std::cell::RefCell;
use std::convert::Infallible;

use embedded_hal::delay::DelayNs;
use embedded_hal::digital::{ErrorType, InputPin, OutputPin};
use husillo_stepper::{
    CoilDriver, Driver, LevelPins, Levels, Mode, PulseNanoseconds, Sequencer, StepDirectionPins,
    Switch, Unwired,
};

type Log = RefCell<Vec<(usize, bool)>>;

/// Writes its number and level to a common log.
struct Pin<'a>(usize, &'a Log);

impl ErrorType for Pin<'_> {
    type Error = Infallible;
}

impl OutputPin for Pin<'_> {
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.1.borrow_mut().push((self.0, false));
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        self.1.borrow_mut().push((self.0, true));
        Ok(())
    }
}

struct Contact(bool);

impl ErrorType for Contact {
    type Error = Infallible;
}

impl InputPin for Contact {
    fn is_high(&mut self) -> Result<bool, Infallible> {
        Ok(self.0)
    }

    fn is_low(&mut self) -> Result<bool, Infallible> {
        Ok(!self.0)
    }
}

#[test]
fn coil_pins_write_all_once_then_changes_only() {
    let log = Log::default();
    let mut pins = LevelPins::new([0, 1, 2, 3].map(|number| Pin(number, &log)));
    let mut motor = Sequencer::new(Driver::Unipolar, Mode::Full).unwrap();
    pins.write(motor.levels()).unwrap();
    assert_eq!(log.take(), [(0, true), (1, true), (2, false), (3, false)]); // 3
    pins.write(motor.step(1)).unwrap();
    assert_eq!(log.take(), [(1, false), (3, true)]); // 9
    pins.write(motor.step(0)).unwrap();
    assert_eq!(log.take(), []);
}

/// Writes its waits to the same log: the number of nanoseconds.
struct Clock<'a>(&'a Log);

impl DelayNs for Clock<'_> {
    fn delay_ns(&mut self, ns: u32) {
        self.0.borrow_mut().push((ns as usize, true));
    }
}

const TIMES: PulseNanoseconds = PulseNanoseconds {
    setup: 650,
    hold: 3000,
    high: 1900,
    low: 1000,
};
/// Numbers of the pins.
const STEP: usize = 0;
const DIR: usize = 1;
const ENABLE: usize = 2;

#[test]
fn enable_direction_and_step_are_written_in_this_order_with_the_set_up_time() {
    let log = Log::default();
    let [step, direction, enable] = [STEP, DIR, ENABLE].map(|number| Pin(number, &log));
    let mut pins = StepDirectionPins::active_low(step, direction, enable, TIMES);
    let on = Levels(Levels::STEP.0 | Levels::DIR.0 | Levels::ENABLE.0);
    pins.write(on, &mut Clock(&log)).unwrap();
    assert_eq!(
        log.take(),
        [(ENABLE, false), (DIR, true), (650, true), (STEP, true)]
    );
    pins.write(Levels(0), &mut Clock(&log)).unwrap();
    assert_eq!(log.take(), [(ENABLE, true), (DIR, false), (STEP, false)]);
}

#[test]
fn a_step_is_one_pulse_with_all_its_times() {
    let log = Log::default();
    let [step, direction, enable] = [STEP, DIR, ENABLE].map(|number| Pin(number, &log));
    let mut pins = StepDirectionPins::active_high(step, direction, enable, TIMES);
    let pulse = [(STEP, true), (1900, true), (STEP, false), (1100, true)];
    pins.step(-1, &mut Clock(&log)).unwrap();
    let begin = [(ENABLE, true), (DIR, false), (STEP, false), (650, true)];
    assert_eq!(log.take(), [begin, pulse].concat());
    pins.step(-1, &mut Clock(&log)).unwrap();
    assert_eq!(log.take(), pulse);
    pins.step(1, &mut Clock(&log)).unwrap();
    assert_eq!(
        log.take(),
        [&[(DIR, true), (650, true)], &pulse[..]].concat()
    );
    pins.step(0, &mut Clock(&log)).unwrap();
    assert_eq!(log.take(), []);
}

#[test]
fn a_driver_without_enable_needs_two_pins() {
    let log = Log::default();
    let [step, direction] = [STEP, DIR].map(|number| Pin(number, &log));
    let mut pins = StepDirectionPins::active_low(step, direction, Unwired::new(), TIMES);
    pins.step(1, &mut Clock(&log)).unwrap();
    assert_eq!(
        log.take()
            .iter()
            .filter(|entry| **entry == (STEP, true))
            .count(),
        1
    );
}

#[test]
fn switches_have_either_polarity() {
    for level in [false, true] {
        assert_eq!(Switch::active_high(Contact(level)).is_closed(), Ok(level));
        assert_eq!(Switch::active_low(Contact(level)).is_closed(), Ok(!level));
    }
}

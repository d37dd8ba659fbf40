//! The `embedded-hal` adapters on recording pins.
#![cfg(feature = "embedded-hal")]

use std::cell::RefCell;
use std::convert::Infallible;

use embedded_hal::digital::{ErrorType, InputPin, OutputPin};
use husillo_stepper::{
    CoilDriver, Driver, LevelPins, Levels, Mode, Sequencer, StepDirectionPins, Switch,
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

#[test]
fn direction_is_written_before_step() {
    let log = Log::default();
    let mut pins = StepDirectionPins::new(Pin(0, &log), Pin(1, &log));
    pins.write(Levels::STEP).unwrap();
    assert_eq!(log.take(), [(1, false), (0, true)]);
}

#[test]
fn switches_have_either_polarity() {
    for level in [false, true] {
        assert_eq!(Switch::active_high(Contact(level)).is_closed(), Ok(level));
        assert_eq!(Switch::active_low(Contact(level)).is_closed(), Ok(!level));
    }
}

//! Tests of the bridge adapter on a PWM channel and a pin that record what is written to them.
#![cfg(feature = "embedded-hal")]

use std::cell::RefCell;

use embedded_hal::digital::{self, OutputPin};
use embedded_hal::pwm::{self, SetDutyCycle};
use husillo_pid::{DriveError, PwmDirection};

#[derive(Debug, Clone, Copy, PartialEq)]
struct Broken;

impl digital::Error for Broken {
    fn kind(&self) -> digital::ErrorKind {
        digital::ErrorKind::Other
    }
}

impl pwm::Error for Broken {
    fn kind(&self) -> pwm::ErrorKind {
        pwm::ErrorKind::Other
    }
}

#[derive(Default)]
struct Board {
    log: RefCell<Vec<String>>,
    pin_is_broken: RefCell<bool>,
}

struct Channel<'a>(&'a Board);
struct Pin<'a>(&'a Board);

impl pwm::ErrorType for Channel<'_> {
    type Error = Broken;
}

impl SetDutyCycle for Channel<'_> {
    fn max_duty_cycle(&self) -> u16 {
        1000
    }

    fn set_duty_cycle(&mut self, duty: u16) -> Result<(), Broken> {
        self.0.log.borrow_mut().push(duty.to_string());
        Ok(())
    }
}

impl digital::ErrorType for Pin<'_> {
    type Error = Broken;
}

impl OutputPin for Pin<'_> {
    fn set_low(&mut self) -> Result<(), Broken> {
        self.set("forward")
    }

    fn set_high(&mut self) -> Result<(), Broken> {
        self.set("reverse")
    }
}

impl Pin<'_> {
    fn set(&self, direction: &str) -> Result<(), Broken> {
        if *self.0.pin_is_broken.borrow() {
            return Err(Broken);
        }
        self.0.log.borrow_mut().push(direction.to_owned());
        Ok(())
    }
}

#[test]
fn the_duty_is_zero_while_the_direction_changes() {
    let board = Board::default();
    let mut bridge = PwmDirection::new(Channel(&board), Pin(&board), 255);
    for drive in [51, 255, 0, -102, -400, 0, -51] {
        bridge.set(drive).unwrap();
    }
    let expected = [
        "0", "forward", "200", "1000", "0", "0", "reverse", "400", "1000", "0", "200",
    ];
    assert_eq!(*board.log.borrow(), expected);
}

#[test]
fn a_direction_that_was_not_set_is_tried_again() {
    let board = Board::default();
    let mut bridge = PwmDirection::new(Channel(&board), Pin(&board), 255);
    *board.pin_is_broken.borrow_mut() = true;
    assert_eq!(bridge.set(51), Err(DriveError::Direction(Broken)));
    *board.pin_is_broken.borrow_mut() = false;
    bridge.set(51).unwrap();
    assert_eq!(*board.log.borrow(), ["0", "0", "forward", "200"]);
}

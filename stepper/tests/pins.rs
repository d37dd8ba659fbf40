//! The `embedded-hal` adapters on pins that record what is written, and when.
#![cfg(feature = "embedded-hal")]

mod scope;

use embedded_hal::digital::{ErrorKind, ErrorType, InputPin};
use husillo_stepper::{
    CoilDriver, Driver, DriverPins, LevelPins, Levels, Mode, PinCount, PinError, PortBits,
    PortPins, PulseNanoseconds, Sequencer, StepDirectionPins, StepPulses, Switch, Unwired,
};
use scope::{Broken, Clock, Pin, Recorder, Scope};
use std::convert::Infallible;

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
fn coil_pins_write_all_once_then_changes_only() {
    let scope = Scope::default();
    // Three types of pins.
    let (a, b) = (Pin::<Infallible>::new(0, &scope), scope.other_pin(1));
    let mut pins = LevelPins::of(
        Driver::Unipolar,
        (a, b, Unwired, Pin::<Infallible>::new(3, &scope)),
    )
    .unwrap();
    let mut motor = Sequencer::new(Driver::Unipolar, Mode::Full).unwrap();
    pins.write(&[motor.levels()]).unwrap();
    assert_eq!(scope.take(), [(0, 0, true), (0, 1, true), (0, 3, false)]); // 3
    pins.write(&[motor.step(1)]).unwrap();
    assert_eq!(scope.take(), [(0, 1, false), (0, 3, true)]); // 9
    pins.write(&[motor.step(0)]).unwrap();
    assert_eq!(scope.take(), []);
    let (first, ..) = pins.release();
    assert_eq!(first.number(), 0);
}

#[test]
fn a_missing_pin_is_an_error() {
    let scope = Scope::default();
    let pins = || [0, 1, 2, 3].map(|number| Pin::<Infallible>::new(number, &scope));
    let wanted = PinCount {
        given: 4,
        wanted: 6,
    };
    assert_eq!(
        LevelPins::of(Driver::A3988, pins()).err(),
        Some(wanted),
        "PH, I0 and I1 of two coils"
    );
    assert!(LevelPins::of(Driver::Unipolar, pins()).is_ok());
    // A driver has as many inputs as it has bits that change its currents.
    for driver in [
        Driver::Pbl3717a,
        Driver::A3988,
        Driver::L297,
        Driver::Unipolar,
        Driver::PhasePair,
    ] {
        let matters = |bit: u8| {
            let flips = |levels| {
                driver.currents(Levels(levels)) != driver.currents(Levels(levels ^ 1 << bit))
            };
            (0..=255).any(flips)
        };
        assert_eq!(
            (0..8).filter(|bit| matters(*bit)).count(),
            driver.inputs(),
            "{driver:?}"
        );
    }
}

#[test]
fn enable_and_direction_come_before_step_and_may_be_inverted() {
    let scope = Scope::default();
    let driver = || {
        let [step, direction, enable] =
            [STEP, DIR, ENABLE].map(|number| Pin::<Infallible>::new(number, &scope));
        StepDirectionPins::active_low(step, direction, enable)
    };
    let on = Levels(Levels::STEP.0 | Levels::DIR.0 | Levels::ENABLE.0);
    let mut pins = driver();
    pins.write(&[on]).unwrap();
    assert_eq!(
        scope.take(),
        [(0, ENABLE, false), (0, DIR, true), (0, STEP, true)]
    );
    pins.write(&[Levels::ENABLE]).unwrap();
    assert_eq!(scope.take(), [(0, DIR, false), (0, STEP, false)]);
    let mut pins = driver().inverted(Levels(Levels::STEP.0 | Levels::DIR.0));
    pins.write(&[on]).unwrap();
    assert_eq!(
        scope.take(),
        [(0, ENABLE, false), (0, DIR, false), (0, STEP, false)]
    );
}

#[test]
fn a_step_is_one_pulse_with_all_its_times() {
    let scope = Scope::default();
    let [step, direction, enable] =
        [STEP, DIR, ENABLE].map(|number| Pin::<Infallible>::new(number, &scope));
    let pins = StepDirectionPins::active_high(step, direction, enable);
    let mut motor = StepPulses::new((pins,), [TIMES]).with_enable_ns(50_000);
    let mut clock = Clock(&scope);
    assert_eq!(motor.step(&[-1], &mut clock), Ok(50_000 + 1900 + 1100));
    assert_eq!(
        scope.take(),
        [
            (0, ENABLE, true),
            (0, DIR, false),
            (0, STEP, false),
            (50_000, STEP, true),
            (51_900, STEP, false),
        ]
    );
    assert_eq!(motor.step(&[-1], &mut clock), Ok(1900 + 1100));
    assert_eq!(scope.take(), [(53_000, STEP, true), (54_900, STEP, false)]);
    assert_eq!(motor.step(&[1], &mut clock), Ok(650 + 1900 + 1100));
    assert_eq!(
        scope.take(),
        [
            (56_000, DIR, true),
            (56_650, STEP, true),
            (58_550, STEP, false)
        ]
    );
    assert_eq!(motor.step(&[0], &mut clock), Ok(0));
    motor.set_enabled(false, &mut clock).unwrap();
    assert_eq!(scope.take(), [(59_650, ENABLE, false)]);
    motor.set_enabled(true, &mut clock).unwrap();
    assert_eq!(scope.take(), [(59_650, ENABLE, true)]);
    assert_eq!(motor.step(&[1], &mut clock), Ok(1900 + 1100));
    assert_eq!(
        scope.take(),
        [(109_650, STEP, true), (111_550, STEP, false)]
    );
}

#[test]
fn motors_that_step_together_share_the_longest_times() {
    let scope = Scope::default();
    let a4988 = StepDirectionPins::active_low(
        Pin::<Infallible>::new(0, &scope),
        Pin::<Infallible>::new(1, &scope),
        Unwired,
    );
    let drv8825 =
        StepDirectionPins::active_low(scope.other_pin(2), scope.other_pin(3), scope.other_pin(4));
    let times = [PulseNanoseconds::A4988, PulseNanoseconds::DRV8825];
    let mut motors = StepPulses::new((a4988, drv8825), times);
    let mut clock = Clock(&scope);
    assert_eq!(motors.step(&[1, -1], &mut clock), Ok(1900 + 1900 + 1900));
    scope.take();
    assert_eq!(motors.step(&[-1, -1], &mut clock), Ok(200 + 1900 + 1900));
    let turn = 5700;
    assert_eq!(
        scope.take(),
        [
            (turn, 1, false),
            (turn + 200, 0, true),
            (turn + 200, 2, true),
            (turn + 2100, 0, false),
            (turn + 2100, 2, false),
        ]
    );
    // The first motor alone has its own times.
    assert_eq!(motors.step(&[-1, 0], &mut clock), Ok(1000 + 1000));
    assert_eq!(scope.rising_edges(0), 3);
    assert_eq!(scope.rising_edges(2), 2);
}

#[test]
fn levels_of_a_stream_wait_only_where_a_step_rises_with_its_direction() {
    let scope = Scope::default();
    let [step, direction] = [STEP, DIR].map(|number| Pin::<Infallible>::new(number, &scope));
    let pins = [StepDirectionPins::active_low(step, direction, Unwired)];
    let mut motor = StepPulses::new(pins, [TIMES]);
    let mut clock = Clock(&scope);
    let [on, up] = [Levels::ENABLE.0, Levels::ENABLE.0 | Levels::STEP.0].map(Levels);
    motor.write(&[up], &mut clock).unwrap();
    assert_eq!(
        scope.take(),
        [(0, DIR, false), (0, STEP, false), (1000, STEP, true)]
    );
    motor.write(&[on], &mut clock).unwrap();
    motor.write(&[up], &mut clock).unwrap();
    assert_eq!(scope.take(), [(1000, STEP, false), (1000, STEP, true)]);
    motor
        .write(&[Levels(on.0 | Levels::DIR.0)], &mut clock)
        .unwrap();
    assert_eq!(scope.take(), [(1000, DIR, true), (1000, STEP, false)]);
    // A pulse of `step` after one of a stream waits for the low time.
    motor
        .write(&[Levels(up.0 | Levels::DIR.0)], &mut clock)
        .unwrap();
    assert_eq!(motor.step(&[1], &mut clock), Ok(1000 + 1900 + 1100));
}

#[test]
fn a_port_is_written_once_for_all_motors() {
    let mut port = Recorder::default();
    // STEP of X at pins 0 and 1 (two motors), of Y at pin 2; DIR at 4 and 5, a common ENABLE at 8,
    // and STEP of Y inverted.
    let x = PortBits::active_low(0b011, 1 << 4, 1 << 8);
    let y = PortBits::active_low(0b100, 1 << 5, 1 << 8).inverted(0b100);
    let mut motors = StepPulses::new(PortPins::new(&mut port, [x, y]), [TIMES; 2]);
    let scope = Scope::default();
    let mut clock = Clock(&scope);
    motors.step(&[1, -1], &mut clock).unwrap();
    motors.step(&[0, -1], &mut clock).unwrap();
    motors.set_enabled(false, &mut clock).unwrap();
    assert_eq!(
        port.writes,
        [
            (1 << 4 | 0b100, 1 << 8 | 1 << 5 | 0b011),
            (0b011, 0b100),
            (0b100, 0b011),
            (0, 0b100),
            (0b100, 0),
            (1 << 8, 0),
        ]
    );
}

#[test]
fn a_common_enable_is_on_while_one_driver_is_on() {
    for (is_low, [on, off]) in [(true, [(0, 1), (1, 0)]), (false, [(1, 0), (0, 1)])] {
        let mut port = Recorder::default();
        let bits = if is_low {
            PortBits::active_low(0, 0, 1)
        } else {
            PortBits::active_high(0, 0, 1)
        };
        let mut pins = PortPins::new(&mut port, [bits; 2]);
        for levels in [[0, 0], [4, 0], [4, 4], [0, 4], [0, 0]] {
            pins.write(&levels.map(Levels)).unwrap();
        }
        assert_eq!(port.writes, [off, on, off]);
    }
}

#[test]
fn a_failed_pin_is_written_again() {
    let scope = Scope::default();
    let step = Pin::<Broken>::new(STEP, &scope);
    let direction = Pin::<Infallible>::new(DIR, &scope);
    let pins = StepDirectionPins::active_low(step, direction, Unwired);
    let mut motor = StepPulses::new([pins], [TIMES]);
    scope.fail(STEP);
    let error = Err(PinError(ErrorKind::Other));
    assert_eq!(motor.step(&[1], &mut Clock(&scope)), error);
    assert_eq!(scope.take(), [(0, DIR, true)]);
    assert_eq!(motor.step(&[1], &mut Clock(&scope)), Ok(1000 + 1900 + 1100));
    assert_eq!(
        scope.take(),
        [
            (0, DIR, true),
            (0, STEP, false),
            (1000, STEP, true),
            (2900, STEP, false)
        ]
    );

    let mut port = Recorder {
        fails: true,
        ..Recorder::default()
    };
    let bits = PortBits::active_high(1, 2, 4);
    let mut pins = PortPins::new(&mut port, [bits]);
    assert_eq!(pins.write(&[Levels::DIR]), Err(Broken));
    assert_eq!(pins.write(&[Levels::DIR]), Ok(()));
    assert_eq!(port.writes, [(2, 5)]);
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
fn switches_have_either_polarity() {
    for level in [false, true] {
        assert_eq!(Switch::active_high(Contact(level)).is_closed(), Ok(level));
        assert_eq!(Switch::active_low(Contact(level)).is_closed(), Ok(!level));
    }
}

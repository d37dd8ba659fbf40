//! Any walk of any motor.

use husillo_stepper::{CoilDriver, Driver, Microstep, Mode, PulseTiming, Sequencer, StepDirection};

use crate::bytes::Bytes;

const DRIVERS: [&str; 5] = ["pbl3717a", "a3988", "l297", "unipolar", "phase-pair"];
const MODES: [&str; 5] = ["wave", "full", "half", "quarter", "quarter-low"];

/// Steps backwards undo steps forwards, switching off and on keeps the phase, and a pulse train
/// comes to rest with the levels of its direction.
pub fn stepper(data: &[u8]) {
    let mut bytes = Bytes::new(data);
    let driver = DRIVERS
        .into_iter()
        .nth(usize::from(bytes.byte()) % DRIVERS.len())
        .and_then(Driver::by_name);
    let mode = MODES
        .into_iter()
        .nth(usize::from(bytes.byte()) % MODES.len())
        .and_then(Mode::by_name);
    let timing = PulseTiming {
        setup_ticks: bytes.i32().unsigned_abs(),
        hold_ticks: bytes.i32().unsigned_abs(),
        high_ticks: bytes.i32().unsigned_abs(),
        low_ticks: bytes.i32().unsigned_abs(),
    };
    let walk: Vec<i8> =
        std::iter::from_fn(|| (!bytes.is_empty()).then(|| bytes.byte() as i8)).collect();
    check_pulses(timing, &walk);
    check_microsteps(&walk);
    if let (Some(driver), Some(mode)) = (driver, mode)
        && let Ok(motor) = Sequencer::new(driver, mode)
    {
        check_sequence(motor, &walk);
    }
}

fn check_sequence(mut motor: Sequencer, walk: &[i8]) {
    let home = motor.levels();
    for delta in walk.iter().map(|delta| delta.signum()) {
        let levels = motor.step(delta);
        assert_eq!(levels, motor.levels());
        let [a, b] = motor.driver().currents(levels);
        assert!(a.abs() <= 1000 && b.abs() <= 1000);
        motor.set_enabled(false);
        assert_eq!(motor.set_enabled(true), levels, "the phase is kept");
    }
    for delta in walk.iter().rev().map(|delta| delta.signum()) {
        motor.step(-delta);
    }
    assert_eq!(motor.levels(), home, "the way back leads home");
}

fn check_pulses(timing: PulseTiming, walk: &[i8]) {
    let mut pulses = StepDirection::new(timing);
    for delta in walk {
        let mut next = pulses.start(*delta).expect("it is idle");
        let (mut ticks, mut phases) = (0_u64, 0);
        while let Some(present) = next {
            ticks += u64::from(present.ticks);
            phases += 1;
            assert!(phases <= 8, "a step has a few phases");
            assert_eq!(present.levels, pulses.levels());
            next = pulses.advance();
        }
        assert!(pulses.is_idle());
        assert!(
            ticks <= u64::from(pulses.longest_step_ticks())
                || pulses.longest_step_ticks() == u32::MAX
        );
    }
}

fn check_microsteps(walk: &[i8]) {
    let mut motor = Microstep::<64>::new();
    let home = motor.currents();
    for delta in walk {
        assert_eq!(motor.step(delta.signum()), motor.currents());
    }
    for delta in walk {
        motor.step(-delta.signum());
    }
    assert_eq!(motor.currents(), home);
}

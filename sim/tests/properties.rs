//! Properties of every motor, walk and fault.

use husillo_sim::{AxisModel, Cause, Rig};
use husillo_stepper::{
    CoilDriver, Driver, Levels, Mode, PulseNanoseconds, PulseTiming, Sequencer, StepDirection,
    StepToggle,
};
use proptest::prelude::*;

const STAGES: [(Driver, Mode); 14] = [
    (Driver::Pbl3717a, Mode::Wave),
    (Driver::Pbl3717a, Mode::Full),
    (Driver::Pbl3717a, Mode::Half),
    (Driver::Pbl3717a, Mode::Quarter),
    (Driver::Pbl3717a, Mode::QuarterLow),
    (Driver::A3988, Mode::Full),
    (Driver::A3988, Mode::Half),
    (Driver::A3988, Mode::Quarter),
    (Driver::L297, Mode::Wave),
    (Driver::L297, Mode::Full),
    (Driver::L297, Mode::Half),
    (Driver::Unipolar, Mode::Full),
    (Driver::Unipolar, Mode::Half),
    (Driver::PhasePair, Mode::Full),
];

fn walk() -> impl Strategy<Value = Vec<i8>> {
    proptest::collection::vec(-1i8..=1, 0..300)
}

/// A motor, and a rig at rest in its levels.
fn bench(driver: Driver, mode: Mode, backlash: u32, pull_out_ticks: u32) -> (Sequencer, Rig<1>) {
    let motor = Sequencer::new(driver, mode).unwrap();
    let model = AxisModel::coils(driver, mode)
        .with_backlash(backlash)
        .with_pull_out_ticks(pull_out_ticks);
    (motor, Rig::new([model], [motor.levels()]))
}

proptest! {
    /// A motor that is driven slowly enough makes every step, in every mode and in either mounting
    /// direction. Its nut follows with backlash.
    #[test]
    fn the_rotor_makes_every_step(
        stage in 0..STAGES.len(),
        walk in walk(),
        backlash in 0u32..9,
        mounted in any::<bool>(),
    ) {
        let (driver, mode) = STAGES[stage];
        let mut motor = Sequencer::new(driver, mode).unwrap();
        let mut model =
            AxisModel::coils(driver, mode).with_backlash(backlash).with_pull_out_ticks(100);
        if mounted {
            motor = motor.reversed();
            model = model.reversed();
        }
        let mut rig = Rig::new([model], [motor.levels()]);
        let (mut at, mut nut) = (0i32, 0i32);
        for delta in walk {
            rig.apply(&[motor.step(delta)], 100);
            at += i32::from(delta);
            nut = nut.clamp(at, at + backlash as i32);
            prop_assert_eq!(rig.motor(), [at]);
            prop_assert_eq!(rig.tool(), [nut]);
        }
        prop_assert_eq!(rig.lost_steps(), [0]);
    }

    /// Both kinds of step and direction drivers move as stepped; reversed mounting reverses the
    /// motion.
    #[test]
    fn step_and_direction_moves_as_stepped(walk in walk()) {
        let mut toggle = StepToggle::new();
        let timing = PulseTiming { setup_ticks: 3, hold_ticks: 9, high_ticks: 2, low_ticks: 4 };
        let mut pulse = StepDirection::new(timing);
        let models = [
            AxisModel::step_toggle().with_pull_out_ticks(6),
            AxisModel::step_direction(timing).reversed(),
        ];
        let mut rig = Rig::new(models, [toggle.levels(), pulse.levels()]);
        let mut at = 0;
        for delta in walk {
            let toggled = toggle.step(delta);
            // Levels stay for their ticks, until the next ones.
            let (mut present, mut wait_ticks) = (pulse.start(delta).unwrap(), 10);
            while let Some(next) = present {
                rig.apply(&[toggled, next.levels], wait_ticks);
                wait_ticks = next.ticks;
                present = pulse.advance();
            }
            rig.apply(&[toggled, pulse.levels()], wait_ticks);
            at += i32::from(delta);
            prop_assert_eq!(rig.tool(), [at, -at]);
        }
        prop_assert_eq!(rig.lost_steps(), [0, 0]);
    }

    /// Wherever a full-step sequence skips a phase, steps are lost and the event is reported.
    #[test]
    fn a_skipped_phase_is_reported(before in 1u32..50, after in 1u32..50) {
        let (mut motor, mut rig) = bench(Driver::Unipolar, Mode::Full, 0, 0);
        for _ in 0..before {
            rig.apply(&[motor.step(1)], 10);
        }
        motor.step(1);
        for _ in 0..after {
            rig.apply(&[motor.step(1)], 10);
        }
        prop_assert_eq!(rig.losses()[0].event, u64::from(before));
        prop_assert_eq!(rig.losses()[0].cause, Cause::HalfCycle);
        // Half a cycle if it stops there, a whole cycle if the field continues: the rotor falls
        // back.
        prop_assert_eq!(rig.lost_steps(), [if after == 1 { 2 } else { 4 }]);
        let asked = before + after + 1;
        prop_assert_eq!(rig.motor(), [asked as i32 - if after == 1 { 2 } else { 4 }]);
    }

    /// All steps faster than pull-out are lost, and no others.
    #[test]
    fn too_fast_is_lost(fast in 1u32..40, direction in prop_oneof![Just(1i8), Just(-1)]) {
        let (mut motor, mut rig) = bench(Driver::A3988, Mode::Full, 0, 100);
        rig.apply(&[motor.step(direction)], 100);
        for _ in 0..fast {
            rig.apply(&[motor.step(direction)], 99);
        }
        prop_assert_eq!(rig.motor(), [i32::from(direction)]);
        prop_assert_eq!(rig.lost_steps(), [u64::from(fast)]);
        prop_assert_eq!(rig.losses().len(), fast.min(16) as usize);
        for loss in rig.losses() {
            prop_assert!(loss.cause == Cause::TooFast && loss.axis == 0);
        }
    }

    /// Random levels at random times never panic, and a rig with constant levels does not move.
    #[test]
    fn any_levels_are_taken(
        levels in proptest::collection::vec((any::<u8>(), any::<u8>(), any::<u32>()), 0..200),
    ) {
        let coils = AxisModel::coils(Driver::Pbl3717a, Mode::Quarter).with_backlash(7);
        let models = [coils, AxisModel::step_toggle()];
        let mut rig = Rig::new(models, [Levels(0), Levels(0)]);
        for (first, second, wait_ticks) in levels {
            let levels = [Levels(first), Levels(second)];
            rig.apply(&levels, wait_ticks);
            let (tool, lost) = (rig.tool(), rig.lost_steps());
            rig.apply(&levels, wait_ticks);
            prop_assert_eq!((rig.tool(), rig.lost_steps()), (tool, lost));
        }
    }

    /// Switching the current off and on again in the held phase moves nothing and loses nothing, at
    /// any speed.
    #[test]
    fn off_and_on_again(stage in 0..STAGES.len(), walk in walk()) {
        let (driver, mode) = STAGES[stage];
        let (mut motor, mut rig) = bench(driver, mode, 2, 100);
        for delta in walk {
            rig.apply(&[motor.step(delta)], 100);
            let tool = rig.tool();
            rig.apply(&[motor.set_enabled(false)], 1);
            rig.apply(&[motor.set_enabled(true)], 1);
            prop_assert_eq!(rig.tool(), tool);
        }
        prop_assert_eq!(rig.lost_steps(), [0]);
    }
}

/// The field turns while the coils are off: these steps are lost.
#[test]
fn steps_without_current_are_lost() {
    let (_, mut rig) = bench(Driver::Pbl3717a, Mode::Full, 0, 0);
    let off = 0b110_110;
    rig.apply(&[Levels(off | 0b000_001)], 10);
    rig.apply(&[Levels(off | 0b001_001)], 10);
    assert_eq!(rig.lost_steps(), [1]);
    assert_eq!(
        (rig.losses()[0].cause, rig.losses()[0].event),
        (Cause::NoCurrent, 1)
    );
    let mut drive = StepToggle::new();
    let mut rig = Rig::new([AxisModel::step_toggle()], [drive.levels()]);
    let off = drive.set_enabled(false);
    rig.apply(&[off], 10);
    rig.apply(&[Levels(off.0 ^ Levels::STEP.0)], 10);
    assert_eq!((rig.lost_steps(), rig.tool()), ([1], [0]));
}

/// 200 steps are 200 rising edges. A driver for both edges makes half as many, and the chip detects
/// that.
#[test]
fn a_chip_that_counts_rising_edges_counts_no_others() {
    let timing = PulseNanoseconds::A4988.ticks(1_000_000);
    let mut pulses = StepDirection::new(timing);
    let mut toggle = StepToggle::new();
    let chip = AxisModel::step_direction(timing);
    let mut rig = Rig::new([chip; 2], [pulses.levels(), toggle.levels()]);
    for _ in 0..200 {
        let edge = toggle.step(1);
        rig.apply(&[pulses.step(1), edge], 10);
        rig.apply(&[pulses.end_pulse(), edge], 1);
    }
    assert_eq!(rig.tool(), [200, 100]);
    assert_eq!(rig.lost_steps()[0], 0);
}

/// Each violated time of the chip loses the step.
#[test]
fn a_pulse_without_its_times_is_no_step() {
    let timing = PulseTiming {
        setup_ticks: 4,
        hold_ticks: 9,
        high_ticks: 3,
        low_ticks: 5,
    };
    let low = Levels(Levels::DIR.0 | Levels::ENABLE.0);
    let high = Levels(low.0 | Levels::STEP.0);
    let back = Levels::ENABLE;
    let up = Levels(back.0 | Levels::STEP.0);
    let off = Levels(high.0 & !Levels::ENABLE.0);
    let good: &[_] = &[(high, 100), (low, 3)];
    /// Levels after waits, the resulting rotor position, and the lost steps.
    type Case<'a> = (&'a [(Levels, u32)], i32, u64);
    let cases: [Case<'_>; 7] = [
        (good, 1, 0),
        (&[(high, 100), (low, 2)], 0, 1), // high for too short a time
        (&[(high, 100), (low, 3), (high, 4), (low, 3)], 1, 1), // low for too short a time
        (
            &[(high, 100), (low, 3), (back, 6), (up, 4), (back, 3)],
            0,
            0,
        ), // all times kept
        (
            &[(high, 100), (low, 3), (back, 5), (up, 4), (back, 3)],
            -1,
            1,
        ), // hold
        (
            &[(high, 100), (low, 3), (back, 6), (up, 3), (back, 3)],
            1,
            1,
        ), // set-up
        (&[(off, 100), (low, 3)], 0, 1),  // not enabled
    ];
    for (changes, at, lost) in cases {
        let mut rig = Rig::new([AxisModel::step_direction(timing)], [low]);
        for (levels, wait_ticks) in changes {
            rig.apply(&[*levels], *wait_ticks);
        }
        assert_eq!(
            (rig.tool(), rig.lost_steps()),
            ([at], [lost]),
            "{changes:?}"
        );
    }
}

/// One skipped half step makes a full step: the rotor follows.
#[test]
fn a_skipped_half_step_is_followed() {
    let (mut motor, mut rig) = bench(Driver::L297, Mode::Half, 0, 0);
    motor.step(1);
    rig.apply(&[motor.step(1)], 10);
    assert_eq!((rig.motor(), rig.lost_steps()), ([2], [0]));
}

/// The motor only sees currents: exchanged coils reverse its rotation.
#[test]
fn a_swapped_coil_turns_backwards() {
    let (mut motor, mut rig) = bench(Driver::Unipolar, Mode::Full, 0, 0);
    for _ in 0..8 {
        // Coils 1 and 3 exchanged. The levels 3 are the same both ways; 9 appears instead of 3.
        let levels = motor.step(1).0;
        let swapped = levels & 0b0101 | (levels & 0b0010) << 2 | (levels & 0b1000) >> 2;
        rig.apply(&[Levels(swapped)], 10);
    }
    // From 3 the first exchanged level is 3 again, then backwards through 6, 12, 9.
    assert_eq!(rig.motor(), [-7]);
}

/// Where the backlash shrinks, the flank of the screw carries the nut along, also on an axis that
/// stands. Where it grows, the nut stays.
#[test]
fn play_by_place() {
    use std::sync::Arc;
    let motors = [(); 2].map(|()| Sequencer::new(Driver::A3988, Mode::Full).unwrap());
    let [mut x, mut y] = motors;
    let models = [AxisModel::coils(Driver::A3988, Mode::Full); 2];
    let field = |[_, y]: [f64; 2]| [10.0 - y.clamp(0.0, 40.0) / 10.0, 0.0];
    let mut rig = Rig::new(models, [x.levels(), y.levels()]).with_backlash_field(Arc::new(field));
    for _ in 0..12 {
        rig.apply(&[x.step(-1), y.levels()], 100);
    }
    assert_eq!((rig.motor(), rig.tool()), ([-12, 0], [-2, 0]));
    for _ in 0..40 {
        rig.apply(&[x.levels(), y.step(1)], 100);
    }
    assert_eq!(rig.tool(), [-6, 40]);
    for _ in 0..40 {
        rig.apply(&[x.levels(), y.step(-1)], 100);
    }
    assert_eq!(rig.tool(), [-6, 0]);
    rig.apply(&[x.step(-1), y.levels()], 100);
    assert_eq!(rig.tool(), [-6, 0]);
    for _ in 0..4 {
        rig.apply(&[x.step(-1), y.levels()], 100);
    }
    assert_eq!((rig.motor(), rig.tool()), ([-17, 0], [-7, 0]));
}

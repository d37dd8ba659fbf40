//! What holds for every driver, mode, state and walk.

use husillo_stepper::{
    AMPLITUDE, Busy, CoilDriver, Drive, Driver, L297, L297Inputs, Levels, Microstep, Mode,
    PulseTiming, Sequencer, StepDirection, StepToggle, sine,
};
use proptest::prelude::*;

const DRIVERS: [Driver; 5] = [
    Driver::Pbl3717a,
    Driver::A3988,
    Driver::L297,
    Driver::Unipolar,
    Driver::PhasePair,
];
const MODES: [Mode; 5] = [
    Mode::Wave,
    Mode::Full,
    Mode::Half,
    Mode::Quarter,
    Mode::QuarterLow,
];

fn sequencer() -> impl Strategy<Value = Sequencer> {
    (0..DRIVERS.len(), 0..MODES.len(), any::<bool>()).prop_filter_map(
        "the driver has the mode",
        |(driver, mode, reversed)| {
            let motor = Sequencer::new(DRIVERS[driver], MODES[mode]).ok()?;
            Some(if reversed { motor.reversed() } else { motor })
        },
    )
}

/// Electrical angle in degrees, -180 to 180, of what the driver makes of the levels.
fn angle(driver: Driver, levels: Levels) -> f64 {
    let [a, b] = driver.currents(levels).map(f64::from);
    b.atan2(a).to_degrees()
}

fn walk() -> impl Strategy<Value = Vec<i8>> {
    proptest::collection::vec(-1i8..=1, 0..200)
}

proptest! {
    /// A board with an L297 behind STEP and DIR has the same phases as a controller that makes them
    /// itself, whatever the steps and the changes of mode between them.
    #[test]
    fn an_l297_behind_pulses_is_the_sequencer(
        steps in proptest::collection::vec((any::<bool>(), any::<bool>()), 0..200)
    ) {
        let mut chip = L297::new();
        let mut own = Sequencer::new(Driver::L297, Mode::Half).unwrap();
        let mut pulses = StepDirection::new(L297::timing(1_000_000));
        // Between pulses STEP is low.
        chip.set(L297Inputs { clock: false, ..L297Inputs::HIGH });
        for (clockwise, half) in steps {
            own.set_mode(if half { Mode::Half } else { Mode::Full }).unwrap();
            let delta = if clockwise { 1 } else { -1 };
            let mut present = pulses.start(delta).unwrap();
            while let Some(now) = present {
                chip.set(L297Inputs {
                    clock: now.levels.contains(Levels::STEP),
                    clockwise: now.levels.contains(Levels::DIR),
                    half,
                    ..L297Inputs::HIGH
                });
                present = pulses.advance();
            }
            prop_assert_eq!(chip.outputs(), own.step(delta));
        }
    }

    /// Without ENABLE an L297 drives nothing, and its states go on as with it.
    #[test]
    fn the_states_of_an_l297_go_on_without_enable(
        steps in proptest::collection::vec((any::<bool>(), any::<bool>(), any::<bool>()), 0..100)
    ) {
        let (mut chip, mut always) = (L297::new(), L297::new());
        for (enable, clockwise, half) in steps {
            let inputs = L297Inputs { clockwise, half, ..L297Inputs::HIGH };
            for clock in [false, true] {
                chip.set(L297Inputs { clock, enable, ..inputs });
                always.set(L297Inputs { clock, ..inputs });
            }
            prop_assert_eq!(chip.state(), always.state());
            let driven = if enable { always.outputs() } else { Levels(0) };
            let currents = |levels| Driver::L297.currents(levels);
            prop_assert_eq!(currents(chip.outputs()), currents(driven));
        }
    }

    /// A walk and the same walk backwards end in the levels they began with.
    #[test]
    fn there_and_back_is_nothing(mut motor in sequencer(), walk in walk()) {
        let start = motor.levels();
        for &delta in &walk {
            motor.step(delta);
        }
        for &delta in walk.iter().rev() {
            motor.step(-delta);
        }
        prop_assert_eq!(motor.levels(), start);
    }

    /// The levels depend on the sum of the steps alone.
    #[test]
    fn only_the_sum_counts(mut motor in sequencer(), walk in walk()) {
        let mut other = motor;
        for &delta in &walk {
            motor.step(delta);
        }
        let sum: i32 = walk.iter().map(|&delta| i32::from(delta)).sum();
        for _ in 0..sum.abs() {
            other.step(sum.signum() as i8);
        }
        prop_assert_eq!(motor.levels(), other.levels());
    }

    /// One step turns the field one step of the mode: 90 degrees exactly in full step, 45 in half
    /// step; in quarter step 22.5 within the error of the current levels; never backwards, never
    /// half a cycle.
    #[test]
    fn a_step_turns_the_field_by_a_step(mut motor in sequencer(), walk in walk()) {
        let nominal = 90.0 / f64::from(motor.mode().steps_per_full());
        let tolerance = match (motor.driver(), motor.mode()) {
            (_, Mode::Wave | Mode::Full | Mode::Half) => 1e-9,
            (Driver::A3988, _) => 4.2,
            (_, Mode::QuarterLow) => 11.2,
            _ => 8.5,
        };
        let mut probe = motor;
        let from = angle(motor.driver(), probe.levels());
        let sense = if (
            angle(motor.driver(), probe.step(1)) - from
        ).rem_euclid(360.0) < 180.0 { 1.0 } else { -1.0 };
        for delta in walk {
            let before = angle(motor.driver(), motor.levels());
            let turned = angle(motor.driver(), motor.step(delta)) - before;
            let turned = (turned * sense + 180.0).rem_euclid(360.0) - 180.0;
            prop_assert!(
                (turned - nominal * f64::from(delta)).abs() <= tolerance,
                "{turned} for {delta}",
            );
        }
    }

    /// Half steps of the L297 and of unipolar motors change one coil line at a time.
    #[test]
    fn half_steps_are_gray(walk in walk(), l297 in any::<bool>()) {
        let driver = if l297 { Driver::L297 } else { Driver::Unipolar };
        let mut motor = Sequencer::new(driver, Mode::Half).unwrap();
        for delta in walk {
            let before = motor.levels();
            let changed = (before.0 ^ motor.step(delta).0) & 15;
            prop_assert_eq!(changed.count_ones(), u32::from(delta != 0));
        }
    }

    /// Off means no current in any state; steps while off are not made; on again is the phase held
    /// last.
    #[test]
    fn off_and_on_restores_the_phase(mut motor in sequencer(), walk in walk(), ignored in walk()) {
        for &delta in &walk {
            motor.step(delta);
        }
        let held = motor.levels();
        prop_assert_eq!(motor.driver().currents(motor.set_enabled(false)), [0, 0]);
        for &delta in &ignored {
            prop_assert_eq!(motor.driver().currents(motor.step(delta)), [0, 0]);
        }
        prop_assert_eq!(motor.set_enabled(true), held);
        let mut fresh = motor;
        prop_assert_ne!(fresh.step(1), held);
    }

    /// A change of mode moves nothing; after it, steps per full step of the new mode make a quarter
    /// cycle.
    #[test]
    fn mode_changes_in_any_state(mut motor in sequencer(), walk in walk(), mode in 0..MODES.len()) {
        for &delta in &walk {
            motor.step(delta);
        }
        let at = motor.sixteenth();
        if motor.set_mode(MODES[mode]).is_ok() {
            prop_assert_eq!(motor.sixteenth(), at);
            for _ in 0..MODES[mode].steps_per_full() {
                motor.step(1);
            }
            prop_assert_eq!((motor.sixteenth() + 16 - at) % 8, 4);
        }
    }

    /// Any byte of levels has currents within the full current.
    #[test]
    fn any_levels_have_currents(bits in any::<u8>(), driver in 0..DRIVERS.len()) {
        for current in DRIVERS[driver].currents(Levels(bits)) {
            prop_assert!(current.abs() <= 1000);
        }
    }

    /// The double-edge drive changes STEP once a step and DIR tells the sign.
    #[test]
    fn an_edge_a_step(walk in walk()) {
        let mut drive = Drive::StepToggle(StepToggle::new());
        for delta in walk {
            let before = drive.levels();
            let after = drive.step(delta);
            prop_assert_eq!((before.0 ^ after.0) & 1 != 0, delta != 0);
            if delta != 0 {
                prop_assert_eq!(after.contains(Levels::DIR), delta > 0);
            }
        }
    }

    /// On the pins: one rising edge a step with the right DIR, which is stable for the set-up time
    /// before and the hold time after it; pulses and gaps are at least as long as asked; a step
    /// never takes longer than stated.
    #[test]
    fn pulses_keep_their_times(
        walk in walk(),
        setup_ticks in 0u32..20,
        hold_ticks in 0u32..40,
        high_ticks in 0u32..20,
        low_ticks in 0u32..20,
    ) {
        let mut pulse = StepDirection::new(
            PulseTiming { setup_ticks, hold_ticks, high_ticks, low_ticks }
        );
        let (mut now, mut levels) = (1000u32, pulse.levels());
        let (mut rose, mut fell, mut turned) = (0, 0, 0);
        let mut count = 0;
        for &delta in &walk {
            let (begun, mut present) = (now, pulse.start(delta).unwrap());
            prop_assert_eq!(present.is_some(), delta != 0);
            prop_assert!(present.is_none() || pulse.start(delta) == Err(Busy));
            while let Some(next) = present {
                let changed = levels.0 ^ next.levels.0;
                levels = next.levels;
                if changed & Levels::DIR.0 != 0 {
                    prop_assert!(now - rose >= hold_ticks);
                    turned = now;
                }
                if changed & Levels::STEP.0 != 0 && levels.contains(Levels::STEP) {
                    prop_assert!(now - turned >= setup_ticks && now - fell >= low_ticks.max(1));
                    prop_assert_eq!(levels.contains(Levels::DIR), delta > 0);
                    rose = now;
                    count += 1;
                } else if changed & Levels::STEP.0 != 0 {
                    prop_assert!(now - rose >= high_ticks.max(1));
                    fell = now;
                }
                now += next.ticks;
                present = pulse.advance();
            }
            prop_assert!(now - begun <= pulse.longest_step_ticks());
        }
        prop_assert_eq!(count, walk.iter().filter(|&&delta| delta != 0).count());
    }

    /// Microsteps there and back end where they began, and a cycle is four full steps.
    #[test]
    fn microsteps_come_back(walk in proptest::collection::vec(any::<i8>(), 0..100)) {
        let mut motor = Microstep::<256>::new();
        let mut sum = 0;
        for &delta in &walk {
            motor.step(delta);
            sum += i32::from(delta);
        }
        prop_assert_eq!(i32::from(motor.angle()), (128 + sum).rem_euclid(1024));
    }
}

/// The table is 32767 sin, rounded to nearest, at every angle.
#[test]
fn the_sine_table_is_its_rule() {
    for angle in 0..1024u16 {
        let exact =
            f64::from(AMPLITUDE) * (f64::from(angle) * std::f64::consts::TAU / 1024.0).sin();
        assert!(
            (f64::from(sine(angle)) - exact).abs() <= 0.500_000_1,
            "{angle}"
        );
        assert_eq!(sine(angle), sine(angle + 1024));
    }
}

/// Currents are cosine and sine of the angle: exact to half a unit from the table, within 1.1e-3 of
/// full current computed.
#[test]
fn microstep_currents_are_cosine_and_sine() {
    let mut motor = Microstep::<256>::new();
    let mut worst = 0;
    for _ in 0..1024 {
        let [a, b] = motor.step(1);
        worst = worst
            .max((a - sine(motor.angle() + 256)).abs())
            .max((b - sine(motor.angle())).abs());
    }
    let allowed = if cfg!(feature = "micromath") { 36 } else { 0 };
    assert!(worst <= allowed, "{worst} of 32767");
    println!("largest difference from the table: {worst} of {AMPLITUDE}");
}

/// Coarser microsteps are the same circle with longer steps; one a full step is a two-phase full
/// step.
#[test]
fn microsteps_of_all_sizes_share_the_circle() {
    fn full_step<const PER_FULL: u16>() -> [i16; 2] {
        let mut motor = Microstep::<PER_FULL>::new();
        for _ in 0..PER_FULL {
            motor.step(1);
        }
        motor.currents()
    }
    let expected = full_step::<1>();
    let all = [
        full_step::<2>(),
        full_step::<4>(),
        full_step::<8>(),
        full_step::<16>(),
        full_step::<32>(),
    ];
    assert!(all.iter().all(|&currents| currents == expected));
    assert_eq!(
        [full_step::<64>(), full_step::<128>(), full_step::<256>()],
        [expected; 3]
    );
    assert!(expected[0] < 0 && expected[0] == -expected[1] || cfg!(feature = "micromath"));
}

/// A driver says which modes it lacks.
#[test]
fn unsupported_modes_are_refused() {
    let refused = Sequencer::new(Driver::PhasePair, Mode::Half).unwrap_err();
    assert_eq!(refused.to_string(), "PhasePair has no Half step mode");
    for (driver, mode) in [
        (Driver::L297, Mode::Quarter),
        (Driver::Unipolar, Mode::Quarter),
        (Driver::A3988, Mode::QuarterLow),
        (Driver::PhasePair, Mode::Wave),
    ] {
        assert!(Sequencer::new(driver, mode).is_err());
    }
}

/// A change of the mode ends a reduced current: its inputs are levels of a quarter step.
#[test]
fn a_new_mode_has_full_current() {
    let modes = [Mode::Wave, Mode::Full, Mode::Half, Mode::Quarter];
    for (from, to) in modes
        .into_iter()
        .flat_map(|from| modes.map(|to| (from, to)))
    {
        for steps in 0..16 {
            let mut reduced = Sequencer::new(Driver::Pbl3717a, from).unwrap();
            (0..steps).for_each(|_| _ = reduced.step(1));
            let mut full = reduced;
            reduced.set_reduced(true);
            for motor in [&mut reduced, &mut full] {
                motor.set_mode(to).unwrap();
            }
            assert_eq!(
                reduced.levels(),
                full.levels(),
                "{from:?} to {to:?} after {steps}"
            );
            assert_eq!(reduced.step(1), full.step(1));
        }
        // Without current it stays so.
        let mut off = Sequencer::new(Driver::Pbl3717a, from).unwrap();
        off.set_enabled(false);
        let levels = off.levels();
        off.set_mode(to).unwrap();
        assert_eq!(off.levels(), levels, "{from:?} to {to:?}");
    }
}

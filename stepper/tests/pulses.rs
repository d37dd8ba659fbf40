//! Motors with step and direction drivers: the pin levels for any stream of events.

use husillo_stepper::{
    Drive, Driver, Idle, Levels, Mode, Motors, PulseTiming, Sequencer, StepDirection,
};
use proptest::prelude::*;

const AXES: usize = 3;

/// The observed pins of a driver.
#[derive(Clone, Copy, Debug)]
struct Pins {
    timing: PulseTiming,
    levels: Levels,
    rose: u64,
    fell: u64,
    turned: u64,
    /// Rising edges with DIR high minus those with DIR low.
    at: i64,
}

impl Pins {
    /// Takes new levels at a time and checks the times of the driver.
    fn change(&mut self, levels: Levels, now: u64) {
        let changed = levels.0 ^ self.levels.0;
        self.levels = levels;
        if changed & Levels::DIR.0 != 0 {
            assert!(now - self.rose >= u64::from(self.timing.hold_ticks), "hold");
            self.turned = now;
        }
        if changed & Levels::STEP.0 == 0 {
            return;
        }
        if levels.contains(Levels::STEP) {
            let since_turn = now - self.turned;
            assert!(since_turn >= u64::from(self.timing.setup_ticks), "set-up");
            assert!(now - self.fell >= u64::from(self.timing.low()), "low");
            self.rose = now;
            self.at += if levels.contains(Levels::DIR) { 1 } else { -1 };
        } else {
            assert!(now - self.rose >= u64::from(self.timing.high()), "high");
            self.fell = now;
        }
    }
}

fn timing() -> impl Strategy<Value = PulseTiming> {
    let ticks = || 0_u32..30;
    (ticks(), ticks(), ticks(), ticks()).prop_map(
        |(setup_ticks, hold_ticks, high_ticks, low_ticks)| PulseTiming {
            setup_ticks,
            hold_ticks,
            high_ticks,
            low_ticks,
        },
    )
}

/// Waits, steps, and whether the event is a rest instead. Some waits are as long as they may be.
fn events() -> impl Strategy<Value = Vec<(u32, [i8; AXES], bool)>> {
    let delta = prop::array::uniform3(-1_i8..=1);
    let wait = prop_oneof![
        20 => 0_u32..80,
        1 => any::<u32>(),
        1 => (0_u32..80).prop_map(|less| u32::MAX - less),
    ];
    prop::collection::vec((wait, delta, prop::bool::weighted(0.1)), 1..200)
}

proptest! {
    /// For any events: one rising edge per step with the right DIR, and the set-up, hold, high and
    /// low times of each driver are kept. Steps are late only where a driver is not ready, and
    /// delays are caught up.
    #[test]
    fn a_step_is_one_rising_edge_with_its_times(
        timings in prop::array::uniform3(timing()), events in events(),
    ) {
        let drivers = timings.map(|timing| Drive::StepDirection(StepDirection::new(timing)));
        let mut motors = Motors::new(drivers, Idle::Hold);
        let start = 1000;
        let mut now = start;
        let mut pins = [0, 1, 2].map(|axis: usize| Pins {
            timing: timings[axis],
            levels: motors.levels()[axis],
            rose: 0,
            fell: 0,
            turned: 0,
            at: 0,
        });
        let (mut asked, mut at) = (start, [0; AXES]);
        for (wait_ticks, delta, is_rest) in events {
            let mut present = |ticks: u32, levels: &[Levels; AXES]| {
                now += u64::from(ticks);
                for (pins, levels) in pins.iter_mut().zip(levels) {
                    pins.change(*levels, now);
                }
            };
            asked += u64::from(wait_ticks);
            if is_rest {
                motors.rest(wait_ticks, &mut present);
            } else {
                motors.step(wait_ticks, &delta, &mut present);
                for (at, delta) in at.iter_mut().zip(delta) {
                    *at += i64::from(delta);
                }
            }
            prop_assert!(now >= asked, "never early");
            prop_assert_eq!(pins.map(|pins| pins.at), at);
        }
        // Enough time to catch up with everything.
        let rest = 100_000;
        motors.rest(rest, |ticks, levels| {
            now += u64::from(ticks);
            for (pins, levels) in pins.iter_mut().zip(levels) {
                pins.change(*levels, now);
            }
        });
        prop_assert_eq!(now, asked + u64::from(rest));
        prop_assert!(pins.iter().all(|pins| !pins.levels.contains(Levels::STEP)), "all pulses end");
    }

    /// Steps of an axis that are no closer than its driver allows come in time, whatever the other
    /// axes do between them.
    #[test]
    fn what_a_driver_takes_comes_in_time(
        timing in timing(),
        deltas in prop::collection::vec(prop::bool::ANY, 1..100),
    ) {
        let driver = StepDirection::new(timing);
        let mut motors = Motors::new([driver], Idle::Hold);
        let interval = motors.shortest_interval_ticks(0);
        for (index, forward) in deltas.into_iter().enumerate() {
            let (mut now, mut last) = (0, 0);
            let first = if index == 0 { 100 } else { 0 };
            motors.step(interval + first, &[if forward { 1 } else { -1 }], |ticks, _| {
                now += ticks;
                last = now;
            });
            prop_assert_eq!(last, interval + first);
        }
    }
}

/// At the end of a program the last pulses end.
#[test]
fn the_last_pulse_ends() {
    let timing = PulseTiming {
        setup_ticks: 1,
        hold_ticks: 1,
        high_ticks: 7,
        low_ticks: 1,
    };
    let mut motors = Motors::new([StepDirection::new(timing)], Idle::Hold);
    motors.step(10, &[1], |_, _| {});
    assert!(motors.levels()[0].contains(Levels::STEP));
    let mut changes = Vec::new();
    motors.end_pulses(|ticks, levels| changes.push((ticks, levels[0].contains(Levels::STEP))));
    assert_eq!(changes.first(), Some(&(7, false)));
    motors.end_pulses(|_, _| panic!("no pulse is under way"));
}

/// Coils and step/direction drivers together: each gets its own signals.
#[test]
fn coils_need_no_pulse() {
    let coils = Drive::Coils(Sequencer::new(Driver::Unipolar, Mode::Full).unwrap());
    let pulses = Drive::StepDirection(StepDirection::new(PulseTiming::default()));
    let mut motors = Motors::new([coils, pulses], Idle::Hold);
    let mut changes = Vec::new();
    for delta in [[1, 1], [1, 0]] {
        motors.step(5, &delta, |ticks, levels| {
            changes.push((ticks, levels.map(|levels| levels.0)))
        });
    }
    assert_eq!(
        changes,
        [(5, [9, 0b111]), (1, [9, 0b110]), (4, [12, 0b110])]
    );
    assert_eq!(
        [0, 1].map(|axis| motors.shortest_interval_ticks(axis)),
        [0, 2]
    );
}

//! `Machine::fill` returns the events of `next_event`, whatever the lengths of the slices.

mod common;

use husillo_backlash::{Backlash, BacklashMap, BacklashModel, Flank, MappedBacklash};
use husillo_gcode::Nm;
use husillo_interp::Path;
use husillo_machine::{
    AxisRamp, Config, Event, Extension, Filled, Machine, PathRamp, SmoothRamp, StepEvent,
};
use husillo_planner::Ramp;
use proptest::prelude::*;

type Any<L, E, R> = Machine<3, Path<3>, L, 4, E, R>;

/// What happens between two events.
#[derive(Clone, Debug)]
enum Act {
    Line(String),
    /// Takes up to so many events.
    Take(usize),
    Hold,
    Resume,
    Override(u8),
    Abort,
}

fn coordinates() -> impl Strategy<Value = String> {
    // Up to 0.2 mm, in microns: 80 steps of the router and 1400 of the micro mill.
    ((-200..200), (-200..200), (-30..30)).prop_map(|(x, y, z)| {
        let mm = |microns: i32| f64::from(microns) / 1000.0;
        format!("X{:.3} Y{:.3} Z{:.3}", mm(x), mm(y), mm(z))
    })
}

fn act() -> impl Strategy<Value = Act> {
    let line = |text: String| Act::Line(text);
    prop_oneof![
        6 => coordinates().prop_map(move |to| line(format!("G1 {to}"))),
        1 => coordinates().prop_map(move |to| line(format!("G0 {to}"))),
        2 => (2..4, coordinates(), 150..300).prop_map(move |(g, to, radius)| {
            line(format!("G{g} {to} R0.{radius}"))
        }),
        1 => (2..4, 1..150).prop_map(move |(g, radius)| line(format!("G{g} I0.{radius:03}"))),
        1 => prop::sample::select(vec![
            "M3 S1000", "M8", "G4 P0.001", "M0", "G61.1", "G64", "F30", "F600", "G4 P3000",
        ])
        .prop_map(move |text| line(text.into())),
        6 => (1..300_usize).prop_map(Act::Take),
        1 => Just(Act::Hold),
        2 => Just(Act::Resume),
        1 => (10..=200_u8).prop_map(Act::Override),
        1 => Just(Act::Abort),
    ]
}

fn acts() -> impl Strategy<Value = Vec<Act>> {
    prop::collection::vec(act(), 1..60)
}

/// Lengths of the slices; 0 is a call of `next_event`.
fn lengths() -> impl Strategy<Value = Vec<usize>> {
    prop::collection::vec(prop_oneof![Just(0_usize), 1..4_usize, 1..90_usize], 1..12)
}

/// Takes up to `most` events one by one.
fn one_by_one<L: BacklashModel<3> + Clone, E: Extension<3>, R: PathRamp>(
    machine: &mut Any<L, E, R>,
    most: usize,
) -> Vec<Event<3>> {
    std::iter::from_fn(|| machine.next_event())
        .take(most)
        .collect()
}

/// Takes up to `most` events in slices of these lengths.
fn in_slices<L: BacklashModel<3> + Clone, E: Extension<3>, R: PathRamp>(
    machine: &mut Any<L, E, R>,
    most: usize,
    lengths: &mut impl Iterator<Item = usize>,
) -> Vec<Event<3>> {
    let mut events = Vec::new();
    while events.len() < most {
        let length = lengths.next().unwrap();
        if length == 0 {
            match machine.next_event() {
                Some(event) => events.push(event),
                None => break,
            }
            continue;
        }
        // One place more may come as the event that is not a step.
        let length = length.min(most - events.len());
        let mut steps = [StepEvent::default(); 90];
        let Filled { steps: made, then } = machine.fill(&mut steps[..length]);
        assert!(made <= length && !matches!(then, Some(Event::Step(_))));
        events.extend(steps[..made].iter().copied().map(Event::Step));
        events.extend(then);
        if made == 0 && then.is_none() {
            break;
        }
    }
    events
}

/// Does the same with both machines, and compares their events.
fn compare<L: BacklashModel<3> + Clone, E: Extension<3>, R: PathRamp>(
    machine: &Any<L, E, R>,
    acts: &[Act],
    lengths: &[usize],
) {
    let (mut one, mut many) = (machine.clone(), machine.clone());
    let mut lengths = lengths.iter().copied().cycle();
    let end = [Act::Resume, Act::Take(usize::MAX)];
    for act in acts.iter().chain(&end) {
        match act {
            Act::Line(text) => {
                assert_eq!(one.line(text.as_bytes()), many.line(text.as_bytes()));
            }
            Act::Take(most) => {
                let expected = one_by_one(&mut one, *most);
                let events = in_slices(&mut many, *most, &mut lengths);
                assert!(expected == events, "{acts:?}");
            }
            Act::Hold => {
                one.hold();
                many.hold();
            }
            Act::Resume => {
                one.resume();
                many.resume();
            }
            Act::Override(percent) => {
                one.set_feed_override(*percent);
                many.set_feed_override(*percent);
            }
            Act::Abort => {
                one.abort();
                many.abort();
            }
        }
        assert_eq!(one.position_steps(), many.position_steps());
        assert_eq!(one.origin(), many.origin());
        assert_eq!(one.executing(), many.executing());
        assert_eq!(one.has_room(), many.has_room());
    }
}

/// A router of 2.5 um with ramps; X and Y have this backlash.
fn router(backlash_steps: u32, jerk_hz_per_s2: Option<u32>) -> Config<3> {
    let mut config = common::config();
    config.arc_tolerance = Some(Nm(50_000));
    config.corner_deviation = Some(Nm(10_000));
    for axis in &mut config.axes {
        axis.scale = husillo_machine::Scale::new(2_500, 1).unwrap();
        axis.max_rate_hz = 40_000;
        axis.backlash_steps = backlash_steps;
        axis.ramp = Some(AxisRamp {
            acceleration_hz_per_s: 400_000,
            start_rate_hz: 0,
            jerk_hz_per_s2,
            junction_hz: None,
        });
    }
    config.axes[2].backlash_steps = 0;
    config.axes[2].max_rate_hz = 10_000;
    config
}

fn ready<E: Extension<3>, R: PathRamp>(config: Config<3>) -> Any<Backlash, E, R> {
    let mut machine = Machine::new(config);
    machine.line(b"G21 G90 G94 F600").unwrap();
    machine
}

proptest! {
    #[test]
    fn constant_speed_and_take_ups(acts in acts(), lengths in lengths()) {
        compare(&ready::<(), Ramp>(common::config()), &acts, &lengths);
    }

    #[test]
    fn ramps(acts in acts(), lengths in lengths()) {
        compare(&ready::<(), Ramp>(router(0, None)), &acts, &lengths);
    }

    #[test]
    fn ramps_and_take_ups(acts in acts(), lengths in lengths()) {
        compare(&ready::<(), Ramp>(router(30, None)), &acts, &lengths);
    }

    /// Arcs are ellipses on the grid.
    #[test]
    fn ramps_on_unequal_steps(acts in acts(), lengths in lengths(), backlash in 0..2_u32) {
        let mut config = router(backlash * 20, None);
        config.axes[1].scale = husillo_machine::Scale::new(3_500, 1).unwrap();
        compare(&ready::<(), Ramp>(config), &acts, &lengths);
    }

    #[test]
    fn limited_jerk(acts in acts(), lengths in lengths(), backlash in 0..2_u32) {
        let config = router(backlash * 20, Some(80_000_000));
        compare(&ready::<(), SmoothRamp>(config), &acts, &lengths);
    }

    #[test]
    fn backlash_that_varies(acts in acts(), lengths in lengths()) {
        let map = |steps: [u32; 4]| {
            let positions = vec![-200, 200];
            BacklashMap::new([0, 1], [positions.clone(), positions], steps.to_vec()).unwrap()
        };
        let maps = [[20, 35, 28, 3], [7, 7, 30, 30], [0; 4]];
        let models = maps.map(|steps| MappedBacklash::new(map(steps), Flank::Positive));
        let machine: Any<_, (), Ramp> = Machine::with_backlash(router(0, None), models);
        compare(&machine, &acts, &lengths);
    }
}

#[cfg(feature = "extended")]
mod extended {
    use super::{act, in_slices, lengths, one_by_one, router};
    use husillo_backlash::Backlash;
    use husillo_gcode::{Dialect, Nm};
    use husillo_interp::Path;
    use husillo_machine::{Equipment, Event, Extended, Filled, Machine, SmoothRamp, StepEvent};
    use proptest::prelude::*;

    type Lathe = Machine<3, Path<3>, Backlash, 4, Extended<3>, SmoothRamp>;

    const ALL: Equipment = Equipment {
        splines: true,
        probe: true,
        digital_outputs: 4,
        analog_outputs: 2,
        digital_inputs: 4,
        analog_inputs: 2,
        spindle_angle: true,
        surface_milli_rpm: Some(6_000_000),
        tapping_overrun_turns: Some(3),
        heaters: true,
        adaptive_feed: true,
        pallets: true,
    };

    fn lathe(jerk_hz_per_s2: Option<u32>) -> Lathe {
        let mut config = router(0, jerk_hz_per_s2);
        config.dialect = Dialect::RS274;
        config.spindle_counts = Some(400);
        config.equipment = ALL;
        let mut machine = Lathe::new(config);
        machine.line(b"G21 G90 G94 F600").unwrap();
        machine
    }

    fn line() -> impl Strategy<Value = &'static str> {
        prop::sample::select(vec![
            "G38.3 X0.1 Y0.05 Z0",
            "G38.5 X0 Y0 Z0",
            "M62 P1",
            "M63 P1",
            "M64 P2",
            "M66 P0 L3 Q1",
            "G96 D2000 S20 M3",
            "G97 S500 M3",
            "G33 Z-0.05 K0.1",
            "M51 P0",
            "M51 P1",
            "M52 P1",
            "M53 P1",
            "G5 X0.2 Y0.1 I0.1 J0 P-0.1 Q0",
        ])
    }

    proptest! {
        /// The inputs come between two calls, at the same event in both machines.
        #[test]
        fn all_codes(
            acts in prop::collection::vec((act(), line(), 0..4_u8), 1..40),
            lengths in lengths(),
            has_jerk: bool,
        ) {
            let machine = lathe(has_jerk.then_some(80_000_000));
            let (mut one, mut many) = (machine.clone(), machine);
            let mut lengths = lengths.iter().copied().cycle();
            for (act, text, kind) in &acts {
                match (act, kind) {
                    (super::Act::Line(text), 0..2) => {
                        prop_assert_eq!(one.line(text.as_bytes()), many.line(text.as_bytes()));
                    }
                    (super::Act::Override(percent), _) => {
                        for machine in [&mut one, &mut many] {
                            machine.set_adaptive_feed(*percent % 120);
                            machine.set_feed_stop(*percent % 3 == 0);
                        }
                    }
                    (super::Act::Hold, _) => {
                        one.hold();
                        many.hold();
                    }
                    (super::Act::Take(most), _) => {
                        let expected = one_by_one(&mut one, *most);
                        let events = in_slices(&mut many, *most, &mut lengths);
                        prop_assert!(expected == events);
                        let awaits = expected.last().copied();
                        if matches!(awaits, Some(Event::Await { .. })) {
                            one.answer(Some(1_000_000));
                            many.answer(Some(1_000_000));
                        }
                    }
                    (super::Act::Resume, _) => {
                        for machine in [&mut one, &mut many] {
                            machine.set_adaptive_feed(100);
                            machine.set_feed_stop(false);
                            machine.resume();
                        }
                    }
                    (super::Act::Abort, 0) => {
                        one.abort();
                        many.abort();
                    }
                    _ => {
                        prop_assert_eq!(one.line(text.as_bytes()), many.line(text.as_bytes()));
                    }
                }
                prop_assert_eq!(one.position_steps(), many.position_steps());
                prop_assert_eq!(one.origin(), many.origin());
            }
        }
    }

    /// While the level of the probe matters, no step is made ahead of it.
    #[test]
    fn a_probe_is_asked_before_each_event() {
        let mut machine = lathe(None);
        machine.line(b"G1 X0.1").unwrap();
        machine.line(b"G38.3 X1").unwrap();
        let mut steps = [StepEvent::default(); 64];
        let mut made = 0;
        while made < 60 {
            assert!(machine.needs_probe());
            let filled = machine.fill(&mut steps);
            assert_eq!(
                filled,
                Filled {
                    steps: 1,
                    then: None
                }
            );
            made += 1;
        }
        machine.set_probe(true);
        let contact = machine.position_steps();
        while machine.is_probing() {
            assert!(machine.fill(&mut steps).steps <= 1);
        }
        assert_eq!(machine.probed().at[0], Nm(i64::from(contact[0]) * 2_500));
        assert_eq!(contact[0], 60);
    }
}

//! Any program on a machine.

use husillo_gcode::{Dialect, Nm};
use husillo_machine::{
    Axis, AxisRamp, Config, Equipment, Event, MAX_WAIT_TICKS, Machine, Origin, Refused, Scale,
};

/// Longest program in events.
const MOST_EVENTS: u32 = 20_000;

/// Any lines on a small machine, with and without ramps, with occasional holds and overrides. A
/// refused line changes nothing. No wait is longer than documented, every step is a single step,
/// and the tool stays within its travel. At the end it is at the target of the last accepted line.
pub fn machine(data: &[u8]) {
    // Steps of 0.1 mm, so that programs are short.
    let Some(scale) = Scale::new(100_000, 1) else {
        return;
    };
    let axis = Axis {
        scale,
        travel: Some([Nm(-10_000_000), Nm(10_000_000)]),
        max_rate_hz: 1000,
        backlash_steps: 3,
        ramp: None,
    };
    let ramp = AxisRamp {
        acceleration_hz_per_s: 2000,
        start_rate_hz: 0,
        jerk_hz_per_s2: Some(10_000),
        junction_hz: Some(30),
    };
    for (dialect, ramp) in [
        (Dialect::RS274, None),
        (Dialect::MICROMILL, None),
        (Dialect::RS274, Some(ramp)),
    ] {
        let axis = Axis { ramp, ..axis };
        let config = Config {
            axes: [axis, axis, Axis { ramp: None, ..axis }],
            timer_hz: 1_000_000,
            dialect,
            arc_tolerance: None,
            rapid: None,
            top_feed: None,
            corner_deviation: None,
            equipment: Equipment::NONE,
            spindle_counts: ramp.map(|_| 100),
        };
        run(config, data);
    }
}

fn run(config: Config<3>, data: &[u8]) {
    let mut machine = Machine::<3>::new(config);
    let mut events = 0;
    for line in data.split(|byte| matches!(byte, b'\n' | b'\r')) {
        for (_, text) in config.dialect.blocks(line) {
            while !machine.has_room() {
                let is_event = pull(&mut machine, &mut events);
                assert!(is_event || machine.has_room(), "what waits has its turn");
                if events > MOST_EVENTS {
                    return;
                }
            }
            let before = (machine.position_steps(), format!("{:?}", machine.modal()));
            match machine.line(text) {
                Ok(()) => {}
                Err(Refused::Busy) => unreachable!("there was room"),
                Err(_) => assert_eq!(
                    before,
                    (machine.position_steps(), format!("{:?}", machine.modal()))
                ),
            }
            match line.len() % 8 {
                1 => machine.hold(),
                2 => machine.set_feed_override((line.len() * 7) as u8),
                3 => _ = pull(&mut machine, &mut events),
                _ => {}
            }
        }
    }
    while pull(&mut machine, &mut events) {
        if events > MOST_EVENTS {
            return;
        }
    }
    let end = machine.modal().position();
    for (axis, (at, end)) in config
        .axes
        .iter()
        .zip(machine.position_steps().iter().zip(end))
    {
        assert_eq!(
            Some(*at),
            axis.scale.nearest(end.0),
            "it stands where it was sent"
        );
    }
}

/// Takes one event and ends a hold that has stopped. Returns whether there was an event.
fn pull(machine: &mut Machine<3>, events: &mut u32) -> bool {
    let event = match machine.next_event() {
        None if machine.is_held() => {
            machine.resume();
            machine.next_event()
        }
        event => event,
    };
    *events += 1;
    if let Some(event) = &event {
        check(event, machine);
    }
    event.is_some()
}

fn check(event: &Event<3>, machine: &Machine<3>) {
    match event {
        Event::Step(step) => {
            assert!(step.wait_ticks <= MAX_WAIT_TICKS);
            assert!(step.delta != [0; 3] && step.delta.iter().all(|delta| delta.abs() <= 1));
            assert!(machine.origin() != Origin::Rest);
        }
        Event::Dwell { wait_ticks } => assert!(*wait_ticks <= MAX_WAIT_TICKS),
        Event::Follow(step) => assert!(step.wait_counts_q16 <= MAX_WAIT_TICKS),
        Event::Output(_) | Event::Pause(_) | Event::Index => {}
        other => panic!("{other:?} of a plain machine"),
    }
    // Half a step of rounding; the nearest point of an arc may be one step off it.
    assert!(
        machine.position_steps().iter().all(|at| at.abs() <= 101),
        "{:?}",
        machine.position_steps()
    );
}

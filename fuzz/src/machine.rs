//! Any program on a machine.

use husillo_gcode::{Dialect, Nm};
use husillo_machine::{Axis, Config, Event, MAX_WAIT_TICKS, Machine, Origin, Refused, Scale};

/// No program is followed longer.
const MOST_EVENTS: u32 = 20_000;

/// Any lines on a small machine: a refused line changes nothing and gives no event, no wait is longer than promised, every
/// step is a step, and the tool stays within its travel.
pub fn machine(data: &[u8]) {
    // Steps of 0.1 mm, so that programs are short.
    let Some(scale) = Scale::new(100_000, 1) else {
        return;
    };
    let axis = Axis {
        scale,
        travel: Some([Nm(-10_000_000), Nm(10_000_000)]),
        max_rate_hz: 1000,
        lash_steps: 3,
        ramp: None,
    };
    for dialect in [Dialect::RS274, Dialect::MICROMILL] {
        let config = Config {
            axes: [axis; 3],
            timer_hz: 1_000_000,
            dialect,
            arc_tolerance: None,
            rapid: None,
            top_feed: None,
            corner_deviation: None,
        };
        run(config, data);
    }
}

fn run(config: Config<3>, data: &[u8]) {
    let mut machine = Machine::<3>::new(config);
    let mut events = 0;
    for line in data.split(|byte| *byte == b'\n') {
        for (_, text) in config.dialect.blocks(line) {
            let before = (machine.position_steps(), format!("{:?}", machine.modal()));
            match machine.line(text) {
                Ok(()) => {}
                Err(Refused::Busy) => unreachable!("everything before has been pulled"),
                Err(_) => {
                    assert_eq!(
                        before,
                        (machine.position_steps(), format!("{:?}", machine.modal()))
                    );
                    assert_eq!(machine.next_event(), None, "a refused line means nothing");
                }
            }
            while let Some(event) = machine.next_event() {
                check(&event, &machine);
                events += 1;
                if events > MOST_EVENTS {
                    return;
                }
            }
        }
    }
}

fn check(event: &Event<3>, machine: &Machine<3>) {
    match event {
        Event::Step(step) => {
            assert!(step.wait_ticks <= MAX_WAIT_TICKS);
            assert!(step.delta != [0; 3] && step.delta.iter().all(|delta| delta.abs() <= 1));
            assert!(machine.origin() != Origin::Rest);
        }
        Event::Dwell { wait_ticks } => assert!(*wait_ticks <= MAX_WAIT_TICKS),
        Event::Output(_) | Event::Pause(_) => {}
    }
    // Half a step of rounding, and an arc's nearest point may lie one step beside it.
    assert!(
        machine.position_steps().iter().all(|at| at.abs() <= 101),
        "{:?}",
        machine.position_steps()
    );
}

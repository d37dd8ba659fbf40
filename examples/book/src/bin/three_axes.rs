//! A G-code controller of three axes, with a probe and with splines, on `Machine`.

use husillo_machine::backlash::Backlash;
use husillo_machine::gcode::{Dialect, Nm};
use husillo_machine::interp::Path;
use husillo_machine::{
    Axis, AxisRamp, Config, Equipment, Event, Extended, Machine, Refused, Scale,
};

// ANCHOR: config
type Controller = Machine<3, Path<3>, Backlash, 16, Extended<3>>;

fn config() -> Config<3> {
    let axis = Axis {
        scale: Scale::new(2_500, 1).expect("not zero"), // 400 steps per millimetre
        travel: Some([Nm(-50_000_000), Nm(200_000_000)]),
        max_rate_hz: 20_000, // 3000 mm/min
        backlash_steps: 0,
        ramp: Some(AxisRamp {
            acceleration_hz_per_s: 200_000,
            start_rate_hz: 0,
            jerk_hz_per_s2: None,
            junction_hz: None,
        }),
    };
    Config {
        axes: [axis; 3],
        timer_hz: 1_000_000,
        dialect: Dialect::RS274,
        arc_tolerance: None,
        rapid: None,
        top_feed: None,
        corner_deviation: Some(Nm(10_000)),
        spindle_counts: None,
        equipment: Equipment {
            probe: true,
            splines: true,
            ..Equipment::NONE
        },
    }
}
// ANCHOR_END: config

/// The work piece: its surface, in steps.
const SURFACE: i32 = -493;

const PROGRAM: [&str; 6] = [
    "G21 G90 G0 X5 Y5 Z2",
    "G38.2 Z-10 F120",
    "G92 Z0", // where the axes stand after the contact
    "G0 Z1",
    "G5 X25 Y5 I10 J20 P-10 Q20 F600",
    "G0 X0 Y0",
];

// ANCHOR: run
/// Makes all events that are due, and returns their time in microseconds.
fn run(machine: &mut Controller, motors: &mut [i32; 3]) -> u64 {
    let mut us = 0;
    loop {
        machine.set_probe(motors[2] <= SURFACE); // the pin, after the last event
        match machine.next_event() {
            // A firmware waits, and then writes the steps to its pins.
            Some(Event::Step(step)) => {
                us += u64::from(step.wait_ticks);
                motors
                    .iter_mut()
                    .zip(step.delta)
                    .for_each(|(at, by)| *at += i32::from(by));
            }
            Some(Event::Dwell { wait_ticks }) => us += u64::from(wait_ticks),
            Some(Event::Probed { .. }) => {
                let probed = machine.probed();
                println!("  contact at Z {} mm", probed.at[2]);
                assert!(probed.is_touched);
            }
            Some(other) => println!("  {other:?}"),
            None => return us,
        }
    }
}

fn main() -> Result<(), Refused> {
    let mut machine = Controller::new(config());
    let mut motors = [0; 3];
    for line in PROGRAM {
        println!("{line}");
        // A line is taken when there is room, and when the result of a probing move is known.
        while !machine.has_room() {
            run(&mut machine, &mut motors);
        }
        machine.line(line.as_bytes())?;
        let us = run(&mut machine, &mut motors);
        println!("  {:.3} s, motors at {motors:?}", us as f64 / 1e6);
        assert_eq!(machine.position_steps(), motors);
    }
    // ANCHOR_END: run

    // ANCHOR: refused
    // Out of reach: the whole line is refused, and nothing moves.
    let refused = machine
        .line(b"G5 X100 Y0 I0 J900 P0 Q900")
        .expect_err("beyond the travel");
    println!("refused: {refused}");
    assert_eq!(machine.next_event(), None);
    // ANCHOR_END: refused
    assert_eq!(machine.probed().at[2], Nm(i64::from(SURFACE) * 2_500));
    assert_eq!(motors[..2], [0, 0]);
    Ok(())
}

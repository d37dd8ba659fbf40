//! Commands beyond plain moves: cutter compensation, probing, curves, inputs and outputs in time
//! with moves, constant surface speed.

#[path = "extended/curves.rs"]
mod curves;
#[path = "extended/outputs.rs"]
mod outputs;
#[path = "extended/probing.rs"]
mod probing;
#[path = "extended/refused.rs"]
mod refused;
#[path = "extended/stages.rs"]
mod stages;
#[path = "extended/tapping.rs"]
mod tapping;

use husillo_machine::backlash::Backlash;
use husillo_machine::gcode::{Dialect, Nm};
use husillo_machine::interp::Path;
use husillo_machine::{Axis, AxisRamp, Config, Equipment, Event, Extended, Machine, Scale};

type ExtendedMachine = Machine<3, Path<3>, Backlash, 16, Extended<3>>;

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
    pallets: true,
};

/// A mill with steps of 2.5 um, in X and Y from 0 to 300 mm.
fn config(has_ramps: bool) -> Config<3> {
    let axis = |travel: [i64; 2]| Axis {
        scale: Scale::new(2500, 1).unwrap(),
        travel: Some(travel.map(|mm| Nm(mm * 1_000_000))),
        max_rate_hz: 40_000,
        backlash_steps: 0,
        ramp: has_ramps.then_some(AxisRamp {
            acceleration_hz_per_s: 200_000,
            start_rate_hz: 400,
            jerk_hz_per_s2: None,
            junction_hz: Some(2_000),
        }),
    };
    Config {
        axes: [axis([0, 300]), axis([0, 300]), axis([-50, 50])],
        timer_hz: 8_000_000,
        dialect: Dialect::RS274,
        arc_tolerance: None,
        rapid: None,
        top_feed: None,
        spindle_counts: None,
        corner_deviation: Some(Nm(20_000)),
        equipment: ALL,
    }
}

/// Runs lines to their end; `each` gets the machine after each event, and may set its inputs.
fn run(
    machine: &mut ExtendedMachine,
    lines: &[&str],
    mut each: impl FnMut(&mut ExtendedMachine, &Event<3>),
) {
    for line in lines {
        machine
            .line(line.as_bytes())
            .unwrap_or_else(|error| panic!("{line}: {error}"));
        while !machine.has_room() {
            let event = machine.next_event().expect("room comes with events");
            each(machine, &event);
        }
    }
    machine.finish().unwrap();
    while let Some(event) = machine.next_event() {
        each(machine, &event);
    }
}

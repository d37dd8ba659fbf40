//! Lines of G-code in, levels at the pins of A4988 drivers out: a controller of two axes.
//!
//! ```text
//! cargo run -p husillo-machine --example lines_to_pins
//! ```

use husillo_gcode::{Dialect, Nm};
use husillo_machine::{Axis, AxisRamp, Config, Equipment, Event, Machine, Refused, Scale};
use husillo_stepper::{Idle, Motors, PulseNanoseconds, StepDirection};

/// Ticks of 100 ns.
const TIMER_HZ: u32 = 10_000_000;

const PROGRAM: [&str; 4] = [
    "G21 G90 G1 X0.1 Y0.05 F600",
    "G2 X0.2 Y0.05 I0.05 J0",
    "M3 S8000",
    "G0 X0 Y0",
];

fn config() -> Config<2> {
    let axis = Axis {
        scale: Scale::new(12_500, 1).unwrap(), // 80 steps per millimetre
        travel: Some([Nm(-1_000_000), Nm(100_000_000)]),
        max_rate_hz: 8000,
        backlash_steps: 0,
        ramp: Some(AxisRamp {
            start_rate_hz: 0,
            acceleration_hz_per_s: 40_000,
            junction_hz: None,
            jerk_hz_per_s2: None,
        }),
    };
    Config {
        axes: [axis; 2],
        timer_hz: TIMER_HZ,
        dialect: Dialect::GRBL,
        arc_tolerance: None,
        rapid: None,
        top_feed: None,
        corner_deviation: Some(Nm(10_000)),
        equipment: Equipment::NONE,
        spindle_counts: None,
    }
}

fn main() {
    let mut machine: Machine<2> = Machine::new(config());
    let driver = StepDirection::new(PulseNanoseconds::A4988.ticks(TIMER_HZ));
    let mut motors = Motors::new([driver; 2], Idle::Hold);
    let mut lines = PROGRAM.iter().peekable();
    println!("  us later  X: STEP DIR  Y: STEP DIR");
    loop {
        // The queue is kept full, so that moves are planned ahead.
        while let Some(line) = lines.peek() {
            match machine.line(line.as_bytes()) {
                Ok(()) => drop(lines.next()),
                Err(Refused::Busy) => break,
                Err(refused) => return eprintln!("{line}: {refused}"),
            }
        }
        // A firmware hands each wait to its timer, and writes the levels when it has passed.
        let print = |ticks: u32, [x, y]: &[husillo_stepper::Levels; 2]| {
            let us = f64::from(ticks) / 10.0;
            let [x_step, x_dir] = [x.is_high(0), x.is_high(1)].map(u8::from);
            let [y_step, y_dir] = [y.is_high(0), y.is_high(1)].map(u8::from);
            println!("{us:10.1}     {x_step}    {x_dir}       {y_step}    {y_dir}");
        };
        match machine.next_event() {
            Some(Event::Step(step)) => motors.step(step.wait_ticks, &step.delta, print),
            Some(Event::Dwell { wait_ticks }) => motors.rest(wait_ticks, print),
            Some(other) => println!("{other:?}"),
            None => break,
        }
    }
    motors.end_pulses(|_, _| {});
    println!("at {:?} steps", machine.position_steps());
}

//! An arc at the pins of two kinds of drivers: A3988 (coils) and A4988 (STEP and DIR).

use embedded_hal::delay::DelayNs;
use husillo_book::{clock::Clock, pin::Pin};
use husillo_interp::{ArcMove, Direction, Interpolator, Moves, Path, Rim};
use husillo_planner::Timer;
use husillo_stepper::{
    CoilDriver, Driver, DriverPins, LevelPins, Mode, PulseNanoseconds, Sequencer,
    StepDirectionPins, StepPulses,
};
use std::error::Error;

// ANCHOR: arc
/// A whole circle of 100 steps radius around (0, 0), counter-clockwise.
const CIRCLE: ArcMove = ArcMove {
    from: [100, 0],
    to: [100, 0],
    centre: [0, 0],
    fraction_bits: 0,
    direction: Direction::CounterClockwise,
    turns: 0,
    rim: Rim::Spiral,
};

/// The events of the circle with the microseconds before each: 628 steps of path in one second.
fn events() -> Result<impl Iterator<Item = (u32, [i8; 2])>, husillo_interp::ArcError> {
    let path = Path::<2>::arc(&CIRCLE, [0, 1], [0, 0])?;
    let mut timer = Timer::new(1_000_000, path.total_sweep(), path.largest_sweep());
    Ok(path.map(move |step| (timer.wait(step.sweep) as u32, step.deltas())))
}
// ANCHOR_END: arc

fn main() -> Result<(), Box<dyn Error>> {
    // ANCHOR: coils
    // Each A3988 has six inputs: PH, I0 and I1 of both coils.
    let inputs: [[Pin; 6]; 2] = Default::default();
    let [x, y] = inputs.clone();
    let mut pins = (
        LevelPins::of(Driver::A3988, x)?,
        LevelPins::of(Driver::A3988, y)?,
    );
    let mut motors = [Sequencer::new(Driver::A3988, Mode::Full)?; 2];
    let mut delay = Clock::default();
    pins.write(&motors.each_ref().map(CoilDriver::levels))?; // the phase at rest
    for (wait_us, [dx, dy]) in events()? {
        delay.delay_us(wait_us);
        let [x, y] = &mut motors;
        pins.write(&[x.step(dx), y.step(dy)])?;
    }
    // ANCHOR_END: coils
    println!(
        "A3988, {} ms: rising edges of the inputs",
        delay.us() / 1000
    );
    for (axis, pins) in ["X", "Y"].iter().zip(&inputs) {
        print!("  {axis}:");
        for (name, pin) in Driver::A3988.pins().iter().zip(pins) {
            print!("  {name} {}", pin.rising_edges());
        }
        println!();
    }

    // ANCHOR: pulses
    // An A4988 has STEP and DIR, and a low ENABLE switches it on.
    let (steps, directions, enables): ([Pin; 2], [Pin; 2], [Pin; 2]) = Default::default();
    let drivers = [0, 1].map(|axis| {
        let [step, direction, enable] = [&steps, &directions, &enables].map(|pins| &pins[axis]);
        StepDirectionPins::active_low(step.clone(), direction.clone(), enable.clone())
    });
    let mut motors = StepPulses::new(drivers, [PulseNanoseconds::A4988; 2]);
    let mut delay = Clock::default();
    let (mut made, mut due_ns) = ([0_u32; 2], 0);
    for (wait_us, deltas) in events()? {
        // The pulses take their time from the wait.
        due_ns += 1000 * u64::from(wait_us);
        delay.delay_ns((due_ns - delay.ns()) as u32);
        motors.step(&deltas, &mut delay)?;
        for axis in [0, 1] {
            made[axis] += u32::from(deltas[axis].unsigned_abs());
        }
    }
    // ANCHOR_END: pulses
    println!("A4988, {} ms: rising edges", delay.us() / 1000);
    for axis in [0, 1] {
        let [step, direction] = [&steps, &directions].map(|pins| pins[axis].rising_edges());
        println!("  {}:  STEP {step}  DIR {direction}", ["X", "Y"][axis]);
        assert_eq!(
            step, made[axis],
            "the A4988 counts rising edges: one for each step"
        );
    }
    // From 100 to -100 and back, in each axis.
    assert_eq!(made, [400, 400]);
    Ok(())
}

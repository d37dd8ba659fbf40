//! A machine of six axes, X Y Z and the rotary A B C, on a microcontroller: the lines of a program
//! in, steps of six motors out.
//!
//! On your own board, replace [`Motors`] with a timer and the pins of the drivers, and [`PROGRAM`]
//! with the lines of a port.
#![no_std]
#![no_main]

use husillo_backlash::Backlash;
use husillo_gcode::{Axes, Dialect};
use husillo_interp::Path;
use husillo_machine::{
    Axis, AxisRamp, Config, Equipment, Event, Machine, Pause, Refused, Scale, StepEvent,
};
use semihosting::println;

/// Moves as a CAM system writes them for five axes and a turntable: `G93` gives the time of a move
/// in which the tool and the part turn.
const PROGRAM: [&str; 10] = [
    "G21 G90 G94",
    "G0 X10 Y5 Z2",
    "G0 A30 B-15 C90",
    "G1 Z-1 F600",
    "G93 G1 X12 Y6 A35 B-10 F30",
    "G1 X14 Y7 A40 B-5 C95 F30",
    "G94 G3 X10 Y7 I-2 F300",
    "G0 Z5",
    "G0 A0 B0 C0",
    "M2",
];

const TIMER_HZ: u32 = 1_000_000;
/// 400 steps per millimetre.
const LINEAR: Option<Scale> = Scale::new(2_500, 1);
/// 80 steps per degree.
const ROTARY: Option<Scale> = Scale::new(12_500, 1);

/// A queue of two moves: with the stack of a line it takes less than 64 kB of RAM. A longer queue
/// looks further ahead.
type SixAxes = Machine<6, Path<6>, Backlash, 2>;

/// Stands in for the drivers of six motors.
#[derive(Default)]
struct Motors {
    /// Position of each motor, in steps.
    at: [i32; 6],
    /// Steps that each motor has made.
    made: [u32; 6],
    ticks: u64,
}

impl Motors {
    fn step(&mut self, step: &StepEvent<6>) {
        self.ticks += u64::from(step.wait_ticks);
        for ((at, made), delta) in self.at.iter_mut().zip(&mut self.made).zip(step.delta) {
            *at += i32::from(delta);
            *made += u32::from(delta.unsigned_abs());
        }
    }
}

#[cfg_attr(target_arch = "arm", cortex_m_rt::entry)]
#[cfg_attr(target_arch = "riscv32", riscv_rt::entry)]
fn main() -> ! {
    let Some(config) = config() else {
        panic!("six axes with their steps")
    };
    let mut machine = SixAxes::new(config);
    let mut motors = Motors::default();
    for line in PROGRAM {
        // Events are carried out until the queue has room for the moves of this line.
        while !machine.has_room() {
            carry_out(&mut machine, &mut motors);
        }
        match machine.line(line.as_bytes()) {
            Ok(()) => {}
            Err(Refused::Program(error)) => panic!("{line}: {error}"),
            Err(error) => panic!("{line}: {error}"),
        }
    }
    while carry_out(&mut machine, &mut motors) {}

    println!("at: {:?} after {} ms", motors.at, motors.ticks / 1000);
    println!("steps: {:?}", motors.made);
    assert_eq!(motors.at, [4_000, 2_800, 2_000, 0, 0, 0]);
    // The rotary axes go there and back.
    assert_eq!(motors.made[3..], [6_400, 2_400, 15_200]);
    assert_eq!(machine.position_steps(), motors.at);
    semihosting::process::exit(0)
}

/// Carries out the next events. Returns `false` at the end of the program.
fn carry_out(machine: &mut SixAxes, motors: &mut Motors) -> bool {
    let mut steps = [StepEvent::default(); 16];
    let filled = machine.fill(&mut steps);
    for step in steps.iter().take(filled.steps) {
        motors.step(step);
    }
    match filled.then {
        Some(Event::Dwell { wait_ticks }) => motors.ticks += u64::from(wait_ticks),
        Some(Event::Pause(Pause::End { .. })) => return false,
        // Spindle and coolant: outputs of the board.
        Some(_) => {}
        None => return filled.steps != 0,
    }
    true
}

/// Every axis has a ramp, so moves are joined without a stop where the path allows it.
fn config() -> Option<Config<6>> {
    let axes = Axes::new(b"XYZABC")?;
    let axis = |scale| Axis {
        scale,
        travel: None,
        max_rate_hz: 20_000,
        backlash_steps: 0,
        ramp: Some(AxisRamp {
            acceleration_hz_per_s: 200_000,
            start_rate_hz: 400,
            jerk_hz_per_s2: None,
            junction_hz: None,
        }),
    };
    let (linear, rotary) = (axis(LINEAR?), axis(ROTARY?));
    Some(Config {
        axes: [linear, linear, linear, rotary, rotary, rotary],
        timer_hz: TIMER_HZ,
        dialect: Dialect::RS274.with_axes(axes),
        arc_tolerance: None,
        rapid: None,
        top_feed: None,
        corner_deviation: None,
        equipment: Equipment::NONE,
        spindle_counts: None,
    })
}

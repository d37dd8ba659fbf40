//! The micro mill's firmware: strings come in by the UART, step events go out by a timer's interrupt.
//!
//! ```text
//! UART interrupt ──bytes──► foreground: Mill ──events──► queue ──► step interrupt ──► pins
//!                               ◄──────────── how many were made ────────┘
//! ```
//!
//! All that belongs to a board is one file in `board`.
#![no_std]
#![no_main]

mod motors;

use board::{Shared, Step, Steps};
use husillo_gcode::SpindleDirection;
use husillo_machine::{Mill, MillConfig, MillEvent, MillInputs, MillStops, StepEvent};
use husillo_stepper::{Driver, Mode, Sequencer};
use motors::Motors;

/// The machine: another one is another constant.
static CONFIG: MillConfig = MillConfig::MICROMILL;

/// Events that may wait for their time.
const AHEAD: usize = 8;

type Micromill = Mill<'static, 16, AHEAD, 64>;

static STEPS: Shared<Steps<[i8; 3], AHEAD>> = Shared::new(Steps::new([0; 3]));

/// Bytes that stop what moves.
static STOPS: Shared<MillStops> = Shared::new(MillStops::Nothing);

/// The wait of a step is over.
#[unsafe(no_mangle)]
fn on_time() {
    STEPS.with(Steps::on_time);
}

/// What stops acts at once: the foreground may be busy for some steps.
#[unsafe(no_mangle)]
fn on_byte(byte: u8) {
    if STOPS.with(|stops| stops.takes(byte)) {
        STEPS.with(Steps::hold);
    }
}

/// Everything else.
#[board::entry]
fn main() -> ! {
    board::start();
    let Ok(motor) = Sequencer::new(Driver::Pbl3717a, Mode::Full) else {
        // This driver has that mode.
        loop {
            core::hint::spin_loop();
        }
    };
    let mut motors = Motors::new(motor);
    board::write(motors.levels());
    let mut mill = Mill::new(&CONFIG);
    run(&mut mill, &mut motors)
}

/// What `main` keeps on the stack while this runs is only its arguments.
#[inline(never)]
fn run(mill: &mut Micromill, motors: &mut Motors) -> ! {
    let mut told = 0_u8;
    let mut unsent = None;
    loop {
        tell(mill, &mut told, STEPS.with(|steps| steps.made()));
        while let Some(byte) = board::received() {
            if mill.receive(byte) {
                halt(mill, motors, &mut told);
            }
        }
        STOPS.with(|stops| *stops = mill.stops());
        STEPS.with(|steps| {
            // It was none of those that stop.
            if !board::has_heard() {
                steps.release();
            }
        });
        send(mill, &mut unsent);
        let inputs = MillInputs {
            home: home(mill.position_steps()),
        };
        while let Some(event) = mill.next_event(&inputs) {
            match event {
                MillEvent::Step(step) => push(&step, motors),
                // Its speed is set by hand.
                MillEvent::Spindle { direction, .. } => board::switch(spindle(direction)),
                // The operator changes it: the host asks for it and waits.
                MillEvent::Tool { .. } => {}
            }
        }
        // Behind the events: a line that ends without one is told too before it sleeps.
        if unsent.is_none() {
            unsent = mill.transmit();
        }
        if unsent.is_none() {
            board::sleep(|| STEPS.with(|steps| steps.made() == told));
        }
    }
}

/// Tells what was made.
#[inline]
fn tell(mill: &mut Micromill, told: &mut u8, made: u8) {
    while *told != made {
        mill.made();
        *told = told.wrapping_add(1);
    }
}

/// Sends what the transmitter takes.
#[inline]
fn send(mill: &mut Micromill, unsent: &mut Option<u8>) {
    while let Some(byte) = unsent.take().or_else(|| mill.transmit()) {
        if !board::send(byte) {
            *unsent = Some(byte);
            return;
        }
    }
}

/// The home switches. A simulated machine's close at 400 steps below where it was switched on.
#[inline]
fn home(position_steps: [i32; 3]) -> [bool; 3] {
    let [x, y, z] = position_steps.map(|steps| u8::from(steps <= -400));
    let bits = board::inputs(x | y << 1 | z << 2);
    [bits & 1 != 0, bits & 2 != 0, bits & 4 != 0]
}

/// Forwards and backwards.
fn spindle(direction: SpindleDirection) -> u8 {
    match direction {
        SpindleDirection::Off => 0b00,
        SpindleDirection::Clockwise => 0b01,
        SpindleDirection::CounterClockwise => 0b10,
    }
}

/// Queues a step: `Mill` gives no more than the queue holds.
fn push(step: &StepEvent<3>, motors: &mut Motors) {
    let step = Step {
        wait_us: step.wait_ticks,
        delta: step.delta,
        levels: motors.step(&step.delta),
    };
    STEPS.with(|steps| steps.push(step));
}

/// Stops: what has not been made will not be, and the motors' phases are those of what has.
fn halt(mill: &mut Micromill, motors: &mut Motors, told: &mut u8) {
    let made = STEPS.with(|steps| {
        steps.stop().for_each(|step| {
            motors.step(&step.delta.map(i8::wrapping_neg));
        });
        steps.made()
    });
    tell(mill, told, made);
    mill.halted();
}

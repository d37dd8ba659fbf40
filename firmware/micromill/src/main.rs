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

use board::{Shared, Step, Steps};
use husillo_gcode::SpindleDirection;
use husillo_machine::{Idle, Mill, MillConfig, MillEvent, MillInputs, Motors, StepEvent};
use husillo_stepper::{Driver, Levels, Mode, Sequencer};

/// The machine: another one is another constant.
static CONFIG: MillConfig = MillConfig::MICROMILL;

/// Events that may wait for their time, and one place that the queue keeps free.
const AHEAD: usize = 8;
const PLACES: usize = AHEAD + 1;

static STEPS: Shared<Steps<[i8; 3], PLACES>> = Shared::new(Steps::new());

/// The wait of a step is over.
#[unsafe(no_mangle)]
fn on_time() {
    STEPS.with(Steps::on_time);
}

/// The foreground takes them all.
#[unsafe(no_mangle)]
fn on_byte(_: u8) {}

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
    let mut motors = Motors::new([motor; 3], Idle::Hold);
    board::write(phases(motors.levels()));
    let mut mill = Mill::new(&CONFIG);
    run(&mut mill, &mut motors)
}

/// What `main` keeps on the stack while this runs is only its arguments.
#[inline(never)]
fn run(mill: &mut Mill<'_, 16, AHEAD, 64>, motors: &mut Motors<3, Sequencer>) -> ! {
    let mut told = 0_u8;
    let mut unsent = None;
    loop {
        let mut is_idle = true;
        let made = STEPS.with(|steps| steps.made());
        while told != made {
            mill.made();
            told = told.wrapping_add(1);
        }
        while let Some(byte) = board::received() {
            if mill.receive(byte) {
                halt(mill, motors, &mut told);
            }
            is_idle = false;
        }
        let inputs = MillInputs {
            home: home(mill.position_steps()),
        };
        match mill.next_event(&inputs) {
            Some(MillEvent::Step(step)) => {
                push(&step, motors);
                is_idle = false;
            }
            // Its speed is set by hand.
            Some(MillEvent::Spindle { direction, .. }) => {
                board::switch(spindle(direction));
                is_idle = false;
            }
            // The operator changes it: the host asks for it and waits.
            Some(MillEvent::Tool { .. }) => is_idle = false,
            None => {}
        }
        // Behind the events: a line that ends without one is told too before it sleeps.
        unsent = unsent.or_else(|| mill.transmit());
        if let Some(byte) = unsent {
            if board::send(byte) {
                unsent = None;
            }
            is_idle = false;
        }
        if is_idle {
            board::sleep(|| STEPS.with(|steps| steps.made() == told));
        }
    }
}

/// The home switches. A simulated machine's close at 400 steps below where it was switched on.
fn home(position_steps: [i32; 3]) -> [bool; 3] {
    let simulated = position_steps
        .iter()
        .rev()
        .fold(0, |bits, steps| bits << 1 | u8::from(*steps <= -400));
    let bits = board::inputs(simulated);
    [0, 1, 2].map(|axis| bits >> axis & 1 == 1)
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
fn push(step: &StepEvent<3>, motors: &mut Motors<3, Sequencer>) {
    let step = Step {
        wait_us: step.wait_ticks,
        delta: step.delta,
        levels: phases(motors.step(&step.delta)),
    };
    STEPS.with(|steps| steps.push(step));
}

/// Stops: what has not been made will not be, and the motors' phases are those of what has.
fn halt(mill: &mut Mill<'_, 16, AHEAD, 64>, motors: &mut Motors<3, Sequencer>, told: &mut u8) {
    let made = STEPS.with(|steps| {
        steps.stop().for_each(|step| {
            motors.step(&step.delta.map(i8::wrapping_neg));
        });
        steps.made()
    });
    while *told != made {
        mill.made();
        *told = told.wrapping_add(1);
    }
    mill.halted();
}

/// The levels of PH: in full steps both I0 and I1 stay low.
fn phases(levels: &[Levels; 3]) -> u8 {
    levels.iter().rev().fold(0, |word, levels| {
        word << 2 | (levels.0 & 1) | (levels.0 >> 2 & 2)
    })
}

//! The micro mill's firmware: strings come in by the UART, step events go out by a timer's interrupt.
//!
//! ```text
//! UART interrupt ──bytes──► foreground: Micromill ──events──► queue ──► step interrupt ──► pins
//!                               ◄──────────── how many were made ────────┘
//! ```
//!
//! All that belongs to a board is one file in `board`.
#![no_std]
#![no_main]

mod motors;

use board::{CriticalSection, Shared, Step, Steps};
use husillo_controllers::{
    MicromillConfig, MicromillEvent, MicromillInputs, MicromillStep, MicromillStops,
};
use husillo_gcode::SpindleDirection;
use husillo_stepper::{Driver, Mode, Sequencer};
use motors::Motors;

/// The machine: another one is another constant.
static CONFIG: MicromillConfig = MicromillConfig::MICROMILL;

/// Events that may wait for their time.
const AHEAD: usize = 16;

type Micromill = husillo_controllers::Micromill<'static, 16, AHEAD, 80>;

/// What is made before the foreground follows, where it need not tell of them at once.
const TOGETHER: u8 = AHEAD as u8 / 2;

/// A step that was not made goes back by its masks: axes, and those that go backwards.
type Masks = [u8; 2];

/// What the interrupts work on.
struct Interrupts {
    steps: Steps<Masks, AHEAD>,
    /// Bytes that stop what moves.
    stops: MicromillStops,
}

static INTERRUPTS: Shared<Interrupts> = Shared::new(Interrupts {
    steps: Steps::new([0; 2]),
    stops: MicromillStops::Nothing,
});

/// The wait of a step is over.
#[unsafe(no_mangle)]
fn on_time(section: CriticalSection<'_>) {
    INTERRUPTS.within(section, |now| now.steps.on_time(section));
}

/// What stops acts at once: the foreground may be busy for some steps.
#[unsafe(no_mangle)]
fn on_byte(byte: u8, section: CriticalSection<'_>) {
    INTERRUPTS.within(section, |now| {
        if now.stops.takes(byte) {
            now.steps.hold();
        }
    });
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
    board::write(motors.step([0; 2]));
    let mut mill = Micromill::new(&CONFIG);
    run(&mut mill, &mut motors)
}

/// What `main` keeps on the stack while this runs is only its arguments.
#[inline(never)]
fn run(mill: &mut Micromill, motors: &mut Motors) -> ! {
    let mut told = 0_u8;
    let mut unsent = None;
    loop {
        follow(mill, &mut told, INTERRUPTS.with(|now| now.steps.made()));
        while let Some(byte) = board::received() {
            if mill.receive(byte) {
                halt(mill, motors, &mut told);
            }
        }
        board::uninterrupted(|section| {
            INTERRUPTS.within(section, |now| {
                now.stops = mill.stops();
                // It was none of those that stop.
                if !board::has_heard() {
                    now.steps.release(section);
                }
            });
        });
        send(mill, &mut unsent);
        let inputs = MicromillInputs { home: home(mill) };
        while let Some(event) = mill.next_event(&inputs) {
            match event {
                MicromillEvent::Step(step) => push(&step, motors),
                // Its speed is set by hand.
                MicromillEvent::Spindle { direction, .. } => board::switch(spindle(direction)),
                // The operator changes it: the host asks for it and waits.
                MicromillEvent::Tool { .. } => {}
            }
        }
        // Behind the events: a line that ends without one is told too before it sleeps.
        if unsent.is_none() {
            unsent = mill.transmit();
        }
        if unsent.is_none() {
            let together = if mill.will_tell() { 1 } else { TOGETHER };
            board::sleep(|section| {
                INTERRUPTS.within(section, |now| {
                    let new = now.steps.made().wrapping_sub(told);
                    new == 0 || new < together && !now.steps.is_empty()
                })
            });
        }
    }
}

/// Says what was made.
#[inline(never)]
fn follow(mill: &mut Micromill, told: &mut u8, made: u8) {
    mill.made(made.wrapping_sub(*told).into());
    *told = made;
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

/// The home switches. A simulated machine's close at 400 steps below where it was switched on: outside of the travel, once it is homed.
#[inline]
fn home(mill: &Micromill) -> u8 {
    let simulated = if mill.is_homed() {
        0
    } else {
        let [x, y, z] = mill.position_steps().map(|steps| u8::from(steps <= -400));
        x | y << 1 | z << 2
    };
    board::inputs(simulated)
}

/// Forwards and backwards.
fn spindle(direction: SpindleDirection) -> u8 {
    match direction {
        SpindleDirection::Off => 0b00,
        SpindleDirection::Clockwise => 0b01,
        SpindleDirection::CounterClockwise => 0b10,
    }
}

/// Queues a step: `Micromill` gives no more than the queue holds.
fn push(step: &MicromillStep, motors: &mut Motors) {
    let step = Step {
        wait_us: step.wait_ticks,
        delta: [step.axes, step.negative],
        levels: motors.step([step.axes, step.negative]),
    };
    board::uninterrupted(|section| {
        INTERRUPTS.within(section, |now| now.steps.push(step, section));
    });
}

/// Stops: what has not been made will not be, and the motors' phases are those of what has.
fn halt(mill: &mut Micromill, motors: &mut Motors, told: &mut u8) {
    let made = INTERRUPTS.with(|now| {
        now.steps.stop().for_each(|step| {
            let [axes, negative] = step.delta;
            motors.step([axes, axes & !negative]);
        });
        now.steps.made()
    });
    follow(mill, told, made);
    mill.halted();
}

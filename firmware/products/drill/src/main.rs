//! The circuit-board drill's firmware: bytes come in by the UART, steps go out by a timer's interrupt, one at a time with the switches as they are.
//!
//! ```text
//! UART interrupt ──bytes──► foreground: Drill ──one event──► step interrupt ──► pins
//!                               ▲  ▲                               │
//!                  switches ────┘  └──────────── it was made ──────┘
//! ```
//!
//! All that belongs to a board is one file in `board`.
#![no_std]
#![no_main]

mod switches;

use board::{CriticalSection, Shared, Step, Steps};
use husillo_controllers::{Controller, Drill, DrillConfig, DrillEvent, Timed};
use husillo_machine::{Idle, Motors};
use husillo_stepper::{Driver, Levels, Mode, Sequencer};
use husillo_transports::drill::MEMORY_BYTES;
use switches::Switches;

/// In its place from the start: on the stack there is no room to make it.
static DRILL: Shared<Drill<MEMORY_BYTES>> = Shared::new(Drill::new(CONFIG));

const CONFIG: DrillConfig = if cfg!(feature = "faithful") {
    DrillConfig::ORIGINAL
} else {
    DrillConfig::FIXED
};

static STEPS: Shared<Steps<(), 1>> = Shared::new(Steps::new(()));

/// The wait of a step is over.
#[unsafe(no_mangle)]
fn on_time(section: CriticalSection<'_>) {
    STEPS.within(section, |steps| steps.on_time(section));
}

/// The foreground takes them all: what stops this machine is its button R, which is the chip's reset.
#[unsafe(no_mangle)]
fn on_byte(_: u8, _: CriticalSection<'_>) {}

/// Everything else.
#[board::entry]
fn main() -> ! {
    board::start();
    let Ok(motor) = Sequencer::new(Driver::Unipolar, Mode::Full) else {
        // This driver has that mode.
        loop {
            core::hint::spin_loop();
        }
    };
    let mut motors = Motors::new([motor; 3], Idle::Hold);
    let mut levels = pins(motors.levels());
    board::write(levels);
    let mut switches = Switches::new();
    let mut unsent = None;
    loop {
        while let Some(byte) = board::received() {
            DRILL.with(|drill| drill.push(byte));
        }
        let mut is_idle = true;
        let are_made = STEPS.are_made();
        if are_made {
            let inputs = switches.inputs();
            let event = DRILL.with(|drill| Controller::next_event(drill, 0, &inputs));
            match event {
                Some(DrillEvent::Step(step)) => {
                    switches.moved(&step.delta);
                    motors.step(step.wait_ticks, &step.delta, |_, all| levels = pins(all));
                }
                Some(DrillEvent::Spindle(on)) => board::switch(on.into()),
                // There is no panel.
                _ => {}
            }
            is_idle = event.is_none();
            if let Some(wait_us) = event.and_then(|event| event.wait_ticks()) {
                STEPS.push(Step {
                    wait_us,
                    levels,
                    delta: (),
                });
            }
        }
        unsent = unsent.or_else(|| DRILL.with(Drill::transmit));
        if let Some(byte) = unsent {
            if board::send(byte) {
                unsent = None;
            }
            is_idle = false;
        }
        if is_idle {
            board::sleep(|section| STEPS.within(section, |steps| steps.is_empty()) == are_made);
        }
    }
}

/// The first two of four wires of each motor, from bit 0: with two phases on the others are their opposites, by inverters.
fn pins(levels: &[Levels; 3]) -> u8 {
    levels
        .iter()
        .rev()
        .fold(0, |word, levels| word << 2 | levels.0 & 0b11)
}

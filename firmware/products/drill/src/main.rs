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
use husillo_controllers::{Drill, DrillConfig, DrillEvent};
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
            let event = DRILL.with(|drill| drill.next_event(&switches.inputs()));
            let wait_us = match event {
                DrillEvent::Step(step) => {
                    switches.moved(&step.delta);
                    motors.step(step.wait_ticks, &step.delta, |_, all| levels = pins(all));
                    Some(step.wait_ticks)
                }
                // Another task follows at once: its waits go on from where this one's ended.
                DrillEvent::Dwell { wait_ticks: 0 } => None,
                DrillEvent::Dwell { wait_ticks } => Some(wait_ticks),
                DrillEvent::Spindle(on) => {
                    board::switch(on.into());
                    None
                }
                // There is no panel.
                DrillEvent::Report(_) | DrillEvent::Idle => None,
            };
            is_idle = event == DrillEvent::Idle;
            if let Some(wait_us) = wait_us {
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

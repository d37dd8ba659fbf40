//! The microfactory's firmware: commands come in by the UART, steps go out by a timer's interrupt, one at a time with the switches as they are.
//!
//! ```text
//! UART interrupt ──bytes──► foreground: Microfactory ──one event──► step interrupt ──► CLOCK, CW/CCW of four L297
//!                               ▲  ▲                              │
//!                  switches ────┘  └──────────── it was made ─────┘
//! ```
//!
//! All that belongs to a board is one file in `board`.
#![no_std]
#![no_main]

mod switches;

use core::iter;

use board::{CriticalSection, Shared, Step, Steps};
use husillo_controllers::{
    Controller, MICROFACTORY_MOTORS, MicrofactoryConfig, MicrofactoryEvent, MicrofactoryStation,
    Timed,
};
use husillo_transports::microfactory::{ByteTable, Device};
use switches::Switches;

/// Moves of a figure that there is room for.
const ROOM: usize = 500;

/// As the simulated one of `husillo` is: a jog ends half a second after it was sent last.
const CONFIG: MicrofactoryConfig = MicrofactoryConfig {
    dead_man_ticks: Some(500_000),
    ..MicrofactoryConfig::ORIGINAL
};

/// A step, and the end of its CLOCK pulse.
static STEPS: Shared<Steps<(), 2>> = Shared::new(Steps::new(()));
/// CW/CCW of the motors, bits 4 to 7; their CLOCKs are bits 0 to 3.
static WAYS: Shared<u8> = Shared::new(0);
/// Outputs: ENABLE of all motors, and their RESET, which acts low.
const ENABLE: u8 = 0b01;
const NOT_RESET: u8 = 0b10;

/// CLOCK is high so long: an L297 wants 0.5 us, and CW/CCW stable for 4 us after it has risen. A
/// Cortex-M0 at 16 MHz takes some microseconds from one interrupt of the timer to the next.
const PULSE_US: u32 = 10;

/// A wait is over: CLOCKs of a step rise, or fall.
#[unsafe(no_mangle)]
fn on_time(section: CriticalSection<'_>) {
    STEPS.within(section, |steps| steps.on_time(section));
}

/// The foreground takes them all: a step that waits is the last one.
#[unsafe(no_mangle)]
fn on_byte(_: u8, _: CriticalSection<'_>) {}

/// Everything else.
#[board::entry]
fn main() -> ! {
    board::start();
    let mut outputs = NOT_RESET;
    board::switch(outputs);
    let link = Device::new(ByteTable::DEFAULT);
    let link = link.acknowledging().storing(ROOM as u16);
    let mut station = MicrofactoryStation::<ROOM>::new(link, CONFIG);
    let mut switches = Switches::new();
    let mut unsent = None;
    // The part of the next wait that the pulse before it took.
    let mut used_us = 0;
    loop {
        while let Some(byte) = board::received() {
            station.receive(byte);
        }
        let mut is_idle = true;
        let are_made = STEPS.are_made();
        if are_made {
            outputs |= NOT_RESET;
            let event = station.next_event(0, &switches.inputs());
            let mut clocks = 0;
            match event {
                Some(MicrofactoryEvent::Step(step)) => {
                    switches.moved(&step.delta);
                    clocks = self::clocks(&step.delta);
                }
                Some(MicrofactoryEvent::Reset { .. }) => outputs &= !NOT_RESET,
                Some(MicrofactoryEvent::Enable(true)) => outputs |= ENABLE,
                Some(MicrofactoryEvent::Enable(false)) => outputs &= !ENABLE,
                // There is no panel.
                _ => {}
            }
            board::switch(outputs);
            is_idle = event.is_none();
            if let Some(wait_us) = event.and_then(|event| event.wait_ticks()) {
                let ways = WAYS.with(|ways| *ways);
                let rise = Step {
                    wait_us: wait_us.saturating_sub(used_us),
                    levels: ways | clocks,
                    delta: (),
                };
                let fall = (clocks != 0).then_some(Step {
                    wait_us: PULSE_US,
                    levels: ways,
                    delta: (),
                });
                push(rise, fall);
                used_us = if fall.is_some() { PULSE_US } else { 0 };
            }
        }
        unsent = unsent.or_else(|| station.transmit());
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

/// Queues both at once: CLOCK may rise at once, and a byte that comes does not make it fall later.
fn push(rise: Step<()>, fall: Option<Step<()>>) {
    board::uninterrupted(|section| {
        STEPS.within(section, |steps| {
            for step in iter::once(rise).chain(fall) {
                steps.push(step, section);
            }
        });
    });
}

/// CLOCKs of a step; its CW/CCW are written now, long before, and after the pulse of the last one.
fn clocks(delta: &[i8; MICROFACTORY_MOTORS]) -> u8 {
    let clocks = delta
        .iter()
        .rev()
        .fold(0, |word, delta| word << 1 | u8::from(*delta != 0));
    let forwards = delta
        .iter()
        .rev()
        .fold(0, |word, delta| word << 1 | u8::from(*delta > 0));
    WAYS.with(|ways| {
        *ways = *ways & !(clocks << 4) | forwards << 4;
        board::write(*ways);
    });
    clocks
}

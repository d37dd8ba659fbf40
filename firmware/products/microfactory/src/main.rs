//! The firmware of the microfactory.
//!
//! The main loop is [`foreground::run`]. It queues one event at a time, because each step depends
//! on the switches at that moment. The step interrupt writes CLOCK and CW/CCW of four L297 chips.
//! Everything that belongs to a board is in one file of `board`.
#![no_std]
#![no_main]

mod switches;

use board::{CriticalSection, Shared, Step};
use foreground::{Interrupts, Product};
use husillo_controllers::{
    MICROFACTORY_MOTORS, MicrofactoryConfig, MicrofactoryEvent, MicrofactoryInputs,
    MicrofactoryStation, Timed,
};
use husillo_transports::microfactory::{ByteTable, Device};
use switches::Switches;

/// The largest number of moves in a figure.
const MOVES: usize = 500;

type Controller = MicrofactoryStation<MOVES>;

/// As in the host's emulation: a jog ends after half a second unless it is repeated.
const CONFIG: MicrofactoryConfig = MicrofactoryConfig {
    dead_man_ticks: Some(500_000),
    ..MicrofactoryConfig::ORIGINAL
};

/// CLOCK of the motors.
const CLOCKS: u8 = 0b1111;

/// Outputs: ENABLE of all motors, and their RESET, which is active low.
const ENABLE: u8 = 0b01;
const NOT_RESET: u8 = 0b10;

/// How long CLOCK is high. An L297 needs 0.5 us, and CW/CCW stable for 4 us after the rise. A
/// Cortex-M0 at 16 MHz takes some microseconds from one interrupt of the timer to the next.
const PULSE_US: u32 = 10;

static INTERRUPTS: Shared<Interrupts<Microfactory, 1, CLOCKS>> = Shared::new(Interrupts::new(()));

/// A wait is over: the CLOCKs of a step rise or fall.
#[unsafe(no_mangle)]
fn on_time(section: CriticalSection<'_>) {
    INTERRUPTS.within(section, |now| now.on_time(section));
}

/// Does nothing: the foreground handles every byte, and meanwhile at most one step is queued.
#[unsafe(no_mangle)]
fn on_byte(_: u8, _: CriticalSection<'_>) {}

/// Starts the main loop.
#[board::entry]
fn main() -> ! {
    INTERRUPTS.with(|now| now.set_pulse_us(PULSE_US));
    board::start();
    board::switch(NOT_RESET);
    let link = Device::new(ByteTable::DEFAULT);
    let link = link.acknowledging().storing(MOVES as u16);
    let mut station = Controller::new(link, CONFIG);
    let mut machine = Microfactory {
        directions: 0,
        outputs: NOT_RESET,
        switches: Switches::new(),
    };
    foreground::run(&mut machine, &mut station, &INTERRUPTS)
}

/// The pins of the microfactory.
struct Microfactory {
    /// CW/CCW of the motors, bits 4 to 7; their CLOCKs are bits 0 to 3.
    directions: u8,
    outputs: u8,
    switches: Switches,
}

impl Product for Microfactory {
    type Controller = Controller;
    type Undo = ();

    fn inputs(&mut self, _: &Controller) -> MicrofactoryInputs {
        self.switches.inputs()
    }

    fn perform(&mut self, event: MicrofactoryEvent) -> Option<Step<()>> {
        let wait_us = event.wait_ticks();
        let mut clocks = 0;
        match event {
            MicrofactoryEvent::Step(step) => {
                self.switches.moved(&step.delta);
                clocks = self.clocks(&step.delta);
            }
            MicrofactoryEvent::Reset { .. } => self.switch(self.outputs & !NOT_RESET),
            MicrofactoryEvent::Enable(true) => self.switch(self.outputs | ENABLE),
            MicrofactoryEvent::Enable(false) => self.switch(self.outputs & !ENABLE),
            // The board has no panel.
            MicrofactoryEvent::Dwell { .. }
            | MicrofactoryEvent::Report(_)
            | MicrofactoryEvent::Idle => {}
        }
        wait_us.map(|wait_us| Step {
            wait_us,
            levels: self.directions | clocks,
            delta: (),
        })
    }

    /// RESET ends when its wait is over.
    fn made(&mut self) {
        self.switch(self.outputs | NOT_RESET);
    }
}

impl Microfactory {
    fn switch(&mut self, outputs: u8) {
        self.outputs = outputs;
        board::switch(outputs);
    }

    /// Returns the CLOCKs of a step, and writes its CW/CCW. This is long before the step, and after
    /// the pulse of the previous step.
    fn clocks(&mut self, delta: &[i8; MICROFACTORY_MOTORS]) -> u8 {
        let bits = |is_set: fn(i8) -> bool| {
            delta
                .iter()
                .rev()
                .fold(0, |word, delta| word << 1 | u8::from(is_set(*delta)))
        };
        let clocks = bits(|delta| delta != 0);
        self.directions = self.directions & !(clocks << 4) | bits(|delta| delta > 0) << 4;
        board::write(self.directions);
        clocks
    }
}

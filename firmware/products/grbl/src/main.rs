//! A Grbl 1.1 controller for mills, lasers and plotters.
//!
//! The main loop is [`foreground::run`]: bytes to `controllers::Grbl`, its events to the pins.
//! It queues one event at a time, because each step depends on the switches at that moment. The
//! step interrupt writes the step pins. Everything that belongs to a board is in one file of
//! `board`.
#![no_std]
#![no_main]

mod memory;
mod pins;
mod switches;

use board::{CriticalSection, Pins, Shared, Step};
use foreground::{Interrupts, Product};
use husillo_controllers::{GrblEvent, GrblInputs, GrblMemory, GrblOptions, Timed};
use memory::Memory;
use pins::{MIST, Outputs, STEPS, motors};
use static_cell::StaticCell;
use switches::Switches;

/// Moves of look-ahead. A move takes 248 bytes of RAM.
const LOOK_AHEAD: usize = 24;

type Grbl = husillo_controllers::Grbl<LOOK_AHEAD>;

/// In a static, because it is larger than the stack.
static CONTROLLER: StaticCell<Grbl> = StaticCell::new();

/// All that senders ask for, with the protocol of this firmware.
#[cfg(not(feature = "grblhal"))]
const PROTOCOL: GrblOptions = GrblOptions::FULL;
#[cfg(feature = "grblhal")]
const PROTOCOL: GrblOptions = GrblOptions::HAL;

/// The inputs are read also while nothing moves.
const OPTIONS: GrblOptions = GrblOptions {
    reads_inputs: board::HAS_SWITCHES,
    ..PROTOCOL
};

static INTERRUPTS: Shared<Interrupts<Machine, 1, STEPS>> = Shared::new(Interrupts::new(()));

/// A wait is over: the step pins rise or fall.
#[unsafe(no_mangle)]
fn on_time(section: CriticalSection<'_>) {
    INTERRUPTS.within(section, |now| now.on_time(section));
}

/// A reset holds the motors at once, because the foreground may be busy for the time of some steps.
#[unsafe(no_mangle)]
fn on_byte(byte: u8, section: CriticalSection<'_>) {
    INTERRUPTS.within(section, |now| now.on_byte(byte));
}

/// Starts the main loop.
#[board::entry]
fn main() -> ! {
    board::start();
    board::baud(115_200);
    let mut memory = Memory::open();
    // A flash that was never written is a new machine.
    let kept = memory.read().unwrap_or(GrblMemory::FACTORY);
    let Some(controller) = CONTROLLER.try_init_with(|| Grbl::new(OPTIONS, Some(&kept))) else {
        // Never reached: it is made only here.
        loop {
            core::hint::spin_loop();
        }
    };
    let mut machine = Machine {
        memory,
        must_store: false,
        levels: 0,
        outputs: Outputs::default(),
        switches: Switches::new(),
    };
    machine.set_pulses(controller);
    foreground::run(&mut machine, controller, &INTERRUPTS)
}

/// The pins of the machine, and its flash.
struct Machine {
    memory: Memory,
    must_store: bool,
    /// Levels of the motors' pins without the steps.
    levels: Pins,
    outputs: Outputs,
    switches: Switches,
}

impl Product for Machine {
    type Controller = Grbl;
    type Undo = ();

    fn inputs(&mut self, grbl: &Grbl) -> GrblInputs {
        self.switches.inputs(grbl)
    }

    fn perform(&mut self, event: GrblEvent) -> Option<Step<()>> {
        let mut steps = 0;
        match event {
            GrblEvent::Step { delta, .. } => {
                self.switches.moves(delta);
                steps = self.begin(delta);
            }
            GrblEvent::Store => self.must_store = true,
            GrblEvent::Mist { is_on } => {
                self.levels = self.levels & !MIST | if is_on { MIST } else { 0 };
                self.write();
            }
            GrblEvent::Wait { .. } => {}
            output => self.outputs.switch(output),
        }
        event.wait_ticks().map(|wait_us| Step {
            wait_us,
            levels: self.levels | steps,
            delta: (),
        })
    }

    /// Keeps what has changed, before the line is answered.
    fn performed(&mut self, grbl: &Grbl) {
        if core::mem::take(&mut self.must_store) {
            self.memory.write(grbl.memory());
            self.set_pulses(grbl);
        }
    }

    fn made(&mut self) {
        self.switches.moved();
    }

    fn undo(&mut self, (): ()) {
        self.switches.dropped();
    }
}

impl Machine {
    /// Writes the directions of a step and returns its step pins. This is after the pulse of the
    /// previous step, and some microseconds before this one.
    fn begin(&mut self, delta: [i8; 3]) -> Pins {
        let (steps, levels) = motors(delta, self.levels);
        self.levels = levels;
        self.write();
        steps
    }

    /// Writes the pins between two steps.
    fn write(&self) {
        board::write(self.levels ^ INTERRUPTS.with(|now| now.inverted()));
    }

    /// Takes the time of a pulse, `$0`, and the inverted step pins, `$2`, into use.
    fn set_pulses(&mut self, grbl: &Grbl) {
        let settings = grbl.memory().settings();
        let mask = settings.whole(2) as Pins & STEPS;
        INTERRUPTS.with(|now| {
            now.set_pulse_us(settings.whole(0));
            now.invert(mask);
        });
        self.write();
    }
}

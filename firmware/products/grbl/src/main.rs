//! A Grbl 1.1 controller for mills, lasers and plotters.
//!
//! The main loop is [`foreground::run`]: bytes to `controllers::Grbl`, its events to the pins.
//! It queues one event at a time, because each step depends on the switches at that moment. The
//! step interrupt writes the pins of the motors. Everything that belongs to a board is in one file
//! of `board`.
#![no_std]
#![no_main]

#[cfg(feature = "coils")]
mod coils;
#[cfg(feature = "tmc2209")]
mod drivers;
mod memory;
mod outputs;
#[cfg(not(feature = "coils"))]
mod step_direction;
mod switches;

use board::{CriticalSection, Pins, Shared, Step};
#[cfg(feature = "coils")]
use coils::{MIST, Motors, STEPS};
use foreground::{Interrupts, Product};
use husillo_controllers::{GrblEvent, GrblInputs, GrblMemory, GrblOptions, Timed};
use memory::Memory;
use outputs::Outputs;
use static_cell::StaticCell;
#[cfg(not(feature = "coils"))]
use step_direction::{MIST, Motors, STEPS};
use switches::Switches;

/// Moves of look-ahead. A move takes 264 bytes of RAM.
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

static INTERRUPTS: Shared<Interrupts<Machine, 1, STEPS>> = Shared::new(Interrupts::new([0; 3]));

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
        motors: Motors::new(),
        mist: 0,
        is_disable_high: false,
        must_set: false,
        outputs: Outputs::default(),
        switches: Switches::new(),
    };
    machine.set_pins(controller);
    #[cfg(feature = "tmc2209")]
    drivers::write(controller.memory());
    foreground::run(&mut machine, controller, &INTERRUPTS)
}

/// The pins of the machine, and its flash.
struct Machine {
    memory: Memory,
    must_store: bool,
    motors: Motors,
    /// The pin of mist coolant, if it is high.
    mist: Pins,
    /// The level of the output that switches the motors off, `$4` included.
    is_disable_high: bool,
    must_set: bool,
    outputs: Outputs,
    switches: Switches,
}

impl Product for Machine {
    type Controller = Grbl;
    type Undo = [i8; 3];

    fn inputs(&mut self, grbl: &Grbl) -> GrblInputs {
        self.switches.inputs(grbl)
    }

    fn perform(&mut self, event: GrblEvent) -> Option<Step<[i8; 3]>> {
        let (mut levels, mut delta) = (self.motors.levels(), [0; 3]);
        match event {
            GrblEvent::Step { delta: step, .. } => {
                delta = step;
                self.switches.moves(delta);
                let [before, at_step] = self.motors.step(delta);
                // After the pulse of the previous step, and some microseconds before this one.
                self.write(before);
                levels = at_step;
            }
            GrblEvent::Store => self.must_store = true,
            GrblEvent::Mist { is_on } => {
                self.mist = if is_on { MIST } else { 0 };
                self.write(levels);
            }
            GrblEvent::Disable { is_high } => {
                self.outputs.switch(event);
                self.is_disable_high = is_high;
                self.must_set = true;
            }
            GrblEvent::Wait { .. } => {}
            output => self.outputs.switch(output),
        }
        event.wait_ticks().map(|wait_us| Step {
            wait_us,
            levels: levels | self.mist,
            delta,
        })
    }

    /// Keeps what has changed, before the line is answered.
    fn performed(&mut self, grbl: &Grbl) {
        if core::mem::take(&mut self.must_store) {
            self.memory.write(grbl.memory());
            #[cfg(feature = "tmc2209")]
            drivers::write(grbl.memory());
            self.must_set = true;
        }
        if core::mem::take(&mut self.must_set) {
            self.set_pins(grbl);
        }
    }

    fn made(&mut self) {
        self.switches.moved();
    }

    fn undo(&mut self, delta: [i8; 3]) {
        self.motors.undo(delta);
        self.switches.dropped();
    }
}

impl Machine {
    /// Writes the pins between two steps.
    fn write(&self, levels: Pins) {
        board::write((levels | self.mist) ^ INTERRUPTS.with(|now| now.inverted()));
    }

    /// Takes what the pins need into use: the time of a pulse, `$0`, inverted step pins, `$2`, and
    /// whether the motors are on.
    fn set_pins(&mut self, grbl: &Grbl) {
        let settings = grbl.memory().settings();
        let mask = settings.whole(2) as Pins & STEPS;
        INTERRUPTS.with(|now| {
            now.set_pulse_us(settings.whole(0));
            now.invert(mask);
        });
        self.motors
            .set_enabled(self.is_disable_high == settings.is_set(4));
        self.write(self.motors.levels());
    }
}

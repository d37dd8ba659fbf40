//! The firmware of the circuit-board drill.
//!
//! The main loop is [`foreground::run`]. It queues one event at a time, because each step depends
//! on the switches at that moment. Everything that belongs to a board is in one file of `board`.
#![no_std]
#![no_main]

mod lights;
mod switches;

use board::{CriticalSection, Shared, Step};
use foreground::{Interrupts, Product};
use husillo_controllers::{DrillConfig, DrillEvent, DrillInputs, Timed};
use husillo_stepper::{Driver, Idle, Levels, Mode, Motors, Sequencer};
use husillo_transports::drill::MEMORY_BYTES;
use lights::Lights;
use static_cell::ConstStaticCell;
use switches::Switches;

type Controller = husillo_controllers::Drill<MEMORY_BYTES>;

/// In a static, because the stack has no room to build it.
static CONTROLLER: ConstStaticCell<Controller> = ConstStaticCell::new(Controller::new(CONFIG));

const CONFIG: DrillConfig = DrillConfig {
    blinks: cfg!(feature = "lights"),
    ..if cfg!(feature = "faithful") {
        DrillConfig::ORIGINAL
    } else {
        DrillConfig::FIXED
    }
};

static INTERRUPTS: Shared<Interrupts<Drill, 1>> = Shared::new(Interrupts::new(()));

/// The wait of a step is over.
#[unsafe(no_mangle)]
fn on_time(section: CriticalSection<'_>) {
    INTERRUPTS.within(section, |now| now.on_time(section));
}

/// Does nothing, because no byte stops this machine. Its button R stops it, the reset of the chip,
/// and with a lease the silence of the host, which the main loop notices.
#[unsafe(no_mangle)]
fn on_byte(_: u8, _: CriticalSection<'_>) {}

/// Starts the main loop.
#[board::entry]
fn main() -> ! {
    board::start();
    let motor = Sequencer::new(Driver::Unipolar, Mode::Full);
    let (Ok(motor), Some(controller)) = (motor, CONTROLLER.try_take()) else {
        // Never reached: this driver has that mode, and the controller is taken only here.
        loop {
            core::hint::spin_loop();
        }
    };
    let motors = Motors::new([motor; 3], Idle::Hold);
    let levels = pins(motors.levels());
    board::write(levels);
    let mut drill = Drill {
        motors,
        levels,
        switches: Switches::new(),
        lights: Lights::new(),
    };
    foreground::run(&mut drill, controller, &INTERRUPTS)
}

/// The pins of the drill.
struct Drill {
    motors: Motors<3, Sequencer>,
    /// The levels of the motors' pins.
    levels: u8,
    switches: Switches,
    lights: Lights,
}

impl Product for Drill {
    type Controller = Controller;
    type Undo = ();

    fn inputs(&mut self, drill: &Controller) -> DrillInputs {
        if cfg!(feature = "lights") {
            self.lights.show(drill.lights(), drill.heartbeat());
        }
        self.switches.inputs()
    }

    fn perform(&mut self, event: DrillEvent) -> Option<Step<()>> {
        let wait_us = event.wait_ticks();
        match event {
            DrillEvent::Step(step) => {
                self.switches.moved(&step.delta);
                let levels = &mut self.levels;
                self.motors
                    .step(step.wait_ticks, &step.delta, |_, all| *levels = pins(all));
            }
            DrillEvent::Spindle(on) => self.lights.switch_spindle(on),
            // The lamps show the rest.
            DrillEvent::Dwell { .. } | DrillEvent::Report(_) | DrillEvent::Idle => {}
        }
        wait_us.map(|wait_us| Step {
            wait_us,
            levels: self.levels,
            delta: (),
        })
    }
}

/// Two of the four wires of each motor, from bit 0. Two phases are always on, so inverters drive
/// the other two wires.
fn pins(levels: &[Levels; 3]) -> u8 {
    levels
        .iter()
        .rev()
        .fold(0, |word, levels| word << 2 | levels.0 & 0b11)
}

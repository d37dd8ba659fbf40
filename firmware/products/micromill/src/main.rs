//! The firmware of the micro mill.
//!
//! The main loop is [`foreground::run`]. It fills a queue of events, because the controller plans
//! ahead. Everything that belongs to a board is in one file of `board`.
#![no_std]
#![no_main]

#[cfg(feature = "coils")]
mod coils;
#[cfg(not(feature = "coils"))]
mod motors;

use board::{CriticalSection, Shared, Step};
#[cfg(feature = "coils")]
use coils::Motors;
use foreground::{Interrupts, Product};
use husillo_controllers::{MicromillEvent, MicromillInputs};
use husillo_gcode::SpindleDirection;
#[cfg(not(feature = "coils"))]
use motors::Motors;

/// Slots of the queue of events.
const AHEAD: usize = 16;

type Controller = husillo_controllers::Micromill<'static, 16, AHEAD, 80>;

static INTERRUPTS: Shared<Interrupts<Micromill, AHEAD>> = Shared::new(Interrupts::new([0; 2]));

/// The wait of a step is over.
#[unsafe(no_mangle)]
fn on_time(section: CriticalSection<'_>) {
    INTERRUPTS.within(section, |now| now.on_time(section));
}

/// A stopping byte acts at once, because the foreground may be busy for the time of some steps.
#[unsafe(no_mangle)]
fn on_byte(byte: u8, section: CriticalSection<'_>) {
    INTERRUPTS.within(section, |now| now.on_byte(byte));
}

/// Starts the main loop.
#[board::entry]
fn main() -> ! {
    board::start();
    let mut mill = Micromill {
        motors: Motors::at_start(),
    };
    board::write(mill.motors.step([0; 2]));
    let mut controller = Controller::new(mill.motors.machine());
    foreground::run(&mut mill, &mut controller, &INTERRUPTS)
}

/// The pins of the mill.
struct Micromill {
    motors: Motors,
}

impl Product for Micromill {
    type Controller = Controller;
    /// The masks of a step: its axes, and those that step backwards.
    type Undo = [u8; 2];

    /// Reads the home switches. Without the feature `switches` of `board`, each closes 400 steps
    /// below the position at power-on. Once the machine is homed, that is outside the travel, so
    /// all are open.
    #[inline]
    fn inputs(&mut self, controller: &Controller) -> MicromillInputs {
        let simulated = if controller.is_homed() {
            0
        } else {
            let closed = controller
                .position_steps()
                .map(|steps| u8::from(steps <= -400));
            let [x, y, z] = closed;
            x | y << 1 | z << 2
        };
        MicromillInputs {
            home: board::inputs(simulated),
        }
    }

    #[inline(always)]
    fn perform(&mut self, event: MicromillEvent) -> Option<Step<[u8; 2]>> {
        match event {
            MicromillEvent::Step(step) => {
                let masks = [step.axes, step.negative];
                return Some(Step {
                    wait_us: step.wait_ticks,
                    levels: self.motors.step(masks),
                    delta: masks,
                });
            }
            // The speed of the spindle is set by hand.
            MicromillEvent::Spindle { direction, .. } => board::switch(spindle(direction)),
            // The host asks the operator for the tool and waits.
            MicromillEvent::Tool { .. } => {}
        }
        None
    }

    /// Returns the motors to the phases before a dropped step.
    fn undo(&mut self, [axes, negative]: [u8; 2]) {
        self.motors.step([axes, axes & !negative]);
    }
}

/// The outputs of the spindle: bit 0 for forwards, bit 1 for backwards.
fn spindle(direction: SpindleDirection) -> u8 {
    match direction {
        SpindleDirection::Off => 0b00,
        SpindleDirection::Clockwise => 0b01,
        SpindleDirection::CounterClockwise => 0b10,
    }
}

//! The firmware of a servo module. The UART connects it to the network, and the interrupt of a
//! timer runs the axis.
//!
//! ```text
//! UART interrupt ──bytes──► ┌─────────────┐ ──► UART, driver enable: foreground
//!                           │ ServoModule │
//! timer, each 512 us ─────► └─────────────┘ ──► PWM, direction, amplifier
//!  encoder, probe, index
//! ```
//!
//! Everything that belongs to a board is in one file of `board`.
#![no_std]
#![no_main]

mod plant;
mod servo;

use board::{CriticalSection, Shared};
use foreground::Transmitter;
use servo::Servo;

/// The servo period of the original chip.
const PERIOD_US: u32 = 512;

static SERVO: Shared<Option<Servo>> = Shared::new(None);

/// Accesses the servo. Before it exists, this returns the default value.
fn with_servo<R: Default>(work: impl FnOnce(&mut Servo) -> R) -> R {
    SERVO.with(|servo| servo.as_mut().map(work).unwrap_or_default())
}

/// The servo period is over.
#[unsafe(no_mangle)]
fn on_time(section: CriticalSection<'_>) {
    board::wait(PERIOD_US, section);
    with_servo(Servo::tick);
}

/// The module takes a byte at once, because a received byte ends its reply.
#[unsafe(no_mangle)]
fn on_byte(byte: u8, _: CriticalSection<'_>) {
    with_servo(|servo| servo.hear(byte));
}

/// Sends the replies. The servo runs in the interrupt, so its period does not vary.
#[board::entry]
fn main() -> ! {
    board::start();
    board::baud(19_200);
    SERVO.with(|servo| *servo = Some(Servo::new()));
    board::uninterrupted(|section| board::wait(PERIOD_US, section));
    let (mut transmitter, mut is_driven) = (Transmitter::new(), false);
    loop {
        while board::received().is_some() {
            transmitter.clear();
        }
        if transmitter.send(|| with_servo(Servo::speak)) {
            is_driven = true;
        } else if !is_driven {
            board::sleep(|_| !with_servo(|servo| servo.has_reply()));
        } else if board::is_sent() {
            // The last stop bit has been sent.
            with_servo(Servo::be_silent);
            is_driven = false;
        }
    }
}

//! The firmware of a servo module: the network by the UART, the axis by a timer's interrupt.
//!
//! ```text
//! UART interrupt ──bytes──► ┌─────────────┐ ──► UART, driver enable: foreground
//!                           │ ServoModule │
//! timer, each 512 us ─────► └─────────────┘ ──► PWM, direction, amplifier
//!  encoder, probe, index
//! ```
//!
//! All that belongs to a board is one file in `board`.
#![no_std]
#![no_main]

mod plant;
mod servo;

use board::{CriticalSection, Shared};
use servo::Servo;

/// A servo period, that of the original's chip.
const PERIOD_US: u32 = 512;

static SERVO: Shared<Option<Servo>> = Shared::new(None);

/// What `work` gives, once there is a servo.
fn with_servo<R: Default>(work: impl FnOnce(&mut Servo) -> R) -> R {
    SERVO.with(|servo| servo.as_mut().map(work).unwrap_or_default())
}

/// The servo period is over.
#[unsafe(no_mangle)]
fn on_time(section: CriticalSection<'_>) {
    board::wait(PERIOD_US, section);
    with_servo(Servo::tick);
}

/// At once: who hears a byte stops talking.
#[unsafe(no_mangle)]
fn on_byte(byte: u8, _: CriticalSection<'_>) {
    with_servo(|servo| servo.hear(byte));
}

/// Replies.
#[board::entry]
fn main() -> ! {
    board::start();
    board::baud(19_200);
    SERVO.with(|servo| *servo = Some(Servo::new()));
    board::uninterrupted(|section| board::wait(PERIOD_US, section));
    let (mut unsent, mut is_driven) = (None, false);
    loop {
        while board::received().is_some() {
            unsent = None;
        }
        unsent = unsent.or_else(|| with_servo(Servo::speak));
        match unsent {
            Some(byte) => {
                is_driven = true;
                if board::send(byte) {
                    unsent = None;
                }
            }
            None if is_driven => {
                // The last stop bit is out.
                if board::is_sent() {
                    with_servo(Servo::be_silent);
                    is_driven = false;
                }
            }
            None => board::sleep(|_| !with_servo(|servo| servo.has_reply())),
        }
    }
}

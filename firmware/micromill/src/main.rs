//! The micro mill's firmware: strings come in by the UART, step events go out by a timer's interrupt.
//!
//! ```text
//! UART interrupt ──bytes──► foreground: Mill ──events──► queue ──► step interrupt ──► pins
//!                               ◄──────────── how many were made ────────┘
//! ```
//!
//! All that belongs to a board is one file in `board/`: copy one, change it, name it below. Its lines with `//:` are the memory map.
#![no_std]
#![no_main]

#[cfg_attr(target_arch = "riscv32", path = "board/virt.rs")]
#[cfg_attr(
    all(target_arch = "arm", target_abi = "eabihf"),
    path = "board/mps2.rs"
)]
#[cfg_attr(
    all(target_arch = "arm", not(target_abi = "eabihf")),
    path = "board/microbit.rs"
)]
mod board;
mod shared;

use heapless::spsc::Queue;
use husillo_machine::{Idle, Mill, MillConfig, MillEvent, MillInputs, Motors, StepEvent};
use husillo_stepper::{Driver, Levels, Mode, Sequencer};
use shared::Shared;

/// The machine: another one is another constant.
static CONFIG: MillConfig = MillConfig::MICROMILL;

/// Events that may wait for their time, and one place that the queue keeps free.
const AHEAD: usize = 8;
const PLACES: usize = AHEAD + 1;

/// A step that waits for its time.
#[derive(Clone, Copy)]
struct Entry {
    wait_ticks: u32,
    delta: [i8; 3],
    /// PH of both phases of X, Y and Z, from bit 0.
    levels: u8,
}

/// Between the foreground and the step interrupt.
struct Steps {
    queue: Queue<Entry, PLACES>,
    /// Its wait runs.
    due: Option<Entry>,
    /// Steps made, wrapping.
    made: u8,
}

static STEPS: Shared<Steps> = Shared::new(Steps {
    queue: Queue::new(),
    due: None,
    made: 0,
});
/// Bytes of the line. A host has a few of them on the way at a time.
static HEARD: Shared<Queue<u8, 32>> = Shared::new(Queue::new());

/// The step interrupt: the wait of an entry is over.
pub fn on_time() {
    STEPS.with(|steps| {
        if let Some(entry) = steps.due.take() {
            board::write(entry.levels);
            steps.made = steps.made.wrapping_add(1);
        }
        steps.next();
    });
}

impl Steps {
    /// Begins the wait of the next entry.
    fn next(&mut self) {
        self.due = self.queue.dequeue();
        if let Some(entry) = &self.due {
            board::wait(entry.wait_ticks);
        }
    }
}

/// The UART's interrupt: a byte has come.
pub fn on_byte(byte: u8) {
    // Without room it is lost, and its echo with it.
    HEARD.with(|heard| heard.enqueue(byte).ok());
}

/// Everything else.
#[cfg_attr(target_arch = "arm", cortex_m_rt::entry)]
#[cfg_attr(target_arch = "riscv32", riscv_rt::entry)]
fn main() -> ! {
    board::start();
    let Ok(motor) = Sequencer::new(Driver::Pbl3717a, Mode::Full) else {
        // This driver has that mode.
        loop {
            core::hint::spin_loop();
        }
    };
    let mut motors = Motors::new([motor; 3], Idle::Hold);
    board::write(phases(motors.levels()));
    let mut mill = Mill::new(&CONFIG);
    run(&mut mill, &mut motors)
}

/// What `main` keeps on the stack while this runs is only its arguments.
#[inline(never)]
fn run(mill: &mut Mill<'_, 16, AHEAD, 64>, motors: &mut Motors<3, Sequencer>) -> ! {
    let mut told = 0_u8;
    let mut unsent = None;
    loop {
        let mut is_idle = true;
        let made = STEPS.with(|steps| steps.made);
        while told != made {
            mill.made();
            told = told.wrapping_add(1);
        }
        while let Some(byte) = HEARD.with(|heard| heard.dequeue()) {
            if mill.receive(byte) {
                halt(mill, motors, &mut told);
            }
            is_idle = false;
        }
        let inputs = MillInputs {
            home: board::home(mill.position_steps()),
        };
        match mill.next_event(&inputs) {
            Some(MillEvent::Step(step)) => {
                push(&step, motors);
                is_idle = false;
            }
            Some(MillEvent::Spindle { direction, rpm }) => {
                board::spindle(direction, rpm);
                is_idle = false;
            }
            // The operator changes it: the host asks for it and waits.
            Some(MillEvent::Tool { .. }) => is_idle = false,
            None => {}
        }
        // Behind the events: a line that ends without one is told too before it sleeps.
        unsent = unsent.or_else(|| mill.transmit());
        if let Some(byte) = unsent {
            if board::send(byte) {
                unsent = None;
            }
            is_idle = false;
        }
        if is_idle {
            board::sleep(|| {
                HEARD.with(|heard| heard.is_empty()) && STEPS.with(|steps| steps.made == told)
            });
        }
    }
}

/// Queues a step; where none waits its wait begins now.
fn push(step: &StepEvent<3>, motors: &mut Motors<3, Sequencer>) {
    let entry = Entry {
        wait_ticks: step.wait_ticks,
        delta: step.delta,
        levels: phases(motors.step(&step.delta)),
    };
    STEPS.with(|steps| {
        // `Mill` gives no more than the queue holds.
        let _ = steps.queue.enqueue(entry);
        if steps.due.is_none() {
            steps.next();
        }
    });
}

/// Stops: what has not been made will not be, and the motors' phases are those of what has.
fn halt(mill: &mut Mill<'_, 16, AHEAD, 64>, motors: &mut Motors<3, Sequencer>, told: &mut u8) {
    let made = STEPS.with(|steps| {
        board::stop();
        let due = steps.due.take();
        let mut dropped = due
            .into_iter()
            .chain(core::iter::from_fn(|| steps.queue.dequeue()));
        dropped.by_ref().for_each(|entry| {
            motors.step(&entry.delta.map(i8::wrapping_neg));
        });
        steps.made
    });
    while *told != made {
        mill.made();
        *told = told.wrapping_add(1);
    }
    mill.halted();
}

/// The levels of PH: in full steps both I0 and I1 stay low.
fn phases(levels: &[Levels; 3]) -> u8 {
    levels.iter().rev().fold(0, |word, levels| {
        word << 2 | (levels.0 & 1) | (levels.0 >> 2 & 2)
    })
}

/// There is no panic: whatever could, does not link.
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    unsafe extern "C" {
        fn a_panic_is_left_in_the_firmware() -> !;
    }
    // Safety: nobody defines this function, so no program that contains this call links.
    unsafe { a_panic_is_left_in_the_firmware() }
}

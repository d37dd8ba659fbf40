//! The main loop of every firmware whose motors step.
//!
//! ```text
//! UART interrupt ──bytes──► foreground: Controller ──events──► queue ──► step interrupt ──► pins
//!                               ▲  ▲                                          │
//!               Product::inputs ┘  └──────────── how many were made ──────────┘
//! ```
//!
//! A firmware implements [`Product`] for the pins of its machine, keeps its [`Interrupts`] in a
//! static, and calls [`run`].
#![no_std]

mod interrupts;
mod transmitter;

pub use interrupts::Interrupts;
pub use transmitter::Transmitter;

use board::{Pins, Shared, Step};
use husillo_controllers::Controller;

/// The pins of a machine, and the state of its motors.
pub trait Product {
    /// The controller of the machine.
    type Controller: Controller;
    /// The data with which a dropped event is undone.
    type Undo: Copy;

    /// Reads the switches and sensors.
    fn inputs(&mut self, controller: &Self::Controller)
    -> <Self::Controller as Controller>::Inputs;

    /// Performs an event. Its outputs are switched at once. If the event has a wait, returns it as
    /// a step for the queue. The levels of that step are written when the wait is over.
    fn perform(
        &mut self,
        event: <Self::Controller as Controller>::Event,
    ) -> Option<Step<Self::Undo>>;

    /// Called after each performed event, before the controller gives the next one or a byte.
    fn performed(&mut self, controller: &Self::Controller) {
        let _ = controller;
    }

    /// Called after events with a wait have been made.
    fn made(&mut self) {}

    /// Undoes an event that was dropped from the queue. The last event is undone first.
    fn undo(&mut self, dropped: Self::Undo) {
        let _ = dropped;
    }
}

/// Runs the controller of one machine. Never returns.
///
/// A controller that does not plan ahead needs a queue of one slot. It gets the present state of
/// the switches, and is asked for an event after the previous one was made.
#[inline(never)]
pub fn run<P: Product, const PLACES: usize, const PULSED: Pins>(
    product: &mut P,
    controller: &mut P::Controller,
    interrupts: &Shared<Interrupts<P, PLACES, PULSED>>,
) -> ! {
    const { assert!(P::Controller::AHEAD <= PLACES, "events wait in the queue") };
    let mut reported = 0_u8;
    let mut transmitter = Transmitter::new();
    let mut heard = board::clock();
    loop {
        let made = interrupts.with(|now| now.steps.made());
        report(product, controller, &mut reported, made);
        loop {
            let must_halt = match board::received() {
                Some(byte) => {
                    heard = board::clock();
                    controller.receive(byte)
                }
                None if is_over(controller, heard) => controller.expire(),
                None => break,
            };
            if must_halt {
                halt(product, controller, &mut reported, interrupts);
            }
        }
        let mut has_room = board::uninterrupted(|section| {
            interrupts.within(section, |now| {
                now.stops = controller.stops();
                // The controller has received the bytes that held the steps. None of them stopped
                // it.
                if !board::has_heard() {
                    now.steps.release(section);
                }
                now.steps.has_room()
            })
        });
        let plans_ahead = const { P::Controller::AHEAD > 1 };
        // A controller that does not plan ahead makes the next step before bytes are sent, because
        // the step may be due soon. With queued steps, bytes are sent first. This makes room for
        // the reports of further steps.
        if plans_ahead {
            transmitter.send(|| controller.transmit());
        }
        let inputs = product.inputs(controller);
        // A controller that plans ahead counts its events itself, so the loop does not ask the
        // queue for room.
        while (plans_ahead || has_room)
            && let Some(event) = controller.next_event(0, &inputs)
        {
            if let Some(step) = product.perform(event) {
                has_room = push(interrupts, step);
            }
            product.performed(controller);
        }
        let is_silent = if plans_ahead {
            transmitter.is_empty_after(|| controller.transmit())
        } else {
            !transmitter.send(|| controller.transmit())
        };
        if is_silent && !controller.has_event() {
            // Handling several made events costs as much as handling one.
            let together = if controller.reports_next() {
                1
            } else {
                PLACES as u8 / 2
            };
            board::sleep(|section| {
                interrupts.within(section, |now| {
                    let new = now.steps.made().wrapping_sub(reported);
                    new == 0 || new < together && !now.steps.is_empty()
                })
            });
        }
    }
}

/// Whether the line has been silent for longer than the lease of the motion. `heard` is the time of
/// the last byte.
#[inline]
fn is_over(controller: &impl Controller, heard: u32) -> bool {
    let silence = board::clock().wrapping_sub(heard);
    // A lease is ten seconds at most, and the counter wraps after a longer time.
    let clocks = |us: u32| us.wrapping_mul(board::CLOCKS_PER_US);
    controller.lease_us().is_some_and(|us| silence > clocks(us))
}

/// Reports to the controller how many events were made.
fn report<P: Product>(
    product: &mut P,
    controller: &mut P::Controller,
    reported: &mut u8,
    made: u8,
) {
    let new = made.wrapping_sub(*reported);
    controller.made(0, new.into());
    if new > 0 {
        product.made();
    }
    *reported = made;
}

/// Queues an event. There must be room for it. Returns whether there is room for another one.
#[inline(always)]
fn push<P: Product, const PLACES: usize, const PULSED: Pins>(
    interrupts: &Shared<Interrupts<P, PLACES, PULSED>>,
    step: Step<P::Undo>,
) -> bool {
    board::uninterrupted(|section| {
        interrupts.within(section, |now| {
            now.steps.push(step, section);
            now.steps.has_room()
        })
    })
}

/// Stops the motors, and drops and undoes the queued events.
fn halt<P: Product, const PLACES: usize, const PULSED: Pins>(
    product: &mut P,
    controller: &mut P::Controller,
    reported: &mut u8,
    interrupts: &Shared<Interrupts<P, PLACES, PULSED>>,
) {
    // The step of a pulse that has begun is made.
    while interrupts.with(|now| now.steps.is_pulsing()) {}
    let made = interrupts.with(|now| {
        now.steps.stop().for_each(|step| product.undo(step.delta));
        now.steps.made()
    });
    report(product, controller, reported, made);
    controller.halted();
}

//! A line with servo modules behind a serial port.

use crate::clock::Clock;
use embedded_hal::delay::DelayNs;
use embedded_io::{ErrorType, Read, ReadReady, Write};
use husillo_transports::nmc::{CYCLE_US, Command, Items, Mode, Module, Order, Readings, Status};
use std::collections::VecDeque;
use std::convert::Infallible;

/// Modules of version 4, the first one next to the host. Their motors reach each goal at once.
///
/// A byte takes 100 us at any rate.
#[derive(Debug)]
pub struct ModuleLine {
    modules: Vec<(Module, Servo)>,
    replies: VecDeque<u8>,
    clock: Clock,
    next_cycle_us: u32,
}

#[derive(Clone, Copy, Debug, Default)]
struct Servo {
    position: i32,
    goal: i32,
}

impl ModuleLine {
    /// A line of modules after power-up.
    pub fn new(modules: usize, clock: Clock) -> Self {
        let modules = (0..modules)
            .map(|_| (Module::new(4), Servo::default()))
            .collect();
        ModuleLine {
            modules,
            replies: VecDeque::new(),
            clock,
            next_cycle_us: CYCLE_US,
        }
    }

    /// Ends the servo cycles that are due: each module carries out its order and replies.
    fn run(&mut self) {
        if self.clock.us() < self.next_cycle_us {
            return;
        }
        self.next_cycle_us = self.clock.us() + CYCLE_US;
        let mut is_enabled = true;
        for (module, servo) in &mut self.modules {
            module.set_enabled(is_enabled);
            match module.take() {
                Some(Order::Servo(Command::LoadTrajectory(load))) => {
                    servo.goal = load.position.unwrap_or(servo.goal);
                    if load.start_now && load.mode == Mode::Trapezoid {
                        servo.position = servo.goal;
                    }
                }
                Some(Order::Servo(Command::StartMotion)) => servo.position = servo.goal,
                Some(Order::Reset(_)) => *servo = Servo::default(),
                _ => {}
            }
            let readings = Readings {
                position: servo.position,
                ..Readings::default()
            };
            module.reply(Status(Status::MOVE_DONE.0 | Status::POWER_ON.0), &readings);
            self.replies
                .extend(std::iter::from_fn(|| module.transmit()));
            is_enabled = module.enables_next();
        }
    }

    /// The items of every reply of a module.
    pub fn items(&self, module: usize) -> Items {
        self.modules[module].0.items()
    }
}

impl ErrorType for ModuleLine {
    type Error = Infallible;
}

impl ReadReady for ModuleLine {
    fn read_ready(&mut self) -> Result<bool, Infallible> {
        self.run();
        Ok(!self.replies.is_empty())
    }
}

impl Read for ModuleLine {
    fn read(&mut self, bytes: &mut [u8]) -> Result<usize, Infallible> {
        let length = bytes.len().min(self.replies.len());
        bytes
            .iter_mut()
            .zip(self.replies.drain(..length))
            .for_each(|(to, from)| *to = from);
        self.clock.delay_us(100 * length as u32);
        Ok(length)
    }
}

impl Write for ModuleLine {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, Infallible> {
        for byte in bytes {
            self.modules
                .iter_mut()
                .for_each(|(module, _)| module.push(*byte));
            self.clock.delay_us(100);
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
}

//! A controller on a port: orders, one after the other, and what it tells meanwhile.

use crate::cmm::Port;
use husillo_transports::micromill::{Host, HostTiming, Order, Outcome, Progress, Report};
use std::collections::VecDeque;

/// The longest wait for a byte before the machine is asked how far it is, us.
const TURN_US: u32 = 100_000;

/// The host's end of the line, and what has come.
pub struct Session {
    port: Port,
    host: Host,
    waiting: VecDeque<u8>,
    /// Each step told: axis, and whether forward.
    pub steps: Vec<(u8, bool)>,
    /// Streamed lines that were made.
    pub lines: usize,
}

impl Session {
    /// A controller in any state: [`Order::Stop`] is a good beginning.
    pub fn new(port: Port, bits_per_s: u32) -> Self {
        Self {
            port,
            host: Host::new(HostTiming::of(bits_per_s)),
            waiting: VecDeque::new(),
            steps: Vec::new(),
            lines: 0,
        }
    }

    /// Begins to send an order; `false`: not now.
    pub fn start(&mut self, order: Order) -> bool {
        let now = self.now();
        self.host.start(order, now)
    }

    /// Sends an order and waits for its answer.
    ///
    /// # Errors
    ///
    /// A sentence about why it was not obeyed, beginning with `name`, or about the port.
    pub fn order(&mut self, order: Order, name: &str) -> Result<(), String> {
        if !self.start(order) {
            return Err(format!("{name}: the string before it has not ended"));
        }
        loop {
            match self.turn(TURN_US)? {
                None => {}
                Some(Outcome::Done) => return Ok(()),
                Some(outcome) => return Err(format!("{name}: {}", why(outcome))),
            }
        }
    }

    /// Waits until all streamed lines are made.
    ///
    /// # Errors
    ///
    /// The port.
    pub fn finish(&mut self) -> Result<(), String> {
        while self.host.lines() > 0 {
            self.turn(TURN_US)?;
        }
        Ok(())
    }

    /// Sends what may be sent, or takes what comes within some microseconds; the outcome of a string that ends.
    ///
    /// # Errors
    ///
    /// The port, or a controller that was reset.
    pub fn turn(&mut self, longest_us: u32) -> Result<Option<Outcome>, String> {
        let wait_us = match self.host.poll(self.now()) {
            Progress::Over(outcome) => return Ok(Some(outcome)),
            Progress::Sending => {
                let now = self.now();
                let bytes: Vec<u8> = std::iter::from_fn(|| self.host.transmit(now)).collect();
                if !bytes.is_empty() {
                    self.port.send(&bytes).map_err(gone)?;
                    return Ok(None);
                }
                // The guard before a `;` has begun.
                1000
            }
            Progress::Waiting { us } => us,
            Progress::Idle => longest_us,
        };
        let bytes = self.port.receive(wait_us.min(longest_us)).map_err(gone)?;
        self.waiting.extend(bytes);
        self.hear()?;
        Ok(None)
    }

    fn hear(&mut self) -> Result<(), String> {
        while let Some(byte) = self.waiting.pop_front() {
            let now = self.now();
            match self.host.push(byte, now) {
                Some(Report::Step { axis, forward }) => self.steps.push((axis as u8, forward)),
                Some(Report::LineDone) => self.lines += 1,
                Some(Report::Restarted) => return Err("the controller was reset".into()),
                Some(Report::Stopped | Report::Noise(_)) | None => {}
            }
        }
        Ok(())
    }

    /// Time at the port, wrapping.
    pub fn now(&self) -> u32 {
        self.port.elapsed_us() as u32
    }
}

fn gone(error: std::io::Error) -> String {
    format!("the port: {error}")
}

/// A sentence about an order that was not obeyed to its end.
pub const fn why(outcome: Outcome) -> &'static str {
    match outcome {
        Outcome::Done => "done",
        Outcome::Stopped => "something stopped it",
        Outcome::Refused => "the controller refuses it: not homed, beyond the travel, or busy",
        Outcome::Wrong => "the controller knows no such string",
        Outcome::NoSwitch => "no home switch was found",
        Outcome::Garbled => "the echo is not what was sent: look at the cable and the rate",
        Outcome::Silent => "no answer: look at the cable, the rate and the power",
        Outcome::Restarted => "the controller was reset",
    }
}

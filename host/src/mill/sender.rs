//! Lines to a controller, and the steps that it tells.

use crate::cmm::Port;
use husillo_transports::micromill::{Host, HostTiming, Line, Order, Outcome, Progress, Report};
use std::collections::VecDeque;

/// How lines are sent.
#[derive(Clone, Copy, Debug)]
pub struct Sending {
    /// Bits a second of the port.
    pub bits_per_s: u32,
    /// Without a stop between lines.
    pub streams: bool,
    /// One step in so many is told.
    pub every: u16,
    /// The controller homes first.
    pub homes: bool,
}

/// What came back.
#[derive(Debug, Default)]
pub struct Sent {
    /// Each step told since homing: axis, and whether forward.
    pub steps: Vec<(u8, bool)>,
    /// Lines that were made.
    pub lines: usize,
}

/// Sends lines and waits until they are made; `operator` is asked before a tool, and goes on with `true`.
///
/// # Errors
///
/// A sentence about the line of the file, or the port.
pub fn send(
    port: Port,
    sending: &Sending,
    lines: &[(usize, Line)],
    mut progress: impl FnMut(usize),
    mut operator: impl FnMut(u8) -> bool,
) -> Result<Sent, String> {
    let mut session = Session {
        port,
        host: Host::new(HostTiming::of(sending.bits_per_s)),
        sent: Sent::default(),
        waiting: VecDeque::new(),
    };
    session.order(Order::Stop, "stop")?;
    session.order(Order::Stream(false), "no streaming")?;
    session.order(Order::Every(sending.every), "report of steps")?;
    if sending.homes {
        session.order(Order::Home, "homing")?;
    }
    session.sent = Sent::default();
    if sending.streams {
        session.order(Order::Stream(true), "streaming")?;
    }
    for (done, (number, line)) in lines.iter().enumerate() {
        if let Line::Tool(tool) = line {
            session.finish()?;
            if !operator(*tool) {
                return Err(format!("line {number}: stopped before tool {tool}"));
            }
        }
        let text = Order::Line(*line).text();
        let name = format!("line {number}, {}", String::from_utf8_lossy(text.bytes()));
        session.order(Order::Line(*line), &name)?;
        if !sending.streams {
            session.sent.lines += 1;
        }
        progress(done + 1);
    }
    session.finish()?;
    if sending.streams {
        session.order(Order::Stream(false), "no streaming")?;
    }
    Ok(session.sent)
}

struct Session {
    port: Port,
    host: Host,
    sent: Sent,
    waiting: VecDeque<u8>,
}

impl Session {
    /// Sends an order and waits for its answer.
    fn order(&mut self, order: Order, name: &str) -> Result<(), String> {
        let now = self.now();
        if !self.host.start(order, now) {
            return Err(format!("{name}: the string before it has not ended"));
        }
        loop {
            if let Some(outcome) = self.turn()? {
                return match outcome {
                    Outcome::Done => Ok(()),
                    Outcome::Stopped => Err(format!("{name}: something stopped it")),
                    Outcome::Refused => Err(format!(
                        "{name}: the controller refuses it: not homed, beyond the travel, or busy"
                    )),
                    Outcome::Wrong => Err(format!("{name}: the controller knows no such string")),
                    Outcome::NoSwitch => Err(format!("{name}: no home switch was found")),
                    Outcome::Garbled => Err(format!(
                        "{name}: the echo is not what was sent: look at the cable and the rate"
                    )),
                    Outcome::Silent => Err(format!(
                        "{name}: no answer: look at the cable, the rate and the power"
                    )),
                    Outcome::Restarted => Err(format!("{name}: the controller was reset")),
                };
            }
        }
    }

    /// Waits until all streamed lines are made.
    fn finish(&mut self) -> Result<(), String> {
        while self.host.lines() > 0 {
            self.turn()?;
        }
        Ok(())
    }

    /// Sends what may be sent, takes what has come; the outcome of a string that ends.
    fn turn(&mut self) -> Result<Option<Outcome>, String> {
        let gone = |error: std::io::Error| format!("the port: {error}");
        loop {
            match self.host.poll(self.now()) {
                Progress::Over(outcome) => return Ok(Some(outcome)),
                Progress::Sending => {
                    let mut bytes = Vec::new();
                    let now = self.now();
                    while let Some(byte) = self.host.transmit(now) {
                        bytes.push(byte);
                    }
                    if !bytes.is_empty() {
                        self.port.send(&bytes).map_err(gone)?;
                        continue;
                    }
                    // The guard before a `;` has begun.
                    self.take(1000).map_err(gone)?;
                }
                Progress::Waiting { us } => self.take(us.min(100_000)).map_err(gone)?,
                Progress::Idle => {
                    self.take(100_000).map_err(gone)?;
                    return self.hear();
                }
            }
            self.hear()?;
        }
    }

    fn take(&mut self, wait_us: u32) -> std::io::Result<()> {
        self.waiting.extend(self.port.receive(wait_us)?);
        Ok(())
    }

    fn hear(&mut self) -> Result<Option<Outcome>, String> {
        while let Some(byte) = self.waiting.pop_front() {
            let now = self.now();
            match self.host.push(byte, now) {
                Some(Report::Step { axis, forward }) => {
                    self.sent.steps.push((axis as u8, forward));
                }
                Some(Report::LineDone) => self.sent.lines += 1,
                Some(Report::Restarted) => return Err("the controller was reset".into()),
                Some(Report::Stopped | Report::Noise(_)) | None => {}
            }
        }
        Ok(None)
    }

    /// Time at the port, wrapping.
    fn now(&self) -> u32 {
        self.port.elapsed_us() as u32
    }
}

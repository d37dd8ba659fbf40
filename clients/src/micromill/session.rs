//! A session with a controller at a port: orders, one after the other, and its reports.

use crate::{StopRequests, Wire};
use husillo_sim::device::micromill::Device;
use husillo_transports::micromill::{
    Host, HostTiming, Order, Outcome, Progress, Report, State, StateDigits,
};
use std::collections::VecDeque;
use std::time::Duration;

/// The longest wait for a byte in one turn, us.
const TURN_US: u32 = 100_000;
/// The longest wait between two checks for Ctrl-C, us: 4 steps of a jog.
const LOOK_US: u32 = 20_000;

/// A controller that was just switched on, or reset by the opening of the port, reports within this
/// time.
const GREETING: Duration = Duration::from_millis(20);
/// Largest number of reports of the state that are requested until two agree.
const MOST_REPORTS: u8 = 6;
/// A controller that has not confirmed a stop within this time counts as not answering, us.
const HALT_US: u32 = 3_000_000;

/// The host's end of the link, and the reports of the controller.
#[derive(Debug)]
pub struct Session {
    wire: Wire<Device>,
    timing: HostTiming,
    host: Host,
    waiting: VecDeque<u8>,
    /// Set by Ctrl-C.
    stop: StopRequests,
    /// Whether the stop was carried out.
    is_halted: bool,
    /// Whether the controller has answered the first order. A report of a reset before that answer
    /// is the greeting of a controller that was switched on, so nothing is lost.
    has_begun: bool,
    /// Whether the controller does not answer, or the port has failed.
    is_lost: bool,
    /// Period of the strings that continue a motion, us. `None`: a motion needs no host.
    renewal_us: Option<u32>,
    /// Time at which the last one of these strings was sent, us.
    renewed_us: u32,
    /// Each reported step: its axis, and whether it was forward.
    pub steps: Vec<(u8, bool)>,
    /// Lines that were carried out. The session counts the streamed ones.
    pub lines: usize,
    /// Digits of the last report of the state.
    digits: StateDigits,
    /// What the controller has echoed since the last order began.
    echo: Vec<u8>,
}

impl Session {
    /// A session with a controller in any state. The first order should be [`Order::Stop`]. The
    /// session stops the controller as soon as `stop` is set.
    pub fn new(mut wire: Wire<Device>, bits_per_s: u32, stop: StopRequests) -> Self {
        // Drops earlier bytes. The first order detects a dead line.
        let _ = wire.receive_all(GREETING);
        let timing = HostTiming::of(bits_per_s);
        Self {
            wire,
            timing,
            host: Host::new(timing),
            waiting: VecDeque::new(),
            stop,
            is_halted: false,
            has_begun: false,
            is_lost: false,
            renewal_us: None,
            renewed_us: 0,
            steps: Vec::new(),
            lines: 0,
            digits: StateDigits::new(),
            echo: Vec::new(),
        }
    }

    /// Brings a controller in any state to rest. From now on every motion ends `lease_ms` after the
    /// last byte of the host. The calls of this session continue a motion. With 0 a motion needs no
    /// host.
    ///
    /// # Errors
    ///
    /// Returns a sentence about the port or the controller.
    pub fn begin(&mut self, lease_ms: u16) -> Result<(), String> {
        // The greeting of the controller may come late and end this string in the middle. The
        // beginning of a string spoils the next one. It may be from this session or from a program
        // that was killed.
        let mut first = self.outcome(Order::Stop, "stop")?;
        if first == Outcome::Restarted {
            first = self.outcome(Order::Stop, "stop")?;
        }
        if first == Outcome::Wrong {
            self.order(Order::Stop, "stop")?;
        }
        self.has_begun = true;
        self.order(Order::Stream(false), "no streaming")?;
        // A lease of 0 ends the lease of an earlier program.
        let leased = self.order(Order::Lease(lease_ms), "lease");
        self.renewal_us = None;
        if lease_ms > 0 {
            leased.map_err(|why| {
                format!(
                    "{why}; without a lease (--lease 0) a motion continues \
                when the host has gone"
                )
            })?;
            self.renewal_us = Some(u32::from(lease_ms) * 1000 / 3);
            self.renewed_us = self.now();
        }
        Ok(())
    }

    /// Begins to send an order. Returns `false` if another one is being sent.
    pub fn start(&mut self, order: Order) -> bool {
        let now = self.now();
        let is_started = self.host.start(order, now);
        if is_started && order.is_answered() {
            self.echo.clear();
        }
        is_started
    }

    /// Begins to stop any motion, whatever is being sent: the string is dropped. The first byte of
    /// the stop ends a motion. The outcome [`Wrong`](Outcome::Wrong) means that the stop has
    /// completed a string that was dropped: call this again.
    pub fn interrupt(&mut self) {
        self.host = Host::new(self.timing);
        self.start(Order::Stop);
    }

    /// Sends an order and waits for its answer.
    ///
    /// # Errors
    ///
    /// The port failed, or the order failed. If the order failed, the message is `name` and the
    /// reason.
    pub fn order(&mut self, order: Order, name: &str) -> Result<(), String> {
        match self.outcome(order, name)? {
            Outcome::Done => Ok(()),
            outcome => Err(format!("{name}: {}", why(outcome))),
        }
    }

    /// Sends an order and waits for its outcome.
    fn outcome(&mut self, order: Order, name: &str) -> Result<Outcome, String> {
        if !self.start(order) {
            return Err(format!("{name}: the previous string has not ended"));
        }
        loop {
            if let Some(outcome) = self.turn(TURN_US)? {
                self.is_lost |= outcome == Outcome::Silent;
                return Ok(outcome);
            }
        }
    }

    /// What the controller has echoed of the last order.
    pub fn echo(&self) -> String {
        let echo = String::from_utf8_lossy(&self.echo);
        // The echoes of strings that continue the motion follow it.
        let renewal = Order::Renew.text();
        let renewal = String::from_utf8_lossy(renewal.bytes()).into_owned();
        echo.trim_end_matches(&renewal[..]).to_owned()
    }

    /// Asks a controller at rest for its state. Two reports in succession must be equal, because a
    /// wrong bit on the line would give a wrong position. `None`: the controller has no such
    /// string.
    ///
    /// # Errors
    ///
    /// No two reports agree, the controller does not answer, or the port failed.
    pub fn state(&mut self) -> Result<Option<State>, String> {
        let mut before = None;
        for _ in 0..MOST_REPORTS {
            self.digits = StateDigits::new();
            match self.outcome(Order::Report, "state")? {
                Outcome::Done => {}
                Outcome::Wrong => return Ok(None),
                outcome => return Err(format!("state: {}", why(outcome))),
            }
            let now = self.digits.state();
            if now.is_some() && now == before {
                return Ok(now);
            }
            before = now;
        }
        Err("the reports of the position differ: check the cable".into())
    }

    /// The state after a failure, if the controller still answers.
    pub(super) fn state_after(&mut self) -> Option<State> {
        if self.is_lost {
            return None;
        }
        // The string that failed may not have ended.
        self.host = Host::new(self.timing);
        self.digits = StateDigits::new();
        let is_at_rest = matches!(self.outcome(Order::Stop, "stop"), Ok(Outcome::Done));
        self.state().ok().flatten().filter(|_| is_at_rest)
    }

    /// Waits until all streamed lines are carried out.
    ///
    /// # Errors
    ///
    /// The port failed.
    pub fn finish(&mut self) -> Result<(), String> {
        while self.host.lines() > 0 {
            self.turn(TURN_US)?;
        }
        Ok(())
    }

    /// Sends the bytes that may be sent. If there are none, it receives for at most `longest_us`.
    /// Returns the outcome of a string that has ended.
    ///
    /// # Errors
    ///
    /// The port failed, the controller was reset, or Ctrl-C was pressed. Ctrl-C stops the motion.
    pub fn turn(&mut self, longest_us: u32) -> Result<Option<Outcome>, String> {
        if !self.is_halted && self.stop.is_asked() {
            self.is_halted = true;
            return Err(self.halt());
        }
        self.renew();
        let wait_us = match self.host.poll(self.now()) {
            Progress::Over(outcome) => return Ok(Some(outcome)),
            Progress::Sending => {
                let now = self.now();
                let bytes: Vec<u8> = std::iter::from_fn(|| self.host.transmit(now)).collect();
                if !bytes.is_empty() {
                    let sent = self.wire.send_all(&bytes);
                    self.is_lost |= sent.is_err();
                    sent.map_err(gone)?;
                    return Ok(None);
                }
                // The guard time before a `;` has begun.
                1000
            }
            Progress::Waiting { us } => us,
            Progress::Idle => longest_us,
        };
        let wait_us = wait_us.min(longest_us).min(LOOK_US);
        let wait = Duration::from_micros(wait_us.into());
        let received = self.wire.receive_all(wait);
        self.is_lost |= received.is_err();
        let bytes = received.map_err(gone)?;
        self.waiting.extend(bytes);
        self.hear()?;
        Ok(None)
    }

    /// Continues the motion while no other string is sent.
    fn renew(&mut self) {
        let now = self.now();
        let passed_us = now.wrapping_sub(self.renewed_us);
        let is_due = self
            .renewal_us
            .is_some_and(|period_us| passed_us >= period_us);
        if is_due && self.host.start(Order::Renew, now) {
            self.renewed_us = now;
        }
    }

    /// The lines that a simulated mill has reported on its panel since the last call.
    pub fn panel(&mut self) -> Vec<String> {
        self.wire.take_reports()
    }

    /// Whether Ctrl-C has ended the session.
    pub const fn is_halted(&self) -> bool {
        self.is_halted
    }

    /// The sum of the reported steps of each axis.
    pub fn net_steps(&self) -> [i64; 3] {
        let mut steps = [0; 3];
        for (axis, forward) in &self.steps {
            steps[usize::from(*axis)] += if *forward { 1 } else { -1 };
        }
        steps
    }

    /// Stops any motion, whatever bytes are on the line. Returns the message about the stop. A
    /// second Ctrl-C ends the wait.
    fn halt(&mut self) -> String {
        self.interrupt();
        let start = self.now();
        let why = loop {
            match self.turn(LOOK_US) {
                Ok(None) => {}
                Ok(Some(Outcome::Done)) => return "interrupted: the controller has stopped".into(),
                Ok(Some(outcome)) => break why(outcome).to_owned(),
                Err(sentence) => break sentence,
            }
            if self.stop.count() > 1 {
                break "the wait was ended".into();
            }
            if self.now().wrapping_sub(start) > HALT_US {
                break why(Outcome::Silent).into();
            }
        };
        self.is_lost = true;
        unconfirmed(&why)
    }

    fn hear(&mut self) -> Result<(), String> {
        while let Some(byte) = self.waiting.pop_front() {
            let now = self.now();
            if byte < 0x80 {
                self.echo.push(byte);
            }
            match self.host.push(byte, now) {
                Some(Report::Step { axis, forward }) => self.steps.push((axis as u8, forward)),
                Some(Report::LineDone) => self.lines += 1,
                Some(Report::Digit(digit)) => self.digits.push(digit),
                Some(Report::Restarted) if self.has_begun => {
                    return Err("the controller was reset".into());
                }
                Some(Report::Restarted | Report::Stopped | Report::Noise(_)) | None => {}
            }
        }
        Ok(())
    }

    /// Time since the port was opened. For a simulated mill this is simulated time.
    pub fn elapsed(&self) -> Duration {
        self.wire.elapsed()
    }

    /// The simulated device.
    #[cfg(test)]
    pub fn device(&mut self) -> &mut Device {
        match &mut self.wire {
            Wire::Simulated { device, .. } => device,
            Wire::Real { .. } => panic!("not simulated"),
        }
    }

    /// Time at the port, us. It wraps.
    pub fn now(&self) -> u32 {
        self.wire.elapsed().as_micros() as u32
    }
}

fn gone(error: std::io::Error) -> String {
    format!("the port: {error}")
}

fn unconfirmed(why: &str) -> String {
    format!(
        "interrupted: the stop was sent and is not confirmed ({why}): be ready to switch off the \
         mill"
    )
}

/// The reason why an order was not carried out to its end.
pub const fn why(outcome: Outcome) -> &'static str {
    match outcome {
        Outcome::Done => "done",
        Outcome::Stopped => {
            "it was stopped: by its lease, an end of the travel, a switch, or a byte \
                             from elsewhere"
        }
        Outcome::Refused => "the controller refuses it: not homed, beyond the travel, or busy",
        Outcome::Wrong => "the controller does not know the string",
        Outcome::NoSwitch => {
            "no home switch was found, or one sticks closed: look at the switches and home again; \
             the next search is over the whole travel"
        }
        Outcome::Garbled => "the echo differs from what was sent: check the cable and the rate",
        Outcome::Silent => "no answer: check the cable, the rate and the power",
        Outcome::Restarted => "the controller was reset",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::micromill::{BAUD, LEASE_MS};
    use husillo_sim::device::Emulation as _;
    use husillo_transports::micromill::{Answer, Axis};

    /// A killed program leaves part of a string in the controller. The next session begins
    /// nevertheless.
    #[test]
    fn a_session_begins_after_half_a_string() {
        for left in ["", "L", "PX+10", "G01X01000", "!", "LA", ";"] {
            let mut device = Device::new(BAUD);
            left.bytes().for_each(|byte| device.send(byte));
            let mut wire = Wire::simulated(device);
            // Waits until the controller has echoed all of it.
            while !wire.receive_all(GREETING).unwrap().is_empty() {}
            let mut session = Session::new(wire, BAUD, StopRequests::default());
            assert_eq!(session.begin(LEASE_MS), Ok(()), "{left}");
            assert_eq!(session.order(Order::Every(1), "report"), Ok(()), "{left}");
        }
    }

    /// A controller greets when it is switched on. A greeting after the first bytes of a session
    /// does not count as a reset. A later greeting counts as one.
    #[test]
    fn a_late_greeting_is_no_reset() {
        let greeting = Answer::Ready.byte();
        let wire = Wire::simulated(Device::new(BAUD));
        let mut session = Session::new(wire, BAUD, StopRequests::default());
        session.waiting.push_back(greeting);
        assert_eq!(session.begin(LEASE_MS), Ok(()));
        session.waiting.push_back(greeting);
        let reset = session.order(Order::Every(1), "report");
        assert_eq!(reset, Err("the controller was reset".into()));
    }

    /// A motion ends with its lease. A session with a lease of 0 ends the lease of an earlier one.
    #[test]
    fn a_lease_of_zero_ends_an_earlier_one() {
        let wire = Wire::simulated(Device::new(BAUD));
        let mut session = Session::new(wire, BAUD, StopRequests::default());
        let motion = Order::Steps(Axis::X, 400);
        session.begin(LEASE_MS).unwrap();
        assert_eq!(session.outcome(motion, "move"), Ok(Outcome::Done));
        // The session sends nothing any more, like a host that has gone.
        session.renewal_us = None;
        assert_eq!(session.outcome(motion, "move"), Ok(Outcome::Stopped));
        session.begin(0).unwrap();
        assert_eq!(session.renewal_us, None);
        assert_eq!(session.outcome(motion, "move"), Ok(Outcome::Done));
    }
}

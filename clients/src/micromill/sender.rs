//! Sends lines to a controller, and collects the steps that it reports.

use super::position;
use super::session::Session;
use crate::{StopRequests, Wire};
use husillo_sim::device::micromill::Device;
use husillo_sim::text::counted;
use husillo_transports::micromill::{Line, Order, State};

/// Settings of a transmission.
#[derive(Clone, Copy, Debug)]
pub struct Sending {
    /// Rate of the port, bits/s.
    pub bits_per_s: u32,
    /// Longest silence of the host before a motion ends, ms; 0: a motion needs no host.
    pub lease_ms: u16,
    /// Send a line while the previous one is being carried out, without a stop between them.
    pub streams: bool,
    /// Report every n-th step; 0 reports none.
    pub every: u16,
    /// Home before the first line.
    pub homes: bool,
}

/// Result of a transmission.
#[derive(Debug, Default)]
pub struct Sent {
    /// Each step reported since homing: its axis, and whether it was forward.
    pub steps: Vec<(u8, bool)>,
    /// Lines that were carried out.
    pub lines: usize,
    /// The state that the controller reports at the end. `None`: the controller has no such report.
    pub state: Option<State>,
}

/// A controller that receives lines, one after the other.
#[derive(Debug)]
pub struct Sender {
    session: Session,
    sending: Sending,
    /// The state before homing. `None`: the controller does not report its state.
    found: Option<State>,
    /// The state in which the first line begins. `None`: the controller does not report its state.
    start: Option<State>,
    /// Whether the reported steps give the position.
    is_counted: bool,
}

impl Sender {
    /// Stops any motion, and asks for the state of the controller. It starts no motion.
    ///
    /// # Errors
    ///
    /// Returns a sentence about the port or the controller.
    pub fn new(wire: Wire<Device>, sending: Sending, stop: StopRequests) -> Result<Self, String> {
        let mut session = Session::new(wire, sending.bits_per_s, stop);
        session.begin(sending.lease_ms)?;
        let state = session.state()?;
        Ok(Self {
            session,
            sending,
            found: state,
            start: match sending.homes {
                true => state.map(State::homed),
                false => state,
            },
            is_counted: false,
        })
    }

    /// The session.
    #[cfg(test)]
    pub const fn session(&mut self) -> &mut Session {
        &mut self.session
    }

    /// The state in which the first line begins, after homing if that was requested. `None`: the
    /// controller does not report its state.
    pub const fn start(&self) -> Option<State> {
        self.start
    }

    /// Homes if that was requested. Call it before the first line. Returns a sentence if the home
    /// switches show that steps were lost since the last homing.
    ///
    /// # Errors
    ///
    /// Returns a sentence about the failure. After a stop it contains the position of the motors.
    pub fn begin(&mut self) -> Result<Option<String>, String> {
        let begun = self.try_begin();
        begun.map_err(|sentence| self.failed(sentence))
    }

    fn try_begin(&mut self) -> Result<Option<String>, String> {
        let (session, sending) = (&mut self.session, &self.sending);
        session.order(Order::Every(sending.every), "report of steps")?;
        let mut lost = None;
        if sending.homes {
            session.steps.clear();
            session.order(Order::Home, "homing")?;
            let state = session.state()?;
            if state != self.start {
                return Err("homing: the controller is not where homing ends".into());
            }
            // Steps can be compared only if every step is reported.
            let known = self.found.zip(state).filter(|_| sending.every == 1);
            lost =
                known.and_then(|(found, now)| position::lost(&found, &session.net_steps(), &now));
        }
        session.steps.clear();
        self.is_counted = true;
        if sending.streams {
            session.order(Order::Stream(true), "streaming")?;
        }
        Ok(lost)
    }

    /// Sends a line of the file and waits until it is carried out, or until it is queued if lines
    /// are streamed. Before the line is sent, `operator` gets the line and its string. It returns
    /// whether to continue.
    ///
    /// # Errors
    ///
    /// The line is refused, the port fails, or a stop is requested. The message contains the
    /// position of the motors.
    pub fn send(
        &mut self,
        number: usize,
        line: &Line,
        operator: impl FnMut(&Line, &str) -> bool,
    ) -> Result<(), String> {
        let sent = self.try_send(number, line, operator);
        sent.map_err(|sentence| self.failed(sentence))
    }

    fn try_send(
        &mut self,
        number: usize,
        line: &Line,
        mut operator: impl FnMut(&Line, &str) -> bool,
    ) -> Result<(), String> {
        let session = &mut self.session;
        let text = Order::Line(*line).text();
        let string = String::from_utf8_lossy(text.bytes());
        if matches!(line, Line::Tool(_)) {
            session.finish()?;
        }
        if !operator(line, &string) {
            // After Ctrl-C this call returns the message about the interruption.
            session.turn(0)?;
            return Err(match line {
                Line::Tool(tool) => format!("line {number}: stopped before tool {tool}"),
                _ => format!("line {number}: stopped before {string}"),
            });
        }
        session.order(Order::Line(*line), &format!("line {number}, {string}"))?;
        if !self.sending.streams {
            session.lines += 1;
        }
        Ok(())
    }

    /// What the controller has echoed of the last line, and the number of steps reported so far.
    pub fn echo(&self) -> (String, usize) {
        (self.session.echo(), self.session.steps.len())
    }

    /// Lines that were carried out.
    pub const fn made(&self) -> usize {
        self.session.lines
    }

    /// Keeps the session alive for a time while no line is sent. The time is at most a tenth of a
    /// second.
    ///
    /// # Errors
    ///
    /// The port fails, the controller was reset, or a stop is requested.
    pub fn idle(&mut self, longest_us: u32) -> Result<(), String> {
        let turned = self.session.turn(longest_us);
        turned.map(|_| ()).map_err(|sentence| self.failed(sentence))
    }

    /// Waits until all lines are carried out, then asks for the state.
    ///
    /// # Errors
    ///
    /// The errors of [`send`](Self::send). Also an error if the position of the controller is not
    /// that of the steps that it reported.
    pub fn finish(&mut self) -> Result<Sent, String> {
        let finished = self.try_finish();
        let state = finished.map_err(|sentence| self.failed(sentence))?;
        Ok(Sent {
            steps: std::mem::take(&mut self.session.steps),
            lines: self.session.lines,
            state,
        })
    }

    fn try_finish(&mut self) -> Result<Option<State>, String> {
        self.session.finish()?;
        if self.sending.streams {
            self.session.order(Order::Stream(false), "no streaming")?;
        }
        let state = self.session.state()?;
        match state.and_then(|state| self.uncounted(&state)) {
            Some(uncounted) => Err(uncounted),
            None => Ok(state),
        }
    }

    /// The message about a failure, with the position that the controller reports.
    fn failed(&mut self, sentence: String) -> String {
        if !self.is_counted || self.start.is_none() {
            return sentence;
        }
        let lines = counted(self.session.lines, "line");
        // A controller that does not answer is not asked again.
        let Some(state) = self.session.state_after() else {
            return format!("{sentence}; {lines} made; the position is unknown");
        };
        let motors = position::motors(&state);
        let uncounted = match self.uncounted(&state) {
            Some(uncounted) => format!("; {uncounted}"),
            None => String::new(),
        };
        format!("{sentence}; {lines} made; {motors}{uncounted}")
    }

    /// A sentence about the steps that the controller counts beyond those that it reported.
    fn uncounted(&self, state: &State) -> Option<String> {
        let start = self
            .start
            .filter(|start| start.is_homed == state.is_homed)?;
        if self.sending.every != 1 || !self.is_counted {
            return None;
        }
        position::uncounted(&start, &self.session.net_steps(), state)
    }
}

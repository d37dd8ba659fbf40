//! A session with a controller at a port: its lines, and bytes that take effect at once.

use crate::{StopRequests, Wire};
use husillo_sim::device::grbl::Device;
use husillo_transports::grbl::{
    Alarm, ErrorCode, Message, Place, Position, Realtime, State, Status,
};
use std::time::Duration;

/// Interval of the requests for a status report.
const POLL: Duration = Duration::from_millis(200);
/// The longest wait between two checks for Ctrl-C.
const LOOK: Duration = Duration::from_millis(20);
/// A board that is reset by the opening of the port has started within this time.
const START: Duration = Duration::from_secs(5);
/// A controller that has sent nothing for this time counts as lost. A working one answers each
/// request for a report.
const SILENCE: Duration = Duration::from_secs(3);
/// After a hold a motion has stopped within this time. Ramps take a second or two.
const HOLD: Duration = Duration::from_secs(10);
/// Longest line of a controller, bytes. The rest of a longer line is dropped.
const LONGEST: usize = 1024;

/// What a controller has sent.
#[derive(Clone, Debug, PartialEq)]
pub enum Heard {
    /// A line was accepted.
    Ok,
    /// A line was refused: the number of the error.
    Refused(u16),
    /// A report of state and position.
    Status(Status),
    /// Motion was interrupted, or is not permitted: the number of the alarm.
    Alarm(u16),
    /// The controller has started: its name.
    Started(String),
    /// Another line.
    Text(String),
}

impl Heard {
    /// Reads a line. Numbers that Grbl 1.1 does not have come from a newer controller.
    fn of(line: &[u8]) -> Option<Heard> {
        let text = || String::from_utf8_lossy(line).into_owned();
        let number = |name| text().strip_prefix(name).and_then(|rest| rest.parse().ok());
        if let Some(number) = number("error:") {
            return Some(Heard::Refused(number));
        }
        if let Some(number) = number("ALARM:") {
            return Some(Heard::Alarm(number));
        }
        match Message::parse(line) {
            Some(Message::Blank) => None,
            Some(Message::Ok) => Some(Heard::Ok),
            Some(Message::Status(status)) => Some(Heard::Status(status)),
            Some(Message::Banner(_)) => Some(Heard::Started(text())),
            // Other versions have other words after the name.
            _ if line.starts_with(b"Grbl") => Some(Heard::Started(text())),
            _ => Some(Heard::Text(text())),
        }
    }
}

/// Why a line was not accepted.
enum Unanswered {
    /// The number of the error.
    Refused(u16),
    /// There is no answer in time.
    Silent,
    /// The line must not be sent again: a sentence about the port, the controller or the stop.
    Ended(String),
}

impl Unanswered {
    fn sentence(self) -> String {
        match self {
            Self::Refused(number) => described(number),
            Self::Silent => "the controller does not answer this line".into(),
            Self::Ended(why) => why,
        }
    }
}

/// The host's end of the link.
#[derive(Debug)]
pub struct Session {
    wire: Wire<Device>,
    stop: StopRequests,
    /// The beginning of a line that is not complete.
    line: Vec<u8>,
    status: Option<Status>,
    work_zero: Option<Place>,
    /// Time of the last request for a report.
    asked_at: Duration,
    /// A report was requested and has not come.
    awaits_report: bool,
    /// Time of the last received byte.
    heard_at: Duration,
    /// Whether the port has failed, or the controller does not answer.
    is_lost: bool,
    /// Interval of the requests for a status report.
    poll: Duration,
    /// A controller that has sent nothing for this time counts as lost.
    silence: Duration,
}

impl Session {
    /// A session with a controller in any state. Nothing is sent yet.
    pub fn new(wire: Wire<Device>, stop: StopRequests) -> Self {
        let now = wire.elapsed();
        Self {
            wire,
            stop,
            line: Vec::new(),
            status: None,
            work_zero: None,
            asked_at: now,
            awaits_report: false,
            heard_at: now,
            is_lost: false,
            poll: POLL,
            silence: SILENCE,
        }
    }

    /// Sets the interval of the requests for a status report, 200 ms at first. A request waits for
    /// the report before it, but not longer than 200 ms, because that may be lost.
    pub const fn poll_every(&mut self, interval: Duration) {
        self.poll = interval;
    }

    /// Sets the time of silence after which a controller counts as lost. `None`: 3 s. While it
    /// homes, Grbl sends no reports.
    pub fn allow_silence(&mut self, silence: Option<Duration>) {
        self.silence = silence.unwrap_or(SILENCE);
        self.heard_at = self.elapsed();
    }

    /// Waits for a controller that is starting or already runs. Then ends a line that an earlier
    /// program has begun. Nothing moves.
    ///
    /// # Errors
    ///
    /// Returns a sentence about the port or the controller.
    pub fn begin(&mut self) -> Result<(), String> {
        self.put(&[Realtime::Status.byte()])?;
        let end = self.elapsed() + START;
        while self.status.is_none() {
            self.heard_at = self.elapsed();
            self.turn()?;
            if self.elapsed() > end {
                self.is_lost = true;
                return Err("no answer: check the cable, the rate and the power".into());
            }
        }
        if self.is_held() || self.is_in_motion() {
            return Ok(());
        }
        // A partial line of another program is refused or has no effect, because it is incomplete.
        self.put(b"\n")?;
        loop {
            match self.turn()? {
                Some(Heard::Ok | Heard::Refused(_)) => return self.fresh_status().map(|_| ()),
                _ if self.is_stopped() => return Err("interrupted: nothing was sent".into()),
                _ => {}
            }
        }
    }

    /// Sends bytes.
    ///
    /// # Errors
    ///
    /// The port failed.
    pub fn put(&mut self, bytes: &[u8]) -> Result<(), String> {
        let sent = self.wire.send_all(bytes);
        self.is_lost |= sent.is_err();
        sent.map_err(gone)
    }

    /// Sends a line and waits for its answer. Returns the lines before the answer.
    ///
    /// # Errors
    ///
    /// The line is refused, motion is interrupted, the port fails, or a stop is requested.
    pub fn request(&mut self, line: &str) -> Result<Vec<String>, String> {
        self.ask(line, Duration::MAX).map_err(Unanswered::sentence)
    }

    /// Sends a line as [`request`](Self::request) does, over a link that may lose or change the
    /// line or its answer. So it is sent up to `tries` times, each time after a refusal or after
    /// `patience` without an answer. It must do no harm if it is carried out twice.
    ///
    /// # Errors
    ///
    /// As [`request`](Self::request). In addition, there is no answer.
    pub fn request_repeatedly(
        &mut self,
        line: &str,
        patience: Duration,
        tries: u32,
    ) -> Result<Vec<String>, String> {
        let mut last = Unanswered::Silent;
        for _ in 0..tries {
            match self.ask(line, patience) {
                Ok(lines) => return Ok(lines),
                Err(Unanswered::Ended(why)) => return Err(why),
                Err(other) => last = other,
            }
        }
        Err(last.sentence())
    }

    fn ask(&mut self, line: &str, patience: Duration) -> Result<Vec<String>, Unanswered> {
        if let Some(state) = self.state().filter(|_| self.is_held()) {
            let name = state.name();
            return Err(Unanswered::Ended(format!(
                "the controller answers no line in the state {name}: `husillo stop -m grbl` ends it"
            )));
        }
        let begin = self.elapsed();
        self.put(format!("{line}\n").as_bytes())
            .map_err(Unanswered::Ended)?;
        let mut lines = Vec::new();
        while self.elapsed().saturating_sub(begin) < patience {
            if self.is_stopped() {
                return Err(Unanswered::Ended(self.halt()));
            }
            match self.turn().map_err(Unanswered::Ended)? {
                Some(Heard::Ok) => return Ok(lines),
                Some(Heard::Refused(number)) => return Err(Unanswered::Refused(number)),
                Some(Heard::Alarm(number)) => return Err(Unanswered::Ended(self.alarmed(number))),
                Some(Heard::Started(_)) => {
                    return Err(Unanswered::Ended("the controller was reset".into()));
                }
                Some(Heard::Text(text)) => lines.push(text),
                Some(Heard::Status(_)) | None => {}
            }
        }
        Err(Unanswered::Silent)
    }

    /// Receives for a short time at most. Requests a status report if one is due.
    ///
    /// # Errors
    ///
    /// The port failed, or the controller is silent.
    pub fn turn(&mut self) -> Result<Option<Heard>, String> {
        let now = self.elapsed();
        if now.saturating_sub(self.heard_at) > self.silence {
            self.is_lost = true;
            return Err("the controller does not answer any more: check cable and power".into());
        }
        if now >= self.next_request_at() {
            self.request_report()?;
        }
        let end = self.next_request_at().min(now + LOOK);
        while let Some(left) = end.checked_sub(self.elapsed()) {
            let received = self.wire.receive(left);
            self.is_lost |= received.is_err();
            let Some(byte) = received.map_err(gone)? else {
                return Ok(None);
            };
            self.heard_at = self.elapsed();
            if byte != b'\n' {
                if byte != b'\r' && self.line.len() < LONGEST {
                    self.line.push(byte);
                }
                continue;
            }
            let heard = Heard::of(&std::mem::take(&mut self.line));
            match &heard {
                Some(Heard::Status(status)) => {
                    self.work_zero = status.work_zero.or(self.work_zero);
                    self.status = Some(*status);
                    self.awaits_report = false;
                }
                Some(Heard::Started(_)) => {
                    // Its state is asked for at once. A request of before the start was lost.
                    self.status = None;
                    self.awaits_report = false;
                    self.asked_at = Duration::ZERO;
                }
                _ => {}
            }
            return Ok(heard);
        }
        Ok(None)
    }

    /// When the next report is requested. A slow line is not filled with requests.
    fn next_request_at(&self) -> Duration {
        let wait = match self.awaits_report {
            true => self.poll.max(POLL),
            false => self.poll,
        };
        self.asked_at + wait
    }

    fn request_report(&mut self) -> Result<(), String> {
        self.asked_at = self.elapsed();
        self.awaits_report = true;
        self.put(&[Realtime::Status.byte()])
    }

    /// Requests a report and waits for it.
    ///
    /// # Errors
    ///
    /// The port failed, the controller is silent, or an alarm has ended the motion.
    pub fn fresh_status(&mut self) -> Result<Status, String> {
        self.status = None;
        self.request_report()?;
        loop {
            if let Some(Heard::Alarm(number)) = self.turn()? {
                return Err(self.alarmed(number));
            }
            if let Some(status) = self.status {
                return Ok(status);
            }
        }
    }

    /// The message about an alarm, with the position. After some alarms the controller answers only
    /// after a reset. So this resets the controller. Nothing moves then.
    pub fn alarmed(&mut self, number: u16) -> String {
        let why = alarm(number);
        match self.reset() {
            Ok(()) => format!("{why}; {}", self.stands()),
            Err(silent) => format!("{why}; {silent}"),
        }
    }

    /// Requests reports until one contains the work zero. Grbl sends the work zero at least once in
    /// thirty reports. A controller that never sends it has reported positions from the work zero.
    ///
    /// # Errors
    ///
    /// The port failed, or the controller is silent.
    pub fn expect_work_zero(&mut self) -> Result<(), String> {
        for _ in 0..30 {
            let is_work = |status: &Status| matches!(status.position, Position::Work(_));
            if self.work_zero.is_some() || self.status.as_ref().is_some_and(is_work) {
                break;
            }
            self.fresh_status()?;
        }
        Ok(())
    }

    /// The last reported state.
    pub fn state(&self) -> Option<State> {
        self.status.map(|status| status.state)
    }

    /// The last report.
    pub const fn status(&self) -> Option<&Status> {
        self.status.as_ref()
    }

    /// Position of the work zero in machine coordinates, as it was last reported.
    pub const fn work_zero(&self) -> Option<&Place> {
        self.work_zero.as_ref()
    }

    /// Whether the last report shows a motion.
    pub fn is_in_motion(&self) -> bool {
        use State::{Door, Hold, Home, Jog, Run};
        matches!(
            self.state(),
            Some(Run | Jog | Home | Hold(true) | Door(2 | 3))
        )
    }

    /// Whether the last report shows a state in which the controller answers no line until it
    /// resumes.
    pub fn is_held(&self) -> bool {
        use State::{Door, Hold, Sleep};
        matches!(self.state(), Some(Hold(_) | Door(_) | Sleep))
    }

    /// Whether a stop is requested.
    pub fn is_stopped(&self) -> bool {
        self.stop.is_asked()
    }

    /// Stops any motion and drops all lines that wait in the controller. The axes brake first, so
    /// the position stays valid. After a second request the controller is reset during the motion,
    /// and the position is lost. Returns a message with the position.
    pub fn halt(&mut self) -> String {
        match self.stand() {
            Ok(()) => format!("interrupted: the controller has stopped; {}", self.stands()),
            Err(why) => format!(
                "interrupted: the stop was sent and is not confirmed ({why}): be ready to switch \
                 off the machine"
            ),
        }
    }

    /// Brakes, then resets the controller.
    ///
    /// # Errors
    ///
    /// The controller does not answer.
    pub fn stand(&mut self) -> Result<(), String> {
        let before = self.stop.count();
        let is_homing = self.state() == Some(State::Home);
        // A jog obeys only its own byte. It drops what waits behind it.
        self.put(&[Realtime::Hold.byte(), Realtime::JogCancel.byte()])?;
        let end = self.elapsed() + HOLD;
        self.fresh_status()?;
        // Homing has no hold, so a reset ends it.
        while !is_homing && self.is_in_motion() {
            if self.stop.count() > before.max(1) || self.elapsed() > end {
                break;
            }
            self.fresh_status()?;
        }
        self.reset()
    }

    /// Resets the controller and waits until it has started.
    ///
    /// # Errors
    ///
    /// The controller does not start.
    pub fn reset(&mut self) -> Result<(), String> {
        self.put(&[Realtime::Reset.byte()])?;
        self.line.clear();
        let end = self.elapsed() + START;
        while self.elapsed() < end {
            if let Some(Heard::Started(_)) = self.turn()? {
                return self.fresh_status().map(|_| ());
            }
        }
        Err("it does not start after a reset".into())
    }

    /// The position in the last report, from the work zero, nm. `None`: the work zero is unknown.
    pub fn work_position(&self) -> Option<Vec<i64>> {
        match (self.status?.position, self.work_zero) {
            (Position::Work(at), _) => Some(at.nm().to_vec()),
            (Position::Machine(at), Some(zero)) => {
                let nm = at.nm().iter().zip(zero.nm());
                Some(nm.map(|(at, zero)| at - zero).collect())
            }
            (Position::Machine(_), None) => None,
        }
    }

    /// The position in the last report as text, from the work zero if that is known.
    pub fn stands(&self) -> String {
        let Some(status) = self.status.filter(|_| !self.is_lost) else {
            return "the position is unknown".into();
        };
        let doubtful = match status.state {
            State::Alarm => ", which may be wrong: home the machine",
            _ => "",
        };
        let work = self
            .work_position()
            .map(|at| format!("work {}", lengths(&at)));
        let machine = match status.position {
            Position::Machine(at) => Some(format!("machine {}", lengths(at.nm()))),
            Position::Work(_) => None,
        };
        let known: Vec<_> = work.into_iter().chain(machine).collect();
        known.join("; ") + doubtful
    }

    /// Time since the port was opened. For a simulated controller this is simulated time.
    pub fn elapsed(&self) -> Duration {
        self.wire.elapsed()
    }

    /// The lines that a simulated machine has reported on its panel since the last call.
    pub fn panel(&mut self) -> Vec<String> {
        self.wire.take_reports()
    }

    /// The simulated device.
    #[cfg(test)]
    pub fn device(&mut self) -> &mut Device {
        match &mut self.wire {
            Wire::Simulated { device, .. } => device,
            Wire::Real { .. } => panic!("not simulated"),
        }
    }
}

/// A position in mm, with the letters of its axes.
fn lengths(nm: &[i64]) -> String {
    let axes = ["X", "Y", "Z", "A", "B", "C"].into_iter().zip(nm);
    let words: Vec<_> = axes
        .map(|(letter, nm)| format!("{letter} {:.3}", *nm as f64 / 1e6))
        .collect();
    format!("{} mm", words.join(" "))
}

/// The sentence about an error of a line.
pub fn described(number: u16) -> String {
    let code = u8::try_from(number).ok().and_then(ErrorCode::of);
    match code {
        Some(code) => format!("error {number}: {}", code.text()),
        None => format!("error {number}, which Grbl 1.1 does not have"),
    }
}

/// The sentence about an alarm.
pub fn alarm(number: u16) -> String {
    match u8::try_from(number).ok().and_then(Alarm::of) {
        Some(alarm) => format!("alarm {number}: {}", alarm.text()),
        None => format!("alarm {number}, which Grbl 1.1 does not have"),
    }
}

fn gone(error: std::io::Error) -> String {
    format!("the port: {error}")
}

//! Sends a program to a controller, as fast as its receive buffer accepts it.

use super::session::{Heard, Session, described};
use super::stream::Stream;
use crate::{StopRequests, Wire};
use husillo_sim::device::grbl::Device;
use husillo_transports::grbl::{Realtime, State, Status};
use std::collections::VecDeque;

mod checked;

/// How lines are sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pacing {
    /// As many lines as the receive buffer of the controller holds.
    Counted,
    /// One line, after the previous one is answered.
    Answered,
    /// One line, after the previous one is carried out and the operator agrees.
    SingleBlock,
}

/// An operator who watches a program and intervenes.
pub trait Operator {
    /// Receives a report when the state has changed, or a text of the controller for the operator.
    fn hear(&mut self, heard: &Heard);
    /// Receives the number of lines that are answered.
    fn progress(&mut self, lines: usize);
    /// Returns a byte that takes effect at once: hold, resume or an override.
    fn command(&mut self) -> Option<Realtime>;
    /// Whether to send a line in [`Pacing::SingleBlock`]. If not, the program ends before it.
    /// `None`: there is no answer yet. The question is repeated many times a second, and the
    /// controller is watched meanwhile.
    fn agrees(&mut self, line: &str) -> Option<bool>;
}

/// The result of a program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sent {
    /// Lines that were carried out.
    pub lines: usize,
    /// The status report at the end.
    pub status: Status,
}

/// A controller that receives a program.
#[derive(Debug)]
pub struct Sender {
    session: Session,
    pacing: Pacing,
    /// Index of each line that is sent and not yet answered.
    stream: Stream<usize>,
    answered: usize,
    /// Indices of the last answered lines with motion, as many as may not be carried out.
    moves: VecDeque<usize>,
    /// Largest number of moves that wait in the queue of the controller.
    queue: usize,
}

/// Whether a line has a coordinate. A line without one adds no move to the queue of the controller.
pub fn has_coordinate(line: &str) -> bool {
    line.contains(['X', 'Y', 'Z', 'A', 'B', 'C', 'x', 'y', 'z', 'a', 'b', 'c'])
}

/// A dwell of zero time. The controller answers it when all moves before it are carried out. A
/// report of `Idle` does not show that, because it may come before the last move begins.
pub const SYNCHRONISE: &str = "G4P0";

impl Sender {
    /// Connects to a controller at rest. Nothing moves.
    ///
    /// # Errors
    ///
    /// Returns a sentence about the port, or about a controller that moves or is locked.
    pub fn new(wire: Wire<Device>, pacing: Pacing, stop: StopRequests) -> Result<Self, String> {
        let mut session = Session::new(wire, stop);
        session.begin()?;
        let state = session.state();
        let name = state.map_or("unknown", State::name);
        match state {
            Some(State::Idle | State::Check) => {}
            Some(State::Alarm) => {
                return Err(
                    "the controller is locked: `husillo jog -m grbl home` or `unlock`".into(),
                );
            }
            Some(State::Sleep | State::Hold(false) | State::Door(0 | 1)) => {
                return Err(format!(
                    "the controller is in the state {name}: `husillo stop -m grbl` ends it"
                ));
            }
            _ => {
                return Err(format!(
                    "the controller moves for another program (state {name}): `husillo stop -m \
                     grbl` stops it"
                ));
            }
        }
        let queue = queue(&session.request("$I")?)?;
        Ok(Self {
            session,
            pacing,
            queue,
            stream: Stream::new(),
            answered: 0,
            moves: VecDeque::new(),
        })
    }

    /// The session.
    pub const fn session(&mut self) -> &mut Session {
        &mut self.session
    }

    /// Lines that are answered. Moves of the last of these lines may wait in the queue of the
    /// controller.
    pub const fn answered(&self) -> usize {
        self.answered
    }

    /// Largest number of moves that wait in the queue of the controller, as the controller reports
    /// it.
    pub const fn queue(&self) -> usize {
        self.queue
    }

    /// Index of the first line that may not be carried out. The queue may be full, and one more
    /// move is being carried out. A line is answered when its last move is in the queue, one
    /// without motion at once.
    pub fn first_open(&self) -> usize {
        self.moves.front().copied().unwrap_or(0)
    }

    /// Sends these lines, each with its number, and waits until they are carried out.
    ///
    /// # Errors
    ///
    /// A line is too long or refused, motion is interrupted, the controller is reset, the port
    /// fails, or a stop is requested. If the controller still answers, the machine is at rest then,
    /// and the message contains the position.
    pub fn send(
        &mut self,
        lines: &[(usize, String)],
        operator: &mut dyn Operator,
    ) -> Result<Sent, String> {
        self.stream = Stream::new();
        self.answered = 0;
        self.moves.clear();
        let (mut next, mut finished) = (0, 0);
        while self.answered < lines.len() {
            self.intervene(operator)?;
            while let Some((number, line)) = lines.get(next).filter(|(_, line)| self.may_send(line))
            {
                if self.pacing == Pacing::SingleBlock {
                    match operator.agrees(line) {
                        Some(true) => {}
                        Some(false) => {
                            return Err(self.ended(format!("line {number}: stopped before {line}")));
                        }
                        None => break,
                    }
                }
                self.session.put(format!("{line}\n").as_bytes())?;
                self.stream.sent(line, next);
                next += 1;
            }
            self.hear(lines, operator)?;
            let is_answered = self.stream.is_empty() && self.answered == next;
            if self.pacing == Pacing::SingleBlock && is_answered && next > finished {
                finished = next;
                self.finish(lines, operator)?;
            }
        }
        self.finish(lines, operator)?;
        let status = self.session.fresh_status()?;
        Ok(Sent {
            lines: lines.len(),
            status,
        })
    }

    /// Notes an answered line, if it moves. Moves that are certainly carried out are forgotten.
    fn note_moves(&mut self, index: usize, line: &str) {
        if has_coordinate(line) {
            self.moves.push_back(index);
            let more = self.moves.len().saturating_sub(self.queue + 1);
            self.moves.drain(..more);
        }
    }

    /// Whether a line may be sent: it fits into the buffer, and its turn has come.
    fn may_send(&self, line: &str) -> bool {
        match self.pacing {
            Pacing::Counted => self.stream.has_room(line),
            Pacing::Answered | Pacing::SingleBlock => self.stream.is_empty(),
        }
    }

    /// Carries out a request to stop, and passes on the commands of the operator.
    fn intervene(&mut self, operator: &mut dyn Operator) -> Result<(), String> {
        if self.session.is_stopped() {
            return Err(self.session.halt());
        }
        while let Some(command) = operator.command() {
            if command == Realtime::Reset {
                return Err(self.ended("ended by the operator".into()));
            }
            self.session.put(&[command.byte()])?;
        }
        Ok(())
    }

    /// Receives for a short time and handles a line that has arrived.
    fn hear(
        &mut self,
        lines: &[(usize, String)],
        operator: &mut dyn Operator,
    ) -> Result<(), String> {
        let before = self.session.state();
        let Some(heard) = self.session.turn()? else {
            return Ok(());
        };
        match &heard {
            Heard::Ok | Heard::Refused(_) => {
                let index = self.stream.answered();
                if let (Heard::Refused(number), Some(index)) = (&heard, index) {
                    let why = described(*number);
                    let (number, line) = lines
                        .get(index)
                        .map_or((0, ""), |(number, line)| (*number, line));
                    return Err(self.ended(format!("line {number}, {line}: {why}")));
                }
                if let Some((index, (_, line))) = index.and_then(|at| Some((at, lines.get(at)?))) {
                    self.answered += 1;
                    self.note_moves(index, line);
                    operator.progress(self.answered);
                }
            }
            heard => self.pass_on(heard, before, operator)?,
        }
        Ok(())
    }

    /// Handles what is not an answer: a reset or an alarm ends the program, the operator hears the
    /// rest. `before` is the state of the last report.
    fn pass_on(
        &mut self,
        heard: &Heard,
        before: Option<State>,
        operator: &mut dyn Operator,
    ) -> Result<(), String> {
        match heard {
            Heard::Alarm(number) => return Err(self.session.alarmed(*number)),
            Heard::Started(_) => {
                self.session.fresh_status()?;
                let stands = self.session.stands();
                return Err(format!("the controller was reset; {stands}"));
            }
            Heard::Status(status) if before == Some(status.state) => {}
            heard => operator.hear(heard),
        }
        Ok(())
    }

    /// Waits until all moves are carried out.
    fn finish(
        &mut self,
        lines: &[(usize, String)],
        operator: &mut dyn Operator,
    ) -> Result<(), String> {
        self.session.put(format!("{SYNCHRONISE}\n").as_bytes())?;
        self.stream.sent(SYNCHRONISE, lines.len());
        while !self.stream.is_empty() {
            self.intervene(operator)?;
            self.hear(lines, operator)?;
        }
        Ok(())
    }

    /// Ends a program for a reason that the controller does not know. The controller brakes and
    /// drops the lines that wait in it. Returns the message.
    fn ended(&mut self, why: String) -> String {
        match self.session.stand() {
            Ok(()) => format!(
                "{why}; the controller has stopped; {}",
                self.session.stands()
            ),
            Err(lost) => format!("{why}; the stop is not confirmed: {lost}"),
        }
    }
}

/// Reads the number of moves in the queue from the answer to `$I`: `[OPT:V,15,128]`.
pub fn queue(lines: &[String]) -> Result<usize, String> {
    let options = lines.iter().find_map(|line| line.strip_prefix("[OPT:"));
    let moves = options.and_then(|options| options.split([',', ']']).nth(1)?.parse().ok());
    moves.ok_or_else(|| "the controller does not report the size of its queue: see $I".into())
}

#[cfg(test)]
mod tests;

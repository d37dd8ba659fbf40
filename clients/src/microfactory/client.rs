//! The host's side of the microfactory's link.

use super::action::Action;
use crate::{StopRequests, Wire};
use husillo_sim::device::microfactory::{self as device, Device};
use husillo_transports::microfactory::{
    ByteTable, REJECTED, Report, STATUS_BYTES, Status, figure_check, move_bytes,
};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// Longest wait for an answer of two bytes, 2.08 ms, and the silence after which no byte of it is
/// under way any more.
const IN_SIMULATED_TIME: Waits = Waits {
    answer: Duration::from_millis(200),
    quiet: Duration::from_millis(60),
};
/// The same where a computer that is busy, or an adapter, may sleep in between.
const IN_REAL_TIME: Waits = Waits {
    answer: Duration::from_millis(1500),
    quiet: Duration::from_millis(150),
};
/// Between two questions whether it stands.
const ASK: Duration = Duration::from_millis(50);
/// Between two times a jog is said, well within the dead-man's time.
const AGAIN: Duration = Duration::from_millis(100);
/// What a device that does not answer is given for homing.
const HOMING: Duration = Duration::from_secs(120);
/// Approach and figure of a device that does not answer and has its own figure, of at most 20 000
/// steps.
const FIGURE: Duration = Duration::from_secs(250);
/// Stops that end any half command, and one.
const STOPS: usize = 6;
/// The number of tries of a question, a figure, or bringing to rest. Doing these twice has no other
/// effect than once.
const TRIES: usize = 3;
/// What comes without an end is noise.
const NOISE: usize = 1000;

/// The holder of the lock has the link to a controller of two machines. The value: whether the last
/// exchange succeeded.
type Turn = Arc<Mutex<bool>>;

/// The host's side.
#[derive(Debug)]
pub struct Client {
    wire: Wire<Device>,
    waits: Waits,
    table: ByteTable,
    answers: bool,
    /// The machine of the controller, 0 or 1.
    machine: u8,
    /// Where the controller's other machine has a client, too.
    turn: Option<Turn>,
    has_turn: bool,
    stop: StopRequests,
    is_reached: bool,
    /// It was homed since: what is not homed any more was reset.
    is_homed: bool,
    /// Where the loaded figure leads from its beginning.
    figure_end: Option<[i32; 2]>,
    /// How long it takes at 100 steps a second, its lash taken up at every move.
    figure_time: Duration,
}

/// How long a device is waited for.
#[derive(Clone, Copy, Debug)]
struct Waits {
    answer: Duration,
    quiet: Duration,
}

/// How a byte was answered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Answer {
    Taken,
    Rejected,
}

impl Client {
    /// On a wire to a device that answers, or to one that does not; stops when the flag is set.
    pub fn new(wire: Wire<Device>, table: ByteTable, answers: bool, stop: StopRequests) -> Self {
        let waits = match wire {
            Wire::Simulated { .. } => IN_SIMULATED_TIME,
            Wire::Real { .. } => IN_REAL_TIME,
        };
        Self {
            wire,
            waits,
            table,
            answers,
            machine: 0,
            turn: None,
            has_turn: false,
            stop,
            is_reached: false,
            is_homed: false,
            figure_end: None,
            figure_time: FIGURE,
        }
    }

    /// The same for a machine of a controller of two, 0 or 1.
    pub const fn of_machine(mut self, machine: u8) -> Self {
        self.machine = machine;
        self
    }

    /// A client of another machine of the same controller, on the same link: the two take turns.
    ///
    /// # Errors
    ///
    /// The port cannot be shared.
    pub fn beside(&mut self, machine: u8) -> std::io::Result<Self> {
        let turn = self.turn.get_or_insert_default();
        Ok(Self {
            wire: self.wire.try_clone()?,
            turn: Some(Arc::clone(turn)),
            stop: self.stop.clone(),
            machine,
            ..*self
        })
    }

    /// What a simulated device told.
    pub fn reports(&mut self) -> Vec<String> {
        self.wire.reports()
    }

    /// Time since the beginning.
    pub fn elapsed(&self) -> Duration {
        self.wire.elapsed()
    }

    /// The wire, for another client.
    #[cfg(test)]
    pub fn into_wire(self) -> Wire<Device> {
        self.wire
    }

    /// The simulated device.
    #[cfg(test)]
    pub fn device(&mut self) -> &mut Device {
        match &mut self.wire {
            Wire::Simulated { device, .. } => device,
            Wire::Real { .. } => panic!("not simulated"),
        }
    }

    /// Carries out an action, waits until it has ended, and returns how it ended. After a failure
    /// the device is brought to rest.
    ///
    /// # Errors
    ///
    /// A sentence about the link, or that the device did not do it.
    pub fn carry_out(&mut self, action: &Action) -> Result<String, String> {
        let result = self.done(action);
        result.map_err(|trouble| {
            self.is_reached = false;
            if !self.answers || *action == Action::Emergency {
                return trouble;
            }
            let rest = self.talk(|client| client.rest().and_then(|()| client.ask()));
            if self.wants_emergency() {
                return match self.emergency() {
                    Ok(how) => format!("{trouble}; emergency stop: {how}"),
                    Err(why) => format!("{trouble}; {why}"),
                };
            }
            match rest {
                Ok(status) => format!("{trouble}; it stands at {}", place(&status)),
                Err(_) => trouble,
            }
        })
    }

    /// Whether Ctrl-C is pressed again, within a second of the first time.
    fn wants_emergency(&self) -> bool {
        if !self.stop.is_asked() || !matches!(self.wire, Wire::Real { .. }) {
            return false;
        }
        let end = std::time::Instant::now() + Duration::from_secs(1);
        while self.stop.count() < 2 && std::time::Instant::now() < end {
            std::thread::sleep(Duration::from_millis(10));
        }
        self.stop.count() >= 2
    }

    fn done(&mut self, action: &Action) -> Result<String, String> {
        if self.stop.is_asked() {
            return Err("stopped".into());
        }
        if !self.is_reached && *action != Action::Emergency {
            self.reach()?;
        }
        match action {
            Action::Home => {
                self.is_homed = false;
                self.command(&[self.table.home])?;
                self.finished(HOMING, Report::Homed)
            }
            Action::Load(figure) => self.load(&figure.moves),
            Action::Figure => self.cut(),
            Action::Steps { motor, steps } => self.steps(*motor, *steps),
            Action::Jog {
                motor,
                forward,
                time,
            } => self.talk(|client| client.jog(*motor, *forward, *time)),
            Action::Where => Ok(match self.answers {
                true => place(&self.ask()?),
                false => "it does not answer".into(),
            }),
            // It stands since it was reached.
            Action::Stop => {
                self.talk(Self::rest)?;
                self.finished(Duration::ZERO, Report::Stopped)
                    .or(Ok("stands".into()))
            }
            Action::Emergency => self.emergency(),
        }
    }

    /// Has the link to itself during an exchange, with its machine chosen. The machine is chosen
    /// each time, because after a reset the controller listens for the first one. After a failure
    /// it is unknown what the device has understood, so the next user first brings the link to
    /// rest.
    fn talk<T>(
        &mut self,
        exchange: impl FnOnce(&mut Self) -> Result<T, String>,
    ) -> Result<T, String> {
        if self.has_turn || (self.turn.is_none() && self.machine == 0) {
            return exchange(self);
        }
        let turn = self.turn.clone();
        let mut is_well = turn.as_ref().map(locked);
        let is_known = is_well.as_deref().map_or(self.is_reached, |well| *well);
        self.has_turn = true;
        let rest = if is_known || !self.answers {
            Ok(())
        } else {
            self.rest()
        };
        let result = rest
            .and_then(|()| self.choose())
            .and_then(|()| exchange(self));
        self.has_turn = false;
        if let Some(well) = &mut is_well {
            **well = result.is_ok();
        }
        result
    }

    /// Brings the device to rest and looks whether it can be driven.
    fn reach(&mut self) -> Result<(), String> {
        if !self.answers {
            self.talk(|client| {
                for _ in 0..STOPS {
                    client.send(client.table.stop)?;
                }
                client.choose()
            })?;
            self.is_reached = true;
            return Ok(());
        }
        let status = self.talk(|client| {
            if !client.has_turn {
                client.rest()?;
                client.choose()?;
            }
            // What moved was another's, perhaps.
            client.rest()?;
            client.ask()
        })?;
        if status.report == Some(Report::Emergency) {
            return Err(
                "the device was stopped by an emergency stop: look why, then reset it".into(),
            );
        }
        self.is_reached = true;
        Ok(())
    }

    /// Chooses the machine. A controller of one refuses that, which is as well for the first.
    fn choose(&mut self) -> Result<(), String> {
        let [first, second] = self.table.machines;
        let letter = if self.machine > 0 { second } else { first };
        if self.send(letter)? == Answer::Rejected && self.machine > 0 {
            return Err("the controller there drives one machine: there is no second one".into());
        }
        Ok(())
    }

    /// Ends any half command and any motion; what is on the way is dropped.
    fn rest(&mut self) -> Result<(), String> {
        let mut last = None;
        for attempt in 1..=TRIES {
            for _ in 0..STOPS {
                self.put(self.table.stop)?;
            }
            last = self.answers_to(STOPS)?.or(last);
            // After an emergency stop not even a stop is taken.
            if last.is_some_and(|last| last == self.table.stop || last == REJECTED) {
                return Ok(());
            }
            // Not one of so many bytes: nobody is there.
            if last.is_none() && attempt > 1 {
                break;
            }
        }
        Err(match last {
            None => {
                "no answer: no device there, unplugged, or one that does not answer (then \
                 --without-answers)"
            }
            Some(_) => {
                "only noise comes back: the line is bad, its rate is another one, or it is \
                 another device"
            }
        }
        .into())
    }

    /// The last answer to so many bytes: each is waited for, and then what is on the way still.
    fn answers_to(&mut self, bytes: usize) -> Result<Option<u8>, String> {
        let mut last = None;
        for number in 0..NOISE {
            let within = if number < bytes {
                self.waits.answer
            } else {
                self.waits.quiet
            };
            match self.get(within)? {
                Some(byte) => last = Some(byte),
                None => break,
            }
        }
        Ok(last)
    }

    fn emergency(&mut self) -> Result<String, String> {
        // More often than a half command has data bytes, because the first ones would be taken as
        // data. This does not wait for the lock.
        for _ in 0..STOPS {
            self.put(self.table.emergency)?;
        }
        if !self.answers {
            return Ok("sent".into());
        }
        let unheard = "no answer to the emergency stop: use the button at the machine";
        if let Some(turn) = &self.turn {
            // The answers are anywhere: who asks brings the link to rest first.
            *locked(turn) = false;
        } else if self.answers_to(STOPS)?.is_none() {
            return Err(unheard.into());
        }
        let status = self.ask().map_err(|_| unheard)?;
        match status.report {
            Some(Report::Emergency) => Ok(format!("stopped for good, {}", place(&status))),
            _ => Err("the emergency stop was not taken: use the button at the machine".into()),
        }
    }

    /// Stores another figure. If the link fails, it tries again, because a figure begins anew each
    /// time.
    fn load(&mut self, moves: &[[i16; 2]]) -> Result<String, String> {
        if moves.len() > usize::from(device::ROOM) {
            return Err(format!(
                "a figure of {} moves: the device has room for {}",
                moves.len(),
                device::ROOM
            ));
        }
        let mut trouble = String::new();
        for attempt in 1..=TRIES {
            if self.stop.is_asked() {
                return Err("stopped".into());
            }
            match self.talk(|client| client.load_once(moves)) {
                Ok(()) => {
                    self.note(moves);
                    let again = if attempt > 1 {
                        format!(", {attempt} times: {trouble}")
                    } else {
                        String::new()
                    };
                    return Ok(format!("{} moves{again}", moves.len()));
                }
                Err(error) => trouble = error,
            }
            if !self.answers {
                break;
            }
            self.talk(Self::rest)?;
        }
        Err(format!("the figure is not stored: {trouble}"))
    }

    fn load_once(&mut self, moves: &[[i16; 2]]) -> Result<(), String> {
        let table = self.table;
        if self.send(table.clear)? == Answer::Rejected {
            return Err(
                "the device takes no figures (its own is cut by `husillo jog figure`)".into(),
            );
        }
        let mut bytes = Vec::with_capacity(5 * moves.len() + 5);
        for way in moves {
            bytes.push(table.line);
            bytes.extend(move_bytes(*way));
        }
        bytes.push(table.keep);
        // Below the room of a device.
        bytes.extend(u16::try_from(moves.len()).unwrap_or(u16::MAX).to_le_bytes());
        bytes.extend(figure_check(moves).to_le_bytes());
        self.command(&bytes)
    }

    /// Keeps what the loaded figure leads to.
    fn note(&mut self, moves: &[[i16; 2]]) {
        let sum = |axis: usize| moves.iter().map(|way| i32::from(way[axis])).sum();
        self.figure_end = Some([sum(0), sum(1)]);
        let lengths = moves
            .iter()
            .map(|[x, z]| f64::from(*x).hypot(f64::from(*z)) + 200.0);
        // 5000 steps to the work piece at most.
        self.figure_time = Duration::from_secs_f64((lengths.sum::<f64>() + 5400.0) / 100.0);
    }

    /// Cuts the stored figure; of one that was loaded it is known where it ends.
    fn cut(&mut self) -> Result<String, String> {
        let from = self.position()?;
        if self.answers && !self.is_homed {
            return Err(
                "not homed, so nobody knows on which side its lash lies: home it first".into(),
            );
        }
        if let Err(refused) = self.command(&[self.table.figure]) {
            return Err(match self.ask() {
                Ok(Status {
                    report: Some(report @ Report::NoFigure),
                    ..
                }) => device::text(report),
                _ => refused,
            });
        }
        let how = self.finished(self.figure_time, Report::Done)?;
        if let (Some(by), [Some(from), Some(to)]) = (self.figure_end, [from, self.position()?]) {
            let [x, _, z, _] = from;
            if [to[0], to[2]] != [x.wrapping_add(by[0]), z.wrapping_add(by[1])] {
                return Err(
                    "the figure ended elsewhere than its moves lead: another one was cut".into(),
                );
            }
        }
        Ok(how)
    }

    /// Counted steps, 255 at most at a time.
    fn steps(&mut self, motor: u8, steps: i32) -> Result<String, String> {
        let table = self.table;
        let mut left = steps;
        let mut how = String::new();
        while left != 0 {
            let count = u8::try_from(left.unsigned_abs().min(255)).unwrap_or(u8::MAX);
            let way = i32::from(count) * left.signum();
            let from = self.position()?;
            self.command(&[
                table.steps,
                letter(&table, motor, left > 0),
                count,
                table.run,
            ])?;
            // 64 steps a second at least, and a take-up of 200 steps before them.
            let longest = Duration::from_secs_f64((f64::from(count) + 250.0) / 64.0);
            how = self.finished(longest, Report::Done)?;
            if let [Some(from), Some(to)] = [from, self.position()?] {
                let moved = |motor| {
                    let place = |at: [i32; 4]| at.get(usize::from(motor)).copied().unwrap_or(0);
                    place(to).wrapping_sub(place(from))
                };
                if moved(motor) != way {
                    return Err(format!("{} steps were made instead of {way}", moved(motor)));
                }
            }
            left -= way;
        }
        Ok(how)
    }

    fn jog(&mut self, motor: u8, forward: bool, time: Duration) -> Result<String, String> {
        self.command(&[self.table.manual])?;
        let letter = letter(&self.table, motor, forward);
        let end = self.wire.elapsed() + time;
        let mut turns = true;
        while turns && self.wire.elapsed() < end && !self.stop.is_asked() {
            turns = self.send(letter)? == Answer::Taken;
            if turns {
                self.pause(AGAIN.min(end.saturating_sub(self.wire.elapsed())))?;
            }
        }
        // What a switch has ended goes back off it, which a stop would cut short.
        if !self.answers || (turns && self.ask()?.report.is_none()) {
            self.send(self.table.stop)?;
        }
        if self.stop.is_asked() {
            return Err("stopped".into());
        }
        self.finished(Duration::ZERO, Report::Stopped)
            .or_else(|trouble| {
                // A host or a line that is slow now and then: the jog was shorter, and it says so.
                if trouble == device::text(Report::DeadMan) {
                    Ok(trouble)
                } else {
                    Err(trouble)
                }
            })
    }

    /// Bytes that must all be taken.
    fn command(&mut self, bytes: &[u8]) -> Result<(), String> {
        self.talk(|client| {
            for byte in bytes {
                if client.send(*byte)? == Answer::Rejected {
                    return Err(format!(
                        "the device does not take {}",
                        char::from(*byte).escape_default()
                    ));
                }
            }
            Ok(())
        })
    }

    /// Waits until nothing moves, and checks how it ended. A device that does not answer gets the
    /// whole time.
    fn finished(&mut self, longest: Duration, wanted: Report) -> Result<String, String> {
        if !self.answers {
            self.pause(longest)?;
            if self.stop.is_asked() {
                self.talk(|client| (0..STOPS).try_for_each(|_| client.put(client.table.stop)))?;
                return Err("stopped".into());
            }
            return Ok("sent, not confirmed".into());
        }
        loop {
            let status = self.ask()?;
            if !status.is_moving {
                return match status.report {
                    Some(report) if report == wanted => Ok(device::text(report)),
                    Some(report) => Err(device::text(report)),
                    None => Err("the device was reset".into()),
                };
            }
            if self.stop.is_asked() {
                return Err("stopped".into());
            }
            self.pause(ASK)?;
        }
    }

    /// Load steps of a device that answers.
    fn position(&mut self) -> Result<Option<[i32; 4]>, String> {
        Ok(match self.answers {
            true => Some(self.ask()?.position_steps),
            false => None,
        })
    }

    /// Asks where it is; a question may be put again.
    fn ask(&mut self) -> Result<Status, String> {
        let status = self.talk(|client| {
            let mut trouble = String::new();
            for _ in 0..TRIES {
                match client.ask_once() {
                    Ok(status) => return Ok(status),
                    Err(error) => trouble = error,
                }
                client.answers_to(0)?;
            }
            Err(trouble)
        })?;
        let was_homed = std::mem::replace(&mut self.is_homed, status.is_homed);
        if was_homed && !status.is_homed && status.report != Some(Report::Emergency) {
            return Err("the device was reset: it has to be homed again".into());
        }
        Ok(status)
    }

    fn ask_once(&mut self) -> Result<Status, String> {
        if self.send(self.table.ask)? == Answer::Rejected {
            return Err("the device does not tell where it is".into());
        }
        let mut bytes = [0; STATUS_BYTES];
        for byte in &mut bytes {
            *byte = self
                .get(self.waits.answer)?
                .ok_or("the answer was cut off")?;
        }
        Status::of(&bytes).ok_or_else(|| "the answer was damaged: the line is noisy".into())
    }

    /// A byte and its answer; to a device that does not answer, the time of the byte.
    fn send(&mut self, byte: u8) -> Result<Answer, String> {
        self.put(byte)?;
        if !self.answers {
            self.pause(Duration::from_millis(2))?;
            return Ok(Answer::Taken);
        }
        match self.get(self.waits.answer)? {
            Some(answer) if answer == byte && byte != REJECTED => Ok(Answer::Taken),
            // A raw byte may equal the answer to a command that is not taken. Then it was taken, or
            // the end is wrong.
            Some(REJECTED) if byte == REJECTED => Ok(Answer::Taken),
            Some(REJECTED) => Ok(Answer::Rejected),
            Some(other) => Err(format!(
                "sent {byte:#04x} and {other:#04x} came back: the line is noisy, or the device is \
                 another one"
            )),
            None => Err("no answer: unplugged, switched off, or a byte was lost".into()),
        }
    }

    fn pause(&mut self, time: Duration) -> Result<(), String> {
        let end = self.wire.elapsed() + time;
        while self.wire.elapsed() < end && (self.answers || !self.stop.is_asked()) {
            // A device that does not answer may be waited for long. Ctrl-C is checked at this
            // interval.
            let left = end.saturating_sub(self.wire.elapsed()).min(AGAIN);
            if self.turn.is_some() && !self.has_turn {
                // What comes now is for the other client.
                std::thread::sleep(left);
                continue;
            }
            if let Some(byte) = self.get(left)? {
                return Err(format!("{byte:#04x} came without being asked for"));
            }
        }
        Ok(())
    }

    fn put(&mut self, byte: u8) -> Result<(), String> {
        self.wire.send(byte).map_err(|error| error.to_string())
    }

    fn get(&mut self, within: Duration) -> Result<Option<u8>, String> {
        self.wire.receive(within).map_err(|error| error.to_string())
    }
}

/// Nothing is left half done in it by a thread that broke.
fn locked(turn: &Turn) -> MutexGuard<'_, bool> {
    turn.lock().unwrap_or_else(PoisonError::into_inner)
}

fn letter(table: &ByteTable, motor: u8, forward: bool) -> u8 {
    let [plus, minus] = table
        .motors
        .get(usize::from(motor))
        .copied()
        .unwrap_or([0; 2]);
    if forward { plus } else { minus }
}

/// Where a device is, for people.
fn place(status: &Status) -> String {
    let [x, y, z, spindle] = status.position_steps;
    let frame = if status.is_homed {
        "from home"
    } else {
        "not homed"
    };
    format!("x {x} y {y} z {z} spindle {spindle} steps, {frame}")
}

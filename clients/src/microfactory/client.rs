//! The host's side of the microfactory's link.

mod parts;

pub use parts::Motion;

use super::action::Action;
use super::settings::{Settings, length};
use crate::{StopRequests, Wire};
use husillo_gcode::Nm;
use husillo_sim::device::microfactory::{self as device, Device};
use husillo_sim::text::counted;
use husillo_transports::microfactory::{
    ByteTable, REJECTED, Report, STATUS_BYTES, SWITCHES_BYTES, Status, Switches,
};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// The longest wait for an answer, and the silence after which an answer is complete.
/// An answer of two bytes takes 2.08 ms.
const IN_SIMULATED_TIME: Waits = Waits {
    answer: Duration::from_millis(200),
    quiet: Duration::from_millis(60),
};
/// The waits in real time, where a busy computer or an adapter adds delays.
const IN_REAL_TIME: Waits = Waits {
    answer: Duration::from_millis(1500),
    quiet: Duration::from_millis(150),
};
/// The lease, in units of 10 ms: a motion ends this long after the last byte of this program.
pub const LEASE: u8 = 25;
/// The period of the queries whether the device is at rest.
const ASK: Duration = Duration::from_millis(50);
/// The period in which a jog is repeated. It is well within the dead-man's time.
const AGAIN: Duration = Duration::from_millis(100);
/// The wait for the homing of a device that does not answer.
const HOMING: Duration = Duration::from_secs(120);
/// The wait for the approach and the figure of a device that does not answer and has its own
/// figure: at most 20 000 steps.
const FIGURE: Duration = Duration::from_secs(250);
/// The number of stop bytes that end any partial command, and one more.
const STOPS: usize = 6;
/// The number of tries of a question, of a figure and of bringing the device to rest. A repetition
/// does no harm.
const TRIES: usize = 3;
/// More bytes than this without a pause are noise.
const NOISE: usize = 1000;
/// The message about a report with a wrong check.
const NOISY: &str = "the answer was damaged: the line is noisy";
/// A stepping motor loses steps in multiples of four, because four steps are a turn of its field.
const LEAST_LOSS_STEPS: u32 = 4;

/// The right to use the link to a controller of two machines. The value is `true` if the last
/// use succeeded.
type Turn = Arc<Mutex<bool>>;

/// The host's side of the link.
#[derive(Debug)]
pub struct Client {
    wire: Wire<Device>,
    waits: Waits,
    table: ByteTable,
    answers: bool,
    /// The machine of the controller, 0 or 1.
    machine: u8,
    /// Set if the other machine of the controller has a client, too.
    turn: Option<Turn>,
    has_turn: bool,
    stop: StopRequests,
    /// Longest silence of this program during a motion, in units of 10 ms; 0 for no limit.
    lease: u8,
    /// A step of X, Y and Z in nm, as numerator and denominator.
    steps: [[i128; 2]; 3],
    is_reached: bool,
    /// Whether the machine was homed. If its status is no longer homed, the machine was reset.
    is_homed: bool,
    /// The displacement of the loaded figure, X and Z.
    figure_end: Option<[i32; 2]>,
    /// The duration of the figure at 100 steps a second, with a backlash take-up at every move.
    figure_time: Duration,
}

/// Longest waits for a device.
#[derive(Clone, Copy, Debug)]
struct Waits {
    answer: Duration,
    quiet: Duration,
}

impl Waits {
    /// Waits that together last at most three quarters of a lease.
    fn within_lease(self, lease: u8) -> Self {
        let quarter = match lease {
            0 => return self,
            lease => Duration::from_micros(u64::from(lease) * 10_000 / 4),
        };
        Self {
            answer: self.answer.min(2 * quarter),
            quiet: self.quiet.min(quarter),
        }
    }
}

/// The answer to a byte.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Answer {
    Taken,
    Rejected,
}

impl Client {
    /// A client on a wire. `answers`: whether its device answers. The client stops when a stop is
    /// requested.
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
            lease: LEASE,
            steps: Settings::ORIGINAL.steps,
            is_reached: false,
            is_homed: false,
            figure_end: None,
            figure_time: FIGURE,
        }
    }

    /// Selects machine 0 or 1 of a controller of two.
    pub const fn of_machine(mut self, machine: u8) -> Self {
        self.machine = machine;
        self
    }

    /// Every motion ends this long after the last byte of this program, in units of 10 ms. With 0 a
    /// motion needs no host. The other machine of the same controller has the same lease.
    pub const fn with_lease(mut self, lease: u8) -> Self {
        self.lease = lease;
        self
    }

    /// Sets the length of the steps, for positions in millimetres and inches. Without this call
    /// they are the steps of the original.
    pub const fn with_steps(mut self, steps: [[i128; 2]; 3]) -> Self {
        self.steps = steps;
        self
    }

    /// A client of the other machine of the same controller. The two share the link in turns.
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

    /// What a simulated device has reported since the last call.
    pub fn take_reports(&mut self) -> Vec<String> {
        self.wire.take_reports()
    }

    /// Time since the link was opened.
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

    /// Carries out an action and waits for its end. Returns how it ended. After a failure it brings
    /// the device to rest.
    ///
    /// # Errors
    ///
    /// The link failed, or the device did not carry out the action.
    pub fn carry_out(&mut self, action: &Action) -> Result<String, String> {
        let result = self.done(action);
        result.map_err(|error| {
            self.is_reached = false;
            if !self.answers || *action == Action::Emergency {
                return error;
            }
            let rest = self.talk(|client| client.rest().and_then(|()| client.ask()));
            if self.wants_emergency() {
                return match self.emergency() {
                    Ok(how) => format!("{error}; emergency stop: {how}"),
                    Err(why) => format!("{error}; {why}"),
                };
            }
            match rest {
                Ok(status) => format!("{error}; {}", standing(&status)),
                Err(_) => error,
            }
        })
    }

    /// Whether Ctrl-C is pressed again within a second of the first time.
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
                let how = self.finished(HOMING, Report::Homed)?;
                Ok(match self.lost()? {
                    Some(lost) => format!("{how}; {lost}"),
                    None => how,
                })
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
                true => {
                    let status = self.ask()?;
                    format!("{}{}", place(&status), self.lengths(&status))
                }
                false => "it does not answer".into(),
            }),
            // Reaching the device has stopped it.
            Action::Stop => {
                self.talk(Self::rest)?;
                self.finished(Duration::ZERO, Report::Stopped)
                    .or(Ok("stands".into()))
            }
            Action::Emergency => self.emergency(),
        }
    }

    /// Runs an exchange with exclusive use of the link and with this machine selected. The machine
    /// is selected each time, because a controller selects the first one after a reset. After a
    /// failure the state of the device is unknown, so the next exchange brings the link to rest
    /// first.
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

    /// The position of a homed machine in millimetres and inches.
    fn lengths(&self, status: &Status) -> String {
        if !status.is_homed {
            return String::new();
        }
        let axes = status.position_steps.into_iter().zip(self.steps);
        let [mut mm, mut inch] = [String::new(), String::new()];
        for (letter, (steps, step)) in ["x", "y", "z"].into_iter().zip(axes) {
            let Nm(nm) = length(steps.into(), step);
            // The lengths are below 2^53 nm, so both texts are right to the last printed digit.
            mm += &format!("{letter} {:.3} ", nm as f64 / 1e6);
            inch += &format!("{letter} {:.4} ", nm as f64 / 25.4e6);
        }
        format!("; {mm}mm; {inch}in")
    }

    /// Brings the device to rest and checks that it can be driven.
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
            // The other machine may have been moving.
            client.rest()?;
            client.begin_lease()?;
            client.ask()
        })?;
        if status.report == Some(Report::Emergency) {
            return Err(
                "an emergency stop has stopped the device: find the reason, then reset it".into(),
            );
        }
        self.is_reached = true;
        Ok(())
    }

    /// Sets the lease, or ends that of an earlier program.
    fn begin_lease(&mut self) -> Result<(), String> {
        if self.send(self.table.lease)? == Answer::Taken {
            self.send(self.lease)?;
        } else if self.lease > 0 && self.ask()?.report != Some(Report::Emergency) {
            return Err(
                "the device has no lease: a motion continues if this program is killed \
                        (--lease 0 accepts that)"
                    .into(),
            );
        }
        Ok(())
    }

    /// Selects the machine. A controller of one machine refuses this, which is harmless for the
    /// first machine.
    fn choose(&mut self) -> Result<(), String> {
        let [first, second] = self.table.machines;
        let letter = if self.machine > 0 { second } else { first };
        if self.send(letter)? == Answer::Rejected && self.machine > 0 {
            return Err("this controller drives one machine: there is no second one".into());
        }
        Ok(())
    }

    /// Ends any partial command and any motion. Drops the bytes on the line.
    fn rest(&mut self) -> Result<(), String> {
        let mut last = None;
        for attempt in 1..=TRIES {
            for _ in 0..STOPS {
                self.put(self.table.stop)?;
            }
            last = self.answers_to(STOPS)?.or(last);
            // After an emergency stop the device rejects even a stop.
            if last.is_some_and(|last| last == self.table.stop || last == REJECTED) {
                return Ok(());
            }
            // No byte was answered, so there is no device.
            if last.is_none() && attempt > 1 {
                break;
            }
        }
        Err(match last {
            None => {
                "no answer: there is no device, it is unplugged, or it never answers (then use \
                 --without-answers)"
            }
            Some(_) => {
                "only noise comes back: the line is bad, or it is another rate or another device"
            }
        }
        .into())
    }

    /// The last answer to this number of bytes. Waits for each answer, and then for bytes that are
    /// still on the line.
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
        // These are more bytes than a partial command may still need as data. The emergency stop
        // does not wait for its turn.
        for _ in 0..STOPS {
            self.put(self.table.emergency)?;
        }
        if !self.answers {
            return Ok("sent".into());
        }
        let unheard = "no answer to the emergency stop: use the button at the machine";
        if let Some(turn) = &self.turn {
            // Either client may receive the answers. So the next exchange brings the link to rest
            // first.
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

    /// Stores a figure. Tries again if the link fails. Each try starts from the beginning.
    fn load(&mut self, moves: &[[i16; 2]]) -> Result<String, String> {
        if moves.len() > usize::from(device::ROOM) {
            return Err(format!(
                "a figure of {}: the device has room for {}",
                counted(moves.len(), "move"),
                device::ROOM
            ));
        }
        let mut last = String::new();
        for attempt in 1..=TRIES {
            if self.stop.is_asked() {
                return Err("stopped".into());
            }
            match self.talk(|client| client.load_once(moves)) {
                Ok(()) => {
                    self.note(moves);
                    let again = if attempt > 1 {
                        format!(", {attempt} times: {last}")
                    } else {
                        String::new()
                    };
                    return Ok(format!("{}{again}", counted(moves.len(), "move")));
                }
                Err(error) => last = error,
            }
            if !self.answers {
                break;
            }
            self.talk(Self::rest)?;
        }
        Err(format!("the figure is not stored: {last}"))
    }

    fn load_once(&mut self, moves: &[[i16; 2]]) -> Result<(), String> {
        self.clear_figure()?;
        for delta in moves {
            self.store_move(*delta)?;
        }
        self.keep_figure(moves)
    }

    /// Keeps the displacement and the duration of the loaded figure.
    fn note(&mut self, moves: &[[i16; 2]]) {
        let sum = |axis: usize| moves.iter().map(|delta| i32::from(delta[axis])).sum();
        self.figure_end = Some([sum(0), sum(1)]);
        let lengths = moves
            .iter()
            .map(|[x, z]| f64::from(*x).hypot(f64::from(*z)) + 200.0);
        // The distance to the work piece is at most 5000 steps.
        self.figure_time = Duration::from_secs_f64((lengths.sum::<f64>() + 5400.0) / 100.0);
    }

    /// Cuts the stored figure. Checks the end position if this client has loaded the figure.
    fn cut(&mut self) -> Result<String, String> {
        let from = self.position()?;
        if self.answers && !self.is_homed {
            return Err("not homed, so the side of its backlash is unknown: home it first".into());
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
                return Err("the figure ended at a wrong position: another figure was cut".into());
            }
        }
        Ok(how)
    }

    /// Turns a motor by counted steps, at most 255 at a time.
    fn steps(&mut self, motor: u8, steps: i32) -> Result<String, String> {
        let table = self.table;
        let mut left = steps;
        let mut how = String::new();
        while left != 0 {
            let count = u8::try_from(left.unsigned_abs().min(255)).unwrap_or(u8::MAX);
            let delta = i32::from(count) * left.signum();
            let from = self.position()?;
            self.command(&[
                table.steps,
                letter(&table, motor, left > 0),
                count,
                table.run,
            ])?;
            // At least 64 steps a second, and a take-up of 200 steps before them.
            let longest = Duration::from_secs_f64((f64::from(count) + 250.0) / 64.0);
            how = self.finished(longest, Report::Done)?;
            if let [Some(from), Some(to)] = [from, self.position()?] {
                let moved = |motor| {
                    let place = |at: [i32; 4]| at.get(usize::from(motor)).copied().unwrap_or(0);
                    place(to).wrapping_sub(place(from))
                };
                if moved(motor) != delta {
                    return Err(format!(
                        "the motor made {} instead of {delta}",
                        counted(moved(motor), "step")
                    ));
                }
            }
            left -= delta;
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
        // A jog that a switch has ended still backs off the switch. A stop would interrupt that.
        if !self.answers || (turns && self.ask()?.report.is_none()) {
            self.send(self.table.stop)?;
        }
        if self.stop.is_asked() {
            return Err("stopped".into());
        }
        self.finished(Duration::ZERO, Report::Stopped)
            .or_else(|error| {
                // The host or the line was slow. So the jog was shorter, and the result reports
                // that.
                if error == device::text(Report::DeadMan) {
                    Ok(error)
                } else {
                    Err(error)
                }
            })
    }

    /// Sends bytes that the device must all accept.
    fn command(&mut self, bytes: &[u8]) -> Result<(), String> {
        self.talk(|client| {
            for byte in bytes {
                if client.send(*byte)? == Answer::Rejected {
                    return Err(format!(
                        "the device rejects {}",
                        char::from(*byte).escape_default()
                    ));
                }
            }
            Ok(())
        })
    }

    /// Waits until nothing moves. Returns how the motion ended. For a device that does not answer,
    /// it waits the longest time.
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

    /// The position of a device that answers, in load steps.
    fn position(&mut self) -> Result<Option<[i32; 4]>, String> {
        Ok(match self.answers {
            true => Some(self.ask()?.position_steps),
            false => None,
        })
    }

    /// Asks for the status, several times if needed.
    fn ask(&mut self) -> Result<Status, String> {
        let status = self.talk(|client| {
            let waits = client.waits;
            let status = client.ask_again(waits);
            client.waits = waits;
            status
        })?;
        let was_homed = std::mem::replace(&mut self.is_homed, status.is_homed);
        if was_homed && !status.is_homed && status.report != Some(Report::Emergency) {
            return Err("the device was reset: home it again".into());
        }
        Ok(status)
    }

    /// Asks a device that has homed where its switches closed. Returns a sentence if steps were
    /// lost since the previous homing. `None`: no steps were lost, or there is nothing to compare.
    fn lost(&mut self) -> Result<Option<String>, String> {
        if !self.answers {
            return Ok(None);
        }
        let Switches {
            are_compared,
            lost_steps: [x, y, z],
        } = self.talk(Self::ask_for_switches)?;
        let is_lost = [x, y, z]
            .iter()
            .any(|lost| lost.unsigned_abs() >= LEAST_LOSS_STEPS);
        Ok((are_compared && is_lost).then(|| {
            format!(
                "before homing the motors were x {x:+} y {y:+} z {z:+} steps from where they were \
                 reported: since the last homing steps were lost. Measure what was made in between"
            )
        }))
    }

    /// Asks until there is an answer. The device is at rest, so no lease runs. A device that does
    /// not know the question compares nothing.
    fn ask_for_switches(&mut self) -> Result<Switches, String> {
        let mut trouble = String::new();
        for _ in 0..TRIES {
            let answer = self.send(self.table.switches).and_then(|answer| {
                if answer == Answer::Rejected {
                    return Ok(Switches::default());
                }
                Switches::of(&self.block::<SWITCHES_BYTES>()?).ok_or_else(|| NOISY.into())
            });
            match answer {
                Ok(switches) => return Ok(switches),
                Err(error) => trouble = error,
            }
            // The answer to an earlier question may be late.
            self.answers_to(0)?;
        }
        Err(trouble)
    }

    /// Asks until there is an answer. All tries but the last end early enough to renew the lease.
    fn ask_again(&mut self, waits: Waits) -> Result<Status, String> {
        let mut last = String::new();
        for attempt in 1..=TRIES {
            self.waits = match attempt {
                TRIES => waits,
                _ => waits.within_lease(self.lease),
            };
            match self.ask_once() {
                Ok(status) => {
                    if attempt > 1 {
                        // The answer to an earlier question may be late.
                        self.answers_to(0)?;
                    }
                    return Ok(status);
                }
                Err(error) => last = error,
            }
            self.answers_to(0)?;
        }
        Err(last)
    }

    fn ask_once(&mut self) -> Result<Status, String> {
        if self.send(self.table.ask)? == Answer::Rejected {
            return Err("the device does not report its position".into());
        }
        Status::of(&self.block::<STATUS_BYTES>()?).ok_or_else(|| NOISY.into())
    }

    /// The bytes that follow an answer.
    fn block<const N: usize>(&mut self) -> Result<[u8; N], String> {
        let mut bytes = [0; N];
        for byte in &mut bytes {
            *byte = self
                .get(self.waits.answer)?
                .ok_or("the answer was cut off")?;
        }
        Ok(bytes)
    }

    /// Sends a byte and waits for its answer. If the device does not answer, it waits for the time
    /// of the byte.
    fn send(&mut self, byte: u8) -> Result<Answer, String> {
        self.put(byte)?;
        if !self.answers {
            self.pause(Duration::from_millis(2))?;
            return Ok(Answer::Taken);
        }
        match self.get(self.waits.answer)? {
            Some(answer) if answer == byte && byte != REJECTED => Ok(Answer::Taken),
            // A data byte may equal the rejection. It counts as accepted, because the check at the
            // end of the command reveals an error.
            Some(REJECTED) if byte == REJECTED => Ok(Answer::Taken),
            Some(REJECTED) => Ok(Answer::Rejected),
            Some(other) => Err(format!(
                "sent {byte:#04x} and {other:#04x} came back: the line is noisy, or this is \
                 another device"
            )),
            None => Err("no answer: unplugged, switched off, or a byte was lost".into()),
        }
    }

    fn pause(&mut self, time: Duration) -> Result<(), String> {
        let end = self.wire.elapsed() + time;
        while self.wire.elapsed() < end && (self.answers || !self.stop.is_asked()) {
            // The wait for a device that does not answer may be long, so Ctrl-C is checked
            // meanwhile.
            let left = end.saturating_sub(self.wire.elapsed()).min(AGAIN);
            if self.turn.is_some() && !self.has_turn {
                // Bytes that arrive now are for the other client.
                std::thread::sleep(left);
                continue;
            }
            if let Some(byte) = self.get(left)? {
                return Err(format!("unexpected byte {byte:#04x}"));
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

/// Locks the turn. A thread that panicked leaves a valid value in it.
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

/// The position of a device as text. A device that is not homed does not know its position. It has
/// only its counters.
fn place(status: &Status) -> String {
    let [x, y, z, spindle] = status.position_steps;
    let counters = format!("x {x} y {y} z {z} spindle {spindle} steps");
    match status.is_homed {
        true => format!("{counters}, from home"),
        false => format!("position unknown: not homed; its counters are at {counters}"),
    }
}

/// The position of a device as text, to follow the report of a failure.
fn standing(status: &Status) -> String {
    match status.is_homed {
        true => format!("it stands at {}", place(status)),
        false => place(status),
    }
}

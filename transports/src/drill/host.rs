//! The host's end of the line.

use super::device::check;
use super::{
    AT_WORK, EMPTY, END_OF_TEXT, ENDING, EXPIRED, FAULT, Failure, KEPT, LEASE, NOT_ALL, Outcome,
    Progress, Refused, Step, Timing, WORKING,
};

/// Bytes that bring any device to rest. Four `f` complete any record and reach the position at
/// which `f` ends a program. `Q` leaves the manual mode. An idle device ignores all of them. `B` is
/// the test. A device that receives a program echoes it as well, and one wrong bit in an `f` gives
/// `b`, which begins a program. Therefore a last `Q` follows, because only an idle device does not
/// answer it.
const RESYNC: [u8; 7] = [b'f', b'f', b'f', b'f', b'Q', b'B', b'Q'];

/// The largest number of bytes that a device can hold beyond the echoed ones when a failure is
/// noticed: one that was doubled, one whose echo is missing, and the four `f` of [`RESYNC`].
const BEYOND: u32 = 6;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Mode {
    Unknown,
    Idle,
    /// Number of bytes since `b`.
    Download(u32),
    Manual,
}

/// What the host waits for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Phase {
    Idle,
    /// A byte waits to be sent.
    Send(u8),
    /// The host waits for the answer to this byte.
    Answer(u8),
    /// The host still waits for the answer after the usual time.
    Late,
    /// The host waits for the echo that follows a `w`.
    Border,
    /// The host waits for what follows the answer. This is a record, of which this many bytes have
    /// arrived, or a text.
    Record(u8),
    Text,
    /// The host waits for silence after the answer.
    Guard,
    /// The byte with this number is next. Answers to earlier bytes are dropped.
    Resync(u8),
    Boot,
    Over(Outcome),
}

/// The host's end of the drill's line: one [`Step`] at a time.
///
/// | when | call |
/// | --- | --- |
/// | a step is to begin | [`start`](Host::start) |
/// | the port takes bytes | [`transmit`](Host::transmit) |
/// | a byte arrives | [`push`](Host::push) |
/// | after each of these, and after the time that it returns | [`poll`](Host::poll) |
///
/// [`done_bytes`](Host::done_bytes) have certainly been done, and
/// [`begun_bytes`](Host::begun_bytes) may have been begun. After a failure the operator checks the
/// board between these two. `now_us` wraps. Calls may be up to 2^31 us apart.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Host {
    timing: Timing,
    memory_bytes: u32,
    step: Step,
    mode: Mode,
    phase: Phase,
    /// The expected answer.
    answer: u8,
    /// The next bytes of a step with several parts, and the bytes that the device sends after them.
    then: [Option<u8>; 2],
    last: Option<u8>,
    /// The record that was read last.
    record: [u8; 3],
    /// Tries left for this byte.
    tries: u8,
    /// Number of additional answers that may arrive because the byte was repeated.
    repeats: u8,
    since_us: u32,
    wait_us: u32,
    /// Number of bytes stored since the program was cleared.
    stored: u32,
    /// Whether nothing was stored since the program was cleared.
    is_clear: bool,
    /// Whether the program has its end and can run.
    is_whole: bool,
    done: u32,
    begun: u32,
    stops: bool,
    /// Whether the host has asked if a program runs, and whether the device has confirmed it.
    asks_at_work: bool,
    is_at_work: bool,
    /// The lease that the device has confirmed; 0 without a lease.
    lease: u8,
    /// A byte that arrived while the host waited for none.
    unasked: Option<u8>,
    heard: Option<u8>,
}

impl Host {
    /// Creates a host for a device in an unknown state, whose memory holds this many bytes. The
    /// original holds [`MEMORY_BYTES`](super::MEMORY_BYTES).
    pub const fn new(timing: Timing, memory_bytes: u32) -> Host {
        Host {
            timing,
            memory_bytes,
            step: Step::Resync,
            mode: Mode::Unknown,
            phase: Phase::Idle,
            answer: 0,
            then: [None; 2],
            last: None,
            record: [0; 3],
            tries: 0,
            repeats: 0,
            since_us: 0,
            wait_us: 0,
            stored: 0,
            is_clear: false,
            is_whole: false,
            done: 0,
            begun: 0,
            stops: false,
            asks_at_work: false,
            is_at_work: false,
            lease: 0,
            unasked: None,
            heard: None,
        }
    }

    /// Begins a step. The step fails at once if an unexpected byte has arrived before it.
    ///
    /// # Errors
    /// [`Refused`]. In this case nothing is sent.
    pub fn start(&mut self, step: Step, now_us: u32) -> Result<(), Refused> {
        if self.phase != Phase::Idle {
            return Err(Refused::Busy);
        }
        let byte = self.first_byte(step)?;
        self.step = step;
        (self.stops, self.repeats) = (false, 0);
        (self.asks_at_work, self.is_at_work) = (false, false);
        self.answer = if step == Step::Quit { b'm' } else { byte };
        (self.then, self.last) = match step {
            Step::Manual(advance) | Step::ManualKept(advance) => {
                ([Some(advance), None], Some(b'm'))
            }
            Step::Advance(advance) => ([Some(advance), None], None),
            Step::Lease(units) => ([Some(units), None], None),
            Step::Read(number) => (number.to_le_bytes().map(Some), None),
            _ => ([None; 2], None),
        };
        let is_harmless = matches!(step, Step::Test | Step::Clear | Step::Empty);
        self.tries = if self.timing.resends_anything || is_harmless {
            self.timing.tries.max(1)
        } else {
            1
        };
        let unasked = self.unasked.take();
        match step {
            Step::Resync | Step::AwaitBoot => {
                self.lose();
                self.heard = None;
                let (phase, wait_us) = match step {
                    Step::Resync => (Phase::Resync(0), 0),
                    _ => (Phase::Boot, self.timing.home_us),
                };
                self.wait(phase, wait_us, now_us);
            }
            _ => match unasked {
                Some(b'B') => self.fail(Failure::Restarted),
                Some(FAULT) => self.fail(Failure::Fault),
                Some(byte) => self.fail(Failure::Unasked(byte)),
                None => self.phase = Phase::Send(byte),
            },
        }
        Ok(())
    }

    /// Returns the byte that asks the device to stop a program after the present record. The step
    /// then ends as stopped. Returns `None` if nothing runs. While a full memory is run, only a
    /// device with [`Rules::stops_at_border`](super::Rules::stops_at_border) receives this byte.
    pub fn stop(&mut self) -> Option<u8> {
        let runs = match self.phase {
            Phase::Answer(_) | Phase::Late => self.step == Step::Execute,
            phase => phase == Phase::Border,
        };
        self.stops |= runs;
        runs.then_some(b'E')
    }

    /// Returns the byte that asks a device with extras whether the program runs. With a lease it
    /// asks whether anything moves. The device answers at once: see
    /// [`is_at_work`](Self::is_at_work). Returns `None` if this step moves nothing, or if it has
    /// ended.
    pub fn ask_at_work(&mut self) -> Option<u8> {
        let waits = matches!(self.phase, Phase::Answer(_) | Phase::Late);
        let is_last = self.then == [None; 2] && self.last.is_none();
        let is_heard = self.step == Step::Execute || self.lease > 0 && self.moves();
        self.asks_at_work = waits && is_last && is_heard;
        self.is_at_work = false;
        self.asks_at_work.then_some(AT_WORK)
    }

    /// Whether the device has confirmed, since the last question, that the program runs.
    pub const fn is_at_work(&self) -> bool {
        self.is_at_work
    }

    /// Gives up the present step. The device is then in an unknown state, as after a failure.
    pub fn give_up(&mut self) {
        if self.phase != Phase::Idle {
            self.lose();
            self.phase = Phase::Idle;
        }
    }

    /// Restarts the present wait, for work that takes longer than 2^31 us.
    pub const fn wait_on(&mut self, now_us: u32) {
        self.since_us = now_us;
    }

    /// Returns the next byte for the line. Returns `None` if there is none now.
    pub fn transmit(&mut self, now_us: u32) -> Option<u8> {
        match self.phase {
            Phase::Send(byte) => {
                self.wait(Phase::Answer(byte), self.answer_us(), now_us);
                if matches!(self.step, Step::Execute | Step::Key(b'e')) {
                    self.begun = self.stored;
                }
                Some(byte)
            }
            Phase::Resync(number) if self.left_us(now_us) == 0 => {
                let byte = RESYNC.get(usize::from(number)).copied()?;
                let next = Phase::Resync(number.wrapping_add(1)); // 7 at most
                if usize::from(number).wrapping_add(1) == RESYNC.len() {
                    // The answer to the test, or none.
                    match self.heard {
                        Some(b'B') => {}
                        Some(FAULT) => return self.end_resync(Failure::Fault),
                        Some(other) => return self.end_resync(Failure::Wrong(other)),
                        None => return self.end_resync(Failure::Silent),
                    }
                }
                self.heard = None;
                self.wait(next, self.timing.pause_us, now_us);
                Some(byte)
            }
            _ => None,
        }
    }

    /// Takes a byte from the line.
    pub fn push(&mut self, byte: u8, now_us: u32) {
        match self.phase {
            Phase::Answer(_) | Phase::Late => self.hear(byte, now_us),
            Phase::Border if self.stops && byte == b'E' => {
                self.lose();
                self.phase = Phase::Over(Outcome::Stopped);
            }
            Phase::Border if byte == EXPIRED && byte != self.answer => self.expire(),
            Phase::Border if byte == self.answer => {
                self.done = self.begun;
                self.settle(now_us);
            }
            Phase::Guard if byte == self.answer && self.repeats > 0 => {
                self.repeats = self.repeats.saturating_sub(1);
            }
            Phase::Record(count) => self.hear_record(byte, count, now_us),
            Phase::Text if byte == END_OF_TEXT => self.conclude(now_us),
            Phase::Text => self.wait(Phase::Text, self.pause_us(), now_us),
            Phase::Border | Phase::Guard if byte == b'B' => self.fail(Failure::Restarted),
            Phase::Border | Phase::Boot if byte == FAULT => self.fail(Failure::Fault),
            Phase::Border => self.fail(Failure::Wrong(byte)),
            Phase::Guard => self.fail(Failure::Unasked(byte)),
            Phase::Boot if byte == b'B' => {
                (self.stored, self.lease) = (0, 0);
                self.mode = Mode::Idle;
                self.phase = Phase::Over(Outcome::Done);
            }
            Phase::Resync(_) => self.heard = Some(byte),
            Phase::Idle | Phase::Send(_) | Phase::Over(_) => self.unasked = Some(byte),
            Phase::Boot => {}
        }
    }

    /// Continues the step as far as time and bytes allow.
    pub fn poll(&mut self, now_us: u32) -> Progress {
        let left_us = self.left_us(now_us);
        match self.phase {
            Phase::Idle => return Progress::Idle,
            Phase::Send(_) => return Progress::Sending,
            Phase::Over(_) => {}
            _ if left_us > 0 => return Progress::Waiting { us: left_us },
            Phase::Resync(number) if usize::from(number) < RESYNC.len() => {
                return Progress::Sending;
            }
            Phase::Resync(_) => match self.heard {
                None => {
                    self.mode = Mode::Idle;
                    self.phase = Phase::Over(Outcome::Done);
                }
                Some(b'B') => self.fail(Failure::Restarted),
                Some(FAULT) => self.fail(Failure::Fault),
                Some(other) => self.fail(Failure::Wrong(other)),
            },
            Phase::Guard => self.phase = Phase::Over(Outcome::Done),
            Phase::Answer(sent) if self.tries > 1 => {
                self.tries = self.tries.saturating_sub(1);
                self.repeats = self.repeats.saturating_add(1);
                self.phase = Phase::Send(sent);
                return Progress::Sending;
            }
            Phase::Answer(_) if self.timing.late_us > 0 => {
                self.wait(Phase::Late, self.timing.late_us, now_us);
                return Progress::Waiting {
                    us: self.left_us(now_us),
                };
            }
            Phase::Answer(_)
            | Phase::Late
            | Phase::Record(_)
            | Phase::Text
            | Phase::Border
            | Phase::Boot => {
                self.fail(Failure::Silent);
            }
        }
        let Phase::Over(outcome) = self.phase else {
            return Progress::Idle; // every arm above has ended the step
        };
        self.phase = Phase::Idle;
        Progress::Done(outcome)
    }

    /// Returns the number of bytes stored since the program was cleared.
    pub const fn stored_bytes(&self) -> u32 {
        self.stored
    }

    /// Returns the number of program bytes that the device has certainly done since the program was
    /// cleared, in whole records.
    pub const fn done_bytes(&self) -> u32 {
        self.done
    }

    /// Returns the number of bytes that the device may have done. It exceeds
    /// [`done_bytes`](Self::done_bytes) only while a program runs and after a failure.
    pub const fn begun_bytes(&self) -> u32 {
        self.begun
    }

    /// Returns the record that [`Step::Read`] has read: letter, low and high byte.
    pub const fn record(&self) -> [u8; 3] {
        self.record
    }

    fn first_byte(&self, step: Step) -> Result<u8, Refused> {
        let (byte, mode) = match step {
            Step::Resync | Step::AwaitBoot => return Ok(0),
            Step::Test => (b'B', Mode::Idle),
            Step::Lease(_) => (LEASE, Mode::Idle),
            Step::Empty => (EMPTY, Mode::Idle),
            Step::Clear => (b'c', Mode::Idle),
            Step::Home => (b'r', Mode::Idle),
            Step::Begin => (b'b', Mode::Idle),
            Step::Execute => (b'e', Mode::Idle),
            Step::Manual(_) => (b'm', Mode::Idle),
            Step::ManualKept(_) => (KEPT, Mode::Idle),
            Step::Key(byte) => (byte, Mode::Manual),
            Step::Advance(_) => (b'a', Mode::Manual),
            Step::Teach => (b'T', Mode::Manual),
            Step::Quit => (b'Q', Mode::Manual),
            Step::Spindle(on) => (if on { b'O' } else { b'S' }, Mode::Idle),
            Step::Read(_) if self.mode == Mode::Manual => (b'n', Mode::Manual),
            Step::Read(_) => (b'n', Mode::Idle),
            Step::Help => (b'?', Mode::Idle),
            Step::Store(byte) => (byte, self.download()?),
            Step::End => (b'f', self.download()?),
        };
        let is_at_end = matches!(
            self.mode,
            Mode::Download(count) if count > 0 && count.checked_rem(3) == Some(0),
        );
        match step {
            _ if mode != self.mode => Err(Refused::Mode),
            // These are steps of their own.
            Step::Key(b'a' | b'Q' | b'T' | b'n') => Err(Refused::Mode),
            // With one wrong bit, `m` is `e`.
            Step::Begin | Step::Manual(_) if !self.is_clear => Err(Refused::NotCleared),
            Step::End if !is_at_end => Err(Refused::Incomplete),
            Step::Store(_) if self.lease > 0 && self.is_at_border() => Err(Refused::Leased),
            // This byte would end the program here.
            Step::Store(b'f') if is_at_end => Err(Refused::Incomplete),
            Step::Execute if !self.is_whole => Err(Refused::Incomplete),
            _ => Ok(byte),
        }
    }

    /// Whether the memory of the device is full.
    fn is_at_border(&self) -> bool {
        self.stored > 0 && self.stored.checked_rem(self.memory_bytes) == Some(0)
    }

    fn download(&self) -> Result<Mode, Refused> {
        match self.mode {
            Mode::Download(_) => Ok(self.mode),
            _ => Err(Refused::Mode),
        }
    }

    /// Returns the longest time until the answer to the next byte.
    fn answer_us(&self) -> u32 {
        match self.step {
            Step::Execute | Step::Key(b'e') => self.timing.run_us,
            Step::Home | Step::Key(_) => self.timing.home_us,
            _ => self.timing.echo_us,
        }
    }

    fn hear(&mut self, byte: u8, now_us: u32) {
        let is_border = matches!(self.step, Step::Store(_)) && self.is_at_border();
        // A wrong bit in the answer to a question is harmless.
        let is_like = |answer: u8| (byte ^ answer).count_ones() <= 1;
        if is_border && byte == b'w' {
            self.begun = whole(self.stored);
            self.wait(Phase::Border, self.timing.run_us, now_us);
        } else if byte == self.answer && !is_border {
            self.settle(now_us);
        } else if byte == b'B' {
            self.fail(Failure::Restarted);
        } else if byte == EXPIRED && self.moves() {
            self.expire();
        } else if self.asks_at_work && (is_like(WORKING) || is_like(ENDING)) {
            self.is_at_work = true;
        } else if byte == FAULT && self.moves() {
            self.fail(Failure::Fault);
        } else if byte == NOT_ALL && self.step == Step::Teach {
            self.phase = Phase::Over(Outcome::Failed(Failure::Full));
        } else if byte == NOT_ALL && matches!(self.step, Step::Key(_)) {
            self.phase = Phase::Over(Outcome::Failed(Failure::NotAll));
        } else {
            self.fail(Failure::Wrong(byte));
        }
    }

    fn expire(&mut self) {
        self.lease = 0;
        self.fail(Failure::Expired);
    }

    /// Whether the step moves the machine, so that the machine may report a fault.
    const fn moves(&self) -> bool {
        matches!(
            self.step,
            Step::Home | Step::Execute | Step::Key(_) | Step::Manual(_) | Step::ManualKept(_)
        )
    }

    /// Takes a byte of a record. The fourth one is its check.
    fn hear_record(&mut self, byte: u8, count: u8, now_us: u32) {
        let wanted = check(self.record);
        match self.record.get_mut(usize::from(count)) {
            Some(place) => {
                *place = byte;
                let next = Phase::Record(count.wrapping_add(1)); // 3 at most
                self.wait(next, self.pause_us(), now_us);
            }
            None if byte == wanted => {
                let [letter, ..] = self.record;
                if self.step == Step::Read(0) && matches!(letter, b'X' | b'Y' | b'Z') {
                    // The device has a program. The caller decides whether it is complete.
                    (self.is_whole, self.is_clear) = (true, false);
                }
                self.conclude(now_us);
            }
            None => self.fail(Failure::Wrong(byte)),
        }
    }

    /// Returns the longest pause between bytes that the device sends one after the other.
    const fn pause_us(&self) -> u32 {
        self.timing.echo_us.saturating_add(self.timing.late_us)
    }

    /// Acts on the answer: sends the next byte, waits for the next answer, or ends the step.
    fn settle(&mut self, now_us: u32) {
        let [next, after] = self.then;
        if let Some(next) = next {
            self.then = [after, None];
            self.answer = next;
            self.phase = Phase::Send(next);
            return;
        }
        if let Some(last) = self.last.take() {
            self.answer = last;
            self.tries = 1;
            return self.wait(Phase::Answer(last), self.timing.home_us, now_us);
        }
        match self.step {
            Step::Read(_) => return self.wait(Phase::Record(0), self.pause_us(), now_us),
            Step::Help => return self.wait(Phase::Text, self.pause_us(), now_us),
            Step::Teach => {
                self.stored = self.stored.saturating_add(9);
                (self.is_clear, self.is_whole) = (false, true);
            }
            Step::Lease(units) => self.lease = units,
            Step::Clear | Step::Empty | Step::Key(b'c') => {
                (self.stored, self.done, self.begun) = (0, 0, 0);
                (self.is_clear, self.is_whole) = (true, false);
            }
            Step::Begin => {
                self.mode = Mode::Download(0);
                self.is_clear = false;
            }
            Step::Store(_) => {
                if let Mode::Download(count) = self.mode {
                    self.mode = Mode::Download(count.saturating_add(1)); // 4 GB take 200 days
                    self.stored = self.stored.saturating_add(1);
                }
            }
            Step::End => (self.mode, self.is_whole) = (Mode::Idle, true),
            Step::Quit => self.mode = Mode::Idle,
            Step::Manual(_) | Step::ManualKept(_) => self.mode = Mode::Manual,
            Step::Execute if self.stops => {
                self.phase = Phase::Over(Outcome::Stopped);
                return;
            }
            Step::Execute => {
                self.done = self.begun;
                // If the program was longer than the memory, the device holds only its end.
                self.is_whole = self.stored <= self.memory_bytes;
            }
            _ => {}
        }
        self.conclude(now_us);
    }

    /// Waits for the silence after the last answer.
    fn conclude(&mut self, now_us: u32) {
        let guard_us = if self.repeats > 0 {
            // A repeated byte may be answered once more.
            self.timing.guard_us.saturating_add(self.timing.late_us)
        } else {
            self.timing.guard_us
        };
        if guard_us > 0 && !matches!(self.step, Step::Store(_)) {
            self.wait(Phase::Guard, guard_us, now_us);
        } else {
            self.phase = Phase::Over(Outcome::Done);
        }
    }

    /// Drops the bytes that are not sent yet.
    fn end_resync(&mut self, failure: Failure) -> Option<u8> {
        self.fail(failure);
        None
    }

    fn fail(&mut self, failure: Failure) {
        if failure == Failure::Restarted {
            self.lease = 0;
        }
        self.lose();
        self.phase = Phase::Over(Outcome::Failed(failure));
    }

    /// Ends the step with a failure. The state of the device is unknown from now on.
    fn lose(&mut self) {
        if let Mode::Download(_) = self.mode {
            let border = self
                .stored
                .checked_div(self.memory_bytes)
                .unwrap_or_default()
                .saturating_add(1)
                .saturating_mul(self.memory_bytes);
            if self.is_at_border() {
                self.begun = self.begun.max(whole(self.stored));
            }
            if self.stored.saturating_add(BEYOND) > border {
                self.begun = whole(border);
            }
        }
        self.mode = Mode::Unknown;
        (self.is_clear, self.is_whole) = (false, false);
    }

    /// Starts a wait of `us` from now on. If a byte is on the line, its time is added.
    fn wait(&mut self, phase: Phase, us: u32, now_us: u32) {
        self.phase = phase;
        self.since_us = now_us;
        let is_sent = matches!(phase, Phase::Answer(_)) || matches!(phase, Phase::Resync(1..));
        let flight_us = if is_sent { self.timing.character_us } else { 0 };
        self.wait_us = us.saturating_add(flight_us).min(i32::MAX as u32);
    }

    fn left_us(&self, now_us: u32) -> u32 {
        self.wait_us
            .saturating_sub(now_us.wrapping_sub(self.since_us))
    }
}

/// Returns the number of bytes in whole records.
fn whole(bytes: u32) -> u32 {
    bytes.wrapping_sub(bytes.checked_rem(3).unwrap_or_default()) // at most `bytes`
}

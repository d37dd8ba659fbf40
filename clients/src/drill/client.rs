//! The host's side of the drill's link: one step after another, on a wire.

use crate::{StopRequests, Wire};
use husillo_sim::device::drill::Device;
use husillo_transports::drill::{
    AT_WORK, COUNT, Failure, Host, MEMORY_BYTES, Outcome, Progress, Refused, Step, Timing,
};
use std::time::Duration;

/// The longest wait between two checks for a request to stop.
const LOOK: Duration = Duration::from_millis(20);
/// A step that takes longer has failed. During a run the host extends the wait up to the caller's
/// own limit.
const RUN_US: u32 = 30_000_000;
/// A drill that runs a program answers within this time.
const AT_WORK_ANSWER: Duration = Duration::from_millis(400);
/// Number of queries whether a drill runs a program.
const ASKED: usize = 4;
/// Period of the queries to a drill that runs a program.
const ASK: Duration = Duration::from_secs(1);
/// After this number of queries without an answer the drill counts as absent.
const UNANSWERED: u32 = 5;
/// A drill that is stopped completes its record first: a move of the table, or a drilling.
const RECORD: Duration = Duration::from_secs(180);

/// Why a step has failed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Trouble {
    /// The link failed, or the device reports a fault.
    Link(Failure),
    /// Stopped on request.
    Stopped,
    /// The device runs a program without a host.
    AtWork,
    /// The port failed, for this reason.
    Port(String),
    /// The device cannot do this now.
    Refused(Refused),
}

impl Trouble {
    /// A sentence.
    pub fn text(&self) -> String {
        match self {
            Trouble::Link(Failure::Silent) => {
                "no answer: the drill is off, unplugged or stopped because of a fault, or a byte \
                 was lost"
                    .into()
            }
            Trouble::Link(Failure::Wrong(byte)) => {
                format!(
                    "{byte:#04x} came back for another byte: the line is noisy, or the device is \
                     no drill"
                )
            }
            Trouble::Link(Failure::Unasked(byte)) => {
                format!("unexpected byte {byte:#04x}: a byte was doubled on the line")
            }
            Trouble::Link(Failure::Restarted) => {
                "the drill was reset: it has homed, and its program is lost".into()
            }
            Trouble::Link(Failure::Fault) => {
                "the drill has stopped because of a fault, which its panel shows: steps were lost, \
                 a switch or a sensor does not work, or a position is off the table. Repair it, \
                 then press its button R"
                    .into()
            }
            Trouble::Link(Failure::NotAll) => {
                "the axis reached its end before all steps were made".into()
            }
            Trouble::Link(Failure::Full) => {
                "the drill's memory has no room for another hole".into()
            }
            Trouble::Stopped => "stopped".into(),
            Trouble::AtWork => "the drill runs its program".into(),
            Trouble::Port(why) => format!("the port failed: {why}"),
            Trouble::Refused(refused) => format!("not done: {refused}"),
        }
    }
}

impl Trouble {
    /// A sentence about a drill that does not answer from the start, and what to do.
    pub fn unreached(&self) -> String {
        match self {
            Trouble::Link(_) => format!(
                "{}. Is it still at work? Otherwise press its button R, wait until it has homed, \
                 and try again",
                self.text()
            ),
            Trouble::AtWork => format!(
                "{}. Wait until it has ended, or end it: `husillo stop -m drill --port PORT`",
                self.text()
            ),
            _ => self.text(),
        }
    }
}

/// The host at its end of the link.
#[derive(Debug)]
pub struct Client {
    wire: Wire<Device>,
    host: Host,
    stop: StopRequests,
    /// The answer of the device in a step whose answer is a text.
    text: Vec<u8>,
    has_extras: bool,
}

impl Client {
    /// Opens a port, or a simulated drill at `sim`.
    ///
    /// # Errors
    ///
    /// A sentence about the port.
    pub fn open(port: &str, bits_per_s: u32, stop: StopRequests) -> Result<Self, String> {
        let wire = if port == "sim" {
            Wire::simulated(Device::new(bits_per_s, false))
        } else {
            Wire::open(port, bits_per_s).map_err(|error| format!("{port}: {error}"))?
        };
        Ok(Self::new(wire, bits_per_s, stop))
    }

    /// A client on a wire of this rate. It stops when a stop is requested.
    pub fn new(wire: Wire<Device>, bits_per_s: u32, stop: StopRequests) -> Self {
        let mut timing = Timing::of(bits_per_s, RUN_US);
        if matches!(wire, Wire::Real { .. }) {
            // A computer and its adapter may sleep for longer than a character.
            timing.echo_us += 500_000;
            timing.guard_us += 30_000;
        }
        Self {
            wire,
            host: Host::new(timing, MEMORY_BYTES as u32),
            stop,
            text: Vec::new(),
            has_extras: false,
        }
    }

    /// Time on the wire since it was opened.
    pub fn elapsed(&self) -> Duration {
        self.wire.elapsed()
    }

    /// What a simulated device has reported since the last call.
    pub fn take_reports(&mut self) -> Vec<String> {
        self.wire.take_reports()
    }

    /// The simulated device, if there is one.
    pub fn device(&mut self) -> Option<&mut Device> {
        match &mut self.wire {
            Wire::Simulated { device, .. } => Some(device),
            Wire::Real { .. } => None,
        }
    }

    /// Whether the device has the extras that the original lacks.
    pub const fn has_extras(&self) -> bool {
        self.has_extras
    }

    /// Bytes of the program that are done for certain, and that may have been begun.
    pub const fn done_and_begun(&self) -> [u32; 2] {
        [self.host.done_bytes(), self.host.begun_bytes()]
    }

    /// Whether the operator has requested a stop.
    pub fn is_stopping(&self) -> bool {
        self.stop.is_asked()
    }

    /// Brings the device to rest from any state but a running program, and finds out whether it
    /// has extras.
    ///
    /// # Errors
    ///
    /// [`Trouble::AtWork`]: it runs a program, and says so. Another: it does not answer within
    /// about seven seconds. It is off or absent, it homes, or it is an original at work.
    pub fn reach(&mut self) -> Result<(), Trouble> {
        let mut last = Trouble::Link(Failure::Silent);
        // A byte of the manual mode may make it home first.
        for _ in 0..10 {
            match self.run(Step::Resync) {
                Ok(()) => {
                    self.has_extras = self.run(Step::Read(COUNT)).is_ok();
                    if self.has_extras {
                        return Ok(());
                    }
                    // The original does not answer that.
                    return self.run(Step::Resync);
                }
                Err(Trouble::Link(Failure::Silent)) if self.says_at_work()? => {
                    return Err(Trouble::AtWork);
                }
                Err(Trouble::Link(failure)) => last = Trouble::Link(failure),
                Err(trouble) => return Err(trouble),
            }
        }
        Err(last)
    }

    /// Ends a program that the device runs alone, and brings the device to rest. The spindle of a
    /// device with extras stops too.
    ///
    /// The device completes its present record first: a drilling, or a move over the whole table
    /// (95 s). `wait` gets the longest time that is waited for it, if the device does not answer
    /// at once.
    ///
    /// # Errors
    ///
    /// The device does not answer in that time: it is off, absent or stopped because of a fault.
    /// [`Trouble::Stopped`]: the operator does not wait.
    pub fn end_program(&mut self, wait: impl FnOnce(Duration)) -> Result<(), Trouble> {
        // One wrong bit in an `E` makes an `e`, which runs a program. So only a device that answers
        // nothing else gets it.
        match self.run(Step::Resync) {
            Err(Trouble::Link(Failure::Silent)) => {}
            Err(trouble @ Trouble::Port(_)) => return Err(trouble),
            _ => return self.reach(),
        }
        wait(RECORD);
        self.put(b'E')?;
        let end = self.elapsed() + RECORD;
        let mut ask_at = self.elapsed() + ASK;
        while self.elapsed() < end {
            let byte = self.wire.receive(LOOK);
            let byte = byte.map_err(|error| Trouble::Port(error.to_string()))?;
            if byte == Some(b'e') {
                return self.reach();
            }
            if self.is_stopping() {
                return Err(Trouble::Stopped);
            }
            if self.elapsed() < ask_at {
                continue;
            }
            // The `E` may be lost, and the program may have ended before it.
            if self.run(Step::Resync).is_ok() {
                return self.reach();
            }
            if self.says_at_work()? {
                self.put(b'E')?;
            }
            ask_at = self.elapsed() + 5 * ASK;
        }
        Err(Trouble::Link(Failure::Silent))
    }

    /// Whether the device answers that it runs a program, after a silent [`Step::Resync`]: in the
    /// manual mode it would echo the question. An original never says it.
    fn says_at_work(&mut self) -> Result<bool, Trouble> {
        self.put(AT_WORK)?;
        let end = self.elapsed() + AT_WORK_ANSWER;
        while self.elapsed() < end {
            let byte = self.wire.receive(end - self.elapsed());
            match byte.map_err(|error| Trouble::Port(error.to_string()))? {
                Some(AT_WORK) => return Ok(true),
                // A test follows that finds out more.
                Some(_) => {}
                None => break,
            }
        }
        Ok(false)
    }

    /// Brings the device to rest after a failure. Waits less than [`reach`](Self::reach), as the
    /// device has answered a moment before.
    ///
    /// # Errors
    ///
    /// It does not answer.
    pub fn find_out(&mut self) -> Result<(), Trouble> {
        // The request of the operator has been carried out.
        self.stop.clear();
        let mut last = Ok(());
        for _ in 0..4 {
            last = self.run(Step::Resync);
            if last.is_ok() {
                break;
            }
        }
        last
    }

    /// How many drillings the device has done since its memory was cleared. `None`: the original,
    /// which does not know, or a device after a reset.
    ///
    /// # Errors
    ///
    /// The link failed.
    pub fn drillings(&mut self) -> Result<Option<u16>, Trouble> {
        if !self.has_extras {
            return Ok(None);
        }
        self.run(Step::Read(COUNT))?;
        let [letter, low, high] = self.host.record();
        Ok((letter == b'c').then(|| u16::from_le_bytes([low, high])))
    }

    /// The program in the device's memory, record by record.
    ///
    /// # Errors
    ///
    /// The link failed, or the device does not report its program.
    pub fn program(&mut self) -> Result<Vec<[u8; 3]>, Trouble> {
        let mut records = Vec::new();
        for number in 0..COUNT {
            self.run(Step::Read(number))?;
            let record = self.host.record();
            if record == [b'f', 0, 0] {
                break;
            }
            records.push(record);
        }
        Ok(records)
    }

    /// The device's help.
    ///
    /// # Errors
    ///
    /// The link failed, or the device has no help.
    pub fn help(&mut self) -> Result<String, Trouble> {
        self.text.clear();
        self.run(Step::Help)?;
        // The echo before the text and the mark after it are not part of it.
        let inner = self.text.get(1..self.text.len().max(2) - 1);
        Ok(String::from_utf8_lossy(inner.unwrap_or_default()).into_owned())
    }

    /// A step that takes a few seconds at most.
    ///
    /// # Errors
    ///
    /// See [`Trouble`].
    pub fn run(&mut self, step: Step) -> Result<(), Trouble> {
        self.run_for(step, Duration::ZERO, |_| {})
    }

    /// A step that may take this long. `progress` gets the time since its start.
    ///
    /// # Errors
    ///
    /// See [`Trouble`].
    pub fn run_for(
        &mut self,
        step: Step,
        mut longest: Duration,
        mut progress: impl FnMut(Duration),
    ) -> Result<(), Trouble> {
        let start = self.elapsed();
        let now = self.now_us();
        self.host.start(step, now).map_err(Trouble::Refused)?;
        let mut has_stopped = false;
        let (mut ask_at, mut unanswered) = (start + ASK, 0);
        loop {
            self.transmit()?;
            match self.host.poll(self.now_us()) {
                Progress::Done(Outcome::Done) => return Ok(()),
                Progress::Done(Outcome::Stopped) => return Err(Trouble::Stopped),
                Progress::Done(Outcome::Failed(failure)) => return Err(Trouble::Link(failure)),
                Progress::Idle | Progress::Sending => {}
                Progress::Waiting { us } => {
                    let passed = self.elapsed() - start;
                    // A host waits 30 s for a run. While the run may last, the wait is restarted.
                    if us < RUN_US / 2 && us > 1_000_000 && passed < longest {
                        let now = self.now_us();
                        self.host.wait_on(now);
                    }
                    if self.is_stopping() && !has_stopped {
                        has_stopped = true;
                        if let Some(byte) = self.host.stop() {
                            self.put(byte)?;
                        }
                        if step == Step::Execute {
                            longest = longest.min(passed + RECORD);
                        }
                    }
                    if step == Step::Execute && self.has_extras && self.elapsed() >= ask_at {
                        if self.host.is_at_work() {
                            unanswered = 0;
                        }
                        if unanswered == UNANSWERED {
                            self.host.give_up();
                            return Err(Trouble::Link(Failure::Silent));
                        }
                        if let Some(byte) = self.host.ask_at_work() {
                            self.put(byte)?;
                            unanswered += 1;
                        }
                        ask_at = self.elapsed() + ASK;
                    }
                    self.listen(Duration::from_micros(u64::from(us)).min(LOOK))?;
                    progress(passed);
                }
            }
        }
    }

    /// Starts the program and checks that it runs, without waiting for its end. `false`: the
    /// program has ended already.
    ///
    /// # Errors
    ///
    /// The program did not start, or the device does not confirm its start.
    pub fn start(&mut self) -> Result<bool, Trouble> {
        let now = self.now_us();
        self.host
            .start(Step::Execute, now)
            .map_err(Trouble::Refused)?;
        self.transmit()?;
        for _ in 0..ASKED {
            if let Some(byte) = self.host.ask_at_work() {
                self.put(byte)?;
            }
            let end = self.elapsed() + AT_WORK_ANSWER;
            while self.elapsed() < end {
                self.listen(end - self.elapsed())?;
                match self.host.poll(self.now_us()) {
                    Progress::Done(Outcome::Done) => return Ok(false),
                    Progress::Done(Outcome::Failed(failure)) => return Err(Trouble::Link(failure)),
                    Progress::Done(Outcome::Stopped) => return Err(Trouble::Stopped),
                    _ if self.host.is_at_work() => return Ok(true),
                    _ => {}
                }
            }
        }
        self.host.give_up();
        Err(Trouble::Link(Failure::Silent))
    }

    fn transmit(&mut self) -> Result<(), Trouble> {
        let now = self.now_us();
        match self.host.transmit(now) {
            Some(byte) => self.put(byte),
            None => Ok(()),
        }
    }

    fn put(&mut self, byte: u8) -> Result<(), Trouble> {
        self.wire
            .send(byte)
            .map_err(|error| Trouble::Port(error.to_string()))
    }

    /// Waits for a byte.
    fn listen(&mut self, within: Duration) -> Result<(), Trouble> {
        let byte = self.wire.receive(within);
        if let Some(byte) = byte.map_err(|error| Trouble::Port(error.to_string()))? {
            self.text.push(byte);
            let now = self.now_us();
            self.host.push(byte, now);
        }
        Ok(())
    }

    /// Wraps as the host expects it.
    fn now_us(&self) -> u32 {
        self.wire.elapsed().as_micros() as u32
    }
}

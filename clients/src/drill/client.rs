//! The host's side of the drill's link: one step after another, over a wire.

use super::LEASE_MS;
use crate::{StopRequests, Wire};
use husillo_sim::device::drill::Device;
use husillo_transports::drill::{
    AT_WORK, COUNT, ENDING, FAULT, Failure, Host, LEASE_UNIT_MS, MEMORY_BYTES, Outcome, Progress,
    Reading, Refused, Step, Timing, WORKING,
};
use std::time::Duration;

/// The longest wait between two checks for a request to stop.
const LOOK: Duration = Duration::from_millis(20);
/// A step that takes longer than this has failed. During a run the host extends the wait up to the
/// caller's own limit.
const RUN_US: u32 = 30_000_000;
/// A drill that runs a program answers within this time.
const AT_WORK_ANSWER: Duration = Duration::from_millis(400);
/// Number of queries to find out whether a drill runs a program.
const ASKED: usize = 4;
/// Period of the queries to a drill that runs a program.
const ASK: Duration = Duration::from_secs(1);
/// The longest period of the queries to a drill with a lease. Each query renews the lease.
const RENEW: Duration = Duration::from_millis(100);
/// A drill that answers no query for this time counts as gone.
const GONE: Duration = Duration::from_millis(5500);
/// A drill with a lease counts as gone if it answers no query for this time. It is queried more
/// often.
const GONE_WITH_LEASE: Duration = Duration::from_secs(3);
/// A margin after the lease. By then a drill has detected that the lease has expired.
const LEASE_MARGIN: Duration = Duration::from_millis(50);
/// A drill whose lease has expired raises its spindle within this time.
const REST: Duration = Duration::from_secs(25);
/// A drill that is asked to stop completes its record first: a move of the table, or a drilling. It
/// does so within this time.
const RECORD: Duration = Duration::from_secs(180);

/// What a client does while a step lasts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Going {
    /// It waits for the end of the step.
    On,
    /// It falls silent, so that the lease of the device expires: X and Y stop, and a drill that is
    /// down comes up. The step then fails with [`Failure::Expired`], if it did not end before. A
    /// device without a lease completes the step.
    Silent,
}

/// Why a step has failed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ClientError {
    /// The link failed, or the device reports a fault.
    Link(Failure),
    /// Stopped on request.
    Stopped,
    /// The device runs a program without a host.
    AtWork,
    /// The device does not confirm a lease.
    NoLease,
    /// The port failed, for this reason.
    Port(String),
    /// The device cannot do this now.
    Refused(Refused),
}

impl ClientError {
    /// The error as a sentence.
    pub fn text(&self) -> String {
        match self {
            ClientError::Link(Failure::Silent) => {
                "no answer: the drill is off, unplugged or stopped because of a fault, or a byte \
                 was lost"
                    .into()
            }
            ClientError::Link(Failure::Wrong(byte)) => {
                format!(
                    "{byte:#04x} came back for another byte: the line is noisy, or the device is \
                     no drill"
                )
            }
            ClientError::Link(Failure::Unasked(byte)) => {
                format!("unexpected byte {byte:#04x}: a byte was doubled on the line")
            }
            ClientError::Link(Failure::Restarted) => {
                "the drill was reset: it has homed, and its program is lost".into()
            }
            ClientError::Link(Failure::Fault) => {
                "the drill has stopped because of a fault, which its panel shows: steps were lost, \
                 a switch or a sensor does not work, or a position is off the table. Repair it, \
                 then press its button R"
                    .into()
            }
            ClientError::Link(Failure::Expired) => {
                "the drill has stopped, because it heard nothing for the time of its lease \
                 (--lease): this computer was too busy, or the line was interrupted"
                    .into()
            }
            ClientError::Link(Failure::NotAll) => {
                "the axis reached its end before all steps were made".into()
            }
            ClientError::Link(Failure::Full) => {
                "the drill's memory has no room for another hole".into()
            }
            ClientError::Stopped => "stopped".into(),
            ClientError::AtWork => "the drill runs its program".into(),
            ClientError::NoLease => {
                "the drill does not confirm a lease; without one (--lease 0) it continues when \
                 this program is gone"
                    .into()
            }
            ClientError::Port(why) => format!("the port failed: {why}"),
            ClientError::Refused(refused) => format!("not done: {refused}"),
        }
    }
}

impl ClientError {
    /// A sentence about a drill that does not answer from the start, and what to do.
    pub fn unreached(&self) -> String {
        match self {
            ClientError::Link(Failure::Fault) => self.text(),
            ClientError::Link(_) => format!(
                "{}. Is it still at work? Otherwise press its button R, wait until it has homed, \
                 and try again",
                self.text()
            ),
            ClientError::AtWork => format!(
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
    /// The answer of the device to a step, if that answer is a text.
    text: Vec<u8>,
    has_extras: bool,
    /// The lease to request; 0 for no lease.
    lease_ms: u16,
    /// Whether this client refuses a device without a lease.
    needs_lease: bool,
}

impl Client {
    /// Opens a port, or a simulated drill at `sim`.
    ///
    /// # Errors
    ///
    /// Returns a sentence about the port.
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
            // A computer and its adapter may pause for longer than a character.
            timing.echo_us += 500_000;
            timing.guard_us += 30_000;
        }
        Self {
            wire,
            host: Host::new(timing, MEMORY_BYTES as u32),
            stop,
            text: Vec::new(),
            has_extras: false,
            lease_ms: LEASE_MS,
            needs_lease: false,
        }
    }

    /// All motion ends this many milliseconds after the last byte of this client. The lease is in
    /// units of 50 ms and at most 12.75 s. With 0, motion needs no client. An original has no
    /// lease, so [`reach`](Self::reach) fails at one unless this is 0. Without this call the lease
    /// is [`LEASE_MS`], and an original works without a lease.
    pub const fn with_lease(mut self, lease_ms: u16) -> Self {
        self.lease_ms = lease_ms;
        self.needs_lease = lease_ms > 0;
        self
    }

    /// Whether the motion of this device needs the client.
    pub const fn has_lease(&self) -> bool {
        self.has_extras && self.lease_ms > 0
    }

    /// Time since the wire was opened.
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

    /// Bytes of the program that are certainly done, and bytes that may have been begun.
    pub const fn done_and_begun(&self) -> [u32; 2] {
        [self.host.done_bytes(), self.host.begun_bytes()]
    }

    /// Whether the operator has requested a stop.
    pub fn is_stopping(&self) -> bool {
        self.stop.is_asked()
    }

    /// Brings the device to rest from any state except a running program. Finds out whether it has
    /// extras.
    ///
    /// # Errors
    ///
    /// [`ClientError::AtWork`]: the device reports that it runs a program. [`Failure::Fault`]: it
    /// reports that it has stopped with a fault. [`ClientError::NoLease`]: it has no lease. Another
    /// error: it does not answer within about seven seconds. Then it is off or absent, it homes, or
    /// it is an original at work.
    pub fn reach(&mut self) -> Result<(), ClientError> {
        let mut last = ClientError::Link(Failure::Silent);
        let mut is_second = false;
        let rest_by = self.elapsed() + REST;
        let mut attempts = 0;
        // In the manual mode a byte may make the device home first.
        while attempts < 10 {
            attempts += 1;
            match self.run(Step::Resync) {
                Ok(()) => match self.introduce() {
                    // A byte may be lost, so there is a second try. An original does not answer
                    // that one either.
                    Err(ClientError::Link(_)) if !is_second => is_second = true,
                    Err(ClientError::Link(_)) if !self.has_extras && !self.needs_lease => {
                        return self.run(Step::Resync);
                    }
                    Err(ClientError::Link(_)) if self.lease_ms == 0 => {
                        return self.run(Step::Resync);
                    }
                    Err(ClientError::Link(_)) => return Err(ClientError::NoLease),
                    result => return result,
                },
                Err(ClientError::Link(Failure::Silent)) => match self.says()? {
                    Some(WORKING) => return Err(ClientError::AtWork),
                    Some(FAULT) => return Err(ClientError::Link(Failure::Fault)),
                    // Another client has gone, so the drill raises its spindle.
                    Some(ENDING) if self.elapsed() < rest_by => attempts = 0,
                    _ => last = ClientError::Link(Failure::Silent),
                },
                Err(ClientError::Link(failure)) => last = ClientError::Link(failure),
                Err(error) => return Err(error),
            }
        }
        Err(last)
    }

    /// Finds out whether a device at rest has extras, and requests its lease.
    fn introduce(&mut self) -> Result<(), ClientError> {
        self.has_extras = false;
        self.run(Step::Read(COUNT))?;
        self.has_extras = true;
        self.request_lease(self.lease_ms)
    }

    /// Requests a lease. With 0 the device needs no client.
    fn request_lease(&mut self, lease_ms: u16) -> Result<(), ClientError> {
        let units = lease_ms.div_ceil(LEASE_UNIT_MS);
        self.run(Step::Lease(u8::try_from(units).unwrap_or(u8::MAX)))
    }

    /// Ends a program that the device runs alone, and brings the device to rest. The spindle of a
    /// device with extras stops, too.
    ///
    /// The device completes its present record first: a drilling, or a move over the whole table
    /// (95 s). If the device does not answer at once, `wait` gets the longest time of the wait.
    ///
    /// # Errors
    ///
    /// The device does not answer in that time: it is off, absent, or stopped because of a fault.
    /// [`ClientError::Stopped`]: the operator ends the wait.
    pub fn end_program(&mut self, wait: impl FnOnce(Duration)) -> Result<(), ClientError> {
        // One wrong bit turns an `E` into an `e`, which runs a program. So only a device that
        // answers nothing else receives an `E`.
        match self.run(Step::Resync) {
            Err(ClientError::Link(Failure::Silent)) => {}
            Err(error @ ClientError::Port(_)) => return Err(error),
            _ => return self.reach(),
        }
        wait(RECORD);
        self.put(b'E')?;
        let end = self.elapsed() + RECORD;
        let mut ask_at = self.elapsed() + ASK;
        while self.elapsed() < end {
            let byte = self.wire.receive(LOOK);
            let byte = byte.map_err(|error| ClientError::Port(error.to_string()))?;
            if byte == Some(b'e') {
                return self.reach();
            }
            if self.is_stopping() {
                return Err(ClientError::Stopped);
            }
            if self.elapsed() < ask_at {
                continue;
            }
            // The `E` may be lost, or the program may have ended before it.
            if self.run(Step::Resync).is_ok() {
                return self.reach();
            }
            match self.says()? {
                Some(WORKING) => self.put(b'E')?,
                Some(FAULT) => return Err(ClientError::Link(Failure::Fault)),
                _ => {}
            }
            ask_at = self.elapsed() + 5 * ASK;
        }
        Err(ClientError::Link(Failure::Silent))
    }

    /// Returns the answer of a device that is at work or has stopped, after a silent
    /// [`Step::Resync`]: [`WORKING`], [`ENDING`] or [`FAULT`]. An original never answers.
    fn says(&mut self) -> Result<Option<u8>, ClientError> {
        self.put(AT_WORK)?;
        let end = self.elapsed() + AT_WORK_ANSWER;
        while self.elapsed() < end {
            let byte = self.wire.receive(end - self.elapsed());
            match byte.map_err(|error| ClientError::Port(error.to_string()))? {
                Some(byte @ (WORKING | ENDING | FAULT)) => return Ok(Some(byte)),
                // A later test finds out more.
                Some(_) => {}
                None => break,
            }
        }
        Ok(None)
    }

    /// Brings the device to rest after a failure. Waits for a shorter time than
    /// [`reach`](Self::reach), because the device has answered a moment before.
    ///
    /// # Errors
    ///
    /// It does not answer.
    pub fn find_out(&mut self) -> Result<(), ClientError> {
        // The stop that the operator requested has been carried out.
        self.stop.clear();
        if self.has_lease() {
            // Sends nothing until the lease has expired. Each byte would renew it and continue the
            // motion.
            let end = self.elapsed() + Duration::from_millis(self.lease_ms.into()) + LEASE_MARGIN;
            while self.elapsed() < end {
                self.listen(end - self.elapsed())?;
            }
        }
        let rest_by = self.elapsed() + REST;
        let mut last = Ok(());
        let mut attempts = 0;
        while attempts < 4 {
            attempts += 1;
            last = self.run(Step::Resync);
            if last.is_ok() && self.has_lease() {
                last = self.request_lease(self.lease_ms);
            }
            match last {
                Ok(()) => break,
                Err(ClientError::Link(Failure::Silent)) if self.has_lease() => {
                    // The drill raises its spindle.
                    if self.says()? == Some(ENDING) && self.elapsed() < rest_by {
                        attempts = 0;
                    }
                }
                Err(_) => {}
            }
        }
        last
    }

    /// Number of drillings that the device has done since its memory was cleared. `None`: the
    /// device is an original, which does not know the number, or it was reset.
    ///
    /// # Errors
    ///
    /// The link failed.
    pub fn drillings(&mut self) -> Result<Option<u16>, ClientError> {
        if !self.has_extras {
            return Ok(None);
        }
        let (letter, count) = self.read(Reading::Drillings)?;
        Ok((letter == b'c').then_some(count))
    }

    /// A reading of a device with extras: its letter and its value.
    ///
    /// # Errors
    ///
    /// The link failed.
    pub fn read(&mut self, reading: Reading) -> Result<(u8, u16), ClientError> {
        let [letter, low, high] = self.record(reading.number())?;
        Ok((letter, u16::from_le_bytes([low, high])))
    }

    /// The record with this number, from 0, in a device with extras.
    ///
    /// # Errors
    ///
    /// The link failed.
    pub fn record(&mut self, number: u16) -> Result<[u8; 3], ClientError> {
        self.run(Step::Read(number))?;
        Ok(self.host.record())
    }

    /// The record that [`Step::Read`] has read last.
    pub const fn last_record(&self) -> [u8; 3] {
        self.host.record()
    }

    /// The program in the device's memory, record by record.
    ///
    /// # Errors
    ///
    /// The link failed, or the device does not report its program.
    pub fn program(&mut self) -> Result<Vec<[u8; 3]>, ClientError> {
        let mut records = Vec::new();
        for number in 0..COUNT {
            let record = self.record(number)?;
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
    pub fn help(&mut self) -> Result<String, ClientError> {
        self.text.clear();
        self.run(Step::Help)?;
        // The echo before the text and the mark after it are not part of the text.
        let inner = self.text.get(1..self.text.len().max(2) - 1);
        Ok(String::from_utf8_lossy(inner.unwrap_or_default()).into_owned())
    }

    /// Carries out a step that takes a few seconds at most.
    ///
    /// # Errors
    ///
    /// See [`ClientError`].
    pub fn run(&mut self, step: Step) -> Result<(), ClientError> {
        self.run_for(step, Duration::ZERO, |_| {})
    }

    /// Carries out a step that may take as long as `longest`. `progress` gets the time since its
    /// start.
    ///
    /// # Errors
    ///
    /// See [`ClientError`].
    pub fn run_for(
        &mut self,
        step: Step,
        longest: Duration,
        mut progress: impl FnMut(Duration),
    ) -> Result<(), ClientError> {
        self.run_while(step, longest, |passed| {
            progress(passed);
            Going::On
        })
    }

    /// Carries out a step that may take as long as `longest`, as long as `watch` says so. `watch`
    /// gets the time since the start, at least every 20 ms.
    ///
    /// # Errors
    ///
    /// See [`ClientError`].
    pub fn run_while(
        &mut self,
        step: Step,
        mut longest: Duration,
        mut watch: impl FnMut(Duration) -> Going,
    ) -> Result<(), ClientError> {
        let mut is_silent = false;
        let start = self.elapsed();
        let now = self.now_us();
        self.host.start(step, now).map_err(ClientError::Refused)?;
        let mut has_stopped = false;
        let period = self.question_period();
        let gone = if self.has_lease() {
            GONE_WITH_LEASE
        } else {
            GONE
        };
        let (mut ask_at, mut answered_at) = (start + period, start);
        loop {
            self.transmit()?;
            match self.host.poll(self.now_us()) {
                Progress::Done(Outcome::Done) => return Ok(()),
                Progress::Done(Outcome::Stopped) => return Err(ClientError::Stopped),
                Progress::Done(Outcome::Failed(failure)) => return Err(ClientError::Link(failure)),
                Progress::Idle | Progress::Sending => {}
                Progress::Waiting { us } => {
                    let passed = self.elapsed() - start;
                    // A host waits 30 s for a run. While the run may last, the wait is restarted.
                    if us < RUN_US / 2 && us > 1_000_000 && passed < longest && !is_silent {
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
                    if self.host.is_at_work() {
                        answered_at = self.elapsed();
                    }
                    if self.has_extras && !is_silent && self.elapsed() >= ask_at {
                        if let Some(byte) = self.host.ask_at_work() {
                            if self.elapsed() - answered_at > gone {
                                self.host.give_up();
                                return Err(ClientError::Link(Failure::Silent));
                            }
                            self.put(byte)?;
                        }
                        ask_at = self.elapsed() + period;
                    }
                    self.listen(Duration::from_micros(u64::from(us)).min(LOOK))?;
                    is_silent |= watch(passed) == Going::Silent;
                }
            }
        }
    }

    /// Receives for a time, while no step lasts. What arrives fails the next step: a device that
    /// was reset, or that has stopped with a fault, reports that by itself.
    ///
    /// # Errors
    ///
    /// The port failed.
    pub fn rest(&mut self, time: Duration) -> Result<(), ClientError> {
        let end = self.elapsed() + time;
        while let Some(left) = end
            .checked_sub(self.elapsed())
            .filter(|left| !left.is_zero())
        {
            self.listen(left.min(LOOK))?;
        }
        Ok(())
    }

    /// The period of the queries whether the device is at work: at most a quarter of a lease.
    fn question_period(&self) -> Duration {
        if self.has_lease() {
            RENEW.min(Duration::from_millis(self.lease_ms.into()) / 4)
        } else {
            ASK
        }
    }

    /// Starts the program and checks that it runs. Does not wait for its end. From then on the
    /// program needs no client. `false`: the program has ended already.
    ///
    /// # Errors
    ///
    /// The program did not start, or the device does not confirm its start.
    pub fn start(&mut self) -> Result<bool, ClientError> {
        self.request_lease(0)?;
        let now = self.now_us();
        self.host
            .start(Step::Execute, now)
            .map_err(ClientError::Refused)?;
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
                    Progress::Done(Outcome::Failed(failure)) => {
                        return Err(ClientError::Link(failure));
                    }
                    Progress::Done(Outcome::Stopped) => return Err(ClientError::Stopped),
                    _ if self.host.is_at_work() => return Ok(true),
                    _ => {}
                }
            }
        }
        self.host.give_up();
        Err(ClientError::Link(Failure::Silent))
    }

    fn transmit(&mut self) -> Result<(), ClientError> {
        let now = self.now_us();
        match self.host.transmit(now) {
            Some(byte) => self.put(byte),
            None => Ok(()),
        }
    }

    fn put(&mut self, byte: u8) -> Result<(), ClientError> {
        self.wire
            .send(byte)
            .map_err(|error| ClientError::Port(error.to_string()))
    }

    /// Waits for a byte.
    fn listen(&mut self, within: Duration) -> Result<(), ClientError> {
        let byte = self.wire.receive(within);
        if let Some(byte) = byte.map_err(|error| ClientError::Port(error.to_string()))? {
            self.text.push(byte);
            let now = self.now_us();
            self.host.push(byte, now);
        }
        Ok(())
    }

    /// Time in microseconds. It wraps, as the host expects.
    fn now_us(&self) -> u32 {
        self.wire.elapsed().as_micros() as u32
    }
}

//! The host's end of the line: one step at a time, with retries that never do harm.

use crate::buffer::Buffer;

use super::command::is_group;
use super::damage::{FLUSH_LENGTH, flush_byte, is_fragile};
use super::frame::LONGEST_FRAME;
use super::repeat::{agreement, start};
use super::reply::LONGEST_REPLY;
use super::{
    Baud, Command, Failure, Finding, Frame, Group, Items, Outcome, Progress, Refused, Repeat,
    Reply, Status, Step, Timing, Trajectory,
};

/// Highest individual address the host keeps.
pub const LAST_ADDRESS: u8 = 32;

const ADDRESSES: usize = LAST_ADDRESS as usize + 1;

/// What the host knows of a module.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Member {
    is_present: bool,
    items: Items,
    group: Group,
    version: u8,
    /// What was loaded last and waits for Start Motion.
    loaded: Option<Trajectory>,
}

impl Member {
    const RESET: Member = Member {
        is_present: false,
        items: Items::NONE,
        group: Group::NONE,
        version: 4,
        loaded: None,
    };
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Phase {
    Idle,
    /// Reading what repeating will need.
    Before,
    /// The command itself.
    Command,
    /// Reading whether it was executed.
    After,
    /// Filling half-received packets, then this.
    Flush(Next),
    /// Silence, then sent.
    Wait(u32),
}

/// What follows a flush.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Next {
    Before,
    Command,
    After,
    End(Outcome),
}

/// Why a reply is none.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Bad {
    Silent,
    Garbled,
    /// The module received a damaged packet, and said so.
    Rejected,
}

/// The host of a chain: it knows addresses, groups and items in force, sends, waits, retries.
///
/// | when | call |
/// | --- | --- |
/// | something is to be done | [`start`](Host::start) |
/// | the port takes bytes | [`transmit`](Host::transmit) until `None` |
/// | a byte arrives | [`push`](Host::push) |
/// | after each of these and after the time it names | [`poll`](Host::poll) |
///
/// A command that must not be executed twice is preceded by a reading; when its reply is lost the line is flushed, the reading
/// taken again, and the command repeated only where the two show that nothing happened (see [`Command::repeat`]). Each of these is
/// taken until two in a row agree, as a byte lost and an equal one doubled in the same reply leave its length and its sum right. So such
/// a command takes three exchanges and a poll takes one.
///
/// `now_us` wraps; calls may be up to 2^31 us apart. 1.6 KB.
#[derive(Debug, Clone)]
pub struct Host {
    timing: Timing,
    baud: Baud,
    members: [Member; ADDRESSES],
    address: u8,
    command: Command,
    /// `Some` for a reading that has to be taken twice: how far the positions may be apart.
    twice_counts: Option<u32>,
    /// The reading before, of one that is taken twice.
    first: Option<Reply>,
    phase: Phase,
    /// Left for the command, and for the reading.
    tries: u8,
    readings: u8,
    before: Reply,
    /// Whether any byte of a reply was heard, and of a reading after.
    has_heard: bool,
    has_heard_after: bool,
    out: Buffer<FLUSH_LENGTH>,
    sent: u8,
    /// The last command packet on the line, which a module may have half of.
    last: Frame,
    input: Buffer<LONGEST_REPLY>,
    /// More came than fits a reply.
    is_too_long: bool,
    /// When the phase ends at the latest; unknown until all is sent.
    deadline_us: Option<u32>,
    heard_us: u32,
    outcome: Option<Outcome>,
}

impl Host {
    /// Of a line at 19200 baud whose modules are fresh from reset.
    pub fn new(timing: Timing) -> Host {
        Host {
            timing,
            baud: Baud::B19200,
            members: [Member::RESET; ADDRESSES],
            address: 0,
            command: Command::NoOperation,
            twice_counts: None,
            first: None,
            phase: Phase::Idle,
            tries: 0,
            readings: 0,
            before: Reply::default(),
            has_heard: false,
            has_heard_after: false,
            out: Buffer::new(),
            sent: 0,
            last: Command::NoOperation.frame(0),
            input: Buffer::new(),
            is_too_long: false,
            deadline_us: None,
            heard_us: 0,
            outcome: None,
        }
    }

    /// Begins a step.
    ///
    /// # Errors
    /// [`Refused`]; nothing is sent then.
    pub fn start(&mut self, step: Step, now_us: u32) -> Result<(), Refused> {
        if self.phase != Phase::Idle || self.outcome.is_some() {
            return Err(Refused::Busy);
        }
        self.heard_us = now_us;
        match step {
            Step::Request { address, command } => self.request(address, command, None)?,
            Step::ReadTwice {
                address,
                items,
                jitter_counts,
            } => self.request(address, Command::ReadStatus(items), Some(jitter_counts))?,
            Step::Flush => self.flush_then(Next::End(Outcome::Sent)),
            Step::Wait { us } => {
                self.phase = Phase::Wait(us);
                self.send(&[]);
                self.deadline_us = Some(now_us.wrapping_add(us.min(i32::MAX as u32)));
            }
            Step::Switch(baud) => {
                self.baud = baud;
                self.outcome = Some(Outcome::Sent);
            }
        }
        Ok(())
    }

    /// Begins a request: [`Step::Request`].
    ///
    /// # Errors
    /// [`Refused`]; nothing is sent then.
    pub fn send_command(
        &mut self,
        address: u8,
        command: Command,
        now_us: u32,
    ) -> Result<(), Refused> {
        self.start(Step::Request { address, command }, now_us)
    }

    /// The next byte for the command line; `None` when there is none for now.
    pub fn transmit(&mut self, now_us: u32) -> Option<u8> {
        let bytes = self.out.bytes();
        let byte = bytes.get(usize::from(self.sent)).copied()?;
        let length = bytes.len();
        self.sent = self.sent.wrapping_add(1); // it was below 20
        if usize::from(self.sent) == length {
            let wait_us = match self.phase {
                Phase::Flush(_) => self.timing.settle_us,
                Phase::Wait(us) => us,
                _ => {
                    let reply = 2 + self.expected().length() as u32; // 19 at most
                    let bytes_us = self.timing.per_byte_us.saturating_mul(reply);
                    self.timing.reply_us.saturating_add(bytes_us)
                }
            };
            // All of it may still be in a buffer; 20 characters at most.
            let flight_us = self.baud.characters_us(length as u16);
            let wait_us = wait_us.saturating_add(flight_us).min(i32::MAX as u32);
            self.deadline_us = Some(now_us.wrapping_add(wait_us));
        }
        Some(byte)
    }

    /// Takes a byte of the status line. What comes before the request is sent, in a pause or after a flush is no reply.
    pub fn push(&mut self, byte: u8, now_us: u32) {
        let awaits = matches!(self.phase, Phase::Before | Phase::Command | Phase::After);
        if !awaits || self.deadline_us.is_none() {
            return;
        }
        self.is_too_long |= self.input.bytes().len() >= LONGEST_REPLY;
        self.input.push(byte);
        self.heard_us = now_us;
        self.has_heard = true;
        self.has_heard_after |= self.phase == Phase::After;
    }

    /// Goes on where time or bytes allow it.
    pub fn poll(&mut self, now_us: u32) -> Progress {
        if let Some(outcome) = self.outcome.take() {
            self.phase = Phase::Idle;
            return Progress::Done(outcome);
        }
        if self.phase == Phase::Idle {
            return Progress::Idle;
        }
        let Some(deadline_us) = self.deadline_us else {
            return Progress::Sending;
        };
        let left_us = until(deadline_us, now_us);
        match self.phase {
            Phase::Idle => {}
            Phase::Wait(_) if left_us > 0 => return Progress::Waiting { us: left_us },
            Phase::Wait(_) => self.end(Outcome::Sent),
            Phase::Flush(_) if left_us > 0 => return Progress::Waiting { us: left_us },
            Phase::Flush(next) => match next {
                Next::Before => self.read_before(),
                Next::Command => self.send_again(),
                Next::After => self.read_after(),
                Next::End(outcome) => self.end(outcome),
            },
            Phase::Before | Phase::Command | Phase::After => {
                if let Some(result) = self.whole() {
                    let guard_us = self.heard_us.wrapping_add(self.timing.guard_us);
                    let guard_us = until(guard_us, now_us);
                    if guard_us > 0 {
                        return Progress::Waiting { us: guard_us };
                    }
                    self.heard(result);
                } else if left_us > 0 {
                    return Progress::Waiting { us: left_us };
                } else if self.input.bytes().is_empty() {
                    self.heard(Err(Bad::Silent));
                } else {
                    self.heard(Err(Bad::Garbled));
                }
            }
        }
        match self.outcome.take() {
            Some(outcome) => {
                self.phase = Phase::Idle;
                Progress::Done(outcome)
            }
            None => Progress::Sending,
        }
    }

    /// The rate of the line.
    pub const fn baud(&self) -> Baud {
        self.baud
    }

    /// The waits in force.
    pub const fn timing(&self) -> Timing {
        self.timing
    }

    /// Other waits, from the next step on.
    pub fn set_timing(&mut self, timing: Timing) {
        self.timing = timing;
    }

    /// The modules in a group as bits: bit 0 is address 1. After a group command each has to be asked whether it heard it.
    pub fn members_of(&self, group: u8) -> u32 {
        let mut bits = 0;
        for (bit, member) in (0..32_u32).zip(self.members.iter().skip(1)) {
            if member.is_present && member.group.address == group {
                bits |= 1_u32.wrapping_shl(bit); // below 32
            }
        }
        bits
    }

    /// Takes over a module that was set up before: its address, 1 to 32, the items in force and its group.
    pub fn adopt(&mut self, address: u8, items: Items, group: Group) {
        if let Some(member) = self.member_mut(address) {
            *member = Member {
                is_present: true,
                items,
                group,
                ..Member::RESET
            };
        }
    }

    fn request(
        &mut self,
        address: u8,
        command: Command,
        twice: Option<u32>,
    ) -> Result<(), Refused> {
        if !is_group(address) && address > LAST_ADDRESS {
            return Err(Refused::NoSuchAddress);
        }
        // Members of a group would all take one address.
        if matches!(command, Command::SetAddress { address: new, .. } if new > LAST_ADDRESS || is_group(address))
        {
            return Err(Refused::NoSuchAddress);
        }
        if !command.is_in_range(self.version(address)) {
            return Err(Refused::OutOfRange);
        }
        let repeat = command.repeat(address);
        if repeat != Repeat::Free && is_fragile(&command.frame(address), self.version(address)) {
            return Err(Refused::Fragile);
        }
        self.address = address;
        self.command = command;
        if matches!(command, Command::SetBaud(_)) && self.answerer().is_some() {
            return Err(Refused::WouldAnswer);
        }
        self.twice_counts = twice;
        self.first = None;
        self.has_heard = false;
        self.tries = self.timing.tries.max(1);
        self.readings = self.readings_at_most();
        self.before = Reply::default();
        match repeat {
            Repeat::AfterReading(_) if !is_group(address) => self.read_before(),
            _ => self.send_again(),
        }
        Ok(())
    }

    /// Sends the command, with one try less.
    fn send_again(&mut self) {
        self.tries = self.tries.saturating_sub(1);
        self.readings = self.readings_at_most();
        self.has_heard_after = false;
        if self.twice_counts.is_none() {
            self.first = None;
        }
        let answers = self.answerer().is_some()
            && !matches!(self.command, Command::HardReset(_) | Command::SetBaud(_));
        self.phase = if answers {
            Phase::Command
        } else if matches!(self.command, Command::HardReset(_)) {
            Phase::Wait(self.timing.reset_us)
        } else {
            Phase::Wait(self.timing.unanswered_us)
        };
        if !answers {
            self.learn(None);
        }
        let frame = self.command.frame(self.address);
        self.send_frame(frame);
    }

    /// Tries, and the second reading, which is no retry.
    fn readings_at_most(&self) -> u8 {
        let second = matches!(self.command.repeat(self.address), Repeat::AfterReading(_));
        self.timing.tries.max(1).saturating_add(second.into())
    }

    fn read_before(&mut self) {
        self.phase = Phase::Before;
        self.read();
    }

    fn read_after(&mut self) {
        self.phase = Phase::After;
        self.read();
    }

    fn read(&mut self) {
        self.readings = self.readings.saturating_sub(1);
        let frame = match self.command.repeat(self.address) {
            Repeat::AfterSilenceAt(new) => Command::NoOperation.frame(new),
            Repeat::AfterReading(items) => Command::ReadStatus(items).frame(self.address),
            _ => Command::NoOperation.frame(self.address),
        };
        self.send_frame(frame);
    }

    fn flush_then(&mut self, next: Next) {
        self.phase = Phase::Flush(next);
        self.send(&[flush_byte(&self.last); FLUSH_LENGTH]);
    }

    fn send_frame(&mut self, frame: Frame) {
        self.last = frame;
        self.send(frame.bytes());
    }

    fn send(&mut self, bytes: &[u8]) {
        const { assert!(FLUSH_LENGTH >= LONGEST_FRAME) };
        self.out.clear();
        self.out.extend(bytes);
        self.sent = 0;
        self.input.clear();
        self.is_too_long = false;
        self.deadline_us = None;
    }

    /// The items of a sound reply to what was sent.
    fn expected(&self) -> Items {
        let repeat = self.command.repeat(self.address);
        match (self.phase, self.command, repeat) {
            (Phase::Command, Command::DefineStatus(items) | Command::ReadStatus(items), _)
            | (Phase::Before | Phase::After, _, Repeat::AfterReading(items)) => {
                items.of_version(self.version(self.address))
            }
            _ => self.in_force(),
        }
    }

    /// The items in force where the reply comes from.
    fn in_force(&self) -> Items {
        let from = self.answerer().unwrap_or_default();
        self.member(from)
            .map(|member| member.items)
            .unwrap_or_default()
    }

    /// The reply once it is long enough, sound or not.
    fn whole(&self) -> Option<Result<Reply, Bad>> {
        let status = Status(*self.input.bytes().first()?);
        let is_rejected = status.contains(Status::CHECKSUM_ERROR);
        let items = if !is_rejected {
            self.expected()
        } else if matches!(self.command, Command::DefineStatus(_)) {
            return None; // an earlier try may have changed what is in force: whatever it is, it is over at the deadline
        } else {
            self.in_force()
        };
        let length = items.length() + 2; // 19 at most
        let heard = self.input.bytes().len();
        if heard != length || self.is_too_long {
            return None; // too long is known for certain at the deadline only
        }
        Some(match Reply::decode(self.input.bytes(), items) {
            Some(_) if is_rejected => Err(Bad::Rejected),
            Some(reply) => Ok(reply),
            None => Err(Bad::Garbled),
        })
    }

    fn heard(&mut self, result: Result<Reply, Bad>) {
        match self.phase {
            Phase::Before => self.heard_before(result),
            Phase::Command => self.heard_answer(result),
            Phase::After => self.heard_after(result),
            Phase::Idle | Phase::Flush(_) | Phase::Wait(_) => {}
        }
    }

    fn heard_before(&mut self, result: Result<Reply, Bad>) {
        match result {
            Ok(reply) => match self.agreed(&reply) {
                Some(before) => {
                    self.before = before;
                    self.send_again();
                }
                None if self.readings > 0 => self.read_before(),
                None => self.end(Outcome::Failed(Failure::Unsteady)),
            },
            Err(Bad::Rejected) if self.readings > 0 => self.read_before(),
            Err(_) if self.readings > 0 => self.flush_then(Next::Before),
            Err(bad) => self.give_up(bad),
        }
    }

    fn heard_answer(&mut self, result: Result<Reply, Bad>) {
        let repeat = self.command.repeat(self.address);
        let bad = match result {
            Ok(reply) if self.twice_counts.is_some() => return self.compare(reply),
            Ok(reply) => {
                self.learn(Some(&reply));
                return self.end(Outcome::Answered(reply));
            }
            Err(bad) => bad,
        };
        match (repeat, bad) {
            (Repeat::Free, Bad::Rejected) if self.tries > 0 => self.send_again(),
            (Repeat::Free, Bad::Rejected) => self.give_up(bad),
            (Repeat::Free, _) if self.tries > 0 => self.flush_then(Next::Command),
            (Repeat::Free, _) => self.give_up(bad),
            // One reading cannot speak for all of a group.
            _ if is_group(self.address) => self.fail_after_flush(Failure::Uncertain),
            // Even a reply that says "damaged" may itself be damaged.
            (_, Bad::Rejected) => self.read_after(),
            _ => self.flush_then(Next::After),
        }
    }

    fn heard_after(&mut self, result: Result<Reply, Bad>) {
        let is_new_address = matches!(self.command.repeat(self.address), Repeat::AfterSilenceAt(_));
        let finding = match result {
            Ok(_) if is_new_address => Finding::Executed,
            Ok(reply) => match self.agreed(&reply) {
                Some(after) => self.finding(&after),
                None if self.readings > 0 => return self.read_after(),
                None => Finding::Unknown,
            },
            Err(Bad::Rejected) if self.readings > 0 => return self.read_after(),
            Err(_) if self.readings > 0 => return self.flush_then(Next::After),
            Err(_) if is_new_address && !self.has_heard_after => Finding::NotExecuted,
            Err(_) => Finding::Unknown,
        };
        match (finding, result) {
            (Finding::Executed, Ok(reply)) => {
                self.learn(Some(&reply));
                self.end(Outcome::Confirmed(reply));
            }
            (Finding::NotExecuted | Finding::Harmless, Ok(_)) if self.tries > 0 => {
                self.send_again();
            }
            (Finding::NotExecuted, Ok(_)) => self.end(Outcome::Failed(Failure::NotExecuted)),
            (Finding::NotExecuted, Err(_)) if self.tries > 0 => self.flush_then(Next::Command),
            (Finding::NotExecuted, Err(bad)) => self.give_up(bad),
            (_, Ok(_)) => self.end(Outcome::Failed(Failure::Uncertain)),
            (_, Err(_)) => self.fail_after_flush(Failure::Uncertain),
        }
    }

    fn finding(&self, after: &Reply) -> Finding {
        match self.command {
            Command::StartMotion => {
                let loaded = self.member(self.address).and_then(|member| member.loaded);
                start(loaded.as_ref(), &self.before, after)
            }
            command => command.finding(&self.before, after),
        }
    }

    /// What this reading and the one before say of the module, where they agree.
    fn agreed(&mut self, reply: &Reply) -> Option<Reply> {
        let first = self.first.replace(*reply)?;
        agreement(&first, reply)
    }

    /// Two readings in a row have to agree.
    fn compare(&mut self, reply: Reply) {
        let apart = |a: i32, b: i32| a.wrapping_sub(b).unsigned_abs(); // as positions wrap
        let jitter = self.twice_counts.unwrap_or_default();
        let agrees = self.first.is_some_and(|first| {
            let (a, b) = (&first.readings, &reply.readings);
            first.status == reply.status
                && apart(a.position, b.position) <= jitter
                && (a.home, a.auxiliary) == (b.home, b.auxiliary)
                && (a.kind, a.version, a.path_points) == (b.kind, b.version, b.path_points)
        });
        if agrees {
            self.learn(Some(&reply));
            return self.end(Outcome::Answered(reply));
        }
        if self.first.is_some() && self.tries == 0 {
            return self.end(Outcome::Failed(Failure::Unsteady));
        }
        if self.first.is_none() {
            self.tries = self.tries.saturating_add(1); // the second reading is no retry
        }
        self.first = Some(reply);
        self.send_again();
    }

    fn give_up(&mut self, bad: Bad) {
        let never_sent = self.phase == Phase::Before;
        match bad {
            Bad::Rejected => self.end(Outcome::Failed(Failure::NotExecuted)),
            Bad::Garbled if never_sent => self.fail_after_flush(Failure::Garbled),
            Bad::Silent if !self.has_heard => self.fail_after_flush(Failure::Silent),
            Bad::Silent | Bad::Garbled => self.fail_after_flush(Failure::Garbled),
        }
    }

    fn fail_after_flush(&mut self, failure: Failure) {
        self.flush_then(Next::End(Outcome::Failed(failure)));
    }

    fn end(&mut self, outcome: Outcome) {
        self.outcome = Some(outcome);
    }

    /// What an executed command changes of what the host knows.
    fn learn(&mut self, reply: Option<&Reply>) {
        let (address, command) = (self.address, self.command);
        match command {
            Command::SetAddress {
                address: new,
                group,
            } => {
                let before = self.member(address).copied().unwrap_or(Member::RESET);
                let before = if address == 0 { Member::RESET } else { before };
                if let Some(member) = self.member_mut(address) {
                    *member = Member::RESET;
                }
                if let Some(member) = self.member_mut(new) {
                    *member = Member {
                        is_present: true,
                        group,
                        ..before
                    };
                }
            }
            Command::DefineStatus(items) => self.change(|member| {
                member.items = items.of_version(member.version);
            }),
            Command::LoadTrajectory(trajectory) => self.change(|member| {
                // Of a group only the leader has answered.
                let is_known = !is_group(address) && !trajectory.start_now;
                member.loaded = is_known.then_some(trajectory);
            }),
            Command::HardReset(_) => self.change(|member| *member = Member::RESET),
            _ => {}
        }
        let device = reply.filter(|reply| reply.items.contains(Items::DEVICE));
        if let (Some(reply), Some(member)) = (device, self.member_mut(address)) {
            member.version = reply.readings.version;
        }
    }

    /// Changes the module addressed, or all of the group.
    fn change(&mut self, change: impl Fn(&mut Member)) {
        let address = self.address;
        if is_group(address) {
            let of_group = |member: &&mut Member| member.group.address == address;
            self.members.iter_mut().filter(of_group).for_each(change);
        } else if let Some(member) = self.member_mut(address) {
            change(member);
        }
    }

    /// The individual address whose module answers; `None` for a group without leader.
    fn answerer(&self) -> Option<u8> {
        if !is_group(self.address) {
            return Some(self.address); // also at its new address: it keeps its items
        }
        let leads = |member: &Member| {
            member.is_present && member.group.is_leader && member.group.address == self.address
        };
        (0..=LAST_ADDRESS)
            .zip(&self.members)
            .find_map(|(address, member)| leads(member).then_some(address))
    }

    /// Of a module, or the lowest of a group.
    fn version(&self, address: u8) -> u8 {
        if is_group(address) {
            let of_group = |member: &&Member| member.is_present && member.group.address == address;
            let versions = self.members.iter().filter(of_group);
            versions.map(|member| member.version).min().unwrap_or(4)
        } else {
            self.member(address).map_or(4, |member| member.version)
        }
    }

    fn member(&self, address: u8) -> Option<&Member> {
        self.members.get(usize::from(address))
    }

    fn member_mut(&mut self, address: u8) -> Option<&mut Member> {
        self.members.get_mut(usize::from(address))
    }
}

/// Microseconds from now to then, 0 when it is past.
fn until(then_us: u32, now_us: u32) -> u32 {
    // Half of the circle is the past.
    let left_us = then_us.wrapping_sub(now_us);
    if left_us > i32::MAX as u32 {
        0
    } else {
        left_us
    }
}

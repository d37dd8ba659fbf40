//! The host's end of the line: one step at a time, with safe retries.

mod exchange;
mod members;

use self::members::Member;
use crate::buffer::Buffer;

use super::damage::FLUSH_LENGTH;
use super::reply::LONGEST_REPLY;
use super::{Baud, Command, Frame, Group, Items, Outcome, Progress, Refused, Reply, Step, Timing};

/// Highest individual address of the host.
pub const LAST_ADDRESS: u8 = 32;

const ADDRESSES: usize = LAST_ADDRESS as usize + 1;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Phase {
    Idle,
    /// The reading before a command that may have to be repeated.
    Before,
    /// The command.
    Command,
    /// The reading that shows whether the command was executed.
    After,
    /// The flush of half-received packets, and what follows it.
    Flush(Next),
    /// Silence, after which the step is sent.
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

/// Why there is no valid reply.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Bad {
    Silent,
    Garbled,
    /// The module reports that it received a damaged packet.
    Rejected,
}

/// The host of a network. It knows addresses, groups and items, and it sends, waits and retries.
///
/// | when | call |
/// | --- | --- |
/// | a step is to begin | [`start`](Host::start) |
/// | the port takes bytes | [`transmit`](Host::transmit) until `None` |
/// | a byte arrives | [`push`](Host::push) |
/// | after each of these, and after the time that it returns | [`poll`](Host::poll) |
///
/// Before a command that must not be executed twice, the host takes a reading. If the reply is
/// lost, it flushes the line and reads again. It repeats the command only if the two readings show
/// that nothing happened (see [`Command::repeat`]). The host repeats each reading until two in a
/// row agree. The reason is that a lost byte and an equal doubled byte in one reply leave its
/// length and checksum right. A command with readings takes three exchanges, a poll takes one.
///
/// `now_us` wraps. Calls may be up to 2^31 us apart. The size is 1.6 KB.
#[derive(Debug, Clone)]
pub struct Host {
    timing: Timing,
    baud: Baud,
    members: [Member; ADDRESSES],
    address: u8,
    command: Command,
    /// For a reading that is taken twice: the largest difference of the positions.
    twice_counts: Option<u32>,
    /// The first of two readings of a reading that is taken twice.
    first: Option<Reply>,
    phase: Phase,
    /// Tries left for the command, and for the reading.
    tries: u8,
    readings: u8,
    before: Reply,
    /// Whether any byte of the reply has arrived. The next field is the same for the reading after
    /// it.
    has_heard: bool,
    has_heard_after: bool,
    out: Buffer<FLUSH_LENGTH>,
    sent: u8,
    /// The last command packet on the line. A module may have received half of it.
    last: Frame,
    input: Buffer<LONGEST_REPLY>,
    /// Whether more bytes arrived than a reply has.
    is_too_long: bool,
    /// The latest end of the phase. It is not known until everything is sent.
    deadline_us: Option<u32>,
    heard_us: u32,
    outcome: Option<Outcome>,
}

impl Host {
    /// Creates the host of a line at 19200 baud whose modules were just reset.
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
    /// [`Refused`]. In this case nothing is sent.
    pub fn start(&mut self, step: Step, now_us: u32) -> Result<(), Refused> {
        if self.phase != Phase::Idle || self.outcome.is_some() {
            return Err(Refused::Busy);
        }
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
        self.heard_us = now_us;
        Ok(())
    }

    /// Begins a request: [`Step::Request`].
    ///
    /// # Errors
    /// [`Refused`]. In this case nothing is sent.
    pub fn send_command(
        &mut self,
        address: u8,
        command: Command,
        now_us: u32,
    ) -> Result<(), Refused> {
        self.start(Step::Request { address, command }, now_us)
    }

    /// Returns the next byte for the command line. Returns `None` if there is none now.
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
            // All of it may still be in a buffer. These are at most 20 characters.
            let flight_us = self.baud.characters_us(length as u16);
            let wait_us = wait_us.saturating_add(flight_us).min(i32::MAX as u32);
            self.deadline_us = Some(now_us.wrapping_add(wait_us));
        }
        Some(byte)
    }

    /// Takes a byte of the status line. Bytes that arrive before the request is sent, in a pause,
    /// or after a flush are not part of a reply.
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

    /// Continues the step as far as time and bytes allow.
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

    /// Returns the rate of the line.
    pub const fn baud(&self) -> Baud {
        self.baud
    }

    /// Returns the waits in force.
    pub const fn timing(&self) -> Timing {
        self.timing
    }

    /// Sets other waits, which apply from the next step on.
    pub fn set_timing(&mut self, timing: Timing) {
        self.timing = timing;
    }

    /// Returns the modules in a group as bits. Bit 0 is address 1. After a group command, each of
    /// them must be asked whether it received the command.
    pub fn members_of(&self, group: u8) -> u32 {
        let mut bits = 0;
        for (bit, member) in (0..32_u32).zip(self.members.iter().skip(1)) {
            if member.is_present && member.group.address == group {
                bits |= 1_u32.wrapping_shl(bit); // below 32
            }
        }
        bits
    }

    /// Registers a module that was set up before, with its address, 1 to 32, its status items and
    /// its group.
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
}

/// Returns the microseconds from now to `then_us`. Returns 0 if this time is past.
fn until(then_us: u32, now_us: u32) -> u32 {
    // A difference in the upper half of the range means that the time is past.
    let left_us = then_us.wrapping_sub(now_us);
    if left_us > i32::MAX as u32 {
        0
    } else {
        left_us
    }
}

//! The phases of an exchange: reading, command, answer, and what follows a missing answer.

use super::{Bad, Host, LAST_ADDRESS, Next, Phase};
use crate::nmc::command::is_group;
use crate::nmc::damage::{FLUSH_LENGTH, flush_byte, is_fragile};
use crate::nmc::frame::LONGEST_FRAME;
use crate::nmc::repeat::{agreement, start};
use crate::nmc::{
    Command, Failure, Finding, Frame, Items, Outcome, Refused, Repeat, Reply, Status,
};

impl Host {
    pub(super) fn request(
        &mut self,
        address: u8,
        command: Command,
        twice: Option<u32>,
    ) -> Result<(), Refused> {
        if !is_group(address) && address > LAST_ADDRESS {
            return Err(Refused::NoSuchAddress);
        }
        // Otherwise all members of a group would take one address.
        if matches!(
            command,
            Command::SetAddress { address: new, .. } if new > LAST_ADDRESS || is_group(address),
        ) {
            return Err(Refused::NoSuchAddress);
        }
        if !command.is_in_range(self.version(address)) {
            return Err(Refused::OutOfRange);
        }
        let repeat = command.repeat(address);
        if repeat != Repeat::Free && is_fragile(&command.frame(address), self.version(address)) {
            return Err(Refused::Fragile);
        }
        let last = (self.address, self.command);
        (self.address, self.command) = (address, command);
        if matches!(command, Command::SetBaud(_)) && self.answerer().is_some() {
            (self.address, self.command) = last;
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

    /// Sends the command. One try less is left.
    pub(super) fn send_again(&mut self) {
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

    /// Returns the number of tries plus the second reading, which is not a retry.
    fn readings_at_most(&self) -> u8 {
        let second = matches!(self.command.repeat(self.address), Repeat::AfterReading(_));
        self.timing.tries.max(1).saturating_add(second.into())
    }

    pub(super) fn read_before(&mut self) {
        self.phase = Phase::Before;
        self.read();
    }

    pub(super) fn read_after(&mut self) {
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

    pub(super) fn flush_then(&mut self, next: Next) {
        self.phase = Phase::Flush(next);
        self.send(&[flush_byte(&self.last); FLUSH_LENGTH]);
    }

    fn send_frame(&mut self, frame: Frame) {
        self.last = frame;
        self.send(frame.bytes());
    }

    pub(super) fn send(&mut self, bytes: &[u8]) {
        const { assert!(FLUSH_LENGTH >= LONGEST_FRAME) };
        self.out.clear();
        self.out.extend(bytes);
        self.sent = 0;
        self.input.clear();
        self.is_too_long = false;
        self.deadline_us = None;
    }

    /// Returns the items of a valid reply to the last request.
    pub(super) fn expected(&self) -> Items {
        let repeat = self.command.repeat(self.address);
        match (self.phase, self.command, repeat) {
            (Phase::Command, Command::DefineStatus(items) | Command::ReadStatus(items), _)
            | (Phase::Before | Phase::After, _, Repeat::AfterReading(items)) => {
                items.of_version(self.version(self.address))
            }
            _ => self.in_force(),
        }
    }

    /// Returns the items in force in the module that replies.
    fn in_force(&self) -> Items {
        let from = self.answerer().unwrap_or_default();
        self.member(from)
            .map(|member| member.items)
            .unwrap_or_default()
    }

    /// Returns the reply if it is long enough. The reply may be invalid.
    pub(super) fn whole(&self) -> Option<Result<Reply, Bad>> {
        let status = Status(*self.input.bytes().first()?);
        let is_rejected = status.contains(Status::CHECKSUM_ERROR);
        let items = if !is_rejected {
            self.expected()
        } else if matches!(self.command, Command::DefineStatus(_)) {
            // An earlier try may have changed the items in force, so the length is not known. The
            // reply ends at the deadline in any case.
            return None;
        } else {
            self.in_force()
        };
        let length = items.length() + 2; // 19 at most
        let heard = self.input.bytes().len();
        if heard != length || self.is_too_long {
            return None; // only at the deadline is it certain that no byte follows
        }
        Some(match Reply::decode(self.input.bytes(), items) {
            Some(_) if is_rejected => Err(Bad::Rejected),
            Some(reply) => Ok(reply),
            None => Err(Bad::Garbled),
        })
    }

    pub(super) fn heard(&mut self, result: Result<Reply, Bad>) {
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
            // One reading does not show the state of all members of a group.
            _ if is_group(self.address) => self.fail_after_flush(Failure::Uncertain),
            // Even a reply that reports "damaged" may itself be damaged.
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

    /// Returns what this reading and the one before show, if they agree.
    fn agreed(&mut self, reply: &Reply) -> Option<Reply> {
        let first = self.first.replace(*reply)?;
        agreement(&first, reply)
    }

    /// Compares two readings in a row, which must agree.
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

    pub(super) fn end(&mut self, outcome: Outcome) {
        self.outcome = Some(outcome);
    }
}

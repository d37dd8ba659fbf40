//! The place of a board on the table, and programs that were taught.

use super::Driver;
use super::bench::{Bench, Work, surroundings};
use super::stepping::Trouble;
use crate::drill::program_text;
use crate::serve::drill_program::Placing;
use crate::serve::loaded::Loaded;
use crate::serve::reply::Reply;
use husillo_transports::drill::{Record, Step};
use serde_json::Value;
use std::sync::mpsc::{Receiver, TryRecvError, sync_channel};
use std::sync::{Arc, PoisonError};

/// The name of a program that was taught.
const TAUGHT: &str = "taught.txt";

/// A board that is being placed, in a thread of its own: STOP and states do not wait for it.
#[derive(Debug)]
pub(super) struct Placement {
    made: Receiver<Result<Loaded, String>>,
    /// Where the answer goes. None: nobody wants it any more.
    reply: Option<Reply>,
    /// The zero from which the holes of the references were measured.
    measured_zero: Option<[u16; 2]>,
}

impl Placement {
    /// Whether its result is wanted.
    pub(super) const fn is_wanted(&self) -> bool {
        self.reply.is_some()
    }
}

impl Bench<'_> {
    /// Begins to place the loaded drill file. The answer is its report, as after it was loaded, or
    /// a sentence about why not. The program then stays as it was.
    pub(super) fn place_board(&mut self, placing: Placing, reply: Reply) {
        let program = self.running.course.program();
        let program = match (self.is_free(), program, &self.placement) {
            (Err(why), ..) => return reply.error(why),
            (_, None, _) => return reply.error("no program is loaded"),
            (.., Some(_)) => return reply.error("the board is still being placed: try again"),
            (Ok(()), Some(program), None) => Arc::clone(program),
        };
        let has_references = !placing.references.is_empty();
        let (to, made) = sync_channel(1);
        std::thread::spawn(move || {
            let text = program.text.clone();
            let placed = Loaded::of_drill(&program.name, text, &surroundings(), &placing);
            // If the driver has ended, nobody wants it.
            let _ = to.send(placed);
        });
        self.placement = Some(Placement {
            made,
            reply: Some(reply),
            measured_zero: has_references.then(|| self.zero()),
        });
    }

    /// Loads the board when it is placed.
    pub(super) fn finish_placing(&mut self) {
        let placed = match self.placement.as_ref().map(|one| one.made.try_recv()) {
            None | Some(Err(TryRecvError::Empty)) => return,
            Some(Err(TryRecvError::Disconnected)) => Err("the board could not be placed".into()),
            Some(Ok(placed)) => placed,
        };
        let placement = self.placement.take();
        let Some((reply, zero)) = placement.and_then(|one| Some((one.reply?, one.measured_zero)))
        else {
            return;
        };
        let loaded = placed.and_then(|program| self.replace(program));
        if loaded.is_ok() && zero.is_some() {
            self.running.measured_zero = zero;
        }
        reply.result(loaded);
    }

    /// The board that is being placed is not wanted any more.
    pub(super) fn drop_placing(&mut self, why: &str) {
        let placement = self.placement.as_mut();
        if let Some(reply) = placement.and_then(|one| one.reply.take()) {
            reply.error(why);
        }
    }

    /// Loads a program that was made here, as if a page had sent it.
    pub(super) fn replace(&mut self, program: Loaded) -> Result<Value, String> {
        let report = program.report.clone();
        let program = Arc::new(program);
        self.load(Arc::clone(&program))?;
        *self
            .machine
            .program
            .lock()
            .unwrap_or_else(PoisonError::into_inner) = Some(program);
        Ok(report)
    }
}

impl Driver<'_> {
    /// Reads the program in the memory of the drill, and loads it.
    pub(super) fn load_taught(&mut self) -> Result<Value, Trouble> {
        self.expect_free()?;
        let place = self.bench.place;
        let count = place.and_then(|place| place.records).unwrap_or(0);
        let mut records = Vec::new();
        self.bench.work = Work::Receive;
        for number in 0..count {
            let read = self.step(Step::Read(number));
            if let Err(trouble) = read {
                self.bench.work = Work::None;
                return Err(trouble);
            }
            records.push(self.client.last_record());
        }
        self.bench.work = Work::None;
        let records: Option<Vec<_>> = records.into_iter().map(Record::from_bytes).collect();
        let records = records.filter(|records| !records.is_empty());
        let records = records.ok_or_else(|| {
            Trouble::refused("the memory of the drill holds no program: teach a hole first")
        })?;
        let text = program_text(&records).map_err(Trouble::Refused)?;
        let placing = Placing::default();
        let made = Loaded::of_drill(TAUGHT, text.into_bytes(), &surroundings(), &placing);
        let made = made.and_then(|program| self.bench.replace(program));
        made.map_err(Trouble::Refused)
    }
}

//! The place of a board on the table, and programs that were taught.

use super::Driver;
use super::bench::{Bench, Work, surroundings};
use super::stepping::Trouble;
use crate::drill::program_text;
use crate::serve::drill_program::Placing;
use crate::serve::loaded::Loaded;
use husillo_transports::drill::{Record, Step};
use serde_json::Value;
use std::sync::{Arc, PoisonError};

/// The name of a program that was taught.
const TAUGHT: &str = "taught.txt";

impl Bench<'_> {
    /// Places the loaded drill file. Returns its report, as after it was loaded.
    ///
    /// # Errors
    ///
    /// A sentence about why not. The program stays as it was.
    pub(super) fn place_board(&mut self, placing: &Placing) -> Result<Value, String> {
        self.is_free()?;
        let before = self
            .running
            .course
            .program()
            .ok_or("no program is loaded")?;
        let text = before.text.clone();
        let placed = Loaded::of_drill(&before.name, text, &surroundings(), placing)?;
        let report = self.replace(placed)?;
        if !placing.references.is_empty() {
            self.running.measured_zero = Some(self.zero());
        }
        Ok(report)
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

//! A drill moved by hand: in the manual mode, or idle.

use super::action::{Action, Axis};
use super::client::{Client, ClientError};
use super::place::Place;
use husillo_controllers::DrillConfig;
use husillo_sim::device::drill::STROKE_STEPS;
use husillo_sim::text::counted;
use husillo_transports::drill::{Failure, Record, Step, record_bytes};
use std::time::Duration;

/// Steps of one key of a jog: a fifth of a second at 247 Hz.
const JOG_STEPS: u8 = 50;
/// Longest time of a key: 255 steps and the moves of Z.
const KEY: Duration = Duration::from_secs(60);
/// Longest time of a key on a drill that reports its faults. Such a drill may home first, and each
/// of its searches has an end.
const KEY_WITH_HOMING: Duration = Duration::from_secs(300);
/// Longest run of a program in the memory, whose duration is unknown.
const LONGEST: Duration = Duration::from_secs(24 * 3600);

/// Writes a program of the drill to the file that [`Action::Save`] names.
///
/// # Errors
///
/// Returns a sentence about the file.
pub type Keep = fn(file: &str, bytes: &[u8]) -> Result<(), String>;

/// A drill that is moved by hand. It is in the manual mode, or idle.
#[derive(Debug)]
pub struct Hand {
    client: Client,
    keep: Keep,
    /// The step size of the manual mode. `None`: the drill is not in the manual mode.
    advance: Option<u8>,
    /// Whether this client has switched the spindle on.
    spindle: bool,
}

impl Hand {
    /// Takes a device that has answered ([`Client::reach`]).
    pub const fn new(client: Client, keep: Keep) -> Self {
        Self {
            client,
            keep,
            advance: None,
            spindle: false,
        }
    }

    /// The client.
    pub const fn client(&mut self) -> &mut Client {
        &mut self.client
    }

    /// Carries out an action. Returns a text about the result, which may be empty.
    ///
    /// # Errors
    ///
    /// Returns a sentence about the failure.
    pub fn carry_out(&mut self, action: &Action) -> Result<String, String> {
        self.do_it(action).map_err(|failed| {
            let sentence = match &failed {
                Failed::Link(error) => error.text(),
                Failed::Other(sentence) => return sentence.clone(),
            };
            match self.leave() {
                Ok(()) => sentence,
                Err(_) if self.spindle => format!("{sentence}; its spindle may turn"),
                Err(_) => sentence,
            }
        })
    }

    /// Longest time of a key.
    const fn longest(&self) -> Duration {
        match self.client.has_extras() {
            true => KEY_WITH_HOMING,
            false => KEY,
        }
    }

    /// After a failure: leaves the manual mode and switches the spindle off.
    fn leave(&mut self) -> Result<(), ClientError> {
        self.advance = None;
        self.client.find_out()?;
        if self.client.has_extras() {
            self.client.run(Step::Spindle(false))?;
            self.spindle = false;
        }
        Ok(())
    }

    fn do_it(&mut self, action: &Action) -> Result<String, Failed> {
        let needs_extras = matches!(
            action,
            Action::Teach | Action::Save(_) | Action::Help | Action::Spindle(_)
        );
        if needs_extras && !self.client.has_extras() {
            // The original switches its spindle in the manual mode only.
            if !matches!(action, Action::Spindle(_)) {
                return Err(Failed::Other(
                    "this drill is an original one, which has no teach-in and no help".into(),
                ));
            }
            self.manual(JOG_STEPS)?;
        }
        match action {
            // An earlier run was ended when the drill was reached.
            Action::Stop => {
                self.advance = None;
                self.client.reach()?;
                if self.client.has_extras() {
                    self.client.run(Step::Spindle(false))?;
                    self.spindle = false;
                }
            }
            Action::Home if self.advance.is_some() => self.key(b'r')?,
            Action::Home => self.client.run_for(Step::Home, self.longest(), |_| {})?,
            Action::Steps(axis, steps) => {
                if !self.steps(*axis, *steps)? {
                    return Ok(at_end(*axis));
                }
            }
            Action::Jog(axis, forward, time) => {
                self.manual(JOG_STEPS)?;
                let end = self.client.elapsed() + *time;
                while self.client.elapsed() < end && !self.client.is_stopping() {
                    if !self.moved(axis.key(*forward))? {
                        return Ok(at_end(*axis));
                    }
                }
            }
            Action::Spindle(on) => {
                self.spindle |= *on;
                match self.advance {
                    Some(_) => self.key(if *on { b'O' } else { b'S' })?,
                    None => self.client.run(Step::Spindle(*on))?,
                }
                self.spindle = *on;
            }
            Action::Teach => {
                self.manual(JOG_STEPS)?;
                self.client.run(Step::Teach)?;
            }
            Action::Save(file) => return self.save(file),
            Action::Run => return self.run(),
            Action::Clear if self.advance.is_some() => self.key(b'c')?,
            Action::Clear => self.client.run(Step::Clear)?,
            Action::Test => {
                self.idle()?;
                self.client.run(Step::Test)?;
            }
            Action::Where if !self.client.has_extras() => return Ok(Place::of_original()),
            Action::Where => return Ok(Place::read(&mut self.client)?.to_string()),
            Action::Help => {
                self.idle()?;
                return Ok(self.client.help()?.trim_end().to_owned());
            }
        }
        if self.client.is_stopping() {
            return Err(Failed::Link(ClientError::Stopped));
        }
        Ok(String::new())
    }

    /// Runs the program in the memory with the spindle on.
    fn run(&mut self) -> Result<String, Failed> {
        if !self.client.has_extras() {
            return Err(Failed::Other(
                "this is an original drill, which does not report its program: run programs with \
                 `husillo send`"
                    .into(),
            ));
        }
        self.idle()?;
        let holes = whole(&self.client.program()?).map_err(Failed::Other)?;
        self.spindle = true;
        self.client.run(Step::Spindle(true))?;
        self.client.run_for(Step::Execute, LONGEST, |_| {})?;
        self.client.run(Step::Spindle(false))?;
        self.spindle = false;
        Ok(format!(
            "{}, with the spindle on",
            counted(holes, "drilling")
        ))
    }

    /// Moves an axis by signed steps. Returns `false` if the axis reached its end first.
    fn steps(&mut self, axis: Axis, steps: i32) -> Result<bool, Failed> {
        let mut left = steps.unsigned_abs();
        while left > 0 {
            let part = u8::try_from(left).unwrap_or(u8::MAX);
            self.manual(part)?;
            if self.advance != Some(part) {
                self.client.run(Step::Advance(part))?;
                self.advance = Some(part);
            }
            if !self.moved(axis.key(steps > 0))? {
                return Ok(false);
            }
            left -= u32::from(part);
            if self.client.is_stopping() {
                break;
            }
        }
        Ok(true)
    }

    /// Sends a key that moves an axis. Returns `false` if the axis reached its end first.
    fn moved(&mut self, key: u8) -> Result<bool, Failed> {
        match self.client.run_for(Step::Key(key), self.longest(), |_| {}) {
            Ok(()) => Ok(true),
            Err(ClientError::Link(Failure::NotAll)) => Ok(false),
            Err(error) => Err(Failed::Link(error)),
        }
    }

    fn save(&mut self, file: &str) -> Result<String, Failed> {
        self.idle()?;
        let program = self.client.program()?;
        let records: Option<Vec<_>> = program.into_iter().map(Record::from_bytes).collect();
        let records =
            records.ok_or_else(|| Failed::Other("its memory holds no valid program".into()))?;
        if records.is_empty() {
            return Err(Failed::Other(
                "its memory holds no program: nothing to save".into(),
            ));
        }
        let count = records.len();
        let all: Vec<u8> = record_bytes(records).collect();
        (self.keep)(file, &all).map_err(Failed::Other)?;
        Ok(format!("{file}: {}", counted(count, "record")))
    }

    fn key(&mut self, key: u8) -> Result<(), Failed> {
        Ok(self
            .client
            .run_for(Step::Key(key), self.longest(), |_| {})?)
    }

    /// Enters the manual mode with this step size. The drill homes first.
    fn manual(&mut self, advance: u8) -> Result<(), Failed> {
        if self.advance.is_none() {
            if self.client.has_extras() {
                // Holes that were taught before are kept.
                self.client
                    .run_for(Step::ManualKept(advance), KEY_WITH_HOMING, |_| {})?;
            } else {
                // A wrong bit turns `m` into `e`, which runs the program. So the program is cleared
                // first.
                self.client.run(Step::Clear)?;
                self.client.run_for(Step::Manual(advance), KEY, |_| {})?;
            }
            self.advance = Some(advance);
        }
        Ok(())
    }

    /// Leaves the manual mode.
    ///
    /// # Errors
    ///
    /// The link failed.
    fn idle(&mut self) -> Result<(), Failed> {
        if self.advance.take().is_some() {
            self.client.run(Step::Quit)?;
        }
        Ok(())
    }

    /// Leaves the manual mode, because the next client expects an idle drill.
    ///
    /// # Errors
    ///
    /// Returns a sentence about the failure.
    pub fn end(&mut self) -> Result<(), String> {
        self.idle().map_err(|failed| match failed {
            Failed::Link(error) => error.text(),
            Failed::Other(sentence) => sentence,
        })
    }
}

fn at_end(axis: Axis) -> String {
    format!("{} is at its end: not all of it was done", axis.name())
}

/// Number of drillings of a program that was read back.
///
/// # Errors
///
/// There is no program, or it is incomplete because the link failed during its transfer.
fn whole(program: &[[u8; 3]]) -> Result<usize, String> {
    let [last_x, last_y] = DrillConfig::FIXED.travel_steps;
    let is_good = |record: &Record| match *record {
        Record::X(x) => x <= last_x,
        Record::Y(y) => y <= last_y,
        Record::Drill(depth) => depth <= STROKE_STEPS,
    };
    let records: Option<Vec<_>> = (program.iter())
        .map(|record| Record::from_bytes(*record).filter(is_good))
        .collect();
    let ends_well = |records: &Vec<Record>| {
        matches!(
            records[..],
            [.., Record::Drill(_)] | [.., Record::X(0), Record::Y(0)]
        )
    };
    match records {
        Some(records) if records.is_empty() => Err(
            "its memory holds no program (of a program longer than its memory it keeps only the \
             end)"
                .into(),
        ),
        Some(records) if ends_well(&records) => {
            let is_drilling = |record: &&Record| matches!(record, Record::Drill(_));
            Ok(records.iter().filter(is_drilling).count())
        }
        _ => Err("its program is incomplete: `clear` it, or send it again".into()),
    }
}

enum Failed {
    Link(ClientError),
    Other(String),
}

impl From<ClientError> for Failed {
    fn from(error: ClientError) -> Self {
        Failed::Link(error)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_a_program_is_not_run() {
        let hole = [*b"X\x01\0", *b"Y\x02\0", *b"Z\0\0"];
        assert_eq!(whole(&hole), Ok(1));
        assert_eq!(whole(&[&hole[..], &[*b"X\0\0", *b"Y\0\0"]].concat()), Ok(1));
        assert!(whole(&[]).unwrap_err().contains("no program"));
        // The program is cut off. The `f` bytes that bring a device to rest have filled it up.
        for part in [*b"X\x01f", *b"Xff", *b"Z\x01f", *b"Y\x02\0", *b"f\x01\0"] {
            let program = [&hole[..], &[part]].concat();
            assert!(
                whole(&program).unwrap_err().contains("is incomplete"),
                "{part:?}"
            );
        }
    }
}

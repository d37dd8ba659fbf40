//! Steps on the link: each is carried out to its end, while pages are attended to.

use super::Driver;
use super::bench::Work;
use crate::serve::console_lines::From;
use husillo_clients::drill::{Client, ClientError, Going, Place};
use husillo_transports::drill::{Failure, Reading, Step};
use std::time::Duration;

/// Longest homing. Each of its searches has an end of its own.
const HOMING: Duration = Duration::from_secs(300);
/// Longest record: a move over the whole table, or a drilling.
const RECORD: Duration = Duration::from_secs(180);

/// Why a step was not made.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Trouble {
    /// It cannot be done now. Nothing has moved.
    Refused(String),
    /// The axis reached its end before all steps were made.
    AtEnd,
    /// STOP was pressed, or the operator has gone.
    Halted(&'static str),
    /// It failed, and the drill is at rest.
    Failed(String),
    /// The controller is lost.
    Lost(String),
}

impl Trouble {
    pub(super) fn refused(why: impl Into<String>) -> Self {
        Self::Refused(why.into())
    }

    pub(super) fn lost(error: ClientError) -> Self {
        Self::Lost(error.text())
    }

    /// Nothing, if the drill is at rest and answers.
    pub(super) fn unless_lost(self) -> Result<(), Self> {
        match self {
            Self::Lost(_) => Err(self),
            _ => Ok(()),
        }
    }

    /// It as a sentence.
    pub(super) fn text(self) -> String {
        match self {
            Self::Refused(why) | Self::Failed(why) | Self::Lost(why) => why,
            Self::AtEnd => "the axis is at its end: not all of it was done".into(),
            Self::Halted(why) => why.into(),
        }
    }
}

impl Driver<'_> {
    /// Carries out a step. A STOP ends it, unless it is over sooner by itself.
    pub(super) fn step(&mut self, step: Step) -> Result<(), Trouble> {
        let longest = match step {
            Step::Home | Step::ManualKept(_) | Step::Key(b'r') => HOMING,
            Step::Execute => RECORD,
            _ => Duration::ZERO,
        };
        let may_end = longest > Duration::ZERO;
        let begun = self.client.elapsed();
        let bench = &mut self.bench;
        let result = self.client.run_while(step, longest, |passed| {
            bench.now = begun + passed;
            bench.attend();
            match may_end && bench.must_halt() {
                true => Going::Silent,
                false => Going::On,
            }
        });
        self.bench.now = self.client.elapsed();
        self.bench.tell_reports(self.client.take_reports());
        match result {
            Ok(()) => Ok(()),
            Err(ClientError::Link(Failure::NotAll)) => Err(Trouble::AtEnd),
            Err(ClientError::Link(Failure::Full)) => Err(Trouble::Failed(
                "the memory of the drill has no room for another hole".into(),
            )),
            Err(error) => Err(self.rest_after(&error)),
        }
    }

    /// Carries out a step, and shows meanwhile what works.
    pub(super) fn work(&mut self, work: Work, step: Step) -> Result<(), Trouble> {
        self.bench.work = work;
        let done = self.step(step);
        self.bench.work = Work::None;
        done
    }

    /// Brings the drill to rest after a step that has failed.
    fn rest_after(&mut self, error: &ClientError) -> Trouble {
        self.bench.is_manual = false;
        let why = error.text();
        if self.bench.halting.is_none() && !is_gone(error) {
            // To find out takes some seconds.
            let text = format!("{why}; the drill is asked what it does");
            self.bench.machine.tell(From::Server, text);
        }
        self.bench.show();
        if is_gone(error) || self.client.find_out().is_err() {
            return Trouble::Lost(why);
        }
        self.bench.has_spindle = false;
        let off = self.client.run(Step::Spindle(false)).map_err(Trouble::lost);
        if let Err(trouble) = off.and_then(|()| self.read_place()) {
            return trouble;
        }
        match self.bench.halting {
            Some(why) => Trouble::Halted(why),
            None => Trouble::Failed(why),
        }
    }

    /// Reads where the drill is.
    pub(super) fn read_place(&mut self) -> Result<(), Trouble> {
        let place = self.ask(Place::read)?;
        self.bench.has_spindle = place.machine.spindle_turns;
        self.bench.place = Some(place);
        Ok(())
    }

    /// Asks a drill at rest for its sensors and its spindle.
    pub(super) fn ask_state(&mut self) -> Result<(), Trouble> {
        let (_, bits) = self.ask(|client| client.read(Reading::State))?;
        if let Some(place) = &mut self.bench.place {
            place.machine.set_bits(bits);
            self.bench.has_spindle = place.machine.spindle_turns;
        }
        Ok(())
    }

    /// Asks a drill at rest. After a byte that was lost it asks once more: nothing moves, so a
    /// program that waits is not ended by that. The manual mode is.
    fn ask<T>(
        &mut self,
        question: impl Fn(&mut Client) -> Result<T, ClientError>,
    ) -> Result<T, Trouble> {
        let error = match question(&mut self.client) {
            Ok(answer) => return Ok(answer),
            Err(error) => error,
        };
        if is_gone(&error) || self.client.find_out().is_err() {
            return Err(Trouble::lost(error));
        }
        let mut text = format!("asked once more: {}", error.text());
        if std::mem::take(&mut self.bench.is_manual) {
            text += "; the manual mode has ended";
        }
        self.bench.machine.tell(From::Server, text);
        question(&mut self.client).map_err(Trouble::lost)
    }
}

/// Whether a drill cannot be asked again after this error.
const fn is_gone(error: &ClientError) -> bool {
    matches!(
        error,
        ClientError::Port(_) | ClientError::Link(Failure::Fault | Failure::Restarted)
    )
}

//! What the controller sends.

use super::{Driver, From, Purpose};
use husillo_clients::grbl::{Heard, described};
use husillo_transports::grbl::{Message, State};
use serde_json::json;

impl Driver<'_> {
    /// Handles what the controller has sent.
    ///
    /// # Errors
    ///
    /// The controller is lost.
    pub(super) fn hear(&mut self, heard: Heard) -> Result<(), String> {
        match &heard {
            Heard::Status(status) => {
                self.zero_is_due = false;
                self.state.report(&self.session, self.alarm);
                if self.session.state() != Some(State::Alarm) {
                    self.alarm = None;
                }
                if status.overrides.is_some() {
                    self.adjust()?;
                }
                self.sequence_reported();
                self.program_reported();
                self.change_reported()?;
            }
            Heard::Ok => self.answered(None)?,
            Heard::Refused(number) => self.answered(Some(*number))?,
            Heard::Alarm(number) => {
                self.machine
                    .tell(From::Controller, format!("ALARM:{number}"));
                self.alarm = Some(*number);
                let why = husillo_clients::grbl::alarm(*number);
                self.note_alarm(&why);
                self.fail_program(&why);
                self.end_sequence(&why);
                self.state.why = Some(why);
                if self.halting.is_none() {
                    // After some alarms the controller answers only after a reset. Nothing moves.
                    self.begin_halt(true, "an alarm has ended the motion")?;
                }
            }
            Heard::Started(name) => {
                self.machine.tell(From::Controller, name.as_str());
                self.state.controller = Some(name.clone());
                // A reset has ended them.
                self.wanted = [None, None];
                if self.halting.is_none() {
                    self.drop_lines("the controller was reset");
                    self.settings_are_due = true;
                    self.modes_are_due = true;
                }
            }
            Heard::Text(text) => self.text(text),
        }
        self.hear_halt(&heard);
        Ok(())
    }

    /// Handles the answer to a line: accepted, or refused with a number.
    ///
    /// # Errors
    ///
    /// The controller is lost.
    fn answered(&mut self, refused: Option<u16>) -> Result<(), String> {
        let text = refused.map_or("ok".to_owned(), |number| format!("error:{number}"));
        let Some(purpose) = self.stream.answered() else {
            self.machine.tell(From::Controller, text);
            return Ok(());
        };
        let is_shown =
            !matches!(purpose, Purpose::Known) && (refused.is_some() || !is_jog(&purpose));
        if is_shown {
            self.machine.tell(From::Controller, text);
            self.modes_are_due = true;
            self.zero_is_due = true;
        }
        let result = refused.map_or(Ok(()), |number| Err(described(number)));
        match purpose {
            Purpose::Asked(reply) => {
                if result.is_ok() {
                    self.state.why = None;
                }
                reply.with(result);
            }
            Purpose::Home(reply) => {
                self.session.allow_silence(None);
                reply.with(result);
            }
            Purpose::Zero(reply, before, data) => match result {
                Ok(()) => {
                    self.zeroing.keep(before);
                    reply.data(data);
                }
                Err(why) => reply.error(why),
            },
            Purpose::Undo(reply) => {
                if result.is_ok() {
                    self.zeroing.restored();
                }
                reply.with(result);
            }
            Purpose::Jog => self.jog_answered(result),
            Purpose::Sequence { .. } => {
                self.session.allow_silence(None);
                return self.sequence_answered(result);
            }
            Purpose::Program => return self.program_answered(result),
            Purpose::Synchronise => self.synchronised(),
            Purpose::Change => return self.change_answered(result),
            Purpose::Settings(reply) => match result {
                Ok(()) => reply.data(self.settings_list()),
                Err(why) => reply.error(why),
            },
            Purpose::Written => {
                if let Err(why) = result {
                    self.state.why = Some(why);
                }
            }
            Purpose::Known => {}
        }
        Ok(())
    }

    /// Handles a line that is no answer.
    fn text(&mut self, text: &str) {
        match Message::parse(text.as_bytes()) {
            Some(Message::Modal(modes)) => self.state.modes(&modes),
            // `$#` repeats the last contact.
            Some(Message::Probe(..)) if matches!(self.stream.next(), Some(Purpose::Known)) => {}
            Some(Message::Probe(at, is_touched)) => {
                let at: Vec<_> = at.nm().iter().map(|nm| *nm as f64 / 1e6).collect();
                let before = self.state.probe.as_ref();
                let count = before.map_or(0, |probe| probe["count"].as_u64().unwrap_or(0)) + 1;
                self.state.probe =
                    Some(json!({"at_mm": at, "touched": is_touched, "count": count}));
            }
            Some(Message::Options(_, moves, _)) => self.queue_moves = moves.into(),
            Some(Message::Version(version, _)) if self.state.controller.is_none() => {
                let version = String::from_utf8_lossy(version);
                self.state.controller = Some(format!("Grbl {version}"));
            }
            _ => {}
        }
        if let Some(lengths) = text.strip_prefix("[TLO:") {
            // grblHAL has a length for each axis.
            let z = lengths.trim_end_matches(']').rsplit(',').next();
            self.state.tool_length_mm = z.and_then(|z| z.parse().ok());
        }
        // Numbers that Grbl does not have belong to a newer controller.
        if let Some((number, value)) = text.strip_prefix('$').and_then(|rest| rest.split_once('='))
        {
            if let Ok(number) = number.parse() {
                self.settings.insert(number, value.to_owned());
            }
        }
        if !matches!(self.stream.next(), Some(Purpose::Known)) {
            self.machine.tell(From::Controller, text);
        }
    }
}

const fn is_jog(purpose: &Purpose) -> bool {
    matches!(purpose, Purpose::Jog)
}

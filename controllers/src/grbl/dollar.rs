//! `$` commands.

use husillo_transports::grbl::{ErrorCode, Feedback, Message, Settings, key_and_value};

use super::event::GrblEvent;
use super::lines::{Origin, Outcome, Task};
use super::memory::StoredLine;
use super::{Grbl, GrblMemory, Phase};

const HELP: &[u8] = b"$$ $# $G $I $N $x=val $Nx=line $J=line $SLP $C $X $H ~ ! ? ctrl-x";

impl<const QUEUE: usize> Grbl<QUEUE> {
    /// Requests that the caller stores the memory.
    pub(super) fn store(&mut self) {
        self.is_blank = false;
        self.switch(GrblEvent::Store);
    }

    /// Executes the text after `$`.
    ///
    /// # Errors
    /// Fails with the error that answers the line.
    pub(super) fn dollar(&mut self, text: &[u8]) -> Result<Outcome, ErrorCode> {
        match text {
            [] => self.send(&Message::Help(HELP)),
            [b'$' | b'G' | b'C' | b'X', _, ..] | [b'J'] => return Err(ErrorCode::InvalidStatement),
            b"$" => {
                if matches!(self.phase, Phase::Run | Phase::Hold(_)) || self.is_busy() {
                    return Err(ErrorCode::NotIdle);
                }
                self.list_settings();
            }
            b"G" => self.report_modal(),
            [b'L', rest @ ..] => return self.switch_checks(rest),
            b"C" => return self.toggle_check(),
            b"X" => {
                if self.phase == Phase::Alarm {
                    if self.is_door_open() {
                        return Err(ErrorCode::DoorOpen);
                    }
                    self.send(&Message::Feedback(Feedback::Unlocked));
                    self.phase = Phase::Idle;
                }
            }
            [b'J', rest @ ..] => {
                if !matches!(self.phase, Phase::Idle | Phase::Jog) || self.is_busy() {
                    return Err(ErrorCode::NotIdle);
                }
                let line = rest.strip_prefix(b"=").ok_or(ErrorCode::InvalidStatement)?;
                return self.jog(line);
            }
            _ if !matches!(self.phase, Phase::Idle | Phase::Alarm) || self.is_underway() => {
                return Err(ErrorCode::NotIdle);
            }
            b"SLP" => return Ok(Outcome::Sleep),
            _ if !self.is_drained() => {
                self.task = Task::Sync;
                return Ok(Outcome::Waits);
            }
            _ => return self.dollar_at_rest(text),
        }
        Ok(Outcome::Done)
    }

    /// Whether moves other than jogs are about to begin.
    fn is_busy(&self) -> bool {
        self.phase == Phase::Idle && self.is_underway()
    }

    /// Executes commands that are permitted only in Idle or Alarm.
    pub(super) fn dollar_at_rest(&mut self, text: &[u8]) -> Result<Outcome, ErrorCode> {
        match text {
            b"#" => self.list_places(),
            b"I" => self.report_version(),
            [b'I', b'=', user @ ..] => {
                self.memory.lines[2] = StoredLine::new(user);
                self.store();
            }
            b"N" => self.list_lines(),
            [b'N', rest @ ..] => return self.store_line(rest),
            [b'H', axes @ ..] => return self.home(axes),
            [b'R', rest @ ..] => return self.restore_defaults(rest),
            #[cfg(feature = "height-map")]
            [b'Z', rest @ ..] => return self.map_command(rest),
            [b'#' | b'I' | b'S', ..] => return Err(ErrorCode::InvalidStatement),
            _ => self.write_setting(text)?,
        }
        Ok(Outcome::Done)
    }

    fn toggle_check(&mut self) -> Result<Outcome, ErrorCode> {
        if self.phase == Phase::Check {
            self.send(&Message::Feedback(Feedback::Disabled));
            return Ok(Outcome::Reset);
        }
        if self.phase != Phase::Idle || self.machine.queued() > 0 {
            return Err(ErrorCode::NotIdle);
        }
        self.phase = Phase::Check;
        self.send(&Message::Feedback(Feedback::Enabled));
        Ok(Outcome::Done)
    }

    /// Stores a line (`$Nx=line`) after it was executed once.
    fn store_line(&mut self, text: &[u8]) -> Result<Outcome, ErrorCode> {
        let (number, line) = key_and_value(text)?;
        if number > 1 {
            return Err(ErrorCode::InvalidStatement);
        }
        if self.phase == Phase::Alarm {
            return Err(ErrorCode::NotIdle);
        }
        self.line = StoredLine::new(line);
        self.origin = Origin::Store(number);
        let line = self.line;
        if line.bytes().is_empty() {
            return Ok(Outcome::Done);
        }
        self.block(line.bytes())
    }

    fn restore_defaults(&mut self, text: &[u8]) -> Result<Outcome, ErrorCode> {
        let factory = GrblMemory::FACTORY;
        match text {
            b"ST=$" => {
                self.memory.settings = factory.settings;
                #[cfg(feature = "grblhal")]
                self.memory.hal.restore_settings();
            }
            b"ST=#" => {
                self.memory.places = factory.places;
                #[cfg(feature = "grblhal")]
                self.memory.hal.restore_places();
            }
            b"ST=*" => self.memory = factory,
            _ => return Err(ErrorCode::InvalidStatement),
        }
        self.store();
        self.send(&Message::Feedback(Feedback::RestoringDefaults));
        self.configure();
        self.refresh_motors();
        Ok(Outcome::Reset)
    }

    fn write_setting(&mut self, text: &[u8]) -> Result<(), ErrorCode> {
        let (number, value) = key_and_value(text)?;
        let mut settings = *self.settings();
        settings.write(number, value)?;
        if let (Some(most), 100..=112) = (self.options.most_steps_per_s, number) {
            let axis = number % 10;
            let per_mm = u64::from(settings.milli(100_u8.saturating_add(axis)));
            let per_min = u64::from(settings.milli(110_u8.saturating_add(axis)));
            // Both are below 2^32.
            if per_mm.wrapping_mul(per_min) / 60_000_000 > u64::from(most) {
                return Err(ErrorCode::StepRate);
            }
        }
        self.take_settings(settings, number.into());
        Ok(())
    }

    /// Takes settings into use after the write of one of them.
    pub(super) fn take_settings(&mut self, settings: Settings, number: u16) {
        if settings == *self.settings() {
            return;
        }
        self.memory.settings = settings;
        self.store();
        self.configure();
        self.outputs.is_laser = settings.is_set(32);
        self.refresh_motors();
        self.drive();
        if number == 13 {
            self.report_work_zero();
        }
    }
}

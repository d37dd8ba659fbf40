//! Lines and `$` commands.

use husillo_transports::grbl::{Alarm, ErrorCode, Feedback, Message, decimal};

use super::super::lines::{Outcome, Task};
use super::super::memory::StoredLine;
use super::super::{Grbl, Phase};
use super::Hal;
use super::line::{block_of, message_of};
use super::list::{Form, Listing};
use super::setting::{BEGINS_IN_ALARM, SLEEPS};

impl<const QUEUE: usize> Grbl<QUEUE> {
    /// Sends the text of a comment `(MSG,text)` of a line.
    pub(in super::super) fn hal_say(&mut self, line: &[u8]) {
        let is_locked = matches!(self.phase, Phase::Alarm | Phase::Jog);
        if is_locked || self.hal.refusal.is_some() || line.starts_with(b"$") {
            return;
        }
        if let Some(text) = message_of(line) {
            self.send(&Message::Feedback(Feedback::Other(text)));
        }
    }

    /// Executes a line as it was sent.
    pub(in super::super) fn hal_execute(&mut self, line: &[u8]) -> Result<Outcome, ErrorCode> {
        let line = line.trim_ascii();
        match line {
            [] => {
                self.hal.refusal = None;
                Ok(Outcome::Done)
            }
            [b'$', text @ ..] => {
                self.hal.refusal = None;
                self.hal_dollar(text)
            }
            [b'/', ..] if self.hal.deletes_blocks => Ok(Outcome::Done),
            _ if matches!(self.phase, Phase::Alarm | Phase::Jog) => Err(ErrorCode::Locked),
            _ if self.hal.refusal.is_some() => {
                let refusal = self.hal.refusal.unwrap_or(ErrorCode::Locked);
                Err(refusal)
            }
            _ if self.hal.stash.is_some() => Err(ErrorCode::ToolChange),
            line => {
                let (text, length) = block_of(line.strip_prefix(b"/").unwrap_or(line));
                match text.get(..length).unwrap_or_default() {
                    [] | [b'%'] => Ok(Outcome::Done),
                    text => self.block(text),
                }
            }
        }
    }

    /// Handles the end of a line. Its error refuses the blocks that follow.
    pub(in super::super) fn hal_end_line(&mut self, result: Result<Outcome, ErrorCode>) {
        match result {
            Err(ErrorCode::Locked) => {}
            Err(error) => self.hal.refusal = Some(error),
            Ok(Outcome::Done) if self.hal.change.is_requested() => self.hal_begin_change(),
            Ok(_) => self.hal.holds_next |= self.hal.is_single_block && !self.is_drained(),
        }
    }

    /// Whether the end of a program resets the overrides.
    pub(in super::super) fn hal_restores_overrides(&self) -> bool {
        self.hal_is_set(super::setting::RESTORES_OVERRIDES)
    }

    fn hal_dollar(&mut self, text: &[u8]) -> Result<Outcome, ErrorCode> {
        // Texts keep their case.
        if let [b'I' | b'i', b'=', user @ ..] = text {
            if !self.hal_is_at_rest() {
                return Err(ErrorCode::NotIdle);
            }
            self.memory.lines[2] = StoredLine::new(user);
            self.store();
            return Ok(Outcome::Done);
        }
        let (upper, length) = block_of(text);
        let upper = upper.get(..length).unwrap_or_default();
        if let [b'H', b'E', b'L', b'P', ..] = upper {
            return Ok(self.hal_help(text.get(4..).unwrap_or_default()));
        }
        match upper {
            [] => self.hal_line(&[HELP]),
            b"#" => self.hal_places(),
            b"G" => self.report_modal(),
            b"S" | b"B" | b"O" => self.hal_toggle(upper),
            b"TLR" => self.hal_take_reference(),
            b"SPINDLES" => self.hal_line(&["0 - PWM spindle"]),
            b"SPINDLESH" => self.hal_spindle(),
            b"PINS" | b"PINSTATE" | b"DWNGRD" => {}
            b"LEV" => self.hal_line(&["[LASTEVENTS:,,,,]"]),
            b"LIM" => self.hal_limits(),
            b"X" => return self.hal_unlock(),
            b"SLP" if !self.hal_is_set(SLEEPS) => return Err(ErrorCode::InvalidStatement),
            b"$" | b"+" if self.hal_is_at_rest() => {
                return Ok(self.hal_begin_list(Listing::Values));
            }
            b"$" | b"+" => return Err(ErrorCode::NotIdle),
            [b'J', ..] if self.hal.is_acknowledged() && self.phase == Phase::Tool => {
                self.phase = Phase::Idle;
                let result = self.dollar(upper);
                if result.is_err() {
                    self.phase = Phase::Tool;
                }
                return result;
            }
            [b'C'] | [b'J', ..] | b"L" | [b'L', b'=', ..] | b"SLP" => return self.dollar(upper),
            _ if !self.hal_is_at_rest() => return Err(ErrorCode::NotIdle),
            _ if !self.is_drained() => {
                self.task = Task::Sync;
                return Ok(Outcome::Waits);
            }
            _ => return self.hal_at_rest(upper),
        }
        Ok(Outcome::Done)
    }

    fn hal_is_at_rest(&self) -> bool {
        let is_waiting = self.hal.stash.is_some() && self.phase == Phase::Tool;
        (matches!(self.phase, Phase::Idle | Phase::Alarm) || is_waiting) && !self.is_underway()
    }

    /// Executes commands that are permitted only in Idle and Alarm.
    fn hal_at_rest(&mut self, text: &[u8]) -> Result<Outcome, ErrorCode> {
        let list = match text {
            b"EG" => Listing::Groups,
            b"EA" => Listing::Alarms(false),
            b"EAG" => Listing::Alarms(true),
            b"EE" => Listing::Errors(false),
            b"EEG" => Listing::Errors(true),
            b"ES" => Listing::Settings(Form::Fields),
            b"ESG" => Listing::Settings(Form::Commas),
            b"ESH" => Listing::Settings(Form::Tabs),
            b"TPW" => return self.hal_measure(),
            b"I" | b"I+" => {
                self.hal_version();
                return Ok(Outcome::Done);
            }
            [b'E', b'S', b'=', number @ ..] => {
                let id = number_of(number).ok_or(ErrorCode::BadNumber)?;
                return self.hal_one(id, Some(Form::Fields));
            }
            [b'N'] | [b'N', b'0'..=b'9', ..] | [b'H' | b'R', ..] => {
                return self.dollar_at_rest(text);
            }
            #[cfg(feature = "height-map")]
            [b'Z', rest @ ..] => return self.map_command(rest),
            text => return self.hal_setting_line(text),
        };
        Ok(self.hal_begin_list(list))
    }

    /// `$110` sends a setting, and `$110=500` writes it.
    fn hal_setting_line(&mut self, text: &[u8]) -> Result<Outcome, ErrorCode> {
        let at = text.iter().position(|byte| *byte == b'=');
        let (number, value) = text
            .split_at_checked(at.unwrap_or(text.len()))
            .unwrap_or_default();
        let id = number_of(number).ok_or(ErrorCode::InvalidStatement)?;
        match value.strip_prefix(b"=") {
            Some(value) => {
                self.hal_write(id, value)?;
                Ok(Outcome::Done)
            }
            None => self.hal_one(id, None),
        }
    }

    fn hal_toggle(&mut self, which: &[u8]) {
        let hal = &mut self.hal;
        let switch = match which {
            b"S" => &mut hal.is_single_block,
            b"B" => &mut hal.deletes_blocks,
            _ => &mut hal.ignores_optional_stop,
        };
        *switch = !*switch;
        let feedback = if *switch {
            Feedback::Enabled
        } else {
            Feedback::Disabled
        };
        self.send(&Message::Feedback(feedback));
    }

    fn hal_spindle(&mut self) {
        let (least, most) = (self.settings().milli(31), self.settings().milli(30));
        let range = [least, most].map(|milli| {
            let mut text = husillo_transports::grbl::Text::new();
            text.put_decimal(i64::from(milli) / 100, 1);
            text
        });
        let [least, most] = &range;
        let (least, most) = (super::list::ascii(least), super::list::ascii(most));
        self.hal_line(&["[SPINDLE:0|0|0|*DRV|PWM spindle|", least, ",", most, "]"]);
    }

    fn hal_limits(&mut self) {
        let closed = [0, 1, 2].map(|axis| self.is_limit_closed(axis));
        let letter = |axis: usize, name| {
            if closed.get(axis) == Some(&true) {
                name
            } else {
                ""
            }
        };
        let letters = [letter(0, "X"), letter(1, "Y"), letter(2, "Z")];
        let [x, y, z] = letters;
        self.hal_line(&["[LIMITS:", x, y, z, ",,,]"]);
    }

    fn hal_unlock(&mut self) -> Result<Outcome, ErrorCode> {
        if self.hal_needs_homing() {
            return Err(ErrorCode::HomingRequired);
        }
        let result = self.dollar(b"X");
        if self.hal.is_acknowledged() && self.phase == Phase::Idle {
            // A measurement has failed, and the change goes on.
            self.hal_wait_again();
        }
        result
    }

    /// Handles the begin of homing, which is reported, and its end.
    pub(in super::super) fn hal_homes(&mut self, is_homed: bool) {
        self.hal.is_homed = is_homed;
        self.hal.shown.with_home = true;
        if !is_homed {
            self.hal_report(false);
        }
    }

    /// Whether the axes must be homed before anything else.
    pub(in super::super) fn hal_needs_homing(&self) -> bool {
        self.hal_homing_has(2) && !self.hal.is_homed
    }

    /// Begins a run after a reset, or after power-on.
    pub(in super::super) fn hal_start(&mut self) {
        let is_power_on = !self.hal.has_started;
        let change = self.hal.change.after_reset();
        self.hal = Hal {
            change,
            ..self.hal.after_reset()
        };
        self.reports = [1; 2];
        self.hal_load();
        self.change_modes(b"G0");
        self.hal.shown.frame = self.modal.work_system();
        if is_power_on && self.hal_is_set(super::setting::KEEPS_TOOL) {
            self.hal.change.tool = self.memory.hal.tool;
        }
        if self.hal_needs_homing() || is_power_on && self.hal_is_set(BEGINS_IN_ALARM) {
            self.phase = Phase::Alarm;
        }
        self.hal.is_power_on = is_power_on;
    }

    /// Sends what follows the banner of a locked controller.
    pub(in super::super) fn hal_tell_lock(&mut self) {
        if !self.hal_needs_homing() {
            return self.send(&Message::Feedback(Feedback::Unlock));
        }
        if self.hal.is_power_on {
            self.send(&Message::Alarm(Alarm::HomingRequired));
        }
        self.send(&Message::Feedback(Feedback::Other(
            b"Homing cycle required",
        )));
    }

    /// Brakes before a reset. Returns whether the axes still move.
    pub(in super::super) fn hal_brakes(&mut self) -> bool {
        if !self.moves() || self.phase == Phase::Home {
            return false;
        }
        if !self.machine.is_held() {
            self.machine.hold();
        }
        true
    }

    /// Whether the machine holds now, because it holds after each block.
    pub(in super::super) fn hal_holds(&mut self) -> bool {
        if !self.hal.holds_next || !self.is_drained() {
            return false;
        }
        self.hal.holds_next = false;
        self.phase = Phase::Hold(false);
        true
    }

    /// Whether the present block has to be made before the next one begins.
    pub(in super::super) fn hal_is_waiting(&self) -> bool {
        self.hal.holds_next
    }
}

const HELP: &str = "[HLP:$$ $# $G $I $N $x=val $Nx=line $J=line $SLP $C $X $H $B ~ ! ? ctrl-x]";

fn number_of(text: &[u8]) -> Option<u16> {
    match decimal(text, 0)? {
        (number, []) => u16::try_from(number).ok(),
        _ => None,
    }
}

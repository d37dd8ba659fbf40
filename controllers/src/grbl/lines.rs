//! Execution of lines, one after another, and their answers.

use husillo_gcode::{Command, Commands, Nm, SpindleDirection};
use husillo_machine::MoveError;
use husillo_transports::grbl::{ErrorCode, Feedback, Line, Message, Text};

#[cfg(feature = "grblhal")]
use super::block::modes;
use super::block::{apply, motion_code};
#[cfg(feature = "grblhal")]
use super::hal::{Listing, RawLine};
use super::memory::StoredLine;
use super::motion::{START_US, Tag};
use super::words::{CodeSet, Given, WordReader, bit};
use super::{Grbl, LINE, Phase};

/// The origin of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Origin {
    Host,
    /// A stored line with this number, at the start.
    Startup(u8),
    /// `$N0=` or `$N1=`. The line is stored after it was executed.
    Store(u8),
}

/// What the present line waits for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Task {
    /// There is no line.
    None,
    /// Its next command.
    Block,
    /// The end of the previous motion.
    Sync,
    Dwell,
    /// The operator resumes after M0.
    Pause,
    Probe {
        away: bool,
        must: bool,
    },
    /// The end of the alarm of a failed probe move.
    ProbeFailed {
        has_moved: bool,
    },
    /// The end of the motion before a move that leaves the travel.
    SoftLimit,
    Home,
    /// The start of the controller, which executes the stored line with this number.
    Startup(u8),
    /// A list, whose line with this number is the next.
    #[cfg(feature = "grblhal")]
    List(Listing, u16),
    /// The change of a tool.
    #[cfg(feature = "grblhal")]
    Change,
    /// The height map, whose line with this number is the next.
    #[cfg(feature = "height-map")]
    Map(u8),
    /// The measurement of the height map.
    #[cfg(feature = "height-map")]
    Survey,
}

/// Result of a line that was accepted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Outcome {
    Done,
    /// Its task is not complete.
    Waits,
    /// The answer is followed by a reset.
    Reset,
    Sleep,
}

impl<const QUEUE: usize> Grbl<QUEUE> {
    /// Continues the present line, or takes the next byte. Returns whether there may be more to do.
    pub(super) fn continue_line(&mut self) -> bool {
        match self.task {
            Task::None => self.take_byte(),
            Task::Block => self.take_command(),
            Task::Sync => {
                if !self.is_drained() {
                    return false;
                }
                let line = self.line;
                let result = self.execute(line.bytes());
                self.end_line(result);
                true
            }
            Task::Dwell => {
                if self.dwell_us > 0 {
                    return false;
                }
                self.task = Task::Block;
                true
            }
            Task::ProbeFailed { has_moved } => {
                if has_moved {
                    self.report_probe();
                }
                self.end_line(Ok(Outcome::Done));
                true
            }
            Task::SoftLimit => {
                if self.phase != Phase::Idle {
                    return false;
                }
                self.soft_limit();
                true
            }
            Task::Startup(number) => self.run_stored(number),
            Task::Home => self.continue_homing(),
            #[cfg(feature = "grblhal")]
            Task::List(listing, index) => self.hal_list(listing, index),
            #[cfg(feature = "grblhal")]
            Task::Change => self.hal_continue_change(),
            #[cfg(feature = "height-map")]
            Task::Map(number) => self.list_map(number),
            #[cfg(feature = "height-map")]
            Task::Survey => self.continue_survey(),
            Task::Pause | Task::Probe { .. } => false,
        }
    }

    fn take_byte(&mut self) -> bool {
        #[cfg(feature = "grblhal")]
        if self.is_hal() {
            return self.take_raw_byte();
        }
        let Some(byte) = self.receiver.take() else {
            return false;
        };
        let line: StoredLine<LINE> = match self.reader.push(byte) {
            None => return true,
            Some(Line::TooLong) => {
                self.send(&Message::Error(ErrorCode::LineTooLong));
                return true;
            }
            Some(Line::Text(text)) => StoredLine::new(text),
        };
        self.origin = Origin::Host;
        let Some(text) = self.checked(line.bytes()) else {
            return true;
        };
        let line = StoredLine::new(text);
        self.line = line;
        let result = self.execute(line.bytes());
        self.end_line(result);
        true
    }

    /// Takes a byte of a line of grblHAL.
    #[cfg(feature = "grblhal")]
    fn take_raw_byte(&mut self) -> bool {
        if self.hal_is_waiting() {
            return self.hal_holds();
        }
        let Some(byte) = self.receiver.take() else {
            return false;
        };
        let line: StoredLine<LINE> = match self.hal.reader.push(byte) {
            None => return true,
            Some(RawLine::TooLong) => {
                self.send(&Message::Error(ErrorCode::LineTooLong));
                return true;
            }
            Some(RawLine::Text(text)) => StoredLine::new(text),
        };
        self.origin = Origin::Host;
        let Some(text) = self.checked(line.bytes()) else {
            return true;
        };
        let line = StoredLine::new(text);
        self.line = line;
        self.hal_say(line.bytes());
        let result = self.execute(line.bytes());
        self.end_line(result);
        true
    }

    fn execute(&mut self, line: &[u8]) -> Result<Outcome, ErrorCode> {
        #[cfg(feature = "grblhal")]
        if self.is_hal() {
            return self.hal_execute(line);
        }
        match line {
            [] => Ok(Outcome::Done),
            [b'$', text @ ..] => self.dollar(text),
            _ if matches!(self.phase, Phase::Alarm | Phase::Jog) => Err(ErrorCode::Locked),
            text => self.block(text),
        }
    }

    fn run_stored(&mut self, number: u8) -> bool {
        let Some(line) = self.memory.lines.get(usize::from(number)).copied() else {
            self.task = Task::None;
            return true;
        };
        if number > 1 {
            self.task = Task::None;
            if self.homing.is_answered_later() {
                self.homing.end();
                self.origin = Origin::Host;
                self.send(&Message::Ok);
            }
            return true;
        }
        self.line = StoredLine::new(line.bytes());
        self.origin = Origin::Startup(number);
        let result = match line.bytes() {
            [] if self.is_blank && !self.options.brakes_at_reset() => Err(ErrorCode::StoreRead),
            [] => {
                self.task = Task::Startup(number.wrapping_add(1));
                return true;
            }
            text => self.block(text),
        };
        self.end_line(result);
        true
    }

    /// Answers the line, unless its task is not complete.
    pub(super) fn end_line(&mut self, result: Result<Outcome, ErrorCode>) {
        if result == Ok(Outcome::Waits) {
            return;
        }
        self.task = Task::None;
        match self.origin {
            Origin::Startup(number) => {
                let line = self.line;
                self.send(&Message::Executed(line.bytes(), result.err()));
                self.task = Task::Startup(number.wrapping_add(1));
            }
            Origin::Store(number) if result.is_ok() => {
                let line = self.line;
                if let Some(slot) = self.memory.lines.get_mut(usize::from(number)) {
                    *slot = StoredLine::new(line.bytes());
                }
                self.store();
                self.answer(None);
            }
            _ => self.answer(result.err()),
        }
        #[cfg(feature = "grblhal")]
        if self.is_hal() {
            self.hal_end_line(result);
        }
        match result {
            Ok(Outcome::Reset) => {
                self.phase = Phase::Idle;
                self.boot();
            }
            Ok(Outcome::Sleep) => {
                self.send(&Message::Feedback(Feedback::Sleeping));
                self.phase = Phase::Sleep;
                self.switch_outputs_off();
                self.idle_us = None;
                self.drive_motors(false);
            }
            _ => {}
        }
    }

    /// Executes a block of G-code.
    ///
    /// # Errors
    /// Fails with the error that answers the line. Nothing has changed in this case.
    pub(super) fn block(&mut self, text: &[u8]) -> Result<Outcome, ErrorCode> {
        let given = Given::read(text, self.codes())?;
        let (mut modal, mut commands) = (self.modal.clone(), Commands::new());
        #[cfg(feature = "grblhal")]
        if self.is_hal() {
            given.check(motion_code(&modal), &modes(&modal))?;
            self.hal_check(&given)?;
        }
        apply(text, &given, &mut modal, &mut commands)?;
        self.check_moves(&commands, false)?;
        let is_checking = self.phase == Phase::Check;
        let spindle = modal.spindle() != self.modal.spindle();
        let is_feed = matches!(motion_code(&modal), 10 | 20 | 30);
        let was_feed = matches!(motion_code(&self.modal), 10 | 20 | 30);
        // The power of a laser changes together with the move.
        let with_move = self.outputs.is_laser
            && given.is_motion()
            && given.has_axes()
            && modal.spindle().0 == self.modal.spindle().0;
        let constant = modal.spindle().0 == SpindleDirection::Clockwise;
        let switches_laser = self.outputs.is_laser && constant && is_feed != was_feed;
        let drives_spindle = (spindle || switches_laser) && !with_move;
        let moves_zero = self.moves_zero(&given);
        let waits = drives_spindle || self.waits_for_motion(&given);
        if waits && !is_checking && !self.is_drained() {
            self.task = Task::Sync;
            return Ok(Outcome::Waits);
        }
        self.tag = Tag {
            line: given.line,
            milli_rpm: modal.spindle().1,
            is_dynamic: modal.spindle().0 == SpindleDirection::CounterClockwise,
        };
        self.modal = modal;
        self.tool = given.tool;
        self.commands = commands;
        self.next = None;
        self.keep_places();
        #[cfg(feature = "grblhal")]
        if self.is_hal() {
            self.hal_take_modes(&given);
        }
        let work_zero = self.work_zero_now();
        if work_zero != self.work_zero || moves_zero {
            self.work_zero = work_zero;
            self.report_work_zero();
        }
        if !is_checking && (spindle || drives_spindle) {
            (self.outputs.direction, self.outputs.milli_rpm) = self.modal.spindle();
            if drives_spindle {
                self.report_overrides();
                self.drive();
            }
        }
        self.task = Task::Block;
        Ok(Outcome::Waits)
    }

    /// Whether a block waits until all previous moves are made.
    fn waits_for_motion(&self, given: &Given) -> bool {
        let (mist, flood) = self.modal.coolant();
        let changes_coolant = match given.coolant {
            Some(70) => !mist,
            Some(80) => !flood,
            Some(_) => mist || flood,
            None => false,
        };
        #[cfg(feature = "grblhal")]
        if given.extra.waits() {
            return true;
        }
        changes_coolant
            || self.moves_zero(given)
            || matches!(given.non_modal, Some(40 | 100 | 281 | 301))
            || matches!(given.stop, Some(0 | 20 | 300))
    }

    /// Whether a block selects or shifts the work zero. G10 is not included.
    fn moves_zero(&self, given: &Given) -> bool {
        let frame = u16::from(self.modal.work_system());
        let changes_frame = given.frame.is_some_and(|code| frame_of(code) != frame);
        let shifts = matches!(given.non_modal, Some(920 | 921));
        changes_frame || shifts || given.length.is_some()
    }

    /// Checks the moves of a block. With `in_travel` a move that leaves the travel is an error.
    fn check_moves(&self, commands: &Commands<3>, in_travel: bool) -> Result<(), ErrorCode> {
        let mut from = self.modal.position();
        for command in commands.clone() {
            let Some(to) = command.end() else {
                continue;
            };
            if in_travel && self.leaves_travel(&to) {
                return Err(ErrorCode::Travel);
            }
            match self.machine.config().check(&from, &command) {
                Err(MoveError::Travel { .. }) if in_travel => return Err(ErrorCode::Travel),
                // The engine has no probe moves. It moves them as lines.
                Ok(()) | Err(MoveError::Travel { .. } | MoveError::Unsupported(_)) => {}
                Err(_) => return Err(ErrorCode::BadTarget),
            }
            from = to;
        }
        Ok(())
    }

    /// Executes the next command of the block. Returns whether there may be more to do.
    fn take_command(&mut self) -> bool {
        let Some(command) = self.next.take().or_else(|| self.commands.next()) else {
            self.end_line(Ok(Outcome::Done));
            return true;
        };
        let is_checking = self.phase == Phase::Check;
        if is_checking {
            if let Command::End { .. } = command {
                self.end_program();
            }
            return true;
        }
        let is_ready = match command {
            Command::Rapid { .. } | Command::Linear { .. } | Command::Arc { .. } => {
                return self.take_move(command);
            }
            Command::Path { .. } | Command::ToolLength { .. } | Command::Spindle { .. } => true,
            _ => self.is_drained(),
        };
        if !is_ready {
            self.next = Some(command);
            return false;
        }
        match command {
            Command::Coolant { mist, flood } => self.set_coolant(mist, flood),
            Command::Dwell { micros } => {
                self.dwell_us = micros;
                self.task = Task::Dwell;
            }
            Command::Probe {
                to,
                feed,
                away,
                must,
            } => {
                if self.is_probe_closed() == away && self.leaves_travel(&to) {
                    self.task = Task::SoftLimit;
                } else {
                    self.begin_probe(Command::Linear { to, feed }, away, must);
                }
            }
            Command::Stop { optional: false } => {
                self.task = Task::Pause;
                self.phase = Phase::Hold(false);
            }
            Command::End { .. } => self.end_program(),
            #[cfg(feature = "grblhal")]
            other if self.is_hal() => self.hal_command(&other),
            _ => {}
        }
        true
    }

    fn set_coolant(&mut self, mist: bool, flood: bool) {
        if (mist, flood) != (self.outputs.mist, self.outputs.flood) {
            (self.outputs.mist, self.outputs.flood) = (mist, flood);
            self.report_overrides();
            self.drive();
        }
    }

    /// Whether the end of a program resets the overrides.
    fn resets_overrides(&self) -> bool {
        #[cfg(feature = "grblhal")]
        if self.is_hal() {
            return self.hal_restores_overrides();
        }
        true
    }

    /// Returns the codes of this controller.
    fn codes(&self) -> CodeSet {
        CodeSet {
            has_mist: self.options.has_mist,
            #[cfg(feature = "grblhal")]
            is_hal: self.is_hal(),
        }
    }

    fn end_program(&mut self) {
        if self.resets_overrides() {
            self.overrides = [100; 3];
            self.machine.set_feed_override(100);
            self.machine.set_rapid_override(100);
            self.report_overrides();
        }
        self.report_work_zero();
        if self.phase != Phase::Check {
            self.switch_outputs_off();
        }
        self.outputs.milli_rpm = self.modal.spindle().1;
        self.send(&Message::Feedback(Feedback::ProgramEnd));
    }

    /// Whether a target is outside the travel, without tolerance.
    pub(super) fn leaves_travel(&self, to: &[Nm; 3]) -> bool {
        let axes = self.machine.config().axes.iter().zip(to);
        axes.into_iter().any(|(axis, to)| {
            let is_outside = |[least, most]: [Nm; 2]| to.0 < least.0 || to.0 > most.0;
            axis.travel.is_some_and(is_outside)
        })
    }

    fn take_move(&mut self, command: Command<3>) -> bool {
        let along = matches!(self.machine.check([command]), Err(MoveError::Travel { .. }));
        if along || command.end().is_some_and(|to| self.leaves_travel(&to)) {
            self.task = Task::SoftLimit;
            if self.phase == Phase::Run {
                self.brake();
            } else {
                self.phase = Phase::Idle;
            }
            return true;
        }
        if !self.append(command) {
            self.next = Some(command);
            return false;
        }
        true
    }

    /// Appends a move to the queue. Returns whether there was room.
    pub(super) fn append(&mut self, command: Command<3>) -> bool {
        if !self.machine.can_push() {
            return false;
        }
        let is_rapid = matches!(command, Command::Rapid { .. });
        let tag = Tag {
            milli_rpm: if is_rapid { 0 } else { self.tag.milli_rpm },
            ..self.tag
        };
        // There is a slot for each move that the queue holds. So that of the executing move is
        // kept.
        if let Some(slot) = self.tags.get_mut(self.next_tag as usize) {
            *slot = tag;
        }
        if self.machine.push(command, self.next_tag).is_ok() {
            let next = self.next_tag.wrapping_add(1);
            self.next_tag = if next < QUEUE as u32 { next } else { 0 };
        }
        self.start_us = START_US;
        true
    }

    /// Executes a jog, `$J=`.
    pub(super) fn jog(&mut self, text: &[u8]) -> Result<Outcome, ErrorCode> {
        let given = Given::read(text, self.codes())?;
        if matches!(given.motion, Some(20 | 30)) {
            // Errors of arc words precede the error of a jog.
            apply(text, &given, &mut self.modal.clone(), &mut Commands::new())?;
        }
        if given.motion == Some(800) && given.has_axes() {
            return Err(ErrorCode::AxisWords);
        }
        let is_foreign = [
            given.motion,
            given.length,
            given.frame,
            given.plane,
            given.feed_mode,
            given.stop,
            given.spindle,
            given.coolant,
            given.non_modal.filter(|code| *code != 530),
        ];
        if is_foreign.into_iter().any(|code| code.is_some()) {
            return Err(ErrorCode::Jog);
        }
        if !given.has(b'F') {
            return Err(ErrorCode::NoFeed);
        }
        let words = bit(b'X') | bit(b'Y') | bit(b'Z') | bit(b'F') | bit(b'N');
        if given.letters & !words != 0 {
            return Err(ErrorCode::Unused);
        }
        let mut line = Text::new();
        line.put(b"G94G1");
        for word in WordReader(text).filter_map(Result::ok) {
            line.put(&[word.letter]);
            line.put(word.number);
        }
        let given = Given::read(line.bytes(), self.codes())?;
        let (mut modal, mut commands) = (self.modal.clone(), Commands::new());
        apply(line.bytes(), &given, &mut modal, &mut commands)?;
        if !given.has_axes() {
            return Ok(Outcome::Done);
        }
        #[cfg(feature = "grblhal")]
        let first = self.hal_clipped(&mut commands, &mut modal);
        #[cfg(not(feature = "grblhal"))]
        let first = None;
        self.check_moves(&commands, true)?;
        let position: [Nm; 3] = modal.position();
        self.modal.set_position(position);
        self.tag = Tag {
            line: given.line,
            ..Tag::default()
        };
        self.commands = commands;
        self.next = first;
        self.phase = Phase::Jog;
        self.task = Task::Block;
        Ok(Outcome::Waits)
    }
}

/// Returns the number of the work frame of a code in tenths: 0 for G54.
const fn frame_of(code: u16) -> u16 {
    let (tens, tenth) = (code.saturating_sub(540) / 10, code % 10);
    tens.wrapping_add(tenth) // at most 8
}

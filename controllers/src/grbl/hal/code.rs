//! Codes beyond those of Grbl.

use husillo_gcode::{Command, Commands, Cycle, Modal, Motion, Nm, Switch};
use husillo_transports::grbl::ErrorCode;

use super::super::words::{AxisUser, Given, Word, has_decimals};
use super::super::{Grbl, Phase};
use super::setting::LIMITS_JOGS;

/// Codes of a block that Grbl does not have.
#[derive(Clone, Copy, Debug, Default)]
pub(in super::super) struct Extra {
    /// M6 or M61, in tenths.
    pub(in super::super) tool: Option<u16>,
    /// M48 to M53, in tenths.
    switch: Option<u16>,
    /// M70 to M73, in tenths.
    modes: Option<u16>,
    /// G98 or G99, in tenths.
    returns: Option<u16>,
}

fn set(slot: &mut Option<u16>, code: u16) -> Result<(), ErrorCode> {
    match slot.replace(code) {
        None => Ok(()),
        Some(_) => Err(ErrorCode::ModalGroup),
    }
}

/// Takes a G code in tenths. Returns `None` for a code of Grbl.
pub(in super::super) fn extra_code(
    given: &mut Given,
    word: &Word,
) -> Option<Result<(), ErrorCode>> {
    let code = u16::try_from(word.tenths).ok()?;
    Some(match code {
        // Tool length from the table.
        430 => set(&mut given.length, code),
        591..=593 => set(&mut given.frame, code),
        594..=599 => Err(ErrorCode::Unsupported),
        980 | 990 => set(&mut given.extra.returns, code),
        50 | 51 | 730 | 810 | 820 | 830 | 850 | 860 | 890 => given
            .use_axes(AxisUser::Motion)
            .and_then(|()| set(&mut given.motion, code)),
        _ => return None,
    })
}

/// Takes an M code in tenths. Returns `None` for a code of Grbl.
pub(in super::super) fn extra_m(given: &mut Given, word: &Word) -> Option<Result<(), ErrorCode>> {
    if has_decimals(word) {
        return None;
    }
    let code = u16::try_from(word.tenths).ok()?;
    Some(match code / 10 {
        6 | 61 => set(&mut given.extra.tool, code),
        48..=51 | 53 => set(&mut given.extra.switch, code),
        70..=73 => set(&mut given.extra.modes, code),
        _ => return None,
    })
}

impl Extra {
    /// Whether the block has M6 or M61, which wait until previous moves are made.
    pub(in super::super) const fn waits(&self) -> bool {
        self.tool.is_some() || self.modes.is_some() || self.switch.is_some()
    }

    /// Returns the letters that these codes use.
    pub(in super::super) fn letters(&self, motion: u16, length: Option<u16>) -> &'static [u8] {
        match (self.tool, self.switch, motion, length) {
            (Some(610), _, _, _) => b"Q",
            (_, Some(_), _, _) => b"P",
            (_, _, _, Some(430)) => b"H",
            (_, _, 730..=890, _) if motion != 800 => b"RQPL",
            (_, _, 50 | 51, _) => b"IJPQ",
            _ => b"",
        }
    }

    /// Whether `gcode` must not see an M code in tenths.
    pub(in super::super) const fn hides_m(code: u16) -> bool {
        matches!(code, 700..=730)
    }
}

/// Returns the code of a motion mode beyond those of Grbl, in tenths.
pub(in super::super) const fn extra_motion(motion: Option<Motion>) -> u16 {
    match motion {
        Some(Motion::Cycle(kind)) => match kind {
            Cycle::ChipBreak => 730,
            Cycle::Drill => 810,
            Cycle::DrillDwell => 820,
            Cycle::Peck => 830,
            Cycle::Bore => 850,
            Cycle::BoreStop => 860,
            Cycle::BoreDwell => 890,
            _ => 800,
        },
        _ => 800,
    }
}

impl<const QUEUE: usize> Grbl<QUEUE> {
    /// Checks codes against the tools and the modes of the machine.
    ///
    /// # Errors
    /// Fails with the error that answers the line.
    pub(in super::super) fn hal_check(&self, given: &Given) -> Result<(), ErrorCode> {
        if given.extra.tool == Some(610) && !given.has(b'Q') {
            return Err(ErrorCode::MissingValue);
        }
        if given.length == Some(430) {
            let tools = &self.memory.hal.tools;
            if tools.iter().all(|tool| tool.number == 0) {
                return Err(ErrorCode::Unsupported);
            }
            let number = if given.has(b'H') {
                given.h
            } else {
                self.hal.change.tool
            };
            if number != 0 && tools.iter().all(|tool| tool.number != number) {
                return Err(ErrorCode::ToolNumber);
            }
        }
        // Curves are not made.
        match given.motion {
            Some(50 | 51) => Err(ErrorCode::Unsupported),
            _ => Ok(()),
        }
    }

    /// Takes the codes that stay in effect, when the block is accepted.
    pub(in super::super) fn hal_take_modes(&mut self, given: &Given) {
        if let Some(code) = given.extra.returns {
            self.hal.returns_to_r = code == 990;
        }
        if given.has(b'T') {
            self.hal.shown.with_tool = true;
        }
        if let Some(code) = given.length {
            self.hal.change.set_length(self.modal.tool_length(), code);
        }
        match given.extra.modes {
            Some(700 | 730) => self.hal.saved = Some(self.modal.clone()),
            Some(710) => self.hal.saved = None,
            Some(_) => self.hal_restore_modes(),
            None => {}
        }
        if given.non_modal == Some(100) && matches!(given.l, 1 | 10 | 11) {
            self.hal_keep_entry(u32::try_from(given.p).unwrap_or(0));
        }
        self.hal_keep();
    }

    fn hal_restore_modes(&mut self) {
        let Some(mut saved) = self.hal.saved.take() else {
            return;
        };
        // Offsets and tools are not modes.
        let position: [husillo_gcode::Nm; 3] = self.modal.position();
        saved.set_position(position);
        core::mem::swap(&mut self.modal, &mut saved);
        self.load_places();
        self.hal_load_tools();
        (self.outputs.direction, self.outputs.milli_rpm) = self.modal.spindle();
        (self.outputs.mist, self.outputs.flood) = self.modal.coolant();
        self.drive();
        self.report_work_zero();
    }

    /// Executes a command that Grbl does not have. Everything before it is made.
    pub(in super::super) fn hal_command(&mut self, command: &Command<3>) {
        match *command {
            Command::Tool { number } => self.hal.change.request(number),
            Command::ToolIs { number } => {
                self.hal.change.tool = number;
                self.hal.shown.with_tool = true;
                self.hal.shown.with_accessories = true;
                self.hal_keep_tool();
            }
            Command::Switch { what, on } => {
                let [feed, spindle] = &mut self.hal.is_fixed;
                match what {
                    Switch::Overrides => (*feed, *spindle) = (!on, !on),
                    Switch::FeedOverride => *feed = !on,
                    Switch::SpindleOverride => *spindle = !on,
                    _ => {}
                }
                self.apply_overrides();
            }
            Command::Stop { optional: true } if !self.hal.ignores_optional_stop => {
                self.task = super::super::Task::Pause;
                self.phase = Phase::Hold(false);
            }
            _ => {}
        }
    }

    /// Ends a jog at the limits of the travel, if `$40` is set. Returns the jog in this case.
    pub(in super::super) fn hal_clipped(
        &self,
        commands: &mut Commands<3>,
        modal: &mut Modal<3>,
    ) -> Option<Command<3>> {
        let is_clipped = self.is_hal() && self.hal_is_set(LIMITS_JOGS) && self.hal.is_homed;
        if !is_clipped {
            return None;
        }
        let mut jog = commands.next()?;
        if let Command::Linear { to, .. } = &mut jog {
            let axes = self.machine.config().axes.iter().zip(to.iter_mut());
            for (travel, to) in axes.filter_map(|(axis, to)| Some((axis.travel?, to))) {
                let [least, most] = travel;
                *to = Nm(to.0.max(least.0).min(most.0));
            }
            modal.set_position(*to);
        }
        Some(jog)
    }

    /// Returns the overrides that take effect, in percent.
    pub(in super::super) fn hal_overrides(&self) -> [u8; 3] {
        let [mut feed, rapid, mut spindle] = self.overrides;
        let [feed_is_fixed, spindle_is_fixed] = self.hal.is_fixed;
        if feed_is_fixed {
            feed = 100;
        }
        if spindle_is_fixed {
            spindle = 100;
        }
        [feed, rapid, spindle]
    }
}

//! Settings of a block before it moves: feed, spindle, tool, outputs, modes.

use crate::blocks::block::Block;
use crate::blocks::fault::{Fault, Reason};
use crate::codes::code::{Code, Group};
use crate::codes::dialect::Flavour;
use crate::command::SpindleDirection;
#[cfg(feature = "extended")]
use crate::command::{Input, OrientDirection, Switch, WaitFor};
use crate::features::EXTENDED;
use crate::modal::Modal;
use crate::modal::commands::Commands;
#[cfg(feature = "extended")]
use crate::modal::commands::Plain;
use crate::modal::modes::Units;
#[cfg(feature = "extended")]
use crate::values::decimal::Decimal;
use crate::values::nm::Nm;

/// `value * 10^exponent` as an unsigned number.
#[cfg(feature = "extended")]
pub(crate) fn unsigned(value: Decimal, exponent: u8) -> Option<u64> {
    value
        .scaled(1, exponent)
        .and_then(|scaled| u64::try_from(scaled).ok())
}

/// The whole number of a word, if it fits in the type.
#[cfg(feature = "extended")]
pub(crate) fn whole<T: TryFrom<u32> + TryInto<u32>>(
    block: &Block,
    letter: u8,
    most: T,
) -> Result<Option<T>, Fault> {
    if block.word(letter).is_none() {
        return Ok(None);
    }
    let mut number = 0;
    block.whole(letter, most.try_into().unwrap_or(u32::MAX), &mut number)?;
    Ok(T::try_from(number).ok())
}

/// The error for a missing word that a code of this group needs.
pub(crate) const fn missing(letter: u8, group: Group) -> Fault {
    Fault::at_code(Reason::MissingWord, group).of(letter)
}

impl<const N: usize> Modal<N> {
    #[cfg_attr(target_has_atomic = "32", inline(always))]
    pub(crate) fn set_feed(&mut self, block: &Block) -> Result<(), Fault> {
        let before = self.active(Group::FeedMode);
        let mode = block.code(Group::FeedMode).unwrap_or(before);
        if mode != before || mode == Code::InverseTime {
            // F has another meaning, or is needed in every block: the old value is cleared.
            self.modes.feed = 0;
        }
        self.set_active(Group::FeedMode, mode);
        if !block.has(b'F') {
            return Ok(());
        }
        let mut feed = Nm(0);
        let inverse = mode == Code::InverseTime;
        if inverse || self.units() == Units::Micrometres {
            // F08 is 0.8 mm/min on the link of the micro mill.
            let exponent = if inverse { 6 } else { 5 };
            block.scaled(b'F', 1, exponent, &mut feed.0)?;
        } else {
            self.add_word(block, b'F', &mut feed)?;
        }
        // F is never negative.
        self.modes.feed = feed.0 as u64;
        Ok(())
    }

    #[inline(never)]
    pub(crate) fn set_outputs(
        &mut self,
        block: &Block,
        commands: &mut Commands<N>,
    ) -> Result<(), Fault> {
        #[cfg(feature = "extended")]
        if let Some(code) = block.code(Group::Io).filter(|code| code.is_of_printer()) {
            // Its S and T are not those of the spindle.
            return self.printer_code(block, code, commands);
        }
        self.set_speed(block)?;
        block.whole(b'T', u32::MAX, &mut self.modes.tool)?;
        #[cfg(feature = "extended")]
        if self.is_printer() && self.modes.loaded != self.modes.tool {
            // T alone changes the extruder.
            self.modes.loaded = self.modes.tool;
            commands.tool_is(self.modes.loaded);
        }
        #[cfg(feature = "extended")]
        if let Some(code) = block.code(Group::Io) {
            commands.io(io(block, code)?);
        }
        match block.code(Group::Tool) {
            #[cfg(feature = "extended")]
            Some(Code::SetTool) => {
                if !block.has(b'Q') {
                    return Err(missing(b'Q', Group::Tool));
                }
                block.whole(b'Q', u32::MAX, &mut self.modes.loaded)?;
                commands.tool_is(self.modes.loaded);
            }
            Some(_) => {
                self.modes.loaded = self.modes.tool;
                commands.tool(self.modes.tool);
            }
            None => {}
        }
        self.set_spindle(block, commands)?;
        if let Some(code) = block.code(Group::Coolant) {
            (self.modes.mist, self.modes.flood) = match code {
                Code::Mist => (true, self.modes.flood),
                Code::Flood => (self.modes.mist, true),
                _ => (false, false),
            };
            commands.coolant(self.modes.mist, self.modes.flood);
        }
        #[cfg(feature = "extended")]
        if let Some(code) = block.code(Group::Override) {
            commands.switch(switch(block, code)?);
        }
        Ok(())
    }

    /// G96, G97 and S.
    fn set_speed(&mut self, block: &Block) -> Result<(), Fault> {
        #[cfg(feature = "extended")]
        if self.set_surface_speed(block)? {
            return Ok(());
        }
        let mut speed = self.modes.milli_rpm as i64;
        // S is never negative.
        block.scaled(b'S', 1, 3, &mut speed)?;
        self.modes.milli_rpm = speed as u64;
        Ok(())
    }

    /// G96 and G97. Returns whether an S is a surface speed.
    #[cfg(feature = "extended")]
    fn set_surface_speed(&mut self, block: &Block) -> Result<bool, Fault> {
        let mode = block.code(Group::SpindleMode);
        if let Some(code) = mode {
            self.set_active(Group::SpindleMode, code);
        }
        match mode {
            Some(Code::SurfaceSpeed) => {
                let most = match block.word(b'D') {
                    Some(value) => {
                        let most = unsigned(value, 3).filter(|&most| most > 0);
                        Some(most.ok_or_else(|| Fault::at(Reason::OutOfRange, b'D'))?)
                    }
                    None => None,
                };
                if !block.has(b'S') {
                    return Err(missing(b'S', Group::SpindleMode));
                }
                self.modes.more.surface = Some((Nm(0), most));
            }
            Some(_) => self.modes.more.surface = None,
            None => {}
        }
        let units = self.units();
        let (Some((speed, _)), Some(value)) = (&mut self.modes.more.surface, block.word(b'S'))
        else {
            return Ok(self.modes.more.surface.is_some());
        };
        // Metres or feet per minute.
        let scaled = match units {
            Units::Inches => value.scaled(3048, 5),
            _ => value.scaled(1, 9),
        };
        *speed = scaled
            .and_then(|nm| Nm(nm).within_limit())
            .ok_or_else(|| Fault::at(Reason::NumberTooLarge, b'S'))?;
        Ok(true)
    }
    fn set_spindle(&mut self, block: &Block, commands: &mut Commands<N>) -> Result<(), Fault> {
        let code = block.code(Group::Spindle);
        #[cfg(feature = "extended")]
        if code == Some(Code::Orient) {
            return self.orient(block, commands);
        }
        if let Some(code) = code {
            self.set_active(Group::Spindle, code);
        }
        let direction = self.spindle_direction();
        let runs = direction != SpindleDirection::Off;
        let changed = block.has(b'S') || block.code(Group::SpindleMode).is_some();
        if code.is_none() && !(runs && changed) {
            return Ok(());
        }
        #[cfg(feature = "extended")]
        if let Some((speed, most)) = self.modes.more.surface.filter(|_| runs) {
            commands.turn(Plain::Surface(direction, speed, most));
            return Ok(());
        }
        commands.spindle(direction, if runs { self.modes.milli_rpm } else { 0 });
        Ok(())
    }

    /// M19.
    #[cfg(feature = "extended")]
    fn orient(&mut self, block: &Block, commands: &mut Commands<N>) -> Result<(), Fault> {
        let angle = block.word(b'R').map_or(Some(0), |value| unsigned(value, 6));
        let angle = angle.filter(|&angle| angle < 360_000_000);
        let angle = angle.ok_or_else(|| Fault::at(Reason::OutOfRange, b'R'))?;
        let number = whole(block, b'P', u8::MAX)?.unwrap_or(0);
        let direction = OrientDirection::of(number);
        let direction = direction.ok_or_else(|| Fault::at(Reason::OutOfRange, b'P'))?;
        self.set_active(Group::Spindle, Code::SpindleOff);
        commands.turn(Plain::Orient(angle, direction));
        Ok(())
    }

    pub(crate) fn set_dwell(
        &mut self,
        block: &Block,
        commands: &mut Commands<N>,
    ) -> Result<(), Fault> {
        if block.code(Group::NonModal) != Some(Code::Dwell) {
            return Ok(());
        }
        // A block without `P` was refused earlier.
        if block.is_negative(b'P') {
            return Err(Fault::at(Reason::Negative, b'P'));
        }
        let mut micros = 0;
        #[cfg(feature = "extended")]
        if self.is_printer() {
            // P is in milliseconds, S in seconds.
            block.scaled(b'P', 1, 3, &mut micros)?;
            block.scaled(b'S', 1, 6, &mut micros)?;
            commands.dwell(micros as u64);
            return Ok(());
        }
        if EXTENDED && !block.has(b'P') {
            return Err(Fault::at_code(Reason::NoDwellTime, Group::NonModal));
        }
        block.scaled(b'P', 1, 6, &mut micros)?;
        if self.modes.dialect.flavour == Flavour::Micromill {
            block.whole(b'P', u32::MAX, &mut 0)?;
        }
        commands.dwell(micros as u64);
        Ok(())
    }

    /// The modes that are only their codes, cutter compensation, tool length and path mode.
    pub(crate) fn set_modes(
        &mut self,
        block: &Block,
        commands: &mut Commands<N>,
    ) -> Result<(), Fault> {
        #[cfg(feature = "extended")]
        if let (Some(code), true) = (block.code(Group::Distance), self.is_printer()) {
            // As in Marlin: G90 and G91 are for the extruder too, until the next M82 or M83.
            self.modes.more.feeds_increments = code == Code::Incremental;
        }
        #[cfg(feature = "extended")]
        self.check_plane(block)?;
        #[cfg(feature = "extended")]
        let system = self.active(Group::System);
        let groups = self.modes.active.iter_mut().zip(block.codes());
        for (active, code) in groups.take(Group::PLAIN) {
            if let Some(code) = code {
                *active = Some(*code);
            }
        }
        #[cfg(feature = "extended")]
        self.note_rotation();
        #[cfg(feature = "extended")]
        self.set_compensation(block, commands)?;
        self.set_tool_length(block, commands)?;
        #[cfg(feature = "extended")]
        if system != self.active(Group::System) && self.compensation().is_some() {
            return Err(Fault::at_code(Reason::UnderCompensation, Group::System));
        }
        if self.modes.dialect.flavour == Flavour::Micromill
            && block.code(Group::System).is_some()
            && (block.axes() != 0 || block.code(Group::Motion).is_some())
        {
            // The G54 of the micro mill stores a position. It stands alone, so that nothing reads
            // the zero before it is stored.
            return Err(Fault::at_code(Reason::TwoUsersOfWords, Group::System));
        }
        if let Some(code) = block.code(Group::Path) {
            #[cfg(feature = "extended")]
            if code == Code::Blend {
                let tolerance = self.length_of(block, b'P')?;
                if tolerance.is_some_and(|tolerance| tolerance < Nm(0)) {
                    return Err(Fault::at(Reason::Negative, b'P'));
                }
                self.modes.more.tolerance = tolerance;
            }
            self.set_active(Group::Path, code);
            commands.path(self.path());
        }
        Ok(())
    }

    /// The plane must not change while the contour is compensated.
    #[cfg(feature = "extended")]
    fn check_plane(&self, block: &Block) -> Result<(), Fault> {
        let plane = block.code(Group::Plane);
        if self.compensation().is_some()
            && plane.is_some_and(|plane| plane != self.active(Group::Plane))
        {
            return Err(Fault::at_code(Reason::UnderCompensation, Group::Plane));
        }
        Ok(())
    }
}

/// M62 to M68.
#[cfg(feature = "extended")]
fn io(block: &Block, code: Code) -> Result<Plain, Fault> {
    let needs = |letter| missing(letter, Group::Io);
    let with_motion = matches!(
        code,
        Code::OutputOnWithMotion | Code::OutputOffWithMotion | Code::AnalogWithMotion
    );
    match code {
        Code::OutputOn | Code::OutputOff | Code::OutputOnWithMotion | Code::OutputOffWithMotion => {
            let number = whole(block, b'P', u8::MAX)?.ok_or_else(|| needs(b'P'))?;
            let on = matches!(code, Code::OutputOn | Code::OutputOnWithMotion);
            Ok(Plain::Output(number, on, with_motion))
        }
        Code::Analog | Code::AnalogWithMotion => {
            let number = whole(block, b'E', u8::MAX)?.ok_or_else(|| needs(b'E'))?;
            let value = block.word(b'Q').ok_or_else(|| needs(b'Q'))?;
            let micro = value
                .scaled(1, 6)
                .ok_or_else(|| Fault::at(Reason::NumberTooLarge, b'Q'))?;
            Ok(Plain::Analog(number, micro, with_motion))
        }
        _ => {
            let digital = whole(block, b'P', u8::MAX)?.map(Input::Digital);
            let analog = whole(block, b'E', u8::MAX)?.map(Input::Analog);
            let input = match (digital, analog) {
                (Some(_), Some(_)) => {
                    return Err(Fault::at(Reason::TwoUsersOfWords, b'E'));
                }
                (digital, analog) => digital.or(analog).ok_or_else(|| needs(b'P'))?,
            };
            let until = match whole(block, b'L', u8::MAX)? {
                None | Some(0) => WaitFor::Nothing,
                // An analogue input is only read.
                Some(1) if digital.is_some() => WaitFor::Rise,
                Some(2) if digital.is_some() => WaitFor::Fall,
                Some(3) if digital.is_some() => WaitFor::High,
                Some(4) if digital.is_some() => WaitFor::Low,
                Some(_) => return Err(Fault::at(Reason::OutOfRange, b'L')),
            };
            let timeout = match block.word(b'Q') {
                None if until != WaitFor::Nothing => return Err(needs(b'Q')),
                None => 0,
                Some(value) => {
                    unsigned(value, 6).ok_or_else(|| Fault::at(Reason::OutOfRange, b'Q'))?
                }
            };
            Ok(Plain::Wait(input, until, timeout))
        }
    }
}

/// M48 to M53.
#[cfg(feature = "extended")]
fn switch(block: &Block, code: Code) -> Result<Plain, Fault> {
    let what = match code {
        Code::EnableOverrides => return Ok(Plain::Switch(Switch::Overrides, true)),
        Code::DisableOverrides => return Ok(Plain::Switch(Switch::Overrides, false)),
        Code::FeedOverride => Switch::FeedOverride,
        Code::SpindleOverride => Switch::SpindleOverride,
        Code::AdaptiveFeed => Switch::AdaptiveFeed,
        _ => Switch::FeedHold,
    };
    match whole(block, b'P', u8::MAX)? {
        None | Some(1) => Ok(Plain::Switch(what, true)),
        Some(0) => Ok(Plain::Switch(what, false)),
        Some(_) => Err(Fault::at(Reason::OutOfRange, b'P')),
    }
}

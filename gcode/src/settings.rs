//! What a block sets before it moves: feed, spindle, tool, outputs, modes.

use crate::block::Block;
use crate::code::{Code, EXTENDED, Group};
use crate::command::{Input, PathMode, SpindleDirection, Switch, WaitFor};
use crate::commands::{Commands, Plain};
use crate::decimal::Decimal;
use crate::dialect::Flavour;
use crate::error::ErrorKind;
use crate::fault::Fault;
use crate::modal::{Distance, FeedMode, Modal, Units};
use crate::nm::Nm;

/// `value * 10^exponent` as an unsigned number.
pub(crate) fn unsigned(value: Decimal, exponent: u8) -> Option<u64> {
    value
        .scaled(1, exponent)
        .and_then(|scaled| u64::try_from(scaled).ok())
}

/// The whole number of a word, which a type must hold.
pub(crate) fn whole<T: TryFrom<i64>>(block: &Block, letter: u8) -> Result<Option<T>, Fault> {
    let Some(value) = block.word(letter) else {
        return Ok(None);
    };
    let number = value
        .whole()
        .ok_or_else(|| Fault::at(ErrorKind::NotWhole(letter), letter))?;
    T::try_from(number)
        .map(Some)
        .map_err(|_| Fault::at(ErrorKind::OutOfRange(letter), letter))
}

/// The error of a word that a code of this group needs.
pub(crate) fn missing(letter: u8, group: Group) -> Fault {
    Fault::at_code(ErrorKind::MissingWord(letter), group)
}

impl<const N: usize> Modal<N> {
    pub(crate) fn set_feed(&mut self, block: &Block) -> Result<(), Fault> {
        let mode = match block.code(Group::FeedMode) {
            Some(Code::InverseTime) => FeedMode::InverseTime,
            Some(Code::PerMinute) => FeedMode::PerMinute,
            Some(Code::PerRevolution) => FeedMode::PerRevolution,
            _ => self.modes.feed_mode,
        };
        if mode != self.modes.feed_mode || mode == FeedMode::InverseTime {
            // Another meaning of F, or a new F in every block: the old one is forgotten.
            self.modes.feed = 0;
        }
        self.modes.feed_mode = mode;
        if let Some(value) = block.word(b'F') {
            let feed = match (mode, self.modes.units) {
                (FeedMode::InverseTime, _) => unsigned(value, 6),
                // F08 is 0.8 mm/min on the micro mill's link.
                (_, Units::Micrometres) => unsigned(value, 5),
                (_, units) => units.length(value).and_then(|nm| u64::try_from(nm.0).ok()),
            };
            self.modes.feed = feed
                .filter(|&feed| feed <= i64::MAX.unsigned_abs())
                .ok_or_else(|| Fault::at(ErrorKind::NumberTooLarge, b'F'))?;
        }
        Ok(())
    }

    #[inline(never)]
    pub(crate) fn set_outputs(
        &mut self,
        block: &Block,
        commands: &mut Commands<N>,
    ) -> Result<(), Fault> {
        self.set_speed(block)?;
        if let Some(number) = whole(block, b'T')? {
            self.modes.tool = number;
        }
        if let Some(code) = block.code(Group::Io).filter(|_| EXTENDED) {
            commands.io(io(block, code)?);
        }
        match block.code(Group::Tool) {
            Some(Code::SetTool) if EXTENDED => {
                let number = whole(block, b'Q')?.ok_or_else(|| missing(b'Q', Group::Tool))?;
                self.modes.loaded = number;
                commands.tool_is(number);
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
        if let Some(code) = block.code(Group::Override).filter(|_| EXTENDED) {
            commands.switch(switch(block, code)?);
        }
        Ok(())
    }

    /// G96, G97 and S.
    fn set_speed(&mut self, block: &Block) -> Result<(), Fault> {
        let too_large = || Fault::at(ErrorKind::NumberTooLarge, b'S');
        match block.code(Group::SpindleMode).filter(|_| EXTENDED) {
            Some(Code::SurfaceSpeed) => {
                let most = match block.word(b'D') {
                    Some(value) => {
                        let most = unsigned(value, 3).filter(|&most| most > 0);
                        Some(most.ok_or_else(|| Fault::at(ErrorKind::OutOfRange(b'D'), b'D'))?)
                    }
                    None => None,
                };
                if block.word(b'S').is_none() {
                    return Err(missing(b'S', Group::SpindleMode));
                }
                self.modes.surface = Some((Nm(0), most));
            }
            Some(_) => self.modes.surface = None,
            None => {}
        }
        let Some(value) = block.word(b'S') else {
            return Ok(());
        };
        match &mut self.modes.surface {
            Some((speed, _)) if EXTENDED => {
                // Metres or feet a minute.
                let scaled = match self.modes.units {
                    Units::Inches => value.scaled(3048, 5),
                    _ => value.scaled(1, 9),
                };
                *speed = scaled
                    .and_then(|nm| Nm(nm).within_limit())
                    .ok_or_else(too_large)?;
            }
            _ => self.modes.milli_rpm = unsigned(value, 3).ok_or_else(too_large)?,
        }
        Ok(())
    }

    fn set_spindle(&mut self, block: &Block, commands: &mut Commands<N>) -> Result<(), Fault> {
        let code = block.code(Group::Spindle);
        match code {
            Some(Code::SpindleClockwise) => self.modes.spindle = SpindleDirection::Clockwise,
            Some(Code::SpindleCounterClockwise) => {
                self.modes.spindle = SpindleDirection::CounterClockwise
            }
            Some(Code::SpindleOff) => self.modes.spindle = SpindleDirection::Off,
            Some(_) if EXTENDED => {
                let angle = block.word(b'R').map_or(Some(0), |value| unsigned(value, 6));
                let angle = angle.filter(|&angle| angle < 360_000_000);
                let angle = angle.ok_or_else(|| Fault::at(ErrorKind::OutOfRange(b'R'), b'R'))?;
                let way = whole::<u8>(block, b'P')?.unwrap_or(0);
                if way > 2 {
                    return Err(Fault::at(ErrorKind::OutOfRange(b'P'), b'P'));
                }
                self.modes.spindle = SpindleDirection::Off;
                commands.turn(Plain::Orient(angle, way));
                return Ok(());
            }
            _ => {}
        }
        let runs = self.modes.spindle != SpindleDirection::Off;
        let changed = block.word(b'S').is_some() || block.code(Group::SpindleMode).is_some();
        if code.is_none() && !(runs && changed) {
            return Ok(());
        }
        match self.modes.surface {
            Some((speed, most)) if EXTENDED && runs => {
                commands.turn(Plain::Surface(self.modes.spindle, speed, most));
            }
            _ => commands.spindle(
                self.modes.spindle,
                if runs { self.modes.milli_rpm } else { 0 },
            ),
        }
        Ok(())
    }

    pub(crate) fn set_dwell(
        &mut self,
        block: &Block,
        commands: &mut Commands<N>,
    ) -> Result<(), Fault> {
        if let (Some(Code::Dwell), Some(value)) = (block.code(Group::NonModal), block.word(b'P')) {
            if value.is_negative() {
                return Err(Fault::at(ErrorKind::Negative(b'P'), b'P'));
            }
            if self.dialect.flavour == Flavour::Micromill && value.whole().is_none() {
                return Err(Fault::at(ErrorKind::NotWhole(b'P'), b'P'));
            }
            commands.dwell(
                unsigned(value, 6).ok_or_else(|| Fault::at(ErrorKind::NumberTooLarge, b'P'))?,
            );
        }
        Ok(())
    }

    pub(crate) fn set_modes(&mut self, block: &Block) -> Result<(), Fault> {
        if let Some(Code::Plane(plane)) = block.code(Group::Plane) {
            if plane != self.modes.plane && self.modes.compensation.is_some() {
                return Err(Fault::at_code(ErrorKind::UnderCompensation, Group::Plane));
            }
            self.modes.plane = plane;
        }
        match block.code(Group::Units) {
            Some(Code::Inches) => self.modes.units = Units::Inches,
            Some(Code::Millimetres) => self.modes.units = Units::Millimetres,
            _ => {}
        }
        if let Some(Code::Diameter(on)) = block.code(Group::Diameter) {
            self.modes.diameter = on;
        }
        Ok(())
    }

    /// Work frame, distance modes, the level to which cycles return.
    pub(crate) fn set_frames(&mut self, block: &Block) -> Result<(), Fault> {
        if let Some(Code::System(system)) = block.code(Group::System) {
            if system != self.modes.system && self.modes.compensation.is_some() {
                return Err(Fault::at_code(ErrorKind::UnderCompensation, Group::System));
            }
            // The micro mill's G54 stores a position: alone, so that nothing reads the zero before it is stored.
            let stores = self.dialect.flavour == Flavour::Micromill;
            if stores && (block.axes() != 0 || block.code(Group::Motion).is_some()) {
                return Err(Fault::at_code(ErrorKind::TwoUsersOfWords, Group::System));
            }
            self.modes.system = system;
        }
        match block.code(Group::Distance) {
            Some(Code::Absolute) => self.modes.distance = Distance::Absolute,
            Some(Code::Incremental) => self.modes.distance = Distance::Incremental,
            _ => {}
        }
        match block.code(Group::CentreDistance) {
            Some(Code::AbsoluteCentres) => self.modes.centres = Distance::Absolute,
            Some(Code::IncrementalCentres) => self.modes.centres = Distance::Incremental,
            _ => {}
        }
        match block.code(Group::Return) {
            Some(Code::ReturnToInitial) => self.modes.to_retract = false,
            Some(_) => self.modes.to_retract = true,
            None => {}
        }
        Ok(())
    }

    pub(crate) fn set_path(
        &mut self,
        block: &Block,
        commands: &mut Commands<N>,
    ) -> Result<(), Fault> {
        self.modes.path = match block.code(Group::Path) {
            None => return Ok(()),
            Some(Code::ExactPath) => PathMode::ExactPath,
            Some(Code::ExactStop) => PathMode::ExactStop,
            Some(_) if EXTENDED => {
                let tolerance = self.length_of(block, b'P')?;
                if tolerance.is_some_and(|tolerance| tolerance < Nm(0)) {
                    return Err(Fault::at(ErrorKind::Negative(b'P'), b'P'));
                }
                PathMode::Blend { tolerance }
            }
            Some(_) => return Ok(()),
        };
        commands.path(self.modes.path);
        Ok(())
    }
}

/// M62 to M68.
fn io(block: &Block, code: Code) -> Result<Plain, Fault> {
    let needs = |letter| missing(letter, Group::Io);
    match code {
        Code::Output { on, with_motion } => {
            let number = whole(block, b'P')?.ok_or_else(|| needs(b'P'))?;
            Ok(Plain::Output(number, on, with_motion))
        }
        Code::Analog { with_motion } => {
            let number = whole(block, b'E')?.ok_or_else(|| needs(b'E'))?;
            let value = block.word(b'Q').ok_or_else(|| needs(b'Q'))?;
            let micro = value
                .scaled(1, 6)
                .ok_or_else(|| Fault::at(ErrorKind::NumberTooLarge, b'Q'))?;
            Ok(Plain::Analog(number, micro, with_motion))
        }
        _ => {
            let digital = whole(block, b'P')?.map(Input::Digital);
            let analog = whole(block, b'E')?.map(Input::Analog);
            let input = match (digital, analog) {
                (Some(_), Some(_)) => {
                    return Err(Fault::at(ErrorKind::TwoUsersOfWords, b'E'));
                }
                (digital, analog) => digital.or(analog).ok_or_else(|| needs(b'P'))?,
            };
            let until = match whole::<u8>(block, b'L')? {
                None | Some(0) => WaitFor::Nothing,
                // An analogue input is only read.
                Some(1) if digital.is_some() => WaitFor::Rise,
                Some(2) if digital.is_some() => WaitFor::Fall,
                Some(3) if digital.is_some() => WaitFor::High,
                Some(4) if digital.is_some() => WaitFor::Low,
                Some(_) => return Err(Fault::at(ErrorKind::OutOfRange(b'L'), b'L')),
            };
            let timeout = match block.word(b'Q') {
                None if until != WaitFor::Nothing => return Err(needs(b'Q')),
                None => 0,
                Some(value) => unsigned(value, 6)
                    .ok_or_else(|| Fault::at(ErrorKind::OutOfRange(b'Q'), b'Q'))?,
            };
            Ok(Plain::Wait(input, until, timeout))
        }
    }
}

/// M48 to M53.
fn switch(block: &Block, code: Code) -> Result<Plain, Fault> {
    let what = match code {
        Code::EnableOverrides(on) => return Ok(Plain::Switch(Switch::Overrides, on)),
        Code::FeedOverride => Switch::FeedOverride,
        Code::SpindleOverride => Switch::SpindleOverride,
        Code::AdaptiveFeed => Switch::AdaptiveFeed,
        _ => Switch::FeedHold,
    };
    match whole::<u8>(block, b'P')? {
        None | Some(1) => Ok(Plain::Switch(what, true)),
        Some(0) => Ok(Plain::Switch(what, false)),
        Some(_) => Err(Fault::at(ErrorKind::OutOfRange(b'P'), b'P')),
    }
}

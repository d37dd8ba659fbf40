//! The modal state, and the order in which a block changes it.

use crate::arc::Plane;
use crate::block::{Block, axis_letter};
use crate::code::{Code, Group};
use crate::command::{Command, Commands, PathMode, SpindleDirection, unsigned};
use crate::decimal::Decimal;
use crate::dialect::{Dialect, Flavour};
use crate::error::{Error, ErrorKind};
use crate::nm::Nm;

/// The motion mode: what axis words alone do.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
pub enum Motion {
    /// G0.
    Rapid,
    /// G1.
    Linear,
    /// G2.
    Clockwise,
    /// G3.
    CounterClockwise,
}

/// The unit of lengths.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
pub enum Units {
    /// G21.
    Millimetres,
    /// G20; exactly 25.4 mm.
    Inches,
    /// The micromill dialect's.
    Micrometres,
}

impl Units {
    /// This many units in nanometres, rounded once, halves away from zero; `None` beyond [`Nm::LIMIT`].
    pub(crate) const fn length(self, value: Decimal) -> Option<Nm> {
        let scaled = match self {
            Units::Millimetres => value.scaled(1, 6),
            Units::Inches => value.scaled(254, 5),
            Units::Micrometres => value.scaled(1, 3),
        };
        match scaled {
            Some(nm) => Nm(nm).within_limit(),
            None => None,
        }
    }
}

/// How coordinates (G90, G91) or arc centres (G90.1, G91.1) are meant.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
pub enum Distance {
    /// In the work frame.
    Absolute,
    /// From the position before the move.
    Incremental,
}

/// What `F` means.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
pub enum FeedMode {
    /// G94: length a minute.
    PerMinute,
    /// G93: moves a minute; every feed move has its own `F`.
    InverseTime,
}

/// How many work frames there are: G54 to G59.
const SYSTEMS: usize = 6;

/// The state that one block leaves to the next: modes, frames and the programmed position. Cheap to clone.
///
/// At the start: machine zero, all offsets zero, G54, G17, G21, G90, G91.1, G94, G61, no motion mode (axis words before
/// the first G0 to G3 are an error), no feed, spindle and coolant off. Micromill: micrometres, absolute centres.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Modal<const N: usize> {
    pub(crate) dialect: Dialect,
    pub(crate) position: [Nm; N],
    pub(crate) offsets: [[Nm; N]; SYSTEMS],
    /// The shift of all work frames by G92.
    pub(crate) shift: [Nm; N],
    /// The position G28 goes to.
    pub(crate) home: [Nm; N],
    /// Nanometres a minute, or millionths of a move a minute; 0 when there is none.
    pub(crate) feed: u64,
    pub(crate) milli_rpm: u64,
    pub(crate) tool: u32,
    pub(crate) system: u8,
    pub(crate) motion: Option<Motion>,
    pub(crate) plane: Plane,
    pub(crate) units: Units,
    pub(crate) distance: Distance,
    pub(crate) centres: Distance,
    pub(crate) feed_mode: FeedMode,
    pub(crate) spindle: SpindleDirection,
    pub(crate) mist: bool,
    pub(crate) flood: bool,
    pub(crate) path: PathMode,
}

impl<const N: usize> Modal<N> {
    /// The state at the start of a program.
    pub fn new(dialect: Dialect) -> Self {
        let micromill = dialect.flavour == Flavour::Micromill;
        Modal {
            dialect,
            position: [Nm(0); N],
            offsets: [[Nm(0); N]; SYSTEMS],
            shift: [Nm(0); N],
            home: [Nm(0); N],
            feed: 0,
            milli_rpm: 0,
            tool: 0,
            system: 0,
            motion: None,
            plane: Plane::Xy,
            units: if micromill {
                Units::Micrometres
            } else {
                Units::Millimetres
            },
            distance: Distance::Absolute,
            centres: if micromill {
                Distance::Absolute
            } else {
                Distance::Incremental
            },
            feed_mode: FeedMode::PerMinute,
            spindle: SpindleDirection::Off,
            mist: false,
            flood: false,
            path: PathMode::ExactPath,
        }
    }

    /// What a block means: the state after it and its commands, in the order of execution of RS-274. All or nothing:
    /// `self` stays as it was, and with an error there is nothing else.
    ///
    /// Order: feed mode, F, S, T, M6, spindle, coolant, G4, plane, units, work frame, path mode, distance modes,
    /// G28 or G92, motion, stop. So an `F` beside `G20` still counts in the unit before it.
    ///
    /// # Errors
    /// What depends on the state: axis words without motion (E0206) or missing (E0207), unused words (E0208), axes
    /// this machine has not (E0201), arcs (E03xx), feed (E0501), coordinates beyond [`Nm::LIMIT`] (E0103).
    pub fn plan(&self, block: &Block) -> Result<(Modal<N>, Commands<N>), Error> {
        let mut next = self.clone();
        let mut commands = Commands::new();
        next.execute(block, &mut commands)?;
        Ok((next, commands))
    }

    /// The programmed position, machine frame.
    pub fn position(&self) -> [Nm; N] {
        self.position
    }

    /// Says where the tool really is, machine frame: after homing, probing, or an abort.
    pub fn set_position(&mut self, at: [Nm; N]) {
        self.position = at;
    }

    /// The active work zero in the machine frame: the offset of G54 to G59 and the shift of G92.
    pub fn work_offset(&self) -> [Nm; N] {
        let mut sum = self.system_offset();
        for (sum, shift) in sum.iter_mut().zip(self.shift) {
            sum.0 = sum.0.saturating_add(shift.0);
        }
        sum
    }

    /// The zero of the active work frame, without G92.
    pub(crate) fn system_offset(&self) -> [Nm; N] {
        self.offsets
            .get(usize::from(self.system))
            .copied()
            .unwrap_or([Nm(0); N])
    }

    /// Sets the zero of a work frame, 0 (G54) to 5 (G59); `false` and nothing done for another number.
    pub fn set_work_zero(&mut self, system: u8, zero: [Nm; N]) -> bool {
        self.offsets
            .get_mut(usize::from(system))
            .map(|offset| *offset = zero)
            .is_some()
    }

    /// Sets the position G28 goes to, machine frame; machine zero at the start.
    pub fn set_home(&mut self, home: [Nm; N]) {
        self.home = home;
    }

    /// The position G28 goes to, machine frame.
    pub fn home(&self) -> [Nm; N] {
        self.home
    }

    /// The active work frame: 0 (G54) to 5 (G59).
    pub fn work_system(&self) -> u8 {
        self.system
    }

    /// The dialect it was made for.
    pub fn dialect(&self) -> &Dialect {
        &self.dialect
    }

    /// The motion mode; `None` at the start, after G80 and in the micromill dialect.
    pub fn motion(&self) -> Option<Motion> {
        self.motion
    }

    /// The plane of arcs.
    pub fn plane(&self) -> Plane {
        self.plane
    }

    /// The unit of lengths.
    pub fn units(&self) -> Units {
        self.units
    }

    /// How coordinates are meant.
    pub fn distance(&self) -> Distance {
        self.distance
    }

    /// How arc centres are meant.
    pub fn centre_distance(&self) -> Distance {
        self.centres
    }

    /// What `F` means.
    pub fn feed_mode(&self) -> FeedMode {
        self.feed_mode
    }

    /// The feed of G94 in nm/min; `None` when none was given, and under G93.
    pub fn feed(&self) -> Option<Nm> {
        let rate = i64::try_from(self.feed)
            .ok()
            .filter(|&rate| rate > 0 && self.feed_mode == FeedMode::PerMinute);
        rate.map(Nm)
    }

    /// Spindle and coolant off, as after M5 and M9: for an abort outside of the program.
    pub fn stop_outputs(&mut self) {
        self.spindle = SpindleDirection::Off;
        self.mist = false;
        self.flood = false;
    }

    /// Spindle direction and programmed speed in thousandths of a revolution a minute (kept while it is off).
    pub fn spindle(&self) -> (SpindleDirection, u64) {
        (self.spindle, self.milli_rpm)
    }

    /// Mist (M7) and flood (M8).
    pub fn coolant(&self) -> (bool, bool) {
        (self.mist, self.flood)
    }

    /// The tool selected last.
    pub fn tool(&self) -> u32 {
        self.tool
    }

    /// How moves may be joined.
    pub fn path(&self) -> PathMode {
        self.path
    }

    fn execute(&mut self, block: &Block, commands: &mut Commands<N>) -> Result<(), Error> {
        self.check_axes(block)?;
        self.set_feed(block)?;
        self.set_outputs(block, commands)?;
        self.set_dwell(block, commands)?;
        self.set_modes(block);
        self.set_path(block, commands)?;
        self.moves(block, commands)?;
        self.stop(block, commands);
        Ok(())
    }

    /// The axes of the block, as far as this machine has them.
    fn check_axes(&self, block: &Block) -> Result<(), Error> {
        let mine = if N < 16 {
            1u16.wrapping_shl(N as u32).wrapping_sub(1)
        } else {
            u16::MAX
        };
        let foreign = block.axes() & !mine;
        if foreign == 0 {
            return Ok(());
        }
        let letter = axis_letter(foreign.trailing_zeros() as usize);
        Err(block.error_at(ErrorKind::UnknownWord(letter), letter))
    }

    fn set_feed(&mut self, block: &Block) -> Result<(), Error> {
        let mode = match block.code(Group::FeedMode) {
            Some(Code::InverseTime) => FeedMode::InverseTime,
            Some(Code::PerMinute) => FeedMode::PerMinute,
            _ => self.feed_mode,
        };
        if mode != self.feed_mode || mode == FeedMode::InverseTime {
            // Another meaning of F, or a new F in every block: the old one is forgotten.
            self.feed = 0;
        }
        self.feed_mode = mode;
        if let Some(value) = block.word(b'F') {
            let feed = match (mode, self.units) {
                (FeedMode::InverseTime, _) => unsigned(value, 6),
                // F08 is 0.8 mm/min on the micro mill's link.
                (_, Units::Micrometres) => unsigned(value, 5),
                (_, units) => units.length(value).and_then(|nm| u64::try_from(nm.0).ok()),
            };
            self.feed = feed
                .filter(|&feed| feed <= i64::MAX.unsigned_abs())
                .ok_or_else(|| block.error_at(ErrorKind::NumberTooLarge, b'F'))?;
        }
        Ok(())
    }

    fn set_outputs(&mut self, block: &Block, commands: &mut Commands<N>) -> Result<(), Error> {
        if let Some(value) = block.word(b'S') {
            self.milli_rpm = unsigned(value, 3)
                .ok_or_else(|| block.error_at(ErrorKind::NumberTooLarge, b'S'))?;
        }
        if let Some(number) = block.word(b'T').and_then(Decimal::whole) {
            // Block has checked that it fits.
            self.tool = u32::try_from(number).unwrap_or(u32::MAX);
        }
        if block.code(Group::Tool).is_some() {
            commands.tool(self.tool);
        }
        let code = block.code(Group::Spindle);
        match code {
            Some(Code::SpindleClockwise) => self.spindle = SpindleDirection::Clockwise,
            Some(Code::SpindleCounterClockwise) => {
                self.spindle = SpindleDirection::CounterClockwise
            }
            Some(Code::SpindleOff) => self.spindle = SpindleDirection::Off,
            _ => {}
        }
        let runs = self.spindle != SpindleDirection::Off;
        if code.is_some() || (runs && block.word(b'S').is_some()) {
            commands.spindle(self.spindle, if runs { self.milli_rpm } else { 0 });
        }
        if let Some(code) = block.code(Group::Coolant) {
            (self.mist, self.flood) = match code {
                Code::Mist => (true, self.flood),
                Code::Flood => (self.mist, true),
                _ => (false, false),
            };
            commands.coolant(self.mist, self.flood);
        }
        Ok(())
    }

    fn set_dwell(&mut self, block: &Block, commands: &mut Commands<N>) -> Result<(), Error> {
        if let (Some(Code::Dwell), Some(value)) = (block.code(Group::NonModal), block.word(b'P')) {
            if self.dialect.flavour == Flavour::Micromill && value.whole().is_none() {
                return Err(block.error_at(ErrorKind::NotWhole(b'P'), b'P'));
            }
            commands.dwell(
                unsigned(value, 6)
                    .ok_or_else(|| block.error_at(ErrorKind::NumberTooLarge, b'P'))?,
            );
        }
        Ok(())
    }

    fn set_modes(&mut self, block: &Block) {
        match block.code(Group::Plane) {
            Some(Code::PlaneXy) => self.plane = Plane::Xy,
            Some(Code::PlaneZx) => self.plane = Plane::Zx,
            Some(Code::PlaneYz) => self.plane = Plane::Yz,
            _ => {}
        }
        match block.code(Group::Units) {
            Some(Code::Inches) => self.units = Units::Inches,
            Some(Code::Millimetres) => self.units = Units::Millimetres,
            _ => {}
        }
        if let Some(Code::System(system)) = block.code(Group::System) {
            self.system = system;
            if self.dialect.flavour == Flavour::Micromill {
                let here = self.position;
                self.set_work_zero(system, here);
            }
        }
        match block.code(Group::Distance) {
            Some(Code::Absolute) => self.distance = Distance::Absolute,
            Some(Code::Incremental) => self.distance = Distance::Incremental,
            _ => {}
        }
        match block.code(Group::CentreDistance) {
            Some(Code::AbsoluteCentres) => self.centres = Distance::Absolute,
            Some(Code::IncrementalCentres) => self.centres = Distance::Incremental,
            _ => {}
        }
    }

    fn set_path(&mut self, block: &Block, commands: &mut Commands<N>) -> Result<(), Error> {
        self.path = match block.code(Group::Path) {
            None => return Ok(()),
            Some(Code::ExactPath) => PathMode::ExactPath,
            Some(Code::ExactStop) => PathMode::ExactStop,
            Some(_) => {
                let tolerance = match block.word(b'P') {
                    None => None,
                    Some(value) => Some(self.length(block, b'P', value)?),
                };
                PathMode::Blend { tolerance }
            }
        };
        commands.path(self.path);
        Ok(())
    }

    fn stop(&mut self, block: &Block, commands: &mut Commands<N>) {
        let Some(code) = block.code(Group::Stop) else {
            return;
        };
        match code {
            Code::Stop | Code::OptionalStop => {
                commands.finish(Command::Stop {
                    optional: code == Code::OptionalStop,
                });
            }
            _ => {
                self.end();
                commands.finish(Command::End {
                    rewind: code == Code::EndAndRewind,
                });
            }
        }
    }

    /// What M2 and M30 reset: G54, G92.1, G17, G90, G94, G1, M5, M9. Work zeros, units and the feed stay.
    fn end(&mut self) {
        self.system = 0;
        self.shift = [Nm(0); N];
        self.plane = Plane::Xy;
        self.distance = Distance::Absolute;
        if self.feed_mode == FeedMode::InverseTime {
            self.feed = 0;
        }
        self.feed_mode = FeedMode::PerMinute;
        self.motion = if self.dialect.flavour == Flavour::Rs274 {
            Some(Motion::Linear)
        } else {
            None
        };
        self.stop_outputs();
    }

    /// A word as a length, or the error at that word.
    pub(crate) fn length(&self, block: &Block, letter: u8, value: Decimal) -> Result<Nm, Error> {
        self.units
            .length(value)
            .ok_or_else(|| block.error_at(ErrorKind::NumberTooLarge, letter))
    }
}

//! The modal state, and the order in which a block changes it.

use crate::arc::Plane;
use crate::block::{Block, axis_letter};
use crate::code::{Code, EXTENDED, Group, Side};
use crate::command::{PathMode, SpindleDirection};
use crate::commands::{Commands, Plain};
use crate::decimal::Decimal;
use crate::dialect::{Dialect, Flavour};
use crate::error::{Error, ErrorKind};
use crate::fault::Fault;
use crate::kind::Kind;
use crate::nm::Nm;
use crate::tools::{Tool, Tools};

/// The motion mode: what axis words alone do.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
#[non_exhaustive]
pub enum Motion {
    /// G0.
    Rapid,
    /// G1.
    Linear,
    /// G2.
    Clockwise,
    /// G3.
    CounterClockwise,
    /// G5.
    Cubic,
    /// G5.1.
    Quadratic,
    /// G33.
    Thread,
    /// G38.2 to G38.5.
    Probe {
        /// G38.4, G38.5.
        away: bool,
        /// G38.2, G38.4.
        must: bool,
    },
    /// A canned cycle.
    Cycle(Kind),
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
        let (factor, exponent) = match self {
            Units::Millimetres => (1, 6),
            Units::Inches => (254, 5),
            Units::Micrometres => (1, 3),
        };
        Units::within(value.scaled(factor, exponent))
    }

    /// Half of it, rounded once: a diameter as a radius.
    pub(crate) const fn half(self, value: Decimal) -> Option<Nm> {
        let (factor, exponent) = match self {
            Units::Millimetres => (5, 5),
            Units::Inches => (127, 5),
            Units::Micrometres => (5, 2),
        };
        Units::within(value.scaled(factor, exponent))
    }

    const fn within(scaled: Option<i64>) -> Option<Nm> {
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
    /// G95: length a revolution of the spindle.
    PerRevolution,
}

/// How many work frames there are: G54 to G59, with the extended codes to G59.3.
const SYSTEMS: usize = if EXTENDED { 9 } else { 6 };

#[cfg(feature = "extended")]
/// What a canned cycle keeps for the next block of its series, lengths as they were programmed.
#[derive(Copy, Clone, Eq, PartialEq, Debug, Default)]
pub(crate) struct Sticky {
    pub(crate) retract: Option<Nm>,
    pub(crate) bottom: Option<Nm>,
    pub(crate) peck: Option<Nm>,
    pub(crate) dwell_micros: u64,
    pub(crate) back_bore: Option<[Nm; 3]>,
    /// Height before the series, machine frame: where G98 goes back to.
    pub(crate) initial: Option<Nm>,
    /// The far corner of a turning cycle, X and Z, machine frame.
    pub(crate) corner: Option<[Nm; 2]>,
    /// The taper of a turning cycle, and the lead of a thread.
    pub(crate) taper: Nm,
    pub(crate) lead: Nm,
}

/// The state that one block leaves to the next: modes, frames, eight tools and the programmed position. Cheap to clone.
///
/// At the start: machine zero, all offsets zero, G54, G17, G21, G90, G91.1, G94, G61, G40, G49, G98, G97, G8, no motion
/// mode (axis words before the first motion code are an error), no feed, spindle and coolant off. Micromill: micrometres,
/// absolute centres. Grbl: G0. Lathes: G18 and G7.
///
/// A, B and C are turned in degrees whatever the unit: a millionth of a degree is one [`Nm`].
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Modal<const N: usize> {
    pub(crate) dialect: Dialect,
    pub(crate) modes: Modes<N>,
    // What is below changes only as the last thing a block does: it need not be kept aside.
    pub(crate) offsets: [[Nm; N]; SYSTEMS],
    /// The positions G28 and G30 go to.
    pub(crate) homes: [[Nm; N]; 2],
    pub(crate) tools: Tools<N>,
}

/// What a refused block must leave as it was, small enough to be kept aside meanwhile.
#[derive(Copy, Clone, Debug, Eq, PartialEq)]
pub(crate) struct Modes<const N: usize> {
    pub(crate) position: [Nm; N],
    /// The shift of all work frames by G92.
    pub(crate) shift: [Nm; N],
    /// The shift G92.3 brings back.
    pub(crate) kept_shift: [Nm; N],
    /// The tool length in effect.
    pub(crate) length: [Nm; N],
    /// Nanometres a minute or a revolution, or millionths of a move a minute; 0 when there is none.
    pub(crate) feed: u64,
    pub(crate) milli_rpm: u64,
    /// G96: surface speed a minute and the most thousandths of a revolution; `None` under G97.
    pub(crate) surface: Option<(Nm, Option<u64>)>,
    pub(crate) tool: u32,
    /// The tool in the spindle: by M6 or M61.
    pub(crate) loaded: u32,
    #[cfg(feature = "extended")]
    pub(crate) sticky: Sticky,
    /// G5: from the end of the curve back to its second control point, turned round.
    pub(crate) tail: Option<[Nm; 2]>,
    pub(crate) compensation: Option<Side>,
    pub(crate) diameter: bool,
    pub(crate) to_retract: bool,
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

/// One coordinate; 0 of an axis that is not there.
pub(crate) fn coordinate<const N: usize>(point: &[Nm; N], axis: usize) -> Nm {
    point.get(axis).copied().unwrap_or_default()
}

/// The sum of a coordinate and the length of a word.
pub(crate) fn shifted(from: Nm, by: Nm, letter: u8) -> Result<Nm, Fault> {
    from.0
        .checked_add(by.0)
        .and_then(|sum| Nm(sum).within_limit())
        .ok_or(Fault::at(ErrorKind::NumberTooLarge, letter))
}

impl<const N: usize> Modal<N> {
    /// The state at the start of a program.
    pub fn new(dialect: Dialect) -> Self {
        let micromill = dialect.flavour == Flavour::Micromill;
        Modal {
            dialect,
            modes: Modes {
                position: [Nm(0); N],
                shift: [Nm(0); N],
                kept_shift: [Nm(0); N],
                length: [Nm(0); N],
                feed: 0,
                milli_rpm: 0,
                surface: None,
                tool: 0,
                loaded: 0,
                #[cfg(feature = "extended")]
                sticky: Sticky::default(),
                tail: None,
                compensation: None,
                diameter: dialect.is_lathe(),
                to_retract: false,
                system: 0,
                motion: if dialect.flavour == Flavour::Grbl {
                    Some(Motion::Rapid)
                } else {
                    None
                },
                plane: if dialect.is_lathe() {
                    Plane::Zx
                } else {
                    Plane::Xy
                },
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
            },
            offsets: [[Nm(0); N]; SYSTEMS],
            homes: [[Nm(0); N]; 2],
            tools: Tools::new(),
        }
    }

    /// What a block means: the state after it and its commands, in the order of execution of RS-274. All or nothing:
    /// `self` stays as it was, and with an error there is nothing else.
    ///
    /// Order: feed mode, F, spindle mode, S, T, M62 to M68, M6, spindle, coolant, M48 to M53, G4, plane, units, cutter
    /// compensation, tool length, work frame, path mode, distance modes, G98, then one of G10, G28, G30, G92 and the
    /// motion, stop. So an `F` beside `G20` still counts in the unit before it.
    ///
    /// # Errors
    /// What depends on the state: axis words without motion (E0206) or missing (E0207), unused words (E0208), axes
    /// this machine has not (E0201), arcs, cycles and splines (E03xx), feed and ranges (E05xx), words that a code misses
    /// (E0213), what compensation forbids (E0217), coordinates beyond [`Nm::LIMIT`] (E0103).
    pub fn plan(&self, block: &Block) -> Result<(Modal<N>, Commands<N>), Error> {
        let mut next = self.clone();
        let mut commands = Commands::new();
        next.apply(block, &mut commands)?;
        Ok((next, commands))
    }

    /// As [`Modal::plan`], in place: nothing is moved, and nothing but the modes (or for G0 to G3 with axis words, `F` and
    /// `N` what these change) is kept aside. `commands` are replaced. With an error there are none, and the state is as it was.
    ///
    /// # Errors
    /// Those of [`Modal::plan`].
    pub fn apply(&mut self, block: &Block, commands: &mut Commands<N>) -> Result<(), Error> {
        commands.clear();
        let done = if block.is_move() && self.is_moving(block) {
            self.apply_move(block, commands)
        } else {
            self.apply_any(block, commands)
        };
        done.map_err(|fault| {
            commands.clear();
            block.error(fault)
        })
    }

    /// The stages of [`Modal::execute`] that a block with nothing but a move has.
    fn apply_move(&mut self, block: &Block, commands: &mut Commands<N>) -> Result<(), Fault> {
        // The position and the mode change as the last things.
        let before = self.modes.feed;
        let done = self
            .check_axes(block)
            .and_then(|()| self.set_feed(block))
            .and_then(|()| self.moves_only(block, commands));
        if done.is_err() {
            self.modes.feed = before;
        }
        done
    }

    #[inline(never)]
    fn apply_any(&mut self, block: &Block, commands: &mut Commands<N>) -> Result<(), Fault> {
        let before = self.modes;
        let done = self.execute(block, commands);
        if done.is_err() {
            self.modes = before;
        }
        done
    }

    /// Whether the motion in effect is one of G0 to G3, or none and the block names it.
    fn is_moving(&self, block: &Block) -> bool {
        match self.modes.motion {
            None => block.code(Group::Motion).is_some(),
            Some(Motion::Rapid | Motion::Linear | Motion::Clockwise | Motion::CounterClockwise) => {
                true
            }
            Some(_) => false,
        }
    }

    /// The programmed position, machine frame.
    pub fn position(&self) -> [Nm; N] {
        self.modes.position
    }

    /// Says where the tool really is, machine frame: after homing, probing, or an abort.
    pub fn set_position(&mut self, at: [Nm; N]) {
        self.modes.position = at;
    }

    /// The active work zero in the machine frame: the offset of G54 to G59.3 and the shift of G92,
    /// without the tool length.
    pub fn work_offset(&self) -> [Nm; N] {
        let mut offset = [Nm(0); N];
        for (axis, offset) in (0..N).zip(offset.iter_mut()) {
            *offset = self.work_offset_of(axis);
        }
        offset
    }

    /// The same of one axis. Most ask for one: an array is four copies on the way.
    pub(crate) fn work_offset_of(&self, axis: usize) -> Nm {
        let shift = coordinate(&self.modes.shift, axis);
        Nm(self.system_offset_of(axis).0.saturating_add(shift.0))
    }

    /// The work zero of the programmed point: with the tool length.
    pub(crate) fn zero_of(&self, axis: usize) -> Nm {
        let length = coordinate(&self.modes.length, axis);
        Nm(self.work_offset_of(axis).0.saturating_add(length.0))
    }

    /// The zero of the active work frame, without G92.
    pub(crate) fn system_offset_of(&self, axis: usize) -> Nm {
        let system = self.offsets.get(usize::from(self.modes.system));
        system.map_or(Nm(0), |zero| coordinate(zero, axis))
    }

    /// Sets the zero of a work frame, 0 (G54) to 8 (G59.3); `false` and nothing done for another number.
    pub fn set_work_zero(&mut self, system: u8, zero: [Nm; N]) -> bool {
        match self.offsets.get_mut(usize::from(system)) {
            Some(offset) => {
                // As a whole it is moved by a function that nothing else needs.
                for (offset, zero) in offset.iter_mut().zip(zero) {
                    offset.0 = zero.0;
                }
                true
            }
            None => false,
        }
    }

    /// The zero of a work frame, 0 (G54) to 8 (G59.3).
    pub fn work_zero(&self, system: u8) -> Option<[Nm; N]> {
        self.offsets.get(usize::from(system)).copied()
    }

    /// Sets the position G28 goes to, machine frame; machine zero at the start.
    pub fn set_home(&mut self, home: [Nm; N]) {
        let [first, _] = &mut self.homes;
        *first = home;
    }

    /// The position G28 goes to, machine frame.
    pub fn home(&self) -> [Nm; N] {
        self.homes[0]
    }

    /// Sets the position G30 goes to, machine frame; machine zero at the start.
    pub fn set_second_home(&mut self, home: [Nm; N]) {
        let [_, second] = &mut self.homes;
        *second = home;
    }

    /// The position G30 goes to, machine frame.
    pub fn second_home(&self) -> [Nm; N] {
        self.homes[1]
    }

    /// Writes a tool into the table, as G10 L1 does; `false` and nothing done for tool 0 and when eight others are there.
    pub fn set_tool(&mut self, number: u32, tool: Tool<N>) -> bool {
        self.tools.set(number, tool)
    }

    /// A tool of the table.
    pub fn tool_data(&self, number: u32) -> Option<Tool<N>> {
        self.tools.get(number)
    }

    /// The tool length in effect (G43, G43.1), part of the position.
    pub fn tool_length(&self) -> [Nm; N] {
        self.modes.length
    }

    /// The tool in the spindle: the one of the last M6 or M61.
    pub fn loaded_tool(&self) -> u32 {
        self.modes.loaded
    }

    /// The side of cutter compensation; `None` under G40.
    pub fn compensation(&self) -> Option<Side> {
        self.modes.compensation
    }

    /// Whether X is a diameter (G7).
    pub fn is_diameter(&self) -> bool {
        self.modes.diameter
    }

    /// The active work frame: 0 (G54) to 8 (G59.3).
    pub fn work_system(&self) -> u8 {
        self.modes.system
    }

    /// The dialect it was made for.
    pub fn dialect(&self) -> &Dialect {
        &self.dialect
    }

    /// The motion mode; `None` at the start, after G80 and in the micromill dialect.
    pub fn motion(&self) -> Option<Motion> {
        self.modes.motion
    }

    /// The plane of arcs.
    pub fn plane(&self) -> Plane {
        self.modes.plane
    }

    /// The unit of lengths.
    pub fn units(&self) -> Units {
        self.modes.units
    }

    /// How coordinates are meant.
    pub fn distance(&self) -> Distance {
        self.modes.distance
    }

    /// How arc centres are meant.
    pub fn centre_distance(&self) -> Distance {
        self.modes.centres
    }

    /// What `F` means.
    pub fn feed_mode(&self) -> FeedMode {
        self.modes.feed_mode
    }

    /// The feed of G94 in nm/min; `None` when none was given, and under G93 and G95.
    pub fn feed(&self) -> Option<Nm> {
        let rate = i64::try_from(self.modes.feed)
            .ok()
            .filter(|&rate| rate > 0 && self.modes.feed_mode == FeedMode::PerMinute);
        rate.map(Nm)
    }

    /// Spindle and coolant off, as after M5 and M9: for an abort outside of the program.
    pub fn stop_outputs(&mut self) {
        self.modes.spindle = SpindleDirection::Off;
        self.modes.mist = false;
        self.modes.flood = false;
    }

    /// Spindle direction and programmed speed in thousandths of a revolution a minute (kept while it is off).
    pub fn spindle(&self) -> (SpindleDirection, u64) {
        (self.modes.spindle, self.modes.milli_rpm)
    }

    /// Mist (M7) and flood (M8).
    pub fn coolant(&self) -> (bool, bool) {
        (self.modes.mist, self.modes.flood)
    }

    /// The tool selected last.
    pub fn tool(&self) -> u32 {
        self.modes.tool
    }

    /// How moves may be joined.
    pub fn path(&self) -> PathMode {
        self.modes.path
    }

    fn execute(&mut self, block: &Block, commands: &mut Commands<N>) -> Result<(), Fault> {
        let here = self.modes.position;
        self.check_axes(block)?;
        self.set_feed(block)?;
        self.set_outputs(block, commands)?;
        self.set_dwell(block, commands)?;
        self.set_modes(block)?;
        self.set_compensation(block, commands)?;
        self.set_tool_length(block, commands)?;
        self.set_frames(block)?;
        self.set_path(block, commands)?;
        self.moves(block, commands)?;
        self.store(block, here);
        self.stop(block, commands);
        Ok(())
    }

    /// What G28.1, G30.1 and the micro mill's G54 keep of the position before the block, when it can no longer fail.
    fn store(&mut self, block: &Block, here: [Nm; N]) {
        match block.code(Group::NonModal) {
            Some(Code::StoreHome(0)) => self.set_home(here),
            Some(Code::StoreHome(_)) => self.set_second_home(here),
            _ => {}
        }
        if self.dialect.flavour == Flavour::Micromill && block.code(Group::System).is_some() {
            self.set_work_zero(0, here);
        }
    }

    /// The axes of the block, as far as this machine has them.
    fn check_axes(&self, block: &Block) -> Result<(), Fault> {
        let mine = if N < 16 {
            1u16.wrapping_shl(N as u32).wrapping_sub(1)
        } else {
            u16::MAX
        };
        let foreign = block.axes() & !mine;
        if EXTENDED && self.dialect.flavour == Flavour::Lathe {
            block.check_increments()?;
        }
        if foreign == 0 {
            return Ok(());
        }
        let letter = axis_letter(foreign.trailing_zeros() as usize);
        Err(Fault::at(ErrorKind::UnknownWord(letter), letter))
    }

    fn stop(&mut self, block: &Block, commands: &mut Commands<N>) {
        let Some(code) = block.code(Group::Stop) else {
            return;
        };
        match code {
            Code::Stop | Code::OptionalStop => {
                commands.finish(Plain::Stop(code == Code::OptionalStop));
            }
            Code::PalletStop => commands.finish(Plain::Pallet),
            _ => {
                self.end();
                commands.finish(Plain::End(code == Code::EndAndRewind));
            }
        }
    }

    /// What M2 and M30 reset: G54, G92.1 (not in the grbl dialect), G17 (lathes G18), G90, G94, G1, G40, M5, M9. Work
    /// zeros, tool length, units and the feed stay.
    fn end(&mut self) {
        self.modes.system = 0;
        if self.dialect.flavour != Flavour::Grbl {
            self.modes.shift = [Nm(0); N];
        }
        self.modes.plane = if self.dialect.is_lathe() {
            Plane::Zx
        } else {
            Plane::Xy
        };
        self.modes.distance = Distance::Absolute;
        if self.modes.feed_mode != FeedMode::PerMinute {
            self.modes.feed = 0;
        }
        self.modes.feed_mode = FeedMode::PerMinute;
        self.modes.motion = if self.dialect.flavour == Flavour::Micromill {
            None
        } else {
            Some(Motion::Linear)
        };
        self.modes.compensation = None;
        #[cfg(feature = "extended")]
        {
            self.modes.sticky = Sticky::default();
        }
        self.modes.tail = None;
        self.stop_outputs();
    }

    /// A word as a length, or the error at that word.
    pub(crate) fn length(&self, letter: u8, value: Decimal) -> Result<Nm, Fault> {
        let length = match letter {
            // Degrees, in millionths.
            b'A' | b'B' | b'C' => Units::Millimetres.length(value),
            b'X' | b'U' if self.modes.diameter => self.modes.units.half(value),
            _ => self.modes.units.length(value),
        };
        length.ok_or_else(|| Fault::at(ErrorKind::NumberTooLarge, letter))
    }

    /// A word as a length, if the block has it.
    pub(crate) fn length_of(&self, block: &Block, letter: u8) -> Result<Option<Nm>, Fault> {
        match block.word(letter) {
            Some(value) => self.length(letter, value).map(Some),
            None => Ok(None),
        }
    }
}

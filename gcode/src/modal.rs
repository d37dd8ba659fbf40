//! The modal state, and the order in which a block changes it.

use crate::arc::Plane;
use crate::block::{Block, first_of};
use crate::code::{Code, EXTENDED, Group, ROOMY, Side};
use crate::command::{PathMode, SpindleDirection};
use crate::commands::Commands;
#[cfg(feature = "extended")]
use crate::decimal::Decimal;
use crate::dialect::{Dialect, Flavour};
use crate::error::Error;
use crate::fault::{Fault, Reason};
use crate::kind::Kind;
use crate::nm::{Measure, Nm};
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
    /// A unit in nanometres, as a factor and a power of ten; or half of it.
    pub(crate) const fn scale(self, half: bool) -> (u8, u8) {
        match (self, half) {
            (Units::Millimetres, false) => (1, 6),
            (Units::Millimetres, true) => (5, 5),
            (Units::Inches, false) => (254, 5),
            (Units::Inches, true) => (127, 5),
            (Units::Micrometres, false) => (1, 3),
            (Units::Micrometres, true) => (5, 2),
        }
    }

    /// This many units in nanometres, rounded once, halves away from zero; `None` beyond [`Nm::LIMIT`].
    #[cfg(feature = "extended")]
    pub(crate) fn length(self, value: Decimal) -> Option<Nm> {
        let (factor, exponent) = self.scale(false);
        let scaled = value.scaled(i32::from(factor), exponent);
        scaled.and_then(|nm| Nm(nm).within_limit())
    }

    /// Half of it, rounded once: a diameter as a radius.
    #[cfg(feature = "extended")]
    pub(crate) fn half(self, value: Decimal) -> Option<Nm> {
        let (factor, exponent) = self.scale(true);
        let scaled = value.scaled(i32::from(factor), exponent);
        scaled.and_then(|nm| Nm(nm).within_limit())
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
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
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

#[cfg(feature = "extended")]
impl Sticky {
    pub(crate) const NONE: Sticky = Sticky {
        retract: None,
        bottom: None,
        peck: None,
        dwell_micros: 0,
        back_bore: None,
        initial: None,
        corner: None,
        taper: Nm(0),
        lead: Nm(0),
    };
}

/// The state that one block leaves to the next: modes, frames, eight tools and the programmed position. Cheap to clone.
///
/// At the start: machine zero, all offsets zero, G54, G17, G21, G90, G91.1, G94, G61, G40, G49, G98, G97, G8, no motion
/// mode (axis words before the first motion code are an error), no feed, spindle and coolant off. Micromill: micrometres,
/// absolute centres. Grbl: G0. Lathes: G18 and G7.
///
/// A, B and C are turned in degrees whatever the unit: a millionth of a degree is one [`Nm`].
///
/// What is looked at most stands first: short instructions reach 32 bytes from its address.
#[derive(Clone, Debug, Eq, PartialEq)]
#[repr(C)]
pub struct Modal<const N: usize> {
    pub(crate) modes: Modes<N>,
    // What is below changes only as the last thing a block does: it need not be kept aside.
    /// The positions G28 and G30 go to.
    pub(crate) homes: [[Nm; N]; 2],
    pub(crate) offsets: [[Nm; N]; SYSTEMS],
    pub(crate) tools: Tools<N>,
}

/// What a refused block must leave as it was, small enough to be kept aside meanwhile.
#[derive(Copy, Clone, Debug, Eq, PartialEq)]
#[repr(C)]
pub(crate) struct Modes<const N: usize> {
    pub(crate) tool: u32,
    /// The tool in the spindle: by M6 or M61.
    pub(crate) loaded: u32,
    /// The code in effect of each modal group.
    pub(crate) active: [Option<Code>; Group::MODAL],
    pub(crate) mist: bool,
    pub(crate) flood: bool,
    /// What it was made for; it never changes.
    pub(crate) dialect: Dialect,
    /// Nanometres a minute or a revolution, or millionths of a move a minute; 0 when there is none.
    pub(crate) feed: u64,
    pub(crate) milli_rpm: u64,
    pub(crate) position: [Nm; N],
    /// The shift of all work frames by G92.
    pub(crate) shift: [Nm; N],
    /// The tool length in effect.
    pub(crate) length: [Nm; N],
    /// The shift G92.3 brings back.
    pub(crate) kept_shift: [Nm; N],
    #[cfg(feature = "extended")]
    pub(crate) sticky: Sticky,
    #[cfg(feature = "extended")]
    pub(crate) more: More,
}

impl<const N: usize> Modes<N> {
    /// All bytes zero, as far as the extended codes add none: no codes in effect.
    pub(crate) const NONE: Self = Modes {
        dialect: Dialect::RS274.with_block_delete(false),
        active: [None; Group::MODAL],
        mist: false,
        flood: false,
        tool: 0,
        loaded: 0,
        feed: 0,
        milli_rpm: 0,
        position: [Nm(0); N],
        shift: [Nm(0); N],
        length: [Nm(0); N],
        kept_shift: [Nm(0); N],
        #[cfg(feature = "extended")]
        sticky: Sticky::NONE,
        #[cfg(feature = "extended")]
        more: More::NONE,
    };

    /// Copies it field by field: as a whole it is moved by a function that nothing else of the basic codes needs.
    #[cfg_attr(not(target_has_atomic = "32"), inline(never))]
    fn write_to(&self, to: &mut Self) {
        (to.dialect, to.active) = (self.dialect, self.active);
        (to.mist, to.flood) = (self.mist, self.flood);
        (to.tool, to.loaded) = (self.tool, self.loaded);
        (to.feed, to.milli_rpm) = (self.feed, self.milli_rpm);
        to.position = self.position;
        to.shift = self.shift;
        to.length = self.length;
        to.kept_shift = self.kept_shift;
        #[cfg(feature = "extended")]
        {
            to.sticky = self.sticky;
            to.more = self.more;
        }
    }
}

/// What the extended codes leave to the next block, besides the canned cycles.
#[cfg(feature = "extended")]
#[derive(Copy, Clone, Debug, Eq, PartialEq)]
pub(crate) struct More {
    /// G96: surface speed a minute and the most thousandths of a revolution; `None` under G97.
    pub(crate) surface: Option<(Nm, Option<u64>)>,
    /// G5: from the end of the curve back to its second control point, turned round.
    pub(crate) tail: Option<[Nm; 2]>,
    pub(crate) compensation: Option<Side>,
    /// `P` of G64.
    pub(crate) tolerance: Option<Nm>,
}

#[cfg(feature = "extended")]
impl More {
    const NONE: More = More {
        surface: None,
        tail: None,
        compensation: None,
        tolerance: None,
    };
}

/// The codes in effect at the start of a program.
#[inline(always)]
fn initial(dialect: Dialect) -> [Option<Code>; Group::MODAL] {
    let micromill = dialect.flavour == Flavour::Micromill;
    let lathe = dialect.is_lathe();
    // In the order of the groups.
    [
        Some(if lathe { Code::PlaneZx } else { Code::PlaneXy }),
        Some(if micromill {
            Code::Micrometres
        } else {
            Code::Millimetres
        }),
        Some(if lathe {
            Code::DiameterMode
        } else {
            Code::RadiusMode
        }),
        Some(Code::G54),
        Some(Code::Absolute),
        Some(if micromill {
            Code::AbsoluteCentres
        } else {
            Code::IncrementalCentres
        }),
        Some(Code::ReturnToInitial),
        Some(Code::ExactPath),
        Some(Code::PerMinute),
        Some(if dialect.flavour == Flavour::Grbl {
            Code::Rapid
        } else {
            Code::CancelMotion
        }),
        Some(Code::SpindleOff),
        Some(Code::SpindleSpeed),
    ]
}

/// One coordinate; 0 of an axis that is not there.
pub(crate) fn coordinate<const N: usize>(point: &[Nm; N], axis: usize) -> Nm {
    point.get(axis).copied().unwrap_or_default()
}

/// The sum of a coordinate and the length of a word.
#[cfg(feature = "extended")]
pub(crate) fn shifted(from: Nm, by: Nm, letter: u8) -> Result<Nm, Fault> {
    from.0
        .checked_add(by.0)
        .and_then(|sum| Nm(sum).within_limit())
        .ok_or(Fault::at(Reason::NumberTooLarge, letter))
}

impl<const N: usize> Modal<N> {
    /// The state at the start of a program.
    pub fn new(dialect: Dialect) -> Self {
        let mut modal = Self::ZERO;
        modal.modes.dialect = dialect;
        modal.modes.active = initial(dialect);
        modal
    }

    /// All bytes zero, as far as the extended codes add none: nothing that must be copied from a constant.
    const ZERO: Self = Modal {
        modes: Modes::NONE,
        homes: [[Nm(0); N]; 2],
        offsets: [[Nm(0); N]; SYSTEMS],
        tools: Tools::new(),
    };

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
    /// `N` what these change) is kept aside, in `commands`. `commands` are replaced. With an error there are none, and the state is as it was.
    ///
    /// # Errors
    /// Those of [`Modal::plan`].
    #[cfg_attr(not(target_has_atomic = "32"), inline(never))]
    pub fn apply(&mut self, block: &Block, commands: &mut Commands<N>) -> Result<(), Error> {
        commands.clear();
        let done = match self.plain_move(block) {
            Some(mode) => self.apply_move(block, mode, commands),
            None => self.apply_any(block, commands),
        };
        done.map_err(|fault| {
            commands.clear();
            block.error(fault, Measure::of(commands.arc.mismatch))
        })
    }

    /// The stages of [`Modal::execute`] that a block with nothing but a move has.
    #[inline(always)]
    fn apply_move(
        &mut self,
        block: &Block,
        mode: Code,
        commands: &mut Commands<N>,
    ) -> Result<(), Fault> {
        // The position and the mode change as the last things.
        let before = self.modes.feed;
        let done = self
            .check_axes(block)
            .and_then(|()| self.set_feed(block))
            .and_then(|()| match ROOMY {
                true => self.moves_on(block, mode, commands),
                false => self.moves(block, commands),
            });
        if done.is_err() {
            self.modes.feed = before;
        }
        done
    }

    #[cfg_attr(target_has_atomic = "32", inline(never))]
    #[cfg_attr(not(target_has_atomic = "32"), inline(always))]
    fn apply_any(&mut self, block: &Block, commands: &mut Commands<N>) -> Result<(), Fault> {
        self.modes.write_to(&mut commands.before);
        let done = self.execute(block, commands);
        if done.is_err() {
            commands.before.write_to(&mut self.modes);
            return done;
        }
        self.store(block, &commands.before.position);
        self.stop(block, commands);
        Ok(())
    }

    /// The motion of a block with nothing else, if it is one of G0 to G3, and that before it too, or none.
    #[inline(always)]
    fn plain_move(&self, block: &Block) -> Option<Code> {
        let before = self.active(Group::Motion);
        let code = block.code(Group::Motion).unwrap_or(before);
        // A cycle that ends here leaves words behind.
        let simple = before.is_plain_move() || before == Code::CancelMotion || !EXTENDED;
        Some(code).filter(|code| block.is_move() && code.is_plain_move() && simple)
    }

    /// The code in effect of a modal group.
    #[inline(always)]
    pub(crate) fn active(&self, group: Group) -> Code {
        let code = self.modes.active.get(group as usize).copied();
        code.flatten().unwrap_or(Code::Foreign)
    }

    #[inline(always)]
    pub(crate) fn set_active(&mut self, group: Group, code: Code) {
        if let Some(active) = self.modes.active.get_mut(group as usize) {
            *active = Some(code);
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
        #[cfg(feature = "extended")]
        return self.modes.more.compensation;
        #[cfg(not(feature = "extended"))]
        None
    }

    /// Whether X is a diameter (G7).
    pub fn is_diameter(&self) -> bool {
        EXTENDED && self.active(Group::Diameter) == Code::DiameterMode
    }

    /// The active work frame: 0 (G54) to 8 (G59.3).
    pub fn work_system(&self) -> u8 {
        let code = self.active(Group::System);
        if EXTENDED && code > Code::G59 {
            code.since(Code::G59_1).wrapping_add(6)
        } else {
            code.since(Code::G54)
        }
    }

    /// The dialect it was made for.
    pub fn dialect(&self) -> &Dialect {
        &self.modes.dialect
    }

    /// The motion mode; `None` at the start, after G80 and in the micromill dialect.
    pub fn motion(&self) -> Option<Motion> {
        Some(match self.active(Group::Motion) {
            Code::Rapid => Motion::Rapid,
            Code::Linear => Motion::Linear,
            Code::Clockwise => Motion::Clockwise,
            Code::CounterClockwise => Motion::CounterClockwise,
            Code::Cubic => Motion::Cubic,
            Code::Quadratic => Motion::Quadratic,
            Code::Thread => Motion::Thread,
            code if code.is_probe() => {
                let (away, must) = code.probe();
                Motion::Probe { away, must }
            }
            code => Motion::Cycle(code.cycle()?),
        })
    }

    /// The plane of arcs.
    pub fn plane(&self) -> Plane {
        match self.active(Group::Plane) {
            Code::PlaneZx => Plane::Zx,
            Code::PlaneYz => Plane::Yz,
            _ => Plane::Xy,
        }
    }

    /// The unit of lengths.
    pub fn units(&self) -> Units {
        match self.active(Group::Units) {
            Code::Inches => Units::Inches,
            Code::Micrometres => Units::Micrometres,
            _ => Units::Millimetres,
        }
    }

    /// How coordinates are meant.
    pub fn distance(&self) -> Distance {
        match self.active(Group::Distance) {
            Code::Incremental => Distance::Incremental,
            _ => Distance::Absolute,
        }
    }

    /// How arc centres are meant.
    pub fn centre_distance(&self) -> Distance {
        match self.active(Group::CentreDistance) {
            Code::AbsoluteCentres => Distance::Absolute,
            _ => Distance::Incremental,
        }
    }

    /// What `F` means.
    pub fn feed_mode(&self) -> FeedMode {
        match self.active(Group::FeedMode) {
            Code::InverseTime => FeedMode::InverseTime,
            Code::PerRevolution if EXTENDED => FeedMode::PerRevolution,
            _ => FeedMode::PerMinute,
        }
    }

    /// The feed of G94 in nm/min; `None` when none was given, and under G93 and G95.
    pub fn feed(&self) -> Option<Nm> {
        let rate = i64::try_from(self.modes.feed)
            .ok()
            .filter(|&rate| rate > 0 && self.feed_mode() == FeedMode::PerMinute);
        rate.map(Nm)
    }

    /// Spindle and coolant off, as after M5 and M9: for an abort outside of the program.
    pub fn stop_outputs(&mut self) {
        self.set_active(Group::Spindle, Code::SpindleOff);
        self.modes.mist = false;
        self.modes.flood = false;
    }

    /// Spindle direction and programmed speed in thousandths of a revolution a minute (kept while it is off).
    pub fn spindle(&self) -> (SpindleDirection, u64) {
        (self.spindle_direction(), self.modes.milli_rpm)
    }

    pub(crate) fn spindle_direction(&self) -> SpindleDirection {
        match self.active(Group::Spindle) {
            Code::SpindleClockwise => SpindleDirection::Clockwise,
            Code::SpindleCounterClockwise => SpindleDirection::CounterClockwise,
            _ => SpindleDirection::Off,
        }
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
        #[cfg(feature = "extended")]
        match self.active(Group::Path) {
            Code::ExactStop => return PathMode::ExactStop,
            Code::Blend => {
                let tolerance = self.modes.more.tolerance;
                return PathMode::Blend { tolerance };
            }
            _ => {}
        }
        PathMode::ExactPath
    }

    fn execute(&mut self, block: &Block, commands: &mut Commands<N>) -> Result<(), Fault> {
        self.check_axes(block)?;
        self.set_feed(block)?;
        self.set_outputs(block, commands)?;
        self.set_dwell(block, commands)?;
        self.set_modes(block, commands)?;
        self.moves(block, commands)
    }

    /// What G28.1, G30.1 and the micro mill's G54 keep of the position before the block, when it can no longer fail.
    fn store(&mut self, block: &Block, here: &[Nm; N]) {
        let [first, second] = &mut self.homes;
        match block.code(Group::NonModal) {
            Some(Code::StoreHome) => *first = *here,
            Some(Code::StoreSecondHome) => *second = *here,
            _ => {}
        }
        if self.modes.dialect.flavour == Flavour::Micromill && block.code(Group::System).is_some() {
            if let Some(offset) = self.offsets.first_mut() {
                *offset = *here;
            }
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
        if EXTENDED && self.modes.dialect.flavour == Flavour::Lathe {
            block.check_increments()?;
        }
        if foreign == 0 {
            return Ok(());
        }
        Err(Fault::at(Reason::UnknownWord, first_of(u32::from(foreign))))
    }

    fn stop(&mut self, block: &Block, commands: &mut Commands<N>) {
        let Some(code) = block.code(Group::Stop) else {
            return;
        };
        commands.finish(Some(code));
        if matches!(code, Code::End | Code::EndAndRewind) {
            self.end();
        }
    }

    /// What M2 and M30 reset: G54, G92.1 (not in the grbl dialect), G17 (lathes G18), G90, G94, G1, G40, M5, M9. Work
    /// zeros, tool length, units and the feed stay.
    fn end(&mut self) {
        if self.modes.dialect.flavour != Flavour::Grbl {
            self.modes.shift = [Nm(0); N];
        }
        if self.feed_mode() != FeedMode::PerMinute {
            self.modes.feed = 0;
        }
        let (lathe, micromill) = (
            self.modes.dialect.is_lathe(),
            self.modes.dialect.flavour == Flavour::Micromill,
        );
        for (group, code) in [
            (
                Group::Plane,
                if lathe { Code::PlaneZx } else { Code::PlaneXy },
            ),
            (Group::System, Code::G54),
            (Group::Distance, Code::Absolute),
            (Group::FeedMode, Code::PerMinute),
            (
                Group::Motion,
                if micromill {
                    Code::CancelMotion
                } else {
                    Code::Linear
                },
            ),
        ] {
            self.set_active(group, code);
        }
        #[cfg(feature = "extended")]
        {
            self.modes.sticky = Sticky::NONE;
            (self.modes.more.tail, self.modes.more.compensation) = (None, None);
        }
        self.stop_outputs();
    }

    /// Adds a word to a length, if the block has it; both stay within [`Nm::LIMIT`].
    #[cfg_attr(target_pointer_width = "64", inline(always))]
    #[cfg_attr(not(target_has_atomic = "32"), inline(never))]
    pub(crate) fn add_word(&self, block: &Block, letter: u8, to: &mut Nm) -> Result<(), Fault> {
        let (factor, exponent) = self.scale_of(letter);
        let Some(word) = block.value(letter) else {
            return Ok(());
        };
        if let Some(value) = word.scaled(i32::from(factor), exponent) {
            // Both below 2^63 / 2 where it counts.
            let sum = Nm(to.0.wrapping_add(value));
            if Nm(value).within_limit().is_some() && sum.within_limit().is_some() {
                *to = sum;
                return Ok(());
            }
        }
        Err(Fault::at(Reason::NumberTooLarge, letter))
    }

    /// The unit of a word: degrees, in millionths, or the unit of lengths, or half of it.
    fn scale_of(&self, letter: u8) -> (u8, u8) {
        match letter {
            b'A' | b'B' | b'C' => Units::Millimetres.scale(false),
            b'X' | b'U' if self.is_diameter() => self.units().scale(true),
            _ => self.units().scale(false),
        }
    }

    /// A word as a length, if the block has it.
    #[cfg(feature = "extended")]
    pub(crate) fn length_of(&self, block: &Block, letter: u8) -> Result<Option<Nm>, Fault> {
        if block.word(letter).is_none() {
            return Ok(None);
        }
        let mut length = Nm(0);
        self.add_word(block, letter, &mut length)?;
        Ok(Some(length))
    }
}

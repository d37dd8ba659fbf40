//! Frames and tools: G10, G28 and G30, G43 and G49, G92, and the sides of G41 and G42.

use crate::blocks::block::Block;
use crate::blocks::fault::{Fault, Reason};
#[cfg(feature = "extended")]
use crate::codes::code::Side;
use crate::codes::code::{Code, Group};
use crate::codes::dialect::Flavour;
use crate::codes::letters::{AXES, axis_letter};
use crate::features::EXTENDED;
use crate::modal::Modal;
use crate::modal::commands::{Commands, Entry};
use crate::modal::modes::Units;
use crate::modal::settings::missing;
#[cfg(feature = "extended")]
use crate::modal::settings::whole;
use crate::modal::tools::Tool;
use crate::values::nm::{Nm, coordinate};

/// Offsets that are added to an axis word: some zeros, and the position or the value that the
/// position shall read.
#[derive(Copy, Clone, Eq, PartialEq)]
pub(crate) struct Terms(u8);

const SYSTEM: u8 = 1;
const SHIFT: u8 = 2;
const LENGTH: u8 = 4;
#[cfg(feature = "extended")]
const FIXTURE: u8 = 8;
const POSITION: u8 = 16;
const HERE: u8 = 32;
/// The end of a move; increments count from the position.
const END: u8 = 64;

impl Terms {
    /// The value without any offset.
    pub(crate) const NONE: Terms = Terms(0);
    /// The end of a move in the machine frame, in the work frame, or relative to the position.
    pub(crate) const MACHINE: Terms = Terms(END);
    pub(crate) const WORK: Terms = Terms(END | SYSTEM | SHIFT | LENGTH);
    pub(crate) const INCREMENT: Terms = Terms(END | POSITION);
    /// The zero of a frame for which the present position reads the value: in the work frame (G10
    /// L20), and by G92.
    pub(crate) const TO_SYSTEM: Terms = Terms(HERE | SHIFT | LENGTH);
    pub(crate) const TO_SHIFT: Terms = Terms(HERE | SYSTEM | LENGTH);
    /// The tool length for which the present position reads the value: in the work frame (G10 L10),
    /// or in the fixture of G59.3 regardless of the other shifts (G10 L11).
    #[cfg(feature = "extended")]
    pub(crate) const TO_LENGTH: Terms = Terms(HERE | SYSTEM | SHIFT);
    #[cfg(feature = "extended")]
    const TO_LENGTH_IN_FIXTURE: Terms = Terms(HERE | FIXTURE);

    const fn has(self, term: u8) -> bool {
        self.0 & term != 0
    }
}

impl<const N: usize> Modal<N> {
    /// Replaces the coordinates of the axes that the block gives.
    #[cfg_attr(target_pointer_width = "64", inline(always))]
    #[cfg_attr(not(target_has_atomic = "32"), inline(always))]
    pub(crate) fn read_axes(
        &self,
        block: &Block,
        terms: Terms,
        to: &mut [Nm; N],
    ) -> Result<(), Fault> {
        #[cfg(feature = "extended")]
        if self.is_turned(block, terms) {
            return self.read_turned(block, terms, to).map(|_| ());
        }
        self.read_straight(block, terms, to)
    }

    /// The same for words that are only added to a zero: no polar coordinates, and no rotated
    /// frame.
    #[cfg_attr(target_pointer_width = "64", inline(always))]
    #[cfg_attr(not(target_has_atomic = "32"), inline(never))]
    pub(crate) fn read_straight(
        &self,
        block: &Block,
        terms: Terms,
        to: &mut [Nm; N],
    ) -> Result<(), Fault> {
        #[cfg(feature = "extended")]
        if terms.has(END) && !self.modes.dialect.has_plain_axes() {
            return self.read_odd_axes(block, terms, to);
        }
        let mut given = block.axes();
        // There are no axes beyond those with letters, and no bits of `given`.
        for (axis, to) in (0..AXES).zip(to.iter_mut()) {
            if given & 1 != 0 {
                self.read_axis(block, terms, axis, to)?;
            }
            given >>= 1;
        }
        Ok(())
    }

    /// The end of a move. A fast form of [`Modal::read_axes`] without diameters and increments;
    /// values that are equal for all axes are looked up once.
    #[inline(always)]
    pub(crate) fn read_end(
        &self,
        block: &Block,
        terms: Terms,
        to: &mut [Nm; N],
    ) -> Result<(), Fault> {
        let [first, ..] = &self.offsets;
        // There is no system without a zero. A zero of its own would be a test at each axis.
        let system = self.offsets.get(usize::from(self.work_system()));
        let zeros = system.unwrap_or(first).iter();
        let zeros = zeros.zip(&self.modes.shift).zip(&self.modes.length);
        let axes = (0..AXES).zip(to.iter_mut()).zip(&self.modes.position);
        let (lengths, degrees) = (self.units().scale(false), Units::Millimetres.scale(false));
        let (absolute, incremental) = (terms.has(SYSTEM), terms.has(POSITION));
        let words = block.axis_words();
        for (((axis, to), position), ((word, given), ((system, shift), length))) in
            axes.zip(words.zip(zeros))
        {
            *to = *position;
            if !given {
                continue;
            }
            let is_rotary = match EXTENDED {
                true => axis >= 3 && self.modes.dialect.axes().is_rotary(axis),
                false => axis >= 3,
            };
            let (factor, exponent) = if is_rotary { degrees } else { lengths };
            let value = word.scaled(i32::from(factor), exponent);
            let value = value.and_then(|value| Nm(value).within_limit());
            // Each is within Nm::LIMIT, unless a caller gave more; the sum is then beyond the limit
            // too.
            let zero = if absolute {
                system.0.saturating_add(shift.0).saturating_add(length.0)
            } else if incremental {
                position.0
            } else {
                0
            };
            let end = value.and_then(|value| Nm(value.0.wrapping_add(zero)).within_limit());
            match end {
                Some(end) => *to = end,
                None => return Err(Fault::at(Reason::NumberTooLarge, axis_letter(axis))),
            }
        }
        Ok(())
    }

    /// Reads an axis whose word is only added to a zero.
    #[inline(always)]
    fn read_axis(
        &self,
        block: &Block,
        terms: Terms,
        axis: usize,
        to: &mut Nm,
    ) -> Result<(), Fault> {
        let (value, terms) = self.axis_word(block, terms, axis)?;
        self.place_axis(block, terms, axis, value, to)
    }

    /// The length of an axis word, and the terms to which it is added.
    #[inline(always)]
    fn axis_word(
        &self,
        block: &Block,
        mut terms: Terms,
        axis: usize,
    ) -> Result<(Nm, Terms), Fault> {
        let letter = block.letter_of(axis);
        if EXTENDED && terms.has(END) && block.increment(axis).is_some() {
            if block.axis(axis).is_some() {
                return Err(Fault::at(Reason::TwoUsersOfWords, letter));
            }
            terms = Terms::INCREMENT;
        }
        let mut value = Nm(0);
        self.add_word(block, letter, &mut value)?;
        Ok((value, terms))
    }

    /// Adds the terms to the length of an axis word.
    #[inline(always)]
    fn place_axis(
        &self,
        block: &Block,
        terms: Terms,
        axis: usize,
        mut value: Nm,
        to: &mut Nm,
    ) -> Result<(), Fault> {
        // All within a few times Nm::LIMIT.
        value.0 = value.0.wrapping_add(self.sum_of(axis, terms).0);
        if terms.has(HERE) {
            let here = coordinate(&self.modes.position, axis);
            value.0 = here.0.wrapping_sub(value.0);
        }
        let end = value.within_limit();
        *to = end.ok_or_else(|| Fault::at(Reason::NumberTooLarge, block.letter_of(axis)))?;
        Ok(())
    }

    /// The same as [`Modal::read_straight`] where an axis is wrapped or an extruder.
    #[cfg(feature = "extended")]
    #[cold]
    #[inline(never)]
    fn read_odd_axes(&self, block: &Block, terms: Terms, to: &mut [Nm; N]) -> Result<(), Fault> {
        for (axis, to) in (0..AXES).zip(to.iter_mut()) {
            if block.axes() & 1u16.wrapping_shl(axis as u32) != 0 {
                self.read_any_axis(block, terms, axis, to)?;
            }
        }
        Ok(())
    }

    /// Reads an axis of any kind.
    #[cfg(feature = "extended")]
    #[inline(never)]
    pub(crate) fn read_any_axis(
        &self,
        block: &Block,
        terms: Terms,
        axis: usize,
        to: &mut Nm,
    ) -> Result<(), Fault> {
        let (mut value, mut terms) = self.axis_word(block, terms, axis)?;
        if terms.has(END) && !self.modes.dialect.has_plain_axes() {
            (value, terms) = self.read_odd_axis(block, terms, axis, value)?;
        }
        self.place_axis(block, terms, axis, value, to)
    }

    /// The value and the terms of a wrapped axis or the extruder of a printer; those of other axes
    /// stay.
    #[cfg(feature = "extended")]
    #[cold]
    #[inline(never)]
    fn read_odd_axis(
        &self,
        block: &Block,
        mut terms: Terms,
        axis: usize,
        mut value: Nm,
    ) -> Result<(Nm, Terms), Fault> {
        if self.is_extruder(axis) && terms != Terms::MACHINE {
            terms = match self.modes.more.feeds_increments {
                true => Terms::INCREMENT,
                false => Terms::WORK,
            };
        }
        if !terms.has(POSITION) && self.modes.dialect.axes().is_wrapped(axis) {
            let has_minus = block.axis(axis).is_some_and(|word| word.has_minus());
            // Coordinates are below 2^52.
            let zero = self.sum_of(axis, terms);
            let here = coordinate(&self.modes.position, axis)
                .0
                .wrapping_sub(zero.0);
            value = wrapped(value, has_minus, Nm(here))
                .ok_or(Fault::at(Reason::OutOfRange, block.letter_of(axis)))?;
        }
        Ok((value, terms))
    }

    /// The sum of some coordinates.
    #[cfg_attr(target_pointer_width = "64", inline(always))]
    #[cfg_attr(not(target_has_atomic = "32"), inline(never))]
    fn sum_of(&self, axis: usize, terms: Terms) -> Nm {
        let system = self.offsets.get(usize::from(self.work_system()));
        let mut sum = 0i64;
        for (term, point) in [
            (SYSTEM, system),
            (SHIFT, Some(&self.modes.shift)),
            (LENGTH, Some(&self.modes.length)),
            (POSITION, Some(&self.modes.position)),
            #[cfg(feature = "extended")]
            (FIXTURE, self.offsets.last()),
        ] {
            if let Some(point) = point.filter(|_| terms.has(term)) {
                // A few times Nm::LIMIT, unless a caller gave more; the sum is then beyond the
                // limit too.
                sum = sum.saturating_add(coordinate(point, axis).0);
            }
        }
        Nm(sum)
    }

    /// The active work zero of one axis, without the tool length.
    pub(crate) fn work_offset_of(&self, axis: usize) -> Nm {
        self.sum_of(axis, Terms(SYSTEM | SHIFT))
    }

    /// The work zero of the programmed point, including the tool length.
    pub(crate) fn zero_of(&self, axis: usize) -> Nm {
        self.sum_of(axis, Terms::WORK)
    }

    #[cfg(feature = "extended")]
    #[inline(never)]
    pub(crate) fn set_compensation(
        &mut self,
        block: &Block,
        commands: &mut Commands<N>,
    ) -> Result<(), Fault> {
        let (side, direct) = match block.code(Group::Compensation) {
            None => return Ok(()),
            Some(Code::CompensateLeft) => (Side::Left, false),
            Some(Code::CompensateLeftDirect) => (Side::Left, true),
            Some(Code::CompensateRight) => (Side::Right, false),
            Some(Code::CompensateRightDirect) => (Side::Right, true),
            Some(_) => {
                if self.modes.more.compensation.take().is_some() {
                    commands.compensation(None, Nm(0), self.plane());
                }
                return Ok(());
            }
        };
        if self.modes.more.compensation.is_some() {
            return Err(Fault::at_code(
                Reason::UnderCompensation,
                Group::Compensation,
            ));
        }
        let radius = if direct {
            let value = block
                .word(b'D')
                .ok_or_else(|| missing(b'D', Group::Compensation))?;
            self.units()
                .half(value)
                .ok_or_else(|| Fault::at(Reason::NumberTooLarge, b'D'))?
        } else {
            match whole(block, b'D', u32::MAX)? {
                Some(0) => Nm(0),
                Some(number) => {
                    let tool = self.tools.get(number);
                    tool.ok_or_else(|| Fault::at(Reason::UnknownTool, b'D'))?
                        .radius
                }
                None => {
                    let tool = self.tools.get(self.modes.loaded);
                    let unknown = || Fault::at_code(Reason::UnknownTool, Group::Compensation);
                    tool.ok_or_else(unknown)?.radius
                }
            }
        };
        // A negative radius puts the tool on the other side.
        let side = match (side, radius < Nm(0)) {
            (Side::Left, true) => Side::Right,
            (Side::Right, true) => Side::Left,
            (side, false) => side,
        };
        self.modes.more.compensation = Some(side);
        commands.compensation(Some(side), Nm(radius.0.saturating_abs()), self.plane());
        Ok(())
    }

    #[inline(never)]
    pub(crate) fn set_tool_length(
        &mut self,
        block: &Block,
        commands: &mut Commands<N>,
    ) -> Result<(), Fault> {
        let Some(code) = block.code(Group::ToolLength) else {
            return Ok(());
        };
        #[cfg_attr(not(feature = "extended"), expect(unused_mut))]
        let mut number = 0;
        let to = &mut commands.arc.to;
        *to = self.modes.length;
        match code {
            #[cfg(feature = "extended")]
            Code::ToolLength => {
                number = self.modes.loaded;
                block.whole(b'H', u32::MAX, &mut number)?;
                // A tool that is not in the table has no length; its length is part of the work
                // zero.
                *to = self.tools.get(number).unwrap_or_default().offset;
            }
            Code::DirectToolLength => {
                if block.axes() == 0 {
                    return Err(Fault::at_code(Reason::NoAxisWords, Group::ToolLength));
                }
                self.read_axes(block, Terms::NONE, to)?;
            }
            _ => {
                *to = [Nm(0); N];
                // G49 is in the first line of many programs.
                if self.modes.length == *to {
                    return Ok(());
                }
            }
        }
        #[cfg(feature = "extended")]
        if self.compensation().is_some() {
            // The compensated contour must not shift in its plane.
            let differs = |axis: usize| self.modes.length.get(axis) != to.get(axis);
            if self.plane().axes().into_iter().any(differs) {
                return Err(Fault::at_code(Reason::UnderCompensation, Group::ToolLength));
            }
        }
        self.modes.length = *to;
        commands.length(number, &self.modes.length);
        Ok(())
    }

    /// G10 and its `L`.
    #[inline(never)]
    pub(crate) fn set_data(
        &mut self,
        block: &Block,
        commands: &mut Commands<N>,
    ) -> Result<(), Fault> {
        let (mut kind, mut number) = (0, 0);
        needed(block, b'L', u8::MAX.into(), &mut kind)?;
        needed(block, b'P', u32::MAX, &mut number)?;
        let terms = match kind {
            #[cfg(feature = "extended")]
            1 | 10 | 11 if self.modes.dialect.flavour != Flavour::Grbl => {
                return self.write_tool(block, kind, number, commands);
            }
            2 => Terms::NONE,
            20 => Terms::TO_SYSTEM,
            _ => return Err(Fault::at(Reason::OutOfRange, b'L')),
        };
        let grbl = self.modes.dialect.flavour == Flavour::Grbl;
        #[cfg(feature = "extended")]
        let angle = self.angle_of(block, kind == 2 && !grbl)?;
        #[cfg(not(feature = "extended"))]
        if block.word(b'R').is_some_and(|angle| !angle.is_zero()) {
            return Err(Fault::at(Reason::OutOfRange, b'R'));
        }
        let system = match number.checked_sub(1) {
            None => u32::from(self.work_system()),
            Some(system) => system,
        };
        let zero = self.offsets.get(system as usize);
        let zero = zero.filter(|_| !(EXTENDED && grbl && system >= 6));
        let to = &mut commands.arc.to;
        *to = *zero.ok_or(Fault::at(Reason::OutOfRange, b'P'))?;
        #[cfg(feature = "extended")]
        if kind == 20 {
            self.read_system(block, system, to)?;
        } else {
            self.read_axes(block, terms, to)?;
        }
        #[cfg(not(feature = "extended"))]
        self.read_axes(block, terms, to)?;
        #[cfg(feature = "extended")]
        if let Some(to) = self.angles.get_mut(system as usize) {
            commands.kept_angle = *to;
            *to = angle.unwrap_or(*to);
            self.note_rotation();
        }
        if let Some(zero) = self.offsets.get_mut(system as usize) {
            // There are at most nine frames.
            commands.keep(Entry::System(system as u8), zero);
            *zero = commands.arc.to;
        }
        Ok(())
    }

    /// G10 L1, L10, L11: the length and the radius of a tool.
    #[cfg(feature = "extended")]
    fn write_tool(
        &mut self,
        block: &Block,
        kind: u32,
        number: u32,
        commands: &mut Commands<N>,
    ) -> Result<(), Fault> {
        if number == 0 {
            return Err(Fault::at(Reason::OutOfRange, b'P'));
        }
        let mut tool = self.tools.get(number).unwrap_or_default();
        let terms = match kind {
            1 => Terms::NONE,
            10 => Terms::TO_LENGTH,
            _ => Terms::TO_LENGTH_IN_FIXTURE,
        };
        self.read_axes(block, terms, &mut tool.offset)?;
        if let Some(radius) = self.length_of(block, b'R')? {
            tool.radius = radius;
        }
        let place = self.tools.place(number);
        let place = place.ok_or(Fault::at(Reason::ToolTableFull, b'P'))?;
        if let Some((number, before)) = self.tools.put(place, number, tool) {
            // There are eight places.
            commands.keep(Entry::Tool(place as u8), &before.offset);
            commands.kept_tool = (number, before.radius);
        }
        Ok(())
    }

    /// G92: sets the coordinates of the present position to the axis words; on the drill to zero
    /// without any.
    #[inline(never)]
    pub(crate) fn set_shift(
        &mut self,
        block: &Block,
        commands: &mut Commands<N>,
    ) -> Result<(), Fault> {
        if block.axes() == 0 {
            let flavour = self.modes.dialect.flavour;
            if flavour != Flavour::Drill && !(EXTENDED && flavour == Flavour::Printer) {
                return Err(Fault::at_code(Reason::NoAxisWords, Group::NonModal));
            }
            for axis in 0..N {
                let here = coordinate(&self.modes.position, axis);
                let zero = self.sum_of(axis, Terms(SYSTEM | LENGTH));
                if let Some(shift) = self.modes.shift.get_mut(axis) {
                    *shift = Nm(here.0.saturating_sub(zero.0));
                }
            }
        }
        let to = &mut commands.arc.to;
        *to = self.modes.shift;
        self.read_axes(block, Terms::TO_SHIFT, to)?;
        (self.modes.shift, self.modes.kept_shift) = (*to, *to);
        Ok(())
    }

    /// G52: shifts all work frames by the axis words. The shift is that of G92, as in LinuxCNC.
    #[cfg(feature = "extended")]
    #[inline(never)]
    pub(crate) fn set_local_shift(
        &mut self,
        block: &Block,
        commands: &mut Commands<N>,
    ) -> Result<(), Fault> {
        if block.axes() == 0 {
            return Err(Fault::at_code(Reason::NoAxisWords, Group::NonModal));
        }
        let to = &mut commands.arc.to;
        *to = self.modes.shift;
        self.read_axes(block, Terms::NONE, to)?;
        (self.modes.shift, self.modes.kept_shift) = (*to, *to);
        Ok(())
    }

    /// G28 and G30: through the given point to the stored position, with the named axes only.
    /// Without axis words all axes go straight.
    #[inline(never)]
    pub(crate) fn go_home(
        &mut self,
        block: &Block,
        second: bool,
        commands: &mut Commands<N>,
    ) -> Result<(), Fault> {
        let mut given = block.axes();
        self.aim(block, self.terms(), commands)?;
        if self.modes.dialect.flavour == Flavour::Micromill {
            if given == 0 {
                return Err(Fault::at_code(Reason::NoAxisWords, Group::NonModal));
            }
            self.check_z_alone(block)?;
            for axis in 0..AXES {
                if block.axis(axis).is_some_and(|value| !value.is_zero()) {
                    return Err(Fault::at(Reason::NotZero, axis_letter(axis)));
                }
            }
        } else if given != 0 && !(EXTENDED && self.modes.dialect.flavour == Flavour::Printer) {
            commands.via = commands.arc.to;
            commands.go_via();
        }
        if given == 0 {
            // A printer has no home of its extruder.
            given = match self.modes.dialect.flavour {
                Flavour::Printer if EXTENDED => 0b111,
                _ => u16::MAX,
            };
        }
        // Axes that are not named stay at the intermediate point.
        let [first, other] = &self.homes;
        let home = if second { other } else { first };
        for (to, home) in commands.arc.to.iter_mut().zip(home) {
            if given & 1 != 0 {
                *to = *home;
            }
            given >>= 1;
        }
        #[cfg(feature = "extended")]
        self.unwind(block, commands);
        self.go(Code::Rapid, commands);
        Ok(())
    }
}

/// A turn in millionths of a degree.
#[cfg(feature = "extended")]
const TURN: i64 = 360_000_000;

/// The position of a wrapped axis for a word: its magnitude in the turn in which the axis stands,
/// or in the next one in the direction of the sign. `None` for a turn or more.
///
/// # Source
/// LinuxCNC, `interp_find.cc`, `unwrap_rotary`.
#[cfg(feature = "extended")]
fn wrapped(word: Nm, has_minus: bool, here: Nm) -> Option<Nm> {
    let magnitude = word.0.saturating_abs();
    if magnitude >= TURN {
        return None;
    }
    // |here| < 2^53, so all sums fit.
    let turn = here.0.wrapping_sub(here.0.rem_euclid(TURN));
    let mut end = turn.wrapping_add(magnitude);
    if has_minus && end > here.0 {
        end = end.wrapping_sub(TURN);
    } else if !has_minus && end < here.0 {
        end = end.wrapping_add(TURN);
    }
    Some(Nm(end))
}

#[cfg(feature = "extended")]
impl<const N: usize> Modal<N> {
    /// The home of a wrapped axis is the same angle in any turn: the axis goes there in the shorter
    /// direction, however many turns it has made.
    fn unwind(&self, block: &Block, commands: &mut Commands<N>) {
        let goes_via = block.axes() != 0;
        let before = if goes_via {
            &commands.via
        } else {
            &self.modes.position
        };
        for (axis, (to, here)) in (0..N).zip(commands.arc.to.iter_mut().zip(before)) {
            if self.modes.dialect.axes().is_wrapped(axis) {
                // Both are below 2^52.
                let ahead = to.0.wrapping_sub(here.0).rem_euclid(TURN);
                let way = if ahead > TURN / 2 {
                    ahead.wrapping_sub(TURN)
                } else {
                    ahead
                };
                *to = Nm(here.0.wrapping_add(way));
            }
        }
    }
}

/// A whole number that G10 needs.
#[cfg_attr(not(target_has_atomic = "32"), inline(never))]
fn needed(block: &Block, letter: u8, most: u32, to: &mut u32) -> Result<(), Fault> {
    if !block.has(letter) {
        return Err(missing(letter, Group::NonModal));
    }
    block.whole(letter, most, to)
}

impl<const N: usize> Tool<N> {
    /// A tool without length.
    pub const fn of_radius(radius: Nm) -> Self {
        Tool {
            offset: [Nm(0); N],
            radius,
        }
    }
}

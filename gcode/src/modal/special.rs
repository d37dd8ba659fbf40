//! Splines and synchronised moves: G5 to G5.3, G33, G33.1.

use crate::blocks::block::Block;
use crate::blocks::fault::{Fault, Reason};
use crate::codes::code::Code;
use crate::codes::code::Group;
use crate::codes::dialect::Flavour;
use crate::command::arc::Plane;
use crate::modal::commands::Commands;
use crate::modal::settings::{unsigned, whole};
use crate::modal::{Modal, shifted};
use crate::values::nm::Nm;

/// The largest order of a NURBS.
const MOST_ORDER: u8 = 16;

impl<const N: usize> Modal<N> {
    /// X and Y of a point.
    fn plane_point(point: &[Nm; N]) -> [Nm; 2] {
        [0, 1].map(|axis| point.get(axis).copied().unwrap_or_default())
    }

    /// A pair of words added to a point; `None` when the block has neither.
    fn offset(
        &self,
        block: &Block,
        letters: [u8; 2],
        from: [Nm; 2],
    ) -> Result<Option<[Nm; 2]>, Fault> {
        if letters.iter().all(|&letter| block.word(letter).is_none()) {
            return Ok(None);
        }
        let mut words = [Nm(0); 2];
        for (word, letter) in words.iter_mut().zip(letters) {
            self.add_word(block, letter, word)?;
        }
        let mut point = from;
        for ((entry, word), letter) in point.iter_mut().zip(self.turned(words)).zip(letters) {
            *entry = shifted(*entry, word, letter)?;
        }
        Ok(Some(point))
    }

    /// Start and end of a spline, which is in XY only.
    fn spline_ends(&self, block: &Block) -> Result<([Nm; 2], [Nm; N]), Fault> {
        if block.axes() == 0 {
            return Err(Fault::at_code(Reason::NoAxisWords, Group::Motion));
        }
        if self.plane() != Plane::Xy || block.axes() & !0b11 != 0 || N < 2 {
            return Err(Fault::at_motion(Reason::SplinePlane));
        }
        let to = self.target(block)?;
        Ok((Self::plane_point(&self.modes.position), to))
    }

    /// G5: I J from the start, P Q from the end. After another G5, I and J may be omitted for a
    /// smooth join.
    #[inline(never)]
    pub(crate) fn cubic(&mut self, block: &Block, commands: &mut Commands<N>) -> Result<(), Fault> {
        let (from, to) = self.spline_ends(block)?;
        let end = Self::plane_point(&to);
        let first = match (
            self.offset(block, [b'I', b'J'], from)?,
            self.modes.more.tail,
        ) {
            (Some(first), _) => first,
            (None, Some(tail)) => {
                let mut first = from;
                for (first, tail) in first.iter_mut().zip(tail) {
                    // Each within 2^50.
                    first.0 = first.0.saturating_add(tail.0);
                }
                first
            }
            (None, None) => return Err(Fault::at_motion(Reason::MissingWord).of(b'I')),
        };
        for letter in [b'P', b'Q'] {
            if block.word(letter).is_none() {
                return Err(Fault::at_motion(Reason::MissingWord).of(letter));
            }
        }
        let second = self.offset(block, [b'P', b'Q'], end)?.unwrap_or(end);
        let mut tail = end;
        for (tail, second) in tail.iter_mut().zip(second) {
            tail.0 = tail.0.saturating_sub(second.0);
        }
        self.modes.more.tail = Some(tail);
        self.spline(to, [from, first, second, end], commands)
    }

    /// G5.1: I J from the start to the only control point.
    #[inline(never)]
    pub(crate) fn quadratic(
        &mut self,
        block: &Block,
        commands: &mut Commands<N>,
    ) -> Result<(), Fault> {
        let (from, to) = self.spline_ends(block)?;
        let end = Self::plane_point(&to);
        let control = self
            .offset(block, [b'I', b'J'], from)?
            .filter(|&control| control != from)
            .ok_or_else(|| Fault::at_motion(Reason::MissingWord).of(b'I'))?;
        let points = [from, toward(from, control), toward(end, control), end];
        self.spline(to, points, commands)
    }

    fn spline(
        &mut self,
        to: [Nm; N],
        points: [[Nm; 2]; 4],
        commands: &mut Commands<N>,
    ) -> Result<(), Fault> {
        self.set_feed_of(commands)?;
        commands.arc.to = to;
        commands.points = points;
        self.go(Code::Cubic, commands);
        Ok(())
    }

    /// G5.2: X and Y of a control point, `P` its weight. The first block of a curve may have `L`,
    /// its order, and without X and Y its `P` is the weight of the present position.
    #[inline(never)]
    pub(crate) fn nurbs(&mut self, block: &Block, commands: &mut Commands<N>) -> Result<(), Fault> {
        if self.plane() != Plane::Xy || block.axes() & !0b11 != 0 || N < 2 {
            return Err(Fault::at_motion(Reason::SplinePlane));
        }
        let has_point = match block.axes() {
            0 => false,
            0b11 => true,
            given => {
                let missing = if given & 1 == 0 { b'X' } else { b'Y' };
                return Err(Fault::at_motion(Reason::MissingWord).of(missing));
            }
        };
        let weight = match block.word(b'P') {
            None => 1_000_000,
            Some(value) => unsigned(value, 6)
                .filter(|&weight| weight > 0)
                .ok_or(Fault::at(Reason::OutOfRange, b'P'))?,
        };
        self.set_feed_of(commands)?;
        let (mut order, mut points) = self.modes.more.nurbs;
        if order == 0 {
            order = whole(block, b'L', MOST_ORDER)?.unwrap_or(3);
            if order < 2 {
                return Err(Fault::at(Reason::OutOfRange, b'L'));
            }
            commands.begin_nurbs(order, if has_point { 1_000_000 } else { weight });
            self.modes.more.tail = Some(Self::plane_point(&self.modes.position));
            points = 1;
        } else if block.has(b'L') {
            return Err(Fault::at(Reason::UnusedWord, b'L'));
        } else if !has_point {
            return Err(Fault::at_code(Reason::NoAxisWords, Group::Motion));
        }
        if has_point {
            let to = self.target(block)?;
            let last = Self::plane_point(&to);
            self.modes.more.tail = Some(last);
            points = points.saturating_add(1);
            commands.nurbs_point(last, weight);
        }
        self.modes.more.nurbs = (order, points);
        Ok(())
    }

    /// G5.3: ends the curve in its last control point.
    pub(crate) fn end_nurbs(
        &mut self,
        block: &Block,
        commands: &mut Commands<N>,
    ) -> Result<(), Fault> {
        if block.axes() != 0 {
            let letter = block.letter_of(block.axes().trailing_zeros() as usize);
            return Err(Fault::at(Reason::UnusedWord, letter));
        }
        let (order, points) = core::mem::take(&mut self.modes.more.nurbs);
        if order == 0 || points < u32::from(order) {
            return Err(Fault::at_motion(Reason::TooFewPoints));
        }
        let last = self.modes.more.tail.unwrap_or_default();
        commands.arc.to = self.modes.position;
        for (to, last) in commands.arc.to.iter_mut().zip(last) {
            *to = last;
        }
        self.go(Code::NurbsEnd, commands);
        Ok(())
    }

    /// Refuses what interrupts a NURBS.
    pub(crate) fn check_nurbs(&self, block: &Block, mode: Code) -> Result<(), Fault> {
        if self.modes.more.nurbs.0 == 0 {
            return Ok(());
        }
        if !matches!(mode, Code::Nurbs | Code::NurbsEnd) {
            return Err(Fault::at_motion(Reason::NurbsOpen));
        }
        for (group, harmless) in [
            (Group::NonModal, Code::Dwell),
            (Group::Stop, Code::OptionalStop),
        ] {
            if block.code(group).is_some_and(|code| code != harmless) {
                return Err(Fault::at_code(Reason::NurbsOpen, group));
            }
        }
        Ok(())
    }

    /// The end and the lead of a move that follows the spindle.
    fn follow_spindle(&mut self, block: &Block, commands: &mut Commands<N>) -> Result<(), Fault> {
        if block.axes() == 0 {
            return Err(Fault::at_code(Reason::NoAxisWords, Group::Motion));
        }
        commands.lead = self.lead(block)?;
        self.check_turning()?;
        self.aim(block, self.terms(), commands)
    }

    /// G33.1: `K` is the lead.
    #[inline(never)]
    pub(crate) fn rigid_tap(
        &mut self,
        block: &Block,
        commands: &mut Commands<N>,
    ) -> Result<(), Fault> {
        self.follow_spindle(block, commands)?;
        commands.via = commands.arc.to;
        commands.arc.to = self.modes.position;
        self.go(Code::RigidTap, commands);
        Ok(())
    }

    /// G33: `K` is the lead; in code system A of lathes (G32) it is `F`.
    #[inline(never)]
    pub(crate) fn thread(
        &mut self,
        block: &Block,
        commands: &mut Commands<N>,
    ) -> Result<(), Fault> {
        self.follow_spindle(block, commands)?;
        self.go(Code::Thread, commands);
        Ok(())
    }

    /// The lead of a thread: `K`, or `F` in code system A of lathes; in a series that of the
    /// previous block.
    pub(crate) fn lead(&mut self, block: &Block) -> Result<Nm, Fault> {
        let letter = if self.modes.dialect.flavour == Flavour::LatheA && block.word(b'K').is_none()
        {
            b'F'
        } else {
            b'K'
        };
        let lead = match self.length_of(block, letter)? {
            Some(lead) => lead,
            None => self.modes.sticky.lead,
        };
        if lead == Nm(0) && block.word(letter).is_none() {
            return Err(Fault::at_motion(Reason::MissingWord).of(letter));
        }
        if lead <= Nm(0) {
            return Err(Fault::at(Reason::OutOfRange, letter));
        }
        self.modes.sticky.lead = lead;
        Ok(lead)
    }
}

/// Two thirds of the distance from an end to the control point, rounded to the nearest nanometre
/// (there are no halves).
fn toward(end: [Nm; 2], control: [Nm; 2]) -> [Nm; 2] {
    let mut point = end;
    for (point, control) in point.iter_mut().zip(control) {
        // Below 2^52, so twice that plus one fits.
        let twice = control.0.saturating_sub(point.0).wrapping_mul(2);
        let third = twice.wrapping_add(1).wrapping_div_euclid(3);
        point.0 = point.0.saturating_add(third);
    }
    point
}

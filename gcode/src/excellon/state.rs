//! What the lines so far leave behind, and what coordinates mean by it.

use super::error::{Error, ErrorKind};
use super::feature::{Feature, Features, Hole, Path, Slot};
use super::format::{Format, Units};
use super::operands::Operands;
use super::pattern::{Repeat, Stage};
use super::scanner::Word;
use super::tool::Tool;
use crate::arc::Direction;
use crate::nm::Nm;

/// The most repeats of one `R`.
const MOST_REPEATS: u16 = 9999;

/// What the caller has said and no line changes.
#[derive(Copy, Clone, Debug)]
pub(super) struct Pinned {
    pub units: bool,
    pub zeros: bool,
    pub digits: bool,
}

/// What the lines so far leave behind.
#[derive(Copy, Clone, Debug)]
pub(super) struct State {
    pub format: Format,
    /// Nothing has said the digits: they follow the unit.
    pub usual_digits: bool,
    pub header: bool,
    pub incremental: bool,
    pub mode: Mode,
    pub tool_down: bool,
    pub at: [Nm; 2],
    /// The last feature was a hole.
    pub hole_before: bool,
    pub tool: Option<Tool>,
    pub plated: Option<bool>,
    pub ended: bool,
    pub stage: Stage,
    pub told_after_end: bool,
}

/// An `M02` and what stands beside it.
#[derive(Copy, Clone, Debug)]
pub(super) struct Copies {
    pub word: Word,
    /// `R` before it.
    pub repeat: Option<Word>,
    /// M70, M80, M90.
    pub flags: [bool; 3],
    /// An `X` or `Y` without a number, which is zero.
    pub bare: bool,
}

/// What a coordinate does.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
pub(super) enum Mode {
    /// G05, G81: a hole.
    Drill,
    /// G00: a move of the rout.
    Move,
    /// G01: a straight rout.
    Line,
    /// G02, G03: a circular rout.
    Arc(Direction),
}

impl State {
    pub(super) fn set_units(&mut self, units: Units, pinned: Pinned) {
        if pinned.units {
            return;
        }
        if self.usual_digits && units != self.format.units {
            self.format.digits = units.digits();
        }
        self.format.units = units;
    }

    pub(super) fn length(&self, word: &Word) -> Result<Nm, Error> {
        word.number
            .length(&self.format)
            .ok_or(word.error(ErrorKind::NumberTooLarge))
    }

    /// The length of a word, or zero.
    pub(super) fn offset(&self, word: Option<&Word>) -> Result<Nm, Error> {
        word.map_or(Ok(Nm(0)), |word| self.length(word))
    }

    /// The point that the words name, seen from `from`.
    pub(super) fn target(&self, from: [Nm; 2], operands: &Operands) -> Result<[Nm; 2], Error> {
        let [x, y] = from;
        Ok([
            self.coordinate(x, operands.x.as_ref())?,
            self.coordinate(y, operands.y.as_ref())?,
        ])
    }

    pub(super) fn coordinate(&self, from: Nm, word: Option<&Word>) -> Result<Nm, Error> {
        let Some(word) = word else { return Ok(from) };
        let length = self.length(word)?;
        if !self.incremental {
            return Ok(length);
        }
        // Both are within 2^50.
        Nm(from.0.wrapping_add(length.0))
            .within_limit()
            .ok_or(word.error(ErrorKind::NumberTooLarge))
    }

    pub(super) fn tool_for(&self, operands: &Operands) -> Result<Tool, Error> {
        let tool = self.tool.ok_or(operands.error(ErrorKind::NoTool))?;
        Ok(Tool {
            plated: tool.plated.or(self.plated),
            ..tool
        })
    }

    pub(super) fn slot(
        &mut self,
        start: &Operands,
        end: &Operands,
        word: &Word,
    ) -> Result<Features, Error> {
        if !start.has_point() || !end.has_point() {
            return Err(word.error(ErrorKind::HalfSlot));
        }
        if let Some(odd) = start.of_arc().or(end.of_arc()) {
            return Err(odd.error(ErrorKind::UnknownWord(odd.letter)));
        }
        let from = self.target(self.at, start)?;
        let to = self.target(from, end)?;
        let tool = self.tool_for(start)?;
        self.at = to;
        self.hole_before = false;
        let slot = Slot {
            from,
            to,
            path: Path::Straight,
            tool,
        };
        Ok(Features::one(Feature::Slot(slot)))
    }

    pub(super) fn repeat(&mut self, step: &Operands, word: &Word) -> Result<Features, Error> {
        let count = word.whole(MOST_REPEATS)?;
        if count == 0 {
            return Err(word.error(ErrorKind::StepAndRepeat));
        }
        if let Some(odd) = step.of_arc() {
            return Err(odd.error(ErrorKind::UnknownWord(odd.letter)));
        }
        if self.mode != Mode::Drill {
            return Err(word.error(ErrorKind::RepeatOfSlot));
        }
        if !self.hole_before {
            return Err(word.error(ErrorKind::NothingToRepeat));
        }
        let tool = self.tool.ok_or(word.error(ErrorKind::NoTool))?;
        let tool = Tool {
            plated: tool.plated.or(self.plated),
            ..tool
        };
        let steps = [
            self.offset(step.x.as_ref())?.0,
            self.offset(step.y.as_ref())?.0,
        ];
        let [x, y] = self.at;
        let after = |from: Nm, step: i64, count: u16| {
            let way = step.checked_mul(i64::from(count))?;
            Nm(from.0.checked_add(way)?).within_limit()
        };
        let [step_x, step_y] = steps;
        let point = |count| Some([after(x, step_x, count)?, after(y, step_y, count)?]);
        let (Some(first), Some(last)) = (point(1), point(count)) else {
            return Err(word.error(ErrorKind::NumberTooLarge));
        };
        self.at = last;
        let hole = Hole { at: first, tool };
        Ok(Features::repeated(hole, steps, count))
    }

    /// What `M02` with these coordinates asks for; `flags` are M70, M80, M90.
    pub(super) fn copies(
        &self,
        copy: &Copies,
        operands: &Operands,
    ) -> Result<Option<Repeat>, Error> {
        if let Some(odd) = operands.of_arc() {
            return Err(odd.error(ErrorKind::UnknownWord(odd.letter)));
        }
        let [swap, mirror_x, mirror_y] = copy.flags;
        let says_more = copy.bare || swap || mirror_x || mirror_y || copy.repeat.is_some();
        if !operands.has_point() && !says_more {
            // Alone it only clears a counter of the machine.
            return Ok(None);
        }
        let count = match copy.repeat {
            Some(repeat) => repeat.whole(MOST_REPEATS)?,
            None => 1,
        };
        if count == 0 {
            return Err(copy.word.error(ErrorKind::PatternOrder));
        }
        Ok(Some(Repeat {
            count,
            step: [
                self.offset(operands.x.as_ref())?,
                self.offset(operands.y.as_ref())?,
            ],
            mirror_x,
            mirror_y,
            swap,
        }))
    }

    pub(super) fn origin(&mut self, operands: &Operands) -> Result<Features, Error> {
        for word in [operands.x, operands.y].iter().flatten() {
            if !word.number.is_zero() {
                return Err(word.error(ErrorKind::Origin));
            }
        }
        Ok(Features::NONE)
    }

    pub(super) fn arc(&self, direction: Direction, operands: &Operands) -> Result<Path, Error> {
        if let Some(radius) = &operands.a {
            let length = self.length(radius)?;
            if length.0 <= 0 {
                return Err(radius.error(ErrorKind::NoDiameter));
            }
            return Ok(Path::Radius(direction, length));
        }
        if operands.i.is_none() && operands.j.is_none() {
            return Err(operands.error(ErrorKind::NoCentre));
        }
        let [x, y] = self.at;
        let centre = |from: Nm, word: Option<&Word>| {
            // Both are within 2^50.
            let at = Nm(from.0.wrapping_add(self.offset(word)?.0));
            at.within_limit()
                .ok_or(operands.error(ErrorKind::NumberTooLarge))
        };
        let centre = [
            centre(x, operands.i.as_ref())?,
            centre(y, operands.j.as_ref())?,
        ];
        Ok(Path::Centre(direction, centre))
    }
}

//! State of a reader, and the meaning of coordinates in it.

use crate::error::{Error, ErrorKind};
use crate::feature::{Feature, Features, Hole, Path, Slot};
use crate::format::{Format, Units};
use crate::length::within_limit;
use crate::operands::Operands;
use crate::pattern::{Repeat, Stage};
use crate::scanner::Word;
use crate::tool::Tool;

/// Largest number of repeats of one `R`.
const MOST_REPEATS: u16 = 9999;

/// Whether the caller gave a setting, so that no line changes it.
#[derive(Copy, Clone, Debug)]
pub(crate) struct Pinned {
    pub units: bool,
    pub zeros: bool,
    pub digits: bool,
}

/// State after the lines so far.
#[derive(Copy, Clone, Debug)]
pub(crate) struct State {
    pub format: Format,
    /// The digits are not given: they follow the unit.
    pub usual_digits: bool,
    pub header: bool,
    pub incremental: bool,
    pub mode: Mode,
    pub tool_down: bool,
    pub at_nm: [i64; 2],
    /// The last feature was a hole.
    pub hole_before: bool,
    pub tool: Option<Tool>,
    pub plated: Option<bool>,
    pub ended: bool,
    pub stage: Stage,
    pub told_after_end: bool,
}

/// An `M02` and its words.
#[derive(Copy, Clone, Debug)]
pub(crate) struct Copies {
    pub word: Word,
    /// The `R` before it.
    pub repeat: Option<Word>,
    /// M70, M80, M90.
    pub flags: [bool; 3],
    /// Whether there is an `X` or `Y` without a number, which counts as zero.
    pub bare: bool,
}

/// The effect of a coordinate.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
pub(crate) enum Mode {
    /// G05, G81: a hole.
    Drill,
    /// G00: a move of the rout.
    Move,
    /// G01: a straight rout.
    Line,
    /// G02, G03: a circular rout.
    Arc { clockwise: bool },
}

impl State {
    pub(crate) fn set_units(&mut self, units: Units, pinned: Pinned) {
        if pinned.units {
            return;
        }
        if self.usual_digits && units != self.format.units {
            self.format.digits = units.digits();
        }
        self.format.units = units;
    }

    pub(crate) fn length(&self, word: &Word) -> Result<i64, Error> {
        word.number
            .length_nm(&self.format)
            .ok_or(word.error(ErrorKind::NumberTooLarge))
    }

    /// Returns the length of a word, or zero without a word.
    pub(crate) fn offset(&self, word: Option<&Word>) -> Result<i64, Error> {
        word.map_or(Ok(0), |word| self.length(word))
    }

    /// Returns the point of the words, relative to `from` if coordinates are incremental.
    pub(crate) fn target(&self, from: [i64; 2], operands: &Operands) -> Result<[i64; 2], Error> {
        let [x, y] = from;
        Ok([
            self.coordinate(x, operands.x.as_ref())?,
            self.coordinate(y, operands.y.as_ref())?,
        ])
    }

    pub(crate) fn coordinate(&self, from: i64, word: Option<&Word>) -> Result<i64, Error> {
        let Some(word) = word else { return Ok(from) };
        let length = self.length(word)?;
        if !self.incremental {
            return Ok(length);
        }
        // Both are within 2^50.
        within_limit(from.wrapping_add(length)).ok_or(word.error(ErrorKind::NumberTooLarge))
    }

    pub(crate) fn tool_for(&self, operands: &Operands) -> Result<Tool, Error> {
        let tool = self.tool.ok_or(operands.error(ErrorKind::NoTool))?;
        Ok(Tool {
            plated: tool.plated.or(self.plated),
            ..tool
        })
    }

    pub(crate) fn slot(
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
        let from = self.target(self.at_nm, start)?;
        let to = self.target(from, end)?;
        let tool = self.tool_for(start)?;
        self.at_nm = to;
        self.hole_before = false;
        let slot = Slot {
            from_nm: from,
            to_nm: to,
            path: Path::Straight,
            tool,
        };
        Ok(Features::one(Feature::Slot(slot)))
    }

    pub(crate) fn repeat(&mut self, step: &Operands, word: &Word) -> Result<Features, Error> {
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
        let steps = [self.offset(step.x.as_ref())?, self.offset(step.y.as_ref())?];
        let [x, y] = self.at_nm;
        let after = |from: i64, step: i64, count: u16| {
            let distance = step.checked_mul(i64::from(count))?;
            within_limit(from.checked_add(distance)?)
        };
        let [step_x, step_y] = steps;
        let point = |count| Some([after(x, step_x, count)?, after(y, step_y, count)?]);
        let (Some(first), Some(last)) = (point(1), point(count)) else {
            return Err(word.error(ErrorKind::NumberTooLarge));
        };
        self.at_nm = last;
        let hole = Hole { at_nm: first, tool };
        Ok(Features::repeated(hole, steps, count))
    }

    /// Returns the copies that `M02` with these coordinates requests. The flags of `copy` are M70,
    /// M80, M90.
    pub(crate) fn copies(
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
            // `M02` alone only clears a counter of the machine.
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
            step_nm: [
                self.offset(operands.x.as_ref())?,
                self.offset(operands.y.as_ref())?,
            ],
            mirror_x,
            mirror_y,
            swap,
        }))
    }

    pub(crate) fn origin(&mut self, operands: &Operands) -> Result<Features, Error> {
        for word in [operands.x, operands.y].iter().flatten() {
            if !word.number.is_zero() {
                return Err(word.error(ErrorKind::Origin));
            }
        }
        Ok(Features::NONE)
    }

    pub(crate) fn arc(&self, clockwise: bool, operands: &Operands) -> Result<Path, Error> {
        if let Some(radius) = &operands.a {
            let radius_nm = self.length(radius)?;
            if radius_nm <= 0 {
                return Err(radius.error(ErrorKind::NoDiameter));
            }
            return Ok(Path::Radius {
                clockwise,
                radius_nm,
            });
        }
        if operands.i.is_none() && operands.j.is_none() {
            return Err(operands.error(ErrorKind::NoCentre));
        }
        let [x, y] = self.at_nm;
        let centre = |from: i64, word: Option<&Word>| {
            // Both are within 2^50.
            let at = from.wrapping_add(self.offset(word)?);
            within_limit(at).ok_or(operands.error(ErrorKind::NumberTooLarge))
        };
        let centre_nm = [
            centre(x, operands.i.as_ref())?,
            centre(y, operands.j.as_ref())?,
        ];
        Ok(Path::Centre {
            clockwise,
            centre_nm,
        })
    }
}

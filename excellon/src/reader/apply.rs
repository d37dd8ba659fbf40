//! Carries out the request of a line: selects the tool, makes the feature.

use crate::error::{Error, ErrorKind, WarningKind};
use crate::feature::{Feature, Features, Hole, Path, Slot};
use crate::operands::Operands;
use crate::pattern::{Pattern, Stage};
use crate::reader::Reader;
use crate::reader::line::Request;
use crate::scanner::Word;
use crate::state::{Mode, State};
use crate::tool::{Source, Tool};

impl<const TOOLS: usize> Reader<TOOLS> {
    /// Returns the tool of a `T` word with or without `C`. Also returns a source if the tool has to
    /// be added to the list.
    pub(super) fn tool(
        &self,
        state: &State,
        word: &Word,
        diameter: Option<&Word>,
    ) -> Result<(Tool, Option<Source>), Error> {
        let number = word.whole(u16::MAX)?;
        let mut tool = Tool {
            number,
            diameter_nm: None,
            plated: state.plated,
        };
        let source = match diameter {
            Some(diameter) => {
                let nm = diameter.number.plain_nm(state.format.units, 0);
                let nm = nm.ok_or(diameter.error(ErrorKind::NumberTooLarge))?;
                if nm <= 0 {
                    return Err(diameter.error(ErrorKind::NoDiameter));
                }
                tool.diameter_nm = Some(nm);
                Source::Definition
            }
            None => match self.tools.get(number) {
                Some(known) => return Ok((*known, None)),
                None if number == 0 => return Ok((tool, None)),
                None => Source::Chosen,
            },
        };
        if !self.tools.takes(number) {
            return Err(word.error(ErrorKind::TooManyTools));
        }
        Ok((tool, Some(source)))
    }

    /// Carries out the request so far: selects the tool, makes the feature.
    pub(super) fn apply(&mut self, state: &mut State, request: &mut Request) -> Result<(), Error> {
        if let (Some((word, diameter)), false) = (&request.tool, request.used) {
            let (tool, source) = self.tool(state, word, diameter.as_ref())?;
            let unloads = tool.number == 0 && source.is_none() && tool.diameter_nm.is_none();
            if unloads {
                state.tool = None;
            } else if diameter.is_none() || !state.header {
                let tool = source.map_or(tool, |source| self.tools.preview(tool, source).0);
                if tool.diameter_nm.is_none() {
                    self.warn(WarningKind::NoDiameter(tool.number), word.at, word.end);
                }
                state.tool = Some(tool);
            }
        }
        let operands = request.operands;
        if let (Some(copies), false) = (&request.copies, request.used) {
            request.used = true;
            if request.pattern.is_some() || request.slot.is_some() || request.repeat.is_some() {
                return Err(copies.word.error(ErrorKind::PatternOrder));
            }
            request.pattern = state.copies(copies, &operands)?.map(Pattern::Repeat);
            return Ok(());
        }
        if request.used
            || (operands.first().is_none() && request.slot.is_none() && request.repeat.is_none())
        {
            return Ok(());
        }
        request.used = true;
        if state.stage == Stage::Copies {
            // It is not defined whether copies contain such a hole. It belongs before M01 or after
            // M08.
            return Err(operands.error(ErrorKind::PatternOrder));
        }
        if state.header {
            state.header = false;
            if let Some(word) = operands.first() {
                self.warn(WarningKind::HeaderNotEnded, word.at, word.end);
            }
        }
        let features = match (request.slot, request.repeat) {
            (Some((start, word)), repeat) => {
                if let Some(repeat) = repeat {
                    return Err(repeat.error(ErrorKind::RepeatOfSlot));
                }
                state.slot(&start, &operands, &word)?
            }
            (None, Some(repeat)) => state.repeat(&operands, &repeat)?,
            (None, None) if request.origin => state.origin(&operands)?,
            (None, None) => self.point(state, &operands)?,
        };
        request.features = Some(features);
        Ok(())
    }

    /// Handles one coordinate: a hole, a move or a piece of a rout.
    fn point(&mut self, state: &mut State, operands: &Operands) -> Result<Features, Error> {
        let is_arc = matches!(state.mode, Mode::Arc { .. });
        if let (Some(word), false) = (operands.of_arc(), is_arc) {
            return Err(word.error(ErrorKind::UnknownWord(word.letter)));
        }
        let from = state.at_nm;
        let to = state.target(from, operands)?;
        let path = match state.mode {
            Mode::Drill => {
                let tool = state.tool_for(operands)?;
                state.at_nm = to;
                state.hole_before = true;
                let hole = Hole { at_nm: to, tool };
                return Ok(Features::one(Feature::Hole(hole)));
            }
            Mode::Move => {
                state.at_nm = to;
                return Ok(Features::NONE);
            }
            Mode::Line => Path::Straight,
            Mode::Arc { clockwise } => state.arc(clockwise, operands)?,
        };
        state.at_nm = to;
        state.hole_before = false;
        if !state.tool_down {
            let at = operands.error(ErrorKind::NoTool);
            self.warn(WarningKind::ToolUp, at.at, at.end);
            return Ok(Features::NONE);
        }
        let tool = state.tool_for(operands)?;
        let slot = Slot {
            from_nm: from,
            to_nm: to,
            path,
            tool,
        };
        Ok(Features::one(Feature::Slot(slot)))
    }
}

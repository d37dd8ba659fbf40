//! Reads the words of a line in order.

use crate::error::{Error, ErrorKind, WarningKind};
use crate::feature::Features;
use crate::format::Units;
use crate::operands::Operands;
use crate::pattern::{Pattern, Stage};
use crate::reader::Reader;
use crate::scanner::{Scanner, Word};
use crate::state::{Copies, Mode, State};

/// The request of a line so far.
#[derive(Default)]
pub(super) struct Request {
    pub(super) operands: Operands,
    /// The words before `G85`, and the `G85` word.
    pub(super) slot: Option<(Operands, Word)>,
    pub(super) repeat: Option<Word>,
    /// `G92` or `G93`: the coordinates are an origin.
    pub(super) origin: bool,
    pub(super) tool: Option<(Word, Option<Word>)>,
    /// The coordinates are used: later ones are an error.
    pub(super) used: bool,
    pub(super) features: Option<Features>,
    /// `M02`.
    pub(super) copies: Option<Copies>,
    pub(super) pattern: Option<Pattern>,
}

impl<const TOOLS: usize> Reader<TOOLS> {
    pub(super) fn words(&mut self, mut scanner: Scanner<'_>) -> Result<Features, Error> {
        let mut state = self.state;
        let mut request = Request::default();
        loop {
            if let Some(copies) = &mut request.copies {
                copies.bare |= take_bare(&mut scanner);
            }
            let Some(word) = scanner.word() else { break };
            let word = word?;
            match word.letter {
                b'X' | b'Y' | b'A' | b'I' | b'J' => {
                    if request.used {
                        return Err(word.error(ErrorKind::RepeatedWord(word.letter)));
                    }
                    request.operands.set(word)?;
                }
                b'R' => {
                    if request.repeat.is_some() || request.used {
                        return Err(word.error(ErrorKind::RepeatedWord(b'R')));
                    }
                    request.repeat = Some(word);
                }
                b'T' => {
                    self.apply(&mut state, &mut request)?;
                    if request.tool.is_some() {
                        return Err(word.error(ErrorKind::RepeatedWord(b'T')));
                    }
                    request.tool = Some((word, None));
                }
                b'C' => match &mut request.tool {
                    Some((_, diameter @ None)) => *diameter = Some(word),
                    Some(_) => return Err(word.error(ErrorKind::RepeatedWord(b'C'))),
                    None => return Err(word.error(ErrorKind::UnknownWord(b'C'))),
                },
                // Feeds, speeds and line numbers. `B`, `H` and `Z` are further values of a tool.
                b'F' | b'S' | b'N' => {}
                b'B' | b'H' | b'Z' => {
                    if request.tool.is_none() {
                        self.warn(WarningKind::Ignored, word.at, word.end);
                    }
                }
                b'D' => return Err(word.error(ErrorKind::Gerber)),
                b'G' => {
                    if self.preparatory(&mut state, &mut request, &word)? {
                        break;
                    }
                }
                b'M' if self.takes_patterns
                    && self.step_and_repeat(&mut state, &mut request, &word)? => {}
                b'M' => {
                    self.apply(&mut state, &mut request)?;
                    if self.miscellaneous(&mut state, &word)? {
                        break;
                    }
                }
                letter => return Err(word.error(ErrorKind::UnknownWord(letter))),
            }
        }
        self.apply(&mut state, &mut request)?;
        // No error can occur from here on.
        if let Some((word, diameter)) = request.tool {
            let (tool, source) = self.tool(&state, &word, diameter.as_ref())?;
            if let Some(source) = source {
                let (_, replaced) = self.tools.preview(tool, source);
                if replaced {
                    self.warn(WarningKind::Redefined(tool.number), word.at, word.end);
                }
                self.tools.define(tool, source);
            }
        }
        self.state = state;
        self.pattern = request.pattern;
        Ok(request.features.unwrap_or(Features::NONE))
    }

    /// Handles a G code. Returns `true` if the rest of the line is text.
    fn preparatory(
        &mut self,
        state: &mut State,
        request: &mut Request,
        word: &Word,
    ) -> Result<bool, Error> {
        let code = word.whole(u16::MAX)?;
        if code == 85 {
            if request.slot.is_some() || request.used || request.repeat.is_some() {
                return Err(word.error(ErrorKind::RepeatedWord(b'G')));
            }
            let start = core::mem::take(&mut request.operands);
            request.slot = Some((start, *word));
            return Ok(false);
        }
        self.apply(state, request)?;
        match code {
            0 => state.mode = Mode::Move,
            1 => state.mode = Mode::Line,
            2 => state.mode = Mode::Arc { clockwise: true },
            3 => state.mode = Mode::Arc { clockwise: false },
            5 | 81 => {
                state.mode = Mode::Drill;
                state.tool_down = false;
            }
            90 => state.incremental = false,
            91 => state.incremental = true,
            92 | 93 => request.origin = true,
            40 => {}
            4 => {
                self.warn(WarningKind::Ignored, word.at, word.end);
                return Ok(true);
            }
            _ => return Err(word.error(ErrorKind::UnknownCode(b'G', code))),
        }
        Ok(false)
    }

    /// Handles an M code of step and repeat. Returns `false` for other codes.
    fn step_and_repeat(
        &mut self,
        state: &mut State,
        request: &mut Request,
        word: &Word,
    ) -> Result<bool, Error> {
        let code = word.whole(u16::MAX)?;
        if let Some(copies) = &mut request.copies {
            let [swap, mirror_x, mirror_y] = &mut copies.flags;
            let flag = match code {
                70 => Some(swap),
                80 => Some(mirror_x),
                90 => Some(mirror_y),
                _ => None,
            };
            if let Some(flag) = flag {
                if core::mem::replace(flag, true) {
                    return Err(word.error(ErrorKind::RepeatedWord(b'M')));
                }
                return Ok(true);
            }
        }
        let (from, to, pattern) = match code {
            25 => (Stage::Outside, Stage::Set, Some(Pattern::Begin)),
            1 if state.stage == Stage::Outside => (Stage::Set, Stage::Set, None),
            1 => (state.stage, Stage::Copies, Some(Pattern::EndOfSet)),
            2 => (Stage::Copies, Stage::Copies, None),
            8 => (Stage::Copies, Stage::Outside, Some(Pattern::End)),
            _ => return Ok(false),
        };
        let order = word.error(ErrorKind::PatternOrder);
        if code == 2 {
            let alone = request.operands.first().is_none() && request.copies.is_none();
            if state.stage != from || request.used || !alone {
                return Err(order);
            }
            request.copies = Some(Copies {
                word: *word,
                repeat: request.repeat.take(),
                flags: [false; 3],
                bare: false,
            });
            return Ok(true);
        }
        self.apply(state, request)?;
        if state.stage != from || request.pattern.is_some() {
            return Err(order);
        }
        state.stage = to;
        request.pattern = pattern;
        state.hole_before = false;
        if code == 1 && state.incremental {
            // The manual clears the accumulators at the end of a pattern.
            state.at_nm = [0; 2];
        }
        Ok(true)
    }

    /// Handles an M code. Returns `true` if the rest of the line is text.
    fn miscellaneous(&mut self, state: &mut State, word: &Word) -> Result<bool, Error> {
        let code = word.whole(u16::MAX)?;
        match code {
            0 | 30 => {
                state.ended = true;
                return Ok(true);
            }
            14 | 15 => state.tool_down = true,
            16 | 17 => state.tool_down = false,
            48 => state.header = true,
            95 => state.header = false,
            71 => state.set_units(Units::Millimetres, self.pinned),
            72 => state.set_units(Units::Inches, self.pinned),
            6 | 9 => self.warn(WarningKind::Ignored, word.at, word.end),
            47 | 97 | 98 | 99 => {
                self.warn(WarningKind::Ignored, word.at, word.end);
                return Ok(true);
            }
            1 | 2 | 8 | 25 | 26 | 70 | 80 | 90 => {
                return Err(word.error(ErrorKind::StepAndRepeat));
            }
            _ => return Err(word.error(ErrorKind::UnknownCode(b'M', code))),
        }
        Ok(false)
    }
}

/// Skips `X` and `Y` without a number, as in `M02XY007`. Returns whether there was one.
fn take_bare(scanner: &mut Scanner<'_>) -> bool {
    let mut any = false;
    loop {
        let mut ahead = *scanner;
        let axis = matches!(ahead.next(), Some(b'X' | b'Y'));
        if !axis || matches!(ahead.peek(), Some(b'0'..=b'9' | b'+' | b'-' | b'.')) {
            return any;
        }
        *scanner = ahead;
        any = true;
    }
}

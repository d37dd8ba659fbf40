//! The second pass: lines in, holes and slots out.

use crate::error::{Error, ErrorKind, Warning, WarningKind};
use crate::feature::{Feature, Features, Hole, Path, Slot};
use crate::format::{Digits, Format, Units, Zeros};
use crate::hint::Hint;
use crate::inference::{Reason, Settings};
use crate::operands::Operands;
use crate::pattern::{Pattern, Stage};
use crate::scanner::{Scanner, Word};
use crate::state::{Copies, Mode, Pinned, State};
use crate::statement::Statement;
use crate::tool::{Source, Tool, Tools};

/// Reads a drill file line by line, with room for `TOOLS` tools. A line with an error changes
/// nothing.
///
/// Memory is that of the tools, 40 bytes each, and about 150 bytes; a line costs a few instructions
/// a byte.
#[derive(Clone, Debug)]
pub struct Reader<const TOOLS: usize> {
    state: State,
    tools: Tools<TOOLS>,
    pinned: Pinned,
    warning: Option<Warning>,
    takes_patterns: bool,
    pattern: Option<Pattern>,
}

/// What a line asks for so far.
#[derive(Default)]
struct Request {
    operands: Operands,
    /// The words before `G85`, and that word.
    slot: Option<(Operands, Word)>,
    repeat: Option<Word>,
    /// `G92` or `G93`: the coordinates are an origin.
    origin: bool,
    tool: Option<(Word, Option<Word>)>,
    /// The coordinates have been used: what comes later is of no use.
    used: bool,
    features: Option<Features>,
    /// `M02`.
    copies: Option<Copies>,
    pattern: Option<Pattern>,
}

impl<const TOOLS: usize> Reader<TOOLS> {
    /// A reader before the first line.
    pub const fn new(settings: &Settings) -> Reader<TOOLS> {
        let (units, zeros, digits) = (
            settings.units.reason,
            settings.zeros.reason,
            settings.digits.reason,
        );
        Reader {
            state: State {
                format: settings.format(),
                usual_digits: matches!(digits, Reason::Default | Reason::Profile),
                header: false,
                incremental: settings.incremental,
                mode: Mode::Drill,
                tool_down: false,
                at_nm: [0; 2],
                hole_before: false,
                tool: None,
                plated: None,
                ended: false,
                stage: Stage::Outside,
                told_after_end: false,
            },
            tools: Tools::EMPTY,
            pinned: Pinned {
                units: matches!(units, Reason::Given),
                zeros: matches!(zeros, Reason::Given),
                digits: matches!(digits, Reason::Given),
            },
            warning: None,
            takes_patterns: false,
            pattern: None,
        }
    }

    /// The same reader, which takes step and repeat: its caller keeps the features and makes the
    /// copies that [`Reader::pattern`] asks for.
    pub const fn with_patterns(mut self) -> Reader<TOOLS> {
        self.takes_patterns = true;
        self
    }

    /// What the line read last says about step and repeat; always `None` without
    /// [`Reader::with_patterns`].
    pub const fn pattern(&self) -> Option<Pattern> {
        self.pattern
    }

    /// Sets the diameter of a tool, whatever the file says; to be called before the first line.
    /// `false` when there is no room, or the diameter is not above zero.
    pub fn set_tool(&mut self, number: u16, diameter_nm: i64) -> bool {
        let tool = Tool {
            number,
            diameter_nm: Some(diameter_nm),
            plated: None,
        };
        diameter_nm > 0 && self.tools.define(tool, Source::Caller)
    }

    /// The tools so far.
    pub const fn tools(&self) -> &Tools<TOOLS> {
        &self.tools
    }

    /// What is worth saying about the line read last.
    pub const fn warning(&self) -> Option<Warning> {
        self.warning
    }

    /// Whether the end of the program (M00, M30) has been read.
    pub const fn is_ended(&self) -> bool {
        self.state.ended
    }

    /// How coordinates are read now.
    pub const fn format(&self) -> Format {
        self.state.format
    }

    /// Reads the next line (without its end) and returns what it makes.
    ///
    /// # Errors
    ///
    /// The first thing that is wrong with the line; the reader is then as it was before.
    pub fn read(&mut self, line: &[u8]) -> Result<Features, Error> {
        self.warning = None;
        self.pattern = None;
        if self.state.ended {
            self.behind_the_end(line);
            return Ok(Features::NONE);
        }
        match Statement::parse(line)? {
            Statement::Nothing => {}
            Statement::Comment(text) => self.comment(text),
            Statement::Percent => self.state.header = false,
            Statement::Units {
                units,
                zeros,
                digits,
                odd,
            } => {
                self.declare(units, zeros, digits);
                if let Some(at) = odd {
                    self.warn(WarningKind::UnknownName, at, line.len());
                }
            }
            Statement::Incremental(incremental) => self.state.incremental = incremental,
            Statement::Name(WarningKind::UnknownName) => {
                let (at, end) = (0, line.len());
                if !self.state.header {
                    let kind = ErrorKind::UnknownName;
                    return Err(Error { kind, at, end });
                }
                self.warn(WarningKind::UnknownName, at, end);
            }
            Statement::Name(_) => {}
            Statement::Words(scanner) => return self.words(scanner),
        }
        Ok(Features::NONE)
    }

    fn warn(&mut self, kind: WarningKind, at: usize, end: usize) {
        self.warning = self.warning.or(Some(Warning { kind, at, end }));
    }

    fn behind_the_end(&mut self, line: &[u8]) {
        let says_something = !matches!(
            Statement::parse(line),
            Ok(Statement::Nothing | Statement::Comment(_) | Statement::Percent)
        );
        if says_something && !self.state.told_after_end {
            self.state.told_after_end = true;
            self.warn(WarningKind::AfterEnd, 0, line.len());
        }
    }

    fn declare(&mut self, units: Units, zeros: Option<Zeros>, digits: Option<Digits>) {
        let state = &mut self.state;
        state.set_units(units, self.pinned);
        if let (Some(zeros), false) = (zeros, self.pinned.zeros) {
            state.format.zeros = zeros;
        }
        if let (Some(digits), false) = (digits, self.pinned.digits) {
            state.format.digits = digits;
            state.usual_digits = false;
        }
    }

    /// The settings hold what comments say about formats; plating and sizes take effect where they
    /// stand.
    fn comment(&mut self, text: Scanner<'_>) {
        match Hint::parse(text) {
            Some(Hint::Plated(plated)) => self.state.plated = plated,
            Some(Hint::Size {
                tool,
                diameter_nm,
                plated,
                ..
            }) => {
                let tool = Tool {
                    number: tool,
                    diameter_nm: Some(diameter_nm),
                    plated: plated.or(self.state.plated),
                };
                // A tool too many is an error where it is chosen.
                self.tools.define(tool, Source::Comment);
            }
            Some(Hint::Format { .. }) | None => {}
        }
    }

    fn words(&mut self, mut scanner: Scanner<'_>) -> Result<Features, Error> {
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
                // Feeds, speeds, numbers of lines, and what a tool has besides its diameter.
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
        // Nothing fails from here on.
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

    /// A G code; `true` when the rest of the line is text.
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

    /// An M code of step and repeat; `false` when it is none.
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
            // The manual: the accumulators are cleared at the end of a pattern.
            state.at_nm = [0; 2];
        }
        Ok(true)
    }

    /// An M code; `true` when the rest of the line is text.
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

    /// The tool that a `T` word with or without `C` means; with a source when the list of tools is
    /// to know it.
    fn tool(
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

    /// Uses what the line has asked for so far: chooses the tool, makes the feature.
    fn apply(&mut self, state: &mut State, request: &mut Request) -> Result<(), Error> {
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
            // What would be copied is not said: such a hole belongs before M01 or behind M08.
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

    /// One coordinate: a hole, a move or a piece of a rout.
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

/// Steps over `X` and `Y` without a number: `M02XY007`. Whether there was one.
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

//! Second pass: lines in, holes and slots out.

mod apply;
mod line;

use crate::error::{Error, ErrorKind, Warning, WarningKind};
use crate::feature::Features;
use crate::format::{Digits, Format, Units, Zeros};
use crate::hint::Hint;
use crate::inference::{Reason, Settings};
use crate::pattern::{Pattern, Stage};
use crate::scanner::Scanner;
use crate::state::{Mode, Pinned, State};
use crate::statement::Statement;
use crate::tool::{Source, Tool, Tools};

/// Reads a drill file line by line, with room for `TOOLS` tools. A line with an error leaves the
/// reader unchanged.
///
/// # Cost
/// Memory: 40 bytes per tool plus about 150 bytes. Time: a few instructions per byte.
#[derive(Clone, Debug)]
pub struct Reader<const TOOLS: usize> {
    state: State,
    tools: Tools<TOOLS>,
    pinned: Pinned,
    warning: Option<Warning>,
    takes_patterns: bool,
    pattern: Option<Pattern>,
}

impl<const TOOLS: usize> Reader<TOOLS> {
    /// Creates a reader before the first line.
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

    /// Enables step and repeat. The caller stores the features and makes the copies that
    /// [`Reader::pattern`] requests.
    pub const fn with_patterns(mut self) -> Reader<TOOLS> {
        self.takes_patterns = true;
        self
    }

    /// Returns the step-and-repeat command of the last line. Always `None` without
    /// [`Reader::with_patterns`].
    pub const fn pattern(&self) -> Option<Pattern> {
        self.pattern
    }

    /// Sets the diameter of a tool. It takes precedence over the file. Call it before the first
    /// line. Returns `false` if there is no room, or if the diameter is not above zero.
    pub fn set_tool(&mut self, number: u16, diameter_nm: i64) -> bool {
        let tool = Tool {
            number,
            diameter_nm: Some(diameter_nm),
            plated: None,
        };
        diameter_nm > 0 && self.tools.define(tool, Source::Caller)
    }

    /// Returns the tools so far.
    pub const fn tools(&self) -> &Tools<TOOLS> {
        &self.tools
    }

    /// Returns the warning of the last line.
    pub const fn warning(&self) -> Option<Warning> {
        self.warning
    }

    /// Whether the end of the program (M00, M30) has been read.
    pub const fn is_ended(&self) -> bool {
        self.state.ended
    }

    /// Returns the current format of coordinates.
    pub const fn format(&self) -> Format {
        self.state.format
    }

    /// Reads the next line, without its line end, and returns its features.
    ///
    /// # Errors
    /// Fails with the first error in the line. The reader is then unchanged.
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

    /// Applies plating and sizes from a comment where it stands. Formats from comments are already
    /// in the settings.
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
                // A tool beyond the room is an error where it is selected.
                self.tools.define(tool, Source::Comment);
            }
            Some(Hint::Format { .. }) | None => {}
        }
    }
}

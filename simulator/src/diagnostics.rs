//! Findings about programs and machine files, and collections of them. `drawing` prints them.

mod alike;
mod drawing;
pub mod page;

use crate::text::shown::shown;
use alike::Alike;
use std::collections::HashSet;
use std::io::{self, Write};
use std::ops::Range;

pub use drawing::Format;

/// How bad a finding is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Severity {
    /// The program cannot run.
    Error,
    /// The program runs, but perhaps not as intended.
    Warning,
}

impl Severity {
    /// Its word.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Error => "error",
            Self::Warning => "warning",
        }
    }
}

/// A part of one line of a file.
#[derive(Clone, Debug)]
pub struct Place {
    file: String,
    line: usize,
    text: String,
    span: Range<usize>,
}

impl Place {
    /// The bytes `span` of line number `line` (from 1) of `file`. The line may contain any bytes.
    pub fn new(file: &str, line: usize, bytes: &[u8], span: Range<usize>) -> Self {
        let end = span.end.min(bytes.len());
        let start = span.start.min(end);
        let lossy = |part: &[u8]| String::from_utf8_lossy(part).into_owned();
        let (before, inside) = (lossy(&bytes[..start]), lossy(&bytes[start..end]));
        let span = before.len()..before.len() + inside.len();
        let after = lossy(&bytes[end..]);
        let text = before + &inside + &after;
        Self {
            file: file.to_owned(),
            line,
            text,
            span,
        }
    }

    /// A span of a whole text, for files that are held in memory.
    pub fn in_text(file: &str, text: &str, span: Range<usize>) -> Self {
        let start = span.start.min(text.len());
        let line_start = text[..start].rfind('\n').map_or(0, |at| at + 1);
        let line_end = text[start..].find('\n').map_or(text.len(), |at| start + at);
        let line = text[..start].matches('\n').count() + 1;
        let end = span.end.clamp(start, line_end.max(start));
        let bytes = &text.as_bytes()[line_start..line_end];
        Self::new(file, line, bytes, start - line_start..end - line_start)
    }

    /// The span in bytes of the line as it is shown. [`Fix`] uses the same count.
    pub fn span(&self) -> Range<usize> {
        self.span.clone()
    }

    /// Column of the first character, counted in characters from 1.
    fn column(&self) -> usize {
        self.text[..self.span.start].chars().count() + 1
    }

    /// Column after the last character, counted in characters from 1.
    fn end_column(&self) -> usize {
        self.text[..self.span.end].chars().count() + 1
    }
}

/// A change that removes the finding.
#[derive(Clone, Debug)]
pub struct Fix {
    /// Bytes to remove, counted in the line as it is shown: see [`Place::span`].
    pub span: Range<usize>,
    /// Text that replaces them.
    pub text: String,
}

/// One error or warning.
#[derive(Clone, Debug)]
pub struct Finding {
    /// The code, as in `E0301` or `W0601`.
    pub code: String,
    /// Error or warning.
    pub severity: Severity,
    /// The fault, in lower case and without a full stop.
    pub message: String,
    /// Its place; `None` for findings about the whole program.
    pub place: Option<Place>,
    /// The text under the place.
    pub label: String,
    /// Another place that explains the first, with its label.
    pub elsewhere: Option<(Place, String)>,
    /// Explanations.
    pub notes: Vec<String>,
    /// Advice.
    pub help: Option<String>,
    /// The change that `help` describes, on the line of `place`.
    pub fix: Option<Fix>,
}

impl Finding {
    /// An error at a place.
    pub fn error(code: &str, message: impl Into<String>, place: Place) -> Self {
        Self {
            place: Some(place),
            ..Self::general(Severity::Error, code, message)
        }
    }

    /// A warning at a place.
    pub fn warning(code: &str, message: impl Into<String>, place: Place) -> Self {
        Self {
            place: Some(place),
            ..Self::general(Severity::Warning, code, message)
        }
    }

    /// A finding about the whole program.
    pub fn general(severity: Severity, code: &str, message: impl Into<String>) -> Self {
        Self {
            code: code.to_owned(),
            severity,
            message: message.into(),
            place: None,
            label: String::new(),
            elsewhere: None,
            notes: Vec::new(),
            help: None,
            fix: None,
        }
    }

    /// Its line and first column, both from 1; zeros for a finding about the whole program.
    pub fn line_and_column(&self) -> (usize, usize) {
        let place = self.place.as_ref();
        place.map_or((0, 0), |place| (place.line, place.column()))
    }

    /// Sets the text under the place.
    pub fn label(mut self, label: impl Into<String>) -> Self {
        self.label = label.into();
        self
    }

    /// Adds an explanation.
    pub fn note(mut self, note: impl Into<String>) -> Self {
        self.notes.push(note.into());
        self
    }

    /// Sets the advice.
    pub fn help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }

    /// Sets the change that the advice describes.
    pub fn fix(mut self, span: Range<usize>, text: impl Into<String>) -> Self {
        self.fix = Some(Fix {
            span,
            text: text.into(),
        });
        self
    }
}

/// Findings in their order. All are counted, and the first ones are kept up to a limit.
#[derive(Debug)]
pub struct Findings {
    kept: Vec<Finding>,
    most: u64,
    /// Line, first byte and code of each reported finding. `None` while lines do not repeat.
    reported: Option<HashSet<(usize, usize, String)>>,
    /// The first error decides: others need not be found.
    ends_at_error: bool,
    /// Nothing after the present place counts.
    is_over: bool,
    /// Number of errors, kept or not.
    pub errors: u64,
    /// Number of warnings, kept or not.
    pub warnings: u64,
}

impl Findings {
    /// No findings; keeps at most `most`.
    pub const fn new(most: u64) -> Self {
        Self {
            kept: Vec::new(),
            most,
            reported: None,
            ends_at_error: false,
            is_over: false,
            errors: 0,
            warnings: 0,
        }
    }

    /// No findings, with the same limit: the program is checked once more.
    pub fn restarted(&self) -> Self {
        Self {
            ends_at_error: self.ends_at_error,
            ..Self::new(self.most)
        }
    }

    /// The search for findings ends at the first error.
    pub const fn up_to_error(mut self) -> Self {
        self.ends_at_error = true;
        self
    }

    /// Ends the search for findings.
    pub const fn end(&mut self) {
        self.is_over = true;
    }

    /// Whether no other finding is needed.
    pub const fn is_decided(&self) -> bool {
        self.is_over || self.ends_at_error && self.errors > 0
    }

    /// Whether there is none so far.
    pub const fn is_empty(&self) -> bool {
        self.errors == 0 && self.warnings == 0
    }

    /// From now on ignores a finding that repeats an earlier code and place. It is for programs
    /// with loops.
    pub fn report_once(&mut self) {
        self.reported.get_or_insert_default();
    }

    /// Counts a finding, and keeps it if the limit allows.
    pub fn add(&mut self, finding: Finding) {
        if let (Some(reported), Some(place)) = (&mut self.reported, &finding.place) {
            let key = (place.line, place.span.start, finding.code.clone());
            if !reported.insert(key) {
                return;
            }
        }
        match finding.severity {
            Severity::Error => self.errors += 1,
            Severity::Warning => self.warnings += 1,
        }
        if self.errors + self.warnings <= self.most {
            self.kept.push(finding);
        }
    }

    /// Number of findings that were counted but not kept.
    pub const fn hidden(&self) -> u64 {
        (self.errors + self.warnings).saturating_sub(self.most)
    }

    /// The kept findings.
    pub fn kept(&self) -> &[Finding] {
        &self.kept
    }

    /// Each kept finding as one line of text, without control characters.
    pub fn short(&self) -> Vec<String> {
        let short = |finding: &Finding| shown(&finding.short());
        self.kept.iter().map(short).collect()
    }

    /// Whether an error is about an axis, a code or means that another machine may have.
    pub fn concern_the_machine(&self) -> bool {
        let codes = ["E0201", "E0202", "E0212", "E0404"];
        let mut kept = self.kept.iter();
        kept.any(|finding| codes.contains(&finding.code.as_str()))
    }

    /// Prints the kept findings. As text, of those that are alike the first ones are drawn, and a
    /// line has the number of the others.
    ///
    /// # Errors
    ///
    /// The writer fails.
    pub fn print(&self, format: Format, colour: bool, out: &mut impl Write) -> io::Result<()> {
        let mut alike = Alike::default();
        for finding in &self.kept {
            if format != Format::Text || alike.is_drawn(finding) {
                finding.print(format, colour, out)?;
            }
        }
        alike.print(out)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_span_of_a_text_has_its_line_and_column() {
        let place = Place::in_text("m.toml", "a = 1\nbaklash = 2\n", 6..13);
        assert_eq!(
            (place.line, place.column(), place.text.as_str()),
            (2, 1, "baklash = 2")
        );
    }

    #[test]
    fn all_findings_are_counted_and_some_are_kept() {
        let mut findings = Findings::new(2);
        let at = |line| Place::new("p.nc", line, b"G0", 0..2);
        findings.add(Finding::warning("W0001", "one", at(1)));
        findings.report_once();
        findings.add(Finding::error("E0001", "two", at(2)));
        findings.add(Finding::error("E0001", "two", at(2)));
        findings.add(Finding::error("E0001", "two", at(3)));
        assert_eq!((findings.errors, findings.warnings), (2, 1));
        assert_eq!(findings.hidden(), 1);
        let short = [
            "p.nc:1:1: warning[W0001]: one",
            "p.nc:2:1: error[E0001]: two",
        ];
        assert_eq!(findings.short(), short);
        let mut printed = Vec::new();
        findings.print(Format::Short, false, &mut printed).unwrap();
        assert_eq!(printed, (short.join("\n") + "\n").into_bytes());
    }
}

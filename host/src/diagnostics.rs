//! Findings about programs and machine files, printed as drawn text, one line each, or JSON.

use crate::console::{is_obeyed, shown};
use annotate_snippets::{AnnotationKind, Group, Level, Patch, Renderer, Snippet};
use serde::Serialize;
use std::collections::HashSet;
use std::io::{self, Write};
use std::ops::Range;

/// How findings are printed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Format {
    /// Drawn under the line of the program.
    Text,
    /// `file:line:column: error[E0301]: message`, for editors and screen readers.
    Short,
    /// One JSON object a line.
    Json,
}

/// How bad a finding is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Severity {
    /// The program cannot run.
    Error,
    /// The program runs, and perhaps not as meant.
    Warning,
}

impl Severity {
    const fn name(self) -> &'static str {
        match self {
            Self::Error => "error",
            Self::Warning => "warning",
        }
    }
}

/// A piece of one line of a file.
#[derive(Clone, Debug)]
pub struct Place {
    file: String,
    line: usize,
    text: String,
    span: Range<usize>,
}

impl Place {
    /// The bytes `span` of line number `line` (from 1) of `file`; the line may be any bytes.
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

    /// The same place without what a terminal obeys. What the renderer does not replace itself
    /// becomes something as long.
    fn shown(&self) -> Self {
        let visible = |one: char| match one.len_utf8() {
            2 if is_obeyed(one) => '\u{bf}',
            3 if is_obeyed(one) => char::REPLACEMENT_CHARACTER,
            _ => one,
        };
        Self {
            file: shown(&self.file),
            line: self.line,
            text: self.text.chars().map(visible).collect(),
            span: self.span.clone(),
        }
    }

    /// The piece as bytes of the line as it is drawn: what [`Fix`] counts in.
    pub fn span(&self) -> Range<usize> {
        self.span.clone()
    }

    /// Column of the first character, from 1, in characters.
    fn column(&self) -> usize {
        self.text[..self.span.start].chars().count() + 1
    }

    /// Column behind the last character, from 1, in characters.
    fn end_column(&self) -> usize {
        self.text[..self.span.end].chars().count() + 1
    }
}

/// A change that makes the finding go away.
#[derive(Clone, Debug)]
pub struct Fix {
    /// Bytes of the line that go, as it is drawn: see [`Place::span`].
    pub span: Range<usize>,
    /// Text that comes in their place.
    pub text: String,
}

/// One error or warning.
#[derive(Clone, Debug)]
pub struct Finding {
    /// `E0301`, `W0601`.
    pub code: String,
    /// Error or warning.
    pub severity: Severity,
    /// What is wrong, lower case, no full stop.
    pub message: String,
    /// Where; `None` for findings about the whole program.
    pub place: Option<Place>,
    /// What is written under the place.
    pub label: String,
    /// Another place that explains the first, with its label.
    pub elsewhere: Option<(Place, String)>,
    /// Explanations.
    pub notes: Vec<String>,
    /// What to do.
    pub help: Option<String>,
    /// The change `help` speaks of, on the line of `place`.
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

    /// Sets the change the advice speaks of.
    pub fn fix(mut self, span: Range<usize>, text: impl Into<String>) -> Self {
        self.fix = Some(Fix {
            span,
            text: text.into(),
        });
        self
    }

    /// Prints the finding with its newline.
    ///
    /// # Errors
    ///
    /// What the writer says.
    pub fn print(&self, format: Format, colour: bool, out: &mut impl Write) -> io::Result<()> {
        match format {
            Format::Text => writeln!(out, "{}\n", self.drawn(colour)),
            Format::Short => writeln!(out, "{}", shown(&self.short())),
            Format::Json => writeln!(out, "{}", shown(&self.json())),
        }
    }

    pub fn drawn(&self, colour: bool) -> String {
        let shown = self.shown();
        shown.drawn_as_it_is(colour)
    }

    /// The same finding without what a terminal obeys; columns stay what they are.
    fn shown(&self) -> Self {
        Self {
            code: self.code.clone(),
            severity: self.severity,
            message: shown(&self.message),
            place: self.place.as_ref().map(Place::shown),
            label: shown(&self.label),
            elsewhere: self
                .elsewhere
                .as_ref()
                .map(|(place, label)| (place.shown(), shown(label))),
            notes: self.notes.iter().map(|note| shown(note)).collect(),
            help: self.help.as_deref().map(shown),
            fix: self.fix.clone(),
        }
    }

    fn drawn_as_it_is(&self, colour: bool) -> String {
        let level = match self.severity {
            Severity::Error => Level::ERROR,
            Severity::Warning => Level::WARNING,
        };
        let title = level.primary_title(&self.message).id(&self.code);
        let mut group = Group::with_title(title);
        if let Some(place) = &self.place {
            group = group.element(drawn_at(place, &self.label));
        }
        if let Some((place, label)) = &self.elsewhere {
            group = group.element(drawn_at(place, label));
        }
        for note in &self.notes {
            group = group.element(Level::NOTE.message(note));
        }
        let mut report = Vec::new();
        match (&self.help, &self.fix, &self.place) {
            (Some(help), Some(fix), Some(place)) => {
                let patch = Patch::new(fix.span.clone(), &fix.text);
                let snippet = Snippet::source(&place.text)
                    .line_start(place.line)
                    .patch(patch);
                report.push(group);
                report.push(Level::HELP.secondary_title(help).element(snippet));
            }
            (Some(help), _, _) => report.push(group.element(Level::HELP.message(help))),
            _ => report.push(group),
        }
        let renderer = if colour {
            Renderer::styled()
        } else {
            Renderer::plain()
        };
        renderer.render(&report)
    }

    fn short(&self) -> String {
        let (severity, code, message) = (self.severity.name(), &self.code, &self.message);
        match &self.place {
            Some(place) => {
                let (file, line, column) = (&place.file, place.line, place.column());
                format!("{file}:{line}:{column}: {severity}[{code}]: {message}")
            }
            None => format!("{severity}[{code}]: {message}"),
        }
    }

    fn json(&self) -> String {
        let place = self.place.as_ref();
        let fixes = match (&self.fix, place) {
            (Some(fix), Some(place)) => vec![JsonFix {
                line: place.line,
                column: columns_before(&place.text, fix.span.start) + 1,
                end: columns_before(&place.text, fix.span.end) + 1,
                text: &fix.text,
            }],
            _ => Vec::new(),
        };
        let json = JsonFinding {
            code: &self.code,
            severity: self.severity.name(),
            file: place.map(|place| place.file.as_str()),
            line: place.map(|place| place.line),
            column: place.map(Place::column),
            end: place.map(Place::end_column),
            message: &self.message,
            label: (!self.label.is_empty()).then_some(self.label.as_str()),
            notes: &self.notes,
            help: self.help.as_deref(),
            fixes,
        };
        serde_json::to_string(&json).unwrap_or_default()
    }
}

fn columns_before(text: &str, at: usize) -> usize {
    text.char_indices()
        .take_while(|(index, _)| *index < at)
        .count()
}

fn drawn_at<'a>(
    place: &'a Place,
    label: &'a str,
) -> Snippet<'a, annotate_snippets::Annotation<'a>> {
    let mark = AnnotationKind::Primary.span(place.span.clone());
    let mark = if label.is_empty() {
        mark
    } else {
        mark.label(label)
    };
    Snippet::source(&place.text)
        .line_start(place.line)
        .path(&place.file)
        .annotation(mark)
}

/// What `--format json` prints for one finding.
#[derive(Serialize)]
struct JsonFinding<'a> {
    code: &'a str,
    severity: &'a str,
    file: Option<&'a str>,
    line: Option<usize>,
    column: Option<usize>,
    end: Option<usize>,
    message: &'a str,
    label: Option<&'a str>,
    notes: &'a [String],
    help: Option<&'a str>,
    fixes: Vec<JsonFix<'a>>,
}

#[derive(Serialize)]
struct JsonFix<'a> {
    line: usize,
    column: usize,
    end: usize,
    text: &'a str,
}

/// Where findings go: prints each at once, up to a limit, and counts all.
#[derive(Debug)]
pub struct Findings<W> {
    out: W,
    format: Format,
    colour: bool,
    limit: u64,
    /// Line, first byte and code of what was told, once a program comes to lines again.
    told: Option<HashSet<(usize, usize, String)>>,
    /// Number of errors, printed or not.
    pub errors: u64,
    /// Number of warnings, printed or not.
    pub warnings: u64,
}

impl<W: Write> Findings<W> {
    /// Prints at most `limit` findings to `out`.
    pub fn new(out: W, format: Format, colour: bool, limit: u64) -> Self {
        Self {
            out,
            format,
            colour,
            limit,
            told: None,
            errors: 0,
            warnings: 0,
        }
    }

    /// From now on tells the same about the same place once only: the program has loops.
    pub fn tell_once(&mut self) {
        self.told.get_or_insert_default();
    }

    /// Counts the finding and prints it while the limit allows.
    ///
    /// # Errors
    ///
    /// What the writer says.
    pub fn add(&mut self, finding: &Finding) -> io::Result<()> {
        if let (Some(told), Some(place)) = (&mut self.told, &finding.place) {
            let key = (place.line, place.span.start, finding.code.clone());
            if !told.insert(key) {
                return Ok(());
            }
        }
        match finding.severity {
            Severity::Error => self.errors += 1,
            Severity::Warning => self.warnings += 1,
        }
        if self.errors + self.warnings <= self.limit {
            finding.print(self.format, self.colour, &mut self.out)?;
        }
        Ok(())
    }

    /// Number of findings that were counted and not printed.
    pub fn hidden(&self) -> u64 {
        (self.errors + self.warnings).saturating_sub(self.limit)
    }

    /// The writer, for a summary after the findings.
    pub fn writer(&mut self) -> &mut W {
        &mut self.out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_finding_in_three_forms() {
        let place = Place::new("part.nc", 2, b"N050 G01 X2.0 U0.4 F12", 14..18);
        let finding = Finding::error("E0201", "unknown word `U`", place)
            .label("no axis or parameter named `U`")
            .help("remove the word")
            .fix(14..19, "");
        assert_eq!(
            finding.short(),
            "part.nc:2:15: error[E0201]: unknown word `U`"
        );
        assert!(finding.json().contains("\"column\":15,\"end\":19"));
        let drawn = finding.drawn(false);
        assert!(drawn.contains("--> part.nc:2:15"), "{drawn}");
        assert!(drawn.contains("2 + N050 G01 X2.0 F12"), "{drawn}");
    }

    #[test]
    fn binary_lines_are_drawn() {
        let place = Place::new("junk", 1, b"\x00\xff\xfeG1", 1..2);
        assert!(
            !Finding::error("E0101", "no letter", place)
                .drawn(false)
                .is_empty()
        );
        let past_the_end = Place::new("junk", 1, b"G1", 9..12);
        assert!(
            !Finding::error("E0101", "no letter", past_the_end)
                .drawn(false)
                .is_empty()
        );
    }

    #[test]
    fn places_in_a_text() {
        let place = Place::in_text("m.toml", "a = 1\nbaklash = 2\n", 6..13);
        assert_eq!(
            (place.line, place.column(), place.text.as_str()),
            (2, 1, "baklash = 2")
        );
    }
}

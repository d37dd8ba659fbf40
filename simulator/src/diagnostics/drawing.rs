//! Prints findings as drawn text, as one line each, or as JSON.

use super::{Finding, Place, Severity};
use crate::text::shown::{cut, is_obeyed, shown};
use annotate_snippets::{AnnotationKind, Group, Level, Patch, Renderer, Snippet};
use serde::Serialize;
use std::io::{self, Write};

/// The form in which findings are printed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Drawn under the line of the program.
    Text,
    /// `file:line:column: error[E0301]: message`, for editors and screen readers.
    Short,
}

/// Longest mark under a line, characters.
const LONGEST_MARK: usize = 100;
/// Longest line that is drawn with the change that removes the finding, bytes.
const LONGEST_FIX: usize = 200;

impl Place {
    /// The same place without control characters. Those that the renderer does not replace become
    /// a character of the same length.
    fn shown(&self) -> Self {
        let visible = |one: char| match one.len_utf8() {
            2 if is_obeyed(one) => '\u{bf}',
            3 if is_obeyed(one) => char::REPLACEMENT_CHARACTER,
            _ => one,
        };
        // A mark of a whole long line would be printed with the whole line.
        let mark = self.text.get(self.span.clone()).unwrap_or_default();
        let longest = mark.char_indices().nth(LONGEST_MARK);
        let length = longest.map_or(mark.len(), |(at, _)| at);
        Self {
            file: shown(&cut(&self.file)),
            line: self.line,
            text: self.text.chars().map(visible).collect(),
            span: self.span.start..self.span.start + length,
        }
    }
}

impl Finding {
    /// Prints the finding with its newline.
    ///
    /// # Errors
    ///
    /// The writer fails.
    pub fn print(&self, format: Format, colour: bool, out: &mut impl Write) -> io::Result<()> {
        match format {
            Format::Text => writeln!(out, "{}\n", self.drawn(colour)),
            Format::Short => writeln!(out, "{}", shown(&self.short())),
        }
    }

    /// The finding drawn under its line.
    pub fn drawn(&self, colour: bool) -> String {
        let shown = self.shown();
        shown.drawn_as_it_is(colour)
    }

    /// The same finding without control characters. Its columns stay the same.
    fn shown(&self) -> Self {
        Self {
            code: self.code.clone(),
            severity: self.severity,
            message: shown(&cut(&self.message)),
            place: self.place.as_ref().map(Place::shown),
            label: shown(&cut(&self.label)),
            elsewhere: self
                .elsewhere
                .as_ref()
                .map(|(place, label)| (place.shown(), shown(&cut(label)))),
            notes: self.notes.iter().map(|note| shown(&cut(note))).collect(),
            help: self.help.as_deref().map(|help| shown(&cut(help))),
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
            (Some(help), Some(fix), Some(place)) if place.text.len() <= LONGEST_FIX => {
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

    pub(super) fn short(&self) -> String {
        let (severity, code, message) = (self.severity.name(), &self.code, cut(&self.message));
        match &self.place {
            Some(place) => {
                let (file, line, column) = (&place.file, place.line, place.column());
                format!("{file}:{line}:{column}: {severity}[{code}]: {message}")
            }
            None => format!("{severity}[{code}]: {message}"),
        }
    }

    fn listed(&self) -> JsonFinding<'_> {
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
        JsonFinding {
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
        }
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

impl Serialize for Finding {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.listed().serialize(serializer)
    }
}

/// One finding of `--format json`.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_finding_is_printed_in_three_forms() {
        let place = Place::new("part.nc", 2, b"N050 G01 X2.0 U0.4 F12", 14..18);
        let finding = Finding::error("E0201", "unknown word `U`", place)
            .label("no axis or parameter named `U`")
            .help("remove the word")
            .fix(14..19, "");
        assert_eq!(
            finding.short(),
            "part.nc:2:15: error[E0201]: unknown word `U`"
        );
        let json = serde_json::to_string(&finding).unwrap();
        assert!(json.contains("\"column\":15,\"end\":19"));
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
}

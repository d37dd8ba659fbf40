//! Findings that say the same about several lines: the first ones are drawn, the others counted.

use super::Finding;
use crate::text::shown::shown;
use std::io::{self, Write};

/// Number of findings of one kind that are drawn.
const DRAWN: usize = 3;

/// The kinds of the findings of a program, in the order of their first findings.
#[derive(Default)]
pub struct Alike<'a>(Vec<Kind<'a>>);

/// Findings with one code and one text under their places.
struct Kind<'a> {
    first: &'a Finding,
    count: usize,
    last_line: usize,
}

impl<'a> Alike<'a> {
    /// Counts a finding. Returns whether it is drawn.
    pub fn is_drawn(&mut self, finding: &'a Finding) -> bool {
        let Some(place) = &finding.place else {
            return true;
        };
        let known = self.0.iter_mut().find(|kind| {
            let said = |of: &'a Finding| (&of.code, &of.label, &of.help);
            said(kind.first) == said(finding)
        });
        match known {
            Some(kind) => {
                kind.count += 1;
                kind.last_line = place.line;
                kind.count <= DRAWN
            }
            None => {
                self.0.push(Kind {
                    first: finding,
                    count: 1,
                    last_line: place.line,
                });
                true
            }
        }
    }

    /// Prints one line for each kind with findings that are not drawn.
    pub fn print(&self, out: &mut impl Write) -> io::Result<()> {
        let mut folded = self.0.iter().filter(|kind| kind.count > DRAWN).peekable();
        if folded.peek().is_none() {
            return Ok(());
        }
        for Kind {
            first,
            count,
            last_line,
        } in folded
        {
            let said = match first.label.as_str() {
                "" => &first.message,
                label => label,
            };
            let (severity, code) = (first.severity.name(), &first.code);
            let (said, more) = (shown(said), count - DRAWN);
            writeln!(
                out,
                "{severity}[{code}]: {more} more up to line {last_line}: {said}"
            )?;
        }
        writeln!(
            out,
            "`husillo check --format short` prints a line for each\n"
        )
    }
}

#[cfg(test)]
mod tests {
    use crate::diagnostics::{Finding, Findings, Format, Place};

    fn printed(findings: &Findings, format: Format) -> String {
        let mut printed = Vec::new();
        findings.print(format, false, &mut printed).unwrap();
        String::from_utf8(printed).unwrap()
    }

    #[test]
    fn findings_that_are_alike_are_drawn_three_times_and_counted() {
        let mut findings = Findings::new(50);
        let at = |line| Place::new("p.nc", line, b"X1 A2", 3..5);
        for line in 1..=9 {
            let finding = Finding::error("E0201", "unknown word `A`", at(line));
            findings.add(finding.label("this machine has no A axis"));
        }
        findings.add(Finding::error("E0202", "unknown code", at(10)).label("not in the list"));
        let text = printed(&findings, Format::Text);
        assert_eq!(text.matches("unknown word").count(), 3, "{text}");
        assert_eq!(text.matches("unknown code").count(), 1, "{text}");
        let rest = "error[E0201]: 6 more up to line 9: this machine has no A axis\n";
        assert!(text.contains(rest), "{text}");
        assert_eq!(printed(&findings, Format::Short).lines().count(), 10);
    }

    #[test]
    fn three_findings_that_are_alike_need_no_count() {
        let mut findings = Findings::new(50);
        for line in 1..=3 {
            let place = Place::new("p.nc", line, b"G99.9", 0..5);
            findings.add(Finding::error("E0202", "unknown code", place));
        }
        let text = printed(&findings, Format::Text);
        assert_eq!(text.matches("unknown code").count(), 3, "{text}");
        assert!(!text.contains("more"), "{text}");
    }
}

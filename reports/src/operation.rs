//! What became of a program on a machine: times, lines, stops, alarms.

use crate::frame;
use crate::text::escape;
use std::fmt::Write;

/// A program that was made on a machine.
#[derive(Clone, Debug, Default)]
pub struct Operation {
    /// Name and value, such as the start and the number of lines.
    pub figures: Vec<(&'static str, String)>,
    /// What happened: when, and what.
    pub events: Vec<(String, String)>,
    /// Events that are not among them.
    pub further: usize,
}

/// Writes the section.
pub fn section(page: &mut String, operation: &Operation) {
    page.push_str("<section><h2>On the machine</h2>\n");
    frame::figures(page, operation.figures.iter().cloned());
    if !operation.events.is_empty() {
        page.push_str(
            "<table class=\"events\"><thead><tr><th>Time</th><th>Event</th></tr></thead><tbody>\n",
        );
        for (when, what) in &operation.events {
            // Writing to a String cannot fail.
            let _ = writeln!(
                page,
                "<tr><td>{}</td><td>{}</td></tr>",
                escape(when),
                escape(what)
            );
        }
        page.push_str("</tbody></table>\n");
    }
    if operation.further > 0 {
        let _ = writeln!(
            page,
            "<p>{} further events are not listed.</p>",
            operation.further
        );
    }
    page.push_str("</section>\n");
}

/// A page with that section alone, of a program whose simulation would take too long.
pub fn html(program: &str, machine: &str, operation: &Operation) -> String {
    let mut page = frame::open(program, program, machine, "");
    section(&mut page, operation);
    frame::close(page, None)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_programs_and_events_are_text() {
        let operation = Operation {
            figures: vec![("lines", "3 of 4".into())],
            events: vec![("0:00:01.0".into(), "line 3, G1 <b>: refused".into())],
            further: 2,
        };
        let page = html("<i>.nc", "mill", &operation);
        assert!(page.contains("&lt;i&gt;.nc") && page.contains("G1 &lt;b&gt;"));
        assert!(page.contains("3 of 4") && page.contains("2 further events"));
    }
}

//! The operator before a terminal.

use crate::console::is_smart;
use crate::console::stop::stops_asked;
use crate::console::typed::typed_line;
use husillo_clients::drill::{Operator, left};
use husillo_gcode::Nm;
use indicatif::{ProgressBar, ProgressStyle};
use std::io::Write;

/// Parts of the bar.
const PARTS: u64 = 1000;

/// Standard input, an output, and a bar on standard error.
pub struct Console<'a> {
    out: &'a mut dyn Write,
    bar: ProgressBar,
}

impl<'a> Console<'a> {
    /// Where lines are shown.
    pub fn new(out: &'a mut dyn Write) -> Self {
        let bar = match is_smart(&std::io::stderr()) {
            true => ProgressBar::new(PARTS),
            false => ProgressBar::hidden(),
        };
        if let Ok(style) = ProgressStyle::with_template("{wide_bar} {percent} %, {msg}") {
            bar.set_style(style);
        }
        Self { out, bar }
    }

    /// The next line. `None` at the end of the input, or if Ctrl-C was pressed since this count.
    fn line(stops_before: u32) -> Option<String> {
        typed_line(stops_before).map(|line| line.trim().to_owned())
    }

    /// Takes the bar away.
    pub fn close(&self) {
        self.bar.finish_and_clear();
    }
}

impl Operator for Console<'_> {
    fn show(&mut self, line: &str) {
        self.bar.suspend(|| {
            // A closed output does not stop a machine.
            let _ = writeln!(self.out, "{line}").and_then(|()| self.out.flush());
        });
    }

    fn change(&mut self, tool: &str, diameter: Option<Nm>) -> Option<String> {
        let before = stops_asked();
        let wanted = diameter.map_or(String::new(), |nm| format!(" It should be {nm}."));
        self.show(&format!(
            "{tool}: the spindle stands. Put it in and type its diameter in mm.{wanted}"
        ));
        Self::line(before)
    }

    fn progress(&mut self, share: f64, left_s: f64) {
        self.bar
            .set_position((share.clamp(0.0, 1.0) * PARTS as f64) as u64);
        self.bar.set_message(left(left_s));
    }
}

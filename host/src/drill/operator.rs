//! The operator before a terminal.

use super::sender::{Operator, left};
use crate::wire::{stops_asked, typed_lines};
use husillo_gcode::Nm;
use indicatif::{ProgressBar, ProgressStyle};
use std::io::Write;
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::Duration;

/// Parts of the bar.
const PARTS: u64 = 1000;
/// Ctrl-C is looked for so often while a line is typed.
const LOOK: Duration = Duration::from_millis(50);

/// Standard input, an output, and a bar on standard error.
pub struct Console<'a> {
    out: &'a mut dyn Write,
    bar: ProgressBar,
    /// Lines as they are typed, from when the first one was asked for.
    typed: Option<Receiver<String>>,
}

impl<'a> Console<'a> {
    /// What is told goes there.
    pub fn new(out: &'a mut dyn Write) -> Self {
        let bar = ProgressBar::new(PARTS);
        if let Ok(style) = ProgressStyle::with_template("{wide_bar} {percent} %, {msg}") {
            bar.set_style(style);
        }
        Self {
            out,
            bar,
            typed: None,
        }
    }

    /// The next line; `None` where the input has ended, or Ctrl-C was pressed.
    fn line(&mut self) -> Option<String> {
        // A line that is waited for is not interrupted by Ctrl-C: so another thread waits.
        let typed = self.typed.get_or_insert_with(typed_lines);
        let before = stops_asked();
        loop {
            match typed.recv_timeout(LOOK) {
                Ok(line) => return Some(line.trim().to_owned()),
                Err(RecvTimeoutError::Disconnected) => return None,
                Err(RecvTimeoutError::Timeout) if stops_asked() > before => return None,
                Err(RecvTimeoutError::Timeout) => {}
            }
        }
    }

    /// Takes the bar away.
    pub fn close(&self) {
        self.bar.finish_and_clear();
    }
}

impl Operator for Console<'_> {
    fn tell(&mut self, line: &str) {
        self.bar.suspend(|| {
            // A reader that has gone away does not stop a machine.
            let _ = writeln!(self.out, "{line}").and_then(|()| self.out.flush());
        });
    }

    fn change(&mut self, tool: &str, diameter: Option<Nm>) -> Option<String> {
        let wanted = diameter.map_or(String::new(), |nm| format!(" It should be {nm}."));
        self.tell(&format!(
            "{tool}: the spindle stands. Put it in and type its diameter in mm.{wanted}"
        ));
        self.line()
    }

    fn progress(&mut self, share: f64, left_s: f64) {
        self.bar
            .set_position((share.clamp(0.0, 1.0) * PARTS as f64) as u64);
        self.bar.set_message(left(left_s));
    }
}

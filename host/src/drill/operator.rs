//! The operator before a terminal.

use crate::console::is_smart;
use crate::console::reporter::{Reporter, report};
use crate::console::stop::stops_asked;
use crate::console::typed::typed_line;
use husillo_clients::drill::{Operator, left};
use husillo_gcode::Nm;
use husillo_simulator::text::json::Millimetres;
use indicatif::{ProgressBar, ProgressStyle};
use serde_json::json;

/// Parts of the bar.
const PARTS: u64 = 1000;

/// Standard input, an output, and a bar on standard error.
pub struct Console<'a, 'b> {
    out: &'a mut Reporter<'b>,
    port: &'a str,
    bar: ProgressBar,
    /// The progress that an object has reported.
    percent: Option<u64>,
}

impl<'a, 'b> Console<'a, 'b> {
    /// Where lines are shown.
    pub fn new(out: &'a mut Reporter<'b>, port: &'a str) -> Self {
        let bar = match is_smart(&std::io::stderr()) {
            true => ProgressBar::new(PARTS),
            false => ProgressBar::hidden(),
        };
        if let Ok(style) = ProgressStyle::with_template("{wide_bar} {percent} %, {msg}") {
            bar.set_style(style);
        }
        Self {
            out,
            port,
            bar,
            percent: None,
        }
    }

    /// Where lines are shown.
    pub const fn out(&mut self) -> &mut Reporter<'b> {
        self.out
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

impl Operator for Console<'_, '_> {
    fn show(&mut self, line: &str) {
        let (out, port) = (&mut *self.out, self.port);
        self.bar.suspend(|| {
            out.tell(line, || report(1, port, line));
        });
    }

    fn change(&mut self, tool: &str, diameter: Option<Nm>) -> Option<String> {
        let before = stops_asked();
        let wanted = diameter.map_or(String::new(), |nm| format!(" It should be {nm}."));
        let (out, port) = (&mut *self.out, self.port);
        self.bar.suspend(|| {
            out.tell(
                format_args!(
                    "{tool}: the spindle is off. Put it in and type its diameter in mm.{wanted}"
                ),
                || {
                    let nm = diameter.map(|Nm(nm)| Millimetres(nm));
                    json!({"kind": "tool", "port": port, "tool": tool, "diameter_mm": nm})
                },
            );
        });
        Self::line(before)
    }

    fn progress(&mut self, share: f64, left_s: f64) {
        self.bar
            .set_position((share.clamp(0.0, 1.0) * PARTS as f64) as u64);
        self.bar.set_message(left(left_s));
        let whole = (share.clamp(0.0, 1.0) * 100.0) as u64;
        if self.percent != Some(whole) {
            self.percent = Some(whole);
            self.out.object(
                &json!({"kind": "progress", "port": self.port, "percent": whole, "left_s": left_s}),
            );
        }
    }
}

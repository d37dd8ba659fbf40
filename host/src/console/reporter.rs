//! The output of a command that drives a machine: lines for people, or one object per line for
//! programs.

use crate::cli::Output;
use husillo_simulator::diagnostics::Findings;
use husillo_simulator::text::json::{write_found, write_line};
use serde_json::{Value, json};
use std::fmt::Display;
use std::io::{self, Write};

/// The output of a command that drives a machine. No failure of it stops the machine: `out` keeps
/// its first error.
pub struct Reporter<'a> {
    out: &'a mut dyn Write,
    format: Output,
    /// Name of the objects, as `husillo.jog/1`.
    schema: &'static str,
}

impl<'a> Reporter<'a> {
    /// Writes to `out`.
    pub fn new(out: &'a mut dyn Write, format: Output, schema: &'static str) -> Self {
        Self {
            out,
            format,
            schema,
        }
    }

    /// Lines or objects.
    pub const fn format(&self) -> Output {
        self.format
    }

    /// Whether it prints objects.
    pub fn is_json(&self) -> bool {
        self.format == Output::Json
    }

    /// Prints a line at once, or the object that says the same.
    pub fn tell(&mut self, line: impl Display, object: impl FnOnce() -> Value) {
        match self.format {
            Output::Text => self.text(line),
            Output::Json => self.object(&object()),
        }
    }

    /// Prints a line or its object at once, for a command that ends when this fails.
    ///
    /// # Errors
    ///
    /// It cannot be written.
    #[cfg(unix)]
    pub fn tried(&mut self, line: &str, object: &Value) -> io::Result<()> {
        match self.format {
            Output::Text => writeln!(self.out, "{line}")?,
            Output::Json => write_line(self.schema, object, &mut self.out)?,
        }
        self.out.flush()
    }

    /// Prints a line that no program needs.
    pub fn text(&mut self, line: impl Display) {
        if !self.is_json() {
            let _ = writeln!(self.out, "{line}").and_then(|()| self.out.flush());
        }
    }

    /// Prints an object that people see elsewhere.
    pub fn object(&mut self, object: &Value) {
        if self.is_json() {
            let written = write_line(self.schema, object, &mut self.out);
            let _ = written.and_then(|()| self.out.flush());
        }
    }

    /// Prints the findings of a program as an object. People have read them on standard error.
    pub fn findings(&mut self, file: &str, findings: &Findings) {
        if self.is_json() {
            let body = json!({
                "kind": "findings",
                "file": file,
                "errors": findings.errors,
                "warnings": findings.warnings,
            });
            let written = write_found(self.schema, &body, findings, &mut self.out);
            let _ = written.and_then(|()| self.out.flush());
        }
    }

    /// Prints a failure: on standard error, or as an object. `about` is the port or the file.
    pub fn failed(&mut self, about: &str, why: &str) {
        match self.format {
            Output::Text => eprintln!("error: {about}: {why}"),
            Output::Json => {
                self.object(&json!({"kind": "failed", "about": about, "message": why}));
            }
        }
    }
}

/// The object of an action that has ended: with its result, or with the reason of its failure.
/// `machine` counts from 1.
pub fn action(
    machine: usize,
    port: &str,
    action: &dyn Display,
    took_s: f64,
    end: Result<&str, &str>,
) -> Value {
    json!({
        "kind": "action",
        "machine": machine,
        "port": port,
        "action": action.to_string(),
        "took_s": took_s,
        "result": end.ok(),
        "trouble": end.err(),
    })
}

/// The object of a line of a device.
pub fn report(machine: usize, port: &str, line: &str) -> Value {
    json!({"kind": "report", "machine": machine, "port": port, "text": line})
}

impl Write for Reporter<'_> {
    /// Text of a report that has no objects.
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self.format {
            Output::Text => self.out.write(bytes),
            Output::Json => Ok(bytes.len()),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

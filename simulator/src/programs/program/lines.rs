//! Interprets lines as they arrive.

use super::{Each, Meaning, Start, Walker};
use crate::diagnostics::{Finding, Findings};
use crate::programs::blocks;
use crate::programs::explain::At;
use crate::programs::source::Source;
use crate::programs::watch::Watch;
use husillo_gcode::contour::needs_contours;
use husillo_gcode::parameters::needs_program;
use husillo_gcode::{Command, Nm};
use husillo_sim::observers::AXES;
use std::io::{self, Cursor};

/// A program that is typed, or comes from a pipe. The modal state is kept from line to line. A line
/// with an error changes nothing.
#[derive(Clone, Debug)]
pub struct Lines<'a> {
    walker: Walker<'a>,
    number: usize,
    /// A `%` began the program.
    is_framed: bool,
    has_ended: bool,
}

impl<'a> Lines<'a> {
    /// Starts before the first line.
    pub fn new(file: &'a str, start: Start) -> Self {
        Self {
            walker: Walker::new(u64::MAX, file, start),
            number: 0,
            is_framed: false,
            has_ended: false,
        }
    }

    /// Sets what is called while lines are read.
    pub fn with_watch(mut self, watch: Watch) -> Self {
        self.walker.watch = watch;
        self
    }

    /// Whether a line has ended the program: M2, M30, or the second `%`.
    pub const fn has_ended(&self) -> bool {
        self.has_ended
    }

    /// Interprets a line. `findings` receives its errors, and `each` its commands until an error.
    /// `each` may add errors. After an error the state is as before the line.
    ///
    /// # Errors
    ///
    /// `each` fails.
    pub fn line<F>(&mut self, bytes: &[u8], findings: &mut Findings, mut each: F) -> io::Result<()>
    where
        F: FnMut(&Meaning<'_>, &Command<AXES>, [Nm; AXES], &mut Findings) -> io::Result<()>,
    {
        self.number += 1;
        let dialect = self.walker.dialect;
        if bytes.trim_ascii().starts_with(b"%") {
            self.has_ended = self.is_framed;
            self.is_framed = true;
            return Ok(());
        }
        if needs_program(bytes, &dialect) || needs_contours(bytes, &dialect) {
            findings.add(self.needs_a_file(bytes));
            return Ok(());
        }
        let before = self.walker.clone();
        let errors = findings.errors;
        self.walk(bytes, findings, &mut each)?;
        if findings.errors > errors {
            self.walker = before;
        }
        self.has_ended |= self.walker.has_ended;
        Ok(())
    }

    /// Passes on the last move of a program that ends without G40.
    ///
    /// # Errors
    ///
    /// `each` fails.
    pub fn finish<F>(&mut self, findings: &mut Findings, mut each: F) -> io::Result<()>
    where
        F: FnMut(&Meaning<'_>, &Command<AXES>, [Nm; AXES], &mut Findings) -> io::Result<()>,
    {
        self.walker.finish(findings, &mut each)
    }

    /// Counts a line that is not executed.
    pub const fn count(&mut self) {
        self.number += 1;
    }

    fn walk(&mut self, bytes: &[u8], findings: &mut Findings, each: Each<'_>) -> io::Result<()> {
        let reader = Box::new(Cursor::new(bytes.to_owned()));
        let mut source = Source::from_reader(reader).after(self.number - 1);
        let dialect = self.walker.dialect;
        blocks::each_block(
            &mut source,
            dialect,
            &mut self.walker,
            super::Walker::reading,
            |walker, given, block| walker.block(given, block, findings, each),
        )
    }

    fn needs_a_file(&self, bytes: &[u8]) -> Finding {
        let at = At {
            file: self.walker.file,
            line: self.number,
            bytes,
            block: 0,
            length: bytes.len(),
            dialect: self.walker.dialect,
        };
        let message = "this line needs the rest of its program";
        Finding::error("E0640", message, at.whole())
            .label("a parameter, an expression, an O-word or a contour")
            .note("lines are made as they arrive; a program in a file may have such lines")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use husillo_gcode::Dialect;

    /// The ends of the moves of each line in mm, or its error.
    fn moves(lines: &[&str]) -> Vec<String> {
        let mut program = Lines::new("p", Dialect::RS274.into());
        let mut all = Vec::new();
        for line in lines {
            let mut findings = Findings::new(50);
            let mut ends = String::new();
            program
                .line(line.as_bytes(), &mut findings, |_, command, _, _| {
                    if let Some([x, y, z, ..]) = command.end() {
                        ends += &format!("{x} {y} {z};");
                    }
                    Ok(())
                })
                .unwrap();
            if program.has_ended() {
                ends += "end";
            }
            all.push(findings.short().concat() + &ends);
        }
        all
    }

    #[test]
    fn modes_last_from_line_to_line() {
        let made = moves(&[
            "%",
            "G91 G20 G1 F1",
            "X1",
            "",
            "G90 Y1 (home) ",
            "G0",
            "Z1",
            "%",
        ]);
        let ends = [
            "",
            "",
            "25.4 0 0;",
            "",
            "25.4 25.4 0;",
            "",
            "25.4 25.4 25.4;",
            "end",
        ];
        assert_eq!(made, ends);
        assert_eq!(moves(&["G0 X1", "M30"])[1], "end");
    }

    #[test]
    fn a_wrong_line_changes_nothing() {
        let made = moves(&[
            "G91 G0 X1",
            "G90 G2 X5",
            "X1",
            "G0 X[1+1]",
            "#1=2",
            "o1 if [1]",
        ]);
        assert_eq!((&made[0][..], &made[2][..]), ("1 0 0;", "2 0 0;"));
        assert!(made[1].starts_with("p:2:"), "{made:?}");
        for (place, line) in made.iter().enumerate().skip(3) {
            let error = format!("p:{}:1: error[E0640]", place + 1);
            assert!(line.starts_with(&error), "{line}");
        }
    }
}

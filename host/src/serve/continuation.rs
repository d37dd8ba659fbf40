//! A program from one of its lines on: the state there, and the lines that lead to it.

use super::loaded::{Loaded, in_nm};
use crate::app::Before;
use husillo_gcode::{FeedMode, Nm, SpindleDirection};
use husillo_simulator::programs::program::Start;
use serde_json::{Value, json};

/// What the machine was like when a continuation was made.
#[derive(Clone, Debug, PartialEq)]
pub struct Circumstances {
    /// Work zero in machine coordinates, mm.
    pub zero_mm: Vec<f64>,
    /// Position in machine coordinates, mm.
    pub at_mm: Vec<f64>,
    /// Position in machine coordinates at which the program was started at its first line, mm. An
    /// axis stays there until a line moves it.
    pub begun_mm: Vec<f64>,
    /// The modes of the controller: motion, work coordinate system, plane, units, distances, feeds,
    /// and more.
    pub modal: Vec<String>,
    /// The tool of the controller.
    pub tool: u8,
}

/// A program from one of its lines on.
#[derive(Clone, Debug)]
pub struct Continuation {
    /// The line that was asked for.
    pub asked: usize,
    /// The first line with a command from there on.
    pub from: usize,
    /// Index of that line among the lines that the controller gets.
    index: usize,
    /// Lines that are sent before it.
    pub before: Vec<String>,
    /// The state there.
    state: Value,
    warnings: Vec<&'static str>,
    circumstances: Circumstances,
}

impl Continuation {
    /// A program from this line on. Takes as long as the lines before take to read.
    ///
    /// # Errors
    ///
    /// A sentence about why the program cannot begin there.
    pub fn new(program: &Loaded, asked: usize, now: Circumstances) -> Result<Self, String> {
        let index = program.lines.partition_point(|(line, _)| *line < asked);
        let (from, next) = (program.lines.get(index))
            .ok_or_else(|| format!("the program has no command from line {asked} on"))?;
        let start = Start {
            zero: in_nm(&now.zero_mm),
            at: in_nm(&now.begun_mm),
            ..program.start
        };
        // As the program would begin now: with all modes of the controller but the motion.
        let modes = now.modal.get(1..6).unwrap_or_default().join(" ");
        let before = Before::line(*from, program.code(), &modes, &program.name, start)?;
        let height = (now.at_mm.get(2).zip(now.zero_mm.get(2))).map(|(at, zero)| at - zero);
        let height = height.map(|mm| Nm((mm * 1e6).round() as i64));
        let lines = before.approach(height, next)?;
        Ok(Self {
            asked,
            from: *from,
            index,
            state: state(&before, lines.last().map_or("", String::as_str)),
            warnings: warnings(&before, &now),
            before: lines,
            circumstances: now,
        })
    }

    /// All lines that the controller gets, each with the number of its line in the program.
    pub fn lines(&self, program: &Loaded) -> Vec<(usize, String)> {
        let before = self.before.iter().map(|line| (self.from, line.clone()));
        let rest = program.lines.iter().skip(self.index).cloned();
        before.chain(rest).collect()
    }

    /// Whether it is still what was asked for and shown.
    pub fn is_shown(&self, asked: usize, now: &Circumstances) -> bool {
        (self.asked, &self.circumstances) == (asked, now)
    }

    /// What a page shows before anything moves.
    pub fn described(&self, program: &Loaded) -> Value {
        let times = program.times.as_ref();
        let left_s = times.map(|times| times.total_s() - times.end_s(self.from - 1));
        json!({
            "name": program.name,
            "lines": program.lines.len() - self.index,
            "time_s": left_s,
            "from": self.from,
            "before": self.before,
            "state": self.state,
            "warnings": self.warnings,
        })
    }
}

/// The state, as the `state` of a machine has it. The last line of an approach restores the modes.
fn state(before: &Before, last: &str) -> Value {
    let modal = &before.modal;
    let (direction, milli_rpm) = modal.spindle();
    let mut codes: Vec<_> = last.split(' ').map(str::to_owned).collect();
    codes.push(system(before));
    codes.push(
        match direction {
            SpindleDirection::Clockwise => "M3",
            SpindleDirection::CounterClockwise => "M4",
            _ => "M5",
        }
        .to_owned(),
    );
    let (mist, flood) = modal.coolant();
    codes.extend(mist.then(|| "M7".to_owned()));
    codes.extend(flood.then(|| "M8".to_owned()));
    if !mist && !flood {
        codes.push("M9".to_owned());
    }
    let feed = modal.feed().map(|Nm(nm)| nm as f64 / 1e6);
    let feed = feed.filter(|_| modal.feed_mode() == FeedMode::PerMinute);
    let at = modal.work_position().map(|Nm(nm)| nm as f64 / 1e6);
    json!({
        "modal": codes,
        "offset": system(before),
        "tool": modal.tool(),
        "programmed": {"feed": feed, "rpm": milli_rpm as f64 / 1e3},
        // A controller of Grbl has three axes that a program of ours is checked for.
        "work_mm": at[..3],
    })
}

fn system(before: &Before) -> String {
    format!("G{}", 54 + before.modal.work_system())
}

fn warnings(before: &Before, now: &Circumstances) -> Vec<&'static str> {
    let mut warnings = Vec::new();
    if before.modal.tool() != 0 && before.modal.tool() != u32::from(now.tool) {
        warnings
            .push("the lines before select another tool: put it in and measure its length first");
    }
    if !now.modal.contains(&system(before)) {
        warnings.push(
            "the lines before choose another work coordinate system: check the position, because \
             only the zero of the present one is known",
        );
    }
    warnings
}

#[cfg(test)]
mod tests {
    use super::super::loaded::{Surroundings, Target};
    use super::*;

    const PART: &str = "G21 G90 G94\n(high)\nG0 Z8\nM3 S9000\nG0 X5 Y5\nG1 Z-1 F300\n\
                        M8\nG91 G1 X10 F600\nY2\nX1\n";

    fn now() -> Circumstances {
        let modes = ["G0", "G54", "G17", "G21", "G90", "G94", "M5", "M9"];
        Circumstances {
            zero_mm: vec![-100.0, -100.0, -40.0],
            at_mm: vec![-90.0, -80.0, -39.0],
            begun_mm: vec![-90.0, -80.0, -39.0],
            modal: modes.map(str::to_owned).into(),
            tool: 0,
        }
    }

    fn loaded(text: &str) -> Loaded {
        let around = Surroundings {
            target: Target::Grbl([(100, "400".to_owned())].into()),
            zero_mm: now().zero_mm,
            at_mm: now().at_mm,
        };
        Loaded::new("part.nc", text.as_bytes().to_vec(), &around).unwrap()
    }

    fn before(text: &str, from: usize, now: Circumstances) -> Vec<String> {
        Continuation::new(&loaded(text), from, now).unwrap().before
    }

    #[test]
    fn it_has_the_state_of_the_lines_before() {
        let program = loaded(PART);
        let continuation = Continuation::new(&program, 9, now()).unwrap();
        let expected = [
            "G21 G90 G94 G17 G54",
            "G0 Z8",
            "G0 X15 Y5",
            "M3 S9000",
            "M8",
            "G1 Z-1 F600",
            "G17 G21 G91 G94 G1",
        ];
        assert_eq!(continuation.before, expected);
        let shown = continuation.described(&program);
        let modes = ["G17", "G21", "G91", "G94", "G1", "G54", "M3", "M8"];
        assert_eq!(shown["state"]["modal"], json!(modes));
        assert_eq!(shown["state"]["work_mm"], json!([15.0, 5.0, -1.0]));
        assert_eq!(shown["state"]["programmed"]["feed"], 600.0);
        assert_eq!((&shown["from"], &shown["lines"]), (&json!(9), &json!(2)));
        let lines = continuation.lines(&program);
        assert_eq!(lines.len(), 9);
        assert_eq!(lines[6].0, 9);
        assert_eq!(lines[7..], [(9, "Y2".to_owned()), (10, "X1".to_owned())]);
    }

    /// Above what is highest: the lines before, the machine, or the work zero.
    #[test]
    fn the_tool_is_raised_first() {
        let mut high = now();
        high.at_mm[2] = -30.0;
        assert_eq!(before(PART, 9, high)[1], "G0 Z10");
        assert_eq!(before("G0 X1\nG1 Z-3 F100\nX2\n", 3, now())[1], "G0 Z1");
        // A move in machine coordinates.
        let lines = before("G53 G0 Z-5\nG0 X1 Y1\nG1 Z-1 F100\nX2\n", 4, now());
        assert_eq!(lines[1], "G0 Z35");
    }

    /// A program that begins in the modes and at the position of the machine.
    #[test]
    fn it_begins_as_the_program_would() {
        let mut inches = now();
        inches.modal[3] = "G20".into();
        inches.modal[1] = "G55".into();
        inches.begun_mm[1] = -70.0;
        let lines = before("G1 X1 F10\nX2\n", 2, inches);
        assert_eq!(lines[0], "G21 G90 G94 G17 G55");
        assert_eq!(lines[2], "G0 X25.4 Y30");
        assert_eq!(lines.last().unwrap(), "G17 G20 G90 G94 G1");
    }

    #[test]
    fn what_cannot_be_restored_is_refused_or_said() {
        let refused = |text: &str, from| Continuation::new(&loaded(text), from, now()).unwrap_err();
        assert!(refused("G0 X1\n", 2).contains("no command"));
        assert!(refused("G92 X3\nG0 X1\n", 2).contains("work zero"));
        assert!(refused("G0 X0 Y0\nG2 X1 Y1 R5 F100\nX3 Y3 R5\n", 3).contains("its own code"));
        let elsewhere = "G2 X1 Y1 I5 J0 F100\nG0 X3\n";
        assert!(refused(elsewhere, 2).contains("errors"), "{elsewhere}");
        let program = loaded("G55\nT2\nG0 X1\nX2\n");
        let shown = Continuation::new(&program, 4, now()).unwrap();
        assert_eq!(
            shown.described(&program)["warnings"]
                .as_array()
                .unwrap()
                .len(),
            2
        );
        assert!(shown.is_shown(4, &now()) && !shown.is_shown(3, &now()));
        let mut moved = now();
        moved.at_mm[0] += 0.001;
        assert!(!shown.is_shown(4, &moved));
    }
}

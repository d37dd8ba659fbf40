//! A program as records of the drill: in its own language, or with depths in RS-274.

use husillo_clients::drill::{Part, millimetres};
use husillo_gcode::{Axes, Command, Dialect, Nm};
use husillo_sim::device::drill::STROKE_STEPS;
use husillo_sim::observers::AXES;
use husillo_simulator::diagnostics::{Finding, Findings};
use husillo_simulator::programs::program;
use husillo_simulator::programs::source::Source;
use husillo_transports::drill::{Record, STEPS_PER_MM, Table};
use std::fmt::Write as _;
use std::io;

/// How a program is translated.
#[derive(Clone, Copy, Debug)]
pub struct Translation {
    /// The language of the program.
    pub dialect: Dialect,
    /// Where holes may be.
    pub table: Table,
    /// Height of the upper sensor above Z 0, if Z words are depths.
    pub home_height: Nm,
}

/// The translation so far.
struct Maker {
    table: Table,
    home_height: Nm,
    parts: Vec<Part>,
    /// Position at the end of the records, from home.
    at: [u16; 2],
    /// In the board: no way sideways.
    is_down: bool,
}

impl Translation {
    /// The records of a program, one part for each tool that it selects.
    ///
    /// # Errors
    ///
    /// Reading fails. `findings` gets the errors of the program.
    pub fn read(
        &self,
        source: &mut Source,
        file: &str,
        findings: &mut Findings,
    ) -> io::Result<Vec<Part>> {
        let mut maker = Maker {
            table: self.table,
            home_height: self.home_height,
            parts: Vec::new(),
            at: [0; 2],
            is_down: false,
        };
        maker.change(0);
        program::walk(
            source,
            file,
            self.dialect.with_axes(Axes::XYZ),
            findings,
            |meaning, command, from, findings| {
                let at = &meaning.at;
                if let Err((code, message)) = maker.make(command, from) {
                    findings.add(Finding::error(code, message, at.whole()));
                }
                Ok(())
            },
        )?;
        maker.parts.retain(|part| part.holes() > 0);
        Ok(maker.parts)
    }
}

impl Maker {
    fn change(&mut self, tool: u32) {
        self.parts.push(Part {
            tool,
            diameter: None,
            records: Vec::new(),
        });
        // A part begins at home.
        self.at = [0; 2];
    }

    fn put(&mut self, record: Record) {
        if let Some(part) = self.parts.last_mut() {
            part.records.push(record);
        }
    }

    fn make(
        &mut self,
        command: &Command<AXES>,
        from: [Nm; AXES],
    ) -> Result<(), (&'static str, String)> {
        match command {
            Command::Rapid { to } => self.go(*to, from, false),
            Command::Linear { to, .. } => self.go(*to, from, true),
            Command::Drill => {
                self.put(Record::Drill(0));
                Ok(())
            }
            Command::Tool { number } => {
                self.change(*number);
                Ok(())
            }
            Command::Arc { .. }
            | Command::Spline { .. }
            | Command::NurbsBegin { .. }
            | Command::NurbsPoint { .. }
            | Command::NurbsEnd { .. }
            | Command::Thread { .. }
            | Command::Tap { .. } => Err((
                "E0631",
                "the drill moves from point to point: no arc, no curve, no thread".into(),
            )),
            Command::Probe { .. } => Err(("E0631", "the drill has no probe".into())),
            // Its records have no spindle, coolant or dwell.
            _ => Ok(()),
        }
    }

    fn go(
        &mut self,
        to: [Nm; AXES],
        from: [Nm; AXES],
        is_feed: bool,
    ) -> Result<(), (&'static str, String)> {
        let [x, y, z, ..] = to;
        let steps = self
            .table
            .steps([x.0, y.0])
            .map_err(|error| ("E0401", error.to_string()))?;
        for (axis, steps) in steps.into_iter().enumerate() {
            if self.at[axis] == steps {
                continue;
            }
            if self.is_down {
                let message = "a move across while the drill is in the board".into();
                return Err(("E0631", message));
            }
            self.at[axis] = steps;
            self.put(if axis == 0 {
                Record::X(steps)
            } else {
                Record::Y(steps)
            });
        }
        if z > from[2] {
            self.is_down = false;
        }
        if z < from[2] && is_feed {
            self.is_down = true;
            let depth = self.depth(z)?;
            self.put(Record::Drill(depth));
        }
        Ok(())
    }

    /// Steps below the upper sensor.
    fn depth(&self, z: Nm) -> Result<u16, (&'static str, String)> {
        let below = i128::from(self.home_height.0) - i128::from(z.0);
        let steps = (below * i128::from(STEPS_PER_MM) + 500_000).div_euclid(1_000_000);
        match u16::try_from(steps) {
            Ok(steps @ 1..=STROKE_STEPS) => Ok(steps),
            Ok(1..) => Err((
                "E0401",
                format!("Z{z} is below the lower sensor, which is 35 mm below the upper one"),
            )),
            _ => Err((
                "E0401",
                format!(
                    "Z{z} is no depth below the upper sensor, which is at Z{}: see --home-height",
                    self.home_height
                ),
            )),
        }
    }
}

/// A program that compiles to these records: in the drill's language, or in RS-274 if they have
/// depths.
///
/// # Errors
///
/// A sentence: a program cannot have both depths and strokes to the lower sensor.
pub fn text(records: &[Record]) -> Result<String, String> {
    let mut text = String::from("%\n");
    let depths = |record: &Record| match record {
        Record::Drill(depth) => Some(*depth > 0),
        _ => None,
    };
    let has_depths = records.iter().filter_map(depths).any(|is_depth| is_depth);
    if has_depths && !records.iter().filter_map(depths).all(|is_depth| is_depth) {
        return Err(
            "some holes have a depth and some go to the lower sensor: a program has one kind only; \
             see --format text"
                .into(),
        );
    }
    // Writing to a string does not fail.
    if has_depths {
        text.push_str("G21 G90 G94 F60\n");
        for record in records {
            let _ = match record {
                Record::X(steps) => writeln!(text, "G0 X{}", millimetres(*steps)),
                Record::Y(steps) => writeln!(text, "G0 Y{}", millimetres(*steps)),
                Record::Drill(depth) => writeln!(text, "G1 Z-{}\nG0 Z0", millimetres(*depth)),
            };
        }
        text.push_str("%\n");
        return Ok(text);
    }
    text.push_str("G21\nG90\n");
    // Words of the present line; X comes before Y.
    let mut line: Vec<Record> = Vec::new();
    let mut at = [0; 2];
    for record in records {
        match record {
            Record::Drill(_) => {
                if line.is_empty() {
                    line.push(Record::X(at[0]));
                }
                words(&mut text, "", &line);
                line.clear();
                continue;
            }
            Record::X(x) => {
                at[0] = *x;
                if !line.is_empty() {
                    words(&mut text, "G28 ", &line);
                    line.clear();
                }
            }
            Record::Y(y) => {
                at[1] = *y;
                if matches!(line.last(), Some(Record::Y(_))) {
                    words(&mut text, "G28 ", &line);
                    line.clear();
                }
            }
        }
        line.push(*record);
    }
    if !line.is_empty() {
        words(&mut text, "G28 ", &line);
    }
    text.push_str("%\n");
    Ok(text)
}

fn words(text: &mut String, code: &str, line: &[Record]) {
    text.push_str(code);
    for (place, record) in line.iter().enumerate() {
        let blank = if place == 0 { "" } else { " " };
        let _ = match record {
            Record::X(steps) => write!(text, "{blank}X{}", millimetres(*steps)),
            Record::Y(steps) => write!(text, "{blank}Y{}", millimetres(*steps)),
            Record::Drill(_) => Ok(()),
        };
    }
    text.push('\n');
}

#[cfg(test)]
mod tests {
    use super::*;
    use husillo_clients::drill::lean;
    use proptest::prelude::*;

    fn compile(text: &str, dialect: Dialect) -> Result<Vec<Part>, String> {
        let mut findings = Findings::new(50);
        let mut source = Source::from_reader(Box::new(io::Cursor::new(text.as_bytes().to_vec())));
        let translation = Translation {
            dialect,
            table: Table::UNBOUNDED,
            home_height: Nm(0),
        };
        let parts = translation.read(&mut source, "p", &mut findings).unwrap();
        if findings.errors > 0 {
            return Err(findings.short().join("\n"));
        }
        Ok(parts)
    }

    fn part(records: Vec<Record>) -> Part {
        Part {
            tool: 0,
            diameter: None,
            records,
        }
    }

    #[test]
    fn the_language_of_the_drill() {
        let text = "%\n; a board\nG20\nG90\nX1 Y0.5\nX1.1\nG28 Y0\nG21\nG91\nX10\nG92 X0 \
             Y0\nG90\nX1 Y1\n%\n";
        let parts = compile(text, Dialect::DRILL).unwrap();
        let expected = [
            Record::X(2718),
            Record::Y(1359),
            Record::Drill(0),
            Record::X(2990),
            Record::Drill(0),
            Record::Y(0),
            Record::X(4060),
            Record::Drill(0),
        ];
        assert_eq!(parts[0].records[..8], expected);
        assert_eq!(parts[0].holes(), 4);
        assert!(
            compile("X-1", Dialect::DRILL)
                .unwrap_err()
                .contains("off the table")
        );
    }

    #[test]
    fn depths_and_pecks() {
        let text = "G21 G90 F60\nT1 M6\nG0 Z2\nG81 X1 Y2 Z-3 R-1\nX2\nG80\nT2 M6\nG83 X5 Y5 Z-3 \
             R-1 Q1\nG80\nG0 X0\nG1 Z-1.5\n";
        let parts = compile(text, Dialect::RS274).unwrap();
        assert_eq!(
            parts.iter().map(|part| part.tool).collect::<Vec<_>>(),
            [1, 2]
        );
        let [one, two] = &parts[..] else { panic!() };
        let depths = |part: &Part| part.stops().map(|stop| stop.depth).collect::<Vec<_>>();
        assert_eq!(depths(one), [321, 321]);
        // Pecks of 1 mm below R, then a hole by G1.
        assert_eq!(depths(two), [214, 321, 161]);
        assert!(
            compile("G1 F60 Z-1\nX3", Dialect::RS274)
                .unwrap_err()
                .contains("a move across")
        );
        assert!(
            compile("G1 F60 Z-1\nG2 X1 Y1 I1", Dialect::RS274)
                .unwrap_err()
                .contains("no arc")
        );
        assert!(
            compile("G0 Z5\nG1 F60 Z1", Dialect::RS274)
                .unwrap_err()
                .contains("--home-height")
        );
    }

    fn records(depths: bool) -> impl Strategy<Value = Vec<Record>> {
        let depth = if depths { 1..=STROKE_STEPS } else { 0..=0 };
        let record = prop_oneof![
            any::<u16>().prop_map(Record::X),
            any::<u16>().prop_map(Record::Y),
            depth.prop_map(Record::Drill)
        ];
        prop::collection::vec(record, 1..60)
    }

    proptest! {
        /// Records to a program and back: the same holes in the same order with the same depths;
        /// from then on the same records.
        #[test]
        fn there_and_back(
            depths in any::<bool>(),
            mut all in records(false),
            deep in records(true),
        ) {
            if depths {
                all = deep;
            }
            all.push(Record::Drill(u16::from(depths)));
            let dialect = if depths { Dialect::RS274 } else { Dialect::DRILL };
            let once = compile(&text(&all).unwrap(), dialect).unwrap();
            let stops: Vec<_> = part(all).stops().collect();
            prop_assert_eq!(once[0].stops().collect::<Vec<_>>(), stops);
            let twice = compile(&text(&once[0].records).unwrap(), dialect).unwrap();
            prop_assert_eq!(&twice, &once);
        }

        /// What a drill file compiles to comes back as it was, byte for byte, but for moves to
        /// where it is already.
        #[test]
        fn holes_of_a_file_there_and_back(
            holes in prop::collection::vec((any::<u16>(), any::<u16>()), 1..40),
        ) {
            let hole = |(x, y)| [Record::X(x), Record::Y(y), Record::Drill(0)];
            let all = lean(&holes.into_iter().flat_map(hole).collect::<Vec<_>>());
            let back = compile(&text(&all).unwrap(), Dialect::DRILL).unwrap();
            prop_assert_eq!(part(back[0].records.clone()).bytes(), part(all).bytes());
        }
    }
}

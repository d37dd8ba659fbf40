//! A program of the circuit-board drill: read, placed on the table, and divided into holes.

use husillo_clients::drill::{Part, lean, seconds, travel_s, travel_steps};
use husillo_excellon::{Overrides, Profile};
use husillo_gcode::{Dialect, Nm};
use husillo_holes::{
    Board, Fit, Metric, Placement, RecordsError, Setup, Shift, SlotHandling, records,
};
use husillo_simulator::diagnostics::{Finding, Findings, Severity};
use husillo_simulator::holes::{is_drill_file, read as read_board};
use husillo_simulator::programs::source::Source;
use husillo_transports::drill::{STEPS_PER_MM, Table};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use std::collections::HashMap;
use std::io::Cursor;

use crate::drill::Translation;

/// Holes on the board view. Of a longer program it has none.
const MOST_SHOWN: usize = 50_000;

/// How a drill file is read, and where its holes are put.
#[derive(Clone, Debug, Default, Deserialize, PartialEq, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct Placing {
    /// Only these tools. Empty: all.
    pub only: Vec<u16>,
    /// The axis whose sign changes, because the board is turned over.
    pub mirror: Option<Mirror>,
    /// Turn, counter-clockwise, degrees.
    pub turn_degrees: f64,
    /// Measured holes.
    pub references: Vec<Reference>,
    /// The measured holes also correct scale and skew.
    pub stretch: bool,
    /// The smallest X and Y of the board are put at 0.
    pub corner: bool,
    /// The holes of each tool are sorted for a short path.
    pub shortest: bool,
    /// A file without a header, in inches with 2.3 digits.
    pub tango: bool,
}

/// An axis whose sign changes.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Mirror {
    /// X.
    X,
    /// Y.
    Y,
}

/// A measured hole.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
pub struct Reference {
    /// Its position in the file, mm.
    pub file_mm: [f64; 2],
    /// Its position on the table, mm.
    pub measured_mm: [f64; 2],
}

/// A hole.
#[derive(Clone, Debug, PartialEq)]
pub struct Hole {
    /// Index of its part.
    pub part: usize,
    /// Steps of X and Y from zero.
    pub at: [u16; 2],
    /// Depths of its drillings, steps below the upper sensor; 0 is the full stroke.
    pub depths: Vec<u16>,
    /// Its position in the drill file, nm.
    pub file_nm: Option<[i64; 2]>,
    /// Estimated time of the move and of the drillings, s.
    pub seconds: f64,
}

/// A program, hole by hole.
#[derive(Debug, Default)]
pub struct DrillProgram {
    /// How it was placed.
    pub placing: Placing,
    /// Its tools with their records.
    pub parts: Vec<Part>,
    /// Its holes, in their order.
    pub holes: Vec<Hole>,
    /// The fit to the measured holes.
    pub fit: Option<Fit>,
    /// Whether it is a drill file, which can be placed.
    pub is_drill_file: bool,
    /// Steps of travel in the order of the file, if the order was changed.
    pub file_travel_steps: Option<u64>,
    /// Estimated time of the move home after each part, s.
    backs_s: Vec<f64>,
    /// Estimated time without the changes of tools, s.
    total_s: f64,
}

impl DrillProgram {
    /// Reads and places a program. `findings` gets its errors.
    ///
    /// # Errors
    ///
    /// A sentence: it cannot be placed like this.
    pub fn read(
        name: &str,
        text: &[u8],
        placing: &Placing,
        findings: &mut Findings,
    ) -> Result<Self, String> {
        let has_header = text.trim_ascii_start().starts_with(b"M48");
        let is_drill_file = placing.tango || has_header || is_drill_file(None, name);
        let mut program = Self {
            placing: placing.clone(),
            is_drill_file,
            ..Self::default()
        };
        if is_drill_file {
            program.read_board(name, text, findings)?;
        } else if *placing != Placing::default() {
            return Err("only a drill file can be placed: this program has its positions".into());
        } else {
            let translation = Translation {
                dialect: Dialect::DRILL,
                table: Table::DRILL,
                home_height: Nm(0),
            };
            let mut source = Source::from_reader(Box::new(Cursor::new(text.to_vec())));
            let parts = translation.read(&mut source, name, findings);
            program.parts = parts.map_err(|error| error.to_string())?;
            program.divide(&HashMap::new());
        }
        if findings.errors > 0 {
            // A part of a program is no program.
            program.holes.clear();
        } else if program.holes.is_empty() {
            let message = "the program drills no hole";
            findings.add(Finding::general(Severity::Error, "E0401", message));
        }
        Ok(program)
    }

    /// Reads a drill file.
    fn read_board(
        &mut self,
        name: &str,
        text: &[u8],
        findings: &mut Findings,
    ) -> Result<(), String> {
        let placing = self.placing.clone();
        let mut setup = Setup::default();
        if placing.tango {
            setup.overrides = Overrides {
                profile: Profile::Tango,
                ..Overrides::default()
            };
        }
        let mut board = read_board(text, name, &setup, findings);
        if findings.errors > 0 {
            return Ok(());
        }
        if !placing.only.is_empty() {
            let kept = board.keep_only(&placing.only);
            kept.map_err(|tool| format!("the file makes nothing with tool {tool}"))?;
        }
        let in_file: Vec<_> = board.holes.iter().map(|hole| hole.at_nm).collect();
        let placed = placement(&placing)?.apply(&mut board);
        self.fit = placed.map_err(|error| error.to_string())?;
        let places: HashMap<_, _> = (board.holes.iter().zip(in_file))
            .filter_map(|(hole, file_nm)| {
                let at = Table::DRILL.steps(hole.at_nm).ok()?;
                Some(((u32::from(hole.tool.number), at), file_nm))
            })
            .collect();
        self.parts = parts(&board, name, findings)?;
        if placing.shortest && findings.errors == 0 {
            self.file_travel_steps = Some(self.parts.iter().map(travel_steps).sum());
            board.sort_shortest(Metric::AxisByAxis);
            self.parts = parts(&board, name, findings)?;
        }
        self.divide(&places);
        Ok(())
    }

    /// Divides the parts into holes. `places` has positions in the file by tool and steps.
    fn divide(&mut self, places: &HashMap<(u32, [u16; 2]), [i64; 2]>) {
        for (number, part) in self.parts.iter().enumerate() {
            let times = seconds(part, [0; 2]);
            let drillings = part.stops().zip(times).zip(part.pecks());
            for ((stop, seconds), is_peck) in drillings {
                match self.holes.last_mut().filter(|_| is_peck) {
                    Some(hole) => {
                        hole.depths.push(stop.depth);
                        hole.seconds += seconds;
                    }
                    None => self.holes.push(Hole {
                        part: number,
                        at: stop.at,
                        depths: vec![stop.depth],
                        file_nm: places.get(&(part.tool, stop.at)).copied(),
                        seconds,
                    }),
                }
            }
            let last = part.stops().last().map_or([0; 2], |stop| stop.at);
            self.backs_s.push(travel_s(last, [0; 2]));
        }
        let drilled: f64 = self.holes.iter().map(|hole| hole.seconds).sum();
        self.total_s = drilled + self.backs_s.iter().sum::<f64>();
    }

    /// Estimated time of the move home after the last hole of a part, s.
    pub fn back_s(&self, part: usize) -> f64 {
        self.backs_s.get(part).copied().unwrap_or(0.0)
    }

    /// Estimated time without the changes of tools, s.
    pub const fn total_s(&self) -> f64 {
        self.total_s
    }

    /// A hole as text, such as `X10.000 Y5.000, T1 (0.8 mm)`.
    pub fn text(&self, hole: &Hole) -> String {
        let [x, y] = hole.at.map(millimetres);
        let tool = self.parts.get(hole.part).filter(|part| part.tool > 0);
        let tool = tool.map_or(String::new(), |part| format!(", {}", part.name()));
        format!("X{x:.3} Y{y:.3}{tool}")
    }

    /// The board view of the page.
    pub fn board(&self) -> Value {
        let travel: u64 = self.parts.iter().map(travel_steps).sum();
        let tools = self.parts.iter().map(|part| {
            json!({
                "tool": part.tool,
                "diameter_mm": part.diameter.map(|nm| nm.0 as f64 / 1e6),
                "holes": part.holes(),
            })
        });
        let shown = match self.holes.len() {
            ..=MOST_SHOWN => &self.holes[..],
            _ => &[],
        };
        let holes = shown.iter().map(|hole| {
            let [x, y] = hole.at.map(millimetres);
            let file = hole.file_nm.map(|at| at.map(|nm| nm as f64 / 1e6));
            json!({"at_mm": [x, y], "part": hole.part, "file_mm": file})
        });
        let fit = self.fit.map(|fit| {
            json!({
                "turn_degrees": fit.turn_degrees,
                "scale_ppm": fit.scale_ppm,
                "skew_ppm": fit.skew_ppm,
                "residual_mm": fit.residual_nm / 1e6,
            })
        });
        json!({
            "is_drill_file": self.is_drill_file,
            "placing": self.placing,
            "tools": tools.collect::<Vec<_>>(),
            "holes": holes.collect::<Vec<_>>(),
            "fit": fit,
            "travel_mm": travel as f64 / f64::from(STEPS_PER_MM),
            "time_s": self.total_s(),
        })
    }
}

/// A position in mm.
pub fn millimetres(steps: u16) -> f64 {
    husillo_clients::drill::millimetres(steps).0 as f64 / 1e6
}

fn placement(placing: &Placing) -> Result<Placement, String> {
    let nm = |mm: f64| mm * 1e6;
    let numbers = placing.references.iter();
    let mut numbers = numbers.flat_map(|one| one.file_mm.into_iter().chain(one.measured_mm));
    let is_possible = |mm: f64| mm.is_finite() && mm.abs() <= 1000.0;
    if !(-360.0..=360.0).contains(&placing.turn_degrees) || !numbers.all(is_possible) {
        return Err("a position or an angle is out of range".into());
    }
    if placing.stretch && placing.references.is_empty() {
        return Err("scale and skew need measured holes".into());
    }
    let reference = |one: &Reference| [one.file_mm.map(nm), one.measured_mm.map(nm)];
    Ok(Placement {
        mirror: placing.mirror.map(|mirror| match mirror {
            Mirror::X => husillo_holes::Mirror::X,
            Mirror::Y => husillo_holes::Mirror::Y,
        }),
        turn_degrees: placing.turn_degrees,
        references: placing.references.iter().map(reference).collect(),
        stretches: placing.stretch,
        shift: placing.corner.then_some(Shift::Corner),
    })
}

/// The records of each tool. Holes off the table are an error of the program.
fn parts(board: &Board, name: &str, findings: &mut Findings) -> Result<Vec<Part>, String> {
    let tools = match records(board, Table::DRILL, SlotHandling::Drill) {
        Ok(tools) => tools,
        Err(RecordsError::Slots(error)) => return Err(error.to_string()),
        Err(error @ RecordsError::OffTable { .. }) => {
            let message = format!("{name}: {error}");
            let finding = Finding::general(Severity::Error, "E0401", message);
            findings.add(finding.help("put the corner of the board at 0, turn it, or move it"));
            return Ok(Vec::new());
        }
    };
    let part = |tool: husillo_holes::ToolRecords| Part {
        tool: tool.tool.number.into(),
        diameter: tool.tool.diameter_nm.map(Nm),
        records: lean(&tool.records),
    };
    Ok(tools.into_iter().map(part).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOARD: &str = "M48\nMETRIC,TZ\nT1C0.8\nT2C1.0\n%\nT1\nX10.0Y10.0\nX60.0Y10.0\nT2\n\
                         X10.0Y30.0\nM30\n";

    fn read(name: &str, text: &str, placing: &Placing) -> (DrillProgram, u64) {
        let mut findings = Findings::new(100);
        let read = DrillProgram::read(name, text.as_bytes(), placing, &mut findings);
        (read.unwrap(), findings.errors)
    }

    #[test]
    fn a_board_is_placed_on_measured_holes() {
        let reference = |file_mm, measured_mm| Reference {
            file_mm,
            measured_mm,
        };
        let placing = Placing {
            references: vec![
                reference([10.0, 10.0], [20.0, 5.0]),
                reference([60.0, 10.0], [70.0, 5.0]),
            ],
            ..Placing::default()
        };
        let (program, errors) = read("board.drl", BOARD, &placing);
        assert_eq!(errors, 0);
        let first = &program.holes[0];
        assert_eq!(
            (first.at, first.file_nm),
            ([2140, 535], Some([10_000_000; 2]))
        );
        assert_eq!(program.holes[2].part, 1);
        assert!(program.fit.unwrap().residual_nm < 1.0);
        assert_eq!(program.text(first), "X20.000 Y5.000, T1 (0.8 mm)");
    }

    #[test]
    fn a_program_of_the_drill_has_holes_and_errors_with_places() {
        let (program, errors) = read(
            "part.txt",
            "%\nG21\nG90\nX10 Y5\nX20\n%\n",
            &Placing::default(),
        );
        assert_eq!((errors, program.holes.len()), (0, 2));
        assert_eq!(program.holes[1].at, [2140, 535]);
        assert!(program.total_s() > 40.0);
        let (program, errors) = read("part.txt", "%\nG21\nX300\n%\n", &Placing::default());
        assert!(errors > 0 && program.holes.is_empty());
    }

    #[test]
    fn what_is_off_the_table_or_empty_is_an_error() {
        let far = BOARD.replace("Y30.0", "Y50.0");
        assert_eq!(read("board.drl", &far, &Placing::default()).1, 1);
        assert_eq!(read("part.txt", "%\nG21\n%\n", &Placing::default()).1, 1);
    }
}

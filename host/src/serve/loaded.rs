//! A program that a page has loaded: its findings, its lines, and its times.

use super::controller_machine::machine;
use super::drill_program::{DrillProgram, Placing};
use super::figure_program::{self, Factory};
use super::mill_program;
use super::timetable::Timetable;
use super::tool_changes::{ToolChange, ToolChanges};
use crate::app::{report, sendable_lines};
use crate::microfactory::is_list;
use husillo_gcode::{Dialect, Nm};
use husillo_reports::board::{self, Board};
use husillo_reports::operation::{self, Operation};
use husillo_sim::observers::AXES;
use husillo_simulator::diagnostics::{Finding, Findings};
use husillo_simulator::job::{Job, JobError, Options, Results, Text};
use husillo_simulator::machines::machine_file::MachineFile;
use husillo_simulator::programs::check::Facts;
use husillo_simulator::programs::program::Start;
use husillo_simulator::scene::Scene;
use husillo_transports::drill::Table;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::sync::Arc;

/// A drill is not simulated with the steps of a program.
const NO_DRILL: &str = "a program of the drill has holes, and no lines";
/// Findings that a page gets.
const FINDINGS: u64 = 200;
/// A program with more step events has no times and no picture: its simulation would take minutes.
const MOST_EVENTS: f64 = 2e8;

/// The controller that a program is for.
#[derive(Clone, Debug)]
pub enum Target {
    /// Grbl, with its settings.
    Grbl(BTreeMap<u16, String>),
    /// The micro mill.
    Micromill(Arc<MachineFile>),
    /// The circuit-board drill.
    Drill,
    /// The microfactory.
    Microfactory(Arc<Factory>),
}

impl Target {
    /// Whether a program that was checked for another one may be run on this one.
    fn is(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Grbl(ours), Self::Grbl(others)) => ours == others,
            (Self::Micromill(ours), Self::Micromill(others)) => Arc::ptr_eq(ours, others),
            (Self::Microfactory(ours), Self::Microfactory(others)) => Arc::ptr_eq(ours, others),
            (Self::Drill, Self::Drill) => true,
            _ => false,
        }
    }
}

/// What a program is checked against.
#[derive(Clone, Debug)]
pub struct Surroundings {
    /// The controller.
    pub target: Target,
    /// Work zero in machine coordinates, mm. Empty: it is not known.
    pub zero_mm: Vec<f64>,
    /// Position in machine coordinates, mm.
    pub at_mm: Vec<f64>,
}

impl Surroundings {
    /// Whether a program that was checked in others may be run in these: on the same machine and
    /// with the same work zero, as far as it is known. It may begin at any position.
    pub fn are_those_of(&self, others: &Self) -> bool {
        let is_known = !self.zero_mm.is_empty() && !others.zero_mm.is_empty();
        self.target.is(&others.target) && (!is_known || self.zero_mm == others.zero_mm)
    }

    /// Whether the controller has told all that it tells.
    pub fn are_complete(&self) -> bool {
        match &self.target {
            Target::Grbl(settings) => !self.zero_mm.is_empty() && !settings.is_empty(),
            // Before it is homed, a mill does not know where it is.
            Target::Micromill(_) | Target::Drill | Target::Microfactory(_) => true,
        }
    }
}

/// A program.
#[derive(Debug)]
pub struct Loaded {
    /// Its name.
    pub name: String,
    /// Its text.
    pub text: Vec<u8>,
    /// Its text without the codes that ask for other tools; `None`: it has none.
    plain: Option<Vec<u8>>,
    /// The changes of tools, which this program makes with the operator.
    pub changes: Vec<ToolChange>,
    /// What it was checked against.
    pub around: Surroundings,
    /// The lines that the controller gets, with their numbers.
    pub lines: Arc<[(usize, String)]>,
    /// How it begins.
    pub start: Start,
    /// Lines of the text.
    pub count: usize,
    /// Errors. With errors it is not run.
    pub errors: u64,
    /// Warnings.
    pub warnings: u64,
    /// When the lines are made; `None` if that is not known.
    pub times: Option<Timetable>,
    /// The text of the scene for the viewer: its element, as in a report.
    pub scene: Option<String>,
    /// What the page that has loaded it is told.
    pub report: Value,
    /// The line with which it goes on, if it was interrupted before.
    pub resume_line: Option<usize>,
    /// Its holes, if it is for the drill. They are what others call lines.
    pub holes: Option<DrillProgram>,
    /// Its moves in steps of X and Z, if it is for the microfactory. They are what others call
    /// lines.
    pub figure: Option<Vec<[i16; 2]>>,
}

impl Loaded {
    /// Checks and simulates a program.
    ///
    /// # Errors
    ///
    /// A sentence: the program cannot be sent, or the settings have no sense.
    pub fn new(name: &str, text: Vec<u8>, around: &Surroundings) -> Result<Self, String> {
        match &around.target {
            Target::Drill => return Self::of_drill(name, text, around, &Placing::default()),
            Target::Microfactory(factory) => {
                return Self::of_figure(name, text, around, factory);
            }
            Target::Grbl(_) | Target::Micromill(_) => {}
        }
        let changes = match &around.target {
            Target::Grbl(_) => ToolChanges::of(&text),
            _ => ToolChanges::default(),
        };
        let code = changes.text.as_deref().unwrap_or(&text);
        let mut job = job(name, code, around)?;
        let mut findings = Findings::new(FINDINGS);
        let mut facts = job.check(&mut findings).map_err(said)?;
        let (lines, further) = match &around.target {
            Target::Grbl(_) => (sendable_lines(code)?, Vec::new()),
            Target::Micromill(_) => mill_program::strings(&job)?,
            Target::Drill | Target::Microfactory(_) => (Vec::new(), Vec::new()),
        };
        let of = |severity: &str| {
            further
                .iter()
                .filter(|one| one["severity"] == severity)
                .count()
        };
        let (mut errors, warnings) = (of("error") as u64, of("warning") as u64);
        errors += findings.errors;
        let (mut times, mut scene) = (None, None);
        if errors == 0 {
            (times, scene) = simulated(&mut job, &mut facts, &findings)?;
        }
        let count = text.split(|byte| *byte == b'\n').count();
        let warnings = findings.warnings + warnings;
        let listed: Vec<_> = findings
            .kept()
            .iter()
            .map(described)
            .chain(further)
            .collect();
        let report = json!({
            "name": name,
            "lines": count,
            "errors": errors,
            "warnings": warnings,
            "is_complete": findings.hidden() == 0,
            "findings": listed,
            "time_s": times.as_ref().map(Timetable::total_s),
        });
        Ok(Self {
            name: name.to_owned(),
            text,
            plain: changes.text,
            changes: changes.all,
            lines: lines.into(),
            start: job.start,
            around: around.clone(),
            count,
            errors,
            warnings,
            times,
            scene,
            report,
            resume_line: None,
            holes: None,
            figure: None,
        })
    }

    /// Checks and simulates a figure of the microfactory.
    fn of_figure(
        name: &str,
        text: Vec<u8>,
        around: &Surroundings,
        factory: &Factory,
    ) -> Result<Self, String> {
        let mut findings = Findings::new(FINDINGS);
        let (mut moves, mut times, mut scene) = (Vec::new(), None, None);
        let mut start = Dialect::RS274.into();
        match figure_program::as_program(name, &text, factory) {
            Err(wrong) => findings.add(*wrong),
            Ok(program) => {
                let mut job = job(name, &text, around)?;
                start = job.start;
                let mut facts = job.check(&mut findings).map_err(said)?;
                if findings.errors == 0 {
                    moves = figure_program::moves(&job, &program, factory, &mut findings)?;
                }
                if findings.errors == 0 {
                    (times, scene) = simulated(&mut job, &mut facts, &findings)?;
                }
            }
        }
        let mut listed: Vec<_> = findings.kept().iter().map(described).collect();
        if is_list(name) && !moves.is_empty() {
            // They are about the program that was made of the list.
            for one in &mut listed {
                (one["line"], one["column"], one["fixes"]) = (json!(0), json!(0), json!([]));
            }
        }
        let report = json!({
            "name": name,
            "lines": moves.len(),
            "errors": findings.errors,
            "warnings": findings.warnings,
            "is_complete": findings.hidden() == 0,
            "findings": listed,
            "time_s": times.as_ref().map(Timetable::total_s),
        });
        let lines = moves.iter();
        let lines = lines.map(|(line, way)| (*line, figure_program::text(*way)));
        Ok(Self {
            name: name.to_owned(),
            text,
            plain: None,
            changes: Vec::new(),
            around: around.clone(),
            lines: lines.collect(),
            start,
            count: moves.len(),
            errors: findings.errors,
            warnings: findings.warnings,
            times,
            scene,
            report,
            resume_line: None,
            holes: None,
            figure: Some(moves.into_iter().map(|(_, way)| way).collect()),
        })
    }

    /// Checks and places a program of the drill.
    ///
    /// # Errors
    ///
    /// A sentence: it cannot be read, or not be placed like this.
    pub fn of_drill(
        name: &str,
        text: Vec<u8>,
        around: &Surroundings,
        placing: &Placing,
    ) -> Result<Self, String> {
        let mut findings = Findings::new(FINDINGS);
        let holes = DrillProgram::read(name, &text, placing, &mut findings)?;
        let time_s = (findings.errors == 0).then(|| holes.total_s());
        let listed: Vec<_> = findings.kept().iter().map(described).collect();
        let report = json!({
            "name": name,
            "lines": holes.holes.len(),
            "errors": findings.errors,
            "warnings": findings.warnings,
            "is_complete": findings.hidden() == 0,
            "findings": listed,
            "time_s": time_s,
            "has_scene": false,
        });
        let lines = holes.holes.iter().map(|hole| holes.text(hole));
        Ok(Self {
            name: name.to_owned(),
            lines: (1..).zip(lines).collect(),
            start: Dialect::DRILL.into(),
            around: around.clone(),
            count: holes.holes.len(),
            errors: findings.errors,
            warnings: findings.warnings,
            times: None,
            scene: None,
            report,
            resume_line: None,
            holes: Some(holes),
            figure: None,
            text,
            plain: None,
            changes: Vec::new(),
        })
    }

    /// What is checked and sent of its text.
    pub fn code(&self) -> &[u8] {
        self.plain.as_deref().unwrap_or(&self.text)
    }

    /// The report of a simulated run, as `husillo run` writes it, with what became of the program
    /// on the machine. It simulates the program once more: that takes less than to keep it.
    ///
    /// # Errors
    ///
    /// A sentence: the simulation is not possible.
    pub fn page(&self, operation: Operation) -> Result<String, String> {
        if let Some(holes) = &self.holes {
            return Ok(board::html(&Board {
                name: &self.name,
                parts: &holes.parts,
                table: Table::DRILL,
                file_travel_steps: holes.file_travel_steps,
                operation: Some(&operation),
            }));
        }
        let mut job = job(&self.name, self.code(), &self.around)?;
        if self.times.is_none() {
            let title = &job.machine.title;
            return Ok(operation::html(&self.name, title, &operation));
        }
        let mut findings = Findings::new(FINDINGS);
        let mut facts = job.check(&mut findings).map_err(said)?;
        let simulated = job.simulate(&mut facts, Options::default(), || {});
        let simulated = simulated.map_err(said)?;
        let results = Results {
            warnings: findings.warnings,
            ..simulated.results(&job, &facts)
        };
        let run = &simulated.run;
        let take_up_s = run
            .mechanics
            .in_seconds(run.observers.statistics.take_up_ticks);
        let figures = report::figures(&results, &facts, Some(take_up_s));
        let scene = Scene::of(&job, &simulated, &facts, &findings).map_err(said)?;
        let (warnings, scene) = (findings.short(), scene.element());
        let mut page = report::made(&job, &simulated, &results, figures, warnings, scene);
        page.operation = Some(operation);
        Ok(husillo_reports::run::html(&page))
    }
}

/// The times and the scene of a program without errors, if it is short enough.
fn simulated(
    job: &mut Job,
    facts: &mut Facts,
    findings: &Findings,
) -> Result<(Option<Timetable>, Option<String>), String> {
    if facts.events > MOST_EVENTS {
        return Ok((None, None));
    }
    let simulated = job.simulate(facts, Options::default(), || {});
    let simulated = simulated.map_err(said)?;
    let moves = &simulated.run.observers.recording.moves;
    let of_moves = facts.origins.lines(moves.iter().map(|one| &one.to));
    let total_s = simulated.run.mechanics.seconds();
    let times = Timetable::new(moves, &of_moves, job.machine.timer_hz, total_s);
    let scene = Scene::of(job, &simulated, facts, findings).map_err(said)?;
    Ok((Some(times), Some(scene.text())))
}

pub fn said(error: JobError) -> String {
    error.to_string()
}

/// A program on the machine of its controller.
pub fn job(name: &str, text: &[u8], around: &Surroundings) -> Result<Job, String> {
    let text = match &around.target {
        Target::Microfactory(factory) => {
            let program = figure_program::as_program(name, text, factory);
            Text::new(name, program.map_err(|wrong| wrong.message)?)
        }
        _ => Text::new(name, text),
    };
    let mut job = match &around.target {
        Target::Grbl(settings) => Job::new(text, machine(settings)?, Some("grbl")),
        // The name of the program tells its language.
        Target::Micromill(file) => Job::new(text, MachineFile::clone(file), None),
        Target::Microfactory(factory) => Job::new(text, factory.file.clone(), None),
        Target::Drill => return Err(NO_DRILL.into()),
    }
    .map_err(said)?;
    job.stand(in_nm(&around.zero_mm), in_nm(&around.at_mm));
    let is_known = !around.zero_mm.is_empty();
    if let (Target::Micromill(_), false) = (&around.target, is_known) {
        // Where its limits are is known after homing. It is checked again when it starts.
        for axis in &mut job.config.axes {
            axis.travel = None;
        }
    }
    Ok(job)
}

/// Lengths in nm.
pub fn in_nm(mm: &[f64]) -> [Nm; AXES] {
    let mut nm = [Nm(0); AXES];
    for (slot, mm) in nm.iter_mut().zip(mm) {
        *slot = Nm((mm * 1e6).round() as i64);
    }
    nm
}

/// A finding, as a page gets it.
pub fn described(finding: &Finding) -> Value {
    let (line, column) = finding.line_and_column();
    let whole = serde_json::to_value(finding).unwrap_or_default();
    let fixes = whole["fixes"].as_array().into_iter().flatten();
    let fixes = fixes.map(|fix| {
        json!({
            "line": fix["line"],
            "column": fix["column"],
            "end_column": fix["end"],
            "text": fix["text"],
        })
    });
    json!({
        "code": finding.code,
        "severity": finding.severity.name(),
        "line": line,
        "column": column,
        "message": finding.message,
        "notes": finding.notes,
        "help": finding.help,
        "fixes": fixes.collect::<Vec<_>>(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn loaded(text: &str) -> Loaded {
        let settings = [(100, "400"), (101, "400"), (102, "400"), (110, "6000")];
        let settings = settings.map(|(number, value)| (number, value.to_owned()));
        let around = Surroundings {
            target: Target::Grbl(settings.into()),
            zero_mm: vec![0.0; 3],
            at_mm: vec![0.0; 3],
        };
        Loaded::new("part.nc", text.as_bytes().to_vec(), &around).unwrap()
    }

    #[test]
    fn a_program_has_lines_and_times() {
        let loaded = loaded("%\nG21 G90\n(a comment)\nG1 X10 F600\nG4 P2\nM2\n");
        assert_eq!(loaded.errors, 0);
        let numbers: Vec<_> = loaded.lines.iter().map(|(number, _)| *number).collect();
        assert_eq!(numbers, [2, 4, 5, 6]);
        // 10 mm at 10 mm/s with ramps of 10 mm/s^2, and 2 s.
        let time = loaded.times.unwrap().total_s();
        assert!((3.9..4.1).contains(&time), "{time}");
    }

    #[test]
    fn errors_have_lines_and_columns() {
        let loaded = loaded("G21 G90\nG2 X1 Y1 F100\n");
        assert_eq!((loaded.errors, loaded.times.is_none()), (1, true));
        let finding = &loaded.report["findings"][0];
        assert_eq!(finding["code"], "E0301");
        assert_eq!(
            (&finding["line"], &finding["column"]),
            (&json!(2), &json!(1))
        );
    }
}

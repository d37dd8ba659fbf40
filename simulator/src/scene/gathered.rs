//! The scene of a simulated job.

use super::{Axis, Finding, Header, Machine, Program, Scene};
use crate::diagnostics::{self, Findings};
use crate::job::{Job, JobError, Simulated};
use crate::machines::machine_file::Travel;
use crate::programs::check::Facts;
use husillo_sim::observers::AXES;

/// The text of a program in a scene is cut off here, bytes.
const MOST_TEXT: usize = 32_000_000;

impl<'a> Scene<'a> {
    /// What a run has recorded, with the text of its program.
    ///
    /// # Errors
    ///
    /// The program cannot be read again.
    pub fn of(
        job: &Job,
        simulated: &'a Simulated,
        facts: &Facts,
        findings: &Findings,
    ) -> Result<Self, JobError> {
        let observers = &simulated.run.observers;
        let recording = &observers.recording;
        Ok(Self {
            header: Header {
                program: Program {
                    name: job.name().to_owned(),
                    text: String::from_utf8_lossy(&job.head(MOST_TEXT)?).into_owned(),
                },
                machine: machine(job, simulated.offset_nm),
                tool_diameter_nm: job.machine.tools.first().and_then(|(_, tool)| {
                    let nm = u64::try_from(tool.radius.0).ok()?;
                    (nm > 0).then_some(2 * nm)
                }),
                findings: findings.kept().iter().map(finding).collect(),
                ticks_per_second: job.machine.timer_hz,
            },
            lines: facts.origins.lines(recording.moves.iter().map(|of| &of.to)),
            recording,
            deviation: &observers.deviation,
            speed: &observers.speed,
        })
    }
}

fn machine(job: &Job, offset_nm: [i64; AXES]) -> Machine {
    let axes = job.machine.axes.iter().zip(offset_nm);
    Machine {
        name: job.machine.name.clone(),
        title: job.machine.title.clone(),
        view: job.machine.view,
        axes: axes
            .map(|(axis, zero_nm)| Axis {
                letter: char::from(axis.letter),
                step_nm: axis.step.num as f64 / axis.step.den as f64,
                travel_nm: match axis.travel {
                    Travel::Range(range) => Some(range),
                    Travel::Unknown | Travel::Unlimited => None,
                },
                zero_nm,
            })
            .collect(),
    }
}

fn finding(of: &diagnostics::Finding) -> Finding {
    let (line, column) = of.line_and_column();
    Finding {
        code: of.code.clone(),
        severity: of.severity.name().to_owned(),
        message: of.message.clone(),
        help: of.help.clone(),
        line,
        column,
    }
}

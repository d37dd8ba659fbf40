//! The contents of the report of a run.

use super::results::Results;
use crate::app::Failure;
use crate::app::job::Job;
use husillo_reports::run::{AxisRow, Report};
use husillo_reports::scene::{self, Header, Scene};
use husillo_reports::text::duration;
use husillo_reports::text::length;
use husillo_sim::observers::AXES;
use husillo_sim::text::grouped;
use husillo_simulator::diagnostics::{Finding, Findings};
use husillo_simulator::machines::machine_file::Travel;
use husillo_simulator::programs::check::Facts;
use husillo_simulator::simulation::run::Run;

/// The table of figures. It has no time of take-ups if the backlash is not compensated.
pub fn figures(
    results: &Results,
    facts: &Facts,
    take_up_s: Option<f64>,
) -> Vec<(&'static str, String)> {
    vec![
        ("time", duration(results.duration_s)),
        ("step events", grouped(results.events)),
        ("feed path", length(facts.feed_nm)),
        ("rapid path", length(facts.rapid_nm)),
        ("largest deviation", length(results.max_deviation_nm)),
        ("RMS deviation", length(results.rms_deviation_nm)),
        (
            "reversals",
            results.reversals.iter().sum::<u64>().to_string(),
        ),
        (
            "backlash",
            match take_up_s {
                Some(seconds) => format!("taken up in {}", duration(seconds)),
                None => "not compensated".to_owned(),
            },
        ),
        ("lost steps", results.lost_steps.to_string()),
    ]
}

/// The text of a program in a scene is cut off here, bytes.
const MOST_TEXT: usize = 32_000_000;

/// The element of the scene of a run.
///
/// # Errors
///
/// The program cannot be read again.
pub fn scene(
    job: &Job,
    run: &Run,
    facts: &Facts,
    offset_nm: [i64; AXES],
    findings: &Findings,
) -> Result<String, Failure> {
    let recording = &run.observers.recording;
    let scene = Scene {
        header: Header {
            program: scene::Program {
                name: job.name().to_owned(),
                text: String::from_utf8_lossy(&job.head(MOST_TEXT)?).into_owned(),
            },
            machine: machine(job, offset_nm),
            tool_diameter_nm: job.machine.tools.first().and_then(|(_, tool)| {
                let nm = u64::try_from(tool.radius.0).ok()?;
                (nm > 0).then_some(2 * nm)
            }),
            findings: findings.kept().iter().map(finding).collect(),
            ticks_per_second: job.machine.timer_hz,
        },
        lines: facts.origins.lines(recording.moves.iter().map(|of| &of.to)),
        recording,
        deviation: &run.observers.deviation,
        speed: &run.observers.speed,
    };
    Ok(scene.element())
}

fn machine(job: &Job, offset_nm: [i64; AXES]) -> scene::Machine {
    let axes = job.machine.axes.iter().zip(offset_nm);
    scene::Machine {
        name: job.machine.name.clone(),
        title: job.machine.title.clone(),
        view: job.machine.view,
        axes: axes
            .map(|(axis, zero_nm)| scene::Axis {
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

fn finding(of: &Finding) -> scene::Finding {
    let (line, column) = of.line_and_column();
    scene::Finding {
        code: of.code.clone(),
        severity: of.severity.name().to_owned(),
        message: of.message.clone(),
        help: of.help.clone(),
        line,
        column,
    }
}

/// The report of a run with its work zero at `offset_nm` of the machine; the warnings of the
/// check, one line each.
pub fn made(
    job: &Job,
    run: &Run,
    results: &Results,
    figures: Vec<(&'static str, String)>,
    offset_nm: [i64; AXES],
    warnings: Vec<String>,
    scene: String,
) -> Report {
    let travel = |axis: usize| match job.machine.axes[axis].travel {
        Travel::Range(range) => Some(range.map(|at| (at - offset_nm[axis]) as f64)),
        Travel::Unknown | Travel::Unlimited => None,
    };
    let lost = run.mechanics.losses().lost();
    let axes = (0..job.machine.axes.len())
        .map(|axis| AxisRow {
            letter: char::from(job.machine.axes[axis].letter),
            extent_nm: [results.min_nm[axis] as f64, results.max_nm[axis] as f64],
            travel_nm: travel(axis),
            end_nm: results.end_nm[axis] as f64,
            reversals: results.reversals[axis],
            lost_steps: lost[axis],
        })
        .collect();
    let machine_frame = |axis: usize| match job.machine.axes[axis].travel {
        Travel::Range(range) => Some(range.map(|at| at as f64)),
        Travel::Unknown | Travel::Unlimited => None,
    };
    let [right, up] = job.machine.view;
    let area = machine_frame(right)
        .zip(machine_frame(up))
        .map(|([x0, x1], [y0, y1])| [[x0, y0], [x1, y1]]);
    Report {
        program: job.name().to_owned(),
        machine: job.machine.title.clone(),
        figures,
        axes,
        phases: run.observers.phases.motors().to_vec(),
        drawing: run.observers.picture.drawing.clone(),
        ideal: run.observers.picture.ideal.clone(),
        ideal_is_whole: run.observers.picture.ideal_is_whole,
        area,
        view: job
            .machine
            .view
            .map(|axis| char::from(job.machine.axes[axis].letter)),
        largest_nm: results.max_deviation_nm,
        speed: run.observers.speed.clone(),
        has_ramps: job
            .machine
            .axes
            .iter()
            .any(|axis| axis.acceleration.is_some()),
        warnings,
        scene,
    }
}

//! The contents of the report of a run.

use husillo_reports::run::{AxisRow, Report};
use husillo_reports::text::duration;
use husillo_reports::text::length;
use husillo_sim::text::grouped;
use husillo_simulator::job::{Job, Results, Simulated};
use husillo_simulator::machines::machine_file::Travel;
use husillo_simulator::programs::check::Facts;

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

/// The report of a run; the warnings of the check, one line each.
pub fn made(
    job: &Job,
    simulated: &Simulated,
    results: &Results,
    figures: Vec<(&'static str, String)>,
    warnings: Vec<String>,
    scene: String,
) -> Report {
    let (run, offset_nm) = (&simulated.run, simulated.offset_nm);
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
        operation: None,
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

//! `husillo compare motion`.

use super::page;
use crate::app::job::Job;
use crate::app::reporting::{verdict, with_findings};
use crate::app::{ERRORS, Failure, OK};
use crate::cli::{Compare, Page};
use crate::console;
use crate::output::Outputs;
use husillo_machine::Config;
use husillo_methods::motion::{Course, Figures, Settings, compare as compared};
use husillo_reports::motion::{self, Motion};
use husillo_sim::observers::AXES;
use husillo_simulator::diagnostics::Findings;
use husillo_simulator::programs::program::{self, Meaning};
use husillo_simulator::text::json::write_line;
use serde_json::json;
use std::io::{self, Write};

/// Compares the rules of motion for a program.
pub(super) fn compare(args: &Compare) -> Result<u8, Failure> {
    let usage = |why: String| Failure::Usage(format!("compare motion: {why}"));
    let file = args.file.as_ref();
    let file = file.ok_or_else(|| usage("which program? motion FILE".to_owned()))?;
    let mut job = Job::new(file, &args.target, "free")?;
    job.keep_input()?;
    if job.config.axes.iter().all(|axis| axis.ramp.is_none()) {
        return Err(usage(
            "the machine has no ramps, so its speed jumps".to_owned(),
        ));
    }
    let (own, mut settings) = (window_of(&job.config), Settings::default());
    match args.window {
        Some(window) if window > 0.0 => settings.window = Some(window / 1000.0),
        Some(window) => return Err(usage(format!("--window {window} is not above 0"))),
        // The jerk of the machine file.
        None if own.is_some() => settings.window = None,
        None => {}
    }
    let milliseconds = settings.window.or(own).unwrap_or(0.0) * 1000.0;
    let Some(course) = course(&job)? else {
        return Ok(ERRORS);
    };
    if course.is_empty() {
        return Err(usage(format!("{file}: no move")));
    }
    let rules = compared(&course, &settings)
        .map_err(|why| usage(format!("a window of {milliseconds:.1} ms: {why}")))?;
    let mut notes = vec![format!(
        "The window of limited jerk is {milliseconds:.1} ms."
    )];
    if course.left_out > 0 {
        let count = course.left_out;
        notes.push(format!("{count} splines, threads or taps count as lines."));
    }
    let motion = Motion {
        title: format!(
            "{} on {}: {} moves",
            job.name(),
            job.machine.title,
            course.len()
        ),
        rules,
        notes,
    };
    let mut outputs = Outputs::new();
    let mut out: Box<dyn Write> = match &args.output {
        Some(path) => Box::new(outputs.create(path)?),
        None => Box::new(console::stdout()),
    };
    print(&motion, page(args), &mut out)?;
    outputs.finish()?;
    Ok(OK)
}

/// The time from no acceleration to the full one in s, of a machine with a jerk.
fn window_of(config: &Config<AXES>) -> Option<f64> {
    let limits = config.jerk_limits()?;
    Some(limits.acceleration_nm_per_s2 as f64 / limits.jerk_nm_per_s3 as f64)
}

/// The moves of a program; `None` if it has errors.
fn course(job: &Job) -> Result<Option<Course<AXES>>, Failure> {
    let course = Course::new(job.config, job.start.at);
    let mut course = course.map_err(|why| Failure::Usage(format!("start: {why}")))?;
    let mut source = job.open()?;
    let (_, findings) = with_findings(|findings| {
        let each = |_: &Meaning<'_>, command: &_, _, _: &mut Findings| {
            course.push(command);
            Ok(())
        };
        Ok(program::walk(
            &mut source,
            job.name(),
            job.start,
            findings,
            each,
        )?)
    })?;
    if findings.errors > 0 {
        let verdict = verdict(findings.errors, findings.warnings);
        eprintln!("{}: {verdict}", job.name());
        return Ok(None);
    }
    Ok(Some(course))
}

fn print(of: &Motion, page: Page, mut out: &mut dyn Write) -> io::Result<()> {
    match page {
        Page::Text => motion::print(of, &mut out)?,
        Page::Json => {
            let rules: Vec<&Figures> = of.rules.iter().map(|(figures, _)| figures).collect();
            let body = json!({"rules": rules, "notes": of.notes});
            write_line("husillo.compare.motion/1", &body, &mut out)?;
        }
        Page::Html => out.write_all(motion::html(of).as_bytes())?,
    }
    out.flush()
}

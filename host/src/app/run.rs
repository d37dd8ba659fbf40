//! `run`: checks, simulates and draws a program, and prints a summary.

pub mod report;
mod summary;

use super::choice;
use super::job::Job;
use super::reporting::{verdict, with_some_findings};
use super::{ERRORS, Failure, OK};
use crate::cli::{CuttingOrder, Output, Run as RunArgs};
use crate::console;
use crate::console::progress::Progress;
use crate::output::{Outputs, Writer};
use husillo_simulator::diagnostics::Findings;
use husillo_simulator::job::{Options, Order, Results};
use husillo_simulator::programs::check::Facts;
use husillo_simulator::programs::mirror;
use husillo_simulator::scene::Scene;
use std::io::Write;
use std::path::Path;

pub(super) fn simulate(args: &RunArgs) -> Result<u8, Failure> {
    let mut job = choice::job(&args.file, &args.target, args.place.zero, args.limit)?;
    simulate_job(&mut job, args)
}

fn simulate_job(job: &mut Job, args: &RunArgs) -> Result<u8, Failure> {
    let is_text = args.format == Output::Text;
    let (mut facts, findings) =
        with_some_findings(args.limit, args.format, |findings| job.check(findings))?;
    let verdict = verdict(findings.errors, findings.warnings);
    if findings.errors > 0 {
        eprintln!("{}: {verdict}; nothing moves", job.name());
        if !is_text {
            Results::refused(&findings, job.machine.axes.len()).write_json(
                job,
                &findings,
                &mut console::stdout(),
            )?;
        }
        choice::suggest(job, &args.target, args.place.zero, &findings)?;
        return Ok(ERRORS);
    }
    if is_text {
        let (name, machine) = (job.name(), &job.machine.name);
        writeln!(
            console::stdout(),
            "Checked    {name} for {machine}: {verdict}"
        )?;
    }
    let order = match args.order {
        CuttingOrder::File => None,
        CuttingOrder::Mirrored => Some(mirror(job, &mut facts)?),
    };
    let mut outputs = Outputs::new();
    let mut files = Files::create(job, args, &mut outputs)?;
    let options = Options {
        compensation: !args.no_compensation,
        worn: args.worn,
        pushes: args.lose.clone(),
        symmetry_mm: args.symmetry,
        trace: files.trace.take(),
        observer: None,
    };
    let template = "Simulating [{bar:36}] {percent} % {human_pos} steps";
    let mut progress = Progress::new(template, Some(facts.events as u64));
    let simulated = job.simulate(&mut facts, options, || progress.step())?;
    drop(progress);
    let run = &simulated.run;
    let results = Results {
        order,
        warnings: findings.warnings,
        ..simulated.results(job, &facts)
    };
    if is_text {
        summary::print(job, run, &results, &facts)?;
    } else {
        results.write_json(job, &findings, &mut console::stdout())?;
    }
    let size = files.write_report(|| {
        let take_up_s = (!args.no_compensation).then(|| {
            let ticks = run.observers.statistics.take_up_ticks;
            run.mechanics.in_seconds(ticks)
        });
        let figures = report::figures(&results, &facts, take_up_s);
        let warnings = findings.short();
        let scene = Scene::of(job, &simulated, &facts, &findings)?.element();
        let report = report::made(job, &simulated, &results, figures, warnings, scene);
        Ok(husillo_reports::run::html(&report))
    })?;
    outputs.finish()?;
    if let (true, Some(path), Some(size)) = (is_text, &files.report_path, size) {
        let size = size.div_ceil(1000);
        let mut out = console::stdout();
        writeln!(
            out,
            "Wrote      {path} ({size} kB) - open it in any browser"
        )?;
    }
    for sentence in &results.losses {
        eprintln!("{}: {sentence}", job.name());
    }
    if simulated.has_stopped {
        eprintln!(
            "{}: stopped: an axis is not at its expected position",
            job.name()
        );
    }
    let is_well = results.losses.is_empty() && !simulated.has_stopped;
    Ok(if is_well { OK } else { ERRORS })
}

/// Puts the program of a job into mirrored order.
fn mirror(job: &mut Job, facts: &mut Facts) -> Result<Order, Failure> {
    let mut source = job.open()?;
    let made = mirror::mirrored(&mut source, job.name(), job.start.dialect)?;
    job.replace(made.text);
    let mut findings = Findings::new(1);
    let as_file = std::mem::replace(facts, job.check(&mut findings)?);
    if findings.errors > 0 {
        let why = findings.short().concat();
        return Err(Failure::Usage(format!("in mirrored order: {why}")));
    }
    Ok(Order {
        mirrored: made.contours,
        whole: made.whole,
        reversals_of_file: as_file.reversals[..job.machine.axes.len()].to_vec(),
        reversals: facts.reversals[..job.machine.axes.len()].to_vec(),
    })
}

/// The files of a run. They are begun before it, so that a file that cannot be written costs no
/// run.
struct Files {
    trace: Option<Box<dyn Write>>,
    report: Option<Writer>,
    report_path: Option<String>,
}

impl Files {
    fn create(job: &Job, args: &RunArgs, outputs: &mut Outputs) -> Result<Self, Failure> {
        let trace = match &args.trace {
            Some(path) => Some(Box::new(outputs.create(path)?) as Box<dyn Write>),
            None => None,
        };
        let report_path = match (&args.output, args.format) {
            (Some(path), _) => Some(path.clone()),
            (None, Output::Text) => Some(default_report(&job.file)),
            (None, Output::Json) => None,
        };
        let report = report_path.as_ref().map(|path| outputs.create(path));
        Ok(Self {
            trace,
            report: report.transpose()?,
            report_path,
        })
    }

    /// Writes the report if it is requested. Returns its length in bytes.
    fn write_report(
        &mut self,
        page: impl FnOnce() -> Result<String, Failure>,
    ) -> Result<Option<usize>, Failure> {
        let Some(mut out) = self.report.take() else {
            return Ok(None);
        };
        let page = page()?;
        out.write_all(page.as_bytes())?;
        out.flush()?;
        Ok(Some(page.len()))
    }
}

fn default_report(file: &str) -> String {
    let stem = Path::new(file)
        .file_stem()
        .map_or("report".into(), |stem| stem.to_string_lossy());
    let stem = if stem == "-" { "report".into() } else { stem };
    format!("out/{stem}.html")
}

#[cfg(test)]
mod tests;

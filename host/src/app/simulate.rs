//! `run`: a program checked, simulated, summed up and drawn.

use super::{ERRORS, Failure, Job, OK, to_stderr, verdict};
use crate::cli::{CuttingOrder, Output, Run as RunArgs};
use crate::console;
use crate::diagnostics::{Findings, Format};
use crate::machines::machine_file::Travel;
use crate::output::Outputs;
use crate::page::report::{self, AxisRow, Report, length};
use crate::programs::check::{Facts, duration};
use crate::programs::feeder;
use crate::programs::mirror;
use crate::programs::setup::{self, ClosedMicromill};
use crate::simulation::run::Run;
use crate::simulation::symmetry::{Difference, Symmetry};
use husillo_gcode::Dialect;
use husillo_machine::OnLoss;
use indicatif::{ProgressBar, ProgressStyle};
use serde::Serialize;
use std::io::{self, IsTerminal, Write};
use std::path::Path;

/// What `run --format json` prints.
#[derive(Debug, Default, Serialize)]
struct Results {
    events: u64,
    duration_s: f64,
    end_nm: [i64; 3],
    min_nm: [i64; 3],
    max_nm: [i64; 3],
    max_deviation_nm: f64,
    rms_deviation_nm: f64,
    reversals: [u64; 3],
    lost_steps: u64,
    #[serde(skip_serializing_if = "Option::is_none")]
    order: Option<Order>,
    #[serde(skip_serializing_if = "Option::is_none")]
    left_right: Option<Difference>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    encoders: Vec<String>,
    feed_nm: i64,
    rapid_nm: i64,
    errors: u64,
    warnings: u64,
}

/// What `--order mirrored` has done.
#[derive(Clone, Copy, Debug, Serialize)]
struct Order {
    /// Contours cut in halves.
    mirrored: usize,
    /// Closed contours cut as they were.
    whole: usize,
    /// Reversals of every axis in the order of the file.
    reversals_of_file: [u64; 3],
    /// The same in the order that was cut.
    reversals: [u64; 3],
}

/// Puts the program of a job into mirrored order.
fn mirror(job: &mut Job, facts: &mut Facts) -> Result<Order, Failure> {
    let mut source = job.open()?;
    let made = mirror::mirrored(&mut source, job.name(), job.start.dialect)?;
    job.input = Some(made.text.into_bytes());
    job.start.dialect = Dialect::RS274;
    job.config.dialect = Dialect::RS274;
    let mut told = Findings::new(Vec::new(), Format::Short, false, 1);
    let as_file = std::mem::replace(facts, job.check(&mut told)?);
    if told.errors > 0 {
        let why = String::from_utf8_lossy(told.writer()).into_owned();
        return Err(Failure::Usage(format!("in mirrored order: {why}")));
    }
    Ok(Order {
        mirrored: made.contours,
        whole: made.whole,
        reversals_of_file: as_file.reversals,
        reversals: facts.reversals,
    })
}

pub(super) fn simulate(args: &RunArgs) -> Result<u8, Failure> {
    let mut job = Job::new(&args.file, &args.target, "micromill")?;
    job.place(args.zero)?;
    let text = args.format == Output::Text;
    let mut drawn = to_stderr(Format::Text);
    // The warnings are drawn now and listed in the report.
    let mut listed = Findings::new(Vec::new(), Format::Short, false, 50);
    let mut facts = job.check(&mut drawn)?;
    let (errors, warnings) = (drawn.errors, drawn.warnings);
    if errors > 0 {
        eprintln!(
            "{}: {}; nothing moves",
            job.name(),
            verdict(errors, warnings)
        );
        if !text {
            print_json(&Results {
                errors,
                warnings,
                ..Results::default()
            })?;
        }
        return Ok(ERRORS);
    }
    if warnings > 0 {
        job.check(&mut listed)?;
    }
    if text {
        writeln!(
            console::stdout(),
            "Checked    {} for {}: {}",
            job.name(),
            job.machine.name,
            verdict(errors, warnings)
        )?;
    }
    let order = match args.order {
        CuttingOrder::File => None,
        CuttingOrder::Mirrored => Some(mirror(&mut job, &mut facts)?),
    };
    let mut outputs = Outputs::new();
    let trace = match &args.trace {
        Some(path) => Some(Box::new(outputs.create(path)?) as Box<dyn Write>),
        None => None,
    };
    let report = match (&args.output, text) {
        (Some(path), _) => Some(path.clone()),
        (None, true) => Some(default_report(&job.file)),
        (None, false) => None,
    };
    let report = match report {
        Some(path) => Some((outputs.create(&path)?, path)),
        None => None,
    };
    let mut run = Run::new(&job.machine, args.worn, trace)?;
    let mut source = job.open()?;
    let mut machine = job.new_machine(!args.no_compensation)?;
    run.start_at(machine.position_steps());
    run.set_pushes(&args.lose);
    run.observers.symmetry = args.symmetry.map(|mm| {
        let [x, y, _] = run.mechanics.nm_per_step();
        Symmetry::new(mm * 1e6, [x, y])
    });
    let bar = progress(facts.events);
    let mut countdown = PROGRESS_EVENTS;
    let mut tick = || {
        countdown -= 1;
        if countdown == 0 {
            countdown = PROGRESS_EVENTS;
            bar.inc(PROGRESS_EVENTS);
        }
    };
    let encoders = setup::encoders(&job.machine);
    let mut has_stopped = false;
    if encoders.iter().any(Option::is_some) {
        let mut closed = ClosedMicromill::new(machine, encoders);
        let counts = run.mechanics.counts();
        feeder::feed_followed(&mut source, &mut closed, counts, |closed, entry| {
            tick();
            run.followed(closed, entry)
        })?;
        has_stopped = closed.is_stopped();
        machine = closed.machine().clone();
    } else {
        feeder::feed(&mut source, &mut machine, |machine, event| {
            tick();
            run.event(machine, event)
        })?;
    }
    bar.finish_and_clear();
    run.finish()?;

    let offset = machine.modal().work_offset().map(|nm| nm.0);
    let lost = losses(&job, &run);
    let errors = errors + lost.len() as u64;
    let mut results = results(&job, &run, &facts, offset, [errors, warnings]);
    results.order = order;
    results.left_right = run
        .observers
        .symmetry
        .as_ref()
        .and_then(Symmetry::difference);
    if text {
        summary(&job, &run, &results, &facts)?;
    } else {
        print_json(&results)?;
    }
    let mut wrote = None;
    if let Some((mut out, path)) = report {
        let warnings = String::from_utf8_lossy(listed.writer())
            .lines()
            .map(str::to_owned)
            .collect();
        let figures = figures(
            &results,
            &facts,
            run.observers.statistics.take_up_ticks as f64 / f64::from(job.machine.timer_hz),
            args.no_compensation,
        );
        let page = report::html(&make_report(
            &job, &run, &results, figures, offset, warnings,
        ));
        out.write_all(page.as_bytes())?;
        out.flush()?;
        wrote = Some((path, page.len())).filter(|_| text);
    }
    outputs.finish()?;
    if let Some((path, size)) = wrote {
        writeln!(
            console::stdout(),
            "Wrote      {path} ({} kB) - open it in any browser",
            size.div_ceil(1000)
        )?;
    }
    for sentence in &lost {
        eprintln!("{}: {sentence}", job.name());
    }
    if has_stopped {
        eprintln!("{}: stopped: an axis is not where it should be", job.name());
        return Ok(ERRORS);
    }
    Ok(if lost.is_empty() { OK } else { ERRORS })
}

/// A sentence for each axis that lost steps which nothing made good: how many, where first, and
/// what to do.
fn losses(job: &Job, run: &Run) -> Vec<String> {
    let mut sentences = Vec::new();
    let axes = job.machine.axes.iter().zip(run.mechanics.losses().lost());
    let axes = axes.zip(run.encoders.behind);
    for (((axis, lost), is_behind), first) in axes.zip(run.mechanics.losses().first()) {
        let corrects = axis
            .encoder
            .is_some_and(|file| file.encoder.on_loss == OnLoss::Correct);
        let is_made_good = corrects && !is_behind;
        if lost == 0 || is_made_good {
            continue;
        }
        let place = first.map_or(String::new(), |first| {
            let [x, y, z] = first.at_nm.map(report::millimetres);
            format!(
                "; the first at step event {}, after {}, near X{x} Y{y} Z{z} mm of the machine",
                first.event,
                duration(first.time_s)
            )
        });
        let advice = match axis.pull_out_rate {
            Some(rate) => format!(
                "the motor follows up to {rate} Hz: lower the feed, or `max_rate` or `start_rate` \
                 of the axis"
            ),
            None => "lower the feed or `max_rate` of the axis".to_owned(),
        };
        let letter = char::from(axis.letter);
        let steps = if lost == 1 { "step" } else { "steps" };
        sentences.push(format!(
            "axis {letter} lost {lost} {steps}{place}: {advice}"
        ));
    }
    sentences
}

/// Reports of the encoders that are printed; JSON has all.
const MOST_TOLD: usize = 20;

/// Events between two updates of the progress bar.
const PROGRESS_EVENTS: u64 = 1 << 20;

fn progress(events: f64) -> ProgressBar {
    if events < 4.0 * PROGRESS_EVENTS as f64 || !io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::new(events as u64);
    if let Ok(style) =
        ProgressStyle::with_template("Simulating [{bar:36}] {percent} % {human_pos} steps")
    {
        bar.set_style(style.progress_chars("=> "));
    }
    bar
}

fn default_report(file: &str) -> String {
    let stem = Path::new(file)
        .file_stem()
        .map_or("report".into(), |stem| stem.to_string_lossy());
    let stem = if stem == "-" { "report".into() } else { stem };
    format!("out/{stem}.html")
}

fn print_json(results: &Results) -> io::Result<()> {
    let json = serde_json::to_string(results).map_err(io::Error::other)?;
    writeln!(console::stdout(), "{json}")
}

fn results(
    job: &Job,
    run: &Run,
    facts: &Facts,
    offset: [i64; 3],
    [errors, warnings]: [u64; 2],
) -> Results {
    let nm = |steps: [i32; 3]| {
        [0, 1, 2].map(|axis| {
            let step = job.machine.axes[axis].step;
            let exact = i128::from(steps[axis]) * i128::from(step.num);
            let nearest = (2 * exact + i128::from(step.den)).div_euclid(2 * i128::from(step.den));
            i64::try_from(nearest).unwrap_or(i64::MAX) - offset[axis]
        })
    };
    Results {
        events: run.mechanics.events(),
        duration_s: run.mechanics.seconds(),
        end_nm: nm(run.mechanics.tool()),
        min_nm: nm(run.observers.statistics.low),
        max_nm: nm(run.observers.statistics.high),
        max_deviation_nm: rounded(run.observers.deviation.largest_nm()),
        rms_deviation_nm: rounded(run.observers.deviation.rms_nm()),
        reversals: run.observers.statistics.reversals,
        lost_steps: run.mechanics.losses().lost().iter().sum(),
        encoders: run.encoders.sentences.clone(),
        order: None,
        left_right: None,
        feed_nm: facts.feed_nm.round() as i64,
        rapid_nm: facts.rapid_nm.round() as i64,
        errors,
        warnings,
    }
}

/// Thousandths of a nanometre are more than enough.
fn rounded(nm: f64) -> f64 {
    (nm * 1e3).round() / 1e3
}

fn summary(job: &Job, run: &Run, results: &Results, facts: &Facts) -> io::Result<()> {
    let mut out = console::stdout();
    writeln!(
        out,
        "Simulated  {} step events, {}",
        results.events,
        duration(results.duration_s)
    )?;
    writeln!(
        out,
        "           path {} feed, {} rapid",
        length(facts.feed_nm),
        length(facts.rapid_nm)
    )?;
    writeln!(
        out,
        "           deviation {} at most, {} RMS",
        length(results.max_deviation_nm),
        length(results.rms_deviation_nm)
    )?;
    let lost = run.mechanics.losses().lost();
    for (axis, facts) in job.machine.axes.iter().enumerate() {
        let [low, high, end] = [results.min_nm, results.max_nm, results.end_nm]
            .map(|nm| report::millimetres(nm[axis] as f64));
        write!(
            out,
            "           {} {low} to {high} mm, ends at {end}, {} take-ups",
            char::from(facts.letter),
            results.reversals[axis]
        )?;
        match lost[axis] {
            0 => writeln!(out)?,
            lost => writeln!(out, ", {lost} STEPS LOST")?,
        }
    }
    if let Some(order) = &results.order {
        let count = |reversals: [u64; 3]| reversals.iter().sum::<u64>();
        writeln!(
            out,
            "Mirrored   {} contours in halves, {} as they were; {} reversals, {} in the order of \
             the file",
            order.mirrored,
            order.whole,
            count(order.reversals),
            count(order.reversals_of_file)
        )?;
    }
    if let Some(apart) = &results.left_right {
        writeln!(
            out,
            "Left/right {} apart at most, {} RMS, over {} pairs of points",
            length(apart.max_nm),
            length(apart.rms_nm),
            apart.pairs
        )?;
    }
    for told in run.encoders.sentences.iter().take(MOST_TOLD) {
        writeln!(out, "Encoders   {told}")?;
    }
    if let Some(more @ 1..) = run.encoders.sentences.len().checked_sub(MOST_TOLD) {
        writeln!(out, "           and {more} more")?;
    }
    Ok(())
}

fn figures(
    results: &Results,
    facts: &Facts,
    take_up_s: f64,
    uncompensated: bool,
) -> Vec<(&'static str, String)> {
    vec![
        ("time", duration(results.duration_s)),
        ("step events", results.events.to_string()),
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
            if uncompensated {
                "not compensated".to_owned()
            } else {
                format!("taken up in {}", duration(take_up_s))
            },
        ),
        ("lost steps", results.lost_steps.to_string()),
    ]
}

fn make_report(
    job: &Job,
    run: &Run,
    results: &Results,
    figures: Vec<(&'static str, String)>,
    offset: [i64; 3],
    warnings: Vec<String>,
) -> Report {
    let travel = |axis: usize| match job.machine.axes[axis].travel {
        Travel::Range(range) => Some(range.map(|at| (at - offset[axis]) as f64)),
        Travel::Unknown | Travel::Unlimited => None,
    };
    let lost = run.mechanics.losses().lost();
    let axes = (0..3)
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
        phases: run.observers.phases.motors(&job.machine),
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
    }
}

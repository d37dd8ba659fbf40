//! `husillo compare`.

mod motion;

use super::job::Job;
use super::reporting::{verdict, with_findings};
use super::{ERRORS, Failure, OK, count};
use crate::cli::{Compare, Page};
use crate::console;
use crate::methods::one_move::one_move;
use crate::output::Outputs;
use husillo_methods::{Comparer, Comparison, Weights};
use husillo_reports::methods;
use husillo_simulator::text::json::write_line;
use serde_json::json;
use std::io::{self, Write};

/// Compares the interpolation methods for one move, or for all moves of a program.
pub fn compare(args: &Compare) -> Result<u8, Failure> {
    if args.job == "motion" {
        return motion::compare(args);
    }
    if let Some(file) = &args.file {
        let why = format!("`{file}` after `{}`: only motion takes a program", args.job);
        return Err(Failure::Usage(why));
    }
    let weights = Weights::parse(&args.weights).ok_or_else(|| {
        format!(
            "--weights: `{}` is not four numbers from 0 up, one of them above 0",
            args.weights
        )
    })?;
    let Some(comparison) = compared(args, weights)? else {
        return Ok(ERRORS);
    };
    if comparison.rows.is_empty() {
        let why = comparison.notes.first().map(String::as_str);
        let why = why.unwrap_or("no line and no arc at a feed, so there is nothing to compare");
        return Err(Failure::Usage(format!("{}: {why}", args.job)));
    }
    let mut outputs = Outputs::new();
    let mut out: Box<dyn Write> = match &args.output {
        Some(path) => Box::new(outputs.create(path)?),
        None => Box::new(console::stdout()),
    };
    print(&comparison, page(args), &mut out)?;
    outputs.finish()?;
    if let Some(path) = &args.output {
        eprintln!("{path}: {}", count(comparison.rows.len() as u64, "method"));
    }
    Ok(OK)
}

/// The comparison; `None` for a program with errors.
fn compared(args: &Compare, weights: Weights) -> Result<Option<Comparison>, Failure> {
    let mut comparer = Comparer::new(args.only.as_deref())?;
    if let Some((one, title)) = one_move(args)? {
        comparer.add(&one);
        return Ok(Some(comparer.finish(title, Some(one), weights)));
    }
    let mut job = Job::new(&args.job, &args.target, "free")?;
    job.keep_input()?;
    let comparer = compare_program(&job, comparer)?;
    let title = format!("{} on {}", job.name(), job.machine.title);
    Ok(comparer.map(|comparer| comparer.finish(title, None, weights)))
}

/// The form of the output: that of the option, or of the name of the file.
fn page(args: &Compare) -> Page {
    args.format.unwrap_or(match &args.output {
        Some(path) if path.ends_with(".html") => Page::Html,
        Some(path) if path.ends_with(".json") => Page::Json,
        _ => Page::Text,
    })
}

fn print(comparison: &Comparison, page: Page, mut out: &mut dyn Write) -> io::Result<()> {
    match page {
        Page::Text => methods::print(comparison, &mut out)?,
        Page::Json => {
            let body = json!({"methods": comparison.rows, "notes": comparison.notes});
            write_line("husillo.compare/1", &body, &mut out)?;
        }
        Page::Html => out.write_all(methods::html(comparison).as_bytes())?,
    }
    out.flush()
}

/// Makes every feed move of a program; `None` if it has errors.
fn compare_program(job: &Job, mut comparer: Comparer) -> Result<Option<Comparer>, Failure> {
    let ((), findings) = with_findings(|findings| Ok(job.compare(&mut comparer, findings)?))?;
    if findings.errors > 0 {
        eprintln!(
            "{}: {}",
            job.name(),
            verdict(findings.errors, findings.warnings)
        );
        return Ok(None);
    }
    Ok(Some(comparer))
}

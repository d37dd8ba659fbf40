//! The summary that `run` prints for people.

use crate::app::reporting::count;
use crate::console;
use husillo_reports::text::duration;
use husillo_reports::text::{length, millimetres};
use husillo_sim::observers::symmetry::Difference;
use husillo_sim::text::grouped;
use husillo_simulator::job::{Job, Order, Results};
use husillo_simulator::programs::check::Facts;
use husillo_simulator::simulation::run::Run;
use std::io::{self, Write};

/// Reports of the encoders that are printed; JSON has all.
const MOST_REPORTS: usize = 20;

/// Prints the summary.
///
/// # Errors
///
/// Writing fails.
pub fn print(job: &Job, run: &Run, results: &Results, facts: &Facts) -> io::Result<()> {
    let out = &mut console::stdout();
    writeln!(
        out,
        "Simulated  {}, {}",
        count(results.events, "step event"),
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
    print_axes(job, run, results, out)?;
    for touch in &results.probes {
        let letters = job.machine.letters.letters().map(char::from);
        let at: Vec<String> = letters
            .zip(&touch.position_nm)
            .map(|(letter, nm)| format!("{letter}{}", millimetres(*nm as f64)))
            .collect();
        let what = if touch.is_touched {
            "contact"
        } else {
            "no contact"
        };
        writeln!(out, "Probed     {}: {what}", at.join(" "))?;
    }
    if let Some(order) = &results.order {
        print_order(order, out)?;
    }
    if let Some(apart) = &results.left_right {
        print_sides(apart, out)?;
    }
    let reports = &run.encoders.sentences;
    for report in reports.iter().take(MOST_REPORTS) {
        writeln!(out, "Encoders   {report}")?;
    }
    if let Some(more @ 1..) = reports.len().checked_sub(MOST_REPORTS) {
        writeln!(out, "           and {more} more")?;
    }
    Ok(())
}

fn print_axes(job: &Job, run: &Run, results: &Results, out: &mut impl Write) -> io::Result<()> {
    let lost = run.mechanics.losses().lost();
    for (axis, facts) in job.machine.axes.iter().enumerate() {
        let [low, high, end] = [&results.min_nm, &results.max_nm, &results.end_nm]
            .map(|nm| millimetres(nm[axis] as f64));
        let unit = if facts.is_rotary { "degrees" } else { "mm" };
        write!(
            out,
            "           {} {low} to {high} {unit}, ends at {end}, {}",
            char::from(facts.letter),
            count(results.reversals[axis], "take-up")
        )?;
        match lost[axis] {
            0 => writeln!(out)?,
            lost => writeln!(out, ", {} STEPS LOST", grouped(lost))?,
        }
    }
    Ok(())
}

fn print_order(order: &Order, out: &mut impl Write) -> io::Result<()> {
    let sum = |reversals: &[u64]| reversals.iter().sum::<u64>();
    writeln!(
        out,
        "Mirrored   {} in halves, {} as they were; {}, {} in the order of the file",
        count(order.mirrored as u64, "contour"),
        order.whole,
        count(sum(&order.reversals), "reversal"),
        grouped(sum(&order.reversals_of_file))
    )
}

fn print_sides(apart: &Difference, out: &mut impl Write) -> io::Result<()> {
    writeln!(
        out,
        "Left/right {} apart at most, {} RMS, over {} of points",
        length(apart.max_nm),
        length(apart.rms_nm),
        count(apart.pairs as u64, "pair")
    )
}

//! The page of an experiment: figures, pictures, trials.

use super::listing::{figures, percent};
use crate::chart::{LEFT, Panel, RIGHT, ceiling, time_scale};
use crate::frame;
use crate::text::escape;
use husillo_metrology::tuning::{Outcome, Trace};
use std::fmt::Write;

/// Longest time that is drawn, s. The rest looks the same.
const LONGEST_S: f64 = 1.0;

/// The last column is text.
const STYLE: &str = "td:last-child,th:last-child{text-align:left}";

/// The page.
pub fn html(outcome: &Outcome, traces: &[Trace]) -> String {
    let title = format!("Tuning of {}: {}", outcome.axis, outcome.method);
    let mut page = frame::open(&title, &title, &outcome.machine, STYLE);
    frame::figures(&mut page, figures(outcome));
    if let Some(toml) = &outcome.toml {
        let _ = writeln!(page, "<p><code>{}</code></p>", escape(toml));
    }
    if let Some(why) = &outcome.aborted {
        let _ = writeln!(page, "<p><strong>Aborted: {}</strong></p>", escape(why));
    }
    for (number, trace) in traces.iter().enumerate() {
        section(&mut page, number, trace);
    }
    rules(&mut page, outcome);
    trials(&mut page, outcome);
    frame::notes(&mut page, &outcome.notes);
    frame::close(page, None)
}

/// The shown samples, as pairs of time in s and value.
fn shown(
    trace: &Trace,
    value: impl Fn(&husillo_metrology::tuning::Sample) -> f64,
) -> Vec<(f64, f64)> {
    let values = trace.samples.iter();
    let values = values.map(|sample| (trace_s(trace, sample.us), value(sample)));
    values.filter(|(at, _)| *at <= LONGEST_S).collect()
}

/// Time since the start of a trace, s.
fn trace_s(trace: &Trace, us: u64) -> f64 {
    us.saturating_sub(trace.start_us) as f64 * 1e-6
}

/// The values of the lower chart: the current of a servo, or the drive of a motor without one.
fn below(trace: &Trace) -> Vec<(f64, f64)> {
    if trace.target.is_some() {
        return shown(trace, |sample| percent(sample.current));
    }
    let drives = trace.drives.iter();
    let drives = drives.map(|(us, duty)| (trace_s(trace, *us), f64::from(*duty)));
    drives.filter(|(at, _)| *at <= LONGEST_S).collect()
}

/// Draws the lower chart.
fn lower(page: &mut String, trace: &Trace, below: &[(f64, f64)], x: impl Fn(f64) -> f64) {
    let (name, bottom) = match trace.target {
        Some(_) => ("motor current, % of full scale", 0.0),
        None => ("drive, PWM", -255.0),
    };
    let largest = below
        .iter()
        .map(|(_, value)| value.abs())
        .fold(1.0, f64::max);
    let high = if bottom < 0.0 {
        255.0
    } else {
        ceiling(1.05 * largest, 3.0)
    };
    let lower = Panel {
        top: 300.0,
        bottom: 440.0,
        low: bottom,
        high,
    };
    lower.scale(page, name);
    staircase(page, "acceleration", below, x, &lower);
}

fn section(page: &mut String, number: usize, trace: &Trace) {
    let positions = shown(trace, |sample| f64::from(sample.position));
    let Some((seconds, _)) = positions
        .last()
        .copied()
        .filter(|(seconds, _)| *seconds > 0.0)
    else {
        return;
    };
    let below = below(trace);
    let target = trace.target.map(f64::from);
    let all = || {
        positions
            .iter()
            .map(|(_, position)| *position)
            .chain(target)
    };
    let (low, high) = (
        all().fold(f64::MAX, f64::min),
        all().fold(f64::MIN, f64::max),
    );
    let margin = 0.06 * (high - low).max(2.0);
    let _ = writeln!(page, "<section><h2>{}</h2>", escape(&trace.title));
    let _ = writeln!(
        page,
        "<svg viewBox=\"0 0 1000 480\" role=\"img\" aria-labelledby=\"trace{number}-t \
         trace{number}-d\">\
         <title id=\"trace{number}-t\">{}</title><desc id=\"trace{number}-d\">Position between \
         {low:.0} and {high:.0} counts over {:.0} ms</desc>",
        escape(&trace.title),
        seconds * 1e3
    );
    let x = |at: f64| LEFT + (RIGHT - LEFT) * at / seconds;
    let upper = Panel {
        top: 30.0,
        bottom: 250.0,
        low: low - margin,
        high: high + margin,
    };
    upper.scale(page, "position, counts");
    if let Some(target) = target {
        let y = upper.y(target);
        let _ = writeln!(page, "<path class=\"ideal\" d=\"M{LEFT} {y:.1}H{RIGHT}\"/>");
    }
    staircase(page, "feed", &positions, x, &upper);
    lower(page, trace, &below, x);
    time_scale(page, seconds);
    page.push_str("</svg>\n");
    let _ = writeln!(
        page,
        "<p>{}</p>\n</section>",
        if target.is_some() {
            "The broad line is the commanded position."
        } else {
            "The motor is driven without the servo."
        }
    );
}

/// Draws each value as a level until the next one.
fn staircase(
    page: &mut String,
    class: &str,
    points: &[(f64, f64)],
    x: impl Fn(f64) -> f64,
    panel: &Panel,
) {
    let (mut path, mut level) = (String::new(), f64::NAN);
    for (at, value) in points {
        let y = panel.y(*value);
        // Writing to a string does not fail.
        if path.is_empty() {
            let _ = write!(path, "M{:.1} {y:.1}", x(*at));
        } else if (y - level).abs() >= 0.05 {
            let _ = write!(path, "H{:.1}V{y:.1}", x(*at));
        } else {
            continue;
        }
        level = y;
    }
    if let Some((end, _)) = points.last() {
        let _ = writeln!(
            page,
            "<path class=\"{class}\" d=\"{path}H{:.1}\"/>",
            x(*end)
        );
    }
}

fn rules(page: &mut String, outcome: &Outcome) {
    if outcome.rules.is_empty() {
        return;
    }
    page.push_str(
        "<section><h2>Gains by rule</h2><div \
         class=\"scroll\" tabindex=\"0\"><table><tr><th>rule</th><th>Kp</th><th>Ki</th><th>Kd</th>\
         <th>p</th><th>i</th><th>d</th><th>integral_limit</th><th>source</th></tr>\n",
    );
    for row in &outcome.rules {
        let _ = writeln!(
            page,
            "<tr><td>{}</td><td>{:.2}</td><td>{:.1}</td><td>{:.4}</td><td>{}</td><td>{}</td><td>{}\
             </td><td>{}</td><td>{}</td></tr>",
            row.rule,
            row.kp,
            row.ki,
            row.kd,
            row.p,
            row.i,
            row.d,
            row.integral_limit,
            escape(row.source)
        );
    }
    page.push_str(
        "</table></div><p>Kp is in PWM per count, Ki in PWM per count and second, Kd in PWM per \
         count/s.</p></section>\n",
    );
}

fn trials(page: &mut String, outcome: &Outcome) {
    if outcome.trials.is_empty() {
        return;
    }
    page.push_str(
        "<section><h2>Trials</h2><div class=\"scroll\" tabindex=\"0\">\
         <table><tr><th>stage</th><th>p</th>\
         <th>i</th><th>d</th>\
         <th>integral_limit</th><th>rate_divisor</th><th>result</th></tr>\n",
    );
    for trial in &outcome.trials {
        let _ = writeln!(
            page,
            "<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td>\
             </tr>",
            trial.stage,
            trial.p,
            trial.i,
            trial.d,
            trial.integral_limit,
            trial.rate_divisor,
            escape(&trial.result)
        );
    }
    page.push_str("</table></div></section>\n");
}

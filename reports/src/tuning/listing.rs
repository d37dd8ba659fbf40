//! The results of an experiment as text.

use husillo_metrology::tuning::{Outcome, RuleRow, Trial, counts};
use std::fmt::Write;

/// Names and values of the most important figures.
pub fn figures(outcome: &Outcome) -> Vec<(&'static str, String)> {
    let mut rows = Vec::new();
    let ms = |value: Option<f64>| value.map_or("never".to_owned(), |ms| format!("{ms:.1} ms"));
    if let Some(step) = &outcome.step {
        let overshoot = step.overshoot_percent;
        rows.extend([
            ("step", format!("{} to {} counts", step.from, step.goal)),
            ("rise, 10 to 90 %", ms(step.rise_ms)),
            (
                "overshoot",
                overshoot.map_or("none".into(), |part| format!("{part:.1} %")),
            ),
            ("settled within 1 count", ms(step.settling_ms)),
            ("error at the end", counts(step.steady_error)),
            (
                "peak current",
                format!("{:.0} % of full scale", percent(step.peak_current)),
            ),
        ]);
    }
    if let Some(relay) = &outcome.relay {
        rows.extend([
            (
                "relay",
                format!(
                    "{} PWM, hysteresis {:.1} counts",
                    relay.relay_pwm, relay.hysteresis
                ),
            ),
            (
                "oscillation",
                format!("{:.2} counts, {:.1} ms", relay.amplitude, relay.period_ms),
            ),
        ]);
        if relay.late_ms > 0.0 {
            rows.push(("delay of the line", format!("{:.1} ms", relay.late_ms)));
        }
    }
    if let Some(ultimate) = &outcome.ultimate {
        let gain = format!("{:.1} PWM per count, p = {:.0}", ultimate.gain, ultimate.p);
        let gain = match ultimate.rate_divisor {
            1 => gain,
            divisor => format!("{gain}, rate divisor {divisor}"),
        };
        rows.extend([
            ("Ku", gain),
            ("Tu", format!("{:.1} ms", ultimate.period_ms)),
        ]);
    }
    rows.push(("reading interval", format!("{:.2} ms", outcome.sample_ms)));
    if let Some(check) = &outcome.check {
        let text = format!(
            "{} of {} within 1 count, farthest {}, at rest {}",
            check.within_1_count, check.moves, check.largest_error, check.rest_error
        );
        rows.push(("moves", text));
    }
    rows
}

/// The results as text.
pub fn text(outcome: &Outcome) -> String {
    let mut text = format!(
        "{} of {}: {}\n",
        outcome.axis, outcome.machine, outcome.method
    );
    for trial in &outcome.trials {
        let Trial {
            stage,
            p,
            i,
            d,
            integral_limit,
            rate_divisor,
            result,
        } = trial;
        // Writing to a string does not fail.
        let _ = writeln!(
            text,
            "    {stage:<12} p {p:<5} i {i:<5} d {d:<5} limit {integral_limit:<5} rate \
             1/{rate_divisor:<2} {result}"
        );
    }
    for (name, value) in figures(outcome) {
        let _ = writeln!(text, "    {name:<22} {value}");
    }
    for rule in &outcome.rules {
        let RuleRow {
            rule,
            kp,
            ki,
            kd,
            p,
            i,
            d,
            integral_limit,
            ..
        } = rule;
        let _ = writeln!(
            text,
            "    {rule:<22} Kp {kp:.2}, Ki {ki:.1}/s, Kd {kd:.4} s: p = {p}, i = {i}, d = {d}, \
             integral_limit = {integral_limit}"
        );
    }
    for note in &outcome.notes {
        let _ = writeln!(text, "    note: {note}");
    }
    if let Some(toml) = &outcome.toml {
        let _ = writeln!(text, "{toml}");
    }
    text
}

/// A reading of the current, 0 to 255, in percent of the full scale of the module.
pub fn percent(reading: u8) -> f64 {
    f64::from(reading) / 2.55
}

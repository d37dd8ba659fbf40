//! What an experiment found, as text or JSON.

use super::fit::toml;
use super::moves::Moves;
use super::relay::RelayFigures;
use super::step::StepFigures;
use super::trial::Trial;
use husillo_pid::Gains as Rates;
use husillo_pid::tuning::Ultimate;
use husillo_transports::nmc::Gains;
use serde::Serialize;
use std::fmt::Write;

/// Everything about an experiment but its pictures.
#[derive(Debug, Serialize)]
pub struct Outcome {
    /// Name of the method.
    pub method: &'static str,
    /// Title of the machine.
    pub machine: String,
    /// `X`, `Y` or `Z`.
    pub axis: char,
    /// Where the axis is.
    pub port: String,
    /// Mean time between two readings, ms.
    pub sample_ms: f64,
    /// Every setting that was tried.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub trials: Vec<Trial>,
    /// Of a step.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub step: Option<StepFigures>,
    /// Of a relay.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub relay: Option<RelayFigures>,
    /// Ku and Tu of the module's loop.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ultimate: Option<UltimateFigures>,
    /// Gains by every rule.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub rules: Vec<RuleRow>,
    /// The gains that came of it, as a line of a machine file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub toml: Option<String>,
    /// What moves with them did.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub check: Option<Moves>,
    /// What is to be known of it, in sentences.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub notes: Vec<String>,
    /// Why it was aborted.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub aborted: Option<String>,
}

/// An ultimate point.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct UltimateFigures {
    /// Ku, PWM a count.
    pub gain: f64,
    /// The same as a proportional gain of the module.
    pub p: f64,
    /// Tu, ms.
    pub period_ms: f64,
    /// Servo periods of a sample of the loop in which it was found.
    pub rate_divisor: u8,
}

impl UltimateFigures {
    /// Of a point that was found with this rate divisor.
    pub fn new(ultimate: Ultimate, rate_divisor: u8) -> Self {
        Self {
            gain: ultimate.gain,
            p: ultimate.gain * 256.0,
            period_ms: ultimate.period_s * 1e3,
            rate_divisor,
        }
    }
}

/// Gains by a rule.
#[derive(Clone, Debug, Serialize)]
pub struct RuleRow {
    /// Its name.
    pub rule: &'static str,
    /// Where it was published.
    pub source: &'static str,
    /// Proportional gain, PWM a count.
    pub kp: f64,
    /// Integral gain, PWM a count and second.
    pub ki: f64,
    /// Derivative gain, PWM seconds a count.
    pub kd: f64,
    /// Proportional gain of the module: 256 Kp.
    pub p: u16,
    /// Integral gain of the module: 65536 Ki T.
    pub i: u16,
    /// Derivative gain of the module: 256 Kd / T.
    pub d: u16,
    /// Bound of the sum of errors.
    pub integral_limit: u16,
}

impl RuleRow {
    /// A rule's gains, as they are and in the module.
    pub fn new(rule: &'static str, source: &'static str, rates: Rates<f64>, gains: &Gains) -> Self {
        Self {
            rule,
            source,
            kp: rates.proportional,
            ki: rates.integral,
            kd: rates.derivative,
            p: gains.proportional,
            i: gains.integral,
            d: gains.derivative,
            integral_limit: gains.integration_limit,
        }
    }
}

impl Outcome {
    /// Keeps these gains as the result.
    pub fn conclude(&mut self, gains: &Gains) {
        self.toml = Some(toml(gains));
    }

    /// Names and values of the most important figures.
    pub fn figures(&self) -> Vec<(&'static str, String)> {
        let mut rows = Vec::new();
        let ms = |value: Option<f64>| value.map_or("never".to_owned(), |ms| format!("{ms:.1} ms"));
        if let Some(step) = &self.step {
            let overshoot = step.overshoot_percent;
            rows.extend([
                ("step", format!("{} to {} counts", step.from, step.goal)),
                ("rise, 10 to 90 %", ms(step.rise_ms)),
                (
                    "overshoot",
                    overshoot.map_or("none".into(), |part| format!("{part:.1} %")),
                ),
                ("settled within 1 count", ms(step.settling_ms)),
                ("error at the end", super::stand::counts(step.steady_error)),
                ("peak current", format!("{} of 255", step.peak_current)),
            ]);
        }
        if let Some(relay) = &self.relay {
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
                rows.push(("late by the line", format!("{:.1} ms", relay.late_ms)));
            }
        }
        if let Some(ultimate) = &self.ultimate {
            let gain = format!("{:.1} PWM a count, p = {:.0}", ultimate.gain, ultimate.p);
            let gain = match ultimate.rate_divisor {
                1 => gain,
                divisor => format!("{gain}, rate divisor {divisor}"),
            };
            rows.extend([
                ("Ku", gain),
                ("Tu", format!("{:.1} ms", ultimate.period_ms)),
            ]);
        }
        rows.push(("a reading every", format!("{:.2} ms", self.sample_ms)));
        if let Some(check) = &self.check {
            let text = format!(
                "{} of {} within 1 count, farthest {}, at rest {}",
                check.within_1_count, check.moves, check.largest_error, check.rest_error
            );
            rows.push(("moves", text));
        }
        rows
    }

    /// For people.
    pub fn text(&self) -> String {
        let mut text = format!("{} of {}: {}\n", self.axis, self.machine, self.method);
        for trial in &self.trials {
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
                "    {stage:<12} p {p:<5} i {i:<5} d {d:<5} limit {integral_limit:<5} rate 1/{rate_divisor:<2} {result}"
            );
        }
        for (name, value) in self.figures() {
            let _ = writeln!(text, "    {name:<22} {value}");
        }
        for rule in &self.rules {
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
                "    {rule:<22} Kp {kp:.2}, Ki {ki:.1}/s, Kd {kd:.4} s: p = {p}, i = {i}, d = {d}, integral_limit = {integral_limit}"
            );
        }
        for note in &self.notes {
            let _ = writeln!(text, "    note: {note}");
        }
        if let Some(toml) = &self.toml {
            let _ = writeln!(text, "{toml}");
        }
        text
    }
}

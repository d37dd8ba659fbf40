//! What an experiment found.

use super::fit::toml;
use super::moves::Moves;
use super::relay::RelayFigures;
use super::step::StepFigures;
use super::trial::Trial;
use husillo_pid::Gains as Rates;
use husillo_pid::tuning::Ultimate;
use husillo_transports::nmc::Gains;
use serde::Serialize;

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
    pub(super) fn new(ultimate: Ultimate, rate_divisor: u8) -> Self {
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
    pub(super) fn new(
        rule: &'static str,
        source: &'static str,
        rates: Rates<f64>,
        gains: &Gains,
    ) -> Self {
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
    /// Nothing found yet: of a method, on an axis of a machine at a port.
    #[must_use]
    pub fn new(method: &'static str, machine: String, axis: char, port: String) -> Self {
        Self {
            method,
            machine,
            axis,
            port,
            sample_ms: 0.0,
            trials: Vec::new(),
            step: None,
            relay: None,
            ultimate: None,
            rules: Vec::new(),
            toml: None,
            check: None,
            notes: Vec::new(),
            aborted: None,
        }
    }

    /// Keeps these gains as the result.
    pub(super) fn conclude(&mut self, gains: &Gains) {
        self.toml = Some(toml(gains));
    }
}

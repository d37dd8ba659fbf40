//! The results of an experiment.

use super::fit::toml;
use super::moves::Moves;
use super::relay::RelayFigures;
use super::step::StepFigures;
use super::trial::Trial;
use husillo_pid::Gains as Rates;
use husillo_pid::tuning::Ultimate;
use husillo_transports::nmc::Gains;
use serde::Serialize;

/// All results of an experiment except its traces.
#[derive(Debug, Serialize)]
pub struct Outcome {
    /// Name of the method.
    pub method: &'static str,
    /// Title of the machine.
    pub machine: String,
    /// `X`, `Y` or `Z`.
    pub axis: char,
    /// The port of the axis.
    pub port: String,
    /// Mean time between two readings, ms.
    pub sample_ms: f64,
    /// All trials.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub trials: Vec<Trial>,
    /// Results of a step.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub step: Option<StepFigures>,
    /// Results of a relay.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub relay: Option<RelayFigures>,
    /// Ku and Tu of the loop of the module.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ultimate: Option<UltimateFigures>,
    /// Gains by every rule.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub rules: Vec<RuleRow>,
    /// The resulting gains, as a line of a machine file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub toml: Option<String>,
    /// Results of the moves with these gains.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub check: Option<Moves>,
    /// Notes on the results, in sentences.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub notes: Vec<String>,
    /// Why it was aborted.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub aborted: Option<String>,
}

/// An ultimate point.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct UltimateFigures {
    /// Ku, PWM per count.
    pub gain: f64,
    /// Ku as a proportional gain of the module.
    pub p: f64,
    /// Tu, ms.
    pub period_ms: f64,
    /// Servo periods per sample of the loop in which it was found.
    pub rate_divisor: u8,
}

impl UltimateFigures {
    /// The figures of a point that was found with this rate divisor.
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
    /// Name of the rule.
    pub rule: &'static str,
    /// Where it was published.
    pub source: &'static str,
    /// Proportional gain, PWM per count.
    pub kp: f64,
    /// Integral gain, PWM per count and second.
    pub ki: f64,
    /// Derivative gain, PWM seconds per count.
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
    /// The gains of a rule, in physical units and as integers of the module.
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
    /// An outcome without results, for a method and an axis of a machine at a port.
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

//! One trial of an experiment.

use husillo_transports::nmc::Gains;
use serde::Serialize;

/// Largest gain of a module.
pub const LARGEST: u16 = 0x7fff;

/// Gains that were tried, and the result.
#[derive(Clone, Debug, Serialize)]
pub struct Trial {
    /// The gain or limit that is searched.
    pub stage: &'static str,
    /// Proportional gain of the module.
    pub p: u16,
    /// Integral gain of the module.
    pub i: u16,
    /// Derivative gain of the module.
    pub d: u16,
    /// Bound of the sum of errors.
    pub integral_limit: u16,
    /// Servo periods per sample.
    pub rate_divisor: u8,
    /// The result as text.
    pub result: String,
}

impl Trial {
    /// Appends a trial before it starts and returns its index. Its result is "aborted" until
    /// [`end`](Self::end) sets it.
    pub fn begin(trials: &mut Vec<Self>, stage: &'static str, gains: &Gains) -> usize {
        trials.push(Self {
            stage,
            p: gains.proportional,
            i: gains.integral,
            d: gains.derivative,
            integral_limit: gains.integration_limit,
            rate_divisor: gains.rate_divisor,
            result: "aborted".to_owned(),
        });
        trials.len() - 1
    }

    /// Sets the result of a trial.
    pub fn end(trials: &mut [Self], number: usize, result: String) {
        if let Some(trial) = trials.get_mut(number) {
            trial.result = result;
        }
    }
}

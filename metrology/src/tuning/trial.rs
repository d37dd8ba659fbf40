//! One setting tried.

use husillo_transports::nmc::Gains;
use serde::Serialize;

/// Largest gain of a module.
pub const LARGEST: u16 = 0x7fff;

/// Gains that were tried, and what came of it.
#[derive(Clone, Debug, Serialize)]
pub struct Trial {
    /// What was looked for.
    pub stage: &'static str,
    /// Proportional gain of the module.
    pub p: u16,
    /// Integral gain of the module.
    pub i: u16,
    /// Derivative gain of the module.
    pub d: u16,
    /// Bound of the sum of errors.
    pub integral_limit: u16,
    /// Servo periods of a sample.
    pub rate_divisor: u8,
    /// What came of it.
    pub result: String,
}

impl Trial {
    /// Notes gains that are about to be tried; what comes of it follows. An experiment that is
    /// aborted leaves it open.
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

    /// What came of it.
    pub fn end(trials: &mut [Self], number: usize, result: String) {
        if let Some(trial) = trials.get_mut(number) {
            trial.result = result;
        }
    }
}

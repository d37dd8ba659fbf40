//! Conversion of the gains of a rule to the integers of a module.

use super::trial;
use husillo_pid::Gains as Rates;
use husillo_transports::nmc::{CYCLE_US, Gains};

/// Largest step of the integral part, PWM. The module makes this step whenever its sum of errors
/// passes a multiple of 256. A larger step would jolt the axis.
pub(super) const STEP_PWM: f64 = 4.0;
/// Largest drive of the integral part; full drive is 255. It overcomes stiction and does not jolt
/// the axis.
const SHARE_PWM: f64 = 32.0;

/// Converts the gains of a rule, which are per second and in PWM per count, to those of a module
/// with the limits of `limits`. Also returns sentences about the gains that had to be changed.
/// `None`: the gains are not numbers, or do not fit even when scaled.
pub fn fit(rule: Rates<f64>, limits: &Gains) -> Option<(Gains, Vec<String>)> {
    let period_s = f64::from(CYCLE_US) * 1e-6 * f64::from(limits.rate_divisor.max(1));
    let wanted = rule.per_sample(period_s);
    let mut notes = Vec::new();
    let largest = wanted.proportional.max(wanted.derivative) * 256.0;
    let factor = (f64::from(trial::LARGEST) / largest).min(1.0);
    if factor < 1.0 {
        notes.push(format!(
            "all gains of the rule are multiplied by {factor:.3}, as its {} gain would be \
             {largest:.0} and the limit of a module is 32767",
            if wanted.derivative > wanted.proportional {
                "derivative"
            } else {
                "proportional"
            }
        ));
    }
    let highest_integral = STEP_PWM * 256.0 / 65_536.0;
    let integral = wanted.integral * factor;
    if integral > highest_integral {
        notes.push(format!(
            "the integral gain of the rule would be {:.0}: it is limited to {:.0}, which makes a \
             step of {STEP_PWM} PWM whenever the sum passes a multiple of 256",
            integral * 65_536.0,
            highest_integral * 65_536.0
        ));
    }
    let servo = Rates {
        proportional: wanted.proportional * factor,
        integral: integral.min(highest_integral),
        derivative: wanted.derivative * factor,
    }
    .to_servo()?;
    let limit = SHARE_PWM * 65_536.0 / f64::from(servo.integral.max(1));
    let gains = Gains {
        proportional: servo.proportional,
        integral: servo.integral,
        derivative: servo.derivative,
        integration_limit: limit.min(trial::LARGEST.into()) as u16,
        ..*limits
    };
    Some((gains, notes))
}

/// The gains as a line of a machine file, TOML.
pub fn toml(gains: &Gains) -> String {
    let mut line = format!(
        "gains = {{ p = {}, i = {}, d = {}, integral_limit = {}, output_limit = {}, error_limit = \
         {}",
        gains.proportional,
        gains.integral,
        gains.derivative,
        gains.integration_limit,
        gains.output_limit,
        gains.error_limit
    );
    for (key, value, default) in [
        ("current_limit", gains.current_limit, 0),
        ("rate_divisor", gains.rate_divisor, 1),
        ("dead_band", gains.dead_band, 0),
    ] {
        if value != default {
            line += &format!(", {key} = {value}");
        }
    }
    line + " }"
}

#[cfg(test)]
mod tests {
    use super::*;

    fn limits() -> Gains {
        Gains {
            output_limit: 255,
            error_limit: 400,
            rate_divisor: 1,
            ..Gains::default()
        }
    }

    #[test]
    fn gains_that_fit_do_not_change() {
        let rule = Rates {
            proportional: 2.0,
            integral: 5.0,
            derivative: 0.01,
        };
        let (gains, notes) = fit(rule, &limits()).unwrap();
        assert!(notes.is_empty(), "{notes:?}");
        // 2 * 256; 5 * 512e-6 * 65536; 0.01 / 512e-6 * 256; 32 PWM.
        assert_eq!(
            (gains.proportional, gains.integral, gains.derivative),
            (512, 168, 5000)
        );
        assert_eq!(gains.integration_limit, 12_483);
        let halved = Gains {
            rate_divisor: 2,
            ..limits()
        };
        let (gains, _) = fit(rule, &halved).unwrap();
        assert_eq!((gains.integral, gains.derivative), (336, 2500));
        assert_eq!(
            toml(&gains),
            "gains = { p = 512, i = 336, d = 2500, integral_limit = 6241, output_limit = 255, \
             error_limit = 400, rate_divisor = 2 }"
        );
    }

    #[test]
    fn gains_that_are_too_large_are_noted() {
        let rule = Rates {
            proportional: 60.0,
            integral: 3000.0,
            derivative: 0.27,
        };
        let (gains, notes) = fit(rule, &limits()).unwrap();
        assert_eq!((gains.derivative, gains.integral), (32_767, 1024));
        let proportion = f64::from(gains.proportional) / f64::from(gains.derivative);
        assert!((proportion * 0.27 / 512e-6 / 60.0 - 1.0).abs() < 1e-3);
        assert_eq!(notes.len(), 2);
        let none = Rates {
            proportional: f64::NAN,
            ..rule
        };
        assert!(fit(none, &limits()).is_none());
    }
}

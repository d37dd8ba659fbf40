//! Tuning experiments on axes with known results.

use fixed::types::{I16F16, I32F0};
use husillo_pid::tuning::{Oscillation, Relay, Rule, Ultimate, oscillation, step_response};
use husillo_pid::{
    Gains, Integration, Limits, Pid, RateRule, ServoGains, ServoLaw, ServoState, State, TotalLimit,
};

const PERIOD_S: f64 = 0.001;

/// Three lags of 50 ms each: Ku = 8, Tu = 2 pi T / sqrt(3).
#[derive(Default)]
struct ThreeLags([f64; 3]);

impl ThreeLags {
    fn step(&mut self, mut input: f64) -> f64 {
        for lag in &mut self.0 {
            *lag += (input - *lag) * PERIOD_S / 0.05;
            input = *lag;
        }
        input
    }
}

fn ultimate() -> Ultimate {
    let (mut axis, mut relay, mut output) = (ThreeLags::default(), Relay::new(1.0, 0.0), 0.0);
    let samples: Vec<f64> = (0..10_000)
        .map(|_| {
            output = axis.step(relay.update(-output));
            output
        })
        .collect();
    relay
        .ultimate(&oscillation(&samples[2000..], PERIOD_S, 0.0).unwrap())
        .unwrap()
}

/// The relay finds the ultimate point within the accuracy of the describing function and of the
/// sampling.
#[test]
fn relay_finds_the_ultimate_point() {
    let found = ultimate();
    assert!((found.gain / 8.0 - 1.0).abs() < 0.08, "{found:?}");
    let period_s = std::f64::consts::TAU * 0.05 / 3_f64.sqrt();
    assert!((found.period_s / period_s - 1.0).abs() < 0.04, "{found:?}");
}

/// These gains, in fixed point, hold the axis. Tyreus-Luyben overshoots less than Ziegler-Nichols.
#[test]
fn gains_hold_the_axis() {
    let overshoots = [Rule::ZieglerNicholsPid, Rule::TyreusLuybenPid].map(|rule| {
        let gains = ultimate()
            .gains(rule)
            .per_sample(PERIOD_S)
            .to_fixed::<I16F16>()
            .unwrap();
        let limits = Limits {
            low: I32F0::from_num(-100_000),
            high: I32F0::from_num(100_000),
        };
        let pid = Pid::new(gains, Integration::Bilinear, limits).unwrap();
        let (mut axis, mut state, mut position) = (ThreeLags::default(), State::default(), 0.0);
        let samples: Vec<f64> = (0..5000)
            .map(|_| {
                let measured = I32F0::from_num(position);
                position = axis.step(
                    pid.update(&mut state, I32F0::from_num(1000), measured)
                        .to_num(),
                );
                position
            })
            .collect();
        let figures = step_response(&samples, PERIOD_S, 0.0, 1000.0, 0.02).unwrap();
        assert!(
            figures.rise_s < figures.settling_s && figures.settling_s < 3.0,
            "{figures:?}"
        );
        figures.overshoot
    });
    assert!(
        overshoots[1] < overshoots[0] && overshoots[0] < 0.7,
        "{overshoots:?}"
    );
}

#[test]
fn rules_as_published() {
    let ultimate = Ultimate {
        gain: 10.0,
        period_s: 2.0,
    };
    let of = |rule| {
        let gains = ultimate.gains(rule);
        [gains.proportional, gains.integral, gains.derivative]
            .map(|gain| (gain * 1000.0).round() / 1000.0)
    };
    assert_eq!(of(Rule::ZieglerNicholsP), [5.0, 0.0, 0.0]);
    assert_eq!(of(Rule::ZieglerNicholsPi), [4.5, 2.7, 0.0]);
    assert_eq!(of(Rule::ZieglerNicholsPid), [6.0, 6.0, 1.5]);
    assert_eq!(of(Rule::TyreusLuybenPi), [3.125, 0.71, 0.0]);
    assert_eq!(of(Rule::TyreusLuybenPid), [4.545, 1.033, 1.443]);
    assert_eq!(
        ultimate
            .gains(Rule::ZieglerNicholsPid)
            .per_sample(0.5)
            .derivative,
        3.0
    );
    assert_eq!(
        Ultimate {
            gain: f64::NAN,
            period_s: 1.0
        }
        .gains(Rule::ZieglerNicholsP)
        .to_fixed::<I16F16>(),
        None
    );
}

/// The law with these integers has the gains in PWM per count, per count of change, and per count
/// and sample.
#[test]
fn integers_of_the_servo_law() {
    let gains = Gains {
        proportional: 3.5,
        integral: 0.05,
        derivative: 40.0,
    };
    let servo = ServoGains {
        output_limit: 255,
        error_limit: 1000,
        integral_limit: 0x7fff,
        ..gains.to_servo().unwrap()
    };
    let law = ServoLaw::new(&servo, RateRule::Loop, TotalLimit::BeforeScaling);
    let mut axis = ServoState::on();
    // 3.5 * 4 + 40 * 4 in the first tick, then without the derivative.
    assert_eq!(law.tick(&mut axis, 4, 0, 0).pwm, 174);
    for _ in 1..320 {
        law.tick(&mut axis, 4, 0, 0);
    }
    // 14 plus 0.05 * 4 * 320.
    let pwm = law.tick(&mut axis, 4, 0, 0).pwm;
    assert!((77..=79).contains(&pwm), "{pwm}");
    for derivative in [128.0, -1.0, f64::NAN, f64::INFINITY] {
        assert_eq!(
            Gains {
                derivative,
                ..gains
            }
            .to_servo(),
            None
        );
    }
    let most = Gains {
        derivative: 32_767.4 / 256.0,
        ..gains
    };
    assert_eq!(most.to_servo().unwrap().derivative, 0x7fff);
}

#[test]
fn what_cannot_be_determined() {
    assert_eq!(step_response(&[0.0, 1.0], 1.0, 1.0, 1.0, 0.02), None);
    assert_eq!(step_response(&[0.0, 0.5], 1.0, 0.0, 1.0, 0.02), None);
    assert_eq!(step_response(&[0.0, 1.0, 2.0], 1.0, 0.0, 1.0, 0.02), None);
    assert_eq!(oscillation(&[-1.0, 1.0, 2.0], 1.0, 0.0), None);
    let small = Oscillation {
        amplitude: 1.0,
        period_s: 1.0,
        periods: 3,
    };
    assert_eq!(Relay::new(1.0, 2.0).ultimate(&small), None);
    let with_hysteresis = Relay::new(std::f64::consts::PI, 3.0)
        .ultimate(&Oscillation {
            amplitude: 5.0,
            ..small
        })
        .unwrap();
    assert!((with_hysteresis.gain - 1.0).abs() < 1e-12);
}

#[test]
fn relay_turns_over_beyond_its_hysteresis() {
    let mut relay = Relay::new(2.0, 1.0);
    assert_eq!(
        [0.5, -0.5, -1.5, 0.5, 1.5].map(|error| relay.update(error)),
        [2.0, 2.0, -2.0, -2.0, 2.0]
    );
}

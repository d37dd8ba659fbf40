//! Experiments on motors without friction, whose ultimate point is known, and on the motor of the
//! prototype.

use super::direct::Direct;
use super::fit::fit;
use super::moves::check;
use super::relay::{RelaySettings, relay};
use super::stand::Stand;
use super::stepwise::stepwise;
use super::ultimate::ultimate;
use crate::simulated::one_axis;
use fixed::types::{I16F16, I32F0};
use husillo_pid::tuning::{Rule, Ultimate};
use husillo_pid::{Conditional, Integration, Limits, Pid, State};
use husillo_sim::{DcMotor, DcMotorModel, SERVO_PERIOD_S};

/// A motor with viscous friction only, without inductance, and with an encoder that is finer than
/// that of any module.
const LINEAR: DcMotorModel = DcMotorModel {
    inductance_h: 1e-9,
    coulomb_nm: 0.0,
    stiction_nm: 0.0,
    counts_per_revolution: 10_000,
    ..DcMotorModel::PROTOTYPE
};

/// The ultimate point of the axis `K / (s (1 + s T1))` under proportional control. The controller
/// samples the axis every `period_s` and holds its output in between.
///
/// With `a = exp(-T/T1)` the sampled axis is `(b1 z + b0) / ((z - 1)(z - a))`, `b1 = K (T - T1 (1 -
/// a))`, `b0 = K (T1 (1 - a) - a T)`. The poles of the closed loop are the zeros of `z^2 - (1 + a -
/// k b1) z + a + k b0`. At the ultimate gain their product is 1, so they are on the unit circle.
/// The cosine of their angle is half of their sum.
fn known(model: &DcMotorModel, period_s: f64) -> Ultimate {
    let slope = model.constant_nm_per_a.powi(2) / model.resistance_ohm + model.viscous_nm_s;
    let lag_s = model.inertia_kg_m2 / slope;
    let torque = model.supply_v / model.resistance_ohm * model.constant_nm_per_a;
    let turns = torque / slope / std::f64::consts::TAU / 255.0;
    let rate = turns * f64::from(model.counts_per_revolution);
    let a = (-period_s / lag_s).exp();
    let b1 = rate * (period_s - lag_s * (1.0 - a));
    let b0 = rate * (lag_s * (1.0 - a) - a * period_s);
    let gain = (1.0 - a) / b0;
    let angle = (0.5 * (1.0 + a - gain * b1)).acos();
    Ultimate {
        gain,
        period_s: std::f64::consts::TAU * period_s / angle,
    }
}

/// The same motor with an inductance. Its lag, not the sampling, determines the ultimate point.
const SLOW: DcMotorModel = DcMotorModel {
    inductance_h: 0.1,
    ..LINEAR
};

/// The ultimate point of [`SLOW`] by the criterion of Routh. `L J s^3 + (R J + L b) s^2 + (R b +
/// k^2) s + Kp U k / 255 = 0` has poles on the imaginary axis if the products of the inner and of
/// the outer coefficients are equal.
fn known_of_slow(model: &DcMotorModel) -> Ultimate {
    let m = model;
    let inner = m.resistance_ohm * m.viscous_nm_s + m.constant_nm_per_a.powi(2);
    let square = m.resistance_ohm * m.inertia_kg_m2 + m.inductance_h * m.viscous_nm_s;
    let cubic = m.inductance_h * m.inertia_kg_m2;
    let counts_per_rad = f64::from(m.counts_per_revolution) / std::f64::consts::TAU;
    let drive = m.supply_v / 255.0 * m.constant_nm_per_a * counts_per_rad;
    Ultimate {
        gain: square * inner / cubic / drive,
        period_s: std::f64::consts::TAU / (inner / cubic).sqrt(),
    }
}

/// A stand for a motor, with room for its oscillation.
fn stand(model: DcMotorModel, rate_divisor: u8) -> Stand {
    let mut file = one_axis().axis('x').unwrap();
    file.gains.rate_divisor = rate_divisor;
    file.gains.error_limit = 0x3fff;
    Stand::new(Box::new(Direct::new(model)), file).unwrap()
}

fn near(found: &Ultimate, wanted: &Ultimate, gain: f64, period: f64) {
    let parts = [found.gain / wanted.gain, found.period_s / wanted.period_s];
    assert!(
        (parts[0] - 1.0).abs() <= gain && (parts[1] - 1.0).abs() <= period,
        "{found:?} for {wanted:?}: {parts:?}"
    );
}

fn by_gain(model: DcMotorModel, rate_divisor: u8) -> Ultimate {
    let found = ultimate(&mut stand(model, rate_divisor), &mut Vec::new()).unwrap();
    let (found, divisor) = found.unwrap();
    assert_eq!(divisor, rate_divisor);
    found
}

fn by_relay(model: DcMotorModel, hysteresis: u16) -> Ultimate {
    let settings = RelaySettings {
        amplitude: 200,
        hysteresis,
    };
    relay(&mut stand(model, 1), settings).unwrap().1
}

/// The search with a rising gain finds the ultimate point of the sampled loop at every divisor. The
/// gain is right within 5 %, and the period within 2 %.
#[test]
fn the_ultimate_gain_of_a_sampled_loop() {
    for divisor in [1, 2, 4, 8, 16] {
        let wanted = known(&LINEAR, SERVO_PERIOD_S * f64::from(divisor));
        near(&by_gain(LINEAR, divisor), &wanted, 0.05, 0.02);
    }
}

/// Both methods find the same point. The rising gain finds the gain within 5 %. The relay finds the
/// gain within 8 % and the period within 4 %, because its describing function neglects harmonics.
/// So they agree within 10 %. As expected, a hysteresis moves the point of the relay to a lower
/// gain and a longer period.
#[test]
fn relay_and_ultimate_gain_agree() {
    let wanted = known_of_slow(&SLOW);
    let (gain, relay) = (by_gain(SLOW, 1), by_relay(SLOW, 0));
    near(&gain, &wanted, 0.05, 0.02);
    near(&relay, &wanted, 0.08, 0.04);
    near(&relay, &gain, 0.1, 0.05);
    let wide = by_relay(SLOW, 40);
    assert!(wide.gain < relay.gain && wide.period_s > relay.period_s);
    near(&wide, &wanted, 0.25, 0.15);
}

/// With friction and 400 counts per revolution the gains of both methods agree within 30 %, and the
/// periods within 10 %.
#[test]
fn they_agree_on_the_prototype() {
    let prototype = DcMotorModel::PROTOTYPE;
    let mut slower = stand(prototype, 1);
    let (gain, divisor) = ultimate(&mut slower, &mut Vec::new()).unwrap().unwrap();
    // Friction and whole counts prevent an oscillation at the full rate.
    assert_eq!(divisor, 4);
    near(&by_relay(prototype, 0), &gain, 0.3, 0.1);
}

/// With the gains of every method, all 300 moves end at most a count from their goals.
#[test]
fn gains_place_every_move() {
    let prototype = || stand(DcMotorModel::PROTOTYPE, 1);
    let limits = one_axis().axis('x').unwrap().gains;
    let (gain, _) = ultimate(&mut prototype(), &mut Vec::new())
        .unwrap()
        .unwrap();
    let relay = by_relay(DcMotorModel::PROTOTYPE, 0);
    let mut all = vec![
        limits,
        stepwise(&mut prototype(), 100, &mut Vec::new(), &mut Vec::new()).unwrap(),
    ];
    for point in [gain, relay] {
        for rule in [Rule::ZieglerNicholsPid, Rule::TyreusLuybenPid] {
            all.push(fit(point.gains(rule), &limits).unwrap().0);
        }
    }
    for gains in all {
        let result = check(&mut prototype(), &gains, 300).unwrap();
        assert!(
            result.is_good() && result.moves == 300,
            "{gains:?} {result:?}"
        );
    }
}

/// Because of its friction the prototype oscillates at no gain. So the search ends at its bounds,
/// and a note reports this. Without friction and with a slow winding, the search for the
/// proportional gain ends with an oscillation, and there is no note about it.
#[test]
fn stepwise_says_where_there_was_no_oscillation() {
    let (mut trials, mut notes) = (Vec::new(), Vec::new());
    let mut prototype = stand(DcMotorModel::PROTOTYPE, 1);
    let gains = stepwise(&mut prototype, 100, &mut trials, &mut notes).unwrap();
    assert_eq!((gains.proportional, gains.derivative), (4080, 8160));
    let about = [
        "derivative gain up to 16320",
        "proportional gain up to 8160",
    ];
    for (note, about) in notes.iter().zip(about) {
        assert!(note.contains(about), "{note}");
    }
    assert!(
        trials
            .iter()
            .all(|trial| trial.p <= 8160 && trial.d <= 16_320)
    );

    let (mut trials, mut notes) = (Vec::new(), Vec::new());
    let gains = stepwise(&mut stand(SLOW, 1), 100, &mut trials, &mut notes).unwrap();
    // The motor vibrates at 400, and with any integral gain.
    assert!(
        trials
            .iter()
            .any(|trial| trial.result.starts_with("vibrates"))
    );
    assert_eq!(gains.proportional, 200);
    assert_eq!(notes.len(), 1, "{notes:?}");
    assert!(notes[0].starts_with("no derivative gain"), "{notes:?}");
}

/// The gains of a rule also hold the motor with the controller of the crate `pid`. Its gains are
/// not limited to 0x7FFF, so they are used unchanged, in fixed point.
#[test]
fn gains_hold_the_motor_with_a_pid() {
    let relay = by_relay(DcMotorModel::PROTOTYPE, 0);
    for rule in [Rule::ZieglerNicholsPid, Rule::TyreusLuybenPid] {
        let gains = relay.gains(rule).per_sample(SERVO_PERIOD_S);
        let limits = Limits {
            low: I32F0::from_num(-255),
            high: I32F0::from_num(255),
        };
        let gains = gains.to_fixed::<I16F16>().unwrap();
        let pid = Pid::new(gains, Integration::Backward, limits).unwrap();
        let pid = pid.with_anti_windup(Conditional);
        let (mut motor, mut state) = (DcMotor::new(DcMotorModel::PROTOTYPE), State::default());
        let mut farthest = 0;
        for (goal, tick) in [100, -30, 2, 1000]
            .iter()
            .flat_map(|goal| (0..4000).map(move |tick| (*goal, tick)))
        {
            let counts = motor.counts() as i32;
            let drive = pid.update(&mut state, I32F0::from_num(goal), I32F0::from_num(counts));
            motor.advance(
                f64::from(drive.to_num::<i32>()) / 255.0,
                0.0,
                SERVO_PERIOD_S,
            );
            // The last half of two seconds.
            if tick >= 3000 {
                farthest = farthest.max(counts.abs_diff(goal));
            }
        }
        assert!(farthest <= 1, "{rule:?} {farthest}");
    }
}

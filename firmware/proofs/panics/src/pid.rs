//! The public functions of `husillo-pid`.

use core::hint::black_box;

use embedded_hal::digital::{self, OutputPin};
use embedded_hal::pwm::{self, SetDutyCycle};
use fixed::types::{I8F8, I16F16, I32F0, I32F32};
use husillo_pid::tuning::{Relay, Ultimate, oscillation, step_response};
use husillo_pid::{
    AntiWindup, BackCalculation, Biquad, BiquadState, Clamp, Coefficients, Conditional, DeadBand,
    Derivative, Drive, FeedForward, Filter, FilterState, Gains, Integration, Number, OfError,
    OfMeasurement, Pid, PwmDirection, Regulator, SecondOrder, ServoLaw, ServoState, State, Term,
    error, sign_magnitude,
};

/// Keeps every function in the program.
#[unsafe(export_name = "pid")]
pub fn keep() {
    controller::<I32F0, I16F16>();
    controller::<I16F16, I16F16>();
    controller::<I8F8, I8F8>();
    controller::<f32, f32>();
    controller::<i32, I16F16>();
    controller::<i16, I16F16>();
    controller::<i8, I16F16>();
    controller::<i64, I32F32>();
    controller::<I32F32, I32F32>();
    black_box([
        Integration::formula as *const (),
        SecondOrder::notch as *const (),
        SecondOrder::lead_lag as *const (),
        SecondOrder::low_pass as *const (),
        SecondOrder::bilinear as *const (),
        Coefficients::numerator as *const (),
        Coefficients::denominator as *const (),
        Coefficients::bits as *const (),
        BackCalculation::<i32>::new::<I16F16> as *const (),
        BackCalculation::<f32>::new::<f32> as *const (),
        Filter::new as *const (),
        Filter::of_time_constant as *const (),
        Drive::signed as *const (),
        ServoLaw::new as *const (),
        ServoLaw::is_due as *const (),
        ServoLaw::tick as *const (),
        ServoLaw::open_loop as *const (),
        <ServoLaw as Regulator>::begin as *const (),
        <ServoLaw as Regulator>::has_given_up as *const (),
        <ServoLaw as Regulator>::is_over_current as *const (),
        <ServoLaw as Regulator>::regulate as *const (),
        <Pid<I32F0, I16F16> as Regulator>::begin as *const (),
        <Pid<I32F0, I16F16> as Regulator>::regulate as *const (),
        ServoState::on as *const (),
        ServoState::off as *const (),
        ServoState::is_on as *const (),
        ServoState::is_over_current as *const (),
        ServoState::error_counts as *const (),
        ServoState::total_counts as *const (),
        ServoState::output as *const (),
        sign_magnitude as *const (),
        <Clamp as AntiWindup<i32>>::next as *const (),
        <Conditional as AntiWindup<i32>>::next as *const (),
        <BackCalculation as AntiWindup<i32>>::next as *const (),
        <OfError as Derivative>::source::<i32> as *const (),
        <OfMeasurement as Derivative>::source::<i32> as *const (),
        step_response as *const (),
        oscillation as *const (),
        Relay::new as *const (),
        Relay::update as *const (),
        Relay::ultimate as *const (),
        Ultimate::gains as *const (),
        Gains::<f64>::per_sample as *const (),
        Gains::<f64>::to_servo as *const (),
        Gains::<f64>::to_fixed::<I16F16> as *const (),
        PwmDirection::<Output, Output>::new as *const (),
        PwmDirection::<Output, Output>::set as *const (),
        PwmDirection::<Output, Output>::release as *const (),
    ]);
}

fn controller<S: Number, G: Number<Word = S::Word>>() {
    black_box([
        Pid::<S, G>::new as *const (),
        Pid::<S, G>::with_anti_windup::<Conditional> as *const (),
        Pid::<S, G>::with_anti_windup::<BackCalculation<S::Word>> as *const (),
        Pid::<S, G>::with_derivative::<OfMeasurement> as *const (),
        Term::<S, G>::constant as *const (),
        Term::<S, G>::plus as *const (),
        State::<S>::difference as *const (),
        error::<S> as *const (),
        Gains::<G>::per_sample_ns as *const (),
        Biquad::<S>::new as *const (),
        Biquad::<S>::update as *const (),
        Biquad::<S>::follow as *const (),
        BiquadState::<S>::default as *const (),
        DeadBand::<S>::new as *const (),
        DeadBand::<S>::apply as *const (),
        FeedForward::<G>::new as *const (),
        FeedForward::<G>::term::<S> as *const (),
        Filter::apply::<S, G> as *const (),
        FilterState::<S, G>::default as *const (),
    ]);
    law::<S, G, Clamp, OfError>();
    law::<S, G, Conditional, OfMeasurement>();
    law::<S, G, BackCalculation<S::Word>, OfError>();
}

fn law<S: Number, G: Number<Word = S::Word>, A: AntiWindup<S::Word>, D: Derivative>() {
    black_box([
        Pid::<S, G, A, D>::with_integral_limits as *const (),
        Pid::<S, G, A, D>::update as *const (),
        Pid::<S, G, A, D>::update_with as *const (),
        Pid::<S, G, A, D>::derivative as *const (),
        Pid::<S, G, A, D>::follow as *const (),
        Pid::<S, G, A, D>::integral as *const (),
    ]);
}

/// A pin and a channel that can fail.
struct Output(bool);

#[derive(Debug)]
struct Failed;

impl digital::Error for Failed {
    fn kind(&self) -> digital::ErrorKind {
        digital::ErrorKind::Other
    }
}

impl pwm::Error for Failed {
    fn kind(&self) -> pwm::ErrorKind {
        pwm::ErrorKind::Other
    }
}

impl digital::ErrorType for Output {
    type Error = Failed;
}

impl pwm::ErrorType for Output {
    type Error = Failed;
}

impl OutputPin for Output {
    fn set_low(&mut self) -> Result<(), Failed> {
        black_box(self.0).then_some(()).ok_or(Failed)
    }

    fn set_high(&mut self) -> Result<(), Failed> {
        black_box(self.0).then_some(()).ok_or(Failed)
    }
}

impl SetDutyCycle for Output {
    fn max_duty_cycle(&self) -> u16 {
        black_box(1000)
    }

    fn set_duty_cycle(&mut self, _duty: u16) -> Result<(), Failed> {
        black_box(self.0).then_some(()).ok_or(Failed)
    }
}

//! The public functions of `husillo-planner`.

use core::hint::black_box;

use husillo_planner::{
    ArcLimits, AxisTimers, Burst, Bursts, Follower, JerkRamp, JerkWindow, Junction, Limits,
    LookAhead, Piece, Ramp, Recurrence, Replay, SCurve, ServoLine, ServoPeriod, ServoProfile,
    Slice, Stretch, SurfaceSpeed, Tangent, Timer, Trapezoid, UnitRates, Upper, Waits,
    fixed::types::I32F32, mul_div, mul_div_q16, nanometres, share, times,
};

/// Keeps every function in the program.
#[unsafe(export_name = "planner")]
pub fn keep() {
    black_box([
        Timer::new as *const (),
        Timer::with_fraction_bits as *const (),
        Timer::wait as *const (),
        Timer::wait_one as *const (),
        timer_fill as *const (),
        Timer::fraction_bits as *const (),
        Timer::rate as *const (),
    ]);
    path();
    jerk();
    profiles();
    streams();
    servo();
    durations();
    units();
}

fn units() {
    black_box([
        nanometres::<I32F32> as *const (),
        UnitRates::<I32F32>::rates::<I32F32> as *const (),
        ServoPeriod::new as *const (),
        ServoPeriod::velocity::<I32F32> as *const (),
        ServoPeriod::acceleration::<I32F32> as *const (),
        ServoPeriod::counts_per_s::<I32F32> as *const (),
        ServoPeriod::counts_per_s2::<I32F32> as *const (),
    ]);
}

fn durations() {
    black_box([
        mul_div as *const (),
        mul_div_q16 as *const (),
        share as *const (),
        times as *const (),
        SurfaceSpeed::new as *const (),
        SurfaceSpeed::at as *const (),
    ]);
}

fn path() {
    black_box([
        Stretch::top_at as *const (),
        Stretch::levels as *const (),
        LookAhead::<u32, 16>::new as *const (),
        LookAhead::<u32, 16>::push as *const (),
        LookAhead::<u32, 16>::pop as *const (),
        LookAhead::<u32, 16>::front as *const (),
        LookAhead::<u32, 16>::back as *const (),
        LookAhead::<u32, 16>::limits as *const (),
        LookAhead::<u32, 16>::set_override as *const (),
        LookAhead::<u32, 16>::set_rapid_override as *const (),
        LookAhead::<u32, 16>::percent as *const (),
        LookAhead::<u32, 16>::len as *const (),
        LookAhead::<u32, 16>::is_empty as *const (),
        LookAhead::<u32, 16>::is_full as *const (),
        LookAhead::<u32, 16>::clear as *const (),
        Ramp::new as *const (),
        Ramp::begin as *const (),
        Ramp::wait as *const (),
        Ramp::take_piece as *const (),
        ramp_fill as *const (),
        Ramp::room as *const (),
        ramp_fill_swept as *const (),
        Piece::next as *const (),
        Ramp::hold as *const (),
        Ramp::resume as *const (),
        Ramp::is_held as *const (),
        Ramp::stop as *const (),
        Ramp::speed_nm_per_s as *const (),
        Tangent::<3>::new as *const (),
        Tangent::<3>::with_length as *const (),
        Tangent::<3>::from_units as *const (),
        Tangent::<3>::components as *const (),
        Tangent::<3>::reversed as *const (),
        Tangent::<3>::speed_limit as *const (),
        Tangent::<3>::acceleration_limit as *const (),
        Junction::<3>::speed as *const (),
        ArcLimits::new as *const (),
        Upper::new as *const (),
    ]);
}

fn jerk() {
    black_box([
        JerkWindow::<u32, 16>::new as *const (),
        JerkWindow::<u32, 16>::push as *const (),
        JerkWindow::<u32, 16>::finish as *const (),
        JerkWindow::<u32, 16>::pop as *const (),
        JerkWindow::<u32, 16>::front as *const (),
        JerkWindow::<u32, 16>::back as *const (),
        JerkWindow::<u32, 16>::len as *const (),
        JerkWindow::<u32, 16>::is_empty as *const (),
        JerkWindow::<u32, 16>::is_full as *const (),
        JerkWindow::<u32, 16>::clear as *const (),
        JerkWindow::<u32, 16>::hold as *const (),
        JerkWindow::<u32, 16>::resume as *const (),
        JerkWindow::<u32, 16>::is_held as *const (),
        JerkWindow::<u32, 16>::percent as *const (),
        JerkWindow::<u32, 16>::set_override as *const (),
        JerkWindow::<u32, 16>::set_rapid_override as *const (),
        JerkWindow::<u32, 16>::units_per_nm as *const (),
        JerkWindow::<u32, 16>::slice_ticks_q32 as *const (),
        JerkWindow::<u32, 16>::is_at_rest as *const (),
        JerkWindow::<u32, 16>::next_slice as *const (),
        Slice::length as *const (),
        Slice::end_speed as *const (),
        JerkRamp::new as *const (),
        JerkRamp::begin::<u32, 16> as *const (),
        JerkRamp::wait::<u32, 16> as *const (),
        jerk_ramp_fill as *const (),
        JerkRamp::is_at_rest::<u32, 16> as *const (),
        JerkRamp::speed_nm_per_s::<u32, 16> as *const (),
        JerkRamp::stop as *const (),
    ]);
}

fn profiles() {
    black_box([
        Trapezoid::new as *const (),
        Trapezoid::remaining as *const (),
        Trapezoid::rate_hz as *const (),
        Trapezoid::set_top_rate as *const (),
        Trapezoid::set_remaining as *const (),
        Trapezoid::hold as *const (),
        Trapezoid::resume as *const (),
        Trapezoid::is_held as *const (),
        <Trapezoid as Iterator>::next as *const (),
        <Trapezoid as Iterator>::size_hint as *const (),
        Recurrence::new as *const (),
        <Recurrence as Iterator>::next as *const (),
        <Recurrence as Iterator>::size_hint as *const (),
        SCurve::new as *const (),
        SCurve::remaining as *const (),
        SCurve::set_top_rate as *const (),
        SCurve::set_remaining as *const (),
        SCurve::rate_hz as *const (),
        SCurve::hold as *const (),
        SCurve::resume as *const (),
        SCurve::is_held as *const (),
        <SCurve as Iterator>::next as *const (),
        <SCurve as Iterator>::size_hint as *const (),
    ]);
}

fn streams() {
    black_box([
        Burst::replay as *const (),
        <Replay as Iterator>::next as *const (),
        <Replay as Iterator>::size_hint as *const (),
        Bursts::<Replay>::new as *const (),
        <Bursts<Replay> as Iterator>::next as *const (),
        AxisTimers::<3>::new as *const (),
        AxisTimers::<3>::rest_ticks as *const (),
        <AxisTimers<3> as Iterator>::next as *const (),
        Follower::new as *const (),
        Follower::measure as *const (),
        Follower::due as *const (),
        Follower::advance as *const (),
        Follower::advance_by as *const (),
        Follower::counts_ahead as *const (),
    ]);
}

fn servo() {
    black_box([
        ServoProfile::new as *const (),
        ServoProfile::start as *const (),
        ServoProfile::switch_off as *const (),
        ServoProfile::stop_abruptly as *const (),
        ServoProfile::stop_at as *const (),
        ServoProfile::stop_smoothly as *const (),
        ServoProfile::set_position as *const (),
        ServoProfile::tick as *const (),
        ServoProfile::position as *const (),
        ServoProfile::position_48 as *const (),
        ServoProfile::velocity as *const (),
        ServoProfile::is_done as *const (),
        ServoProfile::is_servo_on as *const (),
        ServoProfile::duty as *const (),
        ServoProfile::is_acceleration_done as *const (),
        ServoProfile::is_slew_done as *const (),
        ServoLine::<3>::new as *const (),
        ServoLine::<3>::deviation as *const (),
        ServoLine::<3>::skew_ticks as *const (),
    ]);
}

fn timer_fill(timer: &mut Timer, places: &mut [u32]) -> Waits {
    Timer::fill(timer, places.iter_mut())
}

fn ramp_fill(ramp: &mut Ramp, places: &mut [u32], limits: &Limits) -> Waits {
    Ramp::fill(ramp, places.iter_mut(), limits)
}

fn ramp_fill_swept(ramp: &mut Ramp, places: &mut [u32]) -> Waits {
    Ramp::fill_swept(ramp, places.iter_mut())
}

fn jerk_ramp_fill(
    ramp: &mut JerkRamp,
    places: &mut [u32],
    window: &mut JerkWindow<u32, 16>,
) -> Waits {
    JerkRamp::fill(ramp, places.iter_mut(), window)
}

//! The public functions of `husillo-planner`.

use core::hint::black_box;

use husillo_planner::{
    AxisTimers, Burst, Bursts, Follower, Recurrence, Replay, SCurve, Timer, Trapezoid,
};

/// Keeps every function in the program.
pub fn keep() {
    black_box([
        Timer::new as *const (),
        Timer::with_fraction_bits as *const (),
        Timer::wait as *const (),
        Timer::fraction_bits as *const (),
        Timer::rate as *const (),
    ]);
    profiles();
    streams();
}

fn profiles() {
    black_box([
        Trapezoid::new as *const (),
        Trapezoid::remaining as *const (),
        Trapezoid::rate_hz as *const (),
        Trapezoid::set_top_rate as *const (),
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
        Follower::counts_ahead as *const (),
    ]);
}

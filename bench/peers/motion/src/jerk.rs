//! Jerk-limited motion from standstill to standstill.

use std::hint::black_box;

use husillo_planner::{JerkLimits, JerkWindow, Rates, SCurve, Stretch};
use rsruckig::prelude::{DataArrayOrVec, InputParameter, Ruckig, ThrowErrorHandler, Trajectory};

use crate::race::{Candidate, race};

const RATES: Rates = Rates {
    timer_hz: 1_000_000,
    start_rate_hz: 0,
    top_rate_hz: 8_000,
    end_rate_hz: 0,
    acceleration_hz_per_s: 20_000,
};
const JERK_HZ_PER_S2: u32 = 100_000;
const EVENTS: u32 = 10_000;

/// The time-optimal one with all seven phases: n / v + v / a + a / j.
fn truth() -> f64 {
    let [v, a, j] = [
        RATES.top_rate_hz,
        RATES.acceleration_hz_per_s,
        JERK_HZ_PER_S2,
    ]
    .map(f64::from);
    f64::from(EVENTS) / v + v / a + a / j
}

fn cells(seconds: f64, gives: &str) -> Vec<String> {
    let longer = 1e6 * (seconds / truth() - 1.0);
    vec![format!("{longer:+.1} ppm"), gives.into()]
}

fn ruckig() -> (Ruckig<1, ThrowErrorHandler>, InputParameter<1>) {
    let mut input = InputParameter::new(None);
    input.target_position[0] = f64::from(EVENTS);
    input.max_velocity[0] = RATES.top_rate_hz.into();
    input.max_acceleration[0] = RATES.acceleration_hz_per_s.into();
    input.max_jerk[0] = JERK_HZ_PER_S2.into();
    (Ruckig::new(None, 0.001), input)
}

pub fn limited() {
    let profile = SCurve::new(&RATES, JERK_HZ_PER_S2, EVENTS).expect("rates within range");
    let ticks: u64 = profile.clone().map(u64::from).sum();
    let own = ticks as f64 / f64::from(RATES.timer_hz);
    let (mut calculator, input) = ruckig();
    let mut trajectory = Trajectory::new(None);
    calculator
        .calculate(&input, &mut trajectory)
        .expect("a trajectory");
    let theirs = trajectory.get_duration();

    let set_up = vec![
        Candidate {
            name: "husillo `SCurve`",
            cells: cells(own, "intervals of all steps"),
            run: Box::new(|| {
                black_box(SCurve::new(black_box(&RATES), JERK_HZ_PER_S2, EVENTS)).ok();
                1
            }),
        },
        Candidate {
            name: "rsruckig",
            cells: cells(theirs, "position at a time"),
            run: Box::new({
                let (mut calculator, input) = ruckig();
                let mut trajectory = Trajectory::new(None);
                move || {
                    black_box(calculator.calculate(black_box(&input), &mut trajectory)).ok();
                    1
                }
            }),
        },
    ];
    let columns = ["time of the move", "gives"];
    race("jerk-limited profile, set-up", "per move", &columns, set_up);

    let events = vec![
        Candidate {
            name: "husillo `SCurve`, an interval",
            cells: cells(own, "intervals of all steps"),
            run: Box::new(move || {
                for ticks in black_box(profile.clone()) {
                    black_box(ticks);
                }
                EVENTS.into()
            }),
        },
        Candidate {
            name: "rsruckig `at_time`, as often",
            cells: cells(theirs, "position at a time"),
            run: Box::new(move || {
                let mut position = DataArrayOrVec::new(None, 0.0);
                for number in 0..EVENTS {
                    let time = theirs * f64::from(number) / f64::from(EVENTS);
                    let [mut velocity, mut acceleration, mut jerk] = [None, None, None];
                    trajectory.at_time(
                        time,
                        &mut Some(&mut position),
                        &mut velocity,
                        &mut acceleration,
                        &mut jerk,
                        &mut None,
                    );
                    black_box(position[0]);
                }
                EVENTS.into()
            }),
        },
    ];
    race(
        "jerk-limited profile, walking",
        "per event",
        &columns,
        events,
    );
}

/// Single moves from rest to rest, at 1 m/s^2, 20 m/s^3 and up to 300 mm/s: time of the window
/// divided by that of the optimum, for lengths in nm.
pub fn single_moves() {
    println!("| one move, 1 m/s^2, 20 m/s^3 | husillo `JerkWindow`, s | rsruckig, s | ratio |");
    println!("| --- | --- | --- | --- |");
    for length in [
        200_000_000,
        50_000_000,
        10_000_000,
        1_000_000,
        100_000,
        10_000,
    ] {
        let (own, theirs) = (window_seconds(length), optimum_seconds(length));
        let mm = length as f64 / 1e6;
        println!("| {mm} mm | {own:.6} | {theirs:.6} | {:.4} |", own / theirs);
    }
}

fn window_seconds(length_nm: u64) -> f64 {
    let limits = JerkLimits {
        acceleration_nm_per_s2: 1_000_000_000,
        jerk_nm_per_s3: 20_000_000_000,
        highest_nm_per_s: 300_000_000,
    };
    let mut window = JerkWindow::<(), 2>::new(&limits).expect("limits within range");
    let stretch = Stretch {
        length_nm,
        top_nm_per_s: limits.highest_nm_per_s,
        ceiling_nm_per_s: limits.highest_nm_per_s,
        obeys_override: true,
        acceleration_nm_per_s2: limits.acceleration_nm_per_s2,
        start_nm_per_s: 0,
        upper: None,
        entry_limit_nm_per_s: 0,
    };
    window.push(stretch, ()).expect("room for two");
    window.finish();
    let slices = std::iter::from_fn(|| window.next_slice()).count();
    let slice = window.slice_ticks_q32(1_000_000_000) as f64 / 2_f64.powi(32) / 1e9;
    slices as f64 * slice
}

fn optimum_seconds(length_nm: u64) -> f64 {
    let mut input: InputParameter<1> = InputParameter::new(None);
    input.target_position[0] = length_nm as f64 / 1e6;
    input.max_velocity[0] = 300.0;
    input.max_acceleration[0] = 1_000.0;
    input.max_jerk[0] = 20_000.0;
    let mut calculator: Ruckig<1, ThrowErrorHandler> = Ruckig::new(None, 0.001);
    let mut trajectory = Trajectory::new(None);
    calculator
        .calculate(&input, &mut trajectory)
        .expect("a trajectory");
    trajectory.get_duration()
}

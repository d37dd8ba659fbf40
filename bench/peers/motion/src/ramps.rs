//! Constant acceleration up, constant rate, constant acceleration down.

use std::hint::black_box;

use husillo_planner::{Rates, Recurrence, Trapezoid};
use ramp_maker::{MotionProfile, Trapezoidal};

use crate::race::{Candidate, race};

const TIMER_HZ: u32 = 1_000_000;

struct Job {
    acceleration: u32,
    top: u32,
    events: u32,
}

impl Job {
    fn rates(&self) -> Rates {
        Rates {
            timer_hz: TIMER_HZ,
            start_rate_hz: 0,
            top_rate_hz: self.top,
            end_rate_hz: 0,
            acceleration_hz_per_s: self.acceleration,
        }
    }

    /// Time of event `number`, counted from 1, on the true trapezoid.
    fn time(&self, number: u32) -> f64 {
        let (a, v) = (f64::from(self.acceleration), f64::from(self.top));
        let (n, s) = (f64::from(number), f64::from(self.events));
        // Length of either ramp; the top rate is reached in all jobs here.
        let ramp = v * v / (2.0 * a);
        let total = s / v + v / a;
        if n <= ramp {
            (2.0 * n / a).sqrt()
        } else if n <= s - ramp {
            v / a + (n - ramp) / v
        } else {
            total - (2.0 * (s - n).max(0.0) / a).sqrt()
        }
    }

    /// Surplus events, time of the whole move, and the largest time error of an event.
    fn cells(&self, intervals: &[f64]) -> Vec<String> {
        let (mut at, mut farthest) = (0.0, 0.0_f64);
        for (interval, number) in intervals.iter().zip(1..=self.events) {
            at += interval;
            farthest = farthest.max((at - self.time(number)).abs());
        }
        let total: f64 = intervals.iter().sum();
        let truth = self.time(self.events);
        vec![
            format!("{:+}", intervals.len() as i64 - i64::from(self.events)),
            format!("{:+.4} %", 100.0 * (total / truth - 1.0)),
            format!("{:.1}", farthest * 1e6),
        ]
    }
}

fn seconds(intervals: impl Iterator<Item = u32>) -> Vec<f64> {
    intervals
        .map(|ticks| f64::from(ticks) / f64::from(TIMER_HZ))
        .collect()
}

fn walk(intervals: impl Iterator<Item = u32>) -> u64 {
    let mut events = 0;
    for ticks in intervals {
        black_box(ticks);
        events += 1;
    }
    events
}

/// With some number types ramp-maker never ends; twice the events are enough to detect it.
fn peer<Profile: MotionProfile>(mut profile: Profile, top: Profile::Velocity, events: u32) -> u64 {
    profile.enter_position_mode(top, events);
    let mut given = 0;
    while let Some(delay) = profile.next_delay() {
        black_box(delay);
        given += 1;
        if given == 2 * u64::from(events) {
            break;
        }
    }
    given
}

fn peer_seconds<Profile: MotionProfile>(
    mut profile: Profile,
    top: Profile::Velocity,
    events: u32,
    in_seconds: impl Fn(Profile::Delay) -> f64,
) -> Vec<f64> {
    profile.enter_position_mode(top, events);
    profile
        .delays()
        .take(2 * events as usize)
        .map(in_seconds)
        .collect()
}

type Fixed = ramp_maker::trapezoidal::DefaultNum;

fn table(title: &str, job: &Job) {
    let rates = job.rates();
    let (a, v, n) = (job.acceleration, job.top, job.events);
    let fits = "rates within range";
    let trapezoid = Trapezoid::new(&rates, n).expect(fits);
    let recurrence = Recurrence::new(&rates, n).expect(fits);
    let single = || Trapezoidal::new(a as f32);
    let double = || Trapezoidal::new(f64::from(a));
    let fixed = || Trapezoidal::new(Fixed::from_num(a));
    let top = Fixed::from_num(v);
    let candidates = vec![
        Candidate {
            name: "husillo `Trapezoid`",
            cells: job.cells(&seconds(trapezoid)),
            run: Box::new(|| Trapezoid::new(black_box(&rates), n).map_or(0, walk)),
        },
        Candidate {
            name: "husillo `Recurrence`",
            cells: job.cells(&seconds(recurrence)),
            run: Box::new(|| Recurrence::new(black_box(&rates), n).map_or(0, walk)),
        },
        Candidate {
            name: "ramp-maker, `f32`",
            cells: job.cells(&peer_seconds(single(), v as f32, n, f64::from)),
            run: Box::new(|| peer(black_box(single()), black_box(v as f32), n)),
        },
        Candidate {
            name: "ramp-maker, `f64`",
            cells: job.cells(&peer_seconds(double(), f64::from(v), n, |delay| delay)),
            run: Box::new(|| peer(black_box(double()), black_box(f64::from(v)), n)),
        },
        Candidate {
            name: "ramp-maker, its default `FixedU64<U32>`",
            cells: job.cells(&peer_seconds(fixed(), top, n, |delay| delay.to_num())),
            run: Box::new(|| peer(black_box(fixed()), black_box(top), n)),
        },
    ];
    let columns = [
        "surplus events",
        "time of the move",
        "largest time error of an event, us",
    ];
    race(title, "per event", &columns, candidates);
}

/// A move that is nearly all ramp.
pub fn short() {
    let job = Job {
        acceleration: 20_000,
        top: 8_000,
        events: 4_000,
    };
    table(
        "ramp to 8 000 steps/s at 20 000 steps/s^2, 4 000 steps",
        &job,
    );
}

/// Rates of a fast servo.
pub fn fast() {
    let job = Job {
        acceleration: 100_000,
        top: 60_000,
        events: 100_000,
    };
    table(
        "ramp to 60 000 steps/s at 100 000 steps/s^2, 100 000 steps",
        &job,
    );
}

//! Speed along the path: the timers, the queue of moves, bursts and the spindle.

use core::hint::black_box;

use husillo_planner::{
    AxisTimers, Burst, Bursts, Follower, Junction, Limits, LookAhead, Ramp, Rates, Stretch,
    Tangent, Timer, Trapezoid,
};

use crate::{Count, time};

const EVENTS: u32 = 2000;
const MOVES: u32 = 500;

/// 2000 events of 1 um.
const LINE: Stretch = Stretch {
    length_nm: 2_000_000,
    top_nm_per_s: 100_000_000,
    ceiling_nm_per_s: 100_000_000,
    obeys_override: true,
    acceleration_nm_per_s2: 100_000_000,
    start_nm_per_s: 0,
    upper: None,
    entry_limit_nm_per_s: 0,
};

#[inline(never)]
pub fn all(count: Count<'_>) {
    let timer = Timer::new(123_456_789, 1 << 34, 1 << 25);
    count("timer_wait", EVENTS, &mut || {
        let mut timer = black_box(timer.clone());
        for _ in 0..EVENTS {
            black_box(timer.wait(black_box(12_345_678)));
        }
    });
    // The speed rises for 1 mm, then falls for 1 mm.
    ramp(count, "ramp_speeding_or_braking", &LINE, EVENTS, 1, 0);
    let short = Stretch {
        length_nm: 400_000,
        ..LINE
    };
    ramp(count, "ramp_of_200_events", &short, 400, 1, 0);
    // As an arc of 10 000 steps of radius.
    ramp(count, "ramp_swept", &LINE, EVENTS, 10_000, 0);
    let cruise = Stretch {
        start_nm_per_s: 100_000_000,
        upper: None,
        ..LINE
    };
    ramp(count, "ramp_cruising", &cruise, EVENTS, 1, u64::MAX);
    ramp(
        count,
        "ramp_cruising_swept",
        &cruise,
        EVENTS,
        10_000,
        u64::MAX,
    );
    queue(count);
    junction(count);
    axes(count);
    bursts(count);
    spindle(count);
}

/// Counts axes with separate timing. An event is a tick at which at least one axis steps.
fn axes(count: Count<'_>) {
    let timers = AxisTimers::new(2_000_000, [EVENTS, 1_300, 7]);
    let items = timers.clone().map(|_| 1).sum();
    count("axis_timers_3_axes", items, &mut || {
        for (ticks, axes) in black_box(timers.clone()) {
            black_box((ticks, axes));
        }
    });
}

fn bursts(count: Count<'_>) {
    let burst = Burst {
        interval_ticks: 3_000,
        count: EVENTS as u16,
        add_ticks: -1,
    };
    time(count, "burst_replay", &burst.replay());
    let rates = Rates {
        timer_hz: 1_000_000,
        start_rate_hz: 0,
        top_rate_hz: 20_000,
        end_rate_hz: 0,
        acceleration_hz_per_s: 100_000,
    };
    let Ok(profile) = Trapezoid::new(&rates, 500) else {
        return;
    };
    // The count includes the intervals of the ramp.
    count("burst_compress", 500, &mut || {
        for burst in Bursts::new(black_box(profile.clone()), 2) {
            black_box(burst);
        }
    });
}

/// Counts a thread of 1.5 mm in steps of 1 um, at 4096 counts per turn. It is polled at every
/// count.
fn spindle(count: Count<'_>) {
    let Some(follower) = Follower::new(4096, 1500, 0, -1) else {
        return;
    };
    count("follower_count", EVENTS, &mut || {
        let mut follower = black_box(follower.clone());
        for (counts, ticks) in (0..EVENTS as i32).zip((0_u32..).step_by(50)) {
            follower.measure(black_box(ticks), black_box(counts));
            if follower.counts_ahead() < 1 {
                black_box(follower.due(ticks));
                follower.advance();
            }
        }
    });
}

#[inline(never)]
fn ramp(count: Count<'_>, name: &str, line: &Stretch, events: u32, sweep: u32, exit_squared: u64) {
    let mut ramp = Ramp::new(1_000_000);
    let total = u64::from(events).wrapping_mul(sweep.into());
    ramp.begin(line, total, sweep, 20_000 << 16);
    let limits = Limits {
        top_nm_per_s: line.top_nm_per_s,
        exit_squared,
        version: 0,
    };
    count(name, events, &mut || {
        let mut ramp = black_box(ramp.clone());
        for _ in 0..events {
            black_box(ramp.wait(black_box(sweep), black_box(&limits)));
        }
    });
}

/// Counts moves of 20 um. The queue has 32 of them, 0.64 mm, which is less than the braking
/// distance.
#[inline(never)]
fn queue(count: Count<'_>) {
    let chord = Stretch {
        length_nm: 20_000,
        entry_limit_nm_per_s: 50_000_000,
        ..LINE
    };
    let mut queue = LookAhead::<u32, 32>::new();
    while !queue.is_full() {
        let _ = queue.push(chord, 0);
    }
    count("look_ahead_move", MOVES, &mut || {
        for number in 0..MOVES {
            black_box(queue.limits());
            black_box(queue.pop());
            // One move in 32 begins at a corner.
            let entry_limit_nm_per_s = if number % 32 == 0 {
                1_000_000
            } else {
                50_000_000
            };
            let stretch = Stretch {
                entry_limit_nm_per_s,
                ..chord
            };
            black_box(queue.push(black_box(stretch), 0)).ok();
        }
    });
}

/// Counts the work for a line before it enters the queue: its direction, its limits, and the corner
/// before it.
fn junction(count: Count<'_>) {
    let junction = Junction {
        jump_nm_per_s: Some([10_000_000; 3]),
        deviation_nm: Some(10_000),
        acceleration_nm_per_s2: [500_000_000; 3],
    };
    let distances = [[20_000, 100, 1], [19_900, 2_000, 2]];
    count("direction_and_junction", MOVES, &mut || {
        let mut last = None;
        for distance in distances.iter().cycle().take(MOVES as usize) {
            let Some(direction) = Tangent::new(*black_box(distance)) else {
                return;
            };
            black_box(direction.speed_limit(&[100_000_000; 3]));
            black_box(direction.acceleration_limit(&junction.acceleration_nm_per_s2));
            if let Some(last) = &last {
                black_box(junction.speed(last, &direction));
            }
            last = Some(direction);
        }
    });
}

//! Motion with limited jerk: events, and slices of the window.

use core::hint::black_box;

use husillo_planner::{JerkLimits, JerkRamp, JerkWindow, Stretch};

use crate::Count;

/// A window of 50 ms, and one of 10 ms.
const LIMITS: JerkLimits = JerkLimits {
    acceleration_nm_per_s2: 1_000_000_000,
    jerk_nm_per_s3: 20_000_000_000,
    highest_nm_per_s: 200_000_000,
};
const SHORT: JerkLimits = JerkLimits {
    jerk_nm_per_s3: 100_000_000_000,
    ..LIMITS
};

const EVENTS: u32 = 4000;

/// 4000 events of 2.5 um at up to 40 000 a second.
const LINE: Stretch = Stretch {
    length_nm: 10_000_000,
    top_nm_per_s: 100_000_000,
    ceiling_nm_per_s: 200_000_000,
    obeys_override: true,
    acceleration_nm_per_s2: 1_000_000_000,
    start_nm_per_s: 0,
    upper: None,
    entry_limit_nm_per_s: 0,
};

type Window = JerkWindow<u32, 16>;

#[inline(never)]
pub fn all(count: Count<'_>) {
    let (Ok(window), Ok(short)) = (Window::new(&LIMITS), Window::new(&SHORT)) else {
        return;
    };
    // A slice has 52 events, and 12.
    events(count, "jerk_event", &window, 1);
    events(count, "jerk_event_10_ms", &short, 1);
    events(count, "jerk_event_swept", &window, 10_000);
    slices(count, "jerk_slice", &window, 1);
    slices(count, "jerk_slice_of_corners", &window, 15);
}

/// Counts a move from standstill to standstill, with its slices.
#[inline(never)]
fn events(count: Count<'_>, name: &str, window: &Window, sweep: u32) {
    let mut window = window.clone();
    let _ = window.push(LINE, 0);
    let mut ramp = JerkRamp::new(1_000_000);
    let total = u64::from(EVENTS).wrapping_mul(sweep.into());
    ramp.begin(&LINE, total, sweep, &window);
    count(name, EVENTS, &mut || {
        let mut ramp = black_box(ramp.clone());
        let mut window = black_box(window.clone());
        for _ in 0..EVENTS {
            black_box(ramp.wait(black_box(sweep), &mut window));
        }
    });
}

/// Counts the slices of a path of 10 mm that is divided into moves with corners at 20 to 90 mm/s.
#[inline(never)]
fn slices(count: Count<'_>, name: &str, window: &Window, moves: u32) {
    let mut window = window.clone();
    for number in 0..moves {
        let stretch = Stretch {
            length_nm: 10_000_000_u64.checked_div(moves.into()).unwrap_or(0),
            entry_limit_nm_per_s: 20_000_000 + number % 8 * 10_000_000,
            ..LINE
        };
        let _ = window.push(stretch, number);
    }
    let mut whole = window.clone();
    let items = core::iter::from_fn(|| whole.next_slice().map(|_| 1)).sum();
    count(name, items, &mut || {
        let mut window = black_box(window.clone());
        while let Some(slice) = window.next_slice() {
            black_box(slice);
        }
    });
}

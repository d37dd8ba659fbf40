//! The times of events, against the path of the slices in floating point.

use husillo_planner::{JerkLimits, JerkRamp, JerkWindow, Slice};

use crate::moves::{MACHINES, Move, line, machine, random_moves};

/// Largest differences between events and path.
#[derive(Clone, Copy, Debug, Default)]
struct Errors {
    /// In intervals, where intervals are longer than 20 ticks.
    intervals: f64,
    /// Difference at the end of the run in ticks.
    end: f64,
}

/// The path as slices, solved for the time by bisection.
struct Path {
    slices: Vec<Slice>,
    starts: Vec<u64>,
    ticks: f64,
}

impl Path {
    fn of(limits: JerkLimits, moves: &[Move], hz: u32) -> Path {
        let mut window = JerkWindow::<(), 1024>::new(&limits).unwrap();
        for one in moves {
            window.push(one.stretch, ()).unwrap();
        }
        let slices: Vec<Slice> = std::iter::from_fn(|| window.next_slice()).collect();
        let mut at = 0;
        let starts = slices
            .iter()
            .map(|slice| {
                let start = at;
                at += slice.length();
                start
            })
            .collect();
        Path {
            slices,
            starts,
            ticks: window.slice_ticks_q32(hz) as f64 / 2_f64.powi(32),
        }
    }

    /// The time at a place in ticks.
    fn time(&self, place: f64) -> f64 {
        let index = self.starts.partition_point(|start| (*start as f64) < place);
        let index = index.saturating_sub(1);
        let Slice { speed, bend, twist } = self.slices[index];
        let rest = place - self.starts[index] as f64;
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..60 {
            let x = (low + high) / 2.0;
            let at = x * (speed as f64 + x * (bend as f64 + x * f64::from(twist)));
            if at < rest {
                low = x;
            } else {
                high = x;
            }
        }
        (index as f64 + low) * self.ticks
    }
}

/// Sweeps of each move: events of about `event_nm`, equal or not.
fn sweeps(one: &Move, event_nm: u64, is_line: bool, random: &mut oorandom::Rand64) -> Vec<u32> {
    let count = (one.stretch.length_nm / event_nm).max(1);
    let mut any = || {
        if is_line {
            1
        } else {
            random.rand_range(1_000..20_000) as u32
        }
    };
    (0..count).map(|_| any()).collect()
}

fn errors(
    limits: JerkLimits,
    moves: &[Move],
    hz: u32,
    event_nm: u64,
    is_line: bool,
    seed: u128,
) -> Errors {
    let mut random = oorandom::Rand64::new(seed);
    let path = Path::of(limits, moves, hz);
    let mut window = JerkWindow::<usize, 1024>::new(&limits).unwrap();
    for (number, one) in moves.iter().enumerate() {
        window.push(one.stretch, number).unwrap();
    }
    let mut ramp = JerkRamp::new(hz);
    let mut errors = Errors::default();
    let unit = f64::from(window.units_per_nm());
    let (mut ticks, mut start, mut last) = (0_u64, 0.0, 0.0);
    while let Some((stretch, number)) = window.front() {
        let (stretch, number) = (*stretch, *number);
        let sweeps = sweeps(&moves[number], event_nm, is_line, &mut random);
        let total: u64 = sweeps.iter().map(|sweep| u64::from(*sweep)).sum();
        let largest = *sweeps.iter().max().unwrap();
        let length = stretch.length_nm as f64 * unit;
        ramp.begin(&stretch, total, largest, &window);
        let mut sum = 0_u64;
        for sweep in sweeps {
            sum += u64::from(sweep);
            ticks += ramp.wait(sweep, &mut window).unwrap();
            let time = path.time(start + length * sum as f64 / total as f64);
            // Waits are whole ticks, so a time is rounded down.
            let error = ((ticks as f64 + 0.5 - time).abs() - 0.5).max(0.0);
            if time - last > 20.0 {
                errors.intervals = errors.intervals.max(error / (time - last));
            }
            last = time;
        }
        start += length;
        window.pop();
    }
    errors.end = (path.slices.len() as f64 * path.ticks - ticks as f64).abs();
    errors
}

#[test]
fn events_are_where_the_path_is() {
    let mut random = oorandom::Rand64::new(3);
    let moves = random_moves(&mut random, 300);
    for limits in MACHINES {
        for (hz, event_nm) in [
            (1_000_000, 2_500),
            (72_000_000, 1_000),
            (1_000_000_000, 5_000),
        ] {
            for is_line in [true, false] {
                let errors = errors(limits, &moves, hz, event_nm, is_line, 5);
                assert!(errors.intervals < 0.02 && errors.end <= 1.0, "{errors:?}");
            }
        }
    }
}

/// A hold stops the path between two events; the next one follows after the resume.
#[test]
fn a_hold_stops_and_goes_on() {
    let one = line(20_000_000, 50_000_000, 0);
    let mut window = JerkWindow::<(), 4>::new(&machine(1, 20)).unwrap();
    window.push(one.stretch, ()).unwrap();
    let mut ramp = JerkRamp::new(1_000_000);
    ramp.begin(&one.stretch, 8_000, 1, &window);
    for _ in 0..4_000 {
        assert!(ramp.wait(1, &mut window).is_some());
    }
    window.hold();
    let stopping = (0..8_000).map_while(|_| ramp.wait(1, &mut window)).count();
    // 50 mm/s, 1 m/s^2, 20 ms: 1.75 mm, and what was left of a slice.
    assert!((650..=750).contains(&stopping), "{stopping}");
    assert_eq!(ramp.wait(1, &mut window), None);
    window.resume();
    let first = ramp.wait(1, &mut window).unwrap();
    assert!(first > 1_000, "{first}");
    let rest = (0..8_000).map_while(|_| ramp.wait(1, &mut window)).count();
    assert_eq!(stopping + rest + 4_001, 8_000);
}

//! Pushes moves, takes slices, and checks them.

use husillo_planner::{JerkLimits, JerkWindow};

use crate::{
    checker::{Checker, Seen},
    moves::Move,
};

/// What disturbs a run.
#[derive(Clone, Copy, Debug, Default)]
pub struct Disturbance {
    /// Moves that arrive in a slice on average; 0 is as many as fit.
    pub moves_per_slice: f64,
    /// Probability of a hold, a resume or an override of feeds or rapids in a slice.
    pub changes: f64,
}

/// Duration of the last slice in s.
fn seconds<M, const CAPACITY: usize>(window: &JerkWindow<M, CAPACITY>) -> f64 {
    const HZ: u32 = 1_000_000_000;
    window.slice_ticks_q32(HZ) as f64 / 2_f64.powi(32) / f64::from(HZ)
}

pub fn run<const CAPACITY: usize>(
    limits: JerkLimits,
    moves: &[Move],
    disturbance: Disturbance,
    random: &mut oorandom::Rand64,
) -> Seen {
    let mut window = JerkWindow::<usize, CAPACITY>::new(&limits).unwrap();
    let percent = if disturbance.changes > 0.0 { 200 } else { 100 };
    let mut checker = Checker::new(limits, moves, percent, window.units_per_nm());
    let (mut pushed, mut arrived) = (0, 0.0);
    // The path made so far and the ends of the moves, exactly, in units.
    let (mut made, mut end) = (0_u128, 0_u128);
    let unit = u128::from(window.units_per_nm());
    loop {
        if disturbance.moves_per_slice > 0.0 {
            arrived += random.rand_float() * 2.0 * disturbance.moves_per_slice;
        } else {
            arrived = f64::INFINITY;
        }
        while pushed < moves.len() && arrived >= 1.0 && !window.is_full() {
            window.push(moves[pushed].stretch, pushed).unwrap();
            pushed += 1;
            if pushed == moves.len() {
                window.finish();
            }
            arrived -= 1.0;
        }
        while let Some((stretch, _)) = window.front() {
            let next = end + u128::from(stretch.length_nm) * unit;
            if made < next {
                break;
            }
            end = next;
            window.pop();
        }
        if random.rand_float() < disturbance.changes {
            match random.rand_range(0..5) {
                0 => window.hold(),
                1 => window.set_override(random.rand_range(10..201) as u8),
                2 => window.set_rapid_override(random.rand_range(10..101) as u8),
                _ => window.resume(),
            }
        }
        match window.next_slice() {
            Some(slice) => {
                made += u128::from(slice.length());
                checker.set_slice(seconds(&window));
                checker.pass(&slice);
            }
            None if window.is_held() && disturbance.changes > 0.0 => window.resume(),
            None if pushed == moves.len() => break,
            None => {}
        }
        assert!(
            checker.seen.seconds < 3600.0,
            "no progress at {} of {}",
            end,
            moves.len()
        );
    }
    assert!(window.is_empty(), "{} left", window.len());
    assert!(checker.is_done(), "the end of the last move is exact");
    checker.seen
}

//! Random and regular lists of moves.

use husillo_planner::{Junction, Stretch, Tangent};
use proptest::prelude::*;

/// A move with its events.
#[derive(Clone, Debug)]
pub struct Move {
    pub stretch: Stretch,
    /// Sweep of each event; the sum is the sweep of the move.
    pub sweeps: Vec<u32>,
    /// Direction as a unit vector, for checks per axis.
    pub direction: [f64; 2],
}

impl Move {
    pub fn total(&self) -> u64 {
        self.sweeps.iter().map(|sweep| u64::from(*sweep)).sum()
    }

    /// Ticks at the programmed speed, times 2^16.
    pub fn cruise_ticks_q16(&self, hz: u32) -> u64 {
        let ticks = (u128::from(self.stretch.length_nm) * u128::from(hz)) << 16;
        (ticks / u128::from(self.stretch.top_nm_per_s)) as u64
    }

    /// Length of an event in nm.
    pub fn length_of(&self, sweep: u32) -> f64 {
        self.stretch.length_nm as f64 * f64::from(sweep) / self.total() as f64
    }
}

pub const ACCELERATION: [u64; 2] = [300_000_000, 500_000_000];
pub const JUMP: [u32; 2] = [3_000_000, 2_000_000];
pub const SPEED: [u32; 2] = [60_000_000, 40_000_000];

/// Junction rules of the machine for the polylines.
pub fn corners() -> Junction<2> {
    Junction {
        jump_nm_per_s: Some(JUMP),
        deviation_nm: None,
        acceleration_nm_per_s2: ACCELERATION,
    }
}

/// A polyline through points in nm; each line has its feed and events of about a micrometre.
pub fn polyline(points: &[([i64; 2], u32)]) -> Vec<Move> {
    let corners = corners();
    let mut from = [0; 2];
    let mut last: Option<Tangent<2>> = None;
    let mut moves = Vec::new();
    for (to, feed) in points {
        let delta = [to[0] - from[0], to[1] - from[1]];
        let Some(direction) = Tangent::new(delta) else {
            continue;
        };
        let length = (delta[0] as f64).hypot(delta[1] as f64);
        let length_nm = length.round() as u64;
        let ceiling = direction.speed_limit(&SPEED);
        let stretch = Stretch {
            length_nm,
            top_nm_per_s: (*feed).min(ceiling),
            ceiling_nm_per_s: ceiling,
            obeys_override: true,
            acceleration_nm_per_s2: direction.acceleration_limit(&ACCELERATION),
            start_nm_per_s: 0,
            upper: None,
            entry_limit_nm_per_s: last.map_or(0, |last| corners.speed(&last, &direction)),
        };
        moves.push(Move {
            stretch,
            sweeps: vec![1; (length_nm / 1000).max(1) as usize],
            direction: delta.map(|way| way as f64 / length),
        });
        last = Some(direction);
        from = *to;
    }
    moves
}

/// Lines of 1 um to 2 mm in all directions, mostly short, at 0.1 to 70 mm/s.
pub fn any_polyline() -> impl Strategy<Value = Vec<Move>> {
    let line = (
        -1.0..1.0_f64,
        -1.0..1.0_f64,
        3.0..6.3_f64,
        5.0..7.85_f64,
        any::<bool>(),
    );
    prop::collection::vec(line, 1..40).prop_map(|lines| {
        let mut at = [0_i64; 2];
        let mut feed = 1_000_000;
        let points: Vec<_> = lines
            .into_iter()
            .map(|(x, y, size, speed, is_new_feed)| {
                let scale = 10_f64.powf(size) / 1.4;
                // Mostly onwards in X, so that all kinds of corners occur.
                at = [
                    at[0] + ((x + 0.5) * scale) as i64,
                    at[1] + (y * scale * x.abs()) as i64,
                ];
                if is_new_feed {
                    feed = 10_f64.powf(speed) as u32;
                }
                (at, feed)
            })
            .collect();
        polyline(&points)
    })
}

/// Moves of any kind: uneven sweeps, individual accelerations, junction limits and ceilings.
pub fn any_moves(longest: usize) -> impl Strategy<Value = Vec<Move>> {
    let one = (
        prop::collection::vec(1_u32..1 << 20, 1..60),
        50_u64..5_000,
        5.0..7.7_f64,
        7.0..10.0_f64,
        prop_oneof![Just(u32::MAX), 1_000_000_u32..50_000_000, Just(0)],
        1.0..3.0_f64,
    );
    let one = one.prop_map(
        |(sweeps, event_nm, top, acceleration, entry_limit, room)| Move {
            stretch: Stretch {
                length_nm: event_nm * sweeps.len() as u64,
                top_nm_per_s: 10_f64.powf(top) as u32,
                ceiling_nm_per_s: (10_f64.powf(top) * room) as u32,
                obeys_override: true,
                acceleration_nm_per_s2: 10_f64.powf(acceleration) as u64,
                start_nm_per_s: 0,
                upper: None,
                entry_limit_nm_per_s: entry_limit,
            },
            sweeps,
            direction: [1.0, 0.0],
        },
    );
    prop::collection::vec(one, 1..longest)
}

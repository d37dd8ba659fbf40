//! The check of gains: moves, and their distances from the goals.

use super::stand::Stand;
use crate::error::Error;
use husillo_transports::nmc::{Gains, Status};
use serde::Serialize;

/// Lengths of the moves in turn, counts. The short ones must overcome stiction.
const LENGTHS: [i32; 9] = [1, 3, 10, 30, 100, 300, 500, 2, 17];
/// The moves stay within this distance of the first position, counts.
const REACH: i32 = 1000;
/// Longest time from the end of a profile until the axis is at rest, us.
const SETTLING_US: u64 = 2_000_000;
/// Time for which the last goal is held and observed, us.
const REST_US: u64 = 3_000_000;
/// The axis is at rest when it has been at its goal for this time, us, and for three readings.
const STILL_US: u64 = 50_000;

/// Results of the moves.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct Moves {
    /// Number of moves.
    pub moves: u32,
    /// Number of moves that ended within 1 count of their goal.
    pub within_1_count: u32,
    /// Largest distance of the end of a move from its goal, counts.
    pub largest_error: u32,
    /// Largest distance from the last goal while the axis is held there, counts. If it is more than
    /// 1, the axis hunts.
    pub rest_error: u32,
}

impl Moves {
    /// Every move ended within 1 count, and the axis rests there.
    pub const fn is_good(&self) -> bool {
        self.within_1_count == self.moves && self.rest_error <= 1
    }
}

/// Makes `moves` moves in both directions with the rate and acceleration of the machine file. Their
/// lengths are 1 to 999 counts. Then it holds the last goal for a while.
///
/// # Errors
///
/// A limit is passed, or the link fails.
pub fn check(stand: &mut Stand, gains: &Gains, moves: u32) -> Result<Moves, Error> {
    stand.engage(gains)?;
    let mut result = Moves::default();
    let mut goal = stand.sample(true)?.position;
    let mut random = 1_u32;
    for length in LENGTHS.into_iter().cycle().take(moves as usize) {
        // The random generator of Numerical Recipes, so that the moves are always the same.
        random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let length = length + (random >> 16) as i32 % length;
        let is_up = random >> 31 == 0;
        let low = stand.settings.travel[0].max(stand.centre - REACH);
        let high = stand.settings.travel[1].min(stand.centre + REACH);
        goal = match (goal + length <= high, goal - length >= low) {
            (true, true) if is_up => goal + length,
            (_, true) => goal - length,
            (true, false) => goal + length,
            (false, false) => goal,
        };
        let error = one(stand, goal)?;
        result.moves += 1;
        result.within_1_count += u32::from(error <= 1);
        result.largest_error = result.largest_error.max(error);
    }
    let mut sample = stand.sample(true)?;
    let end_us = sample.us + REST_US;
    while sample.us < end_us {
        result.rest_error = result.rest_error.max(sample.position.abs_diff(goal));
        sample = stand.sample(true)?;
    }
    Ok(result)
}

/// Makes a move. Returns the distance of its end from its goal.
fn one(stand: &mut Stand, goal: i32) -> Result<u32, Error> {
    stand.start_move(goal)?;
    // The latest end of the move, set at the end of its profile, and the start of its time at the
    // goal.
    let (mut end_us, mut still_us, mut readings) = (None, None, 0);
    loop {
        let sample = stand.sample(true)?;
        let error = sample.position.abs_diff(goal);
        if !sample.status.contains(Status::MOVE_DONE) {
            continue;
        }
        let end_us = *end_us.get_or_insert(sample.us + SETTLING_US);
        (still_us, readings) = match still_us {
            _ if error > 1 => (None, 0),
            None => (Some(sample.us), 1),
            Some(since) => (Some(since), readings + 1),
        };
        let is_still = still_us.is_some_and(|since| sample.us >= since + STILL_US) && readings >= 3;
        if is_still || sample.us > end_us {
            return Ok(error);
        }
    }
}

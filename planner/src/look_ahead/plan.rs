//! The highest speeds at the junctions of a queue, at one or two levels of acceleration.

use core::num::NonZeroU128;

use crate::ring::Ring;
use crate::stretch::{Percents, Stretch, square};

/// The plans of a queue: one for the whole acceleration of each move, and while there are moves
/// with an upper level, one for the small acceleration.
#[derive(Clone, Debug)]
pub(super) struct Plans<const CAPACITY: usize> {
    lower: Plan<CAPACITY>,
    upper: Plan<CAPACITY>,
    /// Number of moves with an upper level. Without any, `upper` is not kept.
    uppers: usize,
}

/// The candidates for one level of acceleration.
#[derive(Clone, Debug)]
struct Plan<const CAPACITY: usize> {
    candidates: Ring<Candidate, CAPACITY>,
    /// Height of the end of the first move. Heights have at most [`HEIGHT_BITS`]: 1024 moves of
    /// 2^85 above a height at which [`Plan::lower_all`] makes this one 0.
    front_end: u128,
    /// Height of the end of the last move.
    end: u128,
}

/// Set in each candidate: as it is not 0, a free place takes no byte of its own.
const MARK: NonZeroU128 = match NonZeroU128::new(1 << 127) {
    Some(mark) => mark,
    None => NonZeroU128::MIN,
};

/// Bits of a height with a limit. 31 bits above them are for the number of a move.
const HEIGHT_BITS: u32 = 96;

/// A junction with a bound below those of all junctions after it: its height with its limit, and
/// the sequence number of the move after it in 31 bits. There are fewer moves.
#[derive(Copy, Clone, Debug)]
struct Candidate(NonZeroU128);

impl Candidate {
    const fn new(number: u32, height_and_limit: u128) -> Candidate {
        // A shift by the size of a word is none on a 32-bit processor.
        let number = (number & (u32::MAX >> 1)) as u128;
        let bits = MARK.get() | number.wrapping_shl(HEIGHT_BITS) | height_and_limit;
        match NonZeroU128::new(bits) {
            Some(bits) => Candidate(bits),
            None => Candidate(MARK),
        }
    }

    const fn is_before(self, number: u32) -> bool {
        let before = self.0.get().wrapping_shr(HEIGHT_BITS) as u32;
        before & (u32::MAX >> 1) == number & (u32::MAX >> 1)
    }

    const fn height_and_limit(self) -> u128 {
        self.0.get() & (1_u128 << HEIGHT_BITS).wrapping_sub(1)
    }
}

impl<const CAPACITY: usize> Plans<CAPACITY> {
    pub(super) const fn new() -> Self {
        Self {
            lower: Plan::new(),
            upper: Plan::new(),
            uppers: 0,
        }
    }

    pub(super) fn clear(&mut self) {
        self.lower.start(0);
        self.uppers = 0;
    }

    /// Begins with the first move, whose [`Stretch::gain`] is `gain`.
    pub(super) fn start(&mut self, first: &Stretch, gain: u128) {
        self.lower.start(gain);
        self.uppers = 0;
        if first.upper.is_some() {
            self.uppers = 1;
            self.upper.start(first.upper_gain());
        }
    }

    /// Appends a move with this sequence number after the last one.
    pub(super) fn join(
        &mut self,
        number: u32,
        last: &Stretch,
        stretch: &Stretch,
        gain: u128,
        percents: Percents,
    ) {
        if stretch.upper.is_some() {
            self.count_upper();
        }
        let limit = entry(last, stretch, percents);
        let squared = |limit: u32| square(limit.max(last.start_nm_per_s));
        // The first plan stays below the upper levels.
        let below = limit.min(last.knee()).min(stretch.knee());
        self.lower.join(number, squared(below), gain);
        if self.uppers != 0 {
            self.join_upper(number, squared(limit), stretch);
        }
    }

    /// Counts a move with an upper level. The plan of the first one begins as a copy.
    #[cold]
    fn count_upper(&mut self) {
        if self.uppers == 0 {
            self.upper.copy(&self.lower);
        }
        self.uppers = self.uppers.wrapping_add(1);
    }

    /// Out of line, so that a queue of lines costs no more than one plan.
    #[inline(never)]
    fn join_upper(&mut self, number: u32, limit_squared: u64, stretch: &Stretch) {
        self.upper.join(number, limit_squared, stretch.upper_gain());
    }

    /// Removes the first move. The next one has this sequence number.
    pub(super) fn advance(&mut self, first: &Stretch, number: u32, next: &Stretch) {
        if first.upper.is_some() {
            self.uppers = self.uppers.wrapping_sub(1);
        }
        self.lower.advance(number, next.gain());
        if self.uppers != 0 {
            self.advance_upper(number, next);
        }
    }

    #[inline(never)]
    fn advance_upper(&mut self, number: u32, next: &Stretch) {
        self.upper.advance(number, next.upper_gain());
    }

    /// Returns the square of the highest speed at the end of the first move, if the last one ends
    /// at `stop`. Both plans are possible, so the faster one counts.
    pub(super) fn exit_squared(&self, stop: u64) -> u64 {
        let exit = self.lower.exit_squared(stop);
        if self.uppers == 0 {
            return exit;
        }
        exit.max(self.upper_exit_squared(stop))
    }

    #[inline(never)]
    fn upper_exit_squared(&self, stop: u64) -> u64 {
        self.upper.exit_squared(stop)
    }
}

impl<const CAPACITY: usize> Plan<CAPACITY> {
    const fn new() -> Self {
        const { assert!(CAPACITY <= 1024, "heights have 96 bits") };
        Self {
            candidates: Ring::new(),
            front_end: 0,
            end: 0,
        }
    }

    fn start(&mut self, gain: u128) {
        self.candidates.clear();
        self.front_end = gain;
        self.end = gain;
    }

    fn copy(&mut self, other: &Self) {
        self.start(other.front_end);
        self.end = other.end;
        let mut offset = 0_usize;
        while let Some(candidate) = other.candidates.get(offset) {
            self.candidates.push_back(*candidate);
            // Below the capacity.
            offset = offset.wrapping_add(1);
        }
    }

    /// Appends a move after a junction with this limit. Removes all candidates with a higher bound.
    fn join(&mut self, number: u32, limit_squared: u64, gain: u128) {
        let height_and_limit = self.end.wrapping_add(limit_squared.into());
        while self
            .candidates
            .back()
            .is_some_and(|candidate| candidate.height_and_limit() >= height_and_limit)
        {
            self.candidates.pop_back();
        }
        self.candidates
            .push_back(Candidate::new(number, height_and_limit));
        self.end = self.end.wrapping_add(gain);
    }

    fn advance(&mut self, number: u32, gain: u128) {
        if let Some(candidate) = self.candidates.front() {
            if candidate.is_before(number) {
                self.candidates.pop_front();
            }
        }
        self.front_end = self.front_end.wrapping_add(gain);
        if self.front_end >> 90 != 0 {
            self.lower_all();
        }
    }

    /// Measures all heights from the end of the first move. No candidate is below it.
    #[cold]
    fn lower_all(&mut self) {
        let base = core::mem::take(&mut self.front_end);
        self.end = self.end.wrapping_sub(base);
        for offset in 0..self.candidates.len() {
            if let Some(candidate) = self.candidates.get_mut(offset) {
                let height = candidate.height_and_limit().saturating_sub(base);
                let number = candidate.0.get().wrapping_shr(HEIGHT_BITS) as u32;
                *candidate = Candidate::new(number, height);
            }
        }
    }

    fn exit_squared(&self, stop: u64) -> u64 {
        let mut lowest = self.end.wrapping_add(stop.into());
        if let Some(candidate) = self.candidates.front() {
            lowest = lowest.min(candidate.height_and_limit());
        }
        let exit = lowest.saturating_sub(self.front_end);
        u64::try_from(exit).unwrap_or(u64::MAX)
    }
}

/// Highest speed from one move to the next: the junction limit and the top speeds of both moves.
/// The start speed of the first move is always allowed besides, because the machine may stop from
/// it and start again.
fn entry(before: &Stretch, after: &Stretch, percents: Percents) -> u32 {
    after
        .entry_limit_nm_per_s
        .min(before.top_under(percents))
        .min(after.top_under(percents))
}

//! Compression of many intervals into few records.

use core::iter::FusedIterator;

/// A record of `count` intervals: the first is `interval_ticks`, each next one is longer by
/// `add_ticks`.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Burst {
    /// Ticks before the first event.
    pub interval_ticks: u32,
    /// Number of events, at least 1.
    pub count: u16,
    /// Ticks by which each interval is longer than the one before.
    pub add_ticks: i16,
}

impl Burst {
    /// Returns the intervals of the record. Each takes two additions, so a slow controller can do
    /// it.
    pub const fn replay(&self) -> Replay {
        Replay {
            interval_ticks: self.interval_ticks,
            left: self.count,
            add_ticks: self.add_ticks,
        }
    }
}

/// The intervals of a [`Burst`].
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Replay {
    interval_ticks: u32,
    left: u16,
    add_ticks: i16,
}

impl Iterator for Replay {
    type Item = u32;

    #[inline]
    fn next(&mut self) -> Option<u32> {
        self.left = self.left.checked_sub(1)?;
        let ticks = self.interval_ticks;
        // `Bursts` makes no record that leaves 32 bits before its last event.
        self.interval_ticks = ticks.wrapping_add_signed(self.add_ticks.into());
        Some(ticks)
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        (self.left.into(), Some(self.left.into()))
    }
}

impl ExactSizeIterator for Replay {}
impl FusedIterator for Replay {}

/// Compresses a stream of intervals into [`Burst`]s for a slow controller or a slow link.
///
/// Replayed events are at most `error_ticks` from the original ones over the whole stream: errors
/// do not add up, because a burst begins where the one before it really ended. Each burst is as
/// long as its first interval allows. Up to [`CANDIDATES`](Bursts::CANDIDATES) first intervals,
/// evenly spread within the error, are followed together with the range of additions that each
/// allows, until none is left. With an error of 8 ticks or less these are all first intervals, so
/// no longer burst exists. Among the candidates that last longest, the one that ends nearest to the
/// original time is taken; among equal ones, the one with the smallest addition.
///
/// Range: intervals up to 2^32 - 1 ticks, errors up to 2^30 ticks; no replayed interval is
/// negative. Memory is constant: two copies of the 17 candidates take 410 bytes of stack each while
/// a burst is made.
///
/// # Cost
/// Up to two divisions of 64 bits per candidate and event, so compression is for a fast processor.
///
/// # Examples
///
/// ```
/// use husillo_planner::{Burst, Bursts};
///
/// let intervals = [1000, 990, 979, 970, 960, 500, 500];
/// let bursts: Vec<Burst> = Bursts::new(intervals.into_iter(), 2).collect();
/// let burst = |interval_ticks, count, add_ticks| Burst { interval_ticks, count, add_ticks };
/// assert_eq!(bursts, [burst(1000, 5, -10), burst(499, 2, 1)]);
/// assert!(bursts[0].replay().eq([1000, 990, 980, 970, 960]));
/// ```
///
/// # Source
/// The record and the idea are those of Klipper's `stepcompress.c` (`interval, count, add`). The
/// search is our own.
#[derive(Clone, Debug)]
pub struct Bursts<I> {
    intervals: I,
    error_ticks: i64,
    /// First interval of the next burst: taken from the stream, not yet used.
    waiting: Option<u32>,
    /// Original time minus replayed time at the end of the last burst.
    late: i64,
}

/// A first interval, and the additions that keep every event so far within the error.
#[derive(Clone, Copy, Debug)]
struct Candidate {
    interval: i64,
    low: i64,
    high: i64,
}

impl Candidate {
    /// Restricts the additions so that an event after `count` intervals lies between the times
    /// `early` and `late`. Returns whether any addition is left.
    fn allow(&mut self, count: i64, early: i64, late: i64) -> bool {
        // count < 2^16, so the weight is below 2^31 and the sum of additions, weight times add, is
        // below 2^46. Times are below 2^49.
        let weight = count.wrapping_mul(count.wrapping_sub(1)) >> 1;
        let base = count.wrapping_mul(self.interval);
        let (least, most) = (early.wrapping_sub(base), late.wrapping_sub(base));
        if weight == 0 {
            return least <= 0 && most >= 0;
        }
        if self.low.wrapping_mul(weight) < least {
            self.low = ceiling(least, weight);
        }
        if self.high.wrapping_mul(weight) > most {
            self.high = ceiling(most.wrapping_add(1), weight).wrapping_sub(1);
        }
        // No interval may be below 0 or above 2^32 - 1; the last one is interval + (count - 1) add.
        let gaps = count.wrapping_sub(1);
        if self.low.wrapping_mul(gaps) < self.interval.wrapping_neg() {
            self.low = ceiling(self.interval.wrapping_neg(), gaps);
        }
        let above = i64::from(u32::MAX).wrapping_sub(self.interval);
        if self.high.wrapping_mul(gaps) > above {
            self.high = ceiling(above.wrapping_add(1), gaps).wrapping_sub(1);
        }
        self.low <= self.high
    }

    /// Returns the addition that ends nearest to `time`, and the remaining error.
    fn nearest(&self, count: i64, time: i64) -> (i64, i64) {
        let weight = count.wrapping_mul(count.wrapping_sub(1)) >> 1;
        let off = time.wrapping_sub(count.wrapping_mul(self.interval));
        let add = off
            .wrapping_add(weight >> 1)
            .checked_div_euclid(weight)
            .unwrap_or(0)
            .max(self.low)
            .min(self.high);
        (add, off.wrapping_sub(add.wrapping_mul(weight)))
    }
}

/// a / b rounded up, for b > 0.
fn ceiling(a: i64, b: i64) -> i64 {
    a.wrapping_neg()
        .checked_div_euclid(b)
        .unwrap_or(0)
        .wrapping_neg()
}

impl<I> Bursts<I> {
    /// Number of first intervals that are tried.
    pub const CANDIDATES: usize = 17;
}

impl<I: Iterator<Item = u32>> Bursts<I> {
    /// Compresses `intervals` so that replayed times are at most `error_ticks` (limited to 2^30)
    /// off the original ones.
    pub fn new(intervals: I, error_ticks: u32) -> Bursts<I> {
        Bursts {
            intervals,
            error_ticks: error_ticks.min(1 << 30).into(),
            waiting: None,
            late: 0,
        }
    }
}

impl<I: Iterator<Item = u32>> Iterator for Bursts<I> {
    type Item = Burst;

    fn next(&mut self) -> Option<Burst> {
        let first = match self.waiting.take() {
            Some(ticks) => ticks,
            None => self.intervals.next()?,
        };
        let error = self.error_ticks;
        // Times count from the replayed end of the last burst.
        let mut time = self.late.wrapping_add(first.into());
        let mut candidates = [Candidate {
            interval: 0,
            low: i16::MIN.into(),
            high: i16::MAX.into(),
        }; 17];
        // First intervals are spread over the whole error range. The error carried from the last
        // burst lies within it as well.
        let lowest = time.wrapping_sub(error).max(0);
        let highest = time.wrapping_add(error).min(u32::MAX.into());
        let span = highest.wrapping_sub(lowest);
        let mut live = 0_usize;
        let steps = span.min(16);
        for (candidate, part) in candidates.iter_mut().zip(0..=steps) {
            // part <= 16, span < 2^32.
            candidate.interval =
                lowest.wrapping_add(span.wrapping_mul(part).checked_div(steps).unwrap_or(0));
            live = live.wrapping_add(1);
        }
        let mut count = 1_i64;
        while count < i64::from(u16::MAX) {
            let Some(ticks) = self.intervals.next() else {
                break;
            };
            let end = time.wrapping_add(ticks.into());
            let next_count = count.wrapping_add(1);
            let before = candidates;
            let mut kept = 0_usize;
            for candidate in before.iter().take(live) {
                let mut candidate = *candidate;
                if candidate.allow(next_count, end.wrapping_sub(error), end.wrapping_add(error)) {
                    if let Some(place) = candidates.get_mut(kept) {
                        *place = candidate;
                    }
                    kept = kept.wrapping_add(1);
                }
            }
            if kept == 0 {
                candidates = before;
                self.waiting = Some(ticks);
                break;
            }
            (live, count, time) = (kept, next_count, end);
        }
        let mut best = (0_i64, 0_i64, i64::MAX);
        for candidate in candidates.iter().take(live) {
            let (add, late) = candidate.nearest(count, time);
            if (late.unsigned_abs(), add.unsigned_abs())
                < (best.2.unsigned_abs(), best.1.unsigned_abs())
            {
                best = (candidate.interval, add, late);
            }
        }
        let (interval, add, late) = best;
        self.late = late;
        Some(Burst {
            interval_ticks: interval as u32,
            count: count as u16,
            // A single event has no addition.
            add_ticks: if count == 1 { 0 } else { add as i16 },
        })
    }
}

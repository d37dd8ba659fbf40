//! Many intervals in few records.

use core::iter::FusedIterator;

/// `count` intervals, the first of `interval_ticks`, each next one longer by `add_ticks`.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Burst {
    /// Ticks before the first event.
    pub interval_ticks: u32,
    /// Events, at least 1.
    pub count: u16,
    /// Ticks that each interval has more than the one before.
    pub add_ticks: i16,
}

impl Burst {
    /// Its intervals again: two additions each, all that a slow controller has to do.
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
        // `Bursts` makes none that leaves 32 bits before its last event.
        self.interval_ticks = ticks.wrapping_add_signed(self.add_ticks.into());
        Some(ticks)
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        (self.left.into(), Some(self.left.into()))
    }
}

impl ExactSizeIterator for Replay {}
impl FusedIterator for Replay {}

/// Compresses a stream of intervals into [`Burst`]s: for a slow controller, or a link.
///
/// Replayed events are never further than `error_ticks` from the original ones, over the whole
/// stream: a burst begins where the one before it ended, not where it should have. Each burst is as
/// long as its first interval lets it be: of the first intervals within the error, up to
/// [`CANDIDATES`](Bursts::CANDIDATES) evenly spread, every one is followed with the range of
/// additions it allows, until none is left. With an error of 8 ticks or less that are all: no
/// longer burst exists. Of those left over the one that ends nearest to the original time is taken,
/// among equals the most even.
///
/// Range: intervals up to 2^32 - 1 ticks, errors up to 2^30; no replayed interval is negative.
/// Memory: constant; the 17 candidates take 410 bytes of stack twice while a burst is made. Cost:
/// up to two divisions of 64 bits for each candidate and event; this is for the side that has time.
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
/// Source: the record and the idea are those of Klipper's `stepcompress.c` (`interval, count,
/// add`); the search is our own.
#[derive(Clone, Debug)]
pub struct Bursts<I> {
    intervals: I,
    error_ticks: i64,
    /// The first interval of the next burst, taken from the stream but not yet used.
    waiting: Option<u32>,
    /// Original less replayed time at the end of the last burst.
    late: i64,
}

/// A first interval and the additions with which every event so far is within the error.
#[derive(Clone, Copy, Debug)]
struct Candidate {
    interval: i64,
    low: i64,
    high: i64,
}

impl Candidate {
    /// Lets an event in that comes after `count` intervals between the times `early` and `late`;
    /// whether any addition is left.
    fn allow(&mut self, count: i64, early: i64, late: i64) -> bool {
        // count < 2^16: the sum of additions is add times this, below 2^31; times below 2^49.
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
        // No interval below 0 and none of 2^32: the last one is interval + (count - 1) add.
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

    /// The addition that ends nearest to `time`, and how far from it.
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
    /// First intervals that are tried.
    pub const CANDIDATES: usize = 17;
}

impl<I: Iterator<Item = u32>> Bursts<I> {
    /// Compresses `intervals` with replayed times at most `error_ticks` (cut to 2^30) off the
    /// original ones.
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
        // Times are counted from the end of the last burst as it was replayed.
        let mut time = self.late.wrapping_add(first.into());
        let mut candidates = [Candidate {
            interval: 0,
            low: i16::MIN.into(),
            high: i16::MAX.into(),
        }; 17];
        // From the lowest first interval to the highest within the error; the late one is within it
        // too.
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
        while count < u16::MAX.into() {
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
            // A single event has nothing added.
            add_ticks: if count == 1 { 0 } else { add as i16 },
        })
    }
}

//! Motion that follows a spindle instead of the clock.

/// When the next event of a move that follows an encoder is due.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Due {
    /// Now, or already passed: make it and call [`Follower::advance`].
    Now,
    /// In so many ticks, if the spindle keeps its speed; sooner if the next count comes first. Ask
    /// again at either.
    In(u32),
    /// Not before another count: ask again after the next [`Follower::measure`].
    NotYet,
}

/// The time base of spindle-synchronised motion (G33, G76, G95): the events of a path become due at
/// encoder counts.
///
/// ```text
/// counts  |----c----|----c----|----c----|     measured: when each came
/// events  |   e     e   |   e     e     |     due at exact fractions of counts
/// ```
///
/// Event k is due at `start + k counts / events`: with 4096 counts a turn, 1.5 mm pitch and 1 um a
/// step, `counts / events` is 4096 / 1500. The remainder is carried, so the pitch is exact over any
/// number of turns.
///
/// - An event that falls on a count or before it is due when that count has come, never later: **nothing drifts**.
/// - Between two counts the measured period of the spindle divides the time (its mean over about 4 counts), so that the steps are as even as its
///   speed. An event comes less than one count early or late, when the spindle changes its speed within that count; with more counts than events a turn the pitch
///   error is therefore below one step at any speed and any change of it, with fewer at a speed that changes little from count to count.
/// - **Stop**: without counts, the events of the present count come and no more; the motion stands with the spindle.
/// - **Reverse**: nothing is stepped back and nothing is due until the spindle is again past the farthest event; the thread is then
///   met where it was left.
///
/// The path's own speed is that of the spindle: who engages at speed gives the axis a run-in, as on
/// any lathe. A follower polled late, or a spindle faster than predicted, has several events due at
/// once; the caller keeps its least interval between steps.
///
/// Range: counts wrap as `i32`, fewer than 2^31 between two calls; periods up to 2^24 ticks a
/// count, above that they are taken as that. Size: 48 bytes. Cost: a product and a shift to ask, a
/// division to measure.
///
/// ```
/// use husillo_planner::{Due, Follower};
///
/// // 2 events in 3 counts, from count 10 on.
/// let mut follower = Follower::new(3, 2, 10, 9).unwrap();
/// follower.measure(1000, 10);
/// assert_eq!(follower.due(1000), Due::Now);
/// follower.advance();
/// assert_eq!(follower.due(1000), Due::NotYet);
/// follower.measure(1100, 11);
/// // Due at count 11.5, which is 50 ticks away.
/// assert_eq!(follower.due(1100), Due::In(50));
/// assert_eq!(follower.due(1150), Due::Now);
/// ```
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Follower {
    /// Whole counts from the present count to that of the next event.
    ahead: i64,
    /// Counts an event: whole, and `part / unit`.
    whole: u32,
    part: u32,
    unit: u32,
    /// Fraction of a count of the next event: `owed / unit`.
    owed: u32,
    count: i32,
    /// When the present count came.
    count_ticks: u32,
    /// Ticks a count, 7 fraction bits; 0 until it is known.
    period: u32,
    is_forward: bool,
    is_timed: bool,
}

/// Fraction bits of the period.
const PERIOD_BITS: u32 = 7;
/// Longest period that is measured: below 2^31 with its fraction.
const LONGEST: u32 = 1 << 24;

impl Follower {
    /// So many `events` in so many `counts`, the first one at count `start`; the encoder is at
    /// `count` now. `None` without events or counts, or with 2^31 events or more.
    pub const fn new(counts: u32, events: u32, start: i32, count: i32) -> Option<Follower> {
        if counts == 0 || events >> 31 != 0 {
            return None;
        }
        let (Some(whole), Some(part)) = (counts.checked_div(events), counts.checked_rem(events))
        else {
            return None;
        };
        Some(Follower {
            ahead: start.wrapping_sub(count) as i64,
            whole,
            part,
            unit: events,
            owed: 0,
            count,
            count_ticks: 0,
            period: 0,
            is_forward: false,
            is_timed: false,
        })
    }

    /// Takes the encoder's count as of `now_ticks`: at every count, or as often as it is read.
    pub fn measure(&mut self, now_ticks: u32, count: i32) {
        let change = count.wrapping_sub(self.count);
        if change == 0 {
            return;
        }
        self.ahead = self.ahead.wrapping_sub(change.into());
        self.count = count;
        if change > 0 && self.is_timed && self.is_forward {
            // Standing still is no period.
            let passed = now_ticks.wrapping_sub(self.count_ticks).min(LONGEST);
            let period = passed
                .wrapping_shl(PERIOD_BITS)
                .checked_div(change.unsigned_abs())
                .unwrap_or(0);
            self.period = if self.period == 0 {
                period
            } else {
                // A quarter of the change; both below 2^31.
                let change = (period as i32).wrapping_sub(self.period as i32) >> 2;
                self.period.wrapping_add_signed(change)
            };
        }
        self.is_timed = true;
        self.is_forward = change > 0;
        self.count_ticks = now_ticks;
    }

    /// When the next event is due.
    pub fn due(&self, now_ticks: u32) -> Due {
        if self.ahead < 0 || (self.ahead == 0 && self.owed == 0 && self.is_forward) {
            return Due::Now;
        }
        if self.ahead > 0 || !self.is_forward || self.period == 0 {
            return Due::NotYet;
        }
        // owed < unit: the product is below 2^62.
        let fraction = u64::from(self.owed)
            .wrapping_mul(self.period.into())
            .checked_div(self.unit.into())
            .unwrap_or(0);
        let wait = (fraction as u32).wrapping_shr(PERIOD_BITS);
        match wait.checked_sub(now_ticks.wrapping_sub(self.count_ticks)) {
            None | Some(0) => Due::Now,
            Some(ticks) => Due::In(ticks),
        }
    }

    /// The event is made: the next one is looked at.
    pub fn advance(&mut self) {
        self.ahead = self.ahead.wrapping_add(self.whole.into());
        // Both below unit < 2^31.
        self.owed = self.owed.wrapping_add(self.part);
        if self.owed >= self.unit {
            self.owed = self.owed.wrapping_sub(self.unit);
            self.ahead = self.ahead.wrapping_add(1);
        }
    }

    /// As [`Follower::advance`] for so many events at once: with one count for 2^16 `events`, the
    /// wait of an event in 2^-16 counts where each has its own.
    pub fn advance_by(&mut self, events: u32) {
        // whole < 2^32, events < 2^32: the product wraps by name only, as counts do after 2^63.
        let counts = i64::from(self.whole).wrapping_mul(events.into());
        // part < unit < 2^31: below 2^63 with what is owed.
        let parts = u64::from(self.part)
            .wrapping_mul(events.into())
            .wrapping_add(self.owed.into());
        let unit = u64::from(self.unit);
        let more = parts.checked_div(unit).unwrap_or(0);
        self.owed = parts.wrapping_sub(more.wrapping_mul(unit)) as u32;
        self.ahead = self.ahead.wrapping_add(counts).wrapping_add_unsigned(more);
    }

    /// Counts from the present one to that of the next event, rounded down; negative when it has
    /// passed.
    pub const fn counts_ahead(&self) -> i64 {
        self.ahead
    }
}

//! Motion that follows a spindle instead of a clock.

/// When the next event of a spindle-synchronised move is due.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Due {
    /// Now, or already passed. Make the event and call [`Follower::advance`].
    Now,
    /// In this many ticks, if the spindle keeps its speed; earlier if the next count comes first.
    /// Ask again at either time.
    In(u32),
    /// Not before another count. Ask again after the next [`Follower::measure`].
    NotYet,
}

/// Time base of spindle-synchronised motion (G33, G76, G95): the events of a path become due at
/// encoder counts.
///
/// ```text
/// counts  |----c----|----c----|----c----|     measured: the time of each count
/// events  |   e     e   |   e     e     |     due at exact fractions of counts
/// ```
///
/// Event k is due at `start + k counts / events`. With 4096 counts per turn, 1.5 mm pitch and steps
/// of 1 um, `counts / events` is 4096 / 1500. The remainder is carried, so the pitch is exact over
/// any number of turns.
///
/// - An event on a count or before it is due when that count has come, never later: **there is no
///   drift**.
/// - Between two counts the time is divided by the measured period of the spindle (its mean over
///   about 4 counts), so the steps are as even as the speed of the spindle. If the spindle changes
///   its speed within a count, an event is less than one count early or late. With more counts than
///   events per turn the pitch error is therefore below one step at any speed and any change of
///   speed. With fewer counts this holds while the speed changes little from count to count.
/// - **Stop**: without counts, only the events of the present count still come. The motion stands
///   with the spindle.
/// - **Reverse**: no step is taken backwards and nothing is due until the spindle is again beyond
///   the farthest event. The thread then continues where it was left.
///
/// The path speed is that of the spindle. If a move engages at speed, the axis needs a run-in, as
/// on any lathe. When a follower is polled late, or the spindle is faster than predicted, several
/// events are due at once; the caller has to keep its minimum interval between steps.
///
/// Range: counts wrap as `i32`, with fewer than 2^31 between two calls. Periods above 2^24 ticks
/// per count are taken as 2^24. Size: 48 bytes.
///
/// # Cost
/// One product and one shift per query, one division per measurement.
///
/// # Examples
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
    /// Counts per event: the whole part, and the fraction `part / unit`.
    whole: u32,
    part: u32,
    unit: u32,
    /// Fraction of a count at which the next event is due: `owed / unit`.
    owed: u32,
    count: i32,
    /// Time of the present count.
    count_ticks: u32,
    /// Ticks per count with 7 fraction bits; 0 until it is known.
    period: u32,
    is_forward: bool,
    is_timed: bool,
}

/// Fraction bits of the period.
const PERIOD_BITS: u32 = 7;
/// Longest period that is measured. With its fraction bits it stays below 2^31.
const LONGEST: u32 = 1 << 24;

impl Follower {
    /// Creates a follower of `events` events in `counts` counts. The first event is at count
    /// `start`; the encoder is at `count` now. Returns `None` for 0 counts, 0 events, or 2^31
    /// events or more.
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

    /// Takes the encoder's count as of `now_ticks`. Call it at every count, or as often as the
    /// encoder is read.
    pub fn measure(&mut self, now_ticks: u32, count: i32) {
        let change = count.wrapping_sub(self.count);
        if change == 0 {
            return;
        }
        self.ahead = self.ahead.wrapping_sub(change.into());
        self.count = count;
        if change > 0 && self.is_timed && self.is_forward {
            // Standstill gives no period.
            let passed = now_ticks.wrapping_sub(self.count_ticks).min(LONGEST);
            let period = passed
                .wrapping_shl(PERIOD_BITS)
                .checked_div(change.unsigned_abs())
                .unwrap_or(0);
            self.period = if self.period == 0 {
                period
            } else {
                // A quarter of the change; both are below 2^31.
                let change = (period as i32).wrapping_sub(self.period as i32) >> 2;
                self.period.wrapping_add_signed(change)
            };
        }
        self.is_timed = true;
        self.is_forward = change > 0;
        self.count_ticks = now_ticks;
    }

    /// Returns when the next event is due.
    pub fn due(&self, now_ticks: u32) -> Due {
        if self.ahead < 0 || (self.ahead == 0 && self.owed == 0 && self.is_forward) {
            return Due::Now;
        }
        if self.ahead > 0 || !self.is_forward || self.period == 0 {
            return Due::NotYet;
        }
        // owed < unit, so the product is below 2^62.
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

    /// Confirms that the event was made and continues to the next one.
    pub fn advance(&mut self) {
        self.ahead = self.ahead.wrapping_add(self.whole.into());
        // Both are below unit < 2^31.
        self.owed = self.owed.wrapping_add(self.part);
        if self.owed >= self.unit {
            self.owed = self.owed.wrapping_sub(self.unit);
            self.ahead = self.ahead.wrapping_add(1);
        }
    }

    /// Does [`Follower::advance`] for `events` events at once. A follower with one count per 2^16
    /// `events` thus takes the wait of each event in 2^-16 counts.
    pub fn advance_by(&mut self, events: u32) {
        // whole < 2^32 and events < 2^32: the product only wraps where the counts would, after
        // 2^63.
        let counts = i64::from(self.whole).wrapping_mul(events.into());
        // part < unit < 2^31, so the sum with the carried remainder is below 2^63.
        let parts = u64::from(self.part)
            .wrapping_mul(events.into())
            .wrapping_add(self.owed.into());
        let unit = u64::from(self.unit);
        let more = parts.checked_div(unit).unwrap_or(0);
        self.owed = parts.wrapping_sub(more.wrapping_mul(unit)) as u32;
        self.ahead = self.ahead.wrapping_add(counts).wrapping_add_unsigned(more);
    }

    /// Counts from the present one to that of the next event, rounded down; negative when that
    /// count has passed.
    pub const fn counts_ahead(&self) -> i64 {
        self.ahead
    }
}

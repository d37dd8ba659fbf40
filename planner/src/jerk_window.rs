//! Look-ahead with limited jerk: one path over all moves, averaged over a window.
//!
//! A path with limited acceleration is planned ahead. The made path is its mean over the last
//! T = a / j. So its acceleration is the change of the planned speed over T, divided by T; it is at
//! most a. Its jerk is the change of the planned acceleration over T, divided by T. It is at most j
//! if these two accelerations are never opposite. The position along the path is averaged, not the
//! axes, so the path itself is exact.
//!
//! The window has 16 slices, in which the planned acceleration is constant. Four rules keep the
//! limits. X is the place of a corner, V the speed allowed there, s and v are the planned path.
//!
//! 1. **Corners.** v is at most V from Y = X - V T / 2 on, until the made path has passed X. From Y
//!    on at most V T is planned within T. The made path is then still before X, so all of the
//!    window at X is planned from Y on, at V or less.
//! 2. **Tops.** v is at most the top speed of the move in which the made path is. The other moves
//!    that v reaches are behind a corner that is still held. Its V is at most their top speeds.
//! 3. **Braking.** Braking to V, as `braking.rs` computes it, ends before Y. It may end up to a
//!    slice early, because speeds change in whole slices. So it is planned to end at Y - V, which
//!    is the *height* Y - V + V^2 / 2 a of the corner in a speed of 0. Level slices and full
//!    braking keep the height that a state needs. So a state that is safe has a safe successor.
//! 4. **Rising.** The end of the queue is a stop. A corner becomes open when it is safe to forget
//!    the stop: rule 3 holds for the corner, or v <= V and s < Y, or no speed in the window is
//!    above V.
//!
//! A corner binds only while v > V. Corners are found in constant time on average:
//!
//! - **A corner with V not below that of a corner before it is hidden.** The window is at V or less
//!   when the made path passes the first one, and the second is considered then. So the corners to
//!   consider have falling V: each links to the next lower one.
//! - **A lower corner with a lower height replaces those before it.** The *candidates* that are
//!   left have falling V and rising heights, so the first one that a speed fits ends the search.
//! - **A corner that a speed does not fit, but which is not below V, is held:** its V is a limit
//!   until the made path has passed it. Each corner is held once.

mod braking;
mod filter;
mod scale;

use crate::{
    Stretch,
    jerk_window::{
        braking::Braking,
        filter::{Filter, SLICES},
        scale::Scale,
    },
    quotient::quotient,
    ring::Ring,
    stretch::Percents,
};

pub(crate) use filter::PARTS;
pub use filter::Slice;
pub use scale::{JerkLimits, JerkLimitsError};

/// A queue of up to `CAPACITY` moves, whose path has limited acceleration and jerk. Each move
/// carries a payload `M`.
///
/// [`next_slice`](JerkWindow::next_slice) gives the path as cubic polynomials of the time.
/// [`JerkRamp`](crate::JerkRamp) times the events in it.
///
/// - **Limits.** Acceleration, jerk, top speeds and the speeds at junctions are never exceeded.
///   This includes holds, resumes and overrides, which act from the next slice on.
/// - **Ends** are exact: the path stops at the end of the last move.
/// - **Moves** lose their own acceleration and start speed: [`JerkLimits`] has one acceleration
///   for all, and a path with limited jerk has no start speed. A move with a lower acceleration A
///   is limited to the speed A T, which is in the ceiling of the move that the queue returns. All
///   speeds of a window then differ by at most that, so its acceleration is at most A. An arc stays
///   below its upper level of speed, because there is less acceleration in it. A length above
///   2^40 nm is taken as this, and a top speed below one unit per slice as one unit.
/// - **Capacity.** At most 512. To reach a speed v, the queue needs moves for a path of about
///   v^2 / 2 a + 1.5 v T.
/// - **Short runs from stop to stop**, below 2 a T^2, get a shorter window with the same jerk, as
///   the seven phases of the optimal profile have it. The stop has to be known when the path leaves
///   the one before it: a move with an entry limit of 0 follows, or
///   [`finish`](JerkWindow::finish) was called.
///
/// # Cost
/// A slice takes additions at constant speed and on ramps. It takes one or two square roots where
/// the acceleration changes. A push takes one 64-bit division.
///
/// # Examples
/// ```
/// use husillo_planner::{JerkLimits, JerkWindow, Stretch};
///
/// let limits = JerkLimits {
///     acceleration_nm_per_s2: 1_000_000_000,
///     jerk_nm_per_s3: 50_000_000_000, // a window of 20 ms
///     highest_nm_per_s: 100_000_000,
/// };
/// let stretch = Stretch {
///     length_nm: 10_000_000,
///     top_nm_per_s: 50_000_000,
///     ceiling_nm_per_s: 100_000_000,
///     obeys_override: true,
///     acceleration_nm_per_s2: 1_000_000_000,
///     start_nm_per_s: 0,
///     upper: None,
///     entry_limit_nm_per_s: 0,
/// };
/// let mut moves = JerkWindow::<(), 8>::new(&limits)?;
/// moves.push(stretch, ()).unwrap();
/// moves.finish();
/// let slices: Vec<_> = std::iter::from_fn(|| moves.next_slice()).collect();
/// // 10 mm at 50 mm/s take 200 ms, the ramps 50 ms more, the window 20 ms more: 216 slices of
/// // 1.25 ms. One more is needed because speeds change in whole slices.
/// assert_eq!(slices.len(), 217);
/// let path: u64 = slices.iter().map(|slice| slice.length()).sum();
/// assert_eq!(path, 10_000_000 * u64::from(moves.units_per_nm()));
/// # Ok::<(), husillo_planner::JerkLimitsError>(())
/// ```
#[derive(Clone, Debug)]
pub struct JerkWindow<M, const CAPACITY: usize> {
    slots: Ring<Slot<M>, CAPACITY>,
    /// Numbers of open corners with no lower corner behind them; their speeds do not fall.
    lows: Ring<u32, CAPACITY>,
    /// Number of the first move; wraps.
    front: u32,
    /// Number of the move in which the made path is.
    made: u32,
    /// Number of the last move that the planned path may enter.
    open: u32,
    /// Numbers of the corners to brake for, with falling speeds and rising heights.
    candidates: Ring<u32, CAPACITY>,
    held: Option<Held>,
    filter: Filter,
    /// Path left in the move in which the made path is, in units of [`Slice`].
    left: i64,
    /// The units of the present run, and those of the whole window.
    scale: Scale,
    whole: Scale,
    /// Whether no more moves follow the last one without a stop.
    is_finished: bool,
    percents: Percents,
    is_held: bool,
}

#[derive(Clone, Debug)]
struct Slot<M> {
    stretch: Stretch,
    payload: M,
    /// End of the move in half units; wraps.
    end: u64,
    corner: Corner,
}

/// The junction before a move, once it is open.
#[derive(Copy, Clone, Debug, Default)]
struct Corner {
    /// Allowed speed in units per slice.
    speed: u32,
    /// Where braking from this speed ends, in half units; wraps.
    height: u64,
    /// Number of the next open corner with a lower speed.
    lower: Option<u32>,
    /// The reverse of this link, while candidates are added.
    higher: u32,
}

/// A corner whose speed is a limit until the path has passed it.
#[derive(Copy, Clone, Debug)]
struct Held {
    number: u32,
    speed: u32,
}

/// The highest speed after a slice.
#[derive(Copy, Clone, Debug)]
struct Choice {
    speed: u32,
    /// Number of candidates that this speed holds.
    count: usize,
    /// The last of them.
    held: Option<Held>,
}

impl<M, const CAPACITY: usize> JerkWindow<M, CAPACITY> {
    /// Creates an empty queue at rest, at an override of 100 %.
    ///
    /// # Errors
    /// Returns the limit that is 0, or why the window does not suit the arithmetic.
    pub fn new(limits: &JerkLimits) -> Result<Self, JerkLimitsError> {
        let scale = Scale::new(limits)?;
        Ok(Self {
            slots: Ring::new(),
            lows: Ring::new(),
            front: 0,
            made: 0,
            open: 0,
            candidates: Ring::new(),
            held: None,
            filter: Filter::at_rest(0),
            left: 0,
            scale,
            whole: scale,
            is_finished: false,
            percents: Percents::FULL,
            is_held: false,
        })
    }

    /// Appends a move. The path no longer has to stop before it, as soon as the limits allow that.
    ///
    /// # Errors
    /// Returns the move when the queue is full.
    ///
    /// # Cost
    /// Constant time.
    pub fn push(&mut self, mut stretch: Stretch, payload: M) -> Result<(), (Stretch, M)> {
        if self.slots.is_full() {
            return Err((stretch, payload));
        }
        let most = self.whole.most_at(stretch.acceleration_nm_per_s2);
        stretch.ceiling_nm_per_s = stretch.ceiling_nm_per_s.min(most);
        self.is_finished = false;
        let start = match self.slots.back() {
            Some(last) => last.end,
            None => {
                self.left = self.units(stretch.length_nm) as i64;
                self.filter.lead.at
            }
        };
        self.slots.push_back(Slot {
            stretch,
            payload,
            end: start.wrapping_add(self.scale.half_units(stretch.length_nm)),
            corner: Corner::default(),
        });
        Ok(())
    }

    /// Removes the first move, after its last event. If the path is still in it, the path goes on
    /// to its end.
    pub fn pop(&mut self) -> Option<(Stretch, M)> {
        let slot = self.slots.pop_front()?;
        if self.made == self.front {
            if self.made == self.open {
                self.open = self.open.wrapping_add(1);
                self.filter = Filter::at_rest(slot.end);
                self.left = 0;
            }
            let next = self.slots.front().map(|slot| slot.stretch.length_nm);
            self.enter_next(next);
        }
        self.front = self.front.wrapping_add(1);
        Some((slot.stretch, slot.payload))
    }

    /// Tells that the path stops after the last move, whatever follows. A short run of moves up to
    /// there is then faster. The next push ends this.
    pub fn finish(&mut self) {
        self.is_finished = true;
    }

    /// The first move.
    pub fn front(&self) -> Option<(&Stretch, &M)> {
        let front = self.slots.front();
        front.map(|slot| (&slot.stretch, &slot.payload))
    }

    /// The move appended last.
    pub fn back(&self) -> Option<(&Stretch, &M)> {
        self.slots.back().map(|slot| (&slot.stretch, &slot.payload))
    }

    /// Number of moves in the queue.
    pub const fn len(&self) -> usize {
        self.slots.len()
    }

    /// Whether there is no move.
    pub const fn is_empty(&self) -> bool {
        self.slots.len() == 0
    }

    /// Whether [`JerkWindow::push`] would return the move.
    pub const fn is_full(&self) -> bool {
        self.slots.is_full()
    }

    /// Drops all moves and stops at once, without a ramp. Hold the path first, if it moves. The
    /// override is kept.
    pub fn clear(&mut self) {
        self.slots.clear();
        self.filter = Filter::at_rest(0);
        self.made = self.front;
        self.open = self.front;
        self.forget();
    }

    /// Feed hold: the path brakes from the next slice on, through as many moves as necessary.
    pub fn hold(&mut self) {
        self.is_held = true;
    }

    /// Ends a hold, even if it has not yet stopped the path.
    pub fn resume(&mut self) {
        self.is_held = false;
    }

    /// Whether a hold is active.
    pub const fn is_held(&self) -> bool {
        self.is_held
    }

    /// The override in percent.
    pub const fn percent(&self) -> u8 {
        self.percents.feed
    }

    /// Units of [`Slice`] in a nanometre, at most 2^12 96.
    pub const fn units_per_nm(&self) -> u32 {
        let bits = self.scale.fraction_bits as u32;
        PARTS.wrapping_mul(2).wrapping_shl(bits)
    }

    /// Duration of the last slice in ticks of a timer, times 2^32. It changes only where the path
    /// stands: a short run of moves between two stops has a shorter window.
    pub fn slice_ticks_q32(&self, timer_hz: u32) -> u64 {
        self.scale.ticks_q32(timer_hz)
    }

    /// Length of a move in units of [`Slice`], below 2^59.
    pub(crate) fn units(&self, length_nm: u64) -> u64 {
        let half_units = self.scale.half_units(length_nm);
        half_units.wrapping_mul(PARTS.into())
    }

    /// Whether the path stands, after the last slice.
    pub fn is_at_rest(&self) -> bool {
        self.filter.is_at_rest()
    }

    /// Converts units of [`Slice`] per slice to nm/s.
    pub(crate) fn nm_per_s(&self, speed: u64) -> u32 {
        self.scale.nm_per_s(speed)
    }

    /// Returns the path of the next slice. Returns `None` at rest: at the end of the queue, or when
    /// a hold has stopped the path.
    pub fn next_slice(&mut self) -> Option<Slice> {
        self.choose_window();
        self.open_corners();
        self.pass_corners();
        let step = self.choose();
        if step == 0 && self.filter.is_at_rest() {
            return None;
        }
        let slice = self.filter.pass(step);
        // Below 2^38.
        self.left = self.left.wrapping_sub_unsigned(slice.length());
        self.pass_corners();
        Some(slice)
    }

    /// Chooses the window of a run from stop to stop before it begins.
    fn choose_window(&mut self) {
        if !self.filter.is_at_rest() || self.made != self.open {
            return;
        }
        let Some(slot) = self.slot(self.open) else {
            return;
        };
        let at = self.filter.lead.at;
        let first = if slot.end == at {
            self.open.wrapping_add(1)
        } else {
            self.open
        };
        if self.slot(first).is_none() || slot.end != at && !self.is_at_start() {
            return;
        }
        self.scale = match self.length_of_run(first) {
            Some(length) => self.whole.shortened(length),
            None => self.whole,
        };
    }

    /// Whether the made path is at the start of its move.
    fn is_at_start(&self) -> bool {
        let length = self.slot(self.made).map(|slot| slot.stretch.length_nm);
        length.map(|length_nm| self.units(length_nm)) == u64::try_from(self.left).ok()
    }

    /// Length of the moves up to the next stop in half units, from rest before the move `first`.
    /// `None` if it is too long for a shorter window, if the stop is not known, or if a move has
    /// less acceleration than the whole window.
    fn length_of_run(&self, first: u32) -> Option<u64> {
        let mut number = first;
        let mut length = 0;
        loop {
            let Some(slot) = self.slot(number) else {
                return self.is_finished.then_some(length);
            };
            if number != first && slot.stretch.entry_limit_nm_per_s == 0 {
                return Some(length);
            }
            length = slot.end.wrapping_sub(self.filter.lead.at);
            if self.whole.fills_window(length)
                || slot.stretch.acceleration_nm_per_s2 < self.whole.acceleration
            {
                return None;
            }
            number = number.wrapping_add(1);
        }
    }

    fn slot(&self, number: u32) -> Option<&Slot<M>> {
        let offset = number.wrapping_sub(self.front);
        self.slots.get(usize::try_from(offset).ok()?)
    }

    fn corner_mut(&mut self, number: u32) -> Option<&mut Corner> {
        let offset = usize::try_from(number.wrapping_sub(self.front)).ok()?;
        Some(&mut self.slots.get_mut(offset)?.corner)
    }

    /// Chooses the change of the planned speed in the next slice: the highest that all rules allow.
    fn choose(&mut self) -> i32 {
        let speed = self.filter.lead.speed;
        let [lowest, highest] = self.filter.steps(self.scale.step);
        let top = self.top();
        let wanted = speed.saturating_add_signed(highest).min(top);
        if wanted > speed {
            let choice = self.limited(wanted, true);
            if choice.speed > speed {
                self.hold_corners(&choice);
                return choice.speed.wrapping_sub(speed) as i32;
            }
        }
        // Where a top speed has just become lower, the speed falls as fast as allowed.
        let least = speed.saturating_add_signed(lowest);
        let choice = self.limited(top.min(speed).max(least), false);
        self.hold_corners(&choice);
        // The speed is below 2^30, and the rules never ask for more than full braking.
        choice.speed.max(least).wrapping_sub(speed) as i32
    }

    fn hold_corners(&mut self, choice: &Choice) {
        for _ in 0..choice.count {
            self.candidates.pop_front();
        }
        self.held = choice.held;
    }

    /// Highest speed without regard to what comes.
    fn top(&self) -> u32 {
        if self.is_held {
            return 0;
        }
        let Some(slot) = self.slot(self.made) else {
            return 0;
        };
        let top = self.scale.speed(slot.stretch.lower_top(self.percents));
        let top = top.max(1);
        self.held.map_or(top, |held| top.min(held.speed))
    }

    /// Returns the highest speed up to `wanted` at the end of the slice from which the path can
    /// brake for everything that comes.
    fn limited(&self, wanted: u32, is_rise: bool) -> Choice {
        let wait = self.filter.wait_after(is_rise);
        let braking = Braking::after(&self.scale, self.filter.lead.speed, wait);
        let mut choice = Choice {
            speed: wanted,
            count: 0,
            held: self.held,
        };
        // A rise that is no rise costs no root.
        let speed = self.filter.lead.speed;
        let is_level =
            |room, is_low| is_rise && !braking.fits(speed.saturating_add(1), room, is_low);
        while let Some((number, corner)) = self.candidate(choice.count) {
            let room = Braking::room(&self.filter.lead, corner.height);
            let is_low = corner.speed <= self.scale.step;
            if braking.fits(choice.speed, room, is_low) {
                break;
            }
            if choice.speed > corner.speed {
                if corner.speed <= speed && is_level(room, is_low) {
                    choice.speed = speed;
                    return choice;
                }
                let highest = braking.highest(room, is_low).max(corner.speed);
                choice.speed = choice.speed.min(highest);
                if choice.speed > corner.speed {
                    break;
                }
            }
            choice.held = Some(Held {
                number,
                speed: corner.speed,
            });
            choice.count = choice.count.wrapping_add(1);
        }
        if let Some(last) = self.slot(self.open) {
            let room = Braking::room(&self.filter.lead, last.end);
            if !braking.fits(choice.speed, room, true) {
                choice.speed = if is_level(room, true) {
                    choice.speed.min(speed)
                } else {
                    choice.speed.min(braking.highest(room, true))
                };
            }
        }
        choice
    }

    fn candidate(&self, offset: usize) -> Option<(u32, &Corner)> {
        let number = *self.candidates.get(offset)?;
        Some((number, &self.slot(number)?.corner))
    }

    /// Opens the corners that the path no longer has to stop at.
    fn open_corners(&mut self) {
        while let Some(corner) = self.corner_to_open() {
            self.open = self.open.wrapping_add(1);
            self.add(self.open, corner);
        }
    }

    /// The corner at the end of the last open move, if it may be opened now.
    fn corner_to_open(&self) -> Option<Corner> {
        let last = self.slot(self.open)?;
        let corner = self.corner(self.open)?;
        let is_open = if corner.speed == 0 {
            self.filter.is_at_rest() && self.filter.lead.at == last.end
        } else {
            self.lowest_speed() <= corner.speed || self.is_safe(last.end, &corner)
        };
        is_open.then_some(corner)
    }

    /// The corner behind a move, with the present override.
    fn corner(&self, number: u32) -> Option<Corner> {
        let before = self.slot(number)?;
        let after = self.slot(number.wrapping_add(1))?;
        let speed = after
            .stretch
            .entry_limit_nm_per_s
            .min(before.stretch.lower_top(self.percents))
            .min(after.stretch.lower_top(self.percents));
        let speed = self.scale.speed(speed);
        let squared = u64::from(speed).wrapping_mul(speed.into());
        Some(Corner {
            speed,
            // Y is 16 half units of the speed before the corner, and Y - V is 18.
            height: before
                .end
                .wrapping_sub(u64::from(speed).wrapping_mul(SLICES as u64 + 2))
                .wrapping_add(quotient(squared, self.scale.step)),
            lower: None,
            higher: 0,
        })
    }

    /// Whether rules 1 and 3 hold for a corner at `place` from now on.
    fn is_safe(&self, place: u64, corner: &Corner) -> bool {
        let lead = &self.filter.lead;
        let braking = Braking::now(&self.scale, self.filter.wait());
        let is_low = corner.speed <= self.scale.step;
        if braking.is_within(lead.speed, Braking::room(lead, corner.height), is_low) {
            return true;
        }
        if lead.speed > corner.speed {
            return false;
        }
        let reach = u64::from(corner.speed).wrapping_mul(SLICES as u64);
        let before = place.wrapping_sub(reach).wrapping_sub(lead.at) as i64;
        before > 0 || self.filter.highest() <= corner.speed
    }

    /// Adds the next open corner to the search.
    fn add(&mut self, number: u32, corner: Corner) {
        if let Some(place) = self.corner_mut(number) {
            *place = corner;
        }
        while let Some(back) = self.lows.back().copied() {
            let Some(last) = self.corner_mut(back) else {
                break;
            };
            if last.speed <= corner.speed {
                break;
            }
            last.lower = Some(number);
            self.lows.pop_back();
        }
        if self.lows.len() == 0 {
            // It is lower than all before it.
            while let Some(back) = self.candidates.back() {
                let height = self.slot(*back).map_or(0, |slot| slot.corner.height);
                if (corner.height.wrapping_sub(height) as i64) > 0 {
                    break;
                }
                self.candidates.pop_back();
            }
            self.candidates.push_back(number);
        }
        self.lows.push_back(number);
    }

    /// Passes the corners that are behind the made path.
    fn pass_corners(&mut self) {
        while self.left <= 0 && self.made != self.open {
            let next = self.slot(self.made.wrapping_add(1));
            let length_nm = next.map(|slot| slot.stretch.length_nm);
            self.enter_next(length_nm);
        }
    }

    /// Goes on to the next move, which has this length. The corner before it no longer binds nor
    /// hides others.
    fn enter_next(&mut self, length_nm: Option<u64>) {
        let length = length_nm.map_or(0, |length_nm| self.units(length_nm));
        self.left = self.left.wrapping_add_unsigned(length);
        self.made = self.made.wrapping_add(1);
        if self.lows.front() == Some(&self.made) {
            self.lows.pop_front();
        }
        if self.candidates.front() == Some(&self.made) {
            self.candidates.pop_front();
        }
        match self.held {
            // A corner farther on is lower.
            Some(held) if held.number != self.made => {}
            _ => {
                self.held = None;
                self.uncover();
            }
        }
    }

    /// Adds the candidates that the corner before the present move has hidden.
    fn uncover(&mut self) {
        if self.made == self.open {
            return;
        }
        let end = self.slot(self.made).and_then(|slot| slot.corner.lower);
        let mut last = self.made;
        let mut next = Some(self.made.wrapping_add(1));
        while let Some(number) = next.filter(|_| next != end) {
            let Some(corner) = self.corner_mut(number) else {
                break;
            };
            corner.higher = last;
            (last, next) = (number, corner.lower);
        }
        while last != self.made {
            let Some(corner) = self.slot(last).map(|slot| slot.corner) else {
                break;
            };
            let height = self.candidate(0).map(|(_, lower)| lower.height);
            if height.is_none_or(|height| (height.wrapping_sub(corner.height) as i64) > 0) {
                self.candidates.push_front(last);
            }
            last = corner.higher;
        }
    }

    /// Forgets all open corners.
    fn forget(&mut self) {
        self.lows.clear();
        self.candidates.clear();
        self.held = None;
    }

    /// Scales the programmed speeds by 1 to 200 percent. Other values count as the nearest of
    /// these.
    ///
    /// Visits every open move. The path speeds up or brakes from the next slice on. After a lower
    /// override, it passes moves that are nearer than its braking distance faster than the new
    /// override, but within their ceilings.
    pub fn set_override(&mut self, percent: u8) {
        self.set_percents(self.percents.with_feed(percent));
    }

    /// Scales the speeds of rapids, which do not obey the other override, by 1 to 100 percent.
    /// Other values count as the nearest of these.
    pub fn set_rapid_override(&mut self, percent: u8) {
        self.set_percents(self.percents.with_rapid(percent));
    }

    fn set_percents(&mut self, percents: Percents) {
        if percents == self.percents {
            return;
        }
        self.percents = percents;
        // Corners behind the braking distance are opened again later, at their new speeds.
        let last = self.last_within_braking();
        let is_possible = self.all_reopen(last);
        self.forget();
        self.open = self.made;
        while self.open != last {
            let number = self.open.wrapping_add(1);
            let old = self.slot(number).map(|slot| slot.corner);
            let corner = match self.reopened(number, self.lowest_speed()) {
                Some(corner) if is_possible => corner,
                _ => Corner {
                    lower: None,
                    ..old.unwrap_or_default()
                },
            };
            self.open = number;
            self.add(number, corner);
        }
    }

    /// Whether all open corners up to `last` have a safe speed under a new override.
    fn all_reopen(&self, last: u32) -> bool {
        let mut number = self.made;
        let mut lowest = u32::MAX;
        while number != last {
            number = number.wrapping_add(1);
            match self.reopened(number, lowest) {
                Some(corner) => lowest = lowest.min(corner.speed),
                None => return false,
            }
        }
        true
    }

    /// The open corner before a move under a new override, or the old one where the new one is not
    /// safe. `None` if neither is safe, because a corner before it was raised.
    fn reopened(&self, number: u32, lowest: u32) -> Option<Corner> {
        let before = number.wrapping_sub(1);
        let new = self.corner(before)?;
        let old = Corner {
            lower: None,
            ..self.slot(number)?.corner
        };
        let place = self.slot(before)?.end;
        [new, old].into_iter().find(|corner| {
            corner.speed != 0 && (lowest <= corner.speed || self.is_safe(place, corner))
        })
    }

    /// The lowest speed of the open corners.
    fn lowest_speed(&self) -> u32 {
        let lowest = self.lows.front().and_then(|number| self.slot(*number));
        lowest.map_or(u32::MAX, |slot| slot.corner.speed)
    }

    /// The first open move at whose end the path can still stop.
    fn last_within_braking(&self) -> u32 {
        let lead = &self.filter.lead;
        let braking = Braking::now(&self.scale, self.filter.wait());
        let mut number = self.made;
        while number != self.open {
            let Some(slot) = self.slot(number) else {
                break;
            };
            if braking.is_within(lead.speed, Braking::room(lead, slot.end), true) {
                break;
            }
            number = number.wrapping_add(1);
        }
        number
    }
}

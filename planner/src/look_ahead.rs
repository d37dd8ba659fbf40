//! Highest speed at the end of each move, given the moves after it.
//!
//! Braking with the acceleration a over a length L changes the square of the speed by 2 a L. The
//! sum of these along the queue is the *height* of a junction. For every junction behind the first
//! move, the square of the speed at the end of that move is at most the square of the speed allowed
//! at the junction plus the height between them. The least of these bounds holds:
//!
//! ```text
//!  height + limit^2
//!     |                x           x  junction, no limit to anything before it
//!     |      x     o               o  candidate: lower than all behind it
//!     |   o                      end  speed 0 (or the start speed)
//!     +---+--+-----+---+----------+-> junctions, first move's end on the left
//! ```
//!
//! Only the candidates are kept. A new junction removes all junctions before it that are higher.
//! Each move is therefore visited twice, for any length of the queue. The lowest candidate is
//! always the first one. This is the known algorithm for the minimum of a sliding window. The two
//! passes of Grbl's planner.c give the same speeds.
//!
//! On arcs less acceleration is left at high speeds ([`Upper`](crate::Upper)). While such moves are
//! in the queue, two plans stand side by side. The first one stays below these speeds and has the
//! whole acceleration. The second one has the small acceleration at all speeds. At each point the
//! higher of the two speeds is possible: where it is that of the first plan, the speed is low, and
//! where it is that of the second one, the acceleration is small. Without such moves both plans are
//! the same, so only the first one is kept. The second one begins as a copy. A move is copied at
//! most once, because it leaves the queue before the move that the copy was made for.

mod plan;

use crate::stretch::{Percents, square};
use crate::{Stretch, ring::Ring};
use plan::Plans;

/// Highest speeds of the executing move, now and at its end.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Limits {
    /// Speed of the move with the override, at most the limit of the machine.
    pub top_nm_per_s: u32,
    /// Square of the highest speed at the end of the move, (nm/s)^2.
    pub exit_squared: u64,
    /// Changes whenever one of the other two changes. Wraps.
    pub version: u32,
}

/// A queue of up to `CAPACITY` moves, the executing one included. Each move carries a payload `M`.
///
/// A place takes 72 bytes on a 32-bit processor, in addition to its payload. There are at most
/// 1024.
///
/// # Examples
/// ```
/// use husillo_planner::{LookAhead, Stretch};
///
/// let millimetre = Stretch {
///     length_nm: 1_000_000,
///     top_nm_per_s: 10_000_000,
///     ceiling_nm_per_s: 50_000_000,
///     obeys_override: true,
///     acceleration_nm_per_s2: 10_000_000,
///     start_nm_per_s: 0,
///     upper: None,
///     entry_limit_nm_per_s: u32::MAX,
/// };
/// let mut moves = LookAhead::<&str, 2>::new();
/// moves.push(millimetre, "first").unwrap();
/// assert_eq!(moves.limits().exit_squared, 0); // nothing behind: it has to stop
/// moves.push(millimetre, "second").unwrap();
/// assert_eq!(moves.limits().exit_squared, 2 * 10_000_000 * 1_000_000); // 2 a L
/// assert_eq!(moves.push(millimetre, "third"), Err((millimetre, "third"))); // full
/// ```
#[derive(Clone, Debug)]
pub struct LookAhead<M, const CAPACITY: usize> {
    slots: Ring<Slot<M>, CAPACITY>,
    plans: Plans<CAPACITY>,
    /// Sequence number of the first move; wraps.
    front_number: u32,
    percents: Percents,
    limits: Limits,
}

#[derive(Clone, Debug)]
struct Slot<M> {
    stretch: Stretch,
    payload: M,
}

impl<M, const CAPACITY: usize> LookAhead<M, CAPACITY> {
    /// Creates an empty queue at an override of 100 %.
    pub const fn new() -> Self {
        Self {
            slots: Ring::new(),
            plans: Plans::new(),
            front_number: 0,
            percents: Percents::FULL,
            limits: Limits {
                top_nm_per_s: 0,
                exit_squared: 0,
                version: 0,
            },
        }
    }

    /// Appends a move. The speeds of the moves before it may rise; none ever falls.
    ///
    /// # Errors
    /// Returns the move when the queue is full.
    ///
    /// # Cost
    /// Constant time on average, no division.
    pub fn push(&mut self, stretch: Stretch, payload: M) -> Result<(), (Stretch, M)> {
        if self.slots.is_full() {
            return Err((stretch, payload));
        }
        let gain = stretch.gain();
        match self.slots.back() {
            Some(last) => {
                // At most 2^31 moves wait, so the numbers of the moves in the queue differ.
                let number = self.front_number.wrapping_add(self.slots.len() as u32);
                self.plans
                    .join(number, &last.stretch, &stretch, gain, self.percents);
            }
            None => self.plans.start(&stretch, gain),
        }
        self.slots.push_back(Slot { stretch, payload });
        let top = if self.slots.len() == 1 {
            self.top()
        } else {
            self.limits.top_nm_per_s
        };
        self.update_limits(top);
        Ok(())
    }

    /// Removes the first move after its execution. The next move becomes the executing one.
    pub fn pop(&mut self) -> Option<(Stretch, M)> {
        let slot = self.slots.pop_front()?;
        self.front_number = self.front_number.wrapping_add(1);
        if let Some(front) = self.slots.front() {
            self.plans
                .advance(&slot.stretch, self.front_number, &front.stretch);
        }
        self.update_limits(self.top());
        Some((slot.stretch, slot.payload))
    }

    /// The executing move, or the move to execute next.
    pub fn front(&self) -> Option<(&Stretch, &M)> {
        self.slots
            .front()
            .map(|slot| (&slot.stretch, &slot.payload))
    }

    /// The move appended last.
    pub fn back(&self) -> Option<(&Stretch, &M)> {
        self.slots.back().map(|slot| (&slot.stretch, &slot.payload))
    }

    /// Returns the current limits of the first move. They may rise, so read them at every event.
    /// All are zero if the queue is empty.
    #[inline]
    pub const fn limits(&self) -> &Limits {
        &self.limits
    }

    /// Scales the programmed speeds by 1 to 200 percent. Other values count as the nearest of
    /// these.
    ///
    /// Visits every move once. After a lower override the executing move may have to brake to a
    /// speed that it cannot reach in time. [`Ramp`](crate::Ramp) then brakes as hard as allowed,
    /// and no junction is passed faster than its limit.
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
        let Some(mut last) = self.slots.front() else {
            return;
        };
        self.plans.start(&last.stretch, last.stretch.gain());
        for offset in 1..self.slots.len() {
            let Some(slot) = self.slots.get(offset) else {
                break;
            };
            let number = self.front_number.wrapping_add(offset as u32);
            let gain = slot.stretch.gain();
            self.plans
                .join(number, &last.stretch, &slot.stretch, gain, percents);
            last = slot;
        }
        self.update_limits(self.top());
    }

    /// The override in percent.
    pub const fn percent(&self) -> u8 {
        self.percents.feed
    }

    /// Number of moves in the queue, the executing one included.
    pub const fn len(&self) -> usize {
        self.slots.len()
    }

    /// Whether there is no move to execute.
    pub const fn is_empty(&self) -> bool {
        self.slots.len() == 0
    }

    /// Whether [`LookAhead::push`] would return the move.
    pub const fn is_full(&self) -> bool {
        self.slots.is_full()
    }

    /// Drops all moves and keeps the override.
    pub fn clear(&mut self) {
        self.slots.clear();
        self.plans.clear();
        self.update_limits(self.top());
    }

    /// Top speed of the first move.
    fn top(&self) -> u32 {
        let front = self.slots.front();
        front.map_or(0, |front| front.stretch.top_under(self.percents))
    }

    /// Computes the limits of the first move, which has this top speed.
    fn update_limits(&mut self, top_nm_per_s: u32) {
        let exit_squared = match self.slots.back() {
            Some(last) => {
                let stop = square(last.stretch.start_nm_per_s);
                self.plans.exit_squared(stop)
            }
            None => 0,
        };
        if top_nm_per_s != self.limits.top_nm_per_s || exit_squared != self.limits.exit_squared {
            self.limits.top_nm_per_s = top_nm_per_s;
            self.limits.exit_squared = exit_squared;
            self.limits.version = self.limits.version.wrapping_add(1);
        }
    }
}

impl<M, const CAPACITY: usize> Default for LookAhead<M, CAPACITY> {
    fn default() -> Self {
        Self::new()
    }
}

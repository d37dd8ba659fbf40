//! Timing of the events of a path with limited jerk.

mod law;

use crate::{JerkWindow, Piece, Stretch, Timer, Waits};

use law::{Law, Passage};

/// Times the events of the moves in a [`JerkWindow`].
///
/// It takes the slices of the window as it needs them. An event may begin in one slice and end in
/// another one.
///
/// - **Time.** Slices have equal, exact durations, and the fraction of a tick is carried, so there
///   is no drift. The last event of a move is exactly where the move ends.
/// - **Within a slice** a cubic gives the time as a function of the path (Hermite interpolation).
///   It has the exact times and speeds at both ends of the slice. Events are at most 0.02 of an
///   interval off. Where the speed changes by more than a quarter in a slice, next to standstill,
///   the time is exact to a tick.
/// - **A hold and an override** act on the next slice.
///
/// # Cost
/// An event of a line takes three 64-bit additions, and a slice with such events about twenty
/// 32-bit products and two divisions. An event of an arc takes about ten products. Next to
/// standstill an event takes one to three divisions.
///
/// # Examples
/// ```
/// use husillo_planner::{JerkLimits, JerkRamp, JerkWindow, Stretch};
///
/// let limits = JerkLimits {
///     acceleration_nm_per_s2: 1_000_000_000,
///     jerk_nm_per_s3: 50_000_000_000, // a window of 20 ms
///     highest_nm_per_s: 100_000_000,
/// };
/// let stretch = Stretch {
///     length_nm: 10_000_000, // 4000 steps of 2.5 um
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
/// let mut ramp = JerkRamp::new(1_000_000);
/// ramp.begin(&stretch, 4_000, 1, &moves);
/// let waits: Vec<u64> = (0..4_000).map_while(|_| ramp.wait(1, &mut moves)).collect();
/// assert_eq!(waits[2_000], 50); // 2.5 um at 50 mm/s
/// assert_eq!(waits.iter().sum::<u64>(), 271_250); // 217 slices of 1250 us
/// # Ok::<(), husillo_planner::JerkLimitsError>(())
/// ```
#[derive(Clone, Debug)]
pub struct JerkRamp {
    /// Coming events of a line, and the fraction of a tick.
    piece: Piece,
    owed: u32,
    /// Whether the last event was begun, but not made because of a hold.
    is_pending: bool,
    is_line: bool,
    timer_hz: u32,
    /// The present slice.
    law: Law,
    passage: Passage,
    /// Where the next event is, from the start of the slice.
    target: u64,
    /// Time of past slices that was not given, in 2^-32 tick.
    late: u64,
    /// Path per event.
    path: Timer,
    /// Path of the longest event of a line; 0 if it is too long for a piece.
    longest: u32,
    /// Events left in a line.
    left: u64,
}

/// Most events of a piece.
const MOST: u32 = 1024;

impl JerkRamp {
    /// Creates a ramp at standstill. Waits are in ticks of `timer_hz`.
    pub fn new(timer_hz: u32) -> JerkRamp {
        JerkRamp {
            piece: Piece::default(),
            owed: 0,
            is_pending: false,
            is_line: true,
            timer_hz,
            law: Law::default(),
            passage: Passage::default(),
            target: 0,
            late: 0,
            path: Timer::new(0, 1, 1),
            longest: 0,
            left: 0,
        }
    }

    /// Begins a move, after the last event of the move before it.
    ///
    /// `total_sweep` is the sum over all events of the move, and `largest_sweep` that of the
    /// largest event. A move without events is begun with a sweep of 1, and
    /// [`wait`](JerkRamp::wait) is called once. Its ticks are carried to the next event if the
    /// caller drops it.
    ///
    /// # Cost
    /// Two to three 64-bit divisions.
    pub fn begin<M, const CAPACITY: usize>(
        &mut self,
        stretch: &Stretch,
        total_sweep: u64,
        largest_sweep: u32,
        window: &JerkWindow<M, CAPACITY>,
    ) {
        let total = total_sweep.max(1);
        let length = window.units(stretch.length_nm);
        self.is_line = largest_sweep <= 1;
        // The longest wait is below 2^59.
        let largest = if self.is_line {
            total.min(MOST.into()) as u32
        } else {
            largest_sweep
        };
        self.path = Timer::new(length, total, largest);
        self.left = total;
        let event = length.checked_div(total).unwrap_or(0);
        // Where the events are not equal, some are a unit longer.
        let is_equal = event.wrapping_mul(total) == length;
        let longest = event.saturating_add((!is_equal).into());
        self.longest = u32::try_from(longest).unwrap_or(0);
        self.piece.count = 0;
        self.is_pending = false;
    }

    /// Returns the ticks to wait before an event of this `sweep`, which is at most the largest one.
    ///
    /// Returns `None` when a hold has stopped the path. The event was then not made. Call again
    /// with the same sweep after [`JerkWindow::resume`].
    #[inline]
    pub fn wait<M, const CAPACITY: usize>(
        &mut self,
        sweep: u32,
        window: &mut JerkWindow<M, CAPACITY>,
    ) -> Option<u64> {
        if let Some(count) = self.piece.count.checked_sub(1) {
            self.piece.count = count;
            return Some(self.piece.step(&mut self.owed).into());
        }
        self.wait_with_care(sweep, window)
    }

    /// Writes the waits before the next events of a line, as [`wait`](JerkRamp::wait) returns them
    /// for a sweep of 1. There are as many as there are places, and no more events than the move
    /// has left. There are fewer where a hold stops the path or where a wait is longer than 2^31
    /// ticks, and none if the move has events of different sweep.
    ///
    /// # Cost
    /// Less than [`wait`](JerkRamp::wait) for each event: the state of a piece stays in registers.
    pub fn fill<'a, M, const CAPACITY: usize>(
        &mut self,
        mut places: impl ExactSizeIterator<Item = &'a mut u32>,
        window: &mut JerkWindow<M, CAPACITY>,
    ) -> Waits {
        let mut waits = Waits::NONE;
        while self.is_line && places.len() != 0 {
            if self.piece.count != 0 && self.piece.is_quick() {
                self.piece.fill(&mut self.owed, &mut places, &mut waits);
                continue;
            }
            let Some(wait) = self.wait(1, window) else {
                break;
            };
            let Some(place) = places.next() else { break };
            if !waits.add(wait, place) {
                break;
            }
        }
        waits
    }

    /// Times an event that is not in a piece.
    #[inline(never)]
    fn wait_with_care<M, const CAPACITY: usize>(
        &mut self,
        sweep: u32,
        window: &mut JerkWindow<M, CAPACITY>,
    ) -> Option<u64> {
        if !self.is_pending {
            self.target = self.passage.passed.wrapping_add(self.path.wait(sweep));
            self.left = self.left.saturating_sub(1);
        }
        while self.target > self.law.length {
            self.late = self.late.saturating_add(self.passage.rest(&self.law));
            self.target = self.target.wrapping_sub(self.law.length);
            let slice = window.next_slice();
            self.is_pending = slice.is_none();
            self.passage = Passage::default();
            self.law = match slice {
                Some(slice) => Law::new(&slice, window.slice_ticks_q32(self.timer_hz)),
                None => Law::default(),
            };
            if self.is_pending {
                return None;
            }
        }
        self.is_pending = false;
        let time = self.passage.pass(self.target, &self.law);
        let time = time.saturating_add(self.late);
        self.late = 0;
        if self.is_line {
            self.begin_piece();
        }
        let fraction = u64::from(self.owed).wrapping_add(time & 0xffff_ffff);
        self.owed = fraction as u32;
        Some((time >> 32).wrapping_add(fraction >> 32))
    }

    /// Prepares the events of a line that end in the present slice.
    fn begin_piece(&mut self) {
        if !self.law.is_smooth() || self.longest == 0 {
            return;
        }
        let share = self.law.share(self.longest.into());
        let count = self.law.count(&self.passage, self.longest, share, MOST);
        let count = count.min(self.left.min(MOST.into()) as u32);
        if count < 4 {
            return;
        }
        let path = self.path.wait(count);
        self.left = self.left.wrapping_sub(count.into());
        self.piece = self.passage.piece(count, share, path, &self.law);
    }

    /// Whether the path stands: all slices have been passed, and a hold or the end of the queue has
    /// stopped the path.
    pub fn is_at_rest<M, const CAPACITY: usize>(&self, window: &JerkWindow<M, CAPACITY>) -> bool {
        let is_passed = self.piece.count == 0 && self.passage.passed >= self.law.length;
        is_passed && window.is_at_rest()
    }

    /// Path speed in nm/s after the last event, or after the last of the events of a line that are
    /// timed together.
    pub fn speed_nm_per_s<M, const CAPACITY: usize>(
        &self,
        window: &JerkWindow<M, CAPACITY>,
    ) -> u32 {
        window.nm_per_s(self.passage.speed(&self.law))
    }

    /// Forgets the rest of the path, after [`JerkWindow::clear`]. The next event starts from rest.
    pub fn stop(&mut self) {
        self.piece.count = 0;
        self.law = Law::default();
        self.passage = Passage::default();
        self.is_pending = false;
        self.late = 0;
    }
}

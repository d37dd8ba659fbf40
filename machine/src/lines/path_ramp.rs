//! How the speed along the path changes: with limited acceleration, or with limited jerk as well.

use core::fmt::Debug;

use husillo_planner::{JerkLimits, LookAhead, Ramp, Stretch, Waits};

/// The queue of moves and the timing of their events. There are two implementations:
/// [`planner::Ramp`](Ramp) for limited acceleration, which contains nothing of the code for jerk,
/// and [`SmoothRamp`](crate::SmoothRamp).
pub trait PathRamp: RampParts {}

impl PathRamp for Ramp {}

/// The methods of a [`PathRamp`], which are those of this crate.
pub trait RampParts: Clone + Debug {
    /// The queue of moves.
    type Queue<M: Clone + Debug, const QUEUE: usize>: MoveQueue<M>;

    /// A ramp at standstill; waits are in ticks of `timer_hz`.
    fn new(timer_hz: u32) -> Self;
    /// Begins the first move of the queue: [`Ramp::begin`].
    fn begin<M: Clone + Debug, const QUEUE: usize>(
        &mut self,
        stretch: &Stretch,
        sweeps: [u64; 2],
        time_q16: u64,
        moves: &Self::Queue<M, QUEUE>,
    );
    /// Ticks before the next event; `None` if a hold has stopped the path.
    fn wait<M: Clone + Debug, const QUEUE: usize>(
        &mut self,
        sweep: u32,
        moves: &mut Self::Queue<M, QUEUE>,
    ) -> Option<u64>;
    /// Writes the waits before the next events of a line: [`Ramp::fill`].
    fn fill<'a, M: Clone + Debug, const QUEUE: usize>(
        &mut self,
        places: impl ExactSizeIterator<Item = &'a mut u32>,
        moves: &mut Self::Queue<M, QUEUE>,
    ) -> Waits;
    /// Most sweep of the next events of an arc that can be timed together: [`Ramp::room`].
    fn room<M: Clone + Debug, const QUEUE: usize>(&mut self, moves: &Self::Queue<M, QUEUE>) -> u32;
    /// Replaces their sweeps by the waits before them: [`Ramp::fill_swept`].
    fn fill_swept<'a>(&mut self, places: impl Iterator<Item = &'a mut u32>) -> Waits;
    /// Path speed in nm/s.
    fn speed_nm_per_s<M: Clone + Debug, const QUEUE: usize>(
        &self,
        moves: &Self::Queue<M, QUEUE>,
    ) -> u32;
    /// Whether the path stands.
    fn is_at_rest<M: Clone + Debug, const QUEUE: usize>(
        &self,
        moves: &Self::Queue<M, QUEUE>,
    ) -> bool;
    /// Sets the speed to 0. With limited jerk, the queue is empty or cleared as well.
    fn stop(&mut self);
    /// Feed hold.
    fn hold(&mut self);
    /// Ends a hold.
    fn resume(&mut self);
    /// Whether a hold is active.
    fn is_held(&self) -> bool;
}

/// A queue of moves with payload `M`, as [`LookAhead`] has it.
pub trait MoveQueue<M>: Clone + Debug {
    /// An empty queue. `limits` are those of the jerk.
    fn new(limits: Option<&JerkLimits>) -> Self;
    /// Appends a move; returns whether there was room.
    fn push(&mut self, stretch: Stretch, payload: M) -> bool;
    /// The path stops after the last move, whatever follows.
    fn finish(&mut self) {}
    /// Removes the first move, after its last event.
    fn pop(&mut self) -> Option<(Stretch, M)>;
    /// The first move.
    fn front(&self) -> Option<(&Stretch, &M)>;
    /// Number of moves.
    fn len(&self) -> usize;
    /// Whether there is no move.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }
    /// Whether there is no room.
    fn is_full(&self) -> bool;
    /// Drops all moves.
    fn clear(&mut self);
    /// The override of the feed in percent.
    fn percent(&self) -> u8;
    /// Sets the override of the feed.
    fn set_override(&mut self, percent: u8);
    /// Sets the override of the rapids.
    fn set_rapid_override(&mut self, percent: u8);
}

impl RampParts for Ramp {
    type Queue<M: Clone + Debug, const QUEUE: usize> = LookAhead<M, QUEUE>;

    fn new(timer_hz: u32) -> Self {
        Ramp::new(timer_hz)
    }

    #[inline]
    fn begin<M: Clone + Debug, const QUEUE: usize>(
        &mut self,
        stretch: &Stretch,
        [sweep, largest]: [u64; 2],
        time_q16: u64,
        _: &LookAhead<M, QUEUE>,
    ) {
        self.begin(stretch, sweep, largest as u32, time_q16);
    }

    #[inline]
    fn wait<M: Clone + Debug, const QUEUE: usize>(
        &mut self,
        sweep: u32,
        moves: &mut LookAhead<M, QUEUE>,
    ) -> Option<u64> {
        self.wait(sweep, moves.limits())
    }

    #[inline]
    fn fill<'a, M: Clone + Debug, const QUEUE: usize>(
        &mut self,
        places: impl ExactSizeIterator<Item = &'a mut u32>,
        moves: &mut LookAhead<M, QUEUE>,
    ) -> Waits {
        self.fill(places, moves.limits())
    }

    #[inline]
    fn room<M: Clone + Debug, const QUEUE: usize>(&mut self, moves: &LookAhead<M, QUEUE>) -> u32 {
        self.room(moves.limits())
    }

    #[inline]
    fn fill_swept<'a>(&mut self, places: impl Iterator<Item = &'a mut u32>) -> Waits {
        self.fill_swept(places)
    }

    fn speed_nm_per_s<M: Clone + Debug, const QUEUE: usize>(&self, _: &LookAhead<M, QUEUE>) -> u32 {
        self.speed_nm_per_s()
    }

    #[inline]
    fn is_at_rest<M: Clone + Debug, const QUEUE: usize>(&self, _: &LookAhead<M, QUEUE>) -> bool {
        self.speed_nm_per_s() == 0
    }

    fn stop(&mut self) {
        self.stop();
    }

    fn hold(&mut self) {
        self.hold();
    }

    fn resume(&mut self) {
        self.resume();
    }

    #[inline]
    fn is_held(&self) -> bool {
        self.is_held()
    }
}

impl<M: Clone + Debug, const QUEUE: usize> MoveQueue<M> for LookAhead<M, QUEUE> {
    fn new(_: Option<&JerkLimits>) -> Self {
        LookAhead::new()
    }

    fn push(&mut self, stretch: Stretch, payload: M) -> bool {
        self.push(stretch, payload).is_ok()
    }

    fn pop(&mut self) -> Option<(Stretch, M)> {
        self.pop()
    }

    fn front(&self) -> Option<(&Stretch, &M)> {
        self.front()
    }

    fn len(&self) -> usize {
        self.len()
    }

    fn is_full(&self) -> bool {
        self.is_full()
    }

    fn clear(&mut self) {
        self.clear();
    }

    fn percent(&self) -> u8 {
        self.percent()
    }

    fn set_override(&mut self, percent: u8) {
        self.set_override(percent);
    }

    fn set_rapid_override(&mut self, percent: u8) {
        self.set_rapid_override(percent);
    }
}

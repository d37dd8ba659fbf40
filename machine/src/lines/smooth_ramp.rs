//! The path with limited jerk.

use core::fmt::Debug;

use husillo_planner::{JerkLimits, JerkRamp, JerkWindow, LookAhead, Ramp, Stretch, Waits};

use crate::lines::path_ramp::{MoveQueue, PathRamp, RampParts};

/// The [`PathRamp`] of a machine that limits the jerk along its path where an axis has one
/// ([`AxisRamp::jerk_hz_per_s2`](crate::AxisRamp)). Without such an axis the machine makes the same
/// events as with [`planner::Ramp`](Ramp).
///
/// The path keeps [`Config::jerk_limits`](crate::Config::jerk_limits), also in a hold, a resume, an
/// override, and when the queue runs empty. These act within a 16th of the window, acceleration /
/// jerk. [`Machine::abort`](crate::Machine::abort) and an alarm stop at once, without a ramp.
/// Start/stop rates have no effect.
#[derive(Clone, Debug)]
pub struct SmoothRamp {
    /// Keeps the hold for both.
    ramp: Ramp,
    jerk: JerkRamp,
}

/// The queue of a [`SmoothRamp`].
#[derive(Clone, Debug)]
pub enum SmoothQueue<M, const QUEUE: usize> {
    /// No axis has a limited jerk.
    Acceleration(LookAhead<M, QUEUE>),
    /// The jerk is limited.
    Jerk(JerkWindow<M, QUEUE>),
}

impl PathRamp for SmoothRamp {}

impl RampParts for SmoothRamp {
    type Queue<M: Clone + Debug, const QUEUE: usize> = SmoothQueue<M, QUEUE>;

    fn new(timer_hz: u32) -> Self {
        SmoothRamp {
            ramp: Ramp::new(timer_hz),
            jerk: JerkRamp::new(timer_hz),
        }
    }

    fn begin<M: Clone + Debug, const QUEUE: usize>(
        &mut self,
        stretch: &Stretch,
        [sweep, largest]: [u64; 2],
        time_q16: u64,
        moves: &SmoothQueue<M, QUEUE>,
    ) {
        match moves {
            SmoothQueue::Acceleration(_) => {
                self.ramp.begin(stretch, sweep, largest as u32, time_q16);
            }
            SmoothQueue::Jerk(window) => self.jerk.begin(stretch, sweep, largest as u32, window),
        }
    }

    #[inline]
    fn wait<M: Clone + Debug, const QUEUE: usize>(
        &mut self,
        sweep: u32,
        moves: &mut SmoothQueue<M, QUEUE>,
    ) -> Option<u64> {
        match moves {
            SmoothQueue::Acceleration(moves) => self.ramp.wait(sweep, moves.limits()),
            SmoothQueue::Jerk(window) => {
                if self.ramp.is_held() {
                    window.hold();
                } else {
                    window.resume();
                }
                self.jerk.wait(sweep, window)
            }
        }
    }

    #[inline]
    fn fill<'a, M: Clone + Debug, const QUEUE: usize>(
        &mut self,
        places: impl ExactSizeIterator<Item = &'a mut u32>,
        moves: &mut SmoothQueue<M, QUEUE>,
    ) -> Waits {
        match moves {
            SmoothQueue::Acceleration(moves) => self.ramp.fill(places, moves.limits()),
            SmoothQueue::Jerk(window) => {
                if self.ramp.is_held() {
                    window.hold();
                } else {
                    window.resume();
                }
                self.jerk.fill(places, window)
            }
        }
    }

    /// The jerk window times arcs one event at a time.
    fn room<M: Clone + Debug, const QUEUE: usize>(&mut self, moves: &SmoothQueue<M, QUEUE>) -> u32 {
        match moves {
            SmoothQueue::Acceleration(moves) => self.ramp.room(moves.limits()),
            SmoothQueue::Jerk(_) => 0,
        }
    }

    fn fill_swept<'a>(&mut self, places: impl Iterator<Item = &'a mut u32>) -> Waits {
        self.ramp.fill_swept(places)
    }

    fn speed_nm_per_s<M: Clone + Debug, const QUEUE: usize>(
        &self,
        moves: &SmoothQueue<M, QUEUE>,
    ) -> u32 {
        match moves {
            SmoothQueue::Acceleration(_) => self.ramp.speed_nm_per_s(),
            SmoothQueue::Jerk(window) => self.jerk.speed_nm_per_s(window),
        }
    }

    fn is_at_rest<M: Clone + Debug, const QUEUE: usize>(
        &self,
        moves: &SmoothQueue<M, QUEUE>,
    ) -> bool {
        match moves {
            SmoothQueue::Acceleration(_) => self.ramp.speed_nm_per_s() == 0,
            SmoothQueue::Jerk(window) => self.jerk.is_at_rest(window),
        }
    }

    fn stop(&mut self) {
        self.ramp.stop();
        self.jerk.stop();
    }

    fn hold(&mut self) {
        self.ramp.hold();
    }

    fn resume(&mut self) {
        self.ramp.resume();
    }

    fn is_held(&self) -> bool {
        self.ramp.is_held()
    }
}

impl<M: Clone + Debug, const QUEUE: usize> MoveQueue<M> for SmoothQueue<M, QUEUE> {
    fn new(limits: Option<&JerkLimits>) -> Self {
        match limits.and_then(|limits| JerkWindow::new(limits).ok()) {
            Some(window) => SmoothQueue::Jerk(window),
            None => SmoothQueue::Acceleration(LookAhead::new()),
        }
    }

    fn push(&mut self, stretch: Stretch, payload: M) -> bool {
        match self {
            SmoothQueue::Acceleration(moves) => moves.push(stretch, payload).is_ok(),
            SmoothQueue::Jerk(window) => window.push(stretch, payload).is_ok(),
        }
    }

    fn finish(&mut self) {
        if let SmoothQueue::Jerk(window) = self {
            window.finish();
        }
    }

    fn pop(&mut self) -> Option<(Stretch, M)> {
        match self {
            SmoothQueue::Acceleration(moves) => moves.pop(),
            SmoothQueue::Jerk(window) => window.pop(),
        }
    }

    fn front(&self) -> Option<(&Stretch, &M)> {
        match self {
            SmoothQueue::Acceleration(moves) => moves.front(),
            SmoothQueue::Jerk(window) => window.front(),
        }
    }

    fn len(&self) -> usize {
        match self {
            SmoothQueue::Acceleration(moves) => moves.len(),
            SmoothQueue::Jerk(window) => window.len(),
        }
    }

    fn is_full(&self) -> bool {
        match self {
            SmoothQueue::Acceleration(moves) => moves.is_full(),
            SmoothQueue::Jerk(window) => window.is_full(),
        }
    }

    fn clear(&mut self) {
        match self {
            SmoothQueue::Acceleration(moves) => moves.clear(),
            SmoothQueue::Jerk(window) => window.clear(),
        }
    }

    fn percent(&self) -> u8 {
        match self {
            SmoothQueue::Acceleration(moves) => moves.percent(),
            SmoothQueue::Jerk(window) => window.percent(),
        }
    }

    fn set_override(&mut self, percent: u8) {
        match self {
            SmoothQueue::Acceleration(moves) => moves.set_override(percent),
            SmoothQueue::Jerk(window) => window.set_override(percent),
        }
    }

    fn set_rapid_override(&mut self, percent: u8) {
        match self {
            SmoothQueue::Acceleration(moves) => moves.set_rapid_override(percent),
            SmoothQueue::Jerk(window) => window.set_rapid_override(percent),
        }
    }
}

//! Inputs that act on the feed of an extended machine: M52 and M53.

use husillo_backlash::BacklashModel;
use husillo_interp::Moves;

use super::Machine;
#[cfg(feature = "extended")]
use crate::Extended;
use crate::lines::extension::Extension;
use crate::lines::path_ramp::{MoveQueue, PathRamp};

impl<
    const N: usize,
    P: Moves<N>,
    L: BacklashModel<N>,
    const QUEUE: usize,
    E: Extension<N>,
    R: PathRamp,
> Machine<N, P, L, QUEUE, E, R>
{
    /// Holds or resumes the path as the operator and the inputs want it. After a contact the
    /// probing move decides.
    pub(super) fn act_on_holds(&mut self) {
        let Some(state) = self.extension.state() else {
            return;
        };
        if state
            .probing
            .is_some_and(|probing| probing.contact.is_some())
        {
            return;
        }
        if state.holds() {
            self.ramp.hold();
        } else {
            self.ramp.resume();
        }
    }

    /// Scales the speeds as the operator, the program and the input want it.
    pub(super) fn act_on_override(&mut self) {
        if let Some(state) = self.extension.state() {
            self.schedule.moves.set_override(state.effective_percent());
        }
    }
}

#[cfg(feature = "extended")]
impl<const N: usize, P: Moves<N>, L: BacklashModel<N>, const QUEUE: usize, R: PathRamp>
    Machine<N, P, L, QUEUE, Extended<N>, R>
{
    /// Sets the input that scales the programmed feeds while M52 P1 holds, in percent, up to 200:
    /// the load of the spindle, for example, or the gap of an electrode. It multiplies with the
    /// override of the operator. At 0 the path brakes and waits. On a new machine it is 100.
    ///
    /// The machine needs [`Equipment::adaptive_feed`](crate::Equipment), otherwise it refuses M52
    /// P1. Moves that follow the spindle keep its pace.
    ///
    /// # Cost
    /// Visits every move of the queue once if the value has changed, so it may be called each
    /// millisecond.
    pub fn set_adaptive_feed(&mut self, percent: u8) {
        self.extension.state.adaptive_percent = percent.min(200);
        self.act_on_override();
        self.act_on_holds();
    }

    /// Sets the input that stops the feed while M53 P1 holds: the path brakes within its
    /// acceleration, and goes on when the input is free again and the operator does not hold it.
    pub fn set_feed_stop(&mut self, is_active: bool) {
        self.extension.state.is_stop_active = is_active;
        self.act_on_holds();
    }
}

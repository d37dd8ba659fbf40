//! The seam of an axis to its law.

use core::fmt::Debug;

use fixed::types::I32F0;

use crate::{AntiWindup, Derivative, Drive, Number, Pid, ServoLaw, ServoState, State};

/// A law that holds an axis at its set point: positions in, drive out, once a servo period.
///
/// The law is its settings; what an axis remembers is its [`State`](Regulator::State).
///
/// # Examples
/// A law that pushes with all its force:
/// ```
/// use husillo_pid::{Drive, Regulator};
///
/// struct BangBang;
///
/// impl Regulator for BangBang {
///     type State = ();
///
///     fn begin(&self) {}
///
///     fn regulate(&self, _: &mut (), set_point: i32, measured: i32, _: u8) -> Drive {
///         Drive {
///             pwm: if set_point == measured { 0 } else { 255 },
///             is_reverse: measured > set_point,
///         }
///     }
/// }
///
/// assert_eq!(BangBang.regulate(&mut (), 3, 5, 0).signed(), -255);
/// ```
pub trait Regulator {
    /// What an axis remembers from one period to the next.
    type State: Copy + Debug + PartialEq;

    /// The state of an axis whose servo is switched on, or off, just now: nothing is remembered.
    fn begin(&self) -> Self::State;

    /// Whether the next period takes a sample: only then the set point has to move on.
    fn is_due(&self, _state: &Self::State) -> bool {
        true
    }

    /// One servo period: the drive for an axis that is to be at `set_point` and is at `measured`,
    /// in counts modulo 2^32, with a reading of its motor's current.
    fn regulate(
        &self,
        state: &mut Self::State,
        set_point: i32,
        measured: i32,
        current: u8,
    ) -> Drive;

    /// One servo period without the law: the drive that was asked for, or less where the law limits
    /// the current.
    fn open_loop(&self, _state: &mut Self::State, drive: Drive, _current: u8) -> Drive {
        drive
    }

    /// Whether the law has given up, as where an error is beyond its limit: the servo has to be
    /// switched off.
    fn has_given_up(&self, _state: &Self::State) -> bool {
        false
    }

    /// Whether the current was beyond its limit in the last period.
    fn is_over_current(&self, _state: &Self::State) -> bool {
        false
    }
}

/// The law of a motion module, as it is.
impl Regulator for ServoLaw {
    type State = ServoState;

    fn begin(&self) -> ServoState {
        ServoState::on()
    }

    #[inline]
    fn is_due(&self, state: &ServoState) -> bool {
        ServoLaw::is_due(self, state)
    }

    #[inline]
    fn regulate(
        &self,
        state: &mut ServoState,
        set_point: i32,
        measured: i32,
        current: u8,
    ) -> Drive {
        self.tick(state, set_point, measured, current)
    }

    #[inline]
    fn open_loop(&self, state: &mut ServoState, drive: Drive, current: u8) -> Drive {
        ServoLaw::open_loop(self, state, drive, current)
    }

    fn has_given_up(&self, state: &ServoState) -> bool {
        !state.is_on()
    }

    fn is_over_current(&self, state: &ServoState) -> bool {
        state.is_over_current()
    }
}

/// A PID controller of whole counts, whose output is the PWM with its sign; beyond 255 it is cut.
///
/// It knows no limit of the error or the current. Between two positions more than 2^31 counts
/// apart, the error is the short way round.
impl<G, A, D> Regulator for Pid<I32F0, G, A, D>
where
    G: Number<Word = i32>,
    A: AntiWindup<i32>,
    D: Derivative,
{
    type State = State<I32F0>;

    fn begin(&self) -> State<I32F0> {
        State::default()
    }

    #[inline]
    fn regulate(&self, state: &mut State<I32F0>, set_point: i32, measured: i32, _: u8) -> Drive {
        let error = set_point.wrapping_sub(measured);
        let set_point = measured.saturating_add(error);
        let output = self.update(
            state,
            I32F0::from_bits(set_point),
            I32F0::from_bits(measured),
        );
        let output = output.to_bits();
        Drive {
            pwm: output.unsigned_abs().min(255) as u8,
            is_reverse: output < 0,
        }
    }
}

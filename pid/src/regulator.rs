//! The interface between an axis and its control law.

use core::fmt::Debug;

use fixed::types::I32F0;

use crate::{AntiWindup, Derivative, Drive, Number, Pid, ServoLaw, ServoState, State};

/// A control law that holds an axis at its set point: positions in, drive out, once per servo
/// period.
///
/// The implementing type holds the settings; [`State`](Regulator::State) is the state of one axis.
///
/// # Examples
/// A law that always drives with full force:
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
    /// The state of one axis between two periods.
    type State: Copy + Debug + PartialEq;

    /// Returns the initial state, for an axis whose servo is just switched on or off.
    fn begin(&self) -> Self::State;

    /// Whether the next period takes a sample. The set point advances only in such a period.
    fn is_due(&self, _state: &Self::State) -> bool {
        true
    }

    /// Computes one servo period: the drive for an axis with its set point and measured position,
    /// in counts modulo 2^32. `current` is a reading of the motor current.
    fn regulate(
        &self,
        state: &mut Self::State,
        set_point: i32,
        measured: i32,
        current: u8,
    ) -> Drive;

    /// Computes one servo period without the loop: the requested drive, or less if the law limits
    /// the current.
    fn open_loop(&self, _state: &mut Self::State, drive: Drive, _current: u8) -> Drive {
        drive
    }

    /// Whether the law has stopped, for example because the error exceeds its limit. The servo must
    /// then be switched off.
    fn has_given_up(&self, _state: &Self::State) -> bool {
        false
    }

    /// Whether the current exceeded its limit in the last period.
    fn is_over_current(&self, _state: &Self::State) -> bool {
        false
    }
}

/// The unchanged law of a motion module.
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

/// The numbers of 32 bits without a fraction: `i32` and `I32F0`.
pub trait Counts: Number<Word = i32> {}

impl Counts for i32 {}
impl Counts for I32F0 {}

/// A PID controller in whole counts. Its output is the PWM with its sign, limited to 255.
///
/// It limits neither the error nor the current. For positions more than 2^31 counts apart, the
/// error is the shorter distance modulo 2^32.
impl<S, G, A, D> Regulator for Pid<S, G, A, D>
where
    S: Counts,
    G: Number<Word = i32>,
    A: AntiWindup<i32>,
    D: Derivative,
{
    type State = State<S>;

    fn begin(&self) -> State<S> {
        State::default()
    }

    #[inline]
    fn regulate(&self, state: &mut State<S>, set_point: i32, measured: i32, _: u8) -> Drive {
        let error = set_point.wrapping_sub(measured);
        let set_point = measured.saturating_add(error);
        let output = self.update(state, S::from_word(set_point), S::from_word(measured));
        let output = output.to_word();
        Drive {
            pwm: output.unsigned_abs().min(255) as u8,
            is_reverse: output < 0,
        }
    }
}

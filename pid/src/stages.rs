//! Optional parts around the controller. A part that is not used costs nothing.

use crate::number::{Number, Word};
use crate::pid::Term;

/// Returns the error, `target - measured`, saturating.
///
/// [`Pid::update`](crate::Pid::update) computes the error internally. This function is for errors
/// that go through a [`DeadBand`] first.
#[inline]
pub fn error<S: Number>(target: S, measured: S) -> S {
    S::from_word(target.to_word().minus(measured.to_word()))
}

/// A dead band for errors. An error within the width becomes 0. A larger error is reduced by the
/// width, so there is no jump at the edge.
///
/// # Examples
/// ```
/// use fixed::types::I32F0;
/// use husillo_pid::DeadBand;
///
/// let band = DeadBand::new(I32F0::from_num(2));
/// assert_eq!(
///     [-5, -2, 1, 3].map(|error| band.apply(I32F0::from_num(error)).to_num::<i32>()),
///     [-3, 0, 0, 1],
/// );
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct DeadBand<S: Number> {
    width: S::Word,
}

impl<S: Number> DeadBand<S> {
    /// Creates a band of `width` on either side of 0. The sign of `width` is ignored.
    pub fn new(width: S) -> Self {
        let (none, width) = (S::Word::default(), width.to_word());
        let width = if width < none {
            none.minus(width)
        } else {
            width
        };
        Self { width }
    }

    /// Returns the rest of `error` outside the band.
    #[inline]
    pub fn apply(&self, error: S) -> S {
        let (none, error) = (S::Word::default(), error.to_word());
        let left = if error > self.width {
            error.minus(self.width)
        } else if error < none.minus(self.width) {
            error.minus(none.minus(self.width))
        } else {
            none
        };
        S::from_word(left)
    }
}

/// Feed-forward of velocity and acceleration, added to the output without waiting for an error.
///
/// Gains are per sample: output per last digit of the velocity (counts per sample) and of the
/// acceleration (counts per sample^2).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct FeedForward<G: Number> {
    velocity: G::Word,
    acceleration: G::Word,
}

impl<G: Number> FeedForward<G> {
    /// Creates a feed-forward with these gains. Returns `None` if their magnitudes add up to more
    /// than 2^29 last digits.
    pub fn new(velocity: G, acceleration: G) -> Option<Self> {
        let [velocity, acceleration] =
            G::Word::gains([velocity.to_word(), acceleration.to_word()])?;
        Some(Self {
            velocity,
            acceleration,
        })
    }

    /// Returns the term for a velocity and an acceleration.
    #[inline]
    pub fn term<S: Number<Word = G::Word>>(&self, velocity: S, acceleration: S) -> Term<S, G> {
        // The sum is within 2^61 because the gains together are within 2^30.
        Term::new(G::Word::plus(
            self.velocity.times(velocity.to_word()),
            self.acceleration.times(acceleration.to_word()),
        ))
    }
}

/// A first-order low-pass for the derivative, `y[k] = y[k-1] + a (x[k] - y[k-1])`. This is Td s /
/// (1 + Tf s) with the backward difference and `a = T / (Tf + T)`.
///
/// Its state has all digits of the products, so for a constant input it settles within `1/a` of
/// their last digits of the input.
///
/// # Source
/// Astrom and Hagglund, *PID Controllers*, 2nd ed., 3.3.
///
/// # Examples
/// ```
/// use fixed::types::I16F16;
/// use husillo_pid::{error, Filter, FilterState, Gains, Integration, Limits, Pid, State};
///
/// let gains = Gains { derivative: I16F16::from_num(8), ..Gains::default() };
/// let limits = Limits { low: I16F16::MIN, high: I16F16::MAX };
/// let pid = Pid::new(gains, Integration::Backward, limits)?;
/// let (mut x, filter, mut y) = (
///     State::default(),
///     Filter::of_time_constant(1),
///     FilterState::default(),
/// );
/// let outputs = [0, 1, 1, 1].map(|target| {
///     let error = error(I16F16::from_num(target), I16F16::ZERO);
///     let slope = pid.derivative(x.difference(error));
///     pid.update_with(&mut x, error, filter.apply(&mut y, slope)).to_num::<f32>()
/// });
/// assert_eq!(outputs, [0.0, 4.0, 2.0, 1.0]); // 8 at once, without the filter
/// # Ok::<(), husillo_pid::SettingsError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Filter {
    weight: u16,
}

/// The state of a [`Filter`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct FilterState<S: Number, G: Number<Word = S::Word> = S> {
    output: Term<S, G>,
}

impl Filter {
    /// Creates a filter with `a = weight / 65536`.
    pub const fn new(weight: u16) -> Self {
        Self { weight }
    }

    /// Creates a filter with a time constant of `samples` sample periods, Tf / T.
    pub const fn of_time_constant(samples: u16) -> Self {
        // A divisor of 2 or more gives a quotient below 2^16. For a divisor of 1, `a` = 65535/65536
        // is practically no filter.
        let divisor = samples as u32 + 1;
        let weight = if divisor < 2 {
            0xffff
        } else {
            0x1_0000 / divisor
        };
        Self {
            weight: weight as u16,
        }
    }

    /// Returns the filtered term.
    #[inline]
    pub fn apply<S: Number, G: Number<Word = S::Word>>(
        &self,
        state: &mut FilterState<S, G>,
        term: Term<S, G>,
    ) -> Term<S, G> {
        // Both terms are within 2^61, and the result lies between them.
        let change = S::Word::less(term.wide, state.output.wide);
        let wide = S::Word::plus(state.output.wide, S::Word::weighted(change, self.weight));
        state.output = Term::new(wide);
        state.output
    }
}

//! A filter of second order: notch, lead-lag, low-pass.

mod design;
mod tangent;

use crate::number::{Number, Word};
use crate::settings::{Limits, SettingsError};

pub use design::{Coefficients, FilterError, SecondOrder};

type Wide<S> = <<S as Number>::Word as Word>::Wide;
type Span<S> = <<S as Number>::Word as Word>::Span;

/// A filter of second order with limits: beside a controller, on its measurement, its error or its
/// output.
///
/// ```text
/// y[k] = b0 x[k] + b1 x[k-1] + b2 x[k-2] - a1 y[k-1] - a2 y[k-2], limited
/// ```
///
/// Any number of channels share the settings; each has its own [`BiquadState`]. Coefficients come
/// from [`SecondOrder::bilinear`], which can run at compile time, so that the chip computes no
/// float.
///
/// - **Rounding.** The output that is fed back keeps all digits of the coefficients. The returned
///   output is rounded once. So a small signal does not get stuck, and a constant input gives the
///   exact output in the end, for any type.
/// - **Limits.** The limited output is fed back. So the filter does not wind up: it leaves its
///   limit as if it had just reached it.
///
/// # Source
/// Oppenheim and Schafer, *Discrete-Time Signal Processing*, 3rd ed., 6.3.4: transposed direct form
/// II.
///
/// # Examples
/// ```
/// use husillo_pid::{Biquad, BiquadState, Coefficients, Limits, SecondOrder};
///
/// // A resonance of the machine at 120 Hz is cut out, 30 Hz wide. 2000 samples a second.
/// const FILTER: SecondOrder = SecondOrder::notch(120.0, 30.0);
/// const NOTCH: Coefficients = match FILTER.bilinear(2000.0, Some(120.0)) {
///     Ok(coefficients) => coefficients,
///     Err(_) => panic!("the notch cannot be made"), // at compile time
/// };
/// let notch = Biquad::new(&NOTCH, Limits { low: -30_000, high: 30_000 })?;
/// let mut axis = BiquadState::default();
/// let (mut steady, mut shaken) = (0, 0);
/// for sample in 0..2000 {
///     let shake = (f64::from(sample) * core::f64::consts::TAU * 0.06).sin() * 100.0;
///     steady = notch.update(&mut axis, 1000 + shake as i32);
///     shaken = shake as i32;
/// }
/// assert!((999..=1001).contains(&steady) && shaken != 0);
/// # Ok::<(), husillo_pid::SettingsError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Biquad<S: Number> {
    numerator: [S::Word; 3],
    denominator: [S::Word; 2],
    bits: u32,
    limits: Span<S>,
}

/// The state of one channel of a [`Biquad`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct BiquadState<S: Number> {
    next: Wide<S>,
    after: Wide<S>,
}

impl<S: Number> Default for BiquadState<S> {
    /// The state after inputs and outputs of 0.
    fn default() -> Self {
        BiquadState {
            next: Wide::<S>::default(),
            after: Wide::<S>::default(),
        }
    }
}

impl<S: Number> Biquad<S> {
    /// Creates a filter whose output is limited.
    ///
    /// # Errors
    /// [`SettingsError::LimitsCrossed`] if `low` is above `high` or one is not a number.
    pub fn new(coefficients: &Coefficients, limits: Limits<S>) -> Result<Self, SettingsError> {
        let bits = coefficients.bits();
        let word = |digits| S::Word::coefficient(digits, bits);
        let limits = S::Word::span(limits.low.to_word(), limits.high.to_word(), bits)
            .ok_or(SettingsError::LimitsCrossed)?;
        Ok(Biquad {
            numerator: coefficients.numerator().map(word),
            denominator: coefficients.denominator().map(word),
            bits,
            limits,
        })
    }

    /// Computes one sample.
    ///
    /// # Cost
    /// Seven products of two registers for integers, five for `f32`.
    #[inline]
    pub fn update(&self, state: &mut BiquadState<S>, input: S) -> S {
        // An `f32` that is not finite counts as 0, as in the controller.
        let input = input.to_word().minus(S::Word::default());
        let [b0, b1, b2] = self.numerator;
        // The magnitudes of the coefficients add up to 2^31 digits, so every sum is within 2^62.
        let wanted = S::Word::plus(b0.times(input), state.next);
        let given = S::Word::within(wanted, &self.limits);
        let [fed_1, fed_2] = self.fed_back(given);
        state.next = S::Word::less(S::Word::plus(b1.times(input), state.after), fed_1);
        state.after = S::Word::less(b2.times(input), fed_2);
        // The limits have type S, so every number between them fits S.
        S::from_word(S::Word::rounded_within(given, self.bits))
    }

    /// Sets the state to that of a constant input and output: at the start, on a change of
    /// coefficients, and in manual mode.
    pub fn follow(&self, state: &mut BiquadState<S>, input: S, output: S) {
        let input = input.to_word().minus(S::Word::default());
        let output = S::Word::within(output.to_word().widened(self.bits), &self.limits);
        let [_, b1, b2] = self.numerator;
        let [fed_1, fed_2] = self.fed_back(output);
        state.after = S::Word::less(b2.times(input), fed_2);
        state.next = S::Word::less(S::Word::plus(b1.times(input), state.after), fed_1);
    }

    #[inline(always)]
    fn fed_back(&self, output: Wide<S>) -> [Wide<S>; 2] {
        self.denominator
            .map(|coefficient| coefficient.times_wide(output, self.bits))
    }
}

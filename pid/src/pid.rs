//! The controller.

use core::marker::PhantomData;

use crate::derivative::{Derivative, OfError};
use crate::number::{Number, Word};
use crate::settings::{Gains, Integration, Limits, SettingsError};
use crate::windup::{AntiWindup, Clamp, Sum};

type Wide<S> = <<S as Number>::Word as Word>::Wide;
type Span<S> = <<S as Number>::Word as Word>::Span;

/// A PID controller in the parallel form: its settings, which any number of channels share. What a
/// channel remembers is its [`State`].
///
/// Target, measurement and output are of type `S`, gains of type `G` (see [`Number`]); `A` is the
/// remedy against windup.
///
/// ```text
/// e = target - measured
/// u[k] = Kp e[k]  +  Ki T (e[0] + ... + e[k-1] + w e[k])  +  Kd/T (e[k] - e[k-1])
/// w = 0 forward, 1/2 bilinear, 1 backward
/// ```
///
/// The sum is exact: it is kept as the whole number `Ki T * sum(e)`, in units of the last digits of
/// gain and signal together, to which each sample adds the whole number `Ki T * e`. Nothing is lost
/// however long it runs, equal and opposite errors cancel to nothing, and a change of the integral
/// gain does not touch what has been summed. The output is rounded once, at the end, to the nearest
/// (ties upwards): its error is at most half of its last digit, plus what the gains lost when they
/// were rounded to their type, `(|e| + |sum e| + |de|) / 2` last digits of the gain.
///
/// Bounds that make the arithmetic safe: with all gains together at most 2^29 last digits (so
/// `I16F16` gains may add up to 8192), doubled, the products are at most 2^61; the integral is
/// within limits of at most 2^61; a [`Term`] is at most 2^61.
///
/// ```
/// use fixed::types::{I16F16, I24F8};
/// use husillo_pid::{Gains, Integration, Limits, Pid, State};
///
/// let gains = Gains {
///     proportional: I16F16::lit("2"),
///     integral: I16F16::lit("0.1"),
///     derivative: I16F16::lit("5"),
/// };
/// let limits = Limits { low: I24F8::from_num(-255), high: I24F8::from_num(255) };
/// let pid = Pid::new(gains, Integration::Bilinear, limits)?;
/// let mut x = State::default();
/// let target = I24F8::from_num(10);
/// assert_eq!(pid.update(&mut x, target, I24F8::ZERO), 70.5); // 2 * 10 + 0.1 / 2 * 10 + 5 * 10
/// assert_eq!(pid.update(&mut x, target, I24F8::ZERO), 21.5); // 2 * 10 + 0.1 * 15
/// # Ok::<(), husillo_pid::SettingsError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Pid<S: Number, G: Number<Word = S::Word> = S, A = Clamp, D = OfError> {
    /// What the error is multiplied by in the same sample: Kp + w Ki T, doubled, as are the others.
    at_once: S::Word,
    integral: S::Word,
    derivative: S::Word,
    limits: Span<S>,
    sum_limits: Span<S>,
    anti_windup: A,
    kind: PhantomData<(G, D)>,
}

/// What one channel remembers from sample to sample.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct State<S: Number> {
    /// `2 Ki T * sum(e)`.
    sum: Wide<S>,
    /// The signal of the derivative, a sample ago.
    previous: S::Word,
}

/// Something added to the output before its limits and its only rounding: a derivative, a
/// feed-forward. At most 2^61 of its last digits.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Term<S: Number, G: Number<Word = S::Word> = S> {
    pub(crate) wide: Wide<S>,
    gain: PhantomData<G>,
}

impl<S: Number, G: Number<Word = S::Word>> Term<S, G> {
    pub(crate) fn new(wide: Wide<S>) -> Self {
        Self {
            wide,
            gain: PhantomData,
        }
    }

    /// A constant share of the output, such as the weight of an axis.
    pub fn constant(share: S) -> Self {
        Self::new(share.to_word().widened(bits::<G>()))
    }

    /// Both together, saturating.
    pub fn plus(self, other: Self) -> Self {
        Self::new(S::Word::term(self.wide, other.wide))
    }
}

impl<S: Number, G: Number<Word = S::Word>> Pid<S, G> {
    /// A controller whose integral has the limits of the output, and whose derivative is of the
    /// error.
    ///
    /// # Errors
    /// Gains or limits that a [`SettingsError`] names.
    pub fn new(
        gains: Gains<G>,
        integration: Integration,
        limits: Limits<S>,
    ) -> Result<Self, SettingsError> {
        // So a limit is at most 2^31 * 2^30.
        if G::FRACTION_BITS > 29 {
            return Err(SettingsError::FractionTooFine);
        }
        let gains = [gains.proportional, gains.integral, gains.derivative].map(G::to_word);
        let [proportional, integral, derivative] =
            S::Word::gains(gains).ok_or(SettingsError::GainsTooLarge)?;
        let at_once = proportional.and(match integration {
            Integration::Forward => S::Word::default(),
            Integration::Backward => integral,
            Integration::Bilinear => integral.half(),
        });
        let limits = span::<S, G>(limits)?;
        Ok(Self {
            at_once,
            integral,
            derivative,
            limits,
            sum_limits: limits,
            anti_windup: Clamp,
            kind: PhantomData,
        })
    }
}

fn span<S: Number, G: Number<Word = S::Word>>(limits: Limits<S>) -> Result<Span<S>, SettingsError> {
    let (low, high) = (limits.low.to_word(), limits.high.to_word());
    S::Word::span(low, high, bits::<G>()).ok_or(SettingsError::LimitsCrossed)
}

/// Bits behind the point of a sum of products, with one for the doubling.
const fn bits<G: Number>() -> u32 {
    G::FRACTION_BITS.wrapping_add(1)
}

impl<S, G, A, D> Pid<S, G, A, D>
where
    S: Number,
    G: Number<Word = S::Word>,
    A: AntiWindup<S::Word>,
    D: Derivative,
{
    /// The same with another remedy against windup.
    pub fn with_anti_windup<B: AntiWindup<S::Word>>(self, anti_windup: B) -> Pid<S, G, B, D> {
        Pid {
            at_once: self.at_once,
            integral: self.integral,
            derivative: self.derivative,
            limits: self.limits,
            sum_limits: self.sum_limits,
            anti_windup,
            kind: PhantomData,
        }
    }

    /// The same with the derivative taken of something else: `OfError`, `OfMeasurement`.
    pub fn with_derivative<E: Derivative>(self, _of: E) -> Pid<S, G, A, E> {
        Pid {
            at_once: self.at_once,
            integral: self.integral,
            derivative: self.derivative,
            limits: self.limits,
            sum_limits: self.sum_limits,
            anti_windup: self.anti_windup,
            kind: PhantomData,
        }
    }

    /// The same with limits of the integral's share in the output that are not those of the output:
    /// narrower ones against overshoot, wider ones where the integral has to work against a
    /// feed-forward. With wider ones the output may stay at its limit for some samples after a
    /// change of sign.
    ///
    /// # Errors
    /// [`SettingsError::LimitsCrossed`].
    pub fn with_integral_limits(self, limits: Limits<S>) -> Result<Self, SettingsError> {
        let sum_limits = span::<S, G>(limits)?;
        Ok(Self { sum_limits, ..self })
    }

    /// One sample: the output for `target` and `measured`, within the limits. An error beyond 32
    /// bits saturates.
    #[inline]
    pub fn update(&self, state: &mut State<S>, target: S, measured: S) -> S {
        let (target, measured) = (target.to_word(), measured.to_word());
        let error = target.minus(measured);
        let derivative = self
            .derivative
            .times(state.slope(D::source(error, measured)));
        self.law(state, error, derivative)
    }

    /// One sample of P and I of an error, with the other terms as the caller has made them: see
    /// [`derivative`](Self::derivative), [`Filter`](crate::Filter),
    /// [`FeedForward`](crate::FeedForward).
    #[inline]
    pub fn update_with(&self, state: &mut State<S>, error: S, added: Term<S, G>) -> S {
        self.law(state, error.to_word(), added.wide)
    }

    /// The derivative term of a difference of two samples ([`State::difference`]).
    #[inline]
    pub fn derivative(&self, difference: S) -> Term<S, G> {
        Term::new(self.derivative.times(difference.to_word()))
    }

    #[inline(always)]
    fn law(&self, state: &mut State<S>, error: S::Word, added: Wide<S>) -> S {
        let before = state.sum;
        // Each of the three is at most 2^61, see the type.
        let wanted = S::Word::plus(S::Word::plus(before, self.at_once.times(error)), added);
        let given = S::Word::within(wanted, &self.limits);
        let sum = Sum {
            before,
            step: self.integral.times(error),
            limits: self.sum_limits,
            wanted,
            given,
        };
        state.sum = self.anti_windup.next(&sum, bits::<G>());
        // The limits are of type S, so what lies between them is as well.
        S::from_word(S::Word::rounded_within(given, bits::<G>()))
    }

    /// Makes the next [`update`](Self::update) with the same target and measurement give `output`,
    /// to its last digit: for a start, for the change to other gains (called on the new controller
    /// with the last output), and, called every sample in manual mode with the output set by hand,
    /// for the change to automatic.
    ///
    /// The integral is what is adapted, within its limits: where the proportional part alone is
    /// farther from `output` than they allow, a bump remains.
    pub fn follow(&self, state: &mut State<S>, target: S, measured: S, output: S) {
        let (target, measured) = (target.to_word(), measured.to_word());
        let error = target.minus(measured);
        state.previous = D::source(error, measured);
        let sum = S::Word::less(
            output.to_word().widened(bits::<G>()),
            self.at_once.times(error),
        );
        state.sum = S::Word::within(sum, &self.sum_limits);
    }

    /// The integral's share in the output, rounded.
    pub fn integral(&self, state: &State<S>) -> S {
        S::from_word(S::Word::rounded_within(state.sum, bits::<G>()))
    }
}

impl<S: Number> State<S> {
    /// `source` less its value a sample ago (saturating), for a derivative of one's own; remembers
    /// it.
    #[inline]
    pub fn difference(&mut self, source: S) -> S {
        S::from_word(self.slope(source.to_word()))
    }

    #[inline(always)]
    fn slope(&mut self, source: S::Word) -> S::Word {
        let previous = core::mem::replace(&mut self.previous, source);
        source.minus(previous)
    }
}

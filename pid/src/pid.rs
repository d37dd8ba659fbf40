//! The PID controller.

use core::marker::PhantomData;

use crate::derivative::{Derivative, OfError};
use crate::number::{Number, Word};
use crate::settings::{Gains, Integration, Limits, SettingsError};
use crate::windup::{AntiWindup, Clamp, Sum};

type Wide<S> = <<S as Number>::Word as Word>::Wide;
type Span<S> = <<S as Number>::Word as Word>::Span;

/// The settings of a PID controller in the parallel form. Any number of channels share them; each
/// channel has its own [`State`].
///
/// Target, measurement and output have type `S`, gains have type `G` (see [`Number`]). `A` is the
/// anti-windup method.
///
/// ```text
/// e = target - measured
/// u[k] = Kp e[k] + Ki T (e[0] + ... + e[k-1] + w e[k]) + Kd/T (e[k] - e[k-1])
/// w = 0 forward, 1/2 bilinear, 1 backward
/// ```
///
/// The sum is exact. It is stored as the integer `Ki T * sum(e)`, in units of the last digit of the
/// gain times the last digit of the signal. Each sample adds the integer `Ki T * e`. No error
/// accumulates over time, and errors of opposite sign cancel exactly. A change of the integral gain
/// does not affect the sum so far.
///
/// The output is rounded once, at the end, to the nearest digit (ties upwards). Its error is at
/// most half of its last digit, plus the rounding of the gains to their type:
/// `(|e| + |sum e| + |de|) / 2` last digits of the gain.
///
/// These bounds make the arithmetic safe. All gains together are at most 2^29 last digits (`I16F16`
/// gains may add up to 8192). They are stored doubled, so the products are at most 2^61. The limits
/// of the integral and each [`Term`] are at most 2^61. With 64 bits, gains are at most 2^61 last
/// digits, and everything else 2^125.
///
/// # Examples
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
    /// Gain of the error in the same sample: Kp + w Ki T, doubled as the other gains are.
    at_once: S::Word,
    integral: S::Word,
    derivative: S::Word,
    limits: Span<S>,
    sum_limits: Span<S>,
    anti_windup: A,
    kind: PhantomData<(G, D)>,
}

/// The state of one channel from sample to sample.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct State<S: Number> {
    /// `2 Ki T * sum(e)`.
    sum: Wide<S>,
    /// The signal of the derivative in the previous sample.
    previous: S::Word,
}

/// A term that is added to the output before its limits and its only rounding: a derivative or a
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

    /// Creates a constant share of the output, for example against the weight of an axis.
    pub fn constant(share: S) -> Self {
        Self::new(share.to_word().widened(bits::<G>()))
    }

    /// Returns the sum of both terms, saturating.
    pub fn plus(self, other: Self) -> Self {
        Self::new(S::Word::term(self.wide, other.wide))
    }
}

impl<S: Number, G: Number<Word = S::Word>> Pid<S, G> {
    /// Creates a controller. Its integral has the limits of the output, and its derivative is that
    /// of the error.
    ///
    /// # Errors
    /// Fails if gains or limits are out of range; [`SettingsError`] lists the cases.
    pub fn new(
        gains: Gains<G>,
        integration: Integration,
        limits: Limits<S>,
    ) -> Result<Self, SettingsError> {
        // A limit is therefore at most 2^31 * 2^30, or 2^63 * 2^62.
        if G::FRACTION_BITS > S::Word::MOST_FRACTION_BITS {
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

/// Fractional bits of a sum of products, with one bit for the doubling.
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
    /// Replaces the anti-windup method.
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

    /// Replaces the signal of the derivative: `OfError` or `OfMeasurement`.
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

    /// Sets limits for the integral's share in the output. Without this call they are the limits of
    /// the output. Narrower limits reduce overshoot. Wider limits let the integral work against a
    /// feed-forward; the output may then stay at its limit for some samples after the error changes
    /// sign.
    ///
    /// # Errors
    /// Fails with [`SettingsError::LimitsCrossed`] if `low` is above `high` or one is not a number.
    pub fn with_integral_limits(self, limits: Limits<S>) -> Result<Self, SettingsError> {
        let sum_limits = span::<S, G>(limits)?;
        Ok(Self { sum_limits, ..self })
    }

    /// Computes one sample: the output for `target` and `measured`, within the limits. An error
    /// beyond 32 bits saturates.
    #[inline]
    pub fn update(&self, state: &mut State<S>, target: S, measured: S) -> S {
        let (target, measured) = (target.to_word(), measured.to_word());
        let error = target.minus(measured);
        let derivative = self
            .derivative
            .times(state.slope(D::source(error, measured)));
        self.law(state, error, derivative)
    }

    /// Computes one sample of P and I of `error` and adds the caller's other terms: see
    /// [`derivative`](Self::derivative), [`Filter`](crate::Filter) and
    /// [`FeedForward`](crate::FeedForward).
    #[inline]
    pub fn update_with(&self, state: &mut State<S>, error: S, added: Term<S, G>) -> S {
        self.law(state, error.to_word(), added.wide)
    }

    /// Returns the derivative term for a difference of two samples ([`State::difference`]).
    #[inline]
    pub fn derivative(&self, difference: S) -> Term<S, G> {
        Term::new(self.derivative.times(difference.to_word()))
    }

    #[inline(always)]
    fn law(&self, state: &mut State<S>, error: S::Word, added: Wide<S>) -> S {
        let before = state.sum;
        // Each of the three terms is at most 2^61, see the type.
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
        // The limits have type S, so every number between them fits S.
        S::from_word(S::Word::rounded_within(given, bits::<G>()))
    }

    /// Sets the state so that the next [`update`](Self::update) with the same target and
    /// measurement returns `output`, exact to the last digit. Call it:
    ///
    /// - at the start;
    /// - on a change of gains, on the new controller with the last output;
    /// - in manual mode, in every sample with the manual output, to prepare the change to
    ///   automatic.
    ///
    /// The function adapts the integral within its limits. If the proportional part alone differs
    /// from `output` by more than these limits, a bump remains.
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

    /// Returns the integral's share in the output, rounded.
    pub fn integral(&self, state: &State<S>) -> S {
        S::from_word(S::Word::rounded_within(state.sum, bits::<G>()))
    }
}

impl<S: Number> State<S> {
    /// Returns `source` minus its value in the previous sample (saturating) and stores `source`.
    /// For a derivative that the caller computes.
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

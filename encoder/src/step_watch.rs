//! Comparison of motor steps with the counts of an encoder.

/// Largest number of counts or steps in the ratio of an [`AxisEncoder`].
const MOST: u32 = 1 << 20;

/// Reaction to lost steps. Each loss is reported in every case.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum OnLoss {
    /// None: the program continues off its path.
    Report,
    /// The path brakes, and all motion waits for the operator.
    Stop,
    /// The path brakes, the lost steps are re-emitted, and the path continues.
    Correct,
}

/// An encoder on the motor of a stepping axis.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct AxisEncoder {
    /// Counts per `steps` motor steps, 1 to 2^20; other values are taken as the nearest of these.
    pub counts: u32,
    /// Motor steps per `counts`, 1 to 2^20; other values are taken as the nearest of these.
    pub steps: u32,
    /// Tolerance in steps, 1 to 2^20: a moving motor that is farther off has lost steps. It has to
    /// cover the lag of the rotor, the resolution of the counts, and events that wait in a queue.
    pub tolerance_steps: u32,
    /// Reaction to a loss.
    pub on_loss: OnLoss,
    /// Rate of re-emitted steps in steps/s, at least 1. The motor has to start and stop at it
    /// without a ramp.
    pub correction_rate_hz: u32,
    /// Time for the motor to come to rest, in timer ticks; at most 2^31.
    pub settle_ticks: u32,
    /// Number of corrections before the axis counts as stalled.
    pub attempts: u8,
}

/// A stepping axis as its encoder sees it: how far the motor is behind its steps.
///
/// Distances are in parts. A part is 1/`counts` of a step, so steps and encoder counts are both
/// whole numbers of parts.
///
/// # Examples
///
/// ```
/// use husillo_encoder::{AxisEncoder, OnLoss, StepWatch};
///
/// let mut watch = StepWatch::new(AxisEncoder {
///     counts: 10, // per step
///     steps: 1,
///     tolerance_steps: 2,
///     on_loss: OnLoss::Correct,
///     correction_rate_hz: 200,
///     settle_ticks: 50_000,
///     attempts: 3,
/// });
/// assert_eq!(watch.behind(0), 0); // the first counts are the origin
/// (0..8).for_each(|_| watch.step(1));
/// let behind = watch.behind(40); // the motor has made 4 steps
/// assert!(!watch.is_tolerable(behind));
/// assert_eq!(watch.steps(behind), 4);
/// ```
#[derive(Copy, Clone, Debug)]
pub struct StepWatch {
    /// The encoder, with its numbers in their ranges.
    pub encoder: AxisEncoder,
    /// Motor steps emitted for the path and its take-up.
    given: i64,
    /// Offset in parts: counts at the first check minus `given` at that time, plus the losses that
    /// were reported and accepted since.
    origin: Option<i64>,
    /// Direction of the last step: -1, 1, or 0 before the first one.
    pub heading: i8,
    /// Reported as lost, and not yet as corrected.
    pub is_lost: bool,
    /// Number of corrections since the axis was last at its expected position.
    pub attempts: u8,
}

impl StepWatch {
    /// Creates the watch of an axis before its first step. The first counts are its origin.
    pub fn new(encoder: AxisEncoder) -> Self {
        Self {
            encoder: AxisEncoder {
                counts: encoder.counts.clamp(1, MOST),
                steps: encoder.steps.clamp(1, MOST),
                tolerance_steps: encoder.tolerance_steps.clamp(1, MOST),
                ..encoder
            },
            given: 0,
            origin: None,
            heading: 0,
            is_lost: false,
            attempts: 0,
        }
    }

    /// Records a step of the path or of its take-up.
    #[inline]
    pub fn step(&mut self, delta: i8) {
        // 2^42 steps take half a year at 300 kHz; the products below wrap far beyond that.
        self.given = self.given.wrapping_add(delta.into());
        self.heading = if delta == 0 { self.heading } else { delta };
    }

    /// Returns the distance by which the motor is behind at these counts, in parts.
    pub fn behind(&mut self, counts: i64) -> i64 {
        // Each is below 2^(42 + 20).
        let should = self.given.wrapping_mul(self.encoder.counts.into());
        let is = counts.wrapping_mul(self.encoder.steps.into());
        let behind = should.wrapping_sub(is);
        let origin = *self.origin.get_or_insert(behind);
        behind.wrapping_sub(origin)
    }

    /// Whether a moving motor may be this far behind.
    pub const fn is_tolerable(&self, behind: i64) -> bool {
        let most = (self.encoder.tolerance_steps as u64).wrapping_mul(self.encoder.counts as u64);
        // A motor that is right at rest has no loss, however small the tolerance is. Otherwise it
        // would be reported again and again.
        behind.unsigned_abs() <= most || self.is_there(behind)
    }

    /// Whether a motor at rest is at its expected position: within half a step, or within a count.
    pub const fn is_there(&self, behind: i64) -> bool {
        let half = self.encoder.counts.div_ceil(2);
        let least = if half > self.encoder.steps {
            half
        } else {
            self.encoder.steps
        };
        behind.unsigned_abs() < least as u64
    }

    /// Converts parts to steps, rounded to nearest and at least one, for a motor that is off.
    pub fn steps(&self, behind: i64) -> i32 {
        let counts = i64::from(self.encoder.counts);
        let half = counts / 2;
        let rounded = behind.saturating_add(if behind < 0 {
            half.wrapping_neg()
        } else {
            half
        });
        let steps = rounded.checked_div(counts).unwrap_or(0);
        let steps = if steps == 0 { behind.signum() } else { steps };
        // Beyond 2^31 the position is unknown.
        i32::try_from(steps).unwrap_or(if steps < 0 { i32::MIN } else { i32::MAX })
    }

    /// Returns the two moves in steps that correct a distance in parts. The axis last moved in the
    /// direction of `heading` and has this backlash in steps. A correction against the heading also
    /// crosses the backlash and returns.
    pub fn legs(&self, behind: i64, heading: i8, backlash_steps: u32) -> [i32; 2] {
        let steps = self.steps(behind);
        if steps.signum() == i32::from(heading) || heading == 0 {
            return [steps, 0];
        }
        let backlash = i32::try_from(backlash_steps).unwrap_or(i32::MAX);
        let back = steps.signum().wrapping_mul(backlash);
        [steps.saturating_add(back), back.wrapping_neg()]
    }

    /// Accepts a loss of these steps: the motor is at its expected position without them.
    pub fn accept(&mut self, steps: i32) {
        let parts = i64::from(steps).wrapping_mul(self.encoder.counts.into());
        if let Some(origin) = &mut self.origin {
            *origin = origin.wrapping_add(parts);
        }
    }
}

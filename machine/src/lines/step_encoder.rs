//! What an encoder says of a stepping axis.

/// Most counts or steps of [`AxisEncoder`]'s ratio.
const MOST: u32 = 1 << 20;

/// What is done when steps were lost. Each loss is told in every case.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum OnLoss {
    /// Nothing: the program goes on beside its path.
    Report,
    /// The path brakes, and nothing moves until the operator decides.
    Stop,
    /// The path brakes, the lost steps are given again, and it goes on.
    Correct,
}

/// An encoder on the motor of a stepping axis.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct AxisEncoder {
    /// Counts for `steps` motor steps, 1 to 2^20; others are taken as the nearest of these.
    pub counts: u32,
    /// Motor steps for `counts`, 1 to 2^20.
    pub steps: u32,
    /// A moving motor that is further than this many steps from where it should be has lost some; 1 to 2^20. At least the lag of the
    /// rotor, of the counts, and of events that wait in a queue.
    pub tolerance_steps: u32,
    /// What is done then.
    pub on_loss: OnLoss,
    /// Rate of steps that are given again, steps per second, at least 1: one that the motor starts and stops at without a ramp.
    pub correction_rate_hz: u32,
    /// Time that a motor needs to come to rest, timer ticks, at most 2^31.
    pub settle_ticks: u32,
    /// How often lost steps are given again before the axis counts as stalled.
    pub attempts: u8,
}

/// An axis as its encoder sees it. A part is a step's `counts`-th: what both sides are whole numbers of.
#[derive(Copy, Clone, Debug)]
pub(crate) struct Watch {
    pub(crate) encoder: AxisEncoder,
    /// Motor steps given for the path and its take-up.
    given: i64,
    /// Counts at the first look less what `given` was then, and what was reported since and is let be, in parts.
    origin: Option<i64>,
    /// Direction of the last step.
    pub(crate) heading: i8,
    /// Told as lost, and not yet as right.
    pub(crate) is_lost: bool,
    /// Times it was given steps again since it was right last.
    pub(crate) attempts: u8,
}

impl Watch {
    pub(crate) fn new(encoder: AxisEncoder) -> Self {
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

    /// A step of the path, or of its take-up.
    pub(crate) fn step(&mut self, delta: i8) {
        // 2^42 steps are half a year at 300 kHz, and the products below wrap far beyond it.
        self.given = self.given.wrapping_add(delta.into());
        self.heading = if delta == 0 { self.heading } else { delta };
    }

    /// How far the motor is behind, in parts.
    pub(crate) fn behind(&mut self, counts: i64) -> i64 {
        // Each below 2^(42 + 20).
        let should = self.given.wrapping_mul(self.encoder.counts.into());
        let is = counts.wrapping_mul(self.encoder.steps.into());
        let behind = should.wrapping_sub(is);
        let origin = *self.origin.get_or_insert(behind);
        behind.wrapping_sub(origin)
    }

    /// Whether a moving motor may be as far behind.
    pub(crate) const fn is_tolerable(&self, behind: i64) -> bool {
        let most = (self.encoder.tolerance_steps as u64).wrapping_mul(self.encoder.counts as u64);
        // What is right at rest is no loss, however small the tolerance: it would be told again and again.
        behind.unsigned_abs() <= most || self.is_there(behind)
    }

    /// Whether a motor at rest is where it should be: within half a step, or what less than a count is.
    pub(crate) const fn is_there(&self, behind: i64) -> bool {
        let half = self.encoder.counts.div_ceil(2);
        let least = if half > self.encoder.steps {
            half
        } else {
            self.encoder.steps
        };
        behind.unsigned_abs() < least as u64
    }

    /// Parts as steps, to the nearest, and at least one: of what is not there.
    pub(crate) fn steps(&self, behind: i64) -> i32 {
        let counts = i64::from(self.encoder.counts);
        let half = counts / 2;
        let rounded = behind.saturating_add(if behind < 0 {
            half.wrapping_neg()
        } else {
            half
        });
        let steps = rounded.checked_div(counts).unwrap_or(0);
        let steps = if steps == 0 { behind.signum() } else { steps };
        // Beyond 2^31 nothing is known any more.
        i32::try_from(steps).unwrap_or(if steps < 0 { i32::MIN } else { i32::MAX })
    }

    /// The ways that make up for being behind, of an axis that went in the direction of `heading` last and has this lash in steps: against
    /// the heading also across it, and back.
    pub(crate) fn legs(&self, behind: i64, heading: i8, lash_steps: u32) -> [i32; 2] {
        let steps = self.steps(behind);
        if steps.signum() == i32::from(heading) || heading == 0 {
            return [steps, 0];
        }
        let lash = i32::try_from(lash_steps).unwrap_or(i32::MAX);
        let back = steps.signum().wrapping_mul(lash);
        [steps.saturating_add(back), back.wrapping_neg()]
    }

    /// Lets these steps be: without them the motor is where it should be.
    pub(crate) fn accept(&mut self, steps: i32) {
        let parts = i64::from(steps).wrapping_mul(self.encoder.counts.into());
        if let Some(origin) = &mut self.origin {
            *origin = origin.wrapping_add(parts);
        }
    }
}

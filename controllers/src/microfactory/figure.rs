//! Straight moves of a figure, at constant speed along the path.

use husillo_interp::Line;

use super::MicrofactoryConfig;

/// A straight move in X and Z, step by step.
#[derive(Clone, Debug)]
pub(super) struct FigureMove {
    line: Line<2>,
    /// The next step, if there is one.
    next: Option<[i8; 2]>,
    /// Ticks per event, times 256.
    wait_q8: u64,
    /// Remainder of the previous waits, in 256ths of a tick.
    rest_q8: u64,
}

impl FigureMove {
    /// Creates a move by `move_steps` in X and Z. The duration of the move follows from its length
    /// and the rate of the axes. All events of the move have the same share of it.
    pub(super) fn new(move_steps: [i16; 2], config: &MicrofactoryConfig) -> Self {
        let mut line = Line::new(move_steps.map(i32::from));
        // The sum of two squares of at most 2^15 is at most 2^31. It is multiplied by 2^16. The
        // root is the length times 256, below 2^24.
        let [x, z] = move_steps.map(|steps| u64::from(steps.unsigned_abs()));
        let square = x.wrapping_mul(x).wrapping_add(z.wrapping_mul(z));
        let length_q8 = (square << 16).isqrt();
        // The product is below 2^32 times 2^24. The divisor is at most 2^16 times 2^15, and not 0.
        let time = u64::from(config.timer_hz).wrapping_mul(length_q8);
        let shares = u64::from(line.events()).wrapping_mul(u64::from(config.axis_rate_hz));
        Self {
            next: line.next().map(|step| step.deltas()),
            line,
            wait_q8: time.checked_div(shares).unwrap_or(0),
            rest_q8: 0,
        }
    }

    /// Returns the next step and the ticks before it.
    pub(super) fn peek(&self) -> Option<([i8; 2], u32)> {
        // The time of a move in 256ths of a tick is below 2^48. An event takes at most sqrt(2)
        // intervals of an axis, below 2^33.
        let wait = self.wait_q8.wrapping_add(self.rest_q8) >> 8;
        Some((self.next?, u32::try_from(wait).unwrap_or(u32::MAX)))
    }

    /// Advances to the next step.
    pub(super) fn advance(&mut self) {
        self.rest_q8 = self.wait_q8.wrapping_add(self.rest_q8) & 0xFF;
        self.next = self.line.next().map(|step| step.deltas());
    }
}

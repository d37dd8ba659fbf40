//! A straight move of a figure, at constant speed along its path.

use husillo_interp::Line;

use super::MicrofactoryConfig;

/// A straight move in X and Z, step by step.
#[derive(Clone, Debug)]
pub(super) struct FigureMove {
    line: Line<2>,
    /// The next step, as long as there is one.
    next: Option<[i8; 2]>,
    /// Ticks an event times 256.
    wait_q8: u64,
    /// What the waits before have left over, in 256ths of a tick.
    rest_q8: u64,
}

impl FigureMove {
    /// A move by this many steps. Its n events share the time that its length takes at the rate of
    /// the axes.
    pub(super) fn new(way: [i16; 2], config: &MicrofactoryConfig) -> Self {
        let mut line = Line::new(way.map(i32::from));
        // At most 2^15 squared, twice: 2^31, times 2^16. Its root is the length times 256, below
        // 2^24.
        let [x, z] = way.map(|steps| u64::from(steps.unsigned_abs()));
        let square = x.wrapping_mul(x).wrapping_add(z.wrapping_mul(z));
        let length_q8 = (square << 16).isqrt();
        // Below 2^32 by 2^24; the divisor is at most 2^16 by 2^15 and not 0.
        let time = u64::from(config.timer_hz).wrapping_mul(length_q8);
        let shares = u64::from(line.events()).wrapping_mul(u64::from(config.axis_rate_hz));
        Self {
            next: line.next().map(|step| step.deltas()),
            line,
            wait_q8: time.checked_div(shares).unwrap_or(0),
            rest_q8: 0,
        }
    }

    /// The next step and the ticks before it.
    pub(super) fn peek(&self) -> Option<([i8; 2], u32)> {
        // The time of a move is below 2^48 ticks in 256ths. An event takes at most sqrt(2)
        // intervals of an axis, below 2^33.
        let wait = self.wait_q8.wrapping_add(self.rest_q8) >> 8;
        Some((self.next?, u32::try_from(wait).unwrap_or(u32::MAX)))
    }

    /// The step was made.
    pub(super) fn advance(&mut self) {
        self.rest_q8 = self.wait_q8.wrapping_add(self.rest_q8) & 0xFF;
        self.next = self.line.next().map(|step| step.deltas());
    }
}

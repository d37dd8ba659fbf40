//! The circle that is nearest to an arc whose ends have different radii.

use crate::programmed_arc::{cross, dot, size};
use crate::{ArcError, Direction, ProgrammedArc, Scale};

impl ProgrammedArc {
    /// The same arc with equal radii, if they differ by more than half of the shorter step.
    ///
    /// The new centre is on the perpendicular bisector of the chord K = E - S of the ends. From
    /// the old one it is d = K (K . (E + S)) / (2 K . K) away, which is the shortest way. Between
    /// ends less than half a turn apart the path moves by less than the difference of the radii.
    /// Otherwise the centre moves by at most twice that difference, and the path with it.
    ///
    /// # Errors
    /// - [`ArcError::Degenerate`]: the arc is shorter than about twice the difference of the radii,
    ///   so its direction is hardly that of a circle. Use a line: it is nearer to the arc than this
    ///   difference.
    /// - [`ArcError::Unequal`]: the arc is almost a whole turn, and the centre would have to move
    ///   by more than twice the difference of the radii.
    /// - [`ArcError::TooLarge`]: a coordinate from the centre has 2^40 nm or more.
    ///
    /// # Cost
    /// Two divisions of 128 bits where the radii differ; two products otherwise.
    #[cfg_attr(not(target_pointer_width = "64"), inline(never))]
    pub fn as_circle(&self, scales: [Scale; 2]) -> Result<ProgrammedArc, ArcError> {
        let is_within = |half_steps: u64, scale: &Scale| {
            let doubled = self.mismatch_nm.saturating_mul(2);
            let limit = u64::from(scale.nm()).saturating_mul(half_steps);
            doubled.saturating_mul(scale.steps().into()) <= limit
        };
        if scales.iter().all(|scale| is_within(1, scale)) {
            return Ok(*self);
        }
        let [start, end] = self.spokes();
        let ([start_x, start_y], [end_x, end_y]) = (start, end);
        if [start, end]
            .iter()
            .flatten()
            .any(|at| at.unsigned_abs() >> 40 != 0)
        {
            return Err(ArcError::TooLarge);
        }
        let chord = [end_x.wrapping_sub(start_x), end_y.wrapping_sub(start_y)];
        let sum = [end_x.wrapping_add(start_x), end_y.wrapping_add(start_y)];
        // Each coordinate is below 2^41: at most 2^83, and 2^124 with another one.
        let double_square = dot(chord, chord).wrapping_mul(2);
        let along = dot(chord, sum);
        let part = |chord: i64| {
            let product = along.wrapping_mul(chord.into());
            product.checked_div(double_square).map(|part| part as i64)
        };
        let [chord_x, chord_y] = chord;
        let (Some(off_x), Some(off_y)) = (part(chord_x), part(chord_y)) else {
            return Ok(*self); // no chord, so the radii are equal
        };
        let is_half_turn_at_most = match self.direction {
            Direction::CounterClockwise => cross(start, end) > 0,
            Direction::Clockwise => cross(start, end) < 0,
        };
        let is_short = is_half_turn_at_most && self.turns == 0;
        // Between ends less than half a turn apart the path hardly moves, wherever the centre goes.
        let most = match is_short {
            true => (size(start) / 4).max(self.mismatch_nm),
            false => self.mismatch_nm,
        };
        if size([off_x, off_y]) > most.saturating_mul(2) {
            // An end within one step of each axis is reached all the same.
            return match scales.iter().all(|scale| is_within(2, scale)) {
                true => Ok(*self),
                false if is_short => Err(ArcError::Degenerate),
                false => Err(ArcError::Unequal),
            };
        }
        let [x, y] = self.centre;
        Ok(ProgrammedArc {
            centre: [x.saturating_add(off_x), y.saturating_add(off_y)],
            mismatch_nm: 0,
            ..*self
        })
    }
}

//! Conversion of a programmed arc for the interpolator.

use husillo_gcode::{Arc, Nm};
use husillo_interp::{ArcError, Direction, ProgrammedArc, Scale};

use crate::{Config, MoveError};

/// Up to this difference of its radii, in steps, an arc is made as it is programmed: the last steps
/// make up for the difference.
const FEW_STEPS: u64 = 4;

/// Returns the arc in its plane; `from` is the position before it.
pub(crate) fn in_plane<const N: usize>(from: &[Nm; N], arc: &Arc<N>) -> ProgrammedArc {
    let [from, to, centre] = arc.in_plane(from);
    ProgrammedArc {
        from,
        to,
        centre,
        direction: Direction::from_clockwise(arc.direction.is_clockwise()),
        turns: arc.turns,
        mismatch_nm: arc.mismatch.0.unsigned_abs(),
    }
}

/// Whether the radii at both ends differ by more than a few steps.
pub(crate) fn is_spiral(arc: &ProgrammedArc, scale: Scale) -> bool {
    let steps = arc.mismatch_nm.saturating_mul(scale.steps().into());
    steps > u64::from(scale.nm()).saturating_mul(FEW_STEPS)
}

impl<const N: usize> Config<N> {
    /// Returns the arc that is made of a programmed one: its centre moves if its ends have
    /// different radii. `None` for a line.
    ///
    /// A spiral is at no right angle to its spokes, and its speed changes as 1 / radius. So it is
    /// made as the circle through its ends with the nearest centre. This keeps the acceleration of
    /// the axes. An arc of about a whole turn has no such circle and stays a spiral. Its slope is
    /// below a fifth of the difference of the radii per radius, and the path stops at its ends. On
    /// equal steps so does an arc of more than a kilometre, beyond the range of this circle.
    ///
    /// # Errors
    /// As [`ProgrammedArc::as_circle`] on axes of different steps, where every arc is a circle, and
    /// [`MoveError::UnequalSteps`] for a machine without the axes of the plane.
    #[cfg_attr(not(target_pointer_width = "64"), inline(never))]
    pub(crate) fn made_arc(
        &self,
        programmed: &ProgrammedArc,
        arc: &Arc<N>,
    ) -> Result<Option<ProgrammedArc>, MoveError> {
        let [Some(first), Some(second)] = arc.plane.axes().map(|number| self.axes.get(number))
        else {
            return Err(MoveError::UnequalSteps);
        };
        let scale = first.scale;
        let is_equal = scale == second.scale;
        if is_equal && !is_spiral(programmed, scale) {
            return Ok(Some(*programmed));
        }
        match programmed.as_circle([scale, second.scale]) {
            Ok(circle) => Ok(Some(circle)),
            Err(ArcError::Degenerate) => Ok(None),
            Err(ArcError::Unequal | ArcError::TooLarge) if is_equal => Ok(Some(*programmed)),
            Err(ArcError::Unequal) => Err(MoveError::UnequalSteps),
            Err(_) => Err(MoveError::ArcTooLarge),
        }
    }
}

//! Conversion of a programmed arc for the interpolator.

use husillo_gcode::{Arc, Nm};
use husillo_interp::{Direction, ProgrammedArc};

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

//! Direction of a move at its start and at its end.

use husillo_gcode::{Command, Direction as Turning};
use husillo_planner::Tangent;

use crate::lines::arc::in_plane;
use crate::lines::tempo::Tempo;
use crate::{Config, Segment};
use husillo_planner::mul_div;

/// The directions of the path at the start and at the end of a move; `None` for a move without
/// distance.
pub(crate) fn tangents<const N: usize>(
    config: &Config<N>,
    segment: &Segment<N>,
    tempo: &Tempo<N>,
    has_ellipses: bool,
) -> Option<[Tangent<N>; 2]> {
    let (Command::Arc { arc, .. }, Some(round)) = (&segment.command, &tempo.round) else {
        return tempo.along.map(|direction| [direction; 2]);
    };
    let mut straight = [0; N];
    for (way, (from, to)) in straight.iter_mut().zip(segment.from.iter().zip(&arc.to)) {
        *way = to.0.saturating_sub(from.0);
    }
    let mut flat = in_plane(&segment.from, arc);
    if has_ellipses {
        flat = config.made_arc(&flat, arc).ok()??;
    }
    let tangent = |[x, y]: [i64; 2], size: u64| {
        let [across, up] = match arc.direction {
            Turning::CounterClockwise => [y.saturating_neg(), x],
            Turning::Clockwise => [y, x.saturating_neg()],
        };
        let mut way = straight;
        for (axis, component) in round.plane.into_iter().zip([across, up]) {
            // Scaled to the length of the arc, so that the other axes keep their share of the
            // direction.
            let part = mul_div(component.unsigned_abs(), round.around_nm, size);
            let part = i64::try_from(part).unwrap_or(i64::MAX);
            if let Some(way) = way.get_mut(axis) {
                *way = if component < 0 {
                    part.wrapping_neg()
                } else {
                    part
                };
            }
        }
        Tangent::new(way)
    };
    let ([start, end], [start_radius, end_radius]) = (flat.spokes(), flat.radii());
    Some([tangent(start, start_radius)?, tangent(end, end_radius)?])
}

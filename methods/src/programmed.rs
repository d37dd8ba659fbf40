//! Puts programmed moves on the grid of a machine, for the methods.

use crate::comparison::Move;
use crate::curve::Curve;
use crate::method::{AXES, Shape};
use husillo_gcode::{Arc, Direction, Nm};
use husillo_interp::{ArcMove, Rim, fraction_bits_for};
use husillo_machine::{Config, Scale};
use std::f64::consts::PI;

// Why a move is left out.
const TOO_LARGE: &str = "moves beyond 2^31 steps are left out";
const UNEQUAL: &str = "arcs in axes with unequal steps are left out";
const TINY: &str = "arcs smaller than the grid are left out";

/// A straight move. `None` if it has no step.
///
/// # Errors
///
/// Why it is left out.
pub fn line<const N: usize>(
    config: &Config<N>,
    from: [Nm; N],
    to: [Nm; N],
) -> Result<Option<Move>, &'static str> {
    let (mut delta, mut exact) = ([0; AXES], [[0.0; AXES]; 2]);
    for axis in 0..AXES.min(N) {
        let scale = config.axes[axis].scale;
        let start = scale.nearest(from[axis].0).ok_or(TOO_LARGE)?;
        let end = scale.nearest(to[axis].0).ok_or(TOO_LARGE)?;
        delta[axis] = end.checked_sub(start).ok_or(TOO_LARGE)?;
        for (point, nm) in exact.iter_mut().zip([from, to]) {
            point[axis] = steps(scale, nm[axis]) - f64::from(start);
        }
    }
    let [from, to] = exact;
    Ok((delta != [0; AXES]).then(|| Move {
        shape: Shape::Line(delta),
        rounded: None,
        curve: Curve::line(from, to),
    }))
}

/// An arc in its plane. Of a helix, only the motion in the plane counts.
///
/// # Errors
///
/// Why it is left out.
pub fn arc<const N: usize>(
    config: &Config<N>,
    from: [Nm; N],
    arc: &Arc<N>,
) -> Result<Option<Move>, &'static str> {
    let plane = arc.plane.axes();
    let scale = config.axes[plane[0]].scale;
    if scale != config.axes[plane[1]].scale {
        return Err(UNEQUAL);
    }
    let flat = |p: [Nm; N]| plane.map(|axis| p[axis]);
    let lattice = |p: [Nm; 2]| match p.map(|at| scale.nearest(at.0)) {
        [Some(x), Some(y)] => Ok([x, y]),
        _ => Err(TOO_LARGE),
    };
    let [from, to, centre] = [flat(from), flat(arc.to), flat(arc.centre)];
    let exact = [from, to, centre].map(|p| p.map(|at| steps(scale, at)));
    let radius = arc.radius.map_or_else(
        || (exact[0][0] - exact[2][0]).hypot(exact[0][1] - exact[2][1]),
        |radius| steps(scale, radius).abs(),
    );
    if radius < 2.0 {
        return Err(TINY);
    }
    let is_circle = steps(scale, arc.mismatch) <= 0.5;
    let direction = match arc.direction {
        Direction::Clockwise => husillo_interp::Direction::Clockwise,
        Direction::CounterClockwise => husillo_interp::Direction::CounterClockwise,
    };
    let curve = Curve::arc(exact, direction, arc.turns, is_circle.then_some(radius));
    let mut one = ArcMove {
        from: lattice(from)?,
        to: lattice(to)?,
        centre: [0; 2],
        fraction_bits: 0,
        direction,
        turns: arc.turns,
        rim: Rim::Spiral,
    };
    one.centre = whole_centre(&one, exact[2], radius);
    one.rim = between(&one);
    let bits = fraction_bits_for(radius as u64);
    // |centre| 2^16 < 2^48 is exact in `f64`.
    let fine = exact[2].map(|at| (at * f64::from(1_u32 << bits)).round() as i64);
    let residue = |p: [i32; 2]| {
        let [x, y] = [0, 1].map(|axis| (i128::from(p[axis]) << bits) - i128::from(fine[axis]));
        // Both squares are below 2^62, so the radius has an error of at most 2^-20 of a step.
        let scaled = radius * f64::from(1_u32 << bits);
        let over = (x * x + y * y) as f64 - scaled * scaled;
        (over / f64::from(1_u32 << bits)).round() as i64
    };
    let general = ArcMove {
        centre: fine,
        fraction_bits: bits,
        rim: if is_circle {
            Rim::Nominal {
                start: residue(one.from),
                end: residue(one.to),
            }
        } else {
            Rim::Spiral
        },
        ..one
    };
    // The grid may merge the ends or move them past each other. The move would then have a full
    // turn more or less.
    let turned = |curve: &Curve| curve.length();
    for grid in [&one, &general] {
        if (turned(&Curve::of(grid, Some(radius))) - turned(&curve)).abs() > PI * radius {
            return Err(TINY);
        }
    }
    Ok(Some(Move {
        shape: Shape::Arc(general),
        rounded: Some(Shape::Arc(one)),
        curve,
    }))
}

/// The whole-step centre that distorts the arc least: near the exact one, and at about the same
/// distance from both ends.
fn whole_centre(arc: &ArcMove, exact: [f64; 2], radius: f64) -> [i64; 2] {
    let near = exact.map(|at| at.round() as i64);
    let wrong = |centre: [i64; 2]| {
        let distance = |p: [f64; 2]| (p[0] - centre[0] as f64).hypot(p[1] - centre[1] as f64);
        let [start, end] = [arc.from, arc.to].map(|p| distance(p.map(f64::from)));
        // Up to one step of difference, a circle between both ends is less than a step from each.
        let apart = ((end - start).abs() - 1.0).max(0.0);
        distance(exact) + (0.5 * (start + end) - radius).abs() + 2.0 * apart
    };
    let mut best = near;
    for (dx, dy) in (-3..=3).flat_map(|dx| (-3..=3).map(move |dy| (dx, dy))) {
        let other = [near[0] + dx, near[1] + dy];
        if wrong(other) < wrong(best) {
            best = other;
        }
    }
    best
}

/// The circle between both ends of an arc with a whole-step centre.
fn between(arc: &ArcMove) -> Rim {
    let square = |p: [i32; 2]| {
        let [x, y] = [0, 1].map(|axis| i64::from(p[axis]) - arc.centre[axis]);
        x * x + y * y
    };
    let (start, end) = (square(arc.from), square(arc.to));
    let radius = 0.5 * ((start as f64).sqrt() + (end as f64).sqrt());
    let middle = (radius * radius).round() as i64;
    Rim::Nominal {
        start: start - middle,
        end: end - middle,
    }
}

/// Converts a length to steps.
fn steps(scale: Scale, at: Nm) -> f64 {
    at.0 as f64 * f64::from(scale.steps()) / f64::from(scale.nm())
}

//! Arcs whose ends have different distances from the centre.

use core::f64::consts::TAU;

use husillo_interp::{Arc, ArcMove, Direction, Rim, fraction_bits_for};
use proptest::prelude::*;

/// A spiral from one radius to another, in steps, over `angle` radians.
fn spiral(start: f64, angle: f64, radii: [f64; 2], is_clockwise: bool) -> ArcMove {
    let at = |angle: f64, radius: f64| {
        [radius * angle.cos(), radius * angle.sin()].map(|at| at.round() as i32)
    };
    let [first, last] = radii;
    let turned = if is_clockwise { -angle } else { angle };
    ArcMove {
        from: at(start, first),
        to: at(start + turned, last),
        centre: [0, 0],
        fraction_bits: fraction_bits_for(first.max(last) as u64),
        direction: Direction::from_clockwise(is_clockwise),
        turns: (angle / TAU) as u32,
        rim: Rim::Spiral,
    }
}

/// Farthest distance of the path from the spiral whose squared radius changes evenly with the
/// events.
fn farthest(arc: &ArcMove) -> f64 {
    let square = |[x, y]: [i64; 2]| (x * x + y * y) as f64;
    let mut at = arc.from.map(i64::from);
    let (first, last) = (square(at), square(arc.to.map(i64::from)));
    let steps = Arc::new(arc).unwrap();
    let count = f64::from(steps.events());
    let distances = steps.enumerate().map(|(number, step)| {
        let [x, y]: [i8; 2] = step.deltas();
        at = [at[0] + i64::from(x), at[1] + i64::from(y)];
        let part = (number + 1) as f64 / count;
        (square(at).sqrt() - (first + (last - first) * part).sqrt()).abs()
    });
    distances.fold(0.0, f64::max)
}

/// A whole turn inwards from 3 to 2.6 mm in steps of 0.1 um. It lags by 7 steps at the axes.
#[test]
fn a_fine_spiral_is_followed() {
    let arc = spiral(-TAU / 4.0, TAU * 0.999, [30_000.0, 26_000.0], false);
    assert!(farthest(&arc) < 12.0, "{}", farthest(&arc));
}

proptest! {
    /// The steps do not depend on the width of the state, however steep the spiral is.
    #[test]
    fn the_width_of_the_state_does_not_change_the_steps(
        start in 0.0..TAU,
        angle in 0.05..15.0_f64,
        radius in 20.0..40_000.0_f64,
        change in -0.5..0.5_f64,
        is_clockwise: bool,
    ) {
        let arc = spiral(start, angle, [radius, radius * change.exp()], is_clockwise);
        let (any, wide) = (Arc::new(&arc).unwrap(), Arc::wide(&arc).unwrap());
        prop_assert_eq!(any.events(), wide.events());
        prop_assert!(any.eq(wide), "{:?}", arc);
    }

    /// Over half a turn and more the path stays within 5 steps, the lag at the axes for its slope,
    /// and a part of the change of the radius: the number of events is estimated as if the path
    /// had no slope.
    #[test]
    fn spirals_are_followed(
        start in 0.0..TAU,
        angle in 3.2..15.0_f64,
        radius in 50.0..40_000.0_f64,
        change in -0.2..0.2_f64,
        is_clockwise: bool,
    ) {
        let radii = [radius, radius * change.exp()];
        let arc = spiral(start, angle, radii, is_clockwise);
        let slope = change / angle;
        let lag = radius * slope * slope;
        let farthest = farthest(&arc);
        let bound = 5.0 + lag + (radii[1] - radius).abs() * (0.02 + slope.abs() / 2.0);
        prop_assert!(farthest < bound, "{farthest} {bound} {arc:?}");
    }
}

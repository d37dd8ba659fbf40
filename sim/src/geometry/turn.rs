//! Angles along arcs.

use std::f64::consts::TAU;

/// If the angles of the two ends differ by less than this, the ends are equal and the arc is a full
/// turn. Two points that are 1 nm apart on a circle of 1 km differ by this angle.
const SAME_ANGLE: f64 = 1e-12;

/// The angle of a point around a centre.
pub fn angle(point: [f64; 2], centre: [f64; 2]) -> f64 {
    (point[1] - centre[1]).atan2(point[0] - centre[0])
}

/// The angle from one direction to another, 0 to a full turn.
pub fn turned(from: f64, to: f64, counter_clockwise: bool) -> f64 {
    match counter_clockwise {
        true => (to - from).rem_euclid(TAU),
        false => (from - to).rem_euclid(TAU),
    }
}

/// The angle of an arc between its ends. It is positive, and a full turn if the ends are equal.
pub fn sweep(from: f64, to: f64, counter_clockwise: bool) -> f64 {
    let forward = turned(from, to, true);
    match counter_clockwise {
        _ if forward < SAME_ANGLE => TAU,
        true => forward,
        false => TAU - forward,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn arcs_sweep_in_their_direction() {
        assert_eq!(sweep(0.0, FRAC_PI_2, true), FRAC_PI_2);
        assert_eq!(sweep(0.0, FRAC_PI_2, false), 3.0 * FRAC_PI_2);
        assert_eq!(sweep(-3.0, 3.0, true), 6.0);
        assert_eq!(turned(-3.0, 3.0, false), TAU - 6.0);
        for counter_clockwise in [true, false] {
            assert_eq!(sweep(1.0, 1.0, counter_clockwise), TAU);
            assert_eq!(turned(1.0, 1.0, counter_clockwise), 0.0);
        }
        assert_eq!(angle([5.0, 7.0], [5.0, 6.0]), FRAC_PI_2);
    }
}

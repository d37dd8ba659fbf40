//! Highest velocity at a given distance from the goal.

use crate::quotient::quotient;

/// Distance from moving by `velocity` in this period to rest, this period included: the sum of the
/// positive terms of `velocity`, `velocity - acceleration`, `velocity - 2 acceleration`, ...
///
/// Both arguments are below 2^32; the acceleration is not 0. With n = velocity / acceleration
/// rounded down, the sum is (n + 1) velocity - acceleration n (n + 1) / 2.
pub(super) fn way_to_rest(velocity: u32, acceleration: u32) -> u64 {
    let periods = velocity.checked_div(acceleration).unwrap_or(0);
    // velocity >= n acceleration, so the difference is positive. The first product is largest for
    // acceleration = 1. Velocities are at most 2^31 (see `ServoProfile`), so it stays below 2^63.
    let periods = u64::from(periods);
    let all = periods.wrapping_add(1).wrapping_mul(velocity.into());
    // n (n + 1) / 2 is below 2^62. Times the acceleration it is at most `all`.
    let pairs = periods.wrapping_mul(periods.wrapping_add(1)) / 2;
    all.wrapping_sub(pairs.wrapping_mul(acceleration.into()))
}

/// The largest velocity from `low` to `high` whose distance to rest is at most `way`; `low` when
/// there is none.
///
/// All velocities are at most 2^31. `high - low` is at most twice the acceleration, so only a few
/// segments of the piecewise linear `way_to_rest` are tried. Takes one division of 32 bits for each
/// end and one of 64 by 32 bits.
pub(super) fn fastest(low: u32, high: u32, acceleration: u32, way: u64) -> u32 {
    if way_to_rest(high, acceleration) <= way {
        return high;
    }
    let mut from = low;
    let mut periods = low.checked_div(acceleration).unwrap_or(0);
    let mut used = way_to_rest(low, acceleration);
    // At most three corners lie between the two; the bound guards against wrong arguments.
    for _ in 0..4 {
        if used >= way {
            break;
        }
        // From here to the next corner each unit of velocity costs `periods + 1`.
        let slope = periods.wrapping_add(1);
        let corner = u64::from(slope)
            .wrapping_mul(acceleration.into())
            .min(high.into()) as u32;
        let gain = quotient(way.wrapping_sub(used), slope);
        let room = corner.wrapping_sub(from);
        if gain < u64::from(room) {
            // from + gain < corner
            return from.wrapping_add(gain as u32);
        }
        // At most `way`, because slope room <= slope gain.
        used = used.wrapping_add(u64::from(slope).wrapping_mul(room.into()));
        from = corner;
        periods = slope;
    }
    from
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::{fastest, way_to_rest};

    fn summed(velocity: u32, acceleration: u32) -> u64 {
        let mut velocity = i64::from(velocity);
        let mut way = 0;
        while velocity > 0 {
            way += velocity;
            velocity -= i64::from(acceleration);
        }
        way as u64
    }

    #[test]
    fn way_to_rest_is_the_sum() {
        for acceleration in 1..40 {
            for velocity in 0..300 {
                assert_eq!(
                    way_to_rest(velocity, acceleration),
                    summed(velocity, acceleration)
                );
            }
        }
        let top = i32::MAX as u32;
        assert_eq!(way_to_rest(top, 1), u64::from(top) * (1 << 30));
        assert_eq!(way_to_rest(top, top), u64::from(top));
    }

    #[test]
    fn fastest_is_the_largest() {
        for acceleration in 1..12_u32 {
            for now in 0..60_u32 {
                let [low, high] = [now.saturating_sub(acceleration), now + acceleration];
                for way in 0..500 {
                    let largest = (low..=high)
                        .rev()
                        .find(|velocity| summed(*velocity, acceleration) <= way);
                    assert_eq!(
                        fastest(low, high, acceleration, way),
                        largest.unwrap_or(low),
                        "{acceleration} {now} {way}"
                    );
                }
            }
        }
    }
}

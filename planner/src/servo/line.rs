//! Straight moves of axes on independent modules.

use crate::tangent::Tangent;

/// Velocities and accelerations have 31 bits.
const LARGEST: u32 = i32::MAX as u32;

/// One time law for the trapezoids of `N` axes: they start together, end together and stay on the
/// straight line between.
///
/// For [`ServoMotion::Trapezoid`](crate::ServoMotion) of independent modules that all start in the
/// same period (a group command). As everywhere with these modules, distances are in counts,
/// velocities in 2^-16 counts per period and accelerations in 2^-16 counts per period^2.
///
/// The longest axis takes its share of the path velocity and of the acceleration. Its acceleration
/// may be lower by up to a sixteenth: the value is chosen for which the shares of the other axes
/// are nearest below whole numbers. The acceleration of each other axis is rounded up. Its velocity
/// is the least with which a trapezoid of that acceleration covers the distance in the time of the
/// longest axis. Accelerations are thus matched to 2^-16 and times to one unit of velocity:
///
/// - **Limits**: no axis exceeds its share of the path velocity by more than 1 unit, nor its share
///   of the acceleration by more than 1 unit.
/// - **Time skew**: all axes end within [`skew_ticks`](Self::skew_ticks) of each other: 3 periods
///   plus duration / velocity. Times can be matched only to one unit of velocity, so a short slow
///   axis ends that much earlier. No axis ends more than 3 periods later.
/// - **Path deviation**: an axis with distance d is off d s, where s is the fraction of its
///   distance that the longest axis has covered, by at most [`deviation`](Self::deviation). In
///   2^-16 counts this is n^2 / 2 for ramps of n periods (an acceleration is rounded by up to 1
///   unit, summed over a ramp), plus two periods of its velocity at the ends of ramps (a trapezoid
///   begins to brake in a whole period), plus one unit of velocity for each period of the move,
///   plus one count for the rounding of positions.
///
/// # Examples
/// ```
/// use husillo_planner::ServoLine;
///
/// // 3:4 with 1.0 counts per period and 0.002 counts per period^2.
/// let line = ServoLine::new([3_000, -4_000], 65_536, 131).unwrap();
/// assert_eq!(line.velocities, [39_321, 52_428]);
/// assert_eq!(line.accelerations, [78, 104]);
/// assert_eq!(line.duration_ticks, 5505);
/// ```
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ServoLine<const N: usize> {
    /// Velocity of each axis in 2^-16 counts per period; 0 where its distance is 0.
    pub velocities: [u32; N],
    /// Acceleration of each axis in 2^-16 counts per period^2; 0 where its distance is 0.
    pub accelerations: [u32; N],
    /// Duration of the move in servo periods; 2^32 - 1 also stands for longer moves.
    pub duration_ticks: u32,
    /// Length of the longer ramp of the longest axis, in servo periods.
    ramp_ticks: u32,
}

/// The time law of the longest axis.
#[derive(Copy, Clone)]
struct Law {
    counts: u32,
    acceleration: u32,
    /// Duration of a continuous trapezoid in 2^-16 periods.
    time: u64,
}

impl<const N: usize> ServoLine<N> {
    /// Computes a line over `distances` in counts, at this velocity and acceleration along the
    /// path. Both are taken as at least 1 and at most 2^31 - 1. Returns `None` when all distances
    /// are 0. `N` is at most 15.
    ///
    /// For the highest path velocity within the limits of the axes see [`Tangent::speed_limit`].
    ///
    /// # Cost
    /// No division of more than 64 bits; up to 65 divisions and 32 products of 128 bits per axis.
    pub fn new(distances: [i32; N], path_velocity: u32, path_acceleration: u32) -> Option<Self> {
        let direction = Tangent::new(distances.map(i64::from))?;
        let counts = distances.iter().map(|way| way.unsigned_abs()).max()?;
        let part = direction
            .components()
            .iter()
            .map(|part| part.unsigned_abs())
            .max()?;
        // `part` is at most slightly above 2^30, so the product has 62 bits and the quotient is at
        // most 2^31.
        let share = |whole: u32| {
            let whole = u64::from(whole.min(LARGEST));
            (whole.wrapping_mul(part.into()) >> 30).clamp(1, LARGEST.into()) as u32
        };
        let acceleration = common(share(path_acceleration), counts, &distances);
        let way = way_units(counts);
        // A short move never reaches its velocity: the highest v with v^2 / a <= distance.
        let reached = least(LARGEST, |velocity| {
            square(velocity) > product(way, acceleration)
        });
        let velocity = share(path_velocity).min(reached.saturating_sub(1).max(1));
        let ramp = quotient(u64::from(velocity) << 16, acceleration);
        let law = Law {
            counts,
            acceleration,
            // At most 2^63 and 2^47. Both quotients are rounded down; with the 2 the time is at
            // least the true one.
            time: quotient(way << 16, velocity)
                .wrapping_add(ramp)
                .wrapping_add(2),
        };
        let axes = distances.map(|way| law.axis(way.unsigned_abs(), velocity));
        Some(Self {
            velocities: axes.map(|(velocity, _)| velocity),
            accelerations: axes.map(|(_, acceleration)| acceleration),
            duration_ticks: ticks(law.time),
            ramp_ticks: ticks(ramp),
        })
    }

    /// Largest distance of any axis from its position on the line at any time, in 2^-16 counts; see
    /// above.
    pub fn deviation(&self) -> u64 {
        let ramp = u64::from(self.ramp_ticks);
        let fastest = self.velocities.iter().copied().max().unwrap_or(0);
        // At most 2^63; the other terms add 2^33 and 2^32.
        (ramp.wrapping_mul(ramp) / 2)
            .saturating_add(u64::from(fastest).wrapping_mul(2))
            .saturating_add(self.duration_ticks.into())
            .saturating_add(1 << 16)
    }

    /// Largest difference between the end times of any two axes, in periods; see above.
    pub fn skew_ticks(&self) -> u32 {
        let moving = self.velocities.iter().copied().filter(|one| *one > 0);
        let slowest = moving.min().unwrap_or(1);
        let unit = self.duration_ticks.checked_div(slowest).unwrap_or(0);
        unit.saturating_add(3)
    }
}

impl Law {
    /// Velocity and acceleration of an axis with this distance. `longest` is the velocity of the
    /// longest axis.
    fn axis(self, counts: u32, longest: u32) -> (u32, u32) {
        if counts == 0 {
            return (0, 0);
        }
        if counts == self.counts {
            return (longest, self.acceleration);
        }
        // Rounded up. The quotient is at most the acceleration of the longest axis, because this
        // distance is shorter.
        let scaled = u64::from(self.acceleration).wrapping_mul(counts.into());
        let rounding = u64::from(self.counts).wrapping_sub(1);
        let acceleration = quotient(scaled.wrapping_add(rounding), self.counts) as u32;
        let way = product(way_units(counts), acceleration);
        let time = product(self.time, acceleration);
        // distance / v + v / a <= time, multiplied by a v: 94 bits on the left with 16 for the
        // fraction of the time, 126 bits on the right.
        let velocity = least(longest, |velocity| {
            let square = square(velocity);
            let left = way.wrapping_add(square).wrapping_shl(16);
            // Velocities above the peak of the two ramps shorten nothing.
            square >= way || left <= time.wrapping_mul(velocity.into())
        });
        (velocity, acceleration)
    }
}

/// Among the accelerations of the longest axis up to a sixteenth (and 64 units) below `most`, the
/// one that needs the least rounding up for the other axes.
fn common(most: u32, longest: u32, distances: &[i32]) -> u32 {
    let mut best = most;
    let mut least = u32::MAX;
    // most is at least 1, and so is the difference.
    for less in 0..=(most >> 4).min(64) {
        let acceleration = most.wrapping_sub(less);
        let worst = distances.iter().map(|way| {
            let scaled = u64::from(acceleration).wrapping_mul(way.unsigned_abs().into());
            let rest = scaled.checked_rem(longest.into()).unwrap_or(0);
            // Distance to the next multiple of `longest`; `longest` itself for an exact multiple.
            u64::from(longest).wrapping_sub(rest) as u32
        });
        let worst = worst.map(|missing| if missing == longest { 0 } else { missing });
        let worst = worst.max().unwrap_or(0);
        if worst < least {
            [best, least] = [acceleration, worst];
        }
        if least == 0 {
            break;
        }
    }
    best
}

/// Converts counts to 2^-16 counts: 48 bits.
fn way_units(counts: u32) -> u64 {
    u64::from(counts) << 16
}

/// The least number from 1 to `most` for which `holds` is true; `most` when there is none. `holds`
/// has to be monotonic.
fn least(most: u32, holds: impl Fn(u32) -> bool) -> u32 {
    let [mut low, mut high] = [1, most.max(1)];
    while low < high {
        // low <= middle < high
        let middle = low.wrapping_add(high.wrapping_sub(low) / 2);
        if holds(middle) {
            high = middle;
        } else {
            low = middle.wrapping_add(1);
        }
    }
    low
}

fn square(number: u32) -> u128 {
    product(number.into(), number)
}

fn product(one: u64, other: u32) -> u128 {
    u128::from(one).wrapping_mul(other.into())
}

/// Whole periods, rounded up, in 32 bits.
fn ticks(time: u64) -> u32 {
    // The sum is at most slightly above 2^63.
    u32::try_from(time.wrapping_add(0xffff) >> 16).unwrap_or(u32::MAX)
}

/// Rounded down.
fn quotient(dividend: u64, divisor: u32) -> u64 {
    dividend.checked_div(divisor.into()).unwrap_or(0)
}

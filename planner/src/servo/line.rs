//! Straight moves of axes that know nothing of each other.

use crate::direction::Direction;

/// Velocities and accelerations have 31 bits.
const LARGEST: u32 = i32::MAX as u32;

/// One time law for the trapezoids of `N` axes, so that they start and end together and stay on the
/// straight line between.
///
/// For [`ServoMotion::Trapezoid`](crate::ServoMotion) of independent modules, all started in the
/// same period (a group command). Distances in counts, velocities in 2^-16 counts a period,
/// accelerations in 2^-16 counts a period^2, as everywhere with these modules.
///
/// The longest axis takes its part of the path velocity, and of the acceleration: of the numbers up
/// to a sixteenth below it the one whose parts for the other axes are nearest below whole numbers.
/// An acceleration of another axis is rounded up, and its velocity is the least with which a
/// trapezoid of that acceleration does its way in the time of the longest axis. So accelerations
/// are matched to 2^-16 and the times to the unit of velocity:
///
/// - **Limits**: no axis exceeds its part of the path velocity by more than 1 unit, nor its part of the acceleration by 1 unit.
/// - **Time skew**: all axes end within [`skew_ticks`](Self::skew_ticks) of each other, 3 periods and duration / velocity: a unit of
///   velocity is all there is to match times with, so a short slow axis ends that much earlier, none more than 3 later.
/// - **Path deviation**: an axis with way d is off d s, where s is the part of its way that the longest axis has done, by at most
///   [`deviation`](Self::deviation): n^2 / 2 for ramps of n periods (the rounding of an acceleration, up to 1 unit, summed up over a
///   ramp), two periods of its velocity on ramps' ends (a trapezoid begins to brake in a whole period), and a unit of velocity for each
///   period of the move, all in 2^-16 counts, and one count for the rounding of positions.
///
/// ```
/// use husillo_planner::ServoLine;
///
/// // 3:4 with 1.0 counts a period and 0.002 counts a period^2.
/// let line = ServoLine::new([3_000, -4_000], 65_536, 131).unwrap();
/// assert_eq!(line.velocities, [39_321, 52_428]);
/// assert_eq!(line.accelerations, [78, 104]);
/// assert_eq!(line.duration_ticks, 5505);
/// ```
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ServoLine<const N: usize> {
    /// Velocity of each axis, 2^-16 counts a period; 0 where it has no way.
    pub velocities: [u32; N],
    /// Acceleration of each axis, 2^-16 counts a period^2; 0 where it has no way.
    pub accelerations: [u32; N],
    /// How long the move takes, in servo periods; 2^32 - 1 also stands for more.
    pub duration_ticks: u32,
    /// Length of the longer ramp of the longest axis, in servo periods.
    ramp_ticks: u32,
}

/// The longest axis, and its time law.
#[derive(Copy, Clone)]
struct Law {
    counts: u32,
    acceleration: u32,
    /// From first to last, 2^-16 periods, of a continuous trapezoid.
    time: u64,
}

impl<const N: usize> ServoLine<N> {
    /// For `distances` in counts at this velocity and acceleration along the path, in counts; both
    /// are taken as 1 at least and as 2^31 - 1 at most. `None` when there is no way at all. `N` is
    /// at most 15.
    ///
    /// For the highest path velocity within limits of the axes see [`Direction::speed_limit`].
    /// Set-up of a line: no division of more than 64 bits; up to 65 divisions and 32 products of
    /// 128 bits for each axis.
    pub fn new(distances: [i32; N], path_velocity: u32, path_acceleration: u32) -> Option<Self> {
        let direction = Direction::new(distances.map(i64::from))?;
        let counts = distances.iter().map(|way| way.unsigned_abs()).max()?;
        let part = direction
            .components()
            .iter()
            .map(|part| part.unsigned_abs())
            .max()?;
        // `part` is at most 2^30 and a little: 62 bits, and the quotient is at most 2^31.
        let share = |whole: u32| {
            let whole = u64::from(whole.min(LARGEST));
            (whole.wrapping_mul(part.into()) >> 30).clamp(1, LARGEST.into()) as u32
        };
        let acceleration = common(share(path_acceleration), counts, &distances);
        let way = way_units(counts);
        // A short move never gets to its velocity: highest v with v^2 / a <= way.
        let reached = least(LARGEST, |velocity| {
            square(velocity) > product(way, acceleration)
        });
        let velocity = share(path_velocity).min(reached.saturating_sub(1).max(1));
        let ramp = quotient(u64::from(velocity) << 16, acceleration);
        let law = Law {
            counts,
            acceleration,
            // 2^63 and 2^47 at most. Two quotients rounded down, so at least as long as in truth
            // with the 2.
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

    /// How far any axis may be from its place on the line at any time, 2^-16 counts; see above.
    pub fn deviation(&self) -> u64 {
        let ramp = u64::from(self.ramp_ticks);
        let fastest = self.velocities.iter().copied().max().unwrap_or(0);
        // 2^63 at most; 2^33 and 2^32 with it.
        (ramp.wrapping_mul(ramp) / 2)
            .saturating_add(u64::from(fastest).wrapping_mul(2))
            .saturating_add(self.duration_ticks.into())
            .saturating_add(1 << 16)
    }

    /// By how many periods any two axes may end apart; see above.
    pub fn skew_ticks(&self) -> u32 {
        let moving = self.velocities.iter().copied().filter(|one| *one > 0);
        let slowest = moving.min().unwrap_or(1);
        let unit = self.duration_ticks.checked_div(slowest).unwrap_or(0);
        unit.saturating_add(3)
    }
}

impl Law {
    /// Velocity and acceleration of an axis with this way; `longest` is the velocity of the longest
    /// one.
    fn axis(self, counts: u32, longest: u32) -> (u32, u32) {
        if counts == 0 {
            return (0, 0);
        }
        if counts == self.counts {
            return (longest, self.acceleration);
        }
        // Rounded up; the quotient is at most the longest axis' acceleration, as the way is
        // shorter.
        let scaled = u64::from(self.acceleration).wrapping_mul(counts.into());
        let rounding = u64::from(self.counts).wrapping_sub(1);
        let acceleration = quotient(scaled.wrapping_add(rounding), self.counts) as u32;
        let way = product(way_units(counts), acceleration);
        let time = product(self.time, acceleration);
        // way / v + v / a <= time, times a v: 94 bits on the left with 16 for the fraction of the
        // time, 126 on the right.
        let velocity = least(longest, |velocity| {
            let square = square(velocity);
            let left = way.wrapping_add(square).wrapping_shl(16);
            // Beyond the highest velocity that the ramps reach nothing gets quicker.
            square >= way || left <= time.wrapping_mul(velocity.into())
        });
        (velocity, acceleration)
    }
}

/// Of the accelerations of the longest axis up to a sixteenth (and 64 units) below this the one
/// that needs the least rounding up for the others.
fn common(most: u32, longest: u32, distances: &[i32]) -> u32 {
    let mut best = most;
    let mut least = u32::MAX;
    // most is at least 1, and so is what is left.
    for less in 0..=(most >> 4).min(64) {
        let acceleration = most.wrapping_sub(less);
        let worst = distances.iter().map(|way| {
            let scaled = u64::from(acceleration).wrapping_mul(way.unsigned_abs().into());
            let rest = scaled.checked_rem(longest.into()).unwrap_or(0);
            // What is missing to the next multiple: below `longest`, or as much where nothing is
            // missing.
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

/// Counts in 2^-16 counts: 48 bits.
fn way_units(counts: u32) -> u64 {
    u64::from(counts) << 16
}

/// The least number from 1 to `most` for which something holds that holds for all above it up to
/// there; `most` when for none.
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
    // 2^63 and a little at most.
    u32::try_from(time.wrapping_add(0xffff) >> 16).unwrap_or(u32::MAX)
}

/// Rounded down.
fn quotient(dividend: u64, divisor: u32) -> u64 {
    dividend.checked_div(divisor.into()).unwrap_or(0)
}

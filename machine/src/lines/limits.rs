//! Limits of the axes in the units of the planner.

use husillo_gcode::PathMode;
use husillo_planner::{
    ArcLimits, JerkLimits, Junction, Stretch, Tangent, Upper, mul_div, mul_div_q16,
};

use crate::lines::tempo::{Round, Tempo};
use crate::{Axis, Config};

/// Limits of all axes, with speeds in nm/s.
#[derive(Copy, Clone, Debug)]
pub(crate) struct Limits<const N: usize> {
    timer_hz: u32,
    start: [u32; N],
    acceleration: [u64; N],
    /// Corner rules of the machine file.
    corner: Junction<N>,
}

impl<const N: usize> Limits<N> {
    /// `None` when no axis has a ramp. Every move then runs at its speed from the first step to the
    /// last.
    pub(crate) fn of(config: &Config<N>) -> Option<Limits<N>> {
        if config.axes.iter().all(|axis| axis.ramp.is_none()) {
            return None;
        }
        let narrow = |speed: u64| u32::try_from(speed).unwrap_or(u32::MAX);
        let acceleration = config.axes.map(|axis| {
            axis.ramp
                .map_or(u64::MAX, |ramp| axis.nm_per_s(ramp.acceleration_hz_per_s))
        });
        let deviation = config.corner_deviation.map(nm);
        let junctions = config
            .axes
            .map(|axis| axis.ramp.and_then(|ramp| ramp.junction_hz));
        let has_jump = junctions.iter().any(Option::is_some);
        let jump = config.axes.map(|axis| match axis.ramp {
            None => u32::MAX,
            Some(ramp) => match (ramp.junction_hz, deviation) {
                (Some(rate), _) => narrow(axis.nm_per_s(rate)),
                (None, Some(_)) => u32::MAX,
                // Nothing else would limit it.
                (None, None) => 0,
            },
        });
        Some(Limits {
            timer_hz: config.timer_hz,
            start: config.axes.map(|axis| {
                axis.ramp
                    .map_or(u32::MAX, |ramp| narrow(axis.nm_per_s(ramp.start_rate_hz)))
            }),
            acceleration,
            corner: Junction {
                jump_nm_per_s: has_jump.then_some(jump),
                // Without any rule the path stops at corners.
                deviation_nm: deviation.or(if has_jump { None } else { Some(0) }),
                acceleration_nm_per_s2: acceleration,
            },
        })
    }

    /// Highest speed from one move to the next.
    pub(crate) fn junction(&self, mode: PathMode, before: &Tangent<N>, after: &Tangent<N>) -> u32 {
        let corner = match mode {
            PathMode::ExactStop => return 0,
            // Only straight continuations and tangents pass without a stop.
            PathMode::ExactPath => Junction {
                deviation_nm: Some(0),
                ..self.corner
            },
            PathMode::Blend {
                tolerance: Some(tolerance),
            } => Junction {
                deviation_nm: Some(nm(tolerance)),
                ..self.corner
            },
            PathMode::Blend { tolerance: None } => self.corner,
        };
        corner.speed(before, after)
    }

    /// The move for the look-ahead, without its junction. `along` is its direction, or the
    /// direction of its start.
    pub(crate) fn stretch(&self, tempo: &Tempo<N>, along: &Tangent<N>) -> Stretch {
        let hz = u64::from(self.timer_hz);
        // 2^32 nm/s is the largest speed of the planner.
        let speed = |ticks_q16: u64| match ticks_q16 {
            0 => u32::MAX,
            ticks => {
                let speed = mul_div_q16(tempo.length_nm, hz, ticks);
                u32::try_from(speed).unwrap_or(u32::MAX)
            }
        };
        let ceiling = speed(tempo.pace.least_q16);
        // 2^32 - 1 for a rapid.
        let programmed = speed(tempo.pace.programmed_q16);
        let is_rapid = tempo.pace.programmed_q16 == 0;
        let stretch = Stretch {
            length_nm: tempo.length_nm,
            top_nm_per_s: programmed,
            ceiling_nm_per_s: ceiling,
            obeys_override: !is_rapid,
            acceleration_nm_per_s2: 0,
            start_nm_per_s: 0,
            upper: None,
            entry_limit_nm_per_s: 0,
        };
        let stretch = match &tempo.round {
            None => Stretch {
                acceleration_nm_per_s2: along.acceleration_limit(&self.acceleration),
                start_nm_per_s: along.speed_limit(&self.start),
                ..stretch
            },
            Some(round) => self.round_stretch(&stretch, along, round),
        };
        Stretch {
            top_nm_per_s: if is_rapid {
                stretch.ceiling_nm_per_s
            } else {
                programmed
            },
            ..stretch
        }
    }

    /// The stretch with the limits of an arc. The direction rotates in the plane, so the slower of
    /// its axes counts.
    fn round_stretch(&self, stretch: &Stretch, along: &Tangent<N>, round: &Round) -> Stretch {
        let [first, second] = round.plane;
        let share = unrolled(along, first, second);
        // At an override of 200 %.
        let highest = stretch.top_nm_per_s.saturating_mul(2);
        let highest = highest.min(stretch.ceiling_nm_per_s);
        let ArcLimits {
            speed_nm_per_s: [lower, upper],
            acceleration_nm_per_s2: accelerations,
        } = self.arc_limits(&share, round, highest);
        let ceiling = stretch.ceiling_nm_per_s.min(upper);
        let upper = if highest > lower {
            Upper::new(ceiling, lower, accelerations)
        } else {
            None
        };
        let [acceleration_nm_per_s2, _] = accelerations;
        let mut start = self.start;
        let other = start.get(second).copied().unwrap_or(u32::MAX);
        if let Some(start) = start.get_mut(first) {
            *start = other.min(*start);
        }
        Stretch {
            ceiling_nm_per_s: ceiling,
            acceleration_nm_per_s2,
            start_nm_per_s: share.speed_limit(&start),
            upper,
            ..*stretch
        }
    }

    /// The limits of an arc along its path, whose highest speed is `highest`. `share` has the whole
    /// plane in its first axis.
    fn arc_limits(&self, share: &Tangent<N>, round: &Round, highest: u32) -> ArcLimits {
        let [first, second] = round.plane;
        let of = |axis: usize| self.acceleration.get(axis).copied().unwrap_or(u64::MAX);
        let mut plane = of(first).min(of(second));
        if round.is_spiral() {
            // At its smaller radius, a spiral is faster than at the mean one in this ratio.
            plane = mul_div(plane, round.around_nm, round.fastest_nm);
        }
        let arc = ArcLimits::new(plane, round.radius_nm, highest);
        ArcLimits {
            speed_nm_per_s: arc.speed_nm_per_s.map(|speed| {
                let mut turning = [u32::MAX; N];
                if let Some(turning) = turning.get_mut(first) {
                    *turning = speed;
                }
                share.speed_limit(&turning)
            }),
            acceleration_nm_per_s2: arc.acceleration_nm_per_s2.map(|acceleration| {
                let mut limits = self.acceleration;
                if let Some(limit) = limits.get_mut(first) {
                    *limit = acceleration;
                }
                share.acceleration_limit(&limits)
            }),
        }
    }
}

impl<const N: usize> Config<N> {
    /// The limits along the path of a machine with [`SmoothRamp`](crate::SmoothRamp); `None` if no
    /// axis has a jerk.
    ///
    /// - **Acceleration**: 0.866 of the least one of the axes. It is safe in every direction, and
    ///   on an arc it leaves half of the limit for the acceleration towards the centre.
    /// - **Jerk**: the least one of the axes that have one.
    ///
    /// Limits that [`JerkWindow`](husillo_planner::JerkWindow) refuses, a window below about 0.1 ms
    /// or of seconds, are not kept: such a machine limits the acceleration only.
    pub fn jerk_limits(&self) -> Option<JerkLimits> {
        let ramps = || self.axes.iter().filter_map(|axis| Some((axis, axis.ramp?)));
        let of_axis = |(axis, rate): (&Axis, u32)| axis.nm_per_s(rate);
        let jerk = ramps()
            .filter_map(|(axis, ramp)| Some((axis, ramp.jerk_hz_per_s2?)))
            .map(of_axis)
            .min()?;
        let accelerations = ramps().map(|(axis, ramp)| (axis, ramp.acceleration_hz_per_s));
        let acceleration = accelerations.map(of_axis).min()?;
        // At most 2^40, as on arcs.
        let acceleration = acceleration.min(1 << 40).wrapping_mul(866) / 1000;
        let squared = self.axes.iter().fold(0_u64, |sum, axis| {
            let speed = axis.nm_per_s(axis.max_rate_hz).min(u32::MAX.into());
            sum.saturating_add(speed.wrapping_mul(speed))
        });
        Some(JerkLimits {
            acceleration_nm_per_s2: acceleration.max(1),
            jerk_nm_per_s3: jerk.max(1),
            // Rounded up; of 32 bits.
            highest_nm_per_s: squared.isqrt().saturating_add(1).min(u32::MAX.into()) as u32,
        })
    }
}

/// A direction whose components in a plane are combined in the first axis of the plane.
fn unrolled<const N: usize>(along: &Tangent<N>, first: usize, second: usize) -> Tangent<N> {
    let mut components = along.components();
    let of = |axis: usize| u64::from(components.get(axis).map_or(0, |of| of.unsigned_abs()));
    // Each is at most 2^30, so the sum of the squares is below 2^61.
    let [x, y] = [of(first), of(second)];
    let size = x.wrapping_mul(x).wrapping_add(y.wrapping_mul(y)).isqrt();
    if let Some(component) = components.get_mut(second) {
        *component = 0;
    }
    if let Some(component) = components.get_mut(first) {
        *component = size as i32;
    }
    Tangent::from_units(components)
}

fn nm(length: husillo_gcode::Nm) -> u32 {
    u32::try_from(length.0.max(0)).unwrap_or(u32::MAX)
}

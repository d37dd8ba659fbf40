//! Length and duration of a move.

use husillo_gcode::{Command, Feed, Nm};
use husillo_interp::{Moves, length};

use crate::lines::arc::{in_plane, is_spiral};
use crate::{Axis, Config, Segment};
use husillo_planner::{Tangent, mul_div, mul_div_q16, times};

/// Length and time of a move. They are those of the programmed path, not of the rounded steps, so
/// many moves shorter than a step take the time of their sum.
///
/// Where axes other than X, Y and Z move, the length is that of the move in all axes, with a degree
/// as a millimetre. It has no meaning but that of a common measure for the speeds of the planner.
/// Feeds and top speeds measure [`Config::fed_length`].
#[derive(Copy, Clone, Debug, Default)]
pub(crate) struct Tempo<const N: usize> {
    /// Length of the whole path.
    pub(crate) length_nm: u64,
    /// Direction of a straight path; `None` for an arc, and without a distance.
    pub(crate) along: Option<Tangent<N>>,
    /// Length of the part of it in the plane of an arc, and the radius.
    pub(crate) round: Option<Round>,
    pub(crate) pace: Pace,
}

/// The time of a move at constant speed.
#[derive(Copy, Clone, Debug, Default)]
pub(crate) struct Pace {
    /// Ticks at the programmed feed, times 2^16; 0 for a rapid.
    pub(crate) programmed_q16: u64,
    /// Least ticks allowed by the rates of the axes and the top speeds of the machine, times 2^16.
    pub(crate) least_q16: u64,
}

/// The circle of an arc.
#[derive(Copy, Clone, Debug)]
pub(crate) struct Round {
    pub(crate) plane: [usize; 2],
    pub(crate) around_nm: u64,
    /// Length that an axis would cover at the highest speed of the arc.
    pub(crate) fastest_nm: u64,
    /// The radius that limits the speed.
    pub(crate) radius_nm: u64,
}

impl Round {
    /// Whether the speed changes with the radius.
    pub(crate) const fn is_spiral(&self) -> bool {
        self.fastest_nm != self.around_nm
    }
}

impl<const N: usize> Tempo<N> {
    /// Limits the speed to the fastest of the planner, 2^32 - 1 nm/s.
    pub(crate) fn limited(mut self, timer_hz: u32) -> Self {
        if self.is_slower(timer_hz) {
            return self;
        }
        let fastest = mul_div_q16(self.length_nm, timer_hz.into(), u32::MAX.into());
        let pace = &mut self.pace;
        pace.least_q16 = pace.least_q16.max(fastest);
        if pace.programmed_q16 != 0 {
            pace.programmed_q16 = pace.programmed_q16.max(fastest);
        }
        self
    }

    /// Whether the speed is below this limit. It is usually found without a division.
    fn is_slower(&self, timer_hz: u32) -> bool {
        let Some(product) = times(self.length_nm, timer_hz.into()) else {
            return false;
        };
        // A 2^-32th part more is for the division by 2^32 - 1, and one for each rounding.
        let most = (product >> 16).wrapping_add(product >> 48).wrapping_add(2);
        let pace = &self.pace;
        pace.least_q16 >= most && (pace.programmed_q16 == 0 || pace.programmed_q16 >= most)
    }
}

impl Pace {
    /// Ticks at constant speed, rounded to nearest, at `percent` of the programmed feed.
    pub(crate) fn ticks(&self, percent: u8) -> u64 {
        let programmed_q16 = mul_div(self.programmed_q16, 100, percent.into());
        programmed_q16.max(self.least_q16).saturating_add(1 << 15) >> 16
    }
}

impl<const N: usize> Config<N> {
    /// Returns the tempo of a move on this path, with the direction of a straight one.
    pub(crate) fn tempo<P: Moves<N>>(&self, segment: &Segment<N>, path: &P) -> Tempo<N> {
        self.tempo_by(segment, path, straight)
    }

    /// The same without the direction. It takes less flash.
    pub(crate) fn pace<P: Moves<N>>(&self, segment: &Segment<N>, path: &P) -> Pace {
        self.tempo_by(segment, path, |_, _| None).pace
    }

    /// The same. `straight` returns the direction and the length between two positions, or `None`.
    fn tempo_by<P: Moves<N>>(
        &self,
        segment: &Segment<N>,
        path: &P,
        straight: impl FnOnce(&[Nm; N], &[Nm; N]) -> Option<(Tangent<N>, u64)>,
    ) -> Tempo<N> {
        let hz = u64::from(self.timer_hz);
        let (feed, to) = match &segment.command {
            Command::Rapid { to } => (None, to),
            Command::Linear { to, feed } | Command::Probe { to, feed, .. } => (Some(feed), to),
            Command::Thread { to, .. } => (None, to),
            Command::Arc { arc, feed } => (Some(feed), &arc.to),
            _ => return Tempo::default(),
        };
        // The circle of an arc; an arc that is too small is the line between its ends.
        let round = self.round(segment, path);
        let is_round = |number: usize| round.is_some_and(|round| round.plane.contains(&number));
        // No axis exceeds its step rate on average over the move.
        let mut least_q16 = 0;
        let mut ways = [0; N];
        // An axis that is like the first one and has a shorter way does not count: each division
        // takes a thousand instructions on a Cortex-M0.
        let mut longest = 0;
        let axes = segment.from.iter().zip(to).zip(&self.axes);
        for ((number, straight), ((from, to), axis)) in (0..N).zip(&mut ways).zip(axes) {
            let way = match &round {
                // Somewhere on a quarter turn one axis has the full path speed.
                Some(round) if is_round(number) => round.fastest_nm,
                _ => {
                    *straight = to.0.abs_diff(from.0);
                    *straight
                }
            };
            let is_alike = self.axes.first().is_some_and(|first| {
                first.scale == axis.scale && first.max_rate_hz == axis.max_rate_hz
            });
            if is_alike && way <= longest {
                continue;
            }
            if is_alike {
                longest = way;
            }
            least_q16 = axis.least_q16(way, hz).max(least_q16);
        }
        let mut around = round.map_or(0, |round| round.around_nm);
        if let (Command::Arc { arc, .. }, None) = (&segment.command, round) {
            // Whole turns that are too small for the grid still take their time; pi is 355 / 113.
            let flat = in_plane(&segment.from, arc);
            let turns = u64::from(arc.turns).saturating_add(u64::from(flat.from == flat.to));
            let [rim, _] = flat.radii();
            around = mul_div(times(rim, turns).unwrap_or(u64::MAX), 710, 113);
        }
        // The root of the length gives the direction as well.
        let straight = match round {
            Some(_) => None,
            None => straight(&segment.from, to),
        };
        let length_nm = match straight {
            Some((_, length_nm)) if around == 0 => length_nm,
            _ => length(&ways, around),
        };
        let fed_nm = self.fed_length(&ways, around, length_nm);
        let (programmed_q16, top) = match feed {
            Some(feed) => (ticks_q16(feed, fed_nm, hz), self.top_feed),
            None => (0, self.rapid),
        };
        let at_top = top.map_or(0, |top| ticks_q16(&Feed::PerMinute(top), fed_nm, hz));
        Tempo {
            length_nm,
            along: straight.map(|(along, _)| along),
            round,
            pace: Pace {
                programmed_q16,
                least_q16: least_q16.max(at_top),
            },
        }
    }

    /// The length that a feed measures, of a move that covers these lengths in its axes and
    /// `around` in the plane of an arc; `whole` is the length in all axes. See [`Axes::fed`].
    ///
    /// [`Axes::fed`]: husillo_gcode::Axes::fed
    fn fed_length(&self, ways: &[u64; N], around: u64, whole: u64) -> u64 {
        if N <= 3 {
            return whole;
        }
        let mut fed = *ways;
        // An arc is one of X, Y and Z. Where it is too small for the grid, nothing may move.
        if let (true, Some(first)) = (around != 0, fed.first_mut()) {
            *first = (*first).max(1);
        }
        let axes = self.dialect.axes().fed(&fed);
        let mut bit = 1_u8;
        for (fed, way) in fed.iter_mut().zip(ways) {
            *fed = if axes & bit != 0 { *way } else { 0 };
            bit = bit.wrapping_shl(1);
        }
        length(&fed, around)
    }

    /// Mask of the axes of a circle; none where their steps differ.
    pub(crate) fn circle_axes(&self, plane: [usize; 2]) -> u8 {
        let [first, second] = plane.map(|number| self.axes.get(number).map(|axis| axis.scale));
        if first != second {
            return 0;
        }
        plane
            .into_iter()
            .fold(0, |axes, number| axes | 1_u8.wrapping_shl(number as u32))
    }

    fn round<P: Moves<N>>(&self, segment: &Segment<N>, path: &P) -> Option<Round> {
        let Command::Arc { arc, .. } = &segment.command else {
            return None;
        };
        let plane = arc.plane.axes();
        let [first, _] = plane.map(|number| self.axes.get(number));
        let scale = first?.scale;
        let mut flat = in_plane(&segment.from, arc);
        if P::HAS_ELLIPSES {
            flat = self.made_arc(&flat, arc).ok()??;
        }
        let [radius_nm, end_nm] = flat.radii();
        // The swept area divided by the radius is the length of the arc in steps.
        let around_nm = mul_div(
            path.total_sweep(),
            u64::from(scale.nm()),
            times(path.radius()?, scale.steps().into()).unwrap_or(u64::MAX),
        );
        let round = Round {
            plane,
            around_nm,
            fastest_nm: around_nm,
            radius_nm,
        };
        if !is_spiral(&flat, scale) {
            return Some(round);
        }
        // A spiral sweeps an equal area in each second, so its speed is highest at the smaller
        // radius s: m / s times that at the mean radius m. There v^2 m^2 / s^3 is the acceleration.
        // Its steps are also more uneven than those of a circle: by less than 7 / 5, the most that
        // some thousand spirals of 5 um showed.
        let (smaller, mean) = (radius_nm.min(end_nm), radius_nm.midpoint(end_nm).max(1));
        let share = |value: u64| mul_div(value, smaller, mean);
        Some(Round {
            fastest_nm: mul_div(
                around_nm,
                mean.saturating_mul(7),
                smaller.saturating_mul(5).max(1),
            ),
            radius_nm: share(share(smaller)),
            ..round
        })
    }
}

impl<const N: usize> Config<N> {
    /// Encoder counts of a move that follows the spindle, times 2^16.
    pub(crate) fn counts_q16(&self, segment: &Segment<N>, tempo: &Tempo<N>) -> Option<u64> {
        let lead = match &segment.command {
            Command::Thread { lead, .. } => lead,
            Command::Linear {
                feed: Feed::PerRevolution(lead),
                ..
            }
            | Command::Arc {
                feed: Feed::PerRevolution(lead),
                ..
            } => lead,
            _ => return None,
        };
        let counts = u64::from(self.spindle_counts?);
        let mut ways = [0; N];
        let to = segment.command.end()?;
        for ((number, way), (from, to)) in (0..N).zip(&mut ways).zip(segment.from.iter().zip(to)) {
            let round = tempo.round.as_ref();
            if !round.is_some_and(|round| round.plane.contains(&number)) {
                *way = to.0.abs_diff(from.0);
            }
        }
        let around = tempo.round.map_or(0, |round| round.around_nm);
        let fed_nm = self.fed_length(&ways, around, tempo.length_nm);
        Some(mul_div_q16(fed_nm, counts, lead.0.unsigned_abs()))
    }
}

impl Axis {
    /// Least ticks of a timer of `hz` for this axis to cover a distance in nanometres, times 2^16.
    fn least_q16(&self, way_nm: u64, hz: u64) -> u64 {
        // nm and rate are below 2^32 each.
        let nm_per_s = u64::from(self.scale.nm()).wrapping_mul(u64::from(self.max_rate_hz));
        let way = times(way_nm, self.scale.steps().into()).unwrap_or(u64::MAX);
        match mul_div_q16(way, hz, nm_per_s) {
            0 => 0,
            // Rounded up: a short move must not exceed the rate by rounding.
            ticks => ticks.saturating_add(1),
        }
    }
}

/// Direction and length of the line between two positions; `None` if they are equal.
fn straight<const N: usize>(from: &[Nm; N], to: &[Nm; N]) -> Option<(Tangent<N>, u64)> {
    let mut ways = [0; N];
    for (way, (from, to)) in ways.iter_mut().zip(from.iter().zip(to)) {
        *way = to.0.saturating_sub(from.0);
    }
    Tangent::with_length(ways)
}

/// Ticks of a path of this length at the programmed feed, times 2^16.
fn ticks_q16(feed: &Feed, length_nm: u64, hz: u64) -> u64 {
    match feed {
        // 60 hz < 2^38.
        Feed::PerMinute(Nm(nm)) => mul_div_q16(length_nm, hz.wrapping_mul(60), nm.unsigned_abs()),
        Feed::InverseTime { micro_per_minute } => mul_div_q16(60_000_000, hz, *micro_per_minute),
        // The spindle determines the time.
        Feed::PerRevolution(_) => 0,
    }
}

//! The rules.

use husillo_machine::planner::{JerkLimits, JerkLimitsError, JerkWindow, LookAhead, Stretch};
use serde::Serialize;

use crate::motion::chords::{Chords, MM, Turn, change};
use crate::motion::course::Course;
use crate::motion::junctions::Corner;
use crate::motion::profile::{Piece, Profile};

/// A rule by which the speed along a path is chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Rule {
    /// The rule of `machine`: limited acceleration, arcs within the acceleration of the axes.
    Trapezoid,
    /// `planner::JerkWindow`: limited acceleration and jerk.
    Jerk,
    /// Grbl: arcs as chords, corners by junction deviation.
    Grbl,
    /// Klipper: arcs as chords, corners by square corner velocity.
    Klipper,
}

impl Rule {
    /// All rules.
    pub const ALL: [Rule; 4] = [Rule::Trapezoid, Rule::Jerk, Rule::Grbl, Rule::Klipper];

    /// Its name on the command line and in tables.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Rule::Trapezoid => "trapezoid",
            Rule::Jerk => "jerk",
            Rule::Grbl => "grbl",
            Rule::Klipper => "klipper",
        }
    }
}

/// What the machine file does not say.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Window of the jerk rule in s; `None` for that of the machine, which has a jerk.
    pub window: Option<f64>,
    /// Junction deviation of Grbl in mm.
    pub deviation: f64,
    /// Arc tolerance of Grbl in mm.
    pub arc_tolerance: f64,
    /// Square corner velocity of Klipper in mm/s.
    pub square_corner: f64,
    /// Length of Klipper's chords of arcs in mm.
    pub chord: f64,
}

impl Default for Settings {
    /// The defaults of both controllers, and a window of 20 ms.
    fn default() -> Self {
        Settings {
            window: Some(0.02),
            deviation: 0.01,
            arc_tolerance: 0.002,
            square_corner: 5.0,
            chord: 1.0,
        }
    }
}

/// A straight part of a path, or an arc, with limits; in mm and s.
#[derive(Clone, Copy, Debug)]
struct Leg {
    length: f64,
    top: f64,
    /// Accelerations below and above the speed `knee`.
    accelerations: [f64; 2],
    knee: f64,
    /// Speed that needs no ramp.
    start: f64,
    radius: f64,
}

/// Moves in the queues of our rules.
const QUEUE: usize = 512;

impl<const N: usize> Course<N> {
    /// The speed along the program under a rule.
    ///
    /// # Errors
    ///
    /// The window does not suit the accelerations.
    pub fn profile(&self, rule: Rule, settings: &Settings) -> Result<Profile, JerkLimitsError> {
        Ok(match rule {
            Rule::Trapezoid => self.trapezoid(),
            Rule::Jerk => self.jerk(settings.window)?,
            Rule::Grbl => {
                let tolerance = settings.arc_tolerance;
                let count = |around: f64, radius: f64| {
                    let chord = (tolerance * (2.0 * radius - tolerance)).max(1e-12).sqrt();
                    (0.5 * around / chord).floor()
                };
                self.peer(count, |corner| corner.by_deviation(settings.deviation))
            }
            Rule::Klipper => {
                let count = |around: f64, _| (around / settings.chord).floor();
                let speed = settings.square_corner;
                self.peer(count, |corner| corner.by_square_corner(speed))
            }
        })
    }

    /// The end speeds are those of the queue of the machine.
    fn trapezoid(&self) -> Profile {
        let mut queue = Box::new(LookAhead::<usize, QUEUE>::new());
        let turns = self.turns();
        let mut profile = Profile::default();
        let (mut next, mut speed) = (0, 0.0);
        loop {
            while next < self.moves.len() && queue.push(self.moves[next].stretch, next).is_ok() {
                next += 1;
            }
            let Some((_, number)) = queue.front() else {
                return profile;
            };
            let number = *number;
            let leg = leg(&self.moves[number].stretch, turns[number].radius);
            self.pass(&mut profile, &turns, number, speed);
            // A start speed is reached and left at once.
            let begin = speed.max(leg.start).min(leg.top);
            profile.jump = profile.jump.max((begin - speed).abs());
            let exit = (queue.limits().exit_squared as f64).sqrt() * MM;
            speed = leg.pass(&mut profile.pieces, begin, exit);
            queue.pop();
        }
    }

    /// Records a junction of our rules.
    fn pass(&self, profile: &mut Profile, turns: &[Turn<N>], number: usize, speed: f64) {
        if let Some(before) = number.checked_sub(1) {
            let top = |number: usize| f64::from(self.moves[number].stretch.top_at(100)) * MM;
            let turn = change(&turns[before].last, &turns[number].first);
            profile
                .junctions
                .push([speed, top(before).min(top(number))]);
            profile.jump = profile.jump.max(speed * turn);
        }
    }

    /// The limits of the machine along its path; `window` replaces its jerk.
    fn jerk_limits(&self, window: Option<f64>) -> JerkLimits {
        let mut config = self.config;
        if window.is_some() {
            for ramp in config.axes.iter_mut().filter_map(|axis| axis.ramp.as_mut()) {
                ramp.jerk_hz_per_s2 = Some(1);
            }
        }
        let limits = config.jerk_limits().unwrap_or(JerkLimits {
            acceleration_nm_per_s2: 1,
            jerk_nm_per_s3: 1,
            highest_nm_per_s: 1,
        });
        let acceleration = limits.acceleration_nm_per_s2 as f64;
        JerkLimits {
            jerk_nm_per_s3: window.map_or(limits.jerk_nm_per_s3, |window| {
                (acceleration / window).max(1.0) as u64
            }),
            ..limits
        }
    }

    fn jerk(&self, window: Option<f64>) -> Result<Profile, JerkLimitsError> {
        let limits = self.jerk_limits(window);
        let mut queue = Box::new(JerkWindow::<usize, QUEUE>::new(&limits)?);
        let unit = MM / f64::from(queue.units_per_nm());
        let turns = self.turns();
        let mut profile = Profile::default();
        // The move in which the path is, and the rest of its path in units.
        let (mut next, mut at) = (0, 0);
        let units = f64::from(queue.units_per_nm());
        let length = |at: usize| {
            let planned = self.moves.get(at);
            planned.map_or(0.0, |planned| planned.stretch.length_nm as f64 * units)
        };
        let mut left = length(0);
        loop {
            while next < self.moves.len() && queue.push(self.moves[next].stretch, next).is_ok() {
                next += 1;
            }
            let Some(slice) = queue.next_slice() else {
                return Ok(profile);
            };
            // A timer of 1 GHz.
            let seconds = queue.slice_ticks_q32(1_000_000_000) as f64 / 2_f64.powi(32) / 1e9;
            let piece = Piece {
                seconds,
                speed: slice.speed as f64 * unit / seconds,
                acceleration: 2.0 * slice.bend as f64 * unit / seconds.powi(2),
                jerk: 6.0 * f64::from(slice.twist) * unit / seconds.powi(3),
                radius: turns.get(at).map_or(f64::INFINITY, |turn| turn.radius),
            };
            profile.pieces.push(piece);
            let path = slice.length() as f64;
            let mut passed = 0.0;
            while at + 1 < self.moves.len() && left <= path - passed {
                passed += left;
                at += 1;
                left = length(at);
                queue.pop();
                let speed = piece.speed_at(piece.seconds_to(passed * unit));
                self.pass(&mut profile, &turns, at, speed);
            }
            left -= path - passed;
        }
    }

    /// Chords with the corners of another rule, and the axes of the machine.
    fn peer(
        &self,
        count: impl Fn(f64, f64) -> f64,
        corner: impl Fn(&Corner<'_>) -> f64,
    ) -> Profile {
        let nm = |rate: u32, axis: usize| {
            let scale = self.config.axes[axis].scale;
            f64::from(rate) * f64::from(scale.nm()) / f64::from(scale.steps()) * MM
        };
        let axes: [f64; N] = std::array::from_fn(|axis| {
            let ramp = self.config.axes[axis].ramp;
            ramp.map_or(f64::INFINITY, |ramp| nm(ramp.acceleration_hz_per_s, axis))
        });
        let rates: [f64; N] =
            std::array::from_fn(|axis| nm(self.config.axes[axis].max_rate_hz, axis));
        let mut legs: Vec<(Leg, [f64; N], f64)> = Vec::new();
        for (number, planned) in self.moves.iter().enumerate() {
            let is_part = number > 0 && self.moves[number - 1].segment == planned.segment;
            if is_part && !self.rests[number] {
                continue;
            }
            let chords = Chords::of(&planned.segment, &count);
            let top = f64::from(planned.stretch.top_nm_per_s) * MM;
            for (chord, way) in chords.directions.iter().enumerate() {
                let acceleration = along(&axes, way);
                let leg = Leg {
                    length: chords.length,
                    top: top.min(along(&rates, way)),
                    accelerations: [acceleration; 2],
                    knee: f64::INFINITY,
                    start: 0.0,
                    radius: chords.radius,
                };
                let limit = match legs.last() {
                    Some((before, direction, _)) if chord > 0 || !self.rests[number] => {
                        let corner = corner(&Corner {
                            before: direction,
                            after: way,
                            lengths: [before.length, leg.length],
                            accelerations: [before.accelerations[0], acceleration],
                            axes: &axes,
                        });
                        corner.min(before.top).min(leg.top)
                    }
                    _ => 0.0,
                };
                legs.push((leg, *way, limit));
            }
        }
        walk(&legs)
    }
}

/// Speeds along legs with limited acceleration; each has its direction and the highest speed at its
/// start.
fn walk<const N: usize>(legs: &[(Leg, [f64; N], f64)]) -> Profile {
    let mut speeds = vec![0.0_f64; legs.len() + 1];
    for (number, (leg, _, limit)) in legs.iter().enumerate().rev() {
        let reach = 2.0 * leg.accelerations[0] * leg.length;
        speeds[number] = limit.min((speeds[number + 1].powi(2) + reach).sqrt());
    }
    let mut profile = Profile::default();
    let mut speed = 0.0;
    for (number, (leg, way, _)) in legs.iter().enumerate() {
        if let Some((before, direction, _)) = number.checked_sub(1).map(|before| &legs[before]) {
            profile.junctions.push([speed, before.top.min(leg.top)]);
            profile.jump = profile.jump.max(speed * change(direction, way));
        }
        speed = leg.pass(&mut profile.pieces, speed, speeds[number + 1]);
    }
    profile
}

/// The largest value along a direction that keeps the limit of each axis.
fn along(limits: &[f64], way: &[f64]) -> f64 {
    let axes = limits.iter().zip(way);
    axes.map(|(limit, part)| limit / part.abs())
        .fold(f64::INFINITY, f64::min)
}

fn leg(stretch: &Stretch, radius: f64) -> Leg {
    let (accelerations, knee) = stretch.levels();
    Leg {
        length: stretch.length_nm as f64 * MM,
        top: f64::from(stretch.top_at(100)) * MM,
        accelerations: accelerations.map(|limit| limit as f64 * MM),
        knee: f64::from(knee) * MM,
        start: f64::from(stretch.start_nm_per_s) * MM,
        radius,
    }
}

impl Leg {
    /// Path from one speed to a higher one.
    fn ramp(&self, low: f64, high: f64) -> f64 {
        let [below, above] = [low, high].map(|speed| speed.min(self.knee));
        let [from, to] = [low, high].map(|speed| speed.max(self.knee));
        let lower = (above * above - below * below) / (2.0 * self.accelerations[0]);
        if to > from {
            lower + (to * to - from * from) / (2.0 * self.accelerations[1])
        } else {
            lower
        }
    }

    /// Passes the leg from one speed to another, as fast as possible. Returns the speed at its end.
    fn pass(&self, pieces: &mut Vec<Piece>, start: f64, end: f64) -> f64 {
        // The highest speed, by bisection; a speed that cannot be reached is lowered.
        let top = self.top.max(start);
        let fits = |peak: f64| self.ramp(start, peak) + self.ramp(end.min(peak), peak);
        let (mut low, mut high) = (start, top);
        if fits(top) > self.length {
            for _ in 0..60 {
                let middle = (low + high) / 2.0;
                if fits(middle) > self.length {
                    high = middle;
                } else {
                    low = middle;
                }
            }
        } else {
            low = top;
        }
        let (peak, end) = (low, end.min(low));
        self.change(pieces, start, peak, 1.0);
        let level = self.length - fits(peak);
        if level > 0.0 && peak > 0.0 {
            self.add(pieces, level / peak, peak, 0.0);
        }
        self.change(pieces, peak, end, -1.0);
        end
    }

    /// Adds a change of speed, with both accelerations.
    fn change(&self, pieces: &mut Vec<Piece>, from: f64, to: f64, sign: f64) {
        let mut at = from;
        let passes = self.knee > from.min(to) && self.knee < from.max(to);
        for next in [if passes { self.knee } else { to }, to] {
            let seconds_speed = (next - at).abs();
            let is_upper = at.min(next) >= self.knee;
            let acceleration = self.accelerations[usize::from(is_upper)];
            if seconds_speed > 0.0 {
                self.add(
                    pieces,
                    seconds_speed / acceleration,
                    at,
                    sign * acceleration,
                );
            }
            at = next;
        }
    }

    fn add(&self, pieces: &mut Vec<Piece>, seconds: f64, speed: f64, acceleration: f64) {
        pieces.push(Piece {
            seconds,
            speed,
            acceleration,
            jerk: 0.0,
            radius: self.radius,
        });
    }
}

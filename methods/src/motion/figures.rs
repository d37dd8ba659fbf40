//! Figures of a profile.

use husillo_machine::planner::JerkLimitsError;
use serde::Serialize;

use crate::motion::course::Course;
use crate::motion::profile::Profile;
use crate::motion::rules::{Rule, Settings};

/// Figures of one rule.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Figures {
    /// The rule.
    pub rule: Rule,
    /// Duration of all moves in s.
    pub seconds: f64,
    /// Highest speed in mm/s.
    pub top_speed: f64,
    /// Largest acceleration along the path in mm/s^2.
    pub acceleration: f64,
    /// Largest acceleration along the path and towards the centre of arcs in mm/s^2.
    pub whole_acceleration: f64,
    /// Largest jump of the acceleration along the path in mm/s^2.
    pub acceleration_jump: f64,
    /// Largest jerk along the path in mm/s^3; `None` if the acceleration jumps.
    pub jerk: Option<f64>,
    /// Largest jump of the velocity at a junction in mm/s.
    pub corner_jump: f64,
    /// Junctions of moves or chords.
    pub junctions: usize,
    /// Junctions that are passed at less than half of the lower top speed beside them.
    pub dips: usize,
    /// Junctions at which the path stops.
    pub stops: usize,
}

impl Figures {
    /// The figures of a profile.
    #[must_use]
    pub fn of(rule: Rule, profile: &Profile) -> Figures {
        let mut figures = Figures {
            rule,
            seconds: profile.seconds(),
            top_speed: 0.0,
            acceleration: 0.0,
            whole_acceleration: 0.0,
            acceleration_jump: 0.0,
            jerk: None,
            corner_jump: profile.jump,
            junctions: profile.junctions.len(),
            dips: 0,
            stops: 0,
        };
        let (mut jerk, mut before) = (0.0_f64, 0.0);
        for piece in &profile.pieces {
            for time in [0.0, piece.seconds / 2.0, piece.seconds] {
                let speed = piece.speed_at(time);
                let acceleration = piece.acceleration_at(time).abs();
                let whole = piece.whole_acceleration_at(time);
                figures.top_speed = figures.top_speed.max(speed);
                figures.acceleration = figures.acceleration.max(acceleration);
                figures.whole_acceleration = figures.whole_acceleration.max(whole);
            }
            let jump = (piece.acceleration - before).abs();
            figures.acceleration_jump = figures.acceleration_jump.max(jump);
            before = piece.acceleration_at(piece.seconds);
            jerk = jerk.max(piece.jerk.abs());
        }
        figures.acceleration_jump = figures.acceleration_jump.max(before.abs());
        // A millionth is rounding.
        if figures.acceleration_jump <= 1e-6 * figures.acceleration {
            figures.acceleration_jump = 0.0;
            figures.jerk = Some(jerk);
        }
        for [speed, top] in &profile.junctions {
            figures.dips += usize::from(*speed < 0.5 * top);
            figures.stops += usize::from(*speed < 1e-3);
        }
        figures
    }
}

/// Profiles and figures of all rules.
///
/// # Errors
///
/// The window does not suit the accelerations.
pub fn compare<const N: usize>(
    course: &Course<N>,
    settings: &Settings,
) -> Result<Vec<(Figures, Profile)>, JerkLimitsError> {
    let one = |rule| {
        let profile = course.profile(rule, settings)?;
        Ok((Figures::of(rule, &profile), profile))
    };
    Rule::ALL.into_iter().map(one).collect()
}

//! Rules of motion, compared.

mod page;
mod text;

use husillo_methods::motion::{Figures, Profile};

pub use page::html;
pub use text::print;

/// One program under all rules.
#[derive(Clone, Debug)]
pub struct Motion {
    /// Program and machine.
    pub title: String,
    /// The rules, with what they make of it.
    pub rules: Vec<(Figures, Profile)>,
    /// What was left out.
    pub notes: Vec<String>,
}

/// Titles of the columns, and the figures of a rule in them.
const TITLES: [&str; 10] = [
    "rule",
    "time",
    "ratio",
    "top speed, mm/s",
    "acceleration, mm/s^2",
    "with arcs, mm/s^2",
    "jerk, mm/s^3",
    "corner jump, mm/s",
    "dips",
    "stops",
];

impl Motion {
    fn rows(&self) -> impl Iterator<Item = [String; 10]> {
        let first = self.rules.first().map_or(1.0, |(first, _)| first.seconds);
        self.rules.iter().map(move |(of, _)| {
            let share = |part: usize| format!("{part} of {}", of.junctions);
            [
                of.rule.name().to_owned(),
                crate::text::duration(of.seconds),
                format!("{:.3}", of.seconds / first),
                format!("{:.1}", of.top_speed),
                format!("{:.0}", of.acceleration),
                format!("{:.0}", of.whole_acceleration),
                of.jerk
                    .map_or("no limit".to_owned(), |jerk| format!("{jerk:.0}")),
                format!("{:.2}", of.corner_jump),
                share(of.dips),
                share(of.stops),
            ]
        })
    }
}

/// What the columns mean.
const MEANING: [&str; 5] = [
    "The rules know all moves ahead. They have the accelerations and rates of the machine file.",
    "with arcs: largest acceleration along the path and towards the centre of arcs together.",
    "corner jump: largest change of the velocity at a junction.",
    "dips: junctions at less than half of the lower programmed speed beside them.",
    "grbl and klipper make chords of arcs, with the default settings of these controllers.",
];

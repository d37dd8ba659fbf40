//! Corner speeds by the rules of other controllers.

use crate::motion::chords::{change, cosine};

/// What a rule knows of two chords that meet.
pub(crate) struct Corner<'a> {
    pub(crate) before: &'a [f64],
    pub(crate) after: &'a [f64],
    /// Length and acceleration of both.
    pub(crate) lengths: [f64; 2],
    pub(crate) accelerations: [f64; 2],
    /// Acceleration of each axis.
    pub(crate) axes: &'a [f64],
}

impl Corner<'_> {
    /// Sine of half the angle between the chords; 1 straight on.
    fn half_sine(&self) -> f64 {
        let cosine = -cosine(self.before, self.after);
        (0.5 * (1.0 - cosine)).max(0.0).sqrt()
    }

    /// Grbl 1.1: a circle that is `deviation` from the corner, with the acceleration that the axes
    /// have in the direction of the change.
    ///
    /// # Source
    /// S. K. Jeon, junction deviation; Grbl 1.1h, `planner.c`.
    pub(crate) fn by_deviation(&self, deviation: f64) -> f64 {
        let cosine = -cosine(self.before, self.after);
        if cosine > 0.999_999 {
            return 0.0;
        }
        if cosine < -0.999_999 {
            return f64::INFINITY;
        }
        let size = change(self.before, self.after);
        let axes = self.before.iter().zip(self.after).zip(self.axes);
        let acceleration = axes
            .map(|((before, after), limit)| limit * size / (after - before).abs())
            .fold(f64::INFINITY, f64::min);
        let sine = self.half_sine();
        (acceleration * deviation * sine / (1.0 - sine)).sqrt()
    }

    /// Klipper: the speed at a right angle is given; other corners follow by the deviation that it
    /// has. The circle must also touch the middles of both chords.
    ///
    /// # Source
    /// Klipper, `docs/Kinematics.md` and `klippy/toolhead.py`.
    pub(crate) fn by_square_corner(&self, speed: f64) -> f64 {
        let sine = self.half_sine();
        let cosine = (1.0 - sine * sine).max(0.0).sqrt();
        if sine >= 1.0 || cosine <= 0.0 {
            return f64::INFINITY;
        }
        let ratio = sine / (1.0 - sine);
        let tangent = sine / cosine;
        let squares = self
            .accelerations
            .iter()
            .zip(self.lengths)
            .map(|(a, length)| {
                let deviation = speed * speed * (2.0_f64.sqrt() - 1.0) / a;
                (ratio * deviation * a).min(0.5 * length * a * tangent)
            });
        squares.fold(f64::INFINITY, f64::min).sqrt()
    }
}

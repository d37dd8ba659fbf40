//! The backlash of the screws over the work area.

use super::measured::{Choice, MeasuredBacklash, backlash_values};
use super::{MIDDLE_MM, TRUE_STEP, nm};
use crate::least_squares::least_squares;
use husillo_sim::BacklashField;
use std::fmt;
use std::sync::Arc;

/// Backlash of one screw in um: `a + b u + c u^2 + d v + e v^2`, with u and v in mm from the middle
/// of the work area along the own and the other axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Screw {
    /// a to e.
    pub terms: [f64; 5],
}

impl Screw {
    /// The backlash at a position from the middle of the work area.
    #[must_use]
    pub fn backlash_um(&self, own_mm: f64, other_mm: f64) -> f64 {
        let powers = powers(own_mm, other_mm);
        self.terms.iter().zip(powers).map(|(a, b)| a * b).sum()
    }
}

impl fmt::Display for Screw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [a, b, c, d, e] = self.terms;
        write!(f, "{a:.1} {b:+.2} u {c:+.2} u^2 {d:+.2} v {e:+.2} v^2 um")
    }
}

fn powers(own_mm: f64, other_mm: f64) -> [f64; 5] {
    [1.0, own_mm, own_mm * own_mm, other_mm, other_mm * other_mm]
}

/// The screws of X and Y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Screws {
    axes: [Screw; 2],
}

impl Screws {
    /// The screws of the original, fitted to its measured backlash values by least squares.
    #[must_use]
    pub fn fitted() -> Self {
        Self::of(&Choice::BEST)
    }

    /// The screws that fit the backlash values of a choice.
    pub(super) fn of(choice: &Choice) -> Self {
        let values = backlash_values(choice);
        let axes = [0, 1].map(|axis| {
            let own = values.iter().filter(|value| value.axis == axis);
            let rows = own.map(|play| (row(play), play.backlash_um));
            // There are 12 backlash values of each axis, at positions that determine five terms.
            let terms = least_squares(rows, [true; 5]).unwrap_or_default();
            Screw { terms }
        });
        Self { axes }
    }

    /// Screws with the same backlash everywhere, um.
    #[must_use]
    pub fn even(backlash_um: [f64; 2]) -> Self {
        let axes = backlash_um.map(|um| Screw {
            terms: [um, 0.0, 0.0, 0.0, 0.0],
        });
        Self { axes }
    }

    /// The screws of X and Y.
    #[must_use]
    pub const fn axes(&self) -> &[Screw; 2] {
        &self.axes
    }

    /// The backlash in true steps, by the position of the tool in true steps from the home
    /// switches.
    #[must_use]
    pub fn field(&self) -> Arc<dyn BacklashField<3>> {
        let [x_screw, y_screw] = self.axes;
        let step_nm = nm(TRUE_STEP);
        let step_um = step_nm / 1e3;
        Arc::new(move |[x, y, _]: [f64; 3]| {
            let x = x * step_nm / 1e6 - MIDDLE_MM[0];
            let y = y * step_nm / 1e6 - MIDDLE_MM[1];
            let backlash = [x_screw.backlash_um(x, y), y_screw.backlash_um(y, x)];
            let [x, y] = backlash.map(|um| um.max(0.0) / step_um);
            [x, y, 0.0]
        })
    }
}

fn row(play: &MeasuredBacklash) -> [f64; 5] {
    powers(play.at_mm[play.axis], play.at_mm[1 - play.axis])
}

#[cfg(test)]
mod tests {
    use super::super::LEFT_UM;
    use super::*;

    /// Five terms fit twelve backlash values. The residual of each is at most what remained
    /// according to the original, 33 and 27 um.
    #[test]
    fn every_measured_play_is_within_the_stated_rest() {
        let screws = Screws::fitted();
        let mut squares = [0.0; 2];
        for play in backlash_values(&Choice::BEST) {
            let [own, other] = [play.axis, 1 - play.axis].map(|axis| play.at_mm[axis]);
            let off = screws.axes()[play.axis].backlash_um(own, other) - play.backlash_um;
            assert!(off.abs() < 0.7 * LEFT_UM[play.axis], "{play:?}: {off}");
            squares[play.axis] += off * off / 12.0;
        }
        let [x, y] = squares.map(f64::sqrt);
        assert!(x < 10.0 && y < 8.0, "{x} {y}");
    }

    #[test]
    fn the_field_is_the_play_in_steps() {
        let screws = Screws::fitted();
        let steps = |mm: f64| mm * 1e6 / nm(TRUE_STEP);
        let [x, y, z] = screws
            .field()
            .backlash_steps([steps(6.0), steps(3.0), 0.0])
            .map(|steps| steps * nm(TRUE_STEP) / 1e3);
        assert!((x - screws.axes()[0].backlash_um(1.0, -0.5)).abs() < 1e-9);
        assert!((y - screws.axes()[1].backlash_um(-0.5, 1.0)).abs() < 1e-9);
        assert_eq!(z, 0.0);
    }
}

//! Values that were measured on the original mill.

use super::{FIRST_TAKE_UP_UM, LAST_TAKE_UP_UM, MIDDLE_MM, scale};

/// A row of table 13: two lines that are joined at one end.
#[derive(Clone, Copy, Debug)]
pub struct Region {
    pub name: &'static str,
    /// 0 for X, 1 for Y.
    pub axis: usize,
    /// Third of the work area across the lines, from its middle: -1 to 1.
    pub third: f64,
    pub programmed_mm: f64,
    pub measured_mm: f64,
    pub backlash_um: f64,
}

const fn region(
    name: &'static str,
    (axis, third): (usize, f64),
    [programmed_mm, measured_mm, backlash_um]: [f64; 3],
) -> Region {
    Region {
        name,
        axis,
        third,
        programmed_mm,
        measured_mm,
        backlash_um,
    }
}

/// Table 13. The thirds count from the left and from the top. With this choice the backlash values
/// of all tables agree best.
pub const REGIONS: [Region; 6] = [
    region("A: X in H1", (0, 1.0), [2.5, 2.509, 190.0]),
    region("B: X in H2", (0, 0.0), [2.5, 2.503, 201.0]),
    region("C: X in H3", (0, -1.0), [2.5, 2.502, 187.0]),
    region("D: Y in V1", (1, -1.0), [1.2, 1.205, 152.0]),
    region("E: Y in V2", (1, 0.0), [1.2, 1.203, 180.0]),
    region("F: Y in V3", (1, 1.0), [1.2, 1.199, 173.0]),
];

/// Side of the squares of table 14, mm.
pub const SQUARE_MM: f64 = 2.5;

/// A row of table 14. `left_um` is positive if the backlash is larger than the take-up.
#[derive(Clone, Copy, Debug)]
pub struct Square {
    pub name: &'static str,
    pub size_mm: [f64; 2],
    pub left_um: [f64; 2],
    /// Middle of the square from the middle of the work area, mm.
    pub at_mm: [f64; 2],
}

/// Table 14. The original prints the remaining backlash without a sign. Y of the first square is
/// larger than programmed, so the take-up there was larger than the backlash. It is assumed that
/// the squares lie in the thirds of the work area from upper left to lower right, because there
/// their backlash values of Y equal those of table 13. A square is higher than a third of the area,
/// so it lies as far within its third as the run-up allows.
pub const SQUARES: [Square; 3] = [
    Square {
        name: "X",
        size_mm: [2.489, 2.519],
        left_um: [12.0, -19.0],
        at_mm: [-10.0 / 3.0, 2.0],
    },
    Square {
        name: "Y",
        size_mm: [2.484, 2.497],
        left_um: [17.0, 5.0],
        at_mm: [0.0, 0.0],
    },
    Square {
        name: "Z",
        size_mm: [2.497, 2.494],
        left_um: [6.0, 5.0],
        at_mm: [10.0 / 3.0, -2.0],
    },
];

/// A circle of table 15.
#[derive(Clone, Copy, Debug)]
pub struct Circle {
    pub name: &'static str,
    pub radius_mm: f64,
    pub diameters_mm: [f64; 8],
    pub mean_mm: f64,
    pub sigma_um: f64,
    /// Backlash that remains at the ends [left, right, top, bottom], um, without sign.
    pub ends_um: [f64; 4],
    pub minutes: f64,
}

/// Table 15.
pub const CIRCLES: [Circle; 3] = [
    Circle {
        name: "a",
        radius_mm: 3.0,
        diameters_mm: [5.950, 5.980, 6.001, 6.003, 5.961, 5.926, 5.904, 5.940],
        mean_mm: 5.958,
        sigma_um: 35.0,
        ends_um: [21.0, 51.0, 8.0, 30.0],
        minutes: 23.0,
    },
    Circle {
        name: "b",
        radius_mm: 2.0,
        diameters_mm: [3.987, 3.991, 3.998, 4.018, 3.990, 3.961, 3.947, 3.969],
        mean_mm: 3.982,
        sigma_um: 22.0,
        ends_um: [21.0, 25.0, 9.0, 13.0],
        minutes: 14.0,
    },
    Circle {
        name: "c",
        radius_mm: 1.0,
        diameters_mm: [1.991, 2.001, 2.017, 2.017, 2.001, 1.971, 1.970, 1.967],
        mean_mm: 1.991,
        sigma_um: 20.0,
        ends_um: [18.0, 12.0, 9.0, 3.0],
        minutes: 8.0,
    },
];

/// Names of the ends of a circle, in the order of [`Circle::ends_um`].
pub const ENDS: [&str; 4] = ["Ei left", "Ed right", "Ps top", "Pi bottom"];

/// The sign of the remaining backlash at each end, which the original does not print. Of all
/// sixteen choices, these signs give the smallest residuals of diameters, of backlash values and of
/// the parts of tables 16 to 20. With them the backlash of X falls steadily from left to right.
pub const SIGNS: [f64; 4] = [1.0, -1.0, 1.0, 1.0];

/// Positions of the ends from the centre, in radii.
const END_AT: [[f64; 2]; 4] = [[-1.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.0, -1.0]];

/// A measured backlash, and its position.
#[derive(Clone, Copy, Debug)]
pub struct MeasuredBacklash {
    /// The axis: 0 for X, 1 for Y.
    pub axis: usize,
    /// Position from the middle of the work area, mm.
    pub at_mm: [f64; 2],
    pub backlash_um: f64,
}

/// The middle of a third of the work area along an axis, mm from the middle of the area.
pub fn third_mm(axis: usize, third: f64) -> f64 {
    third * 2.0 * MIDDLE_MM[axis] / 3.0
}

/// Choices that the description of the original leaves open.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Choice {
    /// Sign of the remaining backlash at each end of a circle.
    pub signs: [f64; 4],
    /// Direction in which the thirds count: of V along X, and of H against Y.
    pub thirds: [f64; 2],
}

impl Choice {
    /// The choice with the smallest residuals.
    pub const BEST: Choice = Choice {
        signs: SIGNS,
        thirds: [1.0; 2],
    };
}

/// The backlash values of tables 13, 14 and 15: the take-up plus the backlash that remained.
pub fn backlash_values(choice: &Choice) -> Vec<MeasuredBacklash> {
    let regions = REGIONS.iter().map(|region| {
        let mut at_mm = [0.0; 2];
        // The second line ends there.
        at_mm[region.axis] = -region.programmed_mm / 2.0;
        let across = 1 - region.axis;
        at_mm[across] = third_mm(across, choice.thirds[across] * region.third);
        MeasuredBacklash {
            axis: region.axis,
            at_mm,
            backlash_um: region.backlash_um,
        }
    });
    let squares = SQUARES.iter().flat_map(|square| {
        [0, 1].map(|axis| {
            let half = SQUARE_MM / 2.0;
            // The upper left corner for X, the lower left one for Y.
            let corner = [[-half, half], [-half, -half]][axis];
            let middle = [0, 1].map(|index| choice.thirds[index] * square.at_mm[index]);
            MeasuredBacklash {
                axis,
                at_mm: [0, 1].map(|index| middle[index] + corner[index]),
                backlash_um: FIRST_TAKE_UP_UM[axis] * scale() + square.left_um[axis],
            }
        })
    });
    let circles = CIRCLES.iter().flat_map(|circle| {
        [0, 1, 2, 3].map(|end| {
            let axis = end / 2;
            MeasuredBacklash {
                axis,
                at_mm: END_AT[end].map(|part| part * circle.radius_mm),
                backlash_um: LAST_TAKE_UP_UM[axis] * scale()
                    + choice.signs[end] * circle.ends_um[end],
            }
        })
    });
    regions.chain(squares).chain(circles).collect()
}

/// Width of a mark, um: the excess of a length, measured from outer edge to outer edge, over the
/// motion of the tool. It is the mean over the lengths of tables 13 and 14.
pub fn mark_width_um() -> f64 {
    let [lines, squares] = mark_widths_um();
    mean(lines.into_iter().chain(squares))
}

/// The width that each line of table 13 and each side of table 14 shows, um.
fn mark_widths_um() -> [Vec<f64>; 2] {
    let lines = REGIONS.iter();
    let lines = lines.map(|line| 1e3 * (line.measured_mm - line.programmed_mm * scale()));
    let squares = SQUARES.iter().flat_map(|square| {
        [0, 1].map(|axis| 1e3 * (square.size_mm[axis] - SQUARE_MM * scale()) + square.left_um[axis])
    });
    [lines.collect(), squares.collect()]
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0), |(sum, count), value| (sum + value, count + 1));
    sum / f64::from(count.max(1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_diameters_have_the_printed_mean_and_deviation() {
        for circle in CIRCLES {
            let mean = circle.diameters_mm.iter().sum::<f64>() / 8.0;
            assert!((mean - circle.mean_mm).abs() < 0.001, "{mean}");
            let squares = circle.diameters_mm.iter().map(|d| (d - mean).powi(2));
            let sigma = 1e3 * (squares.sum::<f64>() / 7.0).sqrt();
            assert!((sigma - circle.sigma_um).abs() < 1.5, "{sigma}");
        }
    }

    /// The lines and the sides of squares show the same width, that of a scratch.
    #[test]
    fn marks_have_the_same_width_in_lines_and_squares() {
        for widths in mark_widths_um() {
            let width_um = mean(widths.into_iter());
            assert!((width_um - 10.0).abs() < 0.5, "{width_um}");
        }
    }
}

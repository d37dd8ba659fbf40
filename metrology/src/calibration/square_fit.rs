//! Angles between axes, from a bar that has the same length in every direction.

use crate::least_squares::least_squares;
use husillo_backlash::Squareness;

/// The two ends of the bar, along the axes, in nm.
pub type Ends = [[i64; 3]; 2];

/// A plane of two axes, and the name of its angle.
const PLANES: [(usize, usize, &str); 3] = [(0, 1, "xy"), (0, 2, "xz"), (1, 2, "yz")];

/// The angles found from a bar.
#[derive(Clone, Debug)]
pub struct SquareFit {
    /// The angles by which axes are not square.
    pub squareness: Squareness,
    /// Whether the bar lay along both diagonals of each plane. If not, the angle of the plane is
    /// unknown and set to 0.
    pub is_known: [bool; 3],
    /// Length of the bar, nm: the given one, or the best fit.
    pub length: f64,
    /// Largest deviation of the length of the bar, nm: with square axes, and with these angles.
    pub worst: [f64; 2],
}

impl SquareFit {
    /// Finds the angles by least squares (Gauss-Newton), and the length of the bar if it is not
    /// given.
    ///
    /// # Errors
    ///
    /// A sentence: the positions of the bar do not determine the angles.
    pub fn new(places: &[Ends], length: Option<f64>) -> Result<Self, String> {
        let displacements: Vec<[f64; 3]> = places
            .iter()
            .map(|[from, to]| [0, 1, 2].map(|axis| (to[axis] - from[axis]) as f64))
            .collect();
        let mean = displacements.iter().map(long).sum::<f64>() / displacements.len().max(1) as f64;
        if displacements.is_empty() || mean == 0.0 {
            return Err("there is no bar".into());
        }
        let is_known = PLANES.map(|(a, b, _)| {
            let products = displacements
                .iter()
                .map(|displacement| displacement[a] * displacement[b] / (mean * mean));
            let spread = products.fold([0.0f64; 2], |[low, high], p| [low.min(p), high.max(p)]);
            // A quarter of the values of the two diagonals, with both signs.
            spread[0] < -0.125 && spread[1] > 0.125
        });
        if !is_known.contains(&true) {
            return Err("the bar has to lie along both diagonals of a plane".into());
        }
        let mut leans = [0.0; 3];
        let mut fitted = length.unwrap_or(mean);
        // Each iteration squares the relative error: 1 % becomes 10^-16 after three.
        for _ in 0..6 {
            let rows = displacements.iter().map(|displacement| {
                let there = leaned(displacement, leans);
                let by_lean = PLANES.map(|(a, b, _)| there[a] * displacement[b] / long(&there));
                (
                    [by_lean[0], by_lean[1], by_lean[2], -1.0],
                    fitted - long(&there),
                )
            });
            let free = [is_known[0], is_known[1], is_known[2], length.is_none()];
            let change = least_squares(rows, free).ok_or(
                "the positions of the bar do not determine the angles: lay it along both \
                 diagonals of each plane",
            )?;
            for (lean, change) in leans.iter_mut().zip(change) {
                *lean += change;
            }
            fitted += change[3];
        }
        if leans.iter().any(|lean| lean.abs() > 1e-2) {
            let text = leans.map(|lean| format!("{:.1} %", lean * 100.0));
            let text = text.join(", ");
            return Err(format!(
                "the axes would lean by {text}: are these the ends of one bar?"
            ));
        }
        let [xy_ppb, xz_ppb, yz_ppb] = leans.map(|lean| (lean * 1e9).round() as i32);
        let worst = |leans, length: f64| {
            let errors = displacements
                .iter()
                .map(|displacement| (long(&leaned(displacement, leans)) - length).abs());
            errors.fold(0.0, f64::max)
        };
        Ok(Self {
            squareness: Squareness {
                xy_ppb,
                xz_ppb,
                yz_ppb,
            },
            is_known,
            length: fitted,
            worst: [
                worst([0.0; 3], length.unwrap_or(mean)),
                worst(leans, fitted),
            ],
        })
    }

    /// Names of the planes whose angle is not known.
    pub fn unknown(&self) -> Vec<&'static str> {
        let planes = PLANES.iter().zip(self.is_known);
        planes
            .filter(|(_, known)| !known)
            .map(|((_, _, name), _)| *name)
            .collect()
    }
}

fn long(displacement: &[f64; 3]) -> f64 {
    displacement
        .iter()
        .map(|part| part * part)
        .sum::<f64>()
        .sqrt()
}

/// A vector in square coordinates.
fn leaned([x, y, z]: &[f64; 3], [xy, xz, yz]: [f64; 3]) -> [f64; 3] {
    [x + xy * y + xz * z, y + yz * z, *z]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The readings of a machine with these angles for a bar of 200 mm in these directions.
    fn read(frame: &Squareness, directions: &[[f64; 3]]) -> Vec<Ends> {
        let place = |direction: &[f64; 3]| {
            let end = direction.map(|part| (part * 200e6 / long(direction)).round() as i64);
            let start = [-30_000_000, 17_000_000, 5_000_000];
            let end = [0, 1, 2].map(|axis| start[axis] + end[axis]);
            [frame.reading_nm(start), frame.reading_nm(end)]
        };
        directions.iter().map(place).collect()
    }

    const DIAGONALS: [[f64; 3]; 6] = [
        [1.0, 1.0, 0.0],
        [1.0, -1.0, 0.0],
        [1.0, 0.0, 1.0],
        [1.0, 0.0, -1.0],
        [0.0, 1.0, 1.0],
        [0.0, 1.0, -1.0],
    ];

    #[test]
    fn three_angles_and_the_length() {
        let frame = Squareness {
            xy_ppb: 100_000,
            xz_ppb: -3_000_000,
            yz_ppb: 777_000,
        };
        for length in [None, Some(200e6)] {
            let fit = SquareFit::new(&read(&frame, &DIAGONALS), length).unwrap();
            let found = fit.squareness;
            let pairs = [
                (found.xy_ppb, frame.xy_ppb),
                (found.xz_ppb, frame.xz_ppb),
                (found.yz_ppb, frame.yz_ppb),
            ];
            assert!(
                pairs
                    .iter()
                    .all(|(found, there)| found.abs_diff(*there) < 20),
                "{fit:?}"
            );
            assert!(
                (fit.length - 200e6).abs() < 2.0 && fit.worst[1] < 3.0,
                "{fit:?}"
            );
            assert!(
                fit.worst[0] > 100_000.0 && fit.unknown().is_empty(),
                "{fit:?}"
            );
        }
    }

    #[test]
    fn a_single_plane() {
        let frame = Squareness {
            xy_ppb: -100_000,
            ..Squareness::default()
        };
        let fit = SquareFit::new(&read(&frame, &DIAGONALS[..2]), None).unwrap();
        assert!(fit.squareness.xy_ppb.abs_diff(-100_000) < 20, "{fit:?}");
        assert_eq!(fit.unknown(), ["xz", "yz"]);
    }

    #[test]
    fn space_diagonals_determine_all_angles() {
        let frame = Squareness {
            xy_ppb: 50_000,
            xz_ppb: 60_000,
            yz_ppb: -70_000,
        };
        let directions = [
            [1.0, 1.0, 1.0],
            [1.0, 1.0, -1.0],
            [1.0, -1.0, 1.0],
            [-1.0, 1.0, 1.0],
        ];
        let fit = SquareFit::new(&read(&frame, &directions), None).unwrap();
        assert!(fit.squareness.yz_ppb.abs_diff(-70_000) < 20, "{fit:?}");
    }

    #[test]
    fn a_bar_that_determines_nothing() {
        let frame = Squareness::default();
        let why = |directions: &[[f64; 3]], length| {
            SquareFit::new(&read(&frame, directions), length).unwrap_err()
        };
        assert!(why(&DIAGONALS[..1], None).contains("both diagonals"));
        assert!(why(&[], None).contains("no bar"));
        // Three positions for four unknowns.
        let three = [[1.0, 1.0, 1.0], [1.0, 1.0, -1.0], [1.0, -1.0, 1.0]];
        assert!(why(&three, None).contains("do not determine the angles"));
        let ends = [
            [[0; 3], [200_000_000, 200_000_000, 0]],
            [[0; 3], [200_000_000, -100_000_000, 0]],
        ];
        assert!(SquareFit::new(&ends, None).unwrap_err().contains("one bar"));
    }
}

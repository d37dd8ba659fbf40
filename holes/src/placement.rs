//! The position of a board on the machine: mirrored, turned, fitted to measured holes, moved.

use crate::Board;
use husillo_excellon::{LIMIT_NM, Path};
use husillo_gcode::Nm;
use std::error::Error;
use std::fmt;

/// The axis whose sign changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mirror {
    /// X.
    X,
    /// Y.
    Y,
}

/// Where a board is moved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shift {
    /// By X and Y.
    By([Nm; 2]),
    /// Its smallest X and Y go to zero.
    Corner,
}

/// The position of a board: first mirrored, then turned, fitted and moved.
#[derive(Clone, Debug, Default)]
pub struct Placement {
    /// Turns the board over.
    pub mirror: Option<Mirror>,
    /// Counter-clockwise.
    pub turn_degrees: f64,
    /// Positions of holes in the file, and their measured positions, nm. Two or more turn and shift
    /// the board onto them.
    pub references: Vec<[[f64; 2]; 2]>,
    /// Whether the references also correct scale and skew.
    pub stretches: bool,
    /// The last movement.
    pub shift: Option<Shift>,
}

/// Why a board cannot be placed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PlacementError {
    /// A position is beyond the range of coordinates.
    OutOfRange,
    /// There is one reference, which does not determine the turn.
    OneReference,
    /// All references are within a millimetre.
    NearReferences,
    /// The measured positions are the mirror image of the file.
    MirrorImage,
    /// The board would be this long in X and Y, relative to the file.
    Stretched([f64; 2]),
    /// When the others fit, one reference is this far off, in nm.
    Residual(f64),
}

impl fmt::Display for PlacementError {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OutOfRange => out.write_str("the board is moved out of reach"),
            Self::OneReference => out.write_str("one reference does not determine the turn"),
            Self::NearReferences => {
                out.write_str("the reference holes are less than a millimetre apart")
            }
            Self::MirrorImage => {
                out.write_str("the measured positions are the mirror image of the file")
            }
            Self::Stretched([x, y]) => write!(
                out,
                "the measured board is {:.1} % as long as the file in X and {:.1} % in Y; are \
                 these the holes, and the unit?",
                100.0 * x,
                100.0 * y
            ),
            Self::Residual(nm) => write!(
                out,
                "one reference is {:.3} mm off when the others fit; are these the holes?",
                nm / 1e6
            ),
        }
    }
}

impl Error for PlacementError {}

/// The result of a fit to measured holes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit {
    /// Turn of the board, degrees.
    pub turn_degrees: f64,
    /// Excess of its length over the file in X and Y, parts in a million.
    pub scale_ppm: [f64; 2],
    /// Deviation of the angle between X and Y from a right angle, um/m; unknown from two holes.
    pub skew_ppm: Option<f64>,
    /// Largest distance of a measured hole from its expected position, nm.
    pub residual_nm: f64,
}

/// Largest stretch of a board, relative to its length: paper and film change by less.
const MAX_STRETCH: f64 = 0.02;

/// Largest distance of a measured hole from the position that the fit expects, nm.
const MAX_RESIDUAL_NM: f64 = 1e6;

/// `p -> M p + t`.
#[derive(Clone, Copy, Debug)]
struct Affine {
    matrix: [[f64; 2]; 2],
    offset: [f64; 2],
}

impl Affine {
    const NONE: Self = Self {
        matrix: [[1.0, 0.0], [0.0, 1.0]],
        offset: [0.0; 2],
    };

    fn turned(degrees: f64) -> Self {
        // A quarter turn is exact.
        let (sin, cos) = match degrees.rem_euclid(360.0) {
            0.0 => (0.0, 1.0),
            90.0 => (1.0, 0.0),
            180.0 => (0.0, -1.0),
            270.0 => (-1.0, 0.0),
            other => other.to_radians().sin_cos(),
        };
        Self {
            matrix: [[cos, -sin], [sin, cos]],
            offset: [0.0; 2],
        }
    }

    fn at(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [[a, b], [c, d]] = self.matrix;
        [
            a * x + b * y + self.offset[0],
            c * x + d * y + self.offset[1],
        ]
    }

    /// First the other, then this.
    fn after(&self, first: &Self) -> Self {
        let column = |j: usize| {
            let from = [first.matrix[0][j], first.matrix[1][j]];
            let [x, y] = self.at(from);
            [x - self.offset[0], y - self.offset[1]]
        };
        let ([a, c], [b, d]) = (column(0), column(1));
        Self {
            matrix: [[a, b], [c, d]],
            offset: self.at(first.offset),
        }
    }

    fn is_mirrored(&self) -> bool {
        let [[a, b], [c, d]] = self.matrix;
        a * d - b * c < 0.0
    }

    /// The point, to the nearest nanometre; `None` out of reach.
    fn place(&self, at_nm: [i64; 2]) -> Option<[i64; 2]> {
        let [x, y] = self.at(at_nm.map(|nm| nm as f64));
        let near = |value: f64| {
            let nm = value.round() as i64;
            (-LIMIT_NM..=LIMIT_NM).contains(&nm).then_some(nm)
        };
        Some([near(x)?, near(y)?])
    }
}

impl Placement {
    /// Moves holes and slots. Returns the fit, if there is one.
    ///
    /// # Errors
    ///
    /// A position is out of reach, or the references do not fit: see [`PlacementError`].
    pub fn apply(&self, board: &mut Board) -> Result<Option<Fit>, PlacementError> {
        if self.references.len() == 1 {
            return Err(PlacementError::OneReference);
        }
        let mirrored = Affine {
            matrix: match self.mirror {
                None => Affine::NONE.matrix,
                Some(Mirror::X) => [[-1.0, 0.0], [0.0, 1.0]],
                Some(Mirror::Y) => [[1.0, 0.0], [0.0, -1.0]],
            },
            offset: [0.0; 2],
        };
        let mut map = Affine::turned(self.turn_degrees).after(&mirrored);
        let mut found = None;
        if !self.references.is_empty() {
            let pairs: Vec<_> = (self.references.iter())
                .map(|[file, measured]| [map.at(*file), *measured])
                .collect();
            let (fitted, fit) = fit(&pairs, self.stretches)?;
            map = fitted.after(&map);
            found = Some(fit);
        }
        move_all(&map, board)?;
        let by = match (self.shift, board.extent()) {
            (Some(Shift::By(by)), _) => by.map(|nm| nm.0 as f64),
            (Some(Shift::Corner), Some([low, _])) => low.map(|nm| -(nm.0 as f64)),
            (None, _) | (_, None) => return Ok(found),
        };
        let shifted = Affine {
            offset: by,
            ..Affine::NONE
        };
        move_all(&shifted, board)?;
        Ok(found)
    }
}

fn move_all(map: &Affine, board: &mut Board) -> Result<(), PlacementError> {
    let far = PlacementError::OutOfRange;
    for hole in &mut board.holes {
        hole.at_nm = map.place(hole.at_nm).ok_or(far)?;
    }
    for slot in &mut board.slots {
        slot.from_nm = map.place(slot.from_nm).ok_or(far)?;
        slot.to_nm = map.place(slot.to_nm).ok_or(far)?;
        match &mut slot.path {
            Path::Straight => {}
            Path::Radius { clockwise, .. } => *clockwise ^= map.is_mirrored(),
            Path::Centre {
                clockwise,
                centre_nm,
            } => {
                *clockwise ^= map.is_mirrored();
                *centre_nm = map.place(*centre_nm).ok_or(far)?;
            }
        }
    }
    Ok(())
}

/// Sums over pairs of points, the first of the file and the second measured.
struct Moments {
    /// Means of the first and of the second points.
    means: [[f64; 2]; 2],
    /// Sums of products about the means: first by first.
    own: [[f64; 2]; 2],
    /// Second by first.
    cross: [[f64; 2]; 2],
}

impl Moments {
    fn of(pairs: &[[[f64; 2]; 2]]) -> Self {
        let count = pairs.len() as f64;
        let mean =
            |of: usize, axis: usize| pairs.iter().map(|pair| pair[of][axis]).sum::<f64>() / count;
        let means @ [from, to] = [0, 1].map(|of| [mean(of, 0), mean(of, 1)]);
        let (mut own, mut cross) = ([[0.0; 2]; 2], [[0.0; 2]; 2]);
        for [file, measured] in pairs {
            let [p, q] = [
                [file[0] - from[0], file[1] - from[1]],
                [measured[0] - to[0], measured[1] - to[1]],
            ];
            for i in 0..2 {
                for j in 0..2 {
                    own[i][j] += p[i] * p[j];
                    cross[i][j] += q[i] * p[j];
                }
            }
        }
        Self { means, own, cross }
    }
}

/// The map that brings the first of each pair nearest to the second, by least squares: a turn and
/// an offset; with `stretches` also scales and skew.
fn fit(pairs: &[[[f64; 2]; 2]], stretches: bool) -> Result<(Affine, Fit), PlacementError> {
    let Moments {
        means: [from, to],
        own,
        cross,
    } = Moments::of(pairs);
    let size = own[0][0] + own[1][1];
    if size < 1e12 {
        return Err(PlacementError::NearReferences);
    }
    let (along, across) = (cross[0][0] + cross[1][1], cross[1][0] - cross[0][1]);
    if cross[0][0] * cross[1][1] - cross[0][1] * cross[1][0] < -1e-6 * size * size {
        return Err(PlacementError::MirrorImage);
    }
    let angle = across.atan2(along);
    let rigid = Affine::turned(angle.to_degrees()).matrix;
    let similar = along.hypot(across) / size;
    let determinant = own[0][0] * own[1][1] - own[0][1] * own[1][0];
    // Holes on a line do not determine the scale across it.
    let whole = (pairs.len() > 2 && determinant > 1e-6 * size * size).then(|| {
        let [[a, b], [c, d]] = cross;
        let [[e, f], [g, h]] = own;
        [
            [(a * h - b * g) / determinant, (b * e - a * f) / determinant],
            [(c * h - d * g) / determinant, (d * e - c * f) / determinant],
        ]
    });
    let (scale, skew) = match whole {
        None => ([similar; 2], None),
        Some([[a, b], [c, d]]) => {
            let [x, y] = [a.hypot(c), b.hypot(d)];
            ([x, y], Some((a * b + c * d) / (x * y)))
        }
    };
    let matrix = match (stretches, whole) {
        (false, _) => rigid,
        (true, Some(whole)) => whole,
        (true, None) => rigid.map(|row| row.map(|value| value * similar)),
    };
    let turned = Affine {
        matrix,
        offset: [0.0; 2],
    }
    .at(from);
    let map = Affine {
        matrix,
        offset: [to[0] - turned[0], to[1] - turned[1]],
    };
    let residual_nm = pairs
        .iter()
        .map(|[file, measured]| {
            let [x, y] = map.at(*file);
            (x - measured[0]).hypot(y - measured[1])
        })
        .fold(0.0, f64::max);
    check_fit(scale, residual_nm)?;
    let fit = Fit {
        turn_degrees: angle.to_degrees(),
        scale_ppm: scale.map(|scale| (scale - 1.0) * 1e6),
        skew_ppm: skew.map(|skew| skew * 1e6),
        residual_nm,
    };
    Ok((map, fit))
}

/// Refuses a fit with a larger error than a drill has: it is that of another file, unit, or hole.
fn check_fit(scale: [f64; 2], residual_nm: f64) -> Result<(), PlacementError> {
    let is_near = |scale: &f64| (scale - 1.0).abs().le(&MAX_STRETCH);
    if !scale.iter().all(is_near) {
        return Err(PlacementError::Stretched(scale));
    }
    if residual_nm > MAX_RESIDUAL_NM {
        return Err(PlacementError::Residual(residual_nm));
    }
    Ok(())
}

impl fmt::Display for Fit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y] = self.scale_ppm;
        write!(
            f,
            "turned by {:.4} degrees; longer than the file by {x:.0} um/m in X and {y:.0} in Y",
            self.turn_degrees
        )?;
        if let Some(skew) = self.skew_ppm {
            write!(f, ", out of square by {skew:.0} um/m")?;
        }
        write!(
            f,
            "; the worst reference is {:.1} um off",
            self.residual_nm / 1e3
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const MM: f64 = 1e6;

    #[test]
    fn quarter_turns_and_mirrors_are_exact() {
        let at = [3_000_001, -7];
        for (degrees, expected) in [
            (90.0, [7, 3_000_001]),
            (180.0, [-3_000_001, 7]),
            (-90.0, [-7, -3_000_001]),
        ] {
            assert_eq!(Affine::turned(degrees).place(at), Some(expected));
        }
    }

    /// Four corners of a board that is 100 um/m too long in X, 50 too short in Y, 30 out of square,
    /// turned and shifted.
    #[test]
    fn a_fit_finds_scale_and_skew() {
        let skewed = Affine {
            matrix: [[1.000_1, 30e-6], [0.0, 0.999_95]],
            offset: [0.0; 2],
        };
        let placed = Affine {
            offset: [12.0 * MM, -3.0 * MM],
            ..Affine::turned(1.5)
        }
        .after(&skewed);
        let corners = [[0.0, 0.0], [80.0, 0.0], [80.0, 40.0], [0.0, 40.0]];
        let pairs = corners.map(|[x, y]| {
            let file = [x * MM, y * MM];
            [file, placed.at(file)]
        });
        let (map, found) = fit(&pairs, true).unwrap();
        assert!((found.scale_ppm[0] - 100.0).abs() < 0.1, "{found:?}");
        assert!((found.scale_ppm[1] + 50.0).abs() < 0.1, "{found:?}");
        assert!((found.skew_ppm.unwrap() - 30.0).abs() < 0.1, "{found:?}");
        assert!((found.turn_degrees - 1.5).abs() < 0.001 && found.residual_nm < 1.0);
        assert!(!map.is_mirrored());
        // As a stiff board: half of what is left at the corners.
        let (_, stiff) = fit(&pairs, false).unwrap();
        assert!((1e3..6e3).contains(&stiff.residual_nm), "{stiff:?}");
    }

    #[test]
    fn holes_on_a_line_say_nothing_of_the_skew() {
        let pairs = [[0.0; 2], [10.0 * MM, 0.0], [30.0 * MM, 0.0]].map(|at| [at, at]);
        let (_, found) = fit(&pairs, true).unwrap();
        assert_eq!(found.skew_ppm, None);
        assert!(fit(&[[[0.0; 2]; 2], [[100.0, 0.0]; 2]], false).is_err());
    }

    proptest! {
        /// A board that was only turned and shifted is found at its position, from two holes as
        /// well as from more.
        #[test]
        fn a_stiff_board_is_found(
            degrees in -180.0..180.0_f64,
            offset in prop::array::uniform2(-1e8..1e8_f64),
            holes in prop::collection::vec(prop::array::uniform2(-1e8..1e8_f64), 2..6),
        ) {
            let far = |a: &[f64; 2], b: &[f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]) > 1e7;
            prop_assume!(holes.iter().any(|hole| far(hole, &holes[0])));
            let placed = Affine { offset, ..Affine::turned(degrees) };
            let pairs: Vec<_> = holes.iter().map(|hole| [*hole, placed.at(*hole)]).collect();
            for stretches in [false, true] {
                let (map, found) = fit(&pairs, stretches).unwrap();
                prop_assert!(found.residual_nm < 1.0, "{:?}", found);
                let [x, y] = map.at([5e7, -3e7]);
                let [ideal_x, ideal_y] = placed.at([5e7, -3e7]);
                if !stretches {
                    prop_assert!((x - ideal_x).hypot(y - ideal_y) < 1.0);
                }
            }
        }
    }
}

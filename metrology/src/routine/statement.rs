//! The checked statement of a line of a routine.

use super::dimension::Wanted;
use super::vector::Vector;
use crate::heads::Approach;

/// The statement of a line.
#[derive(Clone, Debug, PartialEq)]
pub struct Statement {
    /// Number of the line, from 1.
    pub line: usize,
    /// The order.
    pub(super) order: Order,
}

/// Coordinates of the part in nm. `None`: the coordinate of the tip.
pub type Place = [Option<i64>; 3];

/// The order of a statement.
#[derive(Clone, Debug, PartialEq)]
pub enum Order {
    /// Distance before a surface at which touches begin, nm.
    Clearance(i64),
    /// Distance behind a surface at which touches end, nm.
    Search(i64),
    /// Safe height for the moves between features, nm. `None`: the moves are direct.
    Safe(Option<i64>),
    /// The reaction to a contact of all following moves that do not state their own.
    Moves(Approach),
    /// A straight move to a position, and its approach. `None`: the approach that `moves` has set.
    GoTo(Place, Option<Approach>),
    /// A straight move by these distances, nm.
    Jog([i64; 3], Option<Approach>),
    /// These coordinates of the present position become 0.
    Zero([bool; 3]),
    /// Returns to the frame of the machine.
    MachineFrame,
    /// The frame of a plane, a line and a point.
    Frame {
        /// Names of the three features.
        of: [String; 3],
        /// Coordinates of their intersection in the new frame, nm.
        called_nm: [i64; 3],
    },
    /// Measures a feature.
    Measure(Box<Task>),
}

/// A feature to be measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Task {
    /// Its keyword: `bore`, `circle`, ...
    pub keyword: &'static str,
    /// Its name.
    pub name: String,
    /// The touches or the calculation.
    pub job: Job,
    /// The wanted figures.
    pub wanted: Vec<Wanted>,
    /// Clearance instead of that of the routine, nm.
    pub clearance_nm: Option<i64>,
    /// Search instead of that of the routine, nm.
    pub search_nm: Option<i64>,
}

/// The job that gives a feature. Directions are those of travel on the part. Lengths are in nm.
#[derive(Clone, Debug, PartialEq)]
pub enum Job {
    /// One touch from the present position of the tip.
    Touch {
        towards: Vector,
        within_nm: Option<i64>,
    },
    /// One touch.
    Point { at: Place, towards: Vector },
    /// Touches in a row perpendicular to the travel.
    Edge {
        at: Place,
        towards: Vector,
        points: u32,
        over_nm: i64,
    },
    /// Two touches on each of two faces.
    Corner {
        at: Place,
        towards: [Vector; 2],
        inset_nm: i64,
        is_inside: bool,
    },
    /// Two opposite faces.
    Width {
        at: Place,
        along: Vector,
        width_nm: i64,
        is_inside: bool,
    },
    /// Touches around an axis along Z.
    Round {
        at: Place,
        diameter_nm: i64,
        points: u32,
        /// First and last direction, degrees. A whole turn has no touch in the last direction.
        arc_deg: [f64; 2],
        is_inside: bool,
    },
    /// Touches on a face.
    Plane { at: Vec<Place>, towards: Vector },
    /// Touches along a line.
    Line { at: Vec<Place>, towards: Vector },
    /// Touches on the upper half.
    Sphere {
        at: Place,
        diameter_nm: i64,
        points: u32,
    },
    /// A fit to features that were measured before.
    Fit { shape: Fit, of: Vec<String> },
    /// The distance of two features, along a direction if one is given.
    Distance {
        between: [String; 2],
        along: Option<Vector>,
    },
    /// The angle of two lines or faces.
    Angle { between: [String; 2] },
}

/// Least-squares features.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fit {
    Plane,
    Line,
    Circle,
    Sphere,
}

impl Fit {
    /// The number of points that determine it.
    pub const fn least_points(self) -> usize {
        match self {
            Self::Line => 2,
            Self::Plane | Self::Circle => 3,
            Self::Sphere => 4,
        }
    }
}

//! What a line of a routine says, checked.

use super::dimension::Wanted;
use super::vector::Vector;

/// A line that says something.
#[derive(Clone, Debug, PartialEq)]
pub struct Statement {
    /// Number of the line, from 1.
    pub line: usize,
    /// What is to be done.
    pub(super) order: Order,
}

/// Coordinates of the part in nm; `None`: where the tip is.
pub type Place = [Option<i64>; 3];

/// What is to be done.
#[derive(Clone, Debug, PartialEq)]
pub enum Order {
    /// How far before a surface touches begin, nm.
    Clearance(i64),
    /// How far behind a surface they end, nm.
    Search(i64),
    /// Height for the ways between features, nm; `None`: straight ways.
    Safe(Option<i64>),
    /// Straight to a place.
    GoTo(Place),
    /// Straight by so much, nm.
    Jog([i64; 3]),
    /// The present place becomes 0 in these coordinates.
    Zero([bool; 3]),
    /// Back to the frame of the machine.
    MachineFrame,
    /// The frame of a plane, a line and a point.
    Frame {
        /// Names of the three.
        of: [String; 3],
        /// What their place is called, nm.
        called_nm: [i64; 3],
    },
    /// A feature.
    Measure(Box<Task>),
}

/// A feature to be measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Task {
    /// `bore`, `circle`, ...
    pub keyword: &'static str,
    /// Its name.
    pub name: String,
    /// How.
    pub job: Job,
    /// What is said of its figures.
    pub wanted: Vec<Wanted>,
    /// Instead of the routine's, nm.
    pub clearance_nm: Option<i64>,
    /// Instead of the routine's, nm.
    pub search_nm: Option<i64>,
}

/// Ways to a feature. Directions are those of travel, on the part; lengths in nm.
#[derive(Clone, Debug, PartialEq)]
pub enum Job {
    /// One touch from where the tip is.
    Touch {
        towards: Vector,
        within_nm: Option<i64>,
    },
    /// One touch.
    Point { at: Place, towards: Vector },
    /// Touches in a row across the travel.
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
        /// First and last direction, degrees; a whole turn has no last.
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
    /// What was measured before.
    Fit { shape: Fit, of: Vec<String> },
    /// The distance of two features; along a direction, if given.
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
    /// How many points determine it.
    pub const fn least_points(self) -> usize {
        match self {
            Self::Line => 2,
            Self::Plane | Self::Circle => 3,
            Self::Sphere => 4,
        }
    }
}

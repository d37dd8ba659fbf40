//! Measured features.

use super::dimension::{Dimension, Figure, Verdict, Wanted};
use super::frame::Frame;
use super::site::Contact;
use super::vector::{Vector, components, cross, dot, floats, length, minus};
use husillo_probe::{Circle, Line, Plane, Sphere, UnitVector};

/// A measured feature with its points and figures.
#[derive(Clone, Debug)]
pub struct Feature {
    /// Its keyword: `bore`, `circle`, ...
    pub keyword: &'static str,
    /// Its name.
    pub name: String,
    /// Number of the line that measured it.
    pub line: usize,
    /// Its shape, on the machine.
    pub shape: Shape,
    /// Its own touches.
    pub contacts: Vec<Contact>,
    /// Its corrected points with their residuals.
    pub marks: Vec<Mark>,
    /// The frame in which it was measured.
    pub frame: Frame,
    /// Name of that frame in the routine: `machine`, or the features that define it.
    pub frame_name: String,
    /// Its figures in that frame.
    pub dimensions: Vec<Dimension>,
    /// Whether the probe has collided before or after it, so that its result is not valid.
    pub is_spoiled: bool,
}

/// A point of a feature, on the machine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mark {
    /// On the surface, nm.
    pub surface_nm: [i64; 3],
    /// Direction out of the material, or out of the feature.
    pub normal: Vector,
    /// Distance from the feature along the normal, nm.
    pub residual_nm: i64,
}

/// The shape of a feature. All coordinates are on the machine.
#[derive(Clone, Copy, Debug)]
pub enum Shape {
    /// A point of a surface.
    Point {
        /// Position, nm.
        at_nm: [i64; 3],
        /// Assumed normal out of the material.
        outward: UnitVector,
    },
    /// A face.
    Plane(Plane),
    /// A face parallel to Z.
    Edge {
        /// The face.
        plane: Plane,
        /// Its direction across Z.
        along: UnitVector,
    },
    /// A line.
    Line {
        /// The line.
        line: Line,
        /// Normal out of the material, if the line was touched.
        outward: Option<UnitVector>,
    },
    /// The intersection of two edges.
    Corner {
        /// Position, nm.
        at_nm: [i64; 3],
        /// Angle of the material between the edges, millionths of a degree.
        angle_micro: i64,
    },
    /// Two opposite faces.
    Width {
        /// The middle between them, nm.
        centre_nm: [i64; 3],
        /// Their distance, nm.
        width_nm: i64,
        /// A point of each, nm.
        ends_nm: [[i64; 3]; 2],
    },
    /// A circle.
    Circle(Circle),
    /// A sphere.
    Sphere(Sphere),
    /// A distance between two positions.
    Distance {
        /// The two positions, nm.
        ends_nm: [[i64; 3]; 2],
        /// Their distance, nm.
        length_nm: i64,
    },
    /// An angle between two directions.
    Angle {
        /// The angle, millionths of a degree.
        angle_micro: i64,
    },
}

impl Shape {
    /// Position of the feature, if it has one, nm.
    pub const fn point_nm(&self) -> Option<[i64; 3]> {
        match self {
            Self::Point { at_nm, .. } | Self::Corner { at_nm, .. } => Some(*at_nm),
            Self::Plane(plane) | Self::Edge { plane, .. } => Some(plane.point_nm),
            Self::Line { line, .. } => Some(line.point_nm),
            Self::Width { centre_nm, .. } => Some(*centre_nm),
            Self::Circle(circle) => Some(circle.centre_nm),
            Self::Sphere(sphere) => Some(sphere.centre_nm),
            Self::Distance { .. } | Self::Angle { .. } => None,
        }
    }

    /// The face of the feature, if it has one.
    pub const fn plane(&self) -> Option<&Plane> {
        match self {
            Self::Plane(plane) | Self::Edge { plane, .. } => Some(plane),
            _ => None,
        }
    }

    /// The direction of the feature, if it has one: that of a line, or the normal of a face.
    pub const fn direction(&self) -> Option<UnitVector> {
        match self {
            Self::Line { line, .. } => Some(line.direction),
            Self::Edge { along, .. } => Some(*along),
            Self::Plane(plane) => Some(plane.normal),
            _ => None,
        }
    }
}

impl Feature {
    /// Largest minus smallest signed residual, nm.
    pub fn form_nm(&self) -> i64 {
        let residuals = self.marks.iter().map(|mark| mark.residual_nm);
        let most = residuals.clone().max().unwrap_or_default();
        most.saturating_sub(residuals.min().unwrap_or_default())
    }

    /// Number of touches that are part of the result, over all points.
    pub fn touches(&self) -> u32 {
        let touches = self.contacts.iter().map(|contact| contact.touches);
        touches.map(u32::from).sum()
    }

    /// The largest spread of the touches of one point, nm. `None` if each point was touched once.
    pub fn spread_nm(&self) -> Option<i64> {
        let repeated = self.contacts.iter().filter(|contact| contact.touches > 1);
        repeated.map(|contact| contact.spread_nm).max()
    }

    /// Computes the figures.
    pub fn with_figures(mut self, wanted: &[Wanted]) -> Self {
        let frame = &self.frame;
        let mut figures: Vec<(Figure, i64)> = Vec::new();
        if let Some(at_nm) = self.shape.point_nm() {
            figures.extend(Figure::COORDINATES.into_iter().zip(frame.to_part(at_nm)));
        }
        match &self.shape {
            Shape::Corner { angle_micro, .. } | Shape::Angle { angle_micro } => {
                // The edges of a corner meet at any height.
                figures.retain(|(figure, _)| *figure != Figure::Z);
                figures.push((Figure::Angle, *angle_micro));
            }
            Shape::Width { width_nm, .. } => figures.push((Figure::Width, *width_nm)),
            Shape::Distance { length_nm, .. } => figures.push((Figure::Length, *length_nm)),
            Shape::Circle(Circle { radius_nm, .. }) | Shape::Sphere(Sphere { radius_nm, .. }) => {
                figures.push((Figure::Diameter, radius_nm.saturating_mul(2)));
            }
            Shape::Line { line, .. } => {
                figures.push((Figure::Angle, heading_micro(frame, &line.direction, wanted)));
            }
            Shape::Edge { along, .. } if self.marks.len() > 1 => {
                figures.push((Figure::Angle, heading_micro(frame, along, wanted)));
            }
            _ => {}
        }
        if self.marks.len() > least_for_form(&self.shape) {
            figures.push((Figure::Form, self.form_nm()));
        }
        let dimension = |(figure, actual)| Dimension::new(figure, actual, wanted);
        self.dimensions = figures.into_iter().map(dimension).collect();
        self
    }

    /// Whether no figure is out of its tolerance, and no collision has spoiled the feature. A
    /// figure without a tolerance is good.
    pub fn is_good(&self) -> bool {
        let mut dimensions = self.dimensions.iter();
        !self.is_spoiled && dimensions.all(|dimension| dimension.is_good() != Some(false))
    }

    /// The verdict on one of its figures. `None`: the figure has no tolerance.
    pub fn verdict(&self, dimension: &Dimension) -> Option<Verdict> {
        let is_good = dimension.is_good()?;
        Some(match is_good {
            _ if self.is_spoiled => Verdict::Spoiled,
            true => Verdict::Good,
            false => Verdict::Out,
        })
    }

    /// Marks the feature as spoiled by a collision.
    pub const fn spoil(&mut self) {
        self.is_spoiled = true;
    }
}

/// Number of points that a feature always passes through exactly, without residuals.
const fn least_for_form(shape: &Shape) -> usize {
    match shape {
        Shape::Edge { .. } | Shape::Line { .. } => 2,
        Shape::Plane(_) | Shape::Circle(_) => 3,
        Shape::Sphere(_) => 4,
        _ => usize::MAX,
    }
}

/// The angle of a direction to X in the plane of X and Y, millionths of a degree. A line has no
/// front and no back. Of its two angles this is the one within a quarter turn of the wanted angle.
fn heading_micro(frame: &Frame, direction: &UnitVector, wanted: &[Wanted]) -> i64 {
    const HALF_TURN: i64 = 180_000_000;
    let [x, y, _] = frame.direction_to_part(direction);
    let micro = (y.atan2(x).to_degrees() * 1e6).round() as i64;
    let mut wanted = wanted
        .iter()
        .filter(|wanted| wanted.figure == Figure::Angle);
    let about = wanted.next().map_or(0, |wanted| wanted.nominal_micro);
    // -90 degrees become 90 degrees.
    about + HALF_TURN / 2 - (HALF_TURN / 2 - (micro - about)).rem_euclid(HALF_TURN)
}

/// The angle of two directions that have no front and no back, millionths of a degree. It is 0 to
/// 90 degrees, or 90 to 180 degrees if the wanted angle is above 90.
pub fn angle_micro(a: &UnitVector, b: &UnitVector, wanted: &[Wanted]) -> i64 {
    let cosine = dot(components(a), components(b)).abs().min(1.0);
    let sine = length(cross(components(a), components(b)));
    let micro = (sine.atan2(cosine).to_degrees() * 1e6).round() as i64;
    let mut wanted = wanted
        .iter()
        .filter(|wanted| wanted.figure == Figure::Angle);
    match wanted.next() {
        Some(wanted) if wanted.nominal_micro > 90_000_000 => 180_000_000 - micro,
        _ => micro,
    }
}

/// The distance of two features whose positions are `ends`, nm. It is along the direction if one is
/// given, otherwise perpendicular to a face if one feature is a face. Circles, corners, webs and
/// pockets have no height. For them the component along `upright` does not count.
pub fn distance_nm(
    [a, b]: [&Shape; 2],
    ends: [[i64; 3]; 2],
    along: Option<Vector>,
    upright: Vector,
) -> i64 {
    let displacement = minus(floats(ends[1]), floats(ends[0]));
    let is_tall = |shape: &Shape| {
        matches!(
            shape,
            Shape::Circle(_) | Shape::Corner { .. } | Shape::Width { .. }
        )
    };
    match (along, a.plane(), b.plane()) {
        (Some(along), ..) => dot(displacement, along).abs().round() as i64,
        (None, Some(plane), _) => plane.distance_nm(ends[1]).abs(),
        (None, None, Some(plane)) => plane.distance_nm(ends[0]).abs(),
        (None, None, None) if is_tall(a) || is_tall(b) => {
            length(cross(displacement, upright)).round() as i64
        }
        (None, None, None) => length(displacement).round() as i64,
    }
}

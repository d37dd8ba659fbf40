//! Features as measured.

use super::dimension::{Dimension, Figure, Verdict, Wanted};
use super::frame::Frame;
use super::site::Contact;
use super::vector::{Vector, components, cross, dot, floats, length, minus};
use husillo_probe::{Circle, Line, Plane, Sphere, UnitVector};

/// A feature with its points and its figures.
#[derive(Clone, Debug)]
pub struct Feature {
    /// `bore`, `circle`, ...
    pub keyword: &'static str,
    /// Its name.
    pub name: String,
    /// The line it was measured by.
    pub line: usize,
    /// What it is, on the machine.
    pub shape: Shape,
    /// The touches of its own.
    pub contacts: Vec<Contact>,
    /// Its points, corrected, with what is left of them.
    pub marks: Vec<Mark>,
    /// The frame it was measured in.
    pub frame: Frame,
    /// Its figures in that frame.
    pub dimensions: Vec<Dimension>,
    /// The probe has collided before or after it: nothing of it is good.
    pub is_spoiled: bool,
}

/// A point of a feature, on the machine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mark {
    /// On the surface, nm.
    pub surface_nm: [i64; 3],
    /// Out of the material, or out of the feature.
    pub normal: Vector,
    /// How far it is from the feature along the normal, nm.
    pub residual_nm: i64,
}

/// What a feature is. Points, planes and so on are on the machine.
#[derive(Clone, Copy, Debug)]
pub enum Shape {
    /// A point of a surface whose outward normal is thought to be this.
    Point {
        /// Where, nm.
        at_nm: [i64; 3],
        /// Out of the material.
        outward: UnitVector,
    },
    /// A face.
    Plane(Plane),
    /// A face along Z, and the direction in which it goes.
    Edge {
        /// The face.
        plane: Plane,
        /// The direction in which it goes.
        along: UnitVector,
    },
    /// A line; with the outward normal if it was touched.
    Line {
        /// The line.
        line: Line,
        /// Out of the material, if it was touched.
        outward: Option<UnitVector>,
    },
    /// Where two edges meet.
    Corner {
        /// Where, nm.
        at_nm: [i64; 3],
        /// The angle of the material between, millionths of a degree.
        angle_micro: i64,
    },
    /// Two faces.
    Width {
        /// The middle of both, nm.
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
    /// Between two places.
    Distance {
        /// The two places, nm.
        ends_nm: [[i64; 3]; 2],
        /// Their distance, nm.
        length_nm: i64,
    },
    /// Between two directions.
    Angle {
        /// The angle, millionths of a degree.
        angle_micro: i64,
    },
}

impl Shape {
    /// The place of a feature that has one, nm.
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

    /// The face of a feature that has one.
    pub const fn plane(&self) -> Option<&Plane> {
        match self {
            Self::Plane(plane) | Self::Edge { plane, .. } => Some(plane),
            _ => None,
        }
    }

    /// The direction of a feature that has one: of a line, or the normal of a face.
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
    /// Largest signed residual less the smallest, nm.
    pub fn form_nm(&self) -> i64 {
        let residuals = self.marks.iter().map(|mark| mark.residual_nm);
        let most = residuals.clone().max().unwrap_or_default();
        most.saturating_sub(residuals.min().unwrap_or_default())
    }

    /// Touches that count, of all points.
    pub fn touches(&self) -> u32 {
        let touches = self.contacts.iter().map(|contact| contact.touches);
        touches.map(u32::from).sum()
    }

    /// The largest spread of the touches of one point, nm.
    pub fn spread_nm(&self) -> i64 {
        let spreads = self.contacts.iter().map(|contact| contact.spread_nm);
        spreads.max().unwrap_or_default()
    }

    /// Sets the figures.
    pub fn with_figures(mut self, wanted: &[Wanted]) -> Self {
        let frame = &self.frame;
        let mut figures: Vec<(Figure, i64)> = Vec::new();
        if let Some(at_nm) = self.shape.point_nm() {
            figures.extend(Figure::PLACES.into_iter().zip(frame.to_part(at_nm)));
        }
        match &self.shape {
            Shape::Corner { angle_micro, .. } | Shape::Angle { angle_micro } => {
                // A corner is where its edges meet, at any height.
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

    /// Whether no figure is out of its tolerance, which what has none is not, and nothing has
    /// spoiled them.
    pub fn is_good(&self) -> bool {
        let mut dimensions = self.dimensions.iter();
        !self.is_spoiled && dimensions.all(|dimension| dimension.is_good() != Some(false))
    }

    /// What a figure of it is called, if it has a tolerance.
    pub fn verdict(&self, dimension: &Dimension) -> Option<Verdict> {
        let is_good = dimension.is_good()?;
        Some(match is_good {
            _ if self.is_spoiled => Verdict::Spoiled,
            true => Verdict::Good,
            false => Verdict::Out,
        })
    }

    /// Nothing of it is good any more.
    pub const fn spoil(&mut self) {
        self.is_spoiled = true;
    }
}

/// So many points a feature goes through without anything left.
const fn least_for_form(shape: &Shape) -> usize {
    match shape {
        Shape::Edge { .. } | Shape::Line { .. } => 2,
        Shape::Plane(_) | Shape::Circle(_) => 3,
        Shape::Sphere(_) => 4,
        _ => usize::MAX,
    }
}

/// The angle of a direction to X in the plane of X and Y, millionths of a degree: within half a
/// turn of what is wanted, as a line has no front.
fn heading_micro(frame: &Frame, direction: &UnitVector, wanted: &[Wanted]) -> i64 {
    const HALF_TURN: i64 = 180_000_000;
    let [x, y, _] = frame.direction_to_part(direction);
    let micro = (y.atan2(x).to_degrees() * 1e6).round() as i64;
    let mut wanted = wanted
        .iter()
        .filter(|wanted| wanted.figure == Figure::Angle);
    let about = wanted.next().map_or(0, |wanted| wanted.nominal_micro);
    // -90 degrees are 90.
    about + HALF_TURN / 2 - (HALF_TURN / 2 - (micro - about)).rem_euclid(HALF_TURN)
}

/// The angle of two directions without front, 0 to 90 degrees, or to 180 where the wanted one is
/// beyond 90; millionths.
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

/// The distance of two places of features, nm: at right angles to a face, if one is a face; along a
/// direction, if given. Circles, corners, webs and pockets are where they are at any height, so
/// between them and others `upright` does not count.
pub fn distance_nm(
    a: &Shape,
    b: &Shape,
    along: Option<Vector>,
    upright: Vector,
) -> Option<([[i64; 3]; 2], i64)> {
    let ends = [a.point_nm()?, b.point_nm()?];
    let way = minus(floats(ends[1]), floats(ends[0]));
    let is_tall = |shape: &Shape| {
        matches!(
            shape,
            Shape::Circle(_) | Shape::Corner { .. } | Shape::Width { .. }
        )
    };
    let nm = match (along, a.plane(), b.plane()) {
        (Some(along), ..) => dot(way, along).abs().round() as i64,
        (None, Some(plane), _) => plane.distance_nm(ends[1]).abs(),
        (None, None, Some(plane)) => plane.distance_nm(ends[0]).abs(),
        (None, None, None) if is_tall(a) || is_tall(b) => {
            length(cross(way, upright)).round() as i64
        }
        (None, None, None) => length(way).round() as i64,
    };
    Some((ends, nm))
}

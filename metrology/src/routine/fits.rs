//! Fits of features to touches, with the radius and the pre-travel of the tip.

use super::failure::Failure;
use super::feature::{Mark, Shape};
use super::frame::Frame;
use super::site::{Contact, outward};
use super::vector::{
    self, Vector, components, cross, direction, dot, floats, halfway, minus, scaled,
};
use crate::heads::Stylus;
use husillo_probe::{Circle, Line, Middle, Plane, Sphere, UnitVector};

/// The points that features are fitted to, on the machine.
#[derive(Clone, Debug)]
pub enum Points {
    /// Touches. Features are fitted to the centres of the ball, and then moved by its radius along
    /// their own normal. So the direction of travel causes no error.
    Touched(Vec<Contact>),
    /// Positions of other features, nm.
    Found(Vec<[i64; 3]>),
}

/// A fitted shape with its points.
pub type Fitted = (Shape, Vec<Mark>);

impl Points {
    fn centres(&self) -> Vec<[i64; 3]> {
        match self {
            Self::Touched(contacts) => contacts.iter().map(|contact| contact.centre_nm).collect(),
            Self::Found(points) => points.clone(),
        }
    }

    /// The points of the surface. Two functions compute the normal out of the material, and the
    /// distance from the feature.
    fn marks(
        &self,
        tip: &Stylus,
        normal: impl Fn([i64; 3]) -> UnitVector,
        residual: impl Fn([i64; 3]) -> i64,
    ) -> Vec<Mark> {
        let mark = |surface_nm, normal: &UnitVector| Mark {
            surface_nm,
            normal: components(normal),
            residual_nm: residual(surface_nm),
        };
        match self {
            Self::Touched(contacts) => contacts
                .iter()
                .map(|contact| {
                    let normal = normal(contact.centre_nm);
                    let at = tip.surface_nm(contact.latched_nm, &contact.travel, &normal);
                    mark(at, &normal)
                })
                .collect(),
            Self::Found(points) => points.iter().map(|at| mark(*at, &normal(*at))).collect(),
        }
    }
}

/// A single point. Its normal is opposite to the travel.
pub fn point(contact: &Contact, tip: &Stylus) -> Fitted {
    let outward = contact.travel.reversed();
    let at_nm = tip.surface_nm(contact.latched_nm, &contact.travel, &outward);
    let mark = Mark {
        surface_nm: at_nm,
        normal: components(&outward),
        residual_nm: 0,
    };
    (Shape::Point { at_nm, outward }, vec![mark])
}

/// A face.
///
/// # Errors
///
/// There are too few points, or all are in a line.
pub fn plane(points: &Points, tip: &Stylus, frame: &Frame) -> Result<Fitted, Failure> {
    let (outward, radius_nm) = match points {
        Points::Touched(contacts) => (outward(contacts)?, i64::from(tip.radius_nm)),
        Points::Found(_) => (frame.upright(), 0),
    };
    let plane = Plane::fit(points.centres(), &outward)?.moved_nm(-radius_nm);
    let marks = points.marks(tip, |_| plane.normal, |at| plane.distance_nm(at));
    Ok((Shape::Plane(plane), marks))
}

/// An edge: a face parallel to Z of the frame, from one or more touches.
///
/// # Errors
///
/// All points are on one vertical line.
pub fn edge(contacts: &[Contact], tip: &Stylus, frame: &Frame) -> Result<Fitted, Failure> {
    let outward = outward(contacts)?;
    let points = Points::Touched(contacts.to_vec());
    let upright = frame.upright();
    let plane = match contacts {
        [_] => Plane::across(points.centres(), &outward)?,
        _ => Plane::edge(points.centres(), &upright, &outward)?,
    };
    let plane = plane.moved_nm(-i64::from(tip.radius_nm));
    let along = cross(components(&upright), components(&plane.normal));
    let along = direction(along).ok_or(Failure::Parallel)?;
    let marks = points.marks(tip, |_| plane.normal, |at| plane.distance_nm(at));
    Ok((Shape::Edge { plane, along }, marks))
}

/// The intersection of two edges with the same number of touches.
///
/// # Errors
///
/// The edges are parallel.
pub fn corner(contacts: &[Contact], tip: &Stylus, frame: &Frame) -> Result<Fitted, Failure> {
    let (first, second) = contacts.split_at(contacts.len() / 2);
    let (a, mut marks) = edge(first, tip, frame)?;
    let (b, more) = edge(second, tip, frame)?;
    marks.extend(more);
    let (Some(face), Some(other)) = (a.plane(), b.plane()) else {
        return Err(Failure::Parallel);
    };
    let height = Plane::new(halfway(face.point_nm, other.point_nm), frame.upright());
    let at_nm = husillo_probe::corner_nm(face, other, &height).ok_or(Failure::Parallel)?;
    // The angle of the material and the angle of the outward normals add up to 180 degrees.
    let between = dot(components(&face.normal), components(&other.normal));
    let angle = 180.0 - between.clamp(-1.0, 1.0).acos().to_degrees();
    let angle_micro = (angle * 1e6).round() as i64;
    Ok((Shape::Corner { at_nm, angle_micro }, marks))
}

/// Two opposite faces, and their distance along the direction of their touches.
///
/// # Errors
///
/// There are not exactly two touches.
pub fn width(contacts: &[Contact], tip: &Stylus) -> Result<Fitted, Failure> {
    let [a, b] = contacts else {
        return Err(Failure::Fit(husillo_probe::FitError::TooFewPoints));
    };
    let surface = |contact: &Contact| point(contact, tip);
    let (((first, marks), (second, more)), travel) = ((surface(a), surface(b)), a.travel);
    let (Some(first), Some(second)) = (first.point_nm(), second.point_nm()) else {
        return Err(Failure::Parallel);
    };
    let middle = Middle::of(first, second, &travel);
    let shape = Shape::Width {
        centre_nm: middle.centre_nm,
        width_nm: middle.width_nm,
        ends_nm: [first, second],
    };
    Ok((shape, [marks, more].concat()))
}

/// A line.
///
/// # Errors
///
/// The points have no direction.
pub fn line(points: &Points, tip: &Stylus) -> Result<Fitted, Failure> {
    let centres = points.centres();
    let ends = centres.first().zip(centres.last());
    let displacement = ends.and_then(|(a, b)| direction(minus(floats(*b), floats(*a))));
    let fitted = Line::fit(
        centres.iter().copied(),
        &displacement.ok_or(Failure::Parallel)?,
    )?;
    let Points::Touched(contacts) = points else {
        let off = |at| fitted.distance_nm(at);
        let marks = points.marks(tip, |at| away(fitted.point_nm, &fitted, at), off);
        let shape = Shape::Line {
            line: fitted,
            outward: None,
        };
        return Ok((shape, marks));
    };
    let along = components(&fitted.direction);
    let normal = vector::across(components(&outward(contacts)?), along);
    let outward = normal.and_then(direction).ok_or(Failure::Parallel)?;
    let moved = outward.scaled(-i64::from(tip.radius_nm));
    let line = Line {
        point_nm: std::array::from_fn(|axis| fitted.point_nm[axis].saturating_add(moved[axis])),
        ..fitted
    };
    let off = |at: [i64; 3]| {
        let displacement = minus(floats(at), floats(line.point_nm));
        dot(displacement, components(&outward)).round() as i64
    };
    let marks = points.marks(tip, |_| outward, off);
    let shape = Shape::Line {
        line,
        outward: Some(outward),
    };
    Ok((shape, marks))
}

/// The direction from a line to a point, perpendicular to the line. Z if the point is on the line.
fn away(origin_nm: [i64; 3], line: &Line, at: [i64; 3]) -> UnitVector {
    let along = components(&line.direction);
    let displacement = minus(floats(at), floats(origin_nm));
    let across = vector::across(displacement, along);
    across.and_then(direction).unwrap_or(UnitVector::Z)
}

/// A circle around Z of the frame.
///
/// # Errors
///
/// The points are in a line, or were touched from both sides.
pub fn circle(points: &Points, tip: &Stylus, frame: &Frame) -> Result<Fitted, Failure> {
    let axis = frame.upright();
    let circle = Circle::fit(points.centres(), &axis)?;
    let ray = |at: [i64; 3]| {
        let displacement = minus(floats(at), floats(circle.centre_nm));
        vector::across(displacement, components(&axis)).unwrap_or([1.0, 0.0, 0.0])
    };
    let side = side(points, ray)?;
    let circle = circle.grown_nm(side.growth_nm(tip));
    let normal = |at| direction(scaled(ray(at), side.normal())).unwrap_or(UnitVector::X);
    let marks = points.marks(tip, normal, |at| circle.distance_nm(at));
    Ok((Shape::Circle(circle), outwards(marks, side)))
}

/// A sphere.
///
/// # Errors
///
/// The points are in a plane, or were touched from both sides.
pub fn sphere(points: &Points, tip: &Stylus) -> Result<Fitted, Failure> {
    let sphere = Sphere::fit(points.centres())?;
    let ray = |at: [i64; 3]| {
        let displacement = minus(floats(at), floats(sphere.centre_nm));
        scaled(displacement, 1.0 / vector::length(displacement).max(1.0))
    };
    let side = side(points, ray)?;
    let sphere = sphere.grown_nm(side.growth_nm(tip));
    let normal = |at| direction(scaled(ray(at), side.normal())).unwrap_or(UnitVector::Z);
    let marks = points.marks(tip, normal, |at| sphere.distance_nm(at));
    Ok((Shape::Sphere(sphere), outwards(marks, side)))
}

/// Turns the normals of a round feature away from its middle, whichever side was touched.
fn outwards(mut marks: Vec<Mark>, side: Side) -> Vec<Mark> {
    for mark in &mut marks {
        mark.normal = scaled(mark.normal, side.normal());
    }
    marks
}

/// The side from which a round feature was touched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Side {
    Inside,
    Outside,
    /// Not touched: its points are positions of other features.
    Untouched,
}

impl Side {
    /// Sign of the direction out of the material, along the ray from the middle.
    const fn normal(self) -> f64 {
        match self {
            Self::Inside => -1.0,
            Self::Outside | Self::Untouched => 1.0,
        }
    }

    fn growth_nm(self, tip: &Stylus) -> i64 {
        match self {
            Self::Inside => tip.radius_nm.into(),
            Self::Outside => -i64::from(tip.radius_nm),
            Self::Untouched => 0,
        }
    }
}

fn side(points: &Points, ray: impl Fn([i64; 3]) -> Vector) -> Result<Side, Failure> {
    let Points::Touched(contacts) = points else {
        return Ok(Side::Untouched);
    };
    let is_outwards =
        |contact: &Contact| dot(components(&contact.travel), ray(contact.centre_nm)) > 0.0;
    let inside = contacts
        .iter()
        .filter(|contact| is_outwards(contact))
        .count();
    match inside {
        0 => Ok(Side::Outside),
        all if all == contacts.len() => Ok(Side::Inside),
        _ => Err(Failure::BothSides),
    }
}

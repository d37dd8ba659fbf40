//! The frame of a part from a plane, a line and a point.

use super::failure::Failure;
use super::feature::{Feature, Shape};
use super::frame::Frame;
use super::vector::{
    Vector, across, components, cross, direction, dot, floats, nearest_axis, plus, scaled,
};
use crate::heads::Stylus;
use husillo_probe::UnitVector;

/// 3-2-1 alignment. The plane gives the direction of a first axis and the position on it. The line
/// gives the direction of a second axis and the position on the third. The point gives the position
/// on the second axis. Each direction belongs to the nearest axis of the previous frame.
///
/// The radius of the ball is subtracted along the axes that were found, not along the travel. So
/// the rotation of the part causes no error, as long as the tip can touch it.
///
/// # Errors
///
/// The line is perpendicular to the plane, or a feature has the wrong shape.
pub fn align(
    of: [&Feature; 3],
    called_nm: [i64; 3],
    before: &Frame,
    tip: &Stylus,
) -> Result<Frame, Failure> {
    let [plane, line, point] = of;
    let face = plane.shape.plane().ok_or(Failure::NoFrame)?;
    let along = match &line.shape {
        Shape::Line { line, .. } => components(&line.direction),
        Shape::Edge { along, .. } => components(along),
        _ => return Err(Failure::NoFrame),
    };
    let (first, sign) = nearest_axis(before.direction_to_part(&face.normal), None);
    let normal = scaled(components(&face.normal), sign);
    let along = across(along, normal).ok_or(Failure::NoFrame)?;
    let direction = direction(along).ok_or(Failure::NoFrame)?;
    let (second, sign) = nearest_axis(before.direction_to_part(&direction), Some(first));
    let along = scaled(along, sign);
    let third = 3 - first - second;
    // If the order of the axes is cyclic, the frame is right-handed.
    let is_cyclic = (first + 1) % 3 == second;
    let last = if is_cyclic {
        cross(normal, along)
    } else {
        cross(along, normal)
    };
    let mut axes: [Vector; 3] = [[0.0; 3]; 3];
    (axes[first], axes[second], axes[third]) = (normal, along, last);

    let at = plus(
        plus(
            scaled(normal, dot(floats(face.point_nm), normal)),
            scaled(along, place_along(point, along, tip)),
        ),
        scaled(last, place_along(line, last, tip)),
    );
    Ok(Frame::new(axes, at, called_nm))
}

/// Position of a feature on an axis, nm.
fn place_along(feature: &Feature, axis: Vector, tip: &Stylus) -> f64 {
    let outward: Option<&UnitVector> = match &feature.shape {
        Shape::Point { outward, .. } => Some(outward),
        Shape::Line { outward, .. } => outward.as_ref(),
        _ => None,
    };
    let across = outward.map_or(0.0, |outward| dot(components(outward), axis));
    // The radius counts only if the feature was touched more along this axis than perpendicular to
    // it.
    if across.abs() < 0.5 || feature.contacts.is_empty() {
        return dot(floats(feature.shape.point_nm().unwrap_or_default()), axis);
    }
    let places = feature.contacts.iter();
    let sum: f64 = places
        .map(|contact| dot(floats(contact.centre_nm), axis))
        .sum();
    let radius = f64::from(tip.radius_nm).copysign(across);
    sum / feature.contacts.len() as f64 - radius
}

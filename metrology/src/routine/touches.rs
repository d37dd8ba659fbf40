//! The path of the tip: the touches of a feature, and the moves between them.

use super::failure::Failure;
use super::site::{Contact, Site, beyond};
use super::statement::{Job, Place};
use super::vector::{Vector, cross, scaled};

pub(super) const UP: Vector = [0.0, 0.0, 1.0];

impl Site<'_> {
    /// Makes all touches of a job and returns them in order. A job that only calculates has none.
    ///
    /// # Errors
    ///
    /// [`Failure`] of the machine.
    pub(super) fn contacts(&mut self, job: &Job) -> Result<Vec<Contact>, Failure> {
        match job {
            Job::Touch { towards, within_nm } => {
                let reach_nm = within_nm.unwrap_or(self.reach_nm());
                Ok(vec![self.touch(*towards, reach_nm)?])
            }
            Job::Point { at, towards } => self.face(&[*at], *towards),
            Job::Plane { at, towards } | Job::Line { at, towards } => self.face(at, *towards),
            &Job::Edge {
                at,
                towards,
                points,
                over_nm,
            } => self.edge(at, towards, points, over_nm),
            &Job::Corner {
                at,
                towards,
                inset_nm,
                is_inside,
            } => self.corner(at, towards, inset_nm, is_inside),
            &Job::Width {
                at,
                along,
                width_nm,
                is_inside,
            } => {
                let centre = self.place(at)?;
                self.around(centre, width_nm, &[along, scaled(along, -1.0)], is_inside)
            }
            &Job::Round {
                at,
                diameter_nm,
                points,
                arc_deg,
                is_inside,
            } => {
                let centre = self.place(at)?;
                self.around(centre, diameter_nm, &spokes(points, arc_deg), is_inside)
            }
            &Job::Sphere {
                at,
                diameter_nm,
                points,
            } => self.sphere(at, diameter_nm, points),
            Job::Fit { .. } | Job::Distance { .. } | Job::Angle { .. } => Ok(Vec::new()),
        }
    }

    /// Touches a surface that should be at a point of the part. The tip starts at its standoff and
    /// returns there.
    fn touch_surface(
        &mut self,
        surface_nm: [i64; 3],
        towards: Vector,
        is_direct: bool,
    ) -> Result<Contact, Failure> {
        let before = beyond(surface_nm, towards, -self.standoff_nm());
        if is_direct {
            self.go_to(before)?;
        } else {
            self.travel_to(before)?;
        }
        let contact = self.touch(towards, self.reach_nm())?;
        self.go_to(before)?;
        Ok(contact)
    }

    fn face(&mut self, places: &[Place], towards: Vector) -> Result<Vec<Contact>, Failure> {
        let mut contacts = Vec::new();
        for place in places {
            let surface = self.place(*place)?;
            contacts.push(self.touch_surface(surface, towards, false)?);
        }
        Ok(contacts)
    }

    /// Touches in a row. Between touches the tip keeps its distance from the edge.
    fn edge(
        &mut self,
        at: Place,
        towards: Vector,
        points: u32,
        over_nm: i64,
    ) -> Result<Vec<Contact>, Failure> {
        let middle = self.place(at)?;
        let along = cross(UP, towards);
        let mut contacts = Vec::new();
        for point in 0..points {
            let part = match points {
                1 => 0.0,
                _ => f64::from(point) / f64::from(points - 1) - 0.5,
            };
            let surface = beyond(middle, along, (over_nm as f64 * part).round() as i64);
            contacts.push(self.touch_surface(surface, towards, point > 0)?);
        }
        Ok(contacts)
    }

    /// Two touches on the first face and two on the second. If the corner is touched from outside,
    /// the tip moves around it.
    fn corner(
        &mut self,
        at: Place,
        [first, second]: [Vector; 2],
        inset_nm: i64,
        is_inside: bool,
    ) -> Result<Vec<Contact>, Failure> {
        let corner = self.place(at)?;
        // In a pocket a face extends from the corner against the direction of travel to the other
        // face.
        let step = if is_inside { -inset_nm } else { inset_nm };
        let mut contacts = Vec::new();
        for (inset, is_direct) in [(2, false), (1, true)] {
            let surface = beyond(corner, second, step * inset);
            contacts.push(self.touch_surface(surface, first, is_direct)?);
        }
        if !is_inside {
            let round = beyond(corner, first, -self.standoff_nm());
            self.go_to(beyond(round, second, -self.standoff_nm()))?;
        }
        for inset in [1, 2] {
            let surface = beyond(corner, first, step * inset);
            contacts.push(self.touch_surface(surface, second, true)?);
        }
        Ok(contacts)
    }

    /// Touches a round feature or two opposite faces: outwards from the middle if `is_inside`,
    /// otherwise inwards.
    fn around(
        &mut self,
        centre: [i64; 3],
        diameter_nm: i64,
        spokes: &[Vector],
        is_inside: bool,
    ) -> Result<Vec<Contact>, Failure> {
        let mut contacts = Vec::new();
        if !is_inside {
            for spoke in spokes {
                let surface = beyond(centre, *spoke, diameter_nm / 2);
                contacts.push(self.touch_surface(surface, scaled(*spoke, -1.0), false)?);
            }
            return Ok(contacts);
        }
        self.travel_to(centre)?;
        // If a hole is too small for the clearance, touches begin in its middle.
        let reach_nm = (diameter_nm / 2 - self.radius_nm()).max(0);
        let start_nm = (reach_nm - self.clearance_nm).max(0);
        for spoke in spokes {
            let start = beyond(centre, *spoke, start_nm);
            self.go_to(start)?;
            contacts.push(self.touch(*spoke, reach_nm - start_nm + self.search_nm)?);
            self.go_to(start)?;
        }
        self.go_to(centre)?;
        Ok(contacts)
    }

    /// Touches the upper half from the pole down to the equator. The moves between touches go over
    /// the top.
    fn sphere(
        &mut self,
        at: Place,
        diameter_nm: i64,
        points: u32,
    ) -> Result<Vec<Contact>, Failure> {
        let centre = self.place(at)?;
        let radius_nm = diameter_nm / 2;
        let top_nm = centre[2] + radius_nm + self.standoff_nm();
        let height_nm = self.safe_nm.map_or(top_nm, |safe_nm| safe_nm.max(top_nm));
        let mut contacts = Vec::new();
        for spoke in hemisphere(points) {
            let before = beyond(centre, spoke, radius_nm + self.standoff_nm());
            self.travel_over(before, height_nm)?;
            contacts.push(self.touch(scaled(spoke, -1.0), self.reach_nm())?);
            self.go_to(before)?;
        }
        Ok(contacts)
    }
}

/// Directions around Z, evenly spaced over a whole turn, or over an arc including both ends.
pub(super) fn spokes(points: u32, [from, to]: [f64; 2]) -> Vec<Vector> {
    let is_whole = to - from >= 360.0;
    let gaps = if is_whole { points } else { points - 1 };
    let angle = |point: u32| from + (to - from) * f64::from(point) / f64::from(gaps);
    let spoke = |point| {
        let radians: f64 = f64::to_radians(angle(point));
        [radians.cos(), radians.sin(), 0.0].map(whole)
    };
    (0..points).map(spoke).collect()
}

/// Directions of the upper half: a spiral with equal steps in height, each rotated by the golden
/// angle. So no great circle contains most of them.
pub(super) fn hemisphere(points: u32) -> Vec<Vector> {
    let golden = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
    let spoke = |point: u32| {
        let height = 1.0 - f64::from(point) / f64::from(points - 1);
        let (width, angle) = ((1.0 - height * height).sqrt(), golden * f64::from(point));
        [width * angle.cos(), width * angle.sin(), height].map(whole)
    };
    (0..points).map(spoke).collect()
}

/// Rounds the last bits of a cosine of 90 degrees to 0.
fn whole(part: f64) -> f64 {
    if part.abs() < 1e-12 { 0.0 } else { part }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions() {
        let four = spokes(4, [0.0, 360.0]);
        assert_eq!(four[1], [0.0, 1.0, 0.0]);
        let half = spokes(3, [0.0, 180.0]);
        assert_eq!(half[2], [-1.0, 0.0, 0.0]);
        let cap = hemisphere(9);
        assert_eq!((cap[0], cap[8][2]), (UP, 0.0));
        assert!(
            cap.iter()
                .all(|spoke| (crate::routine::vector::length(*spoke) - 1.0).abs() < 1e-12)
        );
    }
}

//! A machine with a probe, and the frame in which it measures.

use super::failure::Failure;
use super::frame::Frame;
use super::statement::Place;
use super::vector::{self, Vector, components, floats, plus, scaled};
use crate::heads::{Approach, Prober, Stylus};
use husillo_probe::UnitVector;
use std::fmt;

/// A touch, on the machine.
#[derive(Clone, Copy, Debug)]
pub struct Contact {
    /// Latched position of the centre of the tip, nm.
    pub latched_nm: [i64; 3],
    /// The position at the contact, nm: the latched position without the pre-travel.
    pub centre_nm: [i64; 3],
    /// The direction of travel.
    pub travel: UnitVector,
    /// Number of slow touches in the mean.
    pub touches: u8,
    /// Distance between the nearest and the farthest of them, nm.
    pub spread_nm: i64,
}

/// The machine, the probe and the frame of a routine.
pub struct Site<'a> {
    prober: &'a mut dyn Prober,
    /// Radius and pre-travel.
    pub tip: Stylus,
    /// The frame of coordinates.
    pub frame: Frame,
    /// Name of the frame in the routine: `machine`, or the features that define it.
    pub frame_name: String,
    /// Distance before a surface at which touches begin, nm.
    pub clearance_nm: i64,
    /// Distance behind a surface at which touches end, nm.
    pub search_nm: i64,
    /// Safe height for the moves between features, nm. `None`: the moves are direct.
    pub safe_nm: Option<i64>,
    /// The reaction of moves to an unexpected contact.
    pub approach: Approach,
}

impl fmt::Debug for Site<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut text = out.debug_struct("Site");
        text.field("tip", &self.tip).field("frame", &self.frame);
        text.field("clearance_nm", &self.clearance_nm)
            .field("search_nm", &self.search_nm)
            .field("safe_nm", &self.safe_nm)
            .field("approach", &self.approach);
        text.finish_non_exhaustive()
    }
}

impl<'a> Site<'a> {
    /// A site with the frame of the machine, 2 mm of clearance, 2 mm of search, and guarded moves.
    pub fn new(prober: &'a mut dyn Prober, tip: Stylus) -> Self {
        Self {
            prober,
            tip,
            frame: Frame::MACHINE,
            frame_name: "machine".into(),
            clearance_nm: 2_000_000,
            search_nm: 2_000_000,
            safe_nm: None,
            approach: Approach::Guarded,
        }
    }

    /// The machine that moves the probe.
    pub fn prober(&mut self) -> &mut dyn Prober {
        self.prober
    }

    /// Whether there was a collision.
    pub fn has_collided(&self) -> bool {
        self.prober.has_collided()
    }

    /// Radius of the tip, nm.
    pub fn radius_nm(&self) -> i64 {
        self.tip.radius_nm.into()
    }

    /// Distance of the centre of the tip from a surface at the start of a touch, nm.
    pub(super) fn standoff_nm(&self) -> i64 {
        self.radius_nm() + self.clearance_nm
    }

    /// Longest distance of a touch, nm.
    pub(super) fn reach_nm(&self) -> i64 {
        self.clearance_nm + self.search_nm
    }

    /// Position of the centre of the tip on the machine, nm.
    ///
    /// # Errors
    ///
    /// The line fails.
    pub fn machine_position(&mut self) -> Result<[i64; 3], Failure> {
        Ok(self.prober.position()?)
    }

    /// Position of the centre of the tip on the part, nm.
    ///
    /// # Errors
    ///
    /// The line fails.
    pub fn position(&mut self) -> Result<[i64; 3], Failure> {
        Ok(self.frame.to_part(self.prober.position()?))
    }

    /// Completes a position: missing coordinates are those of the tip.
    ///
    /// # Errors
    ///
    /// The line fails.
    pub(super) fn place(&mut self, place: Place) -> Result<[i64; 3], Failure> {
        if let [Some(x), Some(y), Some(z)] = place {
            return Ok([x, y, z]);
        }
        let here = self.position()?;
        Ok(std::array::from_fn(|axis| {
            place[axis].unwrap_or(here[axis])
        }))
    }

    /// Moves to a point of the part along a straight path.
    ///
    /// # Errors
    ///
    /// The machine fails.
    pub fn go_to(&mut self, part_nm: [i64; 3]) -> Result<(), Failure> {
        self.go_by(self.approach, part_nm)
    }

    /// Moves to a point of the part with an approach of its own.
    ///
    /// # Errors
    ///
    /// The machine fails.
    pub(super) fn go_by(&mut self, approach: Approach, part_nm: [i64; 3]) -> Result<(), Failure> {
        let goal = self.frame.to_machine(part_nm);
        match approach {
            Approach::Rapid => self.prober.go_to(goal)?,
            Approach::Guarded => self.prober.guarded_to(goal)?,
        };
        Ok(())
    }

    /// Moves to a point of the part. If there is a safe height, the path leads up to this height,
    /// over the point, and down.
    ///
    /// # Errors
    ///
    /// The machine fails.
    pub(super) fn travel_to(&mut self, part_nm: [i64; 3]) -> Result<(), Failure> {
        let Some(safe_nm) = self.safe_nm else {
            return self.go_to(part_nm);
        };
        self.travel_over(part_nm, safe_nm)
    }

    /// Moves to a point of the part by way of a given safe height.
    ///
    /// # Errors
    ///
    /// The machine fails.
    pub(super) fn travel_over(&mut self, part_nm: [i64; 3], height_nm: i64) -> Result<(), Failure> {
        let [here_x, here_y, here_z] = self.position()?;
        let [x, y, z] = part_nm;
        // If the tip is above the point, within the error of axes at rest, the move is straight
        // down.
        let is_above = (here_x - x).abs().max((here_y - y).abs()) <= NEAR_NM;
        let height_nm = height_nm.max(here_z).max(z);
        if !is_above {
            if height_nm > here_z {
                self.go_to([here_x, here_y, height_nm])?;
            }
            if height_nm > z {
                self.go_to([x, y, height_nm])?;
            }
        }
        self.go_to(part_nm)
    }

    /// Touches along a direction of the part, from the present position within `distance_nm`.
    ///
    /// # Errors
    ///
    /// The machine fails, or there is no contact.
    pub(super) fn touch(&mut self, travel: Vector, distance_nm: i64) -> Result<Contact, Failure> {
        let travel = self
            .frame
            .direction_to_machine(travel)
            .ok_or(Failure::NoDirection)?;
        self.touch_along(travel, distance_nm.unsigned_abs())
    }

    /// Touches along a direction of the machine.
    ///
    /// # Errors
    ///
    /// The machine fails, or there is no contact.
    pub(super) fn touch_along(
        &mut self,
        travel: UnitVector,
        distance_nm: u64,
    ) -> Result<Contact, Failure> {
        let touched = self.prober.touch(&travel, distance_nm)?;
        Ok(Contact {
            latched_nm: touched.centre_nm,
            centre_nm: self.tip.centre_nm(touched.centre_nm, &travel),
            travel,
            touches: touched.touches,
            spread_nm: touched.spread_nm,
        })
    }

    /// Makes these coordinates of the present position 0. The safe height keeps its position on the
    /// machine.
    ///
    /// # Errors
    ///
    /// The line fails.
    pub(super) fn zero(&mut self, axes: [bool; 3]) -> Result<(), Failure> {
        let here = self.machine_position()?;
        self.change_frame(self.frame.zeroed(here, axes), here);
        let axes = "xyz".chars().zip(axes).filter(|(_, is_zeroed)| *is_zeroed);
        self.frame_name.push_str(", zero moved in ");
        self.frame_name.extend(axes.map(|(axis, _)| axis));
        Ok(())
    }

    /// Changes the frame. The tip is at `here_nm`. The safe height keeps its distance above the
    /// tip.
    pub(super) fn change_frame(&mut self, frame: Frame, here_nm: [i64; 3]) {
        if let Some(safe_nm) = self.safe_nm {
            let [x, y, _] = self.frame.to_part(here_nm);
            let [.., safe_nm] = frame.to_part(self.frame.to_machine([x, y, safe_nm]));
            self.safe_nm = Some(safe_nm);
        }
        self.frame = frame;
    }
}

/// In moves between features, positions that are at most this far apart are the same, nm.
const NEAR_NM: i64 = 10_000;

/// The point at the distance `by_nm` from another along a direction, whose length is not 0.
pub fn beyond(point_nm: [i64; 3], direction: Vector, by_nm: i64) -> [i64; 3] {
    let size = vector::length(direction);
    let displacement = scaled(direction, by_nm as f64 / size);
    plus(floats(point_nm), displacement).map(|nm| nm.round() as i64)
}

/// The mean direction out of the touched surface: the sum of the reversed directions of travel.
pub fn outward(contacts: &[Contact]) -> Result<UnitVector, Failure> {
    let sum = contacts.iter().fold([0.0; 3], |sum, contact| {
        plus(sum, components(&contact.travel.reversed()))
    });
    vector::direction(sum)
        .filter(|_| vector::length(sum) > 1e-6)
        .ok_or(Failure::BothSides)
}

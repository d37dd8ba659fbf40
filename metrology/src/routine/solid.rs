//! Ideal solids and a machine that touches them, for tests.

use super::frame::Frame;
use super::vector::{Vector, components, dot, floats, length, minus, plus, scaled};
use crate::Error;
use crate::heads::Stylus;
use crate::heads::{Probed, Prober, Touched};
use husillo_probe::{Edge, UnitVector};

/// A body of the part. Lengths are in nm.
#[derive(Clone, Copy, Debug)]
pub enum Body {
    /// A box between its lowest and highest corner.
    Block([i64; 3], [i64; 3]),
    /// A hole along Z down to `floor` in the bodies before it in the list.
    Hole {
        centre: [i64; 2],
        radius: i64,
        floor: i64,
    },
    /// A hole with four sides, between its lowest and highest corner.
    Pocket([i64; 3], [i64; 3]),
    /// A pin along Z.
    Pin {
        centre: [i64; 2],
        radius: i64,
        top: i64,
    },
    /// A ball with its centre and radius.
    Ball([i64; 3], i64),
}

/// A part made of bodies, on a machine that moves exactly and latches exactly. The pre-travel of
/// the tip is added to the latched positions.
pub struct Ideal {
    pub bodies: Vec<Body>,
    /// Frame of the part.
    pub place: Frame,
    pub tip: Stylus,
    /// Position of the tip on the machine, nm.
    pub at: [i64; 3],
    /// Number of straight moves.
    pub moves: usize,
    /// Number of guarded moves among them.
    pub guarded: usize,
    /// Requested speeds, nm per minute.
    pub speeds: Vec<u64>,
}

/// Largest depth of a pressed tip, nm: pre-travel and braking.
const PRESSED_NM: f64 = 20_000.0;
/// Braking distance after a change of the contact, nm.
const BRAKING_NM: f64 = 3_000.0;

impl Ideal {
    /// Distance from the surface of the ball to the part, nm. Negative inside of the part.
    fn gap(&self, machine: Vector) -> f64 {
        let part = floats(self.place.to_part(machine.map(|nm| nm.round() as i64)));
        // The frame keeps lengths, so only the rounding to nm is lost.
        let mut gap = f64::MAX;
        for body in &self.bodies {
            gap = match *body {
                Body::Block(low, high) => gap.min(outside(part, low, high)),
                Body::Ball(centre, radius) => {
                    let displacement = minus(part, floats(centre));
                    gap.min(length(displacement) - radius as f64)
                }
                Body::Pin {
                    centre: [x, y],
                    radius,
                    top,
                } => {
                    let side = (part[0] - x as f64).hypot(part[1] - y as f64) - radius as f64;
                    gap.min(joined(side, part[2] - top as f64))
                }
                Body::Hole {
                    centre: [x, y],
                    radius,
                    floor,
                } => {
                    let side = radius as f64 - (part[0] - x as f64).hypot(part[1] - y as f64);
                    let inner = side.min(part[2] - floor as f64);
                    gap.max(inner)
                }
                Body::Pocket(low, high) => {
                    let sides = (0..2).map(|axis| {
                        (part[axis] - low[axis] as f64).min(high[axis] as f64 - part[axis])
                    });
                    let inner = sides.fold(part[2] - low[2] as f64, f64::min);
                    gap.max(inner)
                }
            };
        }
        gap - f64::from(self.tip.radius_nm)
    }
}

/// Combines the distances from two perpendicular faces. Outside of both the result is the distance
/// from their edge.
fn joined(a: f64, b: f64) -> f64 {
    a.max(0.0).hypot(b.max(0.0)) + a.max(b).min(0.0)
}

fn outside(part: Vector, low: [i64; 3], high: [i64; 3]) -> f64 {
    let off: Vector = std::array::from_fn(|axis| {
        (low[axis] as f64 - part[axis]).max(part[axis] - high[axis] as f64)
    });
    length(off.map(|displacement| displacement.max(0.0))) + off[0].max(off[1]).max(off[2]).min(0.0)
}

impl Prober for Ideal {
    fn position(&mut self) -> Result<[i64; 3], Error> {
        Ok(self.at)
    }

    fn go_to(&mut self, goal_nm: [i64; 3]) -> Result<[i64; 3], Error> {
        let (from, displacement) = (floats(self.at), minus(floats(goal_nm), floats(self.at)));
        let length = length(displacement);
        self.moves += 1;
        let mut gone = 0.0;
        while gone < length {
            let gap = self.gap(plus(from, scaled(displacement, gone / length)));
            if gap < -PRESSED_NM {
                return Err(Error::PositionError {
                    at: format!("{:?} to {goal_nm:?}, after {gone} nm", self.at),
                });
            }
            gone += gap.max(10_000.0);
        }
        self.at = goal_nm;
        Ok(goal_nm)
    }

    fn guarded_to(&mut self, goal_nm: [i64; 3]) -> Result<[i64; 3], Error> {
        self.guarded += 1;
        self.go_to(goal_nm)
    }

    fn feed_to(&mut self, goal_nm: [i64; 3], nm_per_min: u64) -> Result<[i64; 3], Error> {
        self.speeds.push(nm_per_min);
        self.go_to(goal_nm)
    }

    fn has_collided(&self) -> bool {
        false
    }

    fn probe_to(
        &mut self,
        goal_nm: [i64; 3],
        nm_per_min: u64,
        until: Edge,
    ) -> Result<Probed, Error> {
        self.speeds.push(nm_per_min);
        let (from, displacement) = (floats(self.at), minus(floats(goal_nm), floats(self.at)));
        let length = length(displacement);
        let travel = UnitVector::new(displacement.map(|nm| nm as i64)).unwrap();
        // The stylus is bent by the travel towards the surface.
        let approach = match until {
            Edge::Made => travel,
            Edge::Broken => travel.reversed(),
        };
        let pressed = f64::from(self.tip.pre_travel.along(&approach));
        let is_closed = |gap: f64| gap <= -pressed;
        if is_closed(self.gap(from)) == until.level() {
            return Err(match until {
                Edge::Made => Error::Probe(husillo_probe::Failure::ContactAtStart),
                Edge::Broken => Error::NotTouching,
            });
        }
        let at = |gone: f64| plus(from, scaled(displacement, gone / length));
        let mut gone = 0.0;
        while gone < length {
            let gap = self.gap(at(gone));
            if is_closed(gap) == until.level() {
                let [changed, stood] =
                    [gone, gone + BRAKING_NM].map(|gone| at(gone).map(|nm| nm.round() as i64));
                self.at = stood;
                return Ok(Probed {
                    changed_nm: Some(changed),
                    at_nm: stood,
                });
            }
            gone += (gap + pressed).abs().max(0.5);
        }
        self.at = goal_nm;
        Ok(Probed {
            changed_nm: None,
            at_nm: goal_nm,
        })
    }

    fn touch(&mut self, direction: &UnitVector, distance_nm: u64) -> Result<Touched, Error> {
        let (from, along) = (floats(self.at), components(direction));
        let mut gone = 0.0;
        // Sphere tracing never goes beyond the surface. It ends within 0.5 nm of it.
        let mut gap = self.gap(from);
        while gap.abs() > 0.5 {
            gone += gap * 0.999;
            if gone > distance_nm as f64 {
                return Err(Error::NoContact {
                    from: format!("{:?}", self.at),
                    to: format!("{distance_nm} nm along {along:?}"),
                });
            }
            gap = self.gap(plus(from, scaled(along, gone)));
        }
        let back_off = 100_000.0_f64.min(gone);
        let centre = plus(from, scaled(along, gone)).map(|nm| nm.round() as i64);
        let pre_travel = i64::from(self.tip.pre_travel.along(direction));
        let latched = floats(centre);
        self.at = plus(latched, scaled(along, -back_off)).map(|nm| nm.round() as i64);
        debug_assert!(dot(along, along) > 0.99);
        Ok(Touched {
            centre_nm: plus(latched, scaled(along, pre_travel as f64)).map(|nm| nm.round() as i64),
            touches: 1,
            spread_nm: 0,
        })
    }
}

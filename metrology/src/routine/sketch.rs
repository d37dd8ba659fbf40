//! The sketch of a statement: where its touches should be, before anything is measured.

use super::site::beyond;
use super::statement::{Job, Order, Place, Statement};
use super::touches::{UP, hemisphere, spokes};
use super::vector::{Vector, cross, scaled};

/// The feature of a statement as the routine expects it, in the coordinates of its line.
#[derive(Clone, Debug, PartialEq)]
pub struct Sketch {
    /// Its keyword: `bore`, `circle`, ...
    pub keyword: &'static str,
    /// Its name.
    pub name: String,
    /// Number of its line, from 1.
    pub line: usize,
    /// Its touches in their order.
    pub touches: Vec<SketchedTouch>,
    /// Centre and diameter of a round feature, nm.
    pub round_nm: Option<([i64; 3], i64)>,
}

/// An expected touch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SketchedTouch {
    /// The point of the surface, nm.
    pub at_nm: [i64; 3],
    /// The direction of travel; its length is not 1.
    pub towards: Vector,
}

impl Statement {
    /// Whether the lines after it have other coordinates: it changes the frame or its zero.
    #[must_use]
    pub const fn changes_coordinates(&self) -> bool {
        matches!(
            self.order,
            Order::Zero(_) | Order::MachineFrame | Order::Frame { .. }
        )
    }

    /// The sketch of its feature. `None`: it touches nothing. A coordinate that the line does not
    /// give, because it is that of the tip then, is 0.
    #[must_use]
    pub fn sketch(&self) -> Option<Sketch> {
        let Order::Measure(task) = &self.order else {
            return None;
        };
        let touches = touches(&task.job);
        if touches.is_empty() {
            return None;
        }
        let round_nm = match task.job {
            Job::Round {
                at, diameter_nm, ..
            }
            | Job::Sphere {
                at, diameter_nm, ..
            } => Some((known(at), diameter_nm)),
            _ => None,
        };
        Some(Sketch {
            keyword: task.keyword,
            name: task.name.clone(),
            line: self.line,
            touches,
            round_nm,
        })
    }
}

fn known(place: Place) -> [i64; 3] {
    place.map(Option::unwrap_or_default)
}

fn touches(job: &Job) -> Vec<SketchedTouch> {
    let touch = |at_nm, towards| SketchedTouch { at_nm, towards };
    let around = |centre, by_nm, spokes: Vec<Vector>, sign: f64| {
        let at = |spoke: Vector| touch(beyond(centre, spoke, by_nm), scaled(spoke, sign));
        spokes.into_iter().map(at).collect()
    };
    match job {
        Job::Point { at, towards } => vec![touch(known(*at), *towards)],
        Job::Plane { at, towards } | Job::Line { at, towards } => {
            let at = at.iter().copied().map(known);
            at.map(|at| touch(at, *towards)).collect()
        }
        &Job::Edge {
            at,
            towards,
            points,
            over_nm,
        } => {
            let along = cross(UP, towards);
            let part = |point: u32| match points {
                0 | 1 => 0.0,
                _ => f64::from(point) / f64::from(points - 1) - 0.5,
            };
            let by_nm = |point| (over_nm as f64 * part(point)).round() as i64;
            let at = |point| beyond(known(at), along, by_nm(point));
            (0..points).map(|point| touch(at(point), towards)).collect()
        }
        &Job::Corner {
            at,
            towards: [first, second],
            inset_nm,
            is_inside,
        } => {
            let step = if is_inside { -inset_nm } else { inset_nm };
            let on = |along, towards, inset| touch(beyond(known(at), along, step * inset), towards);
            vec![
                on(second, first, 2),
                on(second, first, 1),
                on(first, second, 1),
                on(first, second, 2),
            ]
        }
        &Job::Width {
            at,
            along,
            width_nm,
            is_inside,
        } => {
            let sign = if is_inside { 1.0 } else { -1.0 };
            let ways = vec![along, scaled(along, -1.0)];
            around(known(at), width_nm / 2, ways, sign)
        }
        &Job::Round {
            at,
            diameter_nm,
            points,
            arc_deg,
            is_inside,
        } => {
            let sign = if is_inside { 1.0 } else { -1.0 };
            around(known(at), diameter_nm / 2, spokes(points, arc_deg), sign)
        }
        &Job::Sphere {
            at,
            diameter_nm,
            points,
        } => around(known(at), diameter_nm / 2, hemisphere(points), -1.0),
        Job::Touch { .. } | Job::Fit { .. } | Job::Distance { .. } | Job::Angle { .. } => {
            Vec::new()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::heads::{Head, Line};
    use crate::routine::{Parser, Runner, Site};
    use crate::simulated::{SimulatedNetwork, SimulatedPort, three_axes};

    fn sketches(text: &str) -> Vec<Sketch> {
        let statements = Parser::file(text).unwrap();
        statements.iter().filter_map(Statement::sketch).collect()
    }

    #[test]
    fn each_feature_has_its_touches() {
        let all = sketches(
            "safe z 10\n\
             plane top towards -z at x1 y2 z-3 at x4 y5 z-3 at x1 y9 z-3\n\
             edge E at x0 y5 z-5 towards +x points 3 over 20\n\
             corner C at x1 y1 z-5 towards +x +y inset 5\n\
             web W at x0 y0 z-5 along x width 20\n\
             bore B at x20 y20 z-4 diameter 12\n\
             sphere S at x0 y0 z0 diameter 20\n\
             touch -z\n\
             distance D between B S\n\
             goto x1\n",
        );
        let counts: Vec<_> = all
            .iter()
            .map(|one| (one.name.as_str(), one.touches.len()))
            .collect();
        let expected = [("top", 3), ("E", 3), ("C", 4), ("W", 2), ("B", 4), ("S", 9)];
        assert_eq!(counts, expected);
        let mm = |x: i64, y: i64, z: i64| [x, y, z].map(|mm| mm * 1_000_000);
        assert_eq!(all[0].touches[1].at_nm, mm(4, 5, -3));
        assert_eq!(all[1].touches[0].at_nm, mm(0, -5, -5));
        assert_eq!(all[1].touches[2].at_nm, mm(0, 15, -5));
        // From outside: the faces extend from the corner in the directions of travel.
        assert_eq!(all[2].touches[0].at_nm, mm(1, 11, -5));
        assert_eq!(all[2].touches[3].at_nm, mm(11, 1, -5));
        assert_eq!(all[3].touches[0].at_nm, mm(10, 0, -5));
        assert_eq!(all[3].touches[0].towards, [-1.0, 0.0, 0.0]);
        assert_eq!(all[4].touches[1].at_nm, mm(20, 26, -4));
        assert_eq!(all[4].touches[1].towards, [0.0, 1.0, 0.0]);
        assert_eq!(all[4].round_nm, Some((mm(20, 20, -4), 12_000_000)));
        assert_eq!(all[5].touches[0].at_nm, mm(0, 0, 10));
    }

    #[test]
    fn a_frame_and_a_zero_change_the_coordinates() {
        let statements = Parser::file(
            "plane P towards -z at x1 y1 z-3 at x4 y1 z-3 at x1 y9 z-3\n\
             line L towards +y at x1 y1 z-5 at x9 y1 z-5\n\
             point A towards +x at x1 y3 z-5\n\
             frame plane P line L point A\n\
             goto x5\n\
             zero x y\n\
             frame machine\n",
        );
        let statements = statements.unwrap();
        let changing = statements.iter().filter(|one| one.changes_coordinates());
        assert_eq!(changing.map(|one| one.line).collect::<Vec<_>>(), [4, 6, 7]);
    }

    /// On an ideal part the touches are where the sketch has them.
    #[test]
    fn the_touches_are_made_where_they_are_sketched() {
        let text = "point A at x-3 y1 z-4 towards -z\npoint B at x5 y1 z-4 towards -z\n";
        let face = "3:..-2000".parse().unwrap();
        let network = SimulatedNetwork::new(&[4; 3], &[face], None).unwrap();
        let line = Line::new(SimulatedPort::new(network));
        let mut machine = three_axes();
        machine.probe.stylus.radius_nm = 0;
        let mut head = Head::start(line, &machine, 1).unwrap();
        let stylus = machine.probe.stylus;
        let mut runner = Runner::new(Site::new(&mut head, stylus));
        for statement in Parser::file(text).unwrap() {
            let sketched = statement.sketch().unwrap().touches[0].at_nm;
            let feature = runner.run(&statement).unwrap().unwrap();
            let touched = feature.contacts[0].centre_nm;
            let is_near = (0..3).all(|axis| touched[axis].abs_diff(sketched[axis]) <= 6_000);
            assert!(is_near, "{touched:?} {sketched:?}");
        }
    }
}

//! The least time of a program in floating point, from its commands alone.
//!
//! Along the path, the speed is the highest of all that keep four limits: the feed, the rate of
//! each axis, the acceleration of each axis, and the corner rule of Jeon (Grbl, planner.c,
//! "junction deviation"). On an arc, the acceleration along the path and v^2 / r towards the centre
//! together have the length of the limit. The path is cut into short pieces. One pass forwards and
//! one backwards over them give the speed, and the sum of their times is the result.

use std::f64::consts::TAU;

use husillo_gcode::{Arc, Block, Command, Commands, Dialect, Feed, Modal, Nm};

/// Length of the pieces in mm.
const PIECE_MM: f64 = 0.002;

/// A machine with three equal axes.
#[derive(Copy, Clone, Debug)]
pub struct Limits {
    /// Highest speed of each axis.
    pub mm_per_s: f64,
    /// Highest acceleration of each axis.
    pub mm_per_s2: f64,
    /// Distance of a corner from the circle that rounds it.
    pub deviation_mm: f64,
}

/// One move.
struct Move {
    length: f64,
    /// Highest speed along the path.
    top: f64,
    /// Radius of an arc, and the part of its path in its plane.
    round: Option<(f64, f64)>,
    /// Part of the path in the axis that moves most, without the plane of an arc.
    largest: f64,
    first: [f64; 3],
    last: [f64; 3],
}

/// The least time of the motion in seconds, from rest at zero. Commands that are not moves stop the
/// path and take no time.
///
/// # Errors
/// The text of the line that cannot be read.
pub fn least_seconds(program: &str, dialect: Dialect, limits: &Limits) -> Result<f64, String> {
    let (mut block, mut modal) = (Block::new(), Modal::<3>::new(dialect));
    let mut commands = Commands::new();
    let mut from = [Nm(0); 3];
    let mut chain: Vec<Move> = Vec::new();
    let mut seconds = 0.0;
    for line in program.lines() {
        for (_, text) in dialect.blocks(line.as_bytes()) {
            block
                .read(text, &dialect)
                .and_then(|()| modal.apply(&block, &mut commands))
                .map_err(|error| format!("{line}: {error}"))?;
            for command in &mut commands {
                match limits.of(&from, &command) {
                    Some(one) if one.length > 0.0 => chain.push(one),
                    Some(_) => {}
                    None => seconds += limits.time(&std::mem::take(&mut chain)),
                }
                from = command.end().unwrap_or(from);
            }
        }
    }
    Ok(seconds + limits.time(&chain))
}

impl Limits {
    fn of(&self, from: &[Nm; 3], command: &Command<3>) -> Option<Move> {
        let (to, feed, arc) = match command {
            Command::Rapid { to } => (to, None, None),
            Command::Linear { to, feed } => (to, Some(feed), None),
            Command::Arc { arc, feed } => (&arc.to, Some(feed), Some(arc)),
            _ => return None,
        };
        let mut way = [0, 1, 2].map(|axis: usize| (to[axis].0 - from[axis].0) as f64 / 1e6);
        let turned = arc.map(|arc| Turned::of(arc, from, &mut way));
        let around = turned.as_ref().map_or(0.0, |turned| turned.length);
        let length = way.iter().map(|way| way * way).sum::<f64>();
        let length = (length + around * around).sqrt();
        let direction = |tangent: [f64; 2]| {
            let mut direction = way.map(|way| way / length);
            if let (Some(turned), Some(arc)) = (&turned, arc) {
                for (axis, part) in arc.plane.axes().into_iter().zip(tangent) {
                    direction[axis] = part * turned.length / length;
                }
            }
            direction
        };
        let largest = way.iter().fold(0.0_f64, |most, way| most.max(way.abs())) / length;
        let top = self.mm_per_s / largest.max(around / length);
        let feed = match feed {
            Some(Feed::PerMinute(feed)) => feed.0 as f64 / 6e7,
            _ => f64::INFINITY,
        };
        Some(Move {
            length,
            top: top.min(feed),
            round: turned
                .as_ref()
                .map(|turned| (turned.radius, around / length)),
            largest,
            first: direction(turned.as_ref().map_or([0.0; 2], |turned| turned.first)),
            last: direction(turned.as_ref().map_or([0.0; 2], |turned| turned.last)),
        })
    }

    /// The acceleration that is left along a move at this square of the speed.
    fn along(&self, one: &Move, squared: f64) -> f64 {
        let straight = self.mm_per_s2 / one.largest;
        let Some((radius, share)) = one.round else {
            return straight;
        };
        let centre = squared * share * share / radius;
        let rest = (self.mm_per_s2 * self.mm_per_s2 - centre * centre).max(0.0);
        (rest.sqrt() / share).min(straight)
    }

    /// Square of the highest speed from one move to the next.
    fn corner(&self, before: &Move, after: &Move) -> f64 {
        let change = [0, 1, 2].map(|axis: usize| after.first[axis] - before.last[axis]);
        let size = change.iter().map(|part| part * part).sum::<f64>().sqrt();
        if size < 1e-6 {
            return f64::INFINITY;
        }
        let sine = (1.0 - size * size / 4.0).max(0.0).sqrt();
        let largest = change
            .iter()
            .fold(0.0_f64, |most, part| most.max(part.abs()))
            / size;
        self.mm_per_s2 / largest * self.deviation_mm * sine / (1.0 - sine)
    }

    /// The time of moves from rest to rest.
    fn time(&self, moves: &[Move]) -> f64 {
        let mut squares = vec![0.0_f64];
        let mut pieces: Vec<(f64, &Move)> = Vec::new();
        for (number, one) in moves.iter().enumerate() {
            let turning = one.round.map_or(f64::INFINITY, |(radius, share)| {
                self.mm_per_s2 * radius / (share * share)
            });
            let most = (one.top * one.top).min(turning);
            if let Some(before) = number.checked_sub(1).map(|before| &moves[before]) {
                let start = squares.last_mut().unwrap();
                *start = start.min(most).min(self.corner(before, one));
            }
            let count = (one.length / PIECE_MM).ceil().max(8.0);
            pieces.extend((0..count as usize).map(|_| (one.length / count, one)));
            squares.extend((0..count as usize).map(|_| most));
        }
        *squares.last_mut().unwrap() = 0.0;
        for (number, (length, one)) in pieces.iter().enumerate() {
            let [before, after] = [squares[number], squares[number + 1]];
            squares[number + 1] = after.min(before + 2.0 * length * self.along(one, before));
        }
        for (number, (length, one)) in pieces.iter().enumerate().rev() {
            let [before, after] = [squares[number], squares[number + 1]];
            squares[number] = before.min(after + 2.0 * length * self.along(one, after));
        }
        let speeds: Vec<f64> = squares.iter().map(|square| square.sqrt()).collect();
        let times = pieces.iter().zip(speeds.windows(2));
        times
            .map(|((length, _), ends)| 2.0 * length / (ends[0] + ends[1]))
            .sum()
    }
}

/// An arc in its plane.
struct Turned {
    length: f64,
    radius: f64,
    first: [f64; 2],
    last: [f64; 2],
}

impl Turned {
    /// Takes the axes of the plane out of `way`.
    fn of(arc: &Arc<3>, from: &[Nm; 3], way: &mut [f64; 3]) -> Self {
        for axis in arc.plane.axes() {
            way[axis] = 0.0;
        }
        let [from, to, centre] = arc.in_plane(from).map(|at| at.map(|nm| nm as f64 / 1e6));
        let spoke = |at: [f64; 2]| [at[0] - centre[0], at[1] - centre[1]];
        let [start, end] = [from, to].map(spoke);
        let [first_angle, last_angle] = [start, end].map(|[x, y]| y.atan2(x));
        let side = if arc.direction.is_clockwise() {
            -1.0
        } else {
            1.0
        };
        let mut angle = (side * (last_angle - first_angle)).rem_euclid(TAU);
        if from == to {
            angle = TAU;
        }
        angle += f64::from(arc.turns) * TAU;
        let radius = start[0].hypot(start[1]);
        let tangent = |angle: f64| [-side * angle.sin(), side * angle.cos()];
        Turned {
            length: radius * angle,
            radius,
            first: tangent(first_angle),
            last: tangent(last_angle),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Limits, least_seconds};
    use core::f64::consts::PI;
    use husillo_gcode::Dialect;

    fn least(program: &str) -> f64 {
        let limits = Limits {
            mm_per_s: 100.0,
            mm_per_s2: 500.0,
            deviation_mm: 0.01,
        };
        least_seconds(program, Dialect::RS274, &limits).unwrap()
    }

    /// 10 mm at 20 mm/s: 0.4 mm and 40 ms each to speed up and to slow down.
    #[test]
    fn a_line_is_a_trapezoid() {
        let found = least("G1 X10 F1200");
        assert!((found - (9.2 / 20.0 + 0.08)).abs() < 1e-3, "{found}");
    }

    /// One circle more of 2 mm takes the time at sqrt(a r).
    #[test]
    fn a_circle_turns_with_the_whole_acceleration() {
        let (speed, radius) = (1000_f64.sqrt(), 2.0);
        let found = least("G3 I2 P10 F6000") - least("G3 I2 P9 F6000");
        assert!((found - 2.0 * PI * radius / speed).abs() < 1e-4, "{found}");
    }

    /// A corner of 90 degrees is passed at v^2 = a d s / (1 - s) in both axes, s = sqrt(1/2).
    #[test]
    fn a_corner_slows_down() {
        let sine = 0.5_f64.sqrt();
        let corner = (500.0 / sine * 0.01 * sine / (1.0 - sine)).sqrt();
        let found = least("G1 X10 F1200\nY10") - 2.0 * least("G1 X10 F1200");
        // Each side needs less time by the part of its ramp below this speed.
        let saved = 2.0 * (corner / 500.0 - corner * corner / 1000.0 / 20.0);
        assert!((found + saved).abs() < 1e-3, "{found} {saved}");
    }
}

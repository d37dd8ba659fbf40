//! Mirrored order: cuts each contour as two halves from the same start point. The order of one half
//! is the mirror image of the other.
//!
//! A tool that goes round a symmetric contour goes up on one side and down on the other. The two
//! sides are then cut on different flanks of the screw. Two halves, both cut from the top down, use
//! the same flank on both sides, so the remaining backlash is the same on both.

use crate::diagnostics::Findings;
use crate::programs::program::walk;
use crate::programs::source::Source;
use husillo_gcode::{
    Arc, Command, Dialect, Direction, Feed, Nm, PathMode, Plane, SpindleDirection,
};
use husillo_sim::geometry::turn;
use husillo_sim::observers::AXES;
use std::fmt::Write;

/// Points at most this far apart count as one, nm: about the length of a step.
const SAME_NM: i64 = 1_000;

/// A program in mirrored order.
#[derive(Clone, Debug)]
pub struct Mirrored {
    /// Its text: RS-274, in millimetres, in the machine frame.
    pub text: String,
    /// Contours that are cut in halves.
    pub contours: usize,
    /// Closed contours that stay unchanged, because they cannot be divided, or because the height
    /// of the tool between the halves is not known.
    pub whole: usize,
}

/// A start point and the command that begins there.
type Given = ([Nm; AXES], Command<AXES>);

/// A cut in the plane of X and Y.
#[derive(Clone, Copy, Debug)]
struct Cut {
    from: [Nm; AXES],
    command: Command<AXES>,
}

impl Cut {
    fn to(&self) -> [Nm; AXES] {
        self.command.end().unwrap_or(self.from)
    }

    /// The same cut in the opposite direction.
    fn reversed(&self) -> Cut {
        let (from, to) = (self.to(), self.from);
        let command = match self.command {
            Command::Arc { arc, feed } => Command::Arc {
                arc: Arc {
                    to,
                    direction: match arc.direction {
                        Direction::Clockwise => Direction::CounterClockwise,
                        Direction::CounterClockwise => Direction::Clockwise,
                    },
                    ..arc
                },
                feed,
            },
            Command::Linear { feed, .. } => Command::Linear { to, feed },
            other => other,
        };
        Cut { from, command }
    }

    /// Splits the cut where it crosses `x`, at the crossing that is farthest from `y`.
    fn split(&self, x: i64, y: i64) -> Option<[Cut; 2]> {
        let to = self.to();
        let cross_y = match self.command {
            Command::Arc { arc, .. } => {
                let [cx, cy] = [arc.centre[0].0, arc.centre[1].0];
                let radius = f64::hypot((self.from[0].0 - cx) as f64, (self.from[1].0 - cy) as f64);
                let reach = radius.powi(2) - ((x - cx) as f64).powi(2);
                let rise = (reach > 0.0).then(|| reach.sqrt().round() as i64)?;
                let on_arc = [cy + rise, cy - rise]
                    .into_iter()
                    .filter(|cross| is_between(&self.from, &to, &arc, [x, *cross]));
                on_arc.max_by_key(|cross| (cross - y).abs())?
            }
            _ => {
                let [x0, x1] = [self.from[0].0, to[0].0];
                if (x0 - x).signum() * (x1 - x).signum() >= 0 {
                    return None;
                }
                let part = (x - x0) as f64 / (x1 - x0) as f64;
                self.from[1].0 + ((to[1].0 - self.from[1].0) as f64 * part).round() as i64
            }
        };
        let mut middle = to;
        middle[0] = Nm(x);
        middle[1] = Nm(cross_y);
        let first = match self.command {
            Command::Arc { arc, feed } => Command::Arc {
                arc: Arc { to: middle, ..arc },
                feed,
            },
            Command::Linear { feed, .. } => Command::Linear { to: middle, feed },
            _ => return None,
        };
        Some([
            Cut {
                from: self.from,
                command: first,
            },
            Cut {
                from: middle,
                command: self.command,
            },
        ])
    }
}

/// Whether a point of the circle lies on the arc, without its ends.
fn is_between(from: &[Nm; AXES], to: &[Nm; AXES], arc: &Arc<AXES>, point: [i64; 2]) -> bool {
    let angle = |x: i64, y: i64| {
        let spoke = [x - arc.centre[0].0, y - arc.centre[1].0];
        turn::angle(spoke.map(|nm| nm as f64), [0.0; 2])
    };
    let (start, end) = (angle(from[0].0, from[1].0), angle(to[0].0, to[1].0));
    let is_forward = arc.direction == Direction::CounterClockwise;
    let whole = turn::sweep(start, end, is_forward);
    let here = turn::turned(start, angle(point[0], point[1]), is_forward);
    here > 1e-9 && here < whole - 1e-9
}

/// Puts the closed contours of a checked program into mirrored order.
///
/// # Errors
///
/// The program cannot be read, or has a command that mirrored order does not write.
pub fn mirrored(source: &mut Source, name: &str, dialect: Dialect) -> Result<Mirrored, String> {
    let mut commands = Vec::new();
    let mut findings = Findings::new(1);
    walk(
        source,
        name,
        dialect,
        &mut findings,
        |_, command, from, _| {
            commands.push((from, *command));
            Ok(())
        },
    )
    .map_err(|error| format!("{name}: {error}"))?;
    let mut writer = Writer::new();
    let mut made = Mirrored {
        text: String::new(),
        contours: 0,
        whole: 0,
    };
    let mut rest = commands.as_slice();
    // The move that took the tool down to its present height.
    let mut plunge = None;
    // Heights above the work: that of the last rapid move across, or the highest so far. The start
    // of a plunge may be within the work, in a second pass.
    let mut highest = Nm(0);
    let mut across = None;
    while let Some(((from, command), after)) = rest.split_first() {
        let closed = contour(rest);
        if let Some((cuts, left)) = closed {
            match (halves(&cuts), plunge) {
                (Some(halves), Some((from, plunge))) => {
                    let up = across.unwrap_or(highest).max(from);
                    writer.halves(&halves, (up, plunge), left.first())?;
                    made.contours += 1;
                }
                _ => {
                    made.whole += 1;
                    for cut in cuts {
                        writer.write(&cut.command)?;
                    }
                }
            }
            rest = left;
            continue;
        }
        let to = command.end().unwrap_or(*from);
        highest = highest.max(to[2]);
        if matches!(command, Command::Rapid { .. }) && to[..2] != from[..2] {
            across = Some(from[2].max(to[2]));
        }
        if to[2] < from[2] && to[..2] == from[..2] {
            plunge = Some((from[2], *command));
        } else if to[2] > from[2] {
            plunge = None;
        }
        writer.write(command)?;
        rest = after;
    }
    made.text = writer.text;
    Ok(made)
}

/// The next cuts in the plane, up to the first return to their start, and the commands after them.
fn contour(commands: &[Given]) -> Option<(Vec<Cut>, &[Given])> {
    let start = commands.first()?.0;
    let mut cuts = Vec::new();
    for (index, (from, command)) in commands.iter().enumerate() {
        let is_flat = match command {
            Command::Linear { to, .. } => to[2] == from[2],
            Command::Arc { arc, .. } => {
                arc.plane == Plane::Xy && arc.turns == 0 && arc.to[2] == from[2]
            }
            _ => false,
        };
        if !is_flat {
            return None;
        }
        let cut = Cut {
            from: *from,
            command: *command,
        };
        cuts.push(cut);
        let near = |axis: usize| (cut.to()[axis].0 - start[axis].0).abs() <= SAME_NM;
        if near(0) && near(1) {
            return commands.get(index + 1..).map(|left| (cuts, left));
        }
    }
    None
}

/// Divides a contour where it crosses the vertical through its start again, at the crossing that is
/// farthest from the start.
fn halves(cuts: &[Cut]) -> Option<[Vec<Cut>; 2]> {
    let [x, y, ..] = cuts.first()?.from.map(|nm| nm.0);
    // Distance of the crossing, number of whole cuts before it, and the split of the next one if
    // the crossing lies inside it.
    let mut best: Option<(i64, usize, Option<[Cut; 2]>)> = None;
    for (index, cut) in cuts.iter().enumerate() {
        let to = cut.to();
        let is_last = index + 1 == cuts.len();
        let at_end = ((to[0].0 - x).abs() <= SAME_NM && !is_last)
            .then(|| ((to[1].0 - y).abs(), index + 1, None));
        let inside = cut
            .split(x, y)
            .map(|two| ((two[0].to()[1].0 - y).abs(), index, Some(two)));
        for found in [at_end, inside].into_iter().flatten() {
            if found.0 > SAME_NM && best.as_ref().is_none_or(|best| found.0 > best.0) {
                best = Some(found);
            }
        }
    }
    let (_, whole, two) = best?;
    let (mut first, mut second) = (cuts[..whole].to_vec(), cuts[whole..].to_vec());
    if let Some([one, other]) = two {
        first.push(one);
        second[0] = other;
    }
    let back = second.iter().rev().map(Cut::reversed).collect();
    Some([first, back])
}

/// Writes commands as text.
struct Writer {
    text: String,
    at: [Nm; AXES],
}

impl Writer {
    fn new() -> Self {
        Self {
            text: "G21 G90 G94 G17\n".to_owned(),
            // A homed machine is at machine zero.
            at: [Nm(0); AXES],
        }
    }

    /// Writes both halves and lifts the tool between them.
    fn halves(
        &mut self,
        [first, second]: &[Vec<Cut>; 2],
        (up, plunge): (Nm, Command<AXES>),
        next: Option<&Given>,
    ) -> Result<(), String> {
        let Some(start) = first.first().map(|cut| cut.from) else {
            return Ok(());
        };
        for cut in first {
            self.write(&cut.command)?;
        }
        self.back_to(start, up)?;
        self.write(&plunge)?;
        for cut in second {
            self.write(&cut.command)?;
        }
        let lifts = next.is_some_and(|(from, next)| match next {
            Command::Rapid { to } => to[..2] == from[..2] && to[2] > from[2],
            _ => false,
        });
        if !lifts {
            self.back_to(start, up)?;
            return self.write(&plunge);
        }
        // The next command lifts the tool: it goes straight up from here.
        match next {
            Some((_, Command::Rapid { to })) => self.lift(to[2]),
            _ => Ok(()),
        }
    }

    /// Lifts the tool, and moves it across to a position.
    fn back_to(&mut self, position: [Nm; AXES], up: Nm) -> Result<(), String> {
        self.lift(up)?;
        let [x, y, ..] = position;
        let [_, _, _, others @ ..] = self.at;
        let [a, b, c] = others;
        self.write(&Command::Rapid {
            to: [x, y, up, a, b, c],
        })
    }

    /// Moves the tool straight up to this height.
    fn lift(&mut self, up: Nm) -> Result<(), String> {
        let mut to = self.at;
        to[2] = up;
        self.write(&Command::Rapid { to })
    }

    /// Writes an arc without its feed.
    fn arc(&mut self, arc: &Arc<AXES>) {
        let (plane, letters) = match arc.plane {
            Plane::Xy => ("G17", "IJ"),
            Plane::Zx => ("G18", "KI"),
            Plane::Yz => ("G19", "JK"),
        };
        let code = match arc.direction {
            Direction::Clockwise => "G2",
            Direction::CounterClockwise => "G3",
        };
        // Writing to a String cannot fail.
        let _ = write!(self.text, "{plane} {code}");
        let from = self.at;
        self.go(&arc.to, true);
        for (letter, axis) in letters.chars().zip(arc.plane.axes()) {
            let distance = Nm(arc.centre[axis].0 - from[axis].0);
            let _ = write!(self.text, " {letter}{}", millimetres(distance));
        }
        if arc.turns > 0 {
            let _ = write!(self.text, " P{}", arc.turns + 1);
        }
    }

    fn write(&mut self, command: &Command<AXES>) -> Result<(), String> {
        let text = &mut self.text;
        let moves_others = |to: [Nm; AXES]| to.iter().skip(3).any(|at| *at != Nm(0));
        if command.end().is_some_and(moves_others) {
            return Err("a program that moves more axes than X, Y and Z".into());
        }
        // Writing to a String cannot fail.
        match command {
            Command::Rapid { to } => {
                text.push_str("G0");
                self.go(to, false);
            }
            Command::Linear { to, feed } => {
                text.push_str("G1");
                self.go(to, false);
                self.feed(feed)?;
            }
            Command::Arc { arc, feed } => {
                self.arc(arc);
                self.feed(feed)?;
            }
            Command::Dwell { micros } => {
                let _ = write!(text, "G4 P{}.{:06}", micros / 1_000_000, micros % 1_000_000);
            }
            Command::Spindle {
                direction,
                milli_rpm,
            } => {
                let code = match direction {
                    SpindleDirection::Clockwise => "M3",
                    SpindleDirection::CounterClockwise => "M4",
                    SpindleDirection::Off => "M5",
                };
                text.push_str(code);
                if *direction != SpindleDirection::Off {
                    let _ = write!(text, " S{}.{:03}", milli_rpm / 1000, milli_rpm % 1000);
                }
            }
            Command::Coolant { mist, flood } => {
                let words = match (mist, flood) {
                    (false, false) => "M9",
                    (true, false) => "M9\nM7",
                    (false, true) => "M9\nM8",
                    (true, true) => "M7\nM8",
                };
                text.push_str(words);
            }
            Command::Tool { number } => {
                let _ = write!(text, "T{number} M6");
            }
            Command::Path { mode } => match mode {
                PathMode::ExactPath => text.push_str("G61"),
                PathMode::ExactStop => text.push_str("G61.1"),
                PathMode::Blend { tolerance: None } => text.push_str("G64"),
                PathMode::Blend {
                    tolerance: Some(tolerance),
                } => {
                    let _ = write!(text, "G64 P{}", millimetres(*tolerance));
                }
            },
            Command::Stop { optional } => text.push_str(if *optional { "M1" } else { "M0" }),
            Command::End { rewind } => text.push_str(if *rewind { "M30" } else { "M2" }),
            other => {
                return Err(format!(
                    "mirrored order is for lines and arcs in X and Y: it cannot write {other:?}"
                ));
            }
        }
        self.text.push('\n');
        Ok(())
    }

    /// Writes the coordinates that change, or every coordinate if `all`.
    fn go(&mut self, to: &[Nm; AXES], all: bool) {
        for ((letter, to), at) in "XYZ".chars().zip(to).zip(&mut self.at) {
            if all || at != to {
                let _ = write!(self.text, " {letter}{}", millimetres(*to));
                *at = *to;
            }
        }
    }

    fn feed(&mut self, feed: &Feed) -> Result<(), String> {
        let Feed::PerMinute(feed) = feed else {
            return Err("mirrored order needs feeds per minute (G94)".into());
        };
        let _ = write!(self.text, " F{}", millimetres(*feed));
        Ok(())
    }
}

/// Millimetres with six decimals, which are exact.
fn millimetres(nm: Nm) -> String {
    let (sign, nm) = (if nm.0 < 0 { "-" } else { "" }, nm.0.unsigned_abs());
    format!("{sign}{}.{:06}", nm / 1_000_000, nm % 1_000_000)
}

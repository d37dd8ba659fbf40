//! Translates commands to the strings of the micro mill. The strings have absolute micrometres.
//! They move X and Y together, and Z alone.

use husillo_gcode::{Arc, Command, Direction, Feed, Nm, Plane, SpindleDirection};
use husillo_machine::Config;
use husillo_sim::geometry::turn;
use husillo_transports::micromill::{Line, Point};
use std::collections::BTreeSet;
use std::f64::consts::TAU;

/// The last digit of a coordinate: 10 nm.
const UNIT_NM: i64 = 10;
/// Largest coordinate in that unit: five digits of micrometres and two decimals.
const MOST: i64 = 9_999_999;
/// Length of the parts into which a curve is divided, as a fraction of a step.
const PART: f64 = 0.02;

/// A program for the mill.
#[derive(Clone, Debug, Default)]
pub struct Translated {
    /// Number of commands that were translated.
    pub commands: usize,
    /// Each line, with the number of its line in the program.
    pub lines: Vec<(usize, Line)>,
    /// Words that were dropped or changed: line and sentence.
    pub notes: Vec<(usize, String)>,
    /// Functions that the mill does not have: line and sentence.
    pub errors: Vec<(usize, String)>,
}

/// Translates commands, each with the number of its line. The mill is at machine zero, and so is
/// the zero of the part.
pub fn translate(
    commands: impl IntoIterator<Item = (usize, Command<3>)>,
    config: &Config<3>,
) -> Translated {
    let mut translator = Translator::new(config, [Nm(0); 3], [Nm(0); 3]);
    for (line, command) in commands {
        translator.push_command(line, &command);
    }
    translator.take()
}

/// Translates one command after the other.
#[derive(Clone, Debug)]
pub struct Translator<'a> {
    config: &'a Config<3>,
    made: Translated,
    /// The notes so far. A note is made once in each line.
    noted: BTreeSet<(usize, String)>,
    line: usize,
    /// The part's zero in machine coordinates.
    zero: [Nm; 3],
    /// The end of the last line, in units from the part's zero.
    at: [i64; 3],
    /// The end of the last command, in machine coordinates.
    from: [Nm; 3],
}

impl<'a> Translator<'a> {
    /// The mill is at the position `at`, and its part's zero is at `zero`. Both are in machine
    /// coordinates, as the commands are. The strings count from the part's zero.
    pub fn new(config: &'a Config<3>, zero: [Nm; 3], at: [Nm; 3]) -> Self {
        let mut translator = Self {
            config,
            made: Translated::default(),
            noted: BTreeSet::new(),
            line: 0,
            zero,
            at: [0; 3],
            from: at,
        };
        translator.at = translator.place(&at);
        translator
    }

    /// Translates a command of a line. Axes after Z are ignored: the mill has none.
    pub fn push_command<const N: usize>(&mut self, line: usize, command: &Command<N>) {
        self.line = line;
        self.made.commands += 1;
        match of_three(command) {
            Some(motion) => self.motion(&motion),
            None => self.other(command),
        }
        self.from = command.end().map_or(self.from, |end| three(&end));
    }

    /// Takes what was translated since the last call.
    pub fn take(&mut self) -> Translated {
        std::mem::take(&mut self.made)
    }
}

impl Translator<'_> {
    fn motion(&mut self, command: &Command<3>) {
        match command {
            Command::Rapid { to } => self.rapid(to),
            Command::Linear { to, feed } => {
                let Some(feed) = self.feed(feed, command) else {
                    return;
                };
                let to = self.place(to);
                if self.moves_apart(to) {
                    let (from, end) = (self.from, *to_nm(command));
                    let steps = self.longest(&from, &end);
                    self.flatten(steps, feed, None, |part| {
                        std::array::from_fn(|axis| {
                            let (a, b) = (from[axis].0 as f64, end[axis].0 as f64);
                            a + (b - a) * part
                        })
                    });
                }
                self.straight(to, Some(feed));
            }
            Command::Arc { arc, feed } => {
                if let Some(feed) = self.feed(feed, command) {
                    self.arc(arc, feed);
                }
            }
            _ => {}
        }
    }

    fn other<const N: usize>(&mut self, command: &Command<N>) {
        match command {
            Command::Dwell { micros } => {
                let seconds = micros.div_ceil(1_000_000);
                if seconds * 1_000_000 != *micros {
                    self.note(format!(
                        "a dwell of {} ms becomes {seconds} s",
                        micros / 1000
                    ));
                }
                match u16::try_from(seconds) {
                    Ok(0) => {}
                    Ok(seconds) if seconds <= 9999 => self.push(Line::Dwell(seconds)),
                    _ => self.error("a dwell of more than 9999 s".into()),
                }
            }
            Command::Spindle {
                direction,
                milli_rpm,
            } => self.spindle(*direction, *milli_rpm),
            Command::Tool { number } => match u8::try_from(*number) {
                Ok(number) if number <= 99 => self.push(Line::Tool(number)),
                _ => self.error(format!("tool {number}: the mill's tools end at 99")),
            },
            Command::End { .. } => self.push(Line::End),
            Command::Coolant {
                mist: false,
                flood: false,
            } => {}
            Command::ToolLength { .. } | Command::Compensation { .. } => {} // in the positions
            Command::Thread { .. }
            | Command::Probe { .. }
            | Command::Spline { .. }
            | Command::NurbsBegin { .. }
            | Command::NurbsPoint { .. }
            | Command::NurbsEnd { .. }
            | Command::Tap { .. }
            | Command::Wait { .. } => {
                self.error(format!("the mill cannot do this: {command}"));
            }
            other => self.note(format!("dropped: {other}")),
        }
    }

    fn rapid(&mut self, to: &[Nm; 3]) {
        let to = self.place(to);
        if self.moves_apart(to) {
            let [x, y, z] = to;
            let [at_x, at_y, at_z] = self.at;
            self.note("Z moves apart from X and Y".into());
            // Z moves up before X and Y move. X and Y move before Z moves down.
            let between = if z > at_z {
                [at_x, at_y, z]
            } else {
                [x, y, at_z]
            };
            self.straight(between, None);
        }
        self.straight(to, None);
    }

    /// Whether both Z and another axis move.
    fn moves_apart(&self, to: [i64; 3]) -> bool {
        let [x, y, z] = to;
        let [at_x, at_y, at_z] = self.at;
        z != at_z && (x != at_x || y != at_y)
    }

    /// Moves X and Y, or Z alone. If a curve leaves both to move, Z moves first.
    fn straight(&mut self, to: [i64; 3], feed: Option<u16>) {
        let [x, y, z] = to;
        let [at_x, at_y, at_z] = self.at;
        let mut points = Vec::new();
        if z != at_z {
            points.push(Point::Z(self.unit(z)));
        }
        if x != at_x || y != at_y {
            points.push(Point::Xy([Some(self.unit(x)), Some(self.unit(y))]));
        }
        self.at = to;
        for point in points {
            self.push(match feed {
                None => Line::Rapid(point),
                Some(feed) => Line::Linear(point, feed),
            });
        }
    }

    fn arc(&mut self, arc: &Arc<3>, feed: u16) {
        let to = self.place(&arc.to);
        let is_flat = arc.plane == Plane::Xy && to[2] == self.at[2];
        if is_flat {
            let centre = self.centre(arc);
            let start = [self.at[0], self.at[1]];
            for _ in 0..arc.turns {
                self.push_arc(arc.direction, start, centre, feed);
            }
            self.push_arc(arc.direction, [to[0], to[1]], centre, feed);
            self.at = to;
            return;
        }
        let axes = arc.plane.axes();
        let from = self.from;
        let spoke = |point: &[Nm; 3]| -> [f64; 2] {
            axes.map(|axis| (point[axis].0 - arc.centre[axis].0) as f64)
        };
        let ([a0, b0], [a1, b1]) = (spoke(&from), spoke(&arc.to));
        let (first, last) = (
            turn::angle([a0, b0], [0.0; 2]),
            turn::angle([a1, b1], [0.0; 2]),
        );
        let (start_radius, end_radius) = (a0.hypot(b0), a1.hypot(b1));
        let is_forward = arc.direction == Direction::CounterClockwise;
        let sweep = turn::sweep(first, last, is_forward) + f64::from(arc.turns) * TAU;
        let turn = if is_forward { sweep } else { -sweep };
        let across = 3 - axes[0] - axes[1];
        let (low, high) = (from[across].0 as f64, arc.to[across].0 as f64);
        let place = |part: f64| -> [f64; 3] {
            let radius = start_radius + (end_radius - start_radius) * part;
            let angle = first + turn * part;
            let mut at = [0.0; 3];
            at[axes[0]] = arc.centre[axes[0]].0 as f64 + radius * angle.cos();
            at[axes[1]] = arc.centre[axes[1]].0 as f64 + radius * angle.sin();
            at[across] = low + (high - low) * part;
            at
        };
        let step_nm = self.step_nm();
        let length = turn.abs() * start_radius.max(end_radius) + (high - low).abs();
        let round = (arc.plane == Plane::Xy).then(|| (arc.direction, self.centre(arc)));
        self.flatten(length / step_nm, feed, round, place);
        self.straight(to, Some(feed));
    }

    /// Follows a curve on which Z moves together with the other axes. Z steps when it is half a
    /// step off. Between these steps X and Y continue on lines or on an arc.
    fn flatten(
        &mut self,
        steps: f64,
        feed: u16,
        round: Option<(Direction, [i64; 2])>,
        place: impl Fn(f64) -> [f64; 3],
    ) {
        self.note("Z moves apart from X and Y, within half a step".into());
        let step_nm = self.step_nm();
        let parts = (steps / PART).ceil().max(1.0);
        let level = |z: f64| (z / step_nm).round();
        let mut z = level(place(0.0)[2]);
        let mut travel = [0.0_f64; 2];
        let mut before = place(0.0);
        let mut part = 0.0;
        while part < parts {
            part += 1.0;
            let at = place(part / parts);
            // X or Y reverses here, and the curve is no arc in X and Y.
            let next_travel = [at[0] - before[0], at[1] - before[1]];
            let turns = round.is_none()
                && travel
                    .iter()
                    .zip(next_travel)
                    .any(|(last, next)| last * next < 0.0);
            if turns {
                self.across(before, feed, round);
            }
            travel = next_travel;
            before = at;
            let now = level(at[2]);
            if now != z {
                self.across(at, feed, round);
                z = now;
                let nm = Nm((z * step_nm).round() as i64);
                let to = [self.at[0], self.at[1], self.rounded(2, nm)];
                self.straight(to, Some(feed));
            }
        }
        let [x, y, _] = place(1.0);
        self.across([x, y, 0.0], feed, round);
    }

    /// Moves X and Y to a position. Z does not move.
    fn across(&mut self, at: [f64; 3], feed: u16, round: Option<(Direction, [i64; 2])>) {
        let [x, y] = [0, 1].map(|axis| self.rounded(axis, Nm(at[axis].round() as i64)));
        let z = self.at[2];
        // A distance of at most a step becomes a line, even on an arc.
        let step = (self.step_nm() / UNIT_NM as f64) as i64;
        let is_short = (x - self.at[0]).abs().max((y - self.at[1]).abs()) <= step;
        match round {
            Some((direction, centre)) if !is_short => {
                self.push_arc(direction, [x, y], centre, feed);
                self.at = [x, y, z];
            }
            _ => self.straight([x, y, z], Some(feed)),
        }
    }

    fn push_arc(&mut self, direction: Direction, to: [i64; 2], centre: [i64; 2], feed: u16) {
        let line = Line::Arc {
            clockwise: direction == Direction::Clockwise,
            to: to.map(|at| self.unit(at)),
            centre: centre.map(|at| self.unit(at)),
            feed,
        };
        self.push(line);
    }

    fn centre(&self, arc: &Arc<3>) -> [i64; 2] {
        [0, 1].map(|axis: usize| nearest(arc.centre[axis].0 - self.zero[axis].0, UNIT_NM))
    }

    fn spindle(&mut self, direction: SpindleDirection, milli_rpm: u64) {
        let rpm = (milli_rpm + 500) / 1000;
        let most = rpm.min(9999);
        if most * 1000 != milli_rpm && direction != SpindleDirection::Off {
            let exact = milli_rpm as f64 / 1000.0;
            self.note(format!("S{exact} becomes S{most:04}"));
        }
        let rpm = most as u16;
        self.push(match direction {
            SpindleDirection::Off => Line::SpindleOff,
            SpindleDirection::Clockwise => Line::Spindle {
                clockwise: true,
                rpm,
            },
            SpindleDirection::CounterClockwise => Line::Spindle {
                clockwise: false,
                rpm,
            },
        });
    }

    /// The feed in tenths of mm/min.
    fn feed(&mut self, feed: &Feed, command: &Command<3>) -> Option<u16> {
        let nm = match feed {
            Feed::PerMinute(Nm(nm)) => *nm as f64,
            Feed::InverseTime { micro_per_minute } if matches!(command, Command::Linear { .. }) => {
                let ways = self.from.iter().zip(to_nm(command));
                let square: f64 = ways.map(|(a, b)| ((b.0 - a.0) as f64).powi(2)).sum();
                square.sqrt() * *micro_per_minute as f64 / 1e6
            }
            _ => {
                self.error(format!("the mill has feeds per minute only: {command}"));
                return None;
            }
        };
        let tenths = (nm / 100_000.0).round().clamp(1.0, 9999.0);
        if tenths * 100_000.0 != nm {
            self.note(format!("F{} becomes F{}", nm / 1e6, tenths / 10.0));
        }
        Some(tenths as u16)
    }

    fn step_nm(&self) -> f64 {
        let [_, _, z] = &self.config.axes;
        f64::from(z.scale.nm()) / f64::from(z.scale.steps())
    }

    /// The steps of the axis with the longest distance.
    fn longest(&self, from: &[Nm; 3], to: &[Nm; 3]) -> f64 {
        let ways = from.iter().zip(to).map(|(a, b)| (b.0 - a.0).abs());
        ways.max().unwrap_or(0) as f64 / self.step_nm()
    }

    fn place(&self, at: &[Nm; 3]) -> [i64; 3] {
        std::array::from_fn(|axis| self.rounded(axis, at[axis]))
    }

    /// A coordinate in units. It is the nearest one that is within the same step.
    fn rounded(&self, axis: usize, at: Nm) -> i64 {
        let zero = self.zero[axis].0;
        let unit = nearest(at.0 - zero, UNIT_NM);
        let scale = self.config.axes[axis].scale;
        let step = scale.nearest(at.0);
        [unit, unit - 1, unit + 1]
            .into_iter()
            .find(|unit| scale.nearest(unit * UNIT_NM + zero) == step)
            .unwrap_or(unit)
    }

    fn unit(&mut self, at: i64) -> i32 {
        if at.abs() > MOST {
            self.error(
                "a coordinate beyond 99.99999 mm: the mill's words have five digits of micrometres"
                    .into(),
            );
        }
        at.clamp(-MOST, MOST) as i32
    }

    fn push(&mut self, line: Line) {
        self.made.lines.push((self.line, line));
    }

    fn note(&mut self, note: String) {
        if self.noted.insert((self.line, note.clone())) {
            self.made.notes.push((self.line, note));
        }
    }

    fn error(&mut self, error: String) {
        self.made.errors.push((self.line, error));
    }
}

/// X, Y and Z of a position.
fn three<const N: usize>(at: &[Nm; N]) -> [Nm; 3] {
    [0, 1, 2].map(|axis| at.get(axis).copied().unwrap_or_default())
}

/// A rapid, a line or an arc in X, Y and Z.
fn of_three<const N: usize>(command: &Command<N>) -> Option<Command<3>> {
    Some(match command {
        Command::Rapid { to } => Command::Rapid { to: three(to) },
        Command::Linear { to, feed } => Command::Linear {
            to: three(to),
            feed: *feed,
        },
        Command::Arc { arc, feed } => Command::Arc {
            arc: Arc {
                to: three(&arc.to),
                centre: three(&arc.centre),
                plane: arc.plane,
                direction: arc.direction,
                turns: arc.turns,
                radius: arc.radius,
                mismatch: arc.mismatch,
                resolution: arc.resolution,
            },
            feed: *feed,
        },
        _ => return None,
    })
}

fn to_nm(command: &Command<3>) -> &[Nm; 3] {
    match command {
        Command::Linear { to, .. } | Command::Rapid { to } => to,
        _ => &[Nm(0); 3],
    }
}

/// `at / unit`, rounded to an integer, halves away from zero.
fn nearest(at: i64, unit: i64) -> i64 {
    let half = if at < 0 { -unit / 2 } else { unit / 2 };
    (at + half) / unit
}

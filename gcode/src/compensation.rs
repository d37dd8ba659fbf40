//! Cutter compensation (G41, G42): commands of the contour in, commands of the tool centre out.
//!
//! ```text
//! Modal::apply ──► Commands ──► Compensation::apply ──► Compensated ──► machine
//!                  contour      one move behind         tool centre
//! ```

pub(crate) mod offset;

use crate::codes::code::Side;
use crate::command::arc::{Arc, Direction, Plane, SLACK_INCH, with_centre};
use crate::command::{Command, Feed};
use crate::compensation::offset::{
    Vector, along, circles, is_between, left, length, line_and_circle, minus, mitre, opposite,
    plus, turn, unit,
};
use crate::error::ErrorKind;
use crate::modal::commands::Commands;
use crate::values::nm::{Measure, Nm};

/// Commands between two moves of a contour that can wait for the corner.
const WAITING: usize = 4;

/// The number of commands that one command can release: the previous move, the commands that waited
/// after it, a corner of two moves, and itself.
const FREED: usize = WAITING + 5;

/// Differences of points up to this are due to rounding.
const ROUNDING: i64 = 4;

/// Cutter compensation: the stage between [`Modal`](crate::Modal) and a machine that turns a
/// contour into the path of the tool centre.
///
/// It works in the plane that is active at G41 or G42. It is one move behind: a move is returned
/// when the next move has determined its end.
///
/// - Outside corners get an arc of the tool radius around the corner. Between rapids they get
///   straight lines that do not touch this arc.
/// - Inside corners end at the common point of the two offset curves.
/// - Every point is within 2 nm of its exact offset curve.
/// - The first move must be straight and longer than the radius. It ends perpendicular to its own
///   end.
/// - Under G40 the next straight move leads from the position of the tool to its programmed end.
///
/// LinuxCNC accepts arcs as first moves; they are refused here. It requires a feed rate under G93
/// and converts it; here G93 is refused while a side is active.
#[derive(Clone, Debug)]
pub struct Compensation<const N: usize> {
    active: Option<Active>,
    /// End of the known part of the contour.
    at: [Nm; N],
    /// Position of the tool centre, in the plane, after all returned commands.
    tool: Vector,
    is_entering: bool,
    is_leaving: bool,
    pending: Option<Pending<N>>,
    waiting: [Option<Command<N>>; WAITING],
}

#[derive(Copy, Clone, Debug)]
struct Active {
    /// Distance to the left of the contour; to the right when negative.
    by: i64,
    plane: Plane,
}

/// A move whose end depends on the next one.
#[derive(Clone, Debug)]
struct Pending<const N: usize> {
    command: Command<N>,
    course: Course,
}

/// The offset curve of a move.
#[derive(Copy, Clone, Debug)]
struct Course {
    start: Vector,
    end: Vector,
    /// Unit vectors along the move.
    first: Vector,
    last: Vector,
    /// Centre, radius, and whether it is counter-clockwise.
    arc: Option<(Vector, i64, bool)>,
}

impl Course {
    /// Whether a common point lies on this part of the curve.
    fn reaches(&self, point: Vector) -> bool {
        let close = |other| length(minus(point, other)) <= ROUNDING;
        if close(self.start) || close(self.end) {
            return true;
        }
        match self.arc {
            None => {
                let ahead = |vector| crate::compensation::offset::dot(vector, self.first) > 0;
                ahead(minus(point, self.start)) && ahead(minus(self.end, point))
            }
            Some((centre, _, counter_clockwise)) => {
                let [start, end, point] =
                    [self.start, self.end, point].map(|point| minus(point, centre));
                if counter_clockwise {
                    is_between(start, end, point)
                } else {
                    is_between(end, start, point)
                }
            }
        }
    }
}

/// The commands of one block after compensation; see [`Compensation::apply`].
#[derive(Clone, Debug)]
pub struct Compensated<const N: usize> {
    /// The stage before the commands, where it does not pass them on unchanged.
    stage: Option<Compensation<N>>,
    commands: Commands<N>,
    freed: Freed<N>,
}

/// A short queue: filled when it is empty, then drained.
#[derive(Clone, Debug)]
struct Freed<const N: usize> {
    places: [Option<Command<N>>; FREED],
}

impl<const N: usize> Freed<N> {
    const fn new() -> Self {
        Freed {
            places: [const { None }; FREED],
        }
    }

    /// There is room: one command releases at most as many commands as there are entries.
    fn push(&mut self, command: Command<N>) {
        if let Some(place) = self.places.iter_mut().find(|place| place.is_none()) {
            *place = Some(command);
        }
    }

    fn pop(&mut self) -> Option<Command<N>> {
        // `take` would copy an empty place too.
        let place = self.places.iter_mut().find(|place| place.is_some());
        place.and_then(Option::take)
    }

    fn clear(&mut self) {
        self.places.iter_mut().for_each(|place| *place = None);
    }
}

impl<const N: usize> Compensated<N> {
    /// No commands.
    pub const fn new() -> Self {
        Compensated {
            stage: None,
            commands: Commands::new(),
            freed: Freed::new(),
        }
    }

    /// The commands before compensation: [`Modal::apply`](crate::Modal::apply) writes them, and
    /// [`Modal::revert`](crate::Modal::revert) takes their block back. Then they wait for
    /// [`Compensation::apply`].
    pub const fn commands(&mut self) -> &mut Commands<N> {
        &mut self.commands
    }

    /// Drops the commands that have not been taken.
    pub fn clear(&mut self) {
        self.stage = None;
        self.commands.clear();
        self.freed.clear();
    }
}

impl<const N: usize> Default for Compensated<N> {
    fn default() -> Self {
        Compensated::new()
    }
}

impl<const N: usize> Iterator for Compensated<N> {
    type Item = Command<N>;

    fn next(&mut self) -> Option<Command<N>> {
        loop {
            if let Some(command) = self.freed.pop() {
                return Some(command);
            }
            let command = self.commands.next()?;
            let Some(stage) = &mut self.stage else {
                return Some(command);
            };
            // `apply` has processed all of them without an error.
            if stage.push(command, &mut self.freed).is_err() {
                return None;
            }
        }
    }
}

impl<const N: usize> core::iter::FusedIterator for Compensated<N> {}

impl<const N: usize> Compensation<N> {
    /// Creates the stage at a position, with compensation off.
    pub const fn new(at: [Nm; N]) -> Self {
        Compensation {
            active: None,
            at,
            tool: [0; 2],
            is_entering: false,
            is_leaving: false,
            pending: None,
            waiting: [const { None }; WAITING],
        }
    }

    /// Whether moves are compensated, or a move still waits for its end.
    pub const fn is_active(&self) -> bool {
        self.active.is_some()
    }

    /// Processes the commands of one block. Returns the stage after them and the commands that are
    /// now determined. All or nothing, as [`Modal::plan`](crate::Modal::plan): with an error
    /// nothing changes.
    ///
    /// # Errors
    /// Those of [`Compensation::apply`].
    pub fn plan(&self, commands: Commands<N>) -> Result<(Self, Compensated<N>), ErrorKind> {
        let mut next = self.clone();
        let mut made = Compensated {
            stage: None,
            commands,
            freed: Freed::new(),
        };
        next.apply(&mut made)?;
        Ok((next, made))
    }

    /// Does [`Compensation::plan`] in place: `made` has the commands of the block, and gives those
    /// that are now determined. With an error the stage is unchanged, and the commands can be taken
    /// back.
    ///
    /// ```
    /// use husillo_gcode::{Block, Command, Compensated, Compensation, Dialect, Modal, Nm};
    ///
    /// let mut modal = Modal::<3>::new(Dialect::RS274);
    /// let mut stage = Compensation::new([Nm(0); 3]);
    /// let mut made = Compensated::new();
    /// let mut ends = 0;
    /// for line in ["G1 X1 F60", "G41.1 D2 G1 X4", "Y5", "G40 X0"] {
    ///     let block = Block::parse(line.as_bytes(), &Dialect::RS274).unwrap();
    ///     modal.apply(&block, made.commands()).unwrap();
    ///     if stage.apply(&mut made).is_err() {
    ///         modal.revert(made.commands());
    ///     }
    ///     ends += made.by_ref().filter_map(|command| command.end()).count();
    /// }
    /// assert_eq!((ends, modal.position()[1]), (4, Nm(5_000_000)));
    /// ```
    ///
    /// # Errors
    /// E0320 to E0323 (see [`ErrorKind`]), E0508 under G93, and E0324 when more than four commands
    /// that do not move in the plane stand between two moves that do.
    ///
    /// # Cost
    /// While compensation is off, one look at the commands. Otherwise one pass over them here, one
    /// when they are pulled, and two copies of the stage.
    pub fn apply(&mut self, made: &mut Compensated<N>) -> Result<(), ErrorKind> {
        made.stage = None;
        made.freed.clear();
        if self.passes(&made.commands) {
            let ends = made.commands.pending().filter_map(|command| command.end());
            self.at = ends.last().unwrap_or(self.at);
            return Ok(());
        }
        let mut next = self.clone();
        let mut freed = Freed::new();
        for command in made.commands.clone() {
            next.push(command, &mut freed)?;
            freed.clear();
        }
        made.stage = Some(core::mem::replace(self, next));
        Ok(())
    }

    /// Whether the stage passes these commands on unchanged.
    const fn passes(&self, commands: &Commands<N>) -> bool {
        self.active.is_none() && !self.is_leaving && !commands.compensates()
    }

    /// Number of commands that wait: a move for its end, and the commands after it. When a later
    /// block releases them, all of them are returned before the commands of that block.
    pub fn held(&self) -> usize {
        let moves = self.pending.iter().map(|_| ());
        moves
            .chain(self.waiting.iter().flatten().map(|_| ()))
            .fold(0, |held: usize, ()| held.saturating_add(1))
    }

    /// The commands that still wait, for a program that ends without G40, M2 or M30.
    pub fn finish(mut self) -> Compensated<N> {
        let mut freed = Freed::new();
        self.flush(None, &mut freed);
        Compensated {
            stage: None,
            commands: Commands::new(),
            freed,
        }
    }

    /// Processes one command of the contour.
    fn push(&mut self, command: Command<N>, out: &mut Freed<N>) -> Result<(), ErrorKind> {
        match command {
            Command::Compensation {
                side: Some(side),
                radius,
                plane,
            } => {
                let by = if side == Side::Left {
                    radius.0
                } else {
                    radius.0.saturating_neg()
                };
                self.active = Some(Active { by, plane });
                self.tool = flat(plane, &self.at);
                self.is_entering = true;
                return Ok(());
            }
            Command::Compensation { side: None, .. } => {
                self.flush(None, out);
                self.is_leaving = self.active.take().is_some_and(|active| active.by != 0);
                return Ok(());
            }
            Command::End { .. } => {
                self.flush(None, out);
                self.active = None;
                out.push(command);
                return Ok(());
            }
            _ => {}
        }
        let Some(active) = self.active.filter(|active| active.by != 0) else {
            if let Some(end) = command.end() {
                if self.is_leaving && matches!(command, Command::Arc { .. }) {
                    return Err(ErrorKind::CompensationEntry);
                }
                self.is_leaving = false;
                self.at = end;
            }
            out.push(command);
            return Ok(());
        };
        let Some(end) = command.end() else {
            return self.wait(command, out);
        };
        let moves = flat(active.plane, &self.at) != flat(active.plane, &end);
        if moves || matches!(command, Command::Arc { .. }) {
            self.contour(active, command, end, out)?;
        } else {
            self.wait(command, out)?;
        }
        self.at = end;
        Ok(())
    }

    /// Handles a command that does not move in the plane: it follows the pending move, or is
    /// returned at once.
    fn wait(&mut self, command: Command<N>, out: &mut Freed<N>) -> Result<(), ErrorKind> {
        if self.pending.is_none() {
            let here = self.tool;
            out.push(self.placed(command, here));
            return Ok(());
        }
        let place = self.waiting.iter_mut().find(|place| place.is_none());
        *place.ok_or(ErrorKind::TooManyWaiting)? = Some(command);
        Ok(())
    }

    /// The same command with its end at another point of the plane.
    fn placed(&self, command: Command<N>, at: Vector) -> Command<N> {
        let Some(active) = self.active else {
            return command;
        };
        let place = |to: [Nm; N]| placed(active.plane, to, at);
        match command {
            Command::Rapid { to } => Command::Rapid { to: place(to) },
            Command::Linear { to, feed } => Command::Linear {
                to: place(to),
                feed,
            },
            other => other,
        }
    }

    /// Returns the pending move, ending at a given point or at its own end, and the commands that
    /// wait after it.
    fn flush(&mut self, end: Option<Vector>, out: &mut Freed<N>) {
        let (Some(pending), Some(active)) = (self.pending.take(), self.active) else {
            return;
        };
        let end = end.unwrap_or(pending.course.end);
        out.push(match pending.command {
            Command::Arc { arc, feed } => {
                let to = placed(active.plane, arc.to, end);
                let points = [self.tool, end, flat(active.plane, &arc.centre)];
                let [from, at, centre] = points.map(|point| point.map(Nm));
                Command::Arc {
                    arc: Arc {
                        to,
                        radius: None,
                        mismatch: mismatch_of(&from, &at, &centre).unwrap_or(arc.mismatch),
                        ..arc
                    },
                    feed,
                }
            }
            straight => self.placed(straight, end),
        });
        self.tool = end;
        for place in 0..WAITING {
            let waiting = self.waiting.get_mut(place).and_then(Option::take);
            if let Some(command) = waiting {
                let command = self.placed(command, end);
                out.push(command);
            }
        }
    }

    /// Processes a move of the contour: its offset, and the corner before it.
    fn contour(
        &mut self,
        active: Active,
        command: Command<N>,
        end: [Nm; N],
        out: &mut Freed<N>,
    ) -> Result<(), ErrorKind> {
        if let Some(Feed::InverseTime { .. }) = feed(&command) {
            return Err(ErrorKind::WrongFeedMode);
        }
        let corner = flat(active.plane, &self.at);
        let to = flat(active.plane, &end);
        let mut course = course(&active, &command, corner, to)?;
        if self.is_entering {
            if course.arc.is_some() {
                return Err(ErrorKind::CompensationEntry);
            }
            let radius = active.by.saturating_abs();
            if length(minus(to, corner)) <= radius {
                return Err(ErrorKind::EntryTooShort(Measure::of(Nm(radius))));
            }
            self.is_entering = false;
        } else if let Some(before) = self.pending.clone() {
            course.start = self.join(&active, &before, &command, &course, corner, out)?;
        }
        self.pending = Some(Pending { command, course });
        Ok(())
    }

    /// Ends the previous move where the next one begins, and returns that point.
    fn join(
        &mut self,
        active: &Active,
        before: &Pending<N>,
        command: &Command<N>,
        course: &Course,
        corner: Vector,
        out: &mut Freed<N>,
    ) -> Result<Vector, ErrorKind> {
        let (sine, cosine) = turn(before.course.last, course.first);
        // Distance between the two offset points of the corner. It is small for small turns, and
        // for a tool without a radius.
        let gap = length(minus(before.course.end, course.start));
        if gap <= 2 {
            self.flush(None, out);
            return Ok(before.course.end);
        }
        let is_inside = (sine < 0) == (active.by < 0) && sine != 0;
        if is_inside {
            let point = common(active, &before.course, course, corner).ok_or(ErrorKind::Gouge)?;
            if !before.course.reaches(point) || !course.reaches(point) {
                return Err(ErrorKind::Gouge);
            }
            self.flush(Some(point), out);
            return Ok(point);
        }
        self.flush(None, out);
        let height = self.at;
        let at = |point: Vector| placed(active.plane, height, point);
        match feed(command).or(feed(&before.command)) {
            Some(feed) => {
                let direction = if active.by > 0 {
                    Direction::Clockwise
                } else {
                    Direction::CounterClockwise
                };
                let points = [before.course.end, course.start, corner];
                let [from, to, centre] = points.map(|point| point.map(Nm));
                out.push(Command::Arc {
                    arc: Arc {
                        to: at(course.start),
                        centre: at(corner),
                        plane: active.plane,
                        direction,
                        turns: 0,
                        radius: None,
                        mismatch: mismatch_of(&from, &to, &centre).unwrap_or_default(),
                        resolution: Nm(1),
                    },
                    feed,
                });
            }
            // Between rapids: around the corner on straight lines, square where the corner is
            // sharp.
            None => {
                let normals = [left(before.course.last), left(course.first)];
                let sharp = mitre(normals[0], normals[1], active.by).filter(|_| cosine >= 0);
                if let Some(aside) = sharp {
                    out.push(Command::Rapid {
                        to: at(plus(corner, aside)),
                    });
                } else {
                    let reach = active.by.saturating_abs();
                    let ahead = plus(before.course.end, along(before.course.last, reach));
                    let behind = plus(course.start, along(opposite(course.first), reach));
                    out.push(Command::Rapid { to: at(ahead) });
                    out.push(Command::Rapid { to: at(behind) });
                }
                out.push(Command::Rapid {
                    to: at(course.start),
                });
            }
        }
        self.tool = course.start;
        Ok(course.start)
    }
}

/// The coordinates of a point in a plane.
fn flat<const N: usize>(plane: Plane, point: &[Nm; N]) -> Vector {
    plane
        .axes()
        .map(|axis| point.get(axis).copied().unwrap_or_default().0)
}

/// A point with other coordinates in a plane.
fn placed<const N: usize>(plane: Plane, mut point: [Nm; N], at: Vector) -> [Nm; N] {
    for (axis, at) in plane.axes().into_iter().zip(at) {
        if let Some(entry) = point.get_mut(axis) {
            *entry = Nm(at);
        }
    }
    point
}

const fn feed<const N: usize>(command: &Command<N>) -> Option<Feed> {
    match command {
        Command::Linear { feed, .. } | Command::Arc { feed, .. } => Some(*feed),
        _ => None,
    }
}

/// The offset curve of a move.
fn course<const N: usize>(
    active: &Active,
    command: &Command<N>,
    from: Vector,
    to: Vector,
) -> Result<Course, ErrorKind> {
    let (first, last, arc) = match command {
        Command::Arc { arc, .. } => {
            let centre = flat(active.plane, &arc.centre);
            let counter_clockwise = arc.direction == Direction::CounterClockwise;
            let [begin, end] = [from, to].map(|point| minus(point, centre));
            // For a counter-clockwise arc, left is inward.
            let inward = if counter_clockwise {
                active.by
            } else {
                active.by.saturating_neg()
            };
            let radius = length(begin).min(length(end)).saturating_sub(inward);
            if radius <= 0 {
                let radius = Measure::of(Nm(active.by));
                return Err(ErrorKind::ArcSmallerThanTool(radius));
            }
            let tangent = |radial: Vector| {
                let tangent = left(unit(radial));
                if counter_clockwise {
                    tangent
                } else {
                    opposite(tangent)
                }
            };
            let arc = Some((centre, radius, counter_clockwise));
            (tangent(begin), tangent(end), arc)
        }
        _ => {
            let direction = unit(minus(to, from));
            (direction, direction, None)
        }
    };
    Ok(Course {
        start: plus(from, along(left(first), active.by)),
        end: plus(to, along(left(last), active.by)),
        first,
        last,
        arc,
    })
}

/// The common point of two offset curves near their corner.
fn common(active: &Active, before: &Course, after: &Course, corner: Vector) -> Option<Vector> {
    match (before.arc, after.arc) {
        (None, None) => {
            mitre(left(before.last), left(after.first), active.by).map(|aside| plus(corner, aside))
        }
        (None, Some((centre, radius, _))) => {
            line_and_circle(before.end, before.last, centre, radius, corner)
        }
        (Some((centre, radius, _)), None) => {
            line_and_circle(after.start, after.first, centre, radius, corner)
        }
        (Some((centre, radius, _)), Some((other, other_radius, _))) => {
            circles((centre, radius), (other, other_radius), corner)
        }
    }
}
/// The mismatch of an arc that fits.
fn mismatch_of(from: &[Nm; 2], to: &[Nm; 2], centre: &[Nm; 2]) -> Option<Nm> {
    let mut off = Nm(0);
    with_centre(from, to, centre, [0, 1], SLACK_INCH, &mut off)
        .ok()
        .map(|()| off)
}

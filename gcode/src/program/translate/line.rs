//! A command as lines of a dialect.

use crate::blocks::block::Block;
use crate::codes::code::Side;
use crate::codes::dialect::Flavour;
use crate::codes::letters::axis_letter;
use crate::command::arc::{Arc, Direction, Plane};
use crate::command::{Command, Feed, Input, PathMode, SpindleDirection, Switch, WaitFor};
use crate::modal::Modal;
use crate::modal::modes::{Distance, FeedMode, Units};
use crate::program::translate::is_same;
use crate::values::nm::{Nm, coordinate};
use core::fmt::{self, Write};

/// Most lines of a command: modes, and up to three for coolant.
pub(super) const MOST: usize = 5;

/// A line of at most this many bytes; the longest here has about 130.
const LONGEST: usize = 192;

/// A line without its end.
#[derive(Copy, Clone)]
pub(super) struct Text {
    bytes: [u8; LONGEST],
    count: usize,
}

impl Text {
    const fn new() -> Self {
        Text {
            bytes: [0; LONGEST],
            count: 0,
        }
    }

    pub(super) fn bytes(&self) -> &[u8] {
        self.bytes.get(..self.count).unwrap_or_default()
    }
}

impl Write for Text {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        let end = self.count.wrapping_add(text.len());
        let room = self.bytes.get_mut(self.count..end).ok_or(fmt::Error)?;
        room.copy_from_slice(text.as_bytes());
        self.count = end;
        Ok(())
    }
}

/// The lines in progress, and the state of the dialect after them.
struct Lines<'a, const N: usize> {
    state: &'a mut Modal<N>,
    lines: &'a mut [Option<Text>; MOST],
    count: usize,
}

/// A number of millionths, as a decimal.
fn millionths(value: u64) -> Result<Nm, fmt::Error> {
    i64::try_from(value).map(Nm).map_err(|_| fmt::Error)
}

/// Writes a command. Returns the number of lines; `None` if the dialect does not have it.
pub(super) fn write<const N: usize>(
    command: &Command<N>,
    state: &mut Modal<N>,
    lines: &mut [Option<Text>; MOST],
) -> Option<usize> {
    let mut lines = Lines {
        state,
        lines,
        count: 0,
    };
    if let Command::Coolant { mist, flood } = *command {
        lines.coolant(mist, flood)?;
    } else {
        if command.end().is_some() || has_lengths(command) {
            lines.modes()?;
        }
        let mut text = Text::new();
        lines.command(command, &mut text).ok()?;
        lines.push(text, Some(command))?;
    }
    Some(lines.count)
}

/// Whether the words of a command other than a move are lengths.
const fn has_lengths<const N: usize>(command: &Command<N>) -> bool {
    matches!(
        command,
        Command::ToolLength { .. }
            | Command::Compensation { .. }
            | Command::Surface { .. }
            | Command::NurbsBegin { .. }
            | Command::NurbsPoint { .. }
            | Command::Path { .. }
    )
}

impl<const N: usize> Lines<'_, N> {
    /// Adds a line, which must be the command in this dialect.
    fn push(&mut self, text: Text, wanted: Option<&Command<N>>) -> Option<()> {
        let block = Block::parse(text.bytes(), self.state.dialect()).ok()?;
        let (next, mut commands) = self.state.plan(&block).ok()?;
        if let Some(wanted) = wanted {
            let is_wanted = commands.next().is_some_and(|made| is_same(&made, wanted));
            if !is_wanted || commands.next().is_some() {
                return None;
            }
        }
        *self.state = next;
        *self.lines.get_mut(self.count)? = Some(text);
        self.count = self.count.wrapping_add(1);
        Some(())
    }

    fn is_grbl(&self) -> bool {
        self.state.dialect().flavour == Flavour::Grbl
    }

    fn plain(&mut self, line: &str) -> Option<()> {
        let mut text = Text::new();
        text.write_str(line).ok()?;
        self.push(text, None)
    }

    /// Absolute millimetres. Units have a line of their own, as an F next to them counts in the
    /// units before.
    fn modes(&mut self) -> Option<()> {
        if self.state.units() != Units::Millimetres {
            self.plain("G21")?;
        }
        if self.state.distance() != Distance::Absolute {
            self.plain("G90")?;
        }
        if self.state.centre_distance() != Distance::Incremental {
            self.plain("G91.1")?;
        }
        Some(())
    }

    fn coolant(&mut self, mist: bool, flood: bool) -> Option<()> {
        let (now_mist, now_flood) = self.state.coolant();
        let is_drier = now_mist && !mist || now_flood && !flood;
        if is_drier || !(mist || flood) {
            self.plain("M9")?;
        }
        if mist && !self.state.coolant().0 {
            self.plain("M7")?;
        }
        if flood && !self.state.coolant().1 {
            self.plain("M8")?;
        }
        (self.state.coolant() == (mist, flood)).then_some(())
    }

    /// The words of the axes that a point changes; `all` writes these axes in any case.
    fn axes(&self, to: &[Nm; N], all: &[usize], text: &mut Text) -> fmt::Result {
        let mut there = self.state.clone();
        there.set_position(*to);
        let (here, there) = (self.state.position(), there.work_position());
        let axes = self.state.dialect().axes();
        for (axis, ((to, here), there)) in (0usize..).zip(to.iter().zip(here).zip(there)) {
            if *to != here || all.contains(&axis) {
                if self.is_grbl() && axis > 2 {
                    return Err(fmt::Error);
                }
                let letter = axes.letter(axis).unwrap_or(axis_letter(axis));
                write!(text, " {}{there}", char::from(letter))?;
            }
        }
        Ok(())
    }

    /// The code and the `F` of a feed, if it is not in effect.
    fn feed(&self, feed: &Feed, text: &mut Text) -> fmt::Result {
        match *feed {
            Feed::PerMinute(rate) => {
                let is_mode = self.state.feed_mode() == FeedMode::PerMinute;
                if !is_mode {
                    text.write_str(" G94")?;
                }
                match self.state.feed() {
                    Some(now) if is_mode && now == rate => Ok(()),
                    _ => write!(text, " F{rate}"),
                }
            }
            Feed::InverseTime { micro_per_minute } => {
                if self.state.feed_mode() != FeedMode::InverseTime {
                    text.write_str(" G93")?;
                }
                let feed = millionths(micro_per_minute)?;
                write!(text, " F{feed}")
            }
            Feed::PerRevolution(by) => {
                if self.state.feed_mode() != FeedMode::PerRevolution {
                    text.write_str(" G95")?;
                }
                write!(text, " F{by}")
            }
        }
    }

    fn arc(&self, arc: &Arc<N>, feed: &Feed, text: &mut Text) -> fmt::Result {
        // Grbl has no turns and no circle without words, and its tool has a length in Z only.
        if self.is_grbl() && arc.turns != 0 {
            return Err(fmt::Error);
        }
        if self.state.plane() != arc.plane {
            text.write_str(match arc.plane {
                Plane::Xy => "G17 ",
                Plane::Zx => "G18 ",
                Plane::Yz => "G19 ",
            })?;
        }
        text.write_str(match arc.direction {
            Direction::Clockwise => "G2",
            Direction::CounterClockwise => "G3",
        })?;
        let axes = arc.plane.axes();
        self.axes(&arc.to, &axes, text)?;
        let from = self.state.position();
        for (letter, axis) in arc.plane.centre_letters().into_iter().zip(axes) {
            let offset = coordinate(&arc.centre, axis)
                .0
                .saturating_sub(coordinate(&from, axis).0);
            write!(text, " {}{}", char::from(letter), Nm(offset))?;
        }
        if arc.turns != 0 {
            write!(text, " P{}", u64::from(arc.turns).wrapping_add(1))?;
        }
        self.feed(feed, text)
    }

    /// X and Y from another point, as words with these letters.
    fn offset(
        &self,
        at: [Nm; 2],
        from: [Nm; 2],
        letters: [char; 2],
        text: &mut Text,
    ) -> fmt::Result {
        for ((at, from), letter) in at.into_iter().zip(from).zip(letters) {
            write!(text, " {letter}{}", Nm(at.0.saturating_sub(from.0)))?;
        }
        Ok(())
    }

    /// Writes the line of a command.
    fn command(&self, command: &Command<N>, text: &mut Text) -> fmt::Result {
        match command {
            Command::Rapid { to } => {
                text.write_str("G0")?;
                self.axes(to, &[], text)
            }
            Command::Linear { to, feed } => {
                text.write_str("G1")?;
                self.axes(to, &[], text)?;
                self.feed(feed, text)
            }
            Command::Arc { arc, feed } => self.arc(arc, feed, text),
            Command::Spline { spline, feed } => {
                text.write_str("G5")?;
                self.axes(&spline.to, &[0, 1], text)?;
                let [from, first, second, end] = spline.points;
                self.offset(first, from, ['I', 'J'], text)?;
                self.offset(second, end, ['P', 'Q'], text)?;
                self.feed(feed, text)
            }
            Command::Thread { to, lead } => {
                text.write_str("G33")?;
                self.axes(to, &[], text)?;
                write!(text, " K{lead}")
            }
            Command::Tap { bottom, lead, .. } => {
                text.write_str("G33.1")?;
                self.axes(bottom, &[], text)?;
                write!(text, " K{lead}")
            }
            Command::Probe {
                to,
                feed,
                away,
                must,
            } => {
                text.write_str(match (*away, *must) {
                    (false, true) => "G38.2",
                    (false, false) => "G38.3",
                    (true, true) => "G38.4",
                    (true, false) => "G38.5",
                })?;
                self.axes(to, &[], text)?;
                self.feed(feed, text)
            }
            _ => self.other(command, text),
        }
    }

    /// Commands that do not move.
    fn other(&self, command: &Command<N>, text: &mut Text) -> fmt::Result {
        match *command {
            Command::NurbsBegin {
                order,
                micro_weight,
                ref feed,
            } => {
                write!(text, "G5.2 P{} L{order}", millionths(micro_weight)?)?;
                self.feed(feed, text)
            }
            Command::NurbsPoint {
                at: [x, y],
                micro_weight,
            } => {
                let mut to = self.state.position();
                for (to, at) in to.iter_mut().zip([x, y]) {
                    *to = at;
                }
                text.write_str("G5.2")?;
                self.axes(&to, &[0, 1], text)?;
                write!(text, " P{}", millionths(micro_weight)?)
            }
            Command::NurbsEnd { .. } => text.write_str("G5.3"),
            Command::Dwell { micros } => write!(text, "G4 P{}", millionths(micros)?),
            Command::Spindle {
                direction,
                milli_rpm,
            } => spindle(direction, milli_rpm, text),
            Command::Surface {
                direction,
                speed,
                most_milli_rpm,
            } => surface(direction, speed, most_milli_rpm, text),
            Command::Orient {
                micro_degrees,
                direction,
            } => {
                // The numbers of `P`, in their order.
                let number = direction as u8;
                write!(text, "M19 R{} P{number}", millionths(micro_degrees)?)
            }
            Command::Tool { number } => write!(text, "T{number} M6"),
            Command::ToolIs { number } => write!(text, "M61 Q{number}"),
            Command::ToolLength { offset, .. } => self.length(&offset, text),
            Command::Compensation { side, radius, .. } => match side {
                None => text.write_str("G40"),
                Some(side) => {
                    let code = if side == Side::Left { "G41.1" } else { "G42.1" };
                    write!(text, "{code} D{}", Nm(radius.0.saturating_mul(2)))
                }
            },
            Command::Switch { what, on } => self.switch(what, on, text),
            Command::Output {
                number,
                on,
                with_motion,
            } => output(number, on, with_motion, text),
            Command::Analog {
                number,
                micro,
                with_motion,
            } => {
                let code = if with_motion { 67 } else { 68 };
                write!(text, "M{code} E{number} Q{}", Nm(micro))
            }
            Command::Wait {
                input,
                until,
                timeout_micros,
            } => wait(input, until, timeout_micros, text),
            Command::Pallet => text.write_str("M60"),
            Command::Stop { optional } => text.write_str(if optional { "M1" } else { "M0" }),
            Command::End { rewind } => text.write_str(if rewind { "M30" } else { "M2" }),
            Command::Path { mode } => path(mode, text),
            // Moves are above; a stroke of the drill has no code elsewhere.
            _ => Err(fmt::Error),
        }
    }

    fn length(&self, offset: &[Nm; N], text: &mut Text) -> fmt::Result {
        if *offset == [Nm(0); N] {
            return text.write_str("G49");
        }
        text.write_str("G43.1")?;
        let now = self.state.tool_length();
        for (axis, (to, now)) in (0usize..).zip(offset.iter().zip(now)) {
            // At least one axis, also where the length stays.
            if *to != now || axis == 2 {
                if self.is_grbl() && axis != 2 {
                    return Err(fmt::Error);
                }
                write!(text, " {}{to}", char::from(axis_letter(axis)))?;
            }
        }
        Ok(())
    }

    fn switch(&self, what: Switch, on: bool, text: &mut Text) -> fmt::Result {
        let code = match what {
            Switch::Overrides => return text.write_str(if on { "M48" } else { "M49" }),
            Switch::FeedOverride => 50,
            Switch::SpindleOverride => 51,
            Switch::AdaptiveFeed => 52,
            Switch::FeedHold => 53,
        };
        write!(text, "M{code} P{}", u8::from(on))
    }
}

/// M3 to M5.
fn spindle(direction: SpindleDirection, milli_rpm: u64, text: &mut Text) -> fmt::Result {
    match direction {
        SpindleDirection::Off => text.write_str("M5"),
        turns => {
            let speed = millionths(milli_rpm.saturating_mul(1000))?;
            write!(text, "{} S{speed}", turning(turns))
        }
    }
}

/// A spindle at constant surface speed, in metres per minute.
fn surface(
    direction: SpindleDirection,
    speed: Nm,
    most_milli_rpm: Option<u64>,
    text: &mut Text,
) -> fmt::Result {
    let metres = Nm(speed.0.checked_div(1000).unwrap_or(0));
    write!(text, "G96 S{metres}")?;
    if let Some(most) = most_milli_rpm {
        write!(text, " D{}", millionths(most.saturating_mul(1000))?)?;
    }
    write!(text, " {}", turning(direction))
}

fn output(number: u8, on: bool, with_motion: bool, text: &mut Text) -> fmt::Result {
    let code = match (on, with_motion) {
        (true, true) => 62,
        (false, true) => 63,
        (true, false) => 64,
        (false, false) => 65,
    };
    write!(text, "M{code} P{number}")
}

fn wait(input: Input, until: WaitFor, timeout_micros: u64, text: &mut Text) -> fmt::Result {
    match input {
        Input::Digital(number) => write!(text, "M66 P{number}")?,
        Input::Analog(number) => write!(text, "M66 E{number}")?,
    }
    let mode = match until {
        WaitFor::Nothing => 0,
        WaitFor::Rise => 1,
        WaitFor::Fall => 2,
        WaitFor::High => 3,
        WaitFor::Low => 4,
    };
    write!(text, " L{mode} Q{}", millionths(timeout_micros)?)
}

fn path(mode: PathMode, text: &mut Text) -> fmt::Result {
    match mode {
        PathMode::ExactPath => text.write_str("G61"),
        PathMode::ExactStop => text.write_str("G61.1"),
        PathMode::Blend { tolerance: None } => text.write_str("G64"),
        PathMode::Blend {
            tolerance: Some(by),
        } => write!(text, "G64 P{by}"),
    }
}

const fn turning(direction: SpindleDirection) -> &'static str {
    match direction {
        SpindleDirection::Off => "M5",
        SpindleDirection::Clockwise => "M3",
        SpindleDirection::CounterClockwise => "M4",
    }
}

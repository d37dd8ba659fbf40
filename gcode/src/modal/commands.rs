//! The commands of one block, pulled one by one.

use crate::codes::code::Code;
#[cfg(feature = "extended")]
use crate::codes::code::Side;
use crate::command::arc::{Arc, Direction, Plane};
use crate::command::{Command, Feed, PathMode, SpindleDirection};
#[cfg(feature = "extended")]
use crate::command::{HeatWait, Heater, Input, OrientDirection, Spline, Switch, WaitFor};
#[cfg(feature = "extended")]
use crate::cycles::cycle::{Cycle, Holes};
use crate::modal::modes::Modes;
use crate::values::nm::Nm;
#[cfg(feature = "extended")]
use crate::values::nm::coordinate;

/// The commands of one block in order of execution. A small value from which they are pulled one by
/// one. A canned cycle computes each move when it is pulled, at most 2^21 moves.
///
/// The fields that are used most come first, because short instructions reach 32 bytes from the
/// address.
#[derive(Clone, Debug)]
#[repr(C)]
pub struct Commands<const N: usize> {
    /// Bit n: command n is pending.
    pending: u16,
    /// Representative of a series of codes: G5 is any spline, G81 any cycle.
    motion: Option<Code>,
    /// A code of the group of stops; `None` is the drilling cycle of the drill.
    last: Option<Code>,
    spindle: SpindleDirection,
    mist: bool,
    flood: bool,
    /// What the block changed in the modal state.
    changed: Changed,
    /// The motion mode before a block that is only a move.
    motion_before: Option<Code>,
    tool: u32,
    length_number: u32,
    milli_rpm: u64,
    dwell_micros: u64,
    /// Feed of all feed moves.
    pub(crate) feed: Feed,
    /// The arc. Its end is the end of all moves. For an arc that does not fit, its mismatch is the
    /// measure of the error.
    pub(crate) arc: Arc<N>,
    length: [Nm; N],
    /// The values before the block of the modes that it changed.
    pub(crate) before: Modes<N>,
    /// The entry that the block changed, and its position before the block.
    pub(crate) entry: Entry,
    pub(crate) kept: [Nm; N],
    /// Before the block, the rotation of the work frame; or the number and the radius of the tool.
    #[cfg(feature = "extended")]
    pub(crate) kept_angle: u32,
    #[cfg(feature = "extended")]
    pub(crate) kept_tool: (u32, Nm),
    /// The intermediate point of G28.
    pub(crate) via: [Nm; N],
    #[cfg(feature = "extended")]
    path: PathMode,
    /// Lead of G33 and G33.1; weight of a control point of a NURBS.
    #[cfg(feature = "extended")]
    pub(crate) lead: Nm,
    /// Points of a spline; of a cycle the centre of polar coordinates and the start from there.
    #[cfg(feature = "extended")]
    pub(crate) points: [[Nm; 2]; 4],
    #[cfg(feature = "extended")]
    more: More<N>,
}

/// What a block changed in the modal state.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub(crate) enum Changed {
    /// Nothing that can be taken back.
    Nothing,
    /// Position, feed and motion mode.
    Move,
    /// Any modes, and one entry.
    Modes,
}

/// The entry of a table that a block changed. A block changes at most one.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub(crate) enum Entry {
    None,
    /// The position of G28, or of G30.
    Home,
    SecondHome,
    /// A work frame, from 0 (G54) on.
    System(u8),
    /// A place of the tool table.
    #[cfg(feature = "extended")]
    Tool(u8),
}

/// The commands of the extended codes.
#[cfg(feature = "extended")]
#[derive(Clone, Debug)]
struct More<const N: usize> {
    tool_is: bool,
    /// The command before the motion begins a NURBS of this order. The weight of its first point is
    /// in the first entry of `via`, as no other command goes there.
    begins_nurbs: bool,
    order: u8,
    compensation: (Option<Side>, Nm, Plane),
    /// M48 to M53 and M62 to M68, which do not move.
    switch: Plain,
    io: Plain,
    turn: Plain,
    cycle: Option<Cycle<N>>,
}

/// Commands without a position, which fit in a few words.
#[cfg(feature = "extended")]
#[derive(Copy, Clone, Debug)]
pub(crate) enum Plain {
    Surface(SpindleDirection, Nm, Option<u64>),
    Orient(u64, OrientDirection),
    Switch(Switch, bool),
    Output(u8, bool, bool),
    Analog(u8, i64, bool),
    Wait(Input, WaitFor, u64),
    Heat(Heater, u32, HeatWait),
    Fan(u8, u16),
    MotorsOff,
}

#[cfg(feature = "extended")]
impl Plain {
    const fn command<const N: usize>(self) -> Command<N> {
        match self {
            Plain::Surface(direction, speed, most_milli_rpm) => Command::Surface {
                direction,
                speed,
                most_milli_rpm,
            },
            Plain::Orient(micro_degrees, direction) => Command::Orient {
                micro_degrees,
                direction,
            },
            Plain::Switch(what, on) => Command::Switch { what, on },
            Plain::Output(number, on, with_motion) => Command::Output {
                number,
                on,
                with_motion,
            },
            Plain::Analog(number, micro, with_motion) => Command::Analog {
                number,
                micro,
                with_motion,
            },
            Plain::Heat(heater, milli_celsius, wait) => Command::Heat {
                heater,
                milli_celsius,
                wait,
            },
            Plain::Fan(number, per_mille) => Command::Fan { number, per_mille },
            Plain::MotorsOff => Command::MotorsOff,
            Plain::Wait(input, until, timeout_micros) => Command::Wait {
                input,
                until,
                timeout_micros,
            },
        }
    }
}

#[cfg(feature = "extended")]
const IO: u16 = 1 << 0;
const TOOL: u16 = 1 << 1;
const SPINDLE: u16 = 1 << 2;
#[cfg(feature = "extended")]
const TURN: u16 = 1 << 3;
const COOLANT: u16 = 1 << 4;
#[cfg(feature = "extended")]
const SWITCH: u16 = 1 << 5;
const DWELL: u16 = 1 << 6;
#[cfg(feature = "extended")]
const COMPENSATION: u16 = 1 << 7;
const LENGTH: u16 = 1 << 8;
const PATH: u16 = 1 << 9;
const VIA: u16 = 1 << 10;
const MOTION: u16 = 1 << 11;
const LAST: u16 = 1 << 12;

impl<const N: usize> Commands<N> {
    /// Creates an empty value, to be filled by [`Modal::apply`](crate::Modal::apply).
    pub const fn new() -> Self {
        Self::EMPTY
    }

    /// All bytes are zero (unless the extended codes add others), so nothing has to be copied from
    /// a constant.
    const EMPTY: Self = Commands {
        pending: 0,
        motion: None,
        last: None,
        #[cfg(feature = "extended")]
        path: PathMode::ExactPath,
        spindle: SpindleDirection::Off,
        mist: false,
        flood: false,
        tool: 0,
        length_number: 0,
        milli_rpm: 0,
        dwell_micros: 0,
        length: [Nm(0); N],
        changed: Changed::Nothing,
        motion_before: None,
        before: Modes::NONE,
        entry: Entry::None,
        kept: [Nm(0); N],
        #[cfg(feature = "extended")]
        kept_angle: 0,
        #[cfg(feature = "extended")]
        kept_tool: (0, Nm(0)),
        via: [Nm(0); N],
        feed: Feed::PerMinute(Nm(0)),
        arc: Arc {
            to: [Nm(0); N],
            centre: [Nm(0); N],
            plane: Plane::Xy,
            direction: Direction::Clockwise,
            turns: 0,
            radius: None,
            mismatch: Nm(0),
            resolution: Nm(0),
        },
        #[cfg(feature = "extended")]
        lead: Nm(0),
        #[cfg(feature = "extended")]
        points: [[Nm(0); 2]; 4],
        #[cfg(feature = "extended")]
        more: More {
            tool_is: false,
            begins_nurbs: false,
            order: 0,
            compensation: (None, Nm(0), Plane::Xy),
            switch: Plain::Orient(0, OrientDirection::Shorter),
            io: Plain::Orient(0, OrientDirection::Shorter),
            turn: Plain::Orient(0, OrientDirection::Shorter),
            cycle: None,
        },
    };

    /// Drops the commands that have not been taken, for a program that is interrupted.
    pub const fn clear(&mut self) {
        // The contents of the fields are then ignored.
        self.pending = 0;
        self.changed = Changed::Nothing;
    }

    /// Whether all commands have been taken.
    pub const fn is_empty(&self) -> bool {
        self.pending == 0
    }

    /// Whether one of them switches cutter compensation on or off.
    #[cfg(feature = "extended")]
    pub(crate) const fn compensates(&self) -> bool {
        self.pending & COMPENSATION != 0
    }

    /// The pending commands, without taking them: to check all of them before the first is made.
    ///
    /// # Cost
    /// A copy of the canned cycle, if one is pending.
    pub fn pending(&self) -> PendingCommands<'_, N> {
        PendingCommands {
            commands: self,
            pending: self.pending,
            #[cfg(feature = "extended")]
            cycle: match self.is_in_cycle(self.pending & MOTION) {
                true => self.more.cycle.clone(),
                false => None,
            },
        }
    }

    /// Notes a block that is only a move, with the motion mode before it.
    #[inline(always)]
    pub(crate) const fn note_move(&mut self, before: Code) {
        (self.changed, self.motion_before) = (Changed::Move, Some(before));
    }

    /// Notes a block that may have changed any mode.
    pub(crate) const fn note_modes(&mut self) {
        self.changed = Changed::Modes;
    }

    /// Notes the entry of a table that the block changes, and its position.
    pub(crate) fn keep(&mut self, entry: Entry, position: &[Nm; N]) {
        (self.entry, self.kept) = (entry, *position);
    }

    /// What the block changed, and the motion mode before a move. It can be taken back once.
    pub(crate) const fn take_changed(&mut self) -> (Changed, Option<Code>) {
        let changed = (self.changed, self.motion_before);
        self.clear();
        changed
    }

    pub(crate) fn tool(&mut self, number: u32) {
        (self.tool, self.pending) = (number, self.pending | TOOL);
        #[cfg(feature = "extended")]
        {
            self.more.tool_is = false;
        }
    }

    pub(crate) fn spindle(&mut self, direction: SpindleDirection, milli_rpm: u64) {
        (self.spindle, self.milli_rpm) = (direction, milli_rpm);
        self.pending |= SPINDLE;
    }

    pub(crate) fn coolant(&mut self, mist: bool, flood: bool) {
        (self.mist, self.flood, self.pending) = (mist, flood, self.pending | COOLANT);
    }

    pub(crate) fn dwell(&mut self, micros: u64) {
        (self.dwell_micros, self.pending) = (micros, self.pending | DWELL);
    }

    pub(crate) fn length(&mut self, number: u32, offset: &[Nm; N]) {
        (self.length_number, self.length) = (number, *offset);
        self.pending |= LENGTH;
    }

    #[cfg_attr(
        not(feature = "extended"),
        expect(unused_variables, reason = "there is one")
    )]
    pub(crate) fn path(&mut self, mode: PathMode) {
        self.pending |= PATH;
        #[cfg(feature = "extended")]
        {
            self.path = mode;
        }
    }

    /// Adds a rapid to `via` before the motion.
    pub(crate) fn go_via(&mut self) {
        self.pending |= VIA;
        #[cfg(feature = "extended")]
        {
            self.more.begins_nurbs = false;
        }
    }

    /// Adds a motion of any kind to the end of the arc.
    pub(crate) fn motion(&mut self, motion: Code) {
        (self.motion, self.pending) = (Some(motion), self.pending | MOTION);
    }

    pub(crate) fn finish(&mut self, last: Option<Code>) {
        (self.last, self.pending) = (last, self.pending | LAST);
    }
}

#[cfg(feature = "extended")]
impl<const N: usize> Commands<N> {
    pub(crate) fn tool_is(&mut self, number: u32) {
        (self.tool, self.pending) = (number, self.pending | TOOL);
        self.more.tool_is = true;
    }

    /// A spindle at constant surface speed, or at an angle.
    pub(crate) fn turn(&mut self, turn: Plain) {
        (self.more.turn, self.pending) = (turn, self.pending | TURN);
    }

    /// Begins a NURBS before the motion.
    pub(crate) fn begin_nurbs(&mut self, order: u8, micro_weight: u64) {
        self.more.order = order;
        if let Some(weight) = self.via.first_mut() {
            *weight = Nm(micro_weight as i64);
        }
        self.more.begins_nurbs = true;
        self.pending |= VIA;
    }

    /// Adds a control point of a NURBS.
    pub(crate) fn nurbs_point(&mut self, at: [Nm; 2], micro_weight: u64) {
        let [_, _, _, point] = &mut self.points;
        *point = at;
        self.lead = Nm(micro_weight as i64);
        self.motion(Code::Nurbs);
    }

    pub(crate) fn switch(&mut self, switch: Plain) {
        (self.more.switch, self.pending) = (switch, self.pending | SWITCH);
    }

    pub(crate) fn io(&mut self, io: Plain) {
        (self.more.io, self.pending) = (io, self.pending | IO);
    }

    pub(crate) fn compensation(&mut self, side: Option<Side>, radius: Nm, plane: Plane) {
        self.more.compensation = (side, radius, plane);
        self.pending |= COMPENSATION;
    }

    /// The holes of the cycle, to be filled in.
    pub(crate) fn holes(&mut self) -> Option<&mut Holes<N>> {
        self.more.cycle = Some(Cycle::Holes(Holes::NONE));
        self.holes_made().map(|(holes, _)| holes)
    }

    /// The holes of the last cycle, and its points.
    pub(crate) fn holes_made(&mut self) -> Option<(&mut Holes<N>, &mut [[Nm; 2]; 4])> {
        match &mut self.more.cycle {
            Some(Cycle::Holes(holes)) => Some((holes, &mut self.points)),
            _ => None,
        }
    }

    /// Whether a canned cycle is the next of these pending commands.
    #[inline(always)]
    fn is_in_cycle(&self, pending: u16) -> bool {
        pending & pending.wrapping_neg() == MOTION && self.motion == Some(Code::DrillCycle)
    }

    fn cycle_command(&mut self) -> Option<Command<N>> {
        let points = &self.points;
        self.more.cycle.as_mut()?.next(points)
    }

    #[inline(always)]
    pub(crate) fn cycle(&mut self, cycle: Cycle<N>) {
        self.more.cycle = Some(cycle);
        self.motion(Code::DrillCycle);
    }
}

impl<const N: usize> Commands<N> {
    #[inline(always)]
    fn move_command(&self) -> Option<Command<N>> {
        let (to, feed) = (self.arc.to, self.feed);
        Some(match self.motion? {
            Code::Rapid => Command::Rapid { to },
            Code::Linear => Command::Linear { to, feed },
            Code::Clockwise | Code::CounterClockwise => Command::Arc {
                arc: self.arc,
                feed,
            },
            #[cfg(feature = "extended")]
            Code::Thread => Command::Thread {
                to,
                lead: self.lead,
            },
            #[cfg(feature = "extended")]
            Code::RigidTap => Command::Tap {
                bottom: self.via,
                to,
                lead: self.lead,
            },
            #[cfg(feature = "extended")]
            Code::Nurbs => {
                let [_, _, _, at] = self.points;
                Command::NurbsPoint {
                    at,
                    micro_weight: self.lead.0 as u64,
                }
            }
            #[cfg(feature = "extended")]
            Code::NurbsEnd => Command::NurbsEnd { to },
            #[cfg(feature = "extended")]
            Code::Cubic => Command::Spline {
                spline: Spline {
                    to,
                    points: self.points,
                },
                feed,
            },
            code => {
                let (away, must) = code.probe();
                Command::Probe {
                    to,
                    feed,
                    away,
                    must,
                }
            }
        })
    }

    #[inline(always)]
    fn last_command(&self) -> Command<N> {
        match self.last {
            Some(code @ (Code::Stop | Code::OptionalStop)) => Command::Stop {
                optional: code == Code::OptionalStop,
            },
            Some(code @ (Code::End | Code::EndAndRewind)) => Command::End {
                rewind: code == Code::EndAndRewind,
            },
            Some(_) => Command::Pallet,
            None => Command::Drill,
        }
    }

    /// The command of one pending bit, except a canned cycle.
    fn command(&self, bit: u16) -> Option<Command<N>> {
        Some(match bit {
            #[cfg(feature = "extended")]
            IO => self.more.io.command(),
            #[cfg(feature = "extended")]
            TOOL if self.more.tool_is => Command::ToolIs { number: self.tool },
            TOOL => Command::Tool { number: self.tool },
            SPINDLE => Command::Spindle {
                direction: self.spindle,
                milli_rpm: self.milli_rpm,
            },
            #[cfg(feature = "extended")]
            TURN => self.more.turn.command(),
            COOLANT => Command::Coolant {
                mist: self.mist,
                flood: self.flood,
            },
            #[cfg(feature = "extended")]
            SWITCH => self.more.switch.command(),
            DWELL => Command::Dwell {
                micros: self.dwell_micros,
            },
            #[cfg(feature = "extended")]
            COMPENSATION => Command::Compensation {
                side: self.more.compensation.0,
                radius: self.more.compensation.1,
                plane: self.more.compensation.2,
            },
            LENGTH => Command::ToolLength {
                number: self.length_number,
                offset: self.length,
            },
            #[cfg(feature = "extended")]
            PATH => Command::Path { mode: self.path },
            #[cfg(not(feature = "extended"))]
            PATH => Command::Path {
                mode: PathMode::ExactPath,
            },
            #[cfg(feature = "extended")]
            VIA if self.more.begins_nurbs => Command::NurbsBegin {
                order: self.more.order,
                micro_weight: coordinate(&self.via, 0).0 as u64,
                feed: self.feed,
            },
            VIA => Command::Rapid { to: self.via },
            MOTION => self.move_command()?,
            LAST => self.last_command(),
            _ => return None,
        })
    }
}

/// The pending commands of a block, none of which is taken. See [`Commands::pending`].
#[derive(Clone, Debug)]
pub struct PendingCommands<'a, const N: usize> {
    commands: &'a Commands<N>,
    pending: u16,
    /// The canned cycle, from its next command on.
    #[cfg(feature = "extended")]
    cycle: Option<Cycle<N>>,
}

impl<const N: usize> Iterator for PendingCommands<'_, N> {
    type Item = Command<N>;

    fn next(&mut self) -> Option<Command<N>> {
        #[cfg(feature = "extended")]
        if self.commands.is_in_cycle(self.pending) {
            let next = self.cycle.as_mut();
            if let Some(command) = next.and_then(|cycle| cycle.next(&self.commands.points)) {
                return Some(command);
            }
            self.pending &= !MOTION;
        }
        let lowest = self.pending & self.pending.wrapping_neg();
        self.pending &= !lowest;
        self.commands.command(lowest)
    }
}

impl<const N: usize> core::iter::FusedIterator for PendingCommands<'_, N> {}

impl<const N: usize> Default for Commands<N> {
    fn default() -> Self {
        Commands::new()
    }
}

impl<const N: usize> Iterator for Commands<N> {
    type Item = Command<N>;

    #[cfg_attr(not(target_has_atomic = "32"), inline(never))]
    fn next(&mut self) -> Option<Command<N>> {
        #[cfg(feature = "extended")]
        if self.is_in_cycle(self.pending) {
            if let Some(command) = self.cycle_command() {
                return Some(command);
            }
            self.pending &= !MOTION;
        }
        let lowest = self.pending & self.pending.wrapping_neg();
        self.pending &= !lowest;
        self.command(lowest)
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        let count = self.pending.count_ones() as usize;
        #[cfg(feature = "extended")]
        if self.motion == Some(Code::DrillCycle) && self.pending & MOTION != 0 {
            return (count.saturating_sub(1), None);
        }
        (count, Some(count))
    }
}

impl<const N: usize> core::iter::FusedIterator for Commands<N> {}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::string::ToString;
    use std::vec::Vec;

    #[test]
    fn commands_come_in_order_of_execution() {
        let mut commands = Commands::<2>::new();
        commands.finish(Some(Code::EndAndRewind));
        commands.arc.to = [Nm(1_500_000), Nm(-1)];
        commands.motion(Code::Rapid);
        commands.dwell(1_500_000);
        commands.spindle(SpindleDirection::CounterClockwise, 1_000_500);
        commands.coolant(true, true);
        commands.path(PathMode::ExactPath);
        commands.tool(3);
        assert_eq!(commands.size_hint(), (7, Some(7)));
        let lines: Vec<_> = commands.map(|command| command.to_string()).collect();
        assert_eq!(
            lines,
            [
                "tool 3",
                "spindle ccw 1000.5 rpm",
                "coolant mist flood",
                "dwell 1.5 s",
                "path exact",
                "rapid X1.5 Y-0.000001",
                "end rewind"
            ]
        );
    }
}

//! The commands of one block, pulled one by one.

use crate::arc::Plane;
use crate::code::{EXTENDED, Side};
use crate::command::{Command, Feed, Input, PathMode, SpindleDirection, Switch, WaitFor};
#[cfg(feature = "extended")]
use crate::cycle::Cycle;
use crate::nm::Nm;

/// The commands of one block, in their order of execution. Small, owned, and pulled one by one; a canned cycle makes
/// its moves as they are pulled, at most 2^21 of them.
#[derive(Clone, Debug)]
pub struct Commands<const N: usize> {
    /// Bit n: the command of place n is still to come.
    pending: u16,
    tool: u32,
    tool_is: bool,
    spindle: (SpindleDirection, u64),
    coolant: (bool, bool),
    dwell_micros: u64,
    path: PathMode,
    compensation: (Option<Side>, Nm, Plane),
    length: (u32, [Nm; N]),
    /// The point a G28 goes through.
    via: [Nm; N],
    /// M48 to M53, M62 to M68: no motion in it.
    switch: Plain,
    io: Plain,
    turn: Plain,
    last: Plain,
    motion: Body<N>,
}

/// The commands without a position, which fit a few words.
#[derive(Copy, Clone, Debug)]
pub(crate) enum Plain {
    Surface(SpindleDirection, Nm, Option<u64>),
    Orient(u64, u8),
    Switch(Switch, bool),
    Output(u8, bool, bool),
    Analog(u8, i64, bool),
    Wait(Input, WaitFor, u64),
    Stop(bool),
    End(bool),
    Pallet,
    Drill,
}

impl Plain {
    const fn command<const N: usize>(self) -> Command<N> {
        match self {
            Plain::Surface(direction, speed, most_milli_rpm) => Command::Surface {
                direction,
                speed,
                most_milli_rpm,
            },
            Plain::Orient(micro_degrees, way) => Command::Orient { micro_degrees, way },
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
            Plain::Wait(input, until, timeout_micros) => Command::Wait {
                input,
                until,
                timeout_micros,
            },
            Plain::Stop(optional) => Command::Stop { optional },
            Plain::End(rewind) => Command::End { rewind },
            Plain::Pallet => Command::Pallet,
            Plain::Drill => Command::Drill,
        }
    }
}

/// What moves.
#[derive(Clone, Debug)]
enum Body<const N: usize> {
    /// G0, or with a feed G1: most of all moves, so without the detour over a [`Command`] (whose variants are copied byte
    /// by byte where they meet).
    Straight {
        to: [Nm; N],
        feed: Option<Feed>,
    },
    One(Command<N>),
    #[cfg(feature = "extended")]
    Cycle(Cycle<N>),
}

const IO: u16 = 1 << 0;
const TOOL: u16 = 1 << 1;
const SPINDLE: u16 = 1 << 2;
const TURN: u16 = 1 << 3;
const COOLANT: u16 = 1 << 4;
const SWITCH: u16 = 1 << 5;
const DWELL: u16 = 1 << 6;
const COMPENSATION: u16 = 1 << 7;
const LENGTH: u16 = 1 << 8;
const PATH: u16 = 1 << 9;
const VIA: u16 = 1 << 10;
const MOTION: u16 = 1 << 11;
const LAST: u16 = 1 << 12;

impl<const N: usize> Commands<N> {
    /// None: to be filled by [`Modal::apply`](crate::Modal::apply).
    pub const fn new() -> Self {
        Commands {
            pending: 0,
            tool: 0,
            tool_is: false,
            spindle: (SpindleDirection::Off, 0),
            coolant: (false, false),
            dwell_micros: 0,
            path: PathMode::ExactPath,
            compensation: (None, Nm(0), Plane::Xy),
            length: (0, [Nm(0); N]),
            via: [Nm(0); N],
            switch: Plain::Pallet,
            io: Plain::Pallet,
            turn: Plain::Pallet,
            last: Plain::Pallet,
            motion: Body::One(Command::Pallet),
        }
    }

    /// None to come; what the fields hold is no longer looked at.
    pub(crate) fn clear(&mut self) {
        self.pending = 0;
    }

    pub(crate) fn tool(&mut self, number: u32) {
        (self.tool, self.tool_is, self.pending) = (number, false, self.pending | TOOL);
    }

    pub(crate) fn tool_is(&mut self, number: u32) {
        (self.tool, self.tool_is, self.pending) = (number, true, self.pending | TOOL);
    }

    pub(crate) fn spindle(&mut self, direction: SpindleDirection, milli_rpm: u64) {
        (self.spindle, self.pending) = ((direction, milli_rpm), self.pending | SPINDLE);
    }

    /// A spindle at constant surface speed, or at an angle.
    pub(crate) fn turn(&mut self, turn: Plain) {
        (self.turn, self.pending) = (turn, self.pending | TURN);
    }

    pub(crate) fn coolant(&mut self, mist: bool, flood: bool) {
        (self.coolant, self.pending) = ((mist, flood), self.pending | COOLANT);
    }

    pub(crate) fn switch(&mut self, switch: Plain) {
        (self.switch, self.pending) = (switch, self.pending | SWITCH);
    }

    pub(crate) fn io(&mut self, io: Plain) {
        (self.io, self.pending) = (io, self.pending | IO);
    }

    pub(crate) fn dwell(&mut self, micros: u64) {
        (self.dwell_micros, self.pending) = (micros, self.pending | DWELL);
    }

    pub(crate) fn compensation(&mut self, side: Option<Side>, radius: Nm, plane: Plane) {
        (self.compensation, self.pending) = ((side, radius, plane), self.pending | COMPENSATION);
    }

    pub(crate) fn length(&mut self, number: u32, offset: [Nm; N]) {
        (self.length, self.pending) = ((number, offset), self.pending | LENGTH);
    }

    pub(crate) fn path(&mut self, mode: PathMode) {
        (self.path, self.pending) = (mode, self.pending | PATH);
    }

    pub(crate) fn via(&mut self, at: [Nm; N]) {
        (self.via, self.pending) = (at, self.pending | VIA);
    }

    pub(crate) fn motion(&mut self, motion: Command<N>) {
        (self.motion, self.pending) = (Body::One(motion), self.pending | MOTION);
    }

    /// G0 without a feed, G1 with it.
    #[inline]
    pub(crate) fn straight(&mut self, to: [Nm; N], feed: Option<Feed>) {
        (self.motion, self.pending) = (Body::Straight { to, feed }, self.pending | MOTION);
    }

    #[cfg(feature = "extended")]
    pub(crate) fn cycle(&mut self, cycle: Cycle<N>) {
        (self.motion, self.pending) = (Body::Cycle(cycle), self.pending | MOTION);
    }

    pub(crate) fn finish(&mut self, last: Plain) {
        (self.last, self.pending) = (last, self.pending | LAST);
    }
}

impl<const N: usize> Default for Commands<N> {
    fn default() -> Self {
        Commands::new()
    }
}

impl<const N: usize> Iterator for Commands<N> {
    type Item = Command<N>;

    fn next(&mut self) -> Option<Command<N>> {
        #[cfg_attr(not(feature = "extended"), expect(unused_mut))]
        let mut lowest = self.pending & self.pending.wrapping_neg();
        if lowest == MOTION {
            match &mut self.motion {
                Body::Straight { to, feed } => {
                    self.pending &= !MOTION;
                    let to = *to;
                    return Some(match *feed {
                        None => Command::Rapid { to },
                        Some(feed) => Command::Linear { to, feed },
                    });
                }
                Body::One(command) => {
                    self.pending &= !MOTION;
                    return Some(*command);
                }
                #[cfg(feature = "extended")]
                Body::Cycle(cycle) => {
                    if let Some(command) = cycle.next() {
                        return Some(command);
                    }
                    self.pending &= !MOTION;
                    lowest = self.pending & self.pending.wrapping_neg();
                }
            }
        }
        self.pending &= !lowest;
        Some(match lowest {
            IO if EXTENDED => self.io.command(),
            TOOL if EXTENDED && self.tool_is => Command::ToolIs { number: self.tool },
            TOOL => Command::Tool { number: self.tool },
            SPINDLE => Command::Spindle {
                direction: self.spindle.0,
                milli_rpm: self.spindle.1,
            },
            TURN if EXTENDED => self.turn.command(),
            COOLANT => Command::Coolant {
                mist: self.coolant.0,
                flood: self.coolant.1,
            },
            SWITCH if EXTENDED => self.switch.command(),
            DWELL => Command::Dwell {
                micros: self.dwell_micros,
            },
            COMPENSATION if EXTENDED => Command::Compensation {
                side: self.compensation.0,
                radius: self.compensation.1,
                plane: self.compensation.2,
            },
            LENGTH => Command::ToolLength {
                number: self.length.0,
                offset: self.length.1,
            },
            PATH => Command::Path { mode: self.path },
            VIA => Command::Rapid { to: self.via },
            LAST => self.last.command(),
            _ => return None,
        })
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        let count = self.pending.count_ones() as usize;
        match self.motion {
            #[cfg(feature = "extended")]
            Body::Cycle(_) if self.pending & MOTION != 0 => (count.saturating_sub(1), None),
            _ => (count, Some(count)),
        }
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
        commands.finish(Plain::End(true));
        commands.motion(Command::Rapid {
            to: [Nm(1_500_000), Nm(-1)],
        });
        commands.dwell(1_500_000);
        commands.spindle(SpindleDirection::CounterClockwise, 1_000_500);
        commands.coolant(true, true);
        commands.path(PathMode::Blend {
            tolerance: Some(Nm(50_000)),
        });
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
                "path blend 0.05",
                "rapid X1.5 Y-0.000001",
                "end rewind"
            ]
        );
    }
}

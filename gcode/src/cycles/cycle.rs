//! Canned cycles as small state machines: each pull returns the next command of the cycle.

use crate::codes::kind::Kind;
use crate::command::arc::Plane;
use crate::command::{Command, Feed, PathMode, SpindleDirection};
use crate::cycles::thread::Passes;
use crate::values::nm::Nm;

impl Kind {
    /// The actions in each hole, from the retract plane down.
    const fn steps(self) -> &'static [Step] {
        use Level::{Bottom, Clear, Middle, Retract};
        use Step::{Dwell, Feed, Manual, Oriented, Peck, Rapid, Reversed, Running, Shift, Stopped};
        match self {
            Kind::Drill => &[Feed(Bottom), Rapid(Clear)],
            Kind::DrillDwell => &[Feed(Bottom), Dwell, Rapid(Clear)],
            Kind::ChipBreak | Kind::Peck | Kind::LathePeck => &[Peck, Rapid(Clear)],
            Kind::Tap | Kind::LeftTap => &[
                Feed(Bottom),
                Stopped,
                Reversed,
                Dwell,
                Feed(Retract),
                Stopped,
                Running,
                Rapid(Clear),
            ],
            Kind::Bore => &[Feed(Bottom), Feed(Retract), Rapid(Clear)],
            Kind::BoreStop => &[Feed(Bottom), Dwell, Stopped, Rapid(Clear), Running],
            Kind::BoreDwell => &[Feed(Bottom), Dwell, Feed(Retract), Rapid(Clear)],
            Kind::BoreManual => &[Feed(Bottom), Dwell, Stopped, Manual, Rapid(Clear), Running],
            Kind::BackBore => &[
                Shift(true),
                Stopped,
                Oriented,
                Rapid(Bottom),
                Shift(false),
                Running,
                Feed(Middle),
                Feed(Bottom),
                Stopped,
                Oriented,
                Shift(true),
                Rapid(Clear),
                Shift(false),
                Running,
            ],
            Kind::Thread | Kind::TurnBox | Kind::ThreadBox | Kind::FaceBox => &[],
        }
    }
}

/// A height of a drilling cycle.
#[derive(Copy, Clone)]
enum Level {
    Bottom,
    /// `K` of G87.
    Middle,
    Retract,
    Clear,
}

/// One action of a drilling cycle.
#[derive(Copy, Clone)]
enum Step {
    Feed(Level),
    Rapid(Level),
    /// All pecks down to the bottom.
    Peck,
    Dwell,
    Stopped,
    Running,
    Reversed,
    Oriented,
    /// M0 for the operator.
    Manual,
    /// To the offset of G87 (`true`) or back.
    Shift(bool),
}

/// Clearance of a peck: the distance of the tool from the depth already reached (G83), and the
/// retract that breaks the chip (G73). LinuxCNC uses 0.010 inch.
pub(crate) const PECK_CLEARANCE: Nm = Nm(254_000);

/// Positions around a centre, each from the last one by the same angle and a longer radius: those
/// of incremental polar coordinates.
#[derive(Copy, Clone, Debug)]
pub(crate) struct Swing {
    pub(crate) centre: [Nm; 2],
    /// From the centre to the position before the first one.
    pub(crate) from: [Nm; 2],
    /// Billionths of a degree from one to the next.
    pub(crate) turn: i64,
    pub(crate) stretch: Nm,
}

impl Swing {
    pub(crate) const NONE: Swing = Swing {
        centre: [Nm(0); 2],
        from: [Nm(0); 2],
        turn: 0,
        stretch: Nm(0),
    };

    /// From the points of a cycle, and its pitch: an angle and a radius.
    fn of(points: &[[Nm; 2]; 4], [turn, stretch]: [Nm; 2]) -> Swing {
        let [centre, from, ..] = *points;
        Swing {
            centre,
            from,
            turn: turn.0,
            stretch,
        }
    }

    /// The position of this number, from 1.
    pub(crate) fn place(&self, number: u32) -> [Nm; 2] {
        let mut place = self.at(number);
        for (place, centre) in place.iter_mut().zip(self.centre) {
            place.0 = place.0.saturating_add(centre.0);
        }
        place
    }
}

/// A drilling cycle at one or more positions, all in the machine frame.
#[derive(Copy, Clone, Debug)]
pub(crate) struct Holes<const N: usize> {
    pub(crate) kind: Kind,
    pub(crate) plane: Plane,
    /// Present position of the tool.
    pub(crate) at: [Nm; N],
    /// Position of the next hole in the plane.
    pub(crate) hole: [Nm; 2],
    /// Distance from one hole to the next.
    pub(crate) pitch: [Nm; 2],
    /// Positions around a centre instead: the number of the present one, or 0. `pitch` is then the
    /// angle and the radius from one to the next.
    pub(crate) swing: u32,
    pub(crate) retract: Nm,
    pub(crate) bottom: Nm,
    pub(crate) clear: Nm,
    /// Depth of a peck, or zero.
    pub(crate) peck: Nm,
    /// Clearance or retract of a peck.
    pub(crate) clearance: Nm,
    /// G87: from the hole to the position where the tool passes.
    pub(crate) offset: [Nm; 2],
    pub(crate) middle: Nm,
    pub(crate) dwell_micros: u64,
    pub(crate) feed: Feed,
    pub(crate) spindle: (SpindleDirection, u64),
    /// The path mode to restore, where corners are rounded.
    pub(crate) path: Option<PathMode>,
    /// Number of holes still to make.
    pub(crate) left: u32,
    pub(crate) state: State,
}

impl<const N: usize> Holes<N> {
    /// An empty cycle, to be filled in.
    pub(crate) const NONE: Self = Holes {
        kind: Kind::Drill,
        plane: Plane::Xy,
        at: [Nm(0); N],
        hole: [Nm(0); 2],
        pitch: [Nm(0); 2],
        swing: 0,
        retract: Nm(0),
        bottom: Nm(0),
        clear: Nm(0),
        peck: Nm(0),
        clearance: Nm(0),
        offset: [Nm(0); 2],
        middle: Nm(0),
        dwell_micros: 0,
        feed: Feed::PerMinute(Nm(0)),
        spindle: (SpindleDirection::Off, 0),
        path: None,
        left: 0,
        state: State::Begin,
    };
}

/// State of a drilling cycle.
#[derive(Copy, Clone, Debug)]
pub(crate) enum State {
    Begin,
    /// Up to the retract plane, once.
    Rise,
    Over,
    Down,
    /// This step of the kind comes next.
    Step(u8),
    /// A peck goes to this depth next.
    PeckDown(Nm, u8),
    /// The tool is at this depth and retracts.
    PeckUp(Nm, u8),
    /// The tool is retracted and goes back near this depth.
    PeckBack(Nm, u8),
    End,
    Done,
}

impl<const N: usize> Holes<N> {
    fn level(&self, level: Level) -> Nm {
        match level {
            Level::Bottom => self.bottom,
            Level::Middle => self.middle,
            Level::Retract => self.retract,
            Level::Clear => self.clear,
        }
    }

    /// The height of the tool along the axis perpendicular to the plane.
    fn height(&self) -> Nm {
        self.at
            .get(self.plane.across())
            .copied()
            .unwrap_or_default()
    }

    fn set_height(&mut self, height: Nm) {
        if let Some(entry) = self.at.get_mut(self.plane.across()) {
            *entry = height;
        }
    }

    fn rapid(&mut self, height: Nm) -> Option<Command<N>> {
        self.set_height(height);
        Some(Command::Rapid { to: self.at })
    }

    fn linear(&mut self, height: Nm) -> Option<Command<N>> {
        self.set_height(height);
        Some(Command::Linear {
            to: self.at,
            feed: self.feed,
        })
    }

    fn over(&mut self, offset: [Nm; 2]) -> Option<Command<N>> {
        let places = self
            .plane
            .axes()
            .into_iter()
            .zip(self.hole.iter().zip(offset));
        for (axis, (hole, offset)) in places {
            if let Some(entry) = self.at.get_mut(axis) {
                // Two coordinates within the limit of 2^50.
                entry.0 = hole.0.saturating_add(offset.0);
            }
        }
        Some(Command::Rapid { to: self.at })
    }

    fn spindle(&self, direction: SpindleDirection) -> Option<Command<N>> {
        let off = direction == SpindleDirection::Off;
        Some(Command::Spindle {
            direction,
            milli_rpm: if off { 0 } else { self.spindle.1 },
        })
    }

    /// Makes one step; `None` where it needs no command.
    fn step(&mut self, step: Step, next: u8) -> Option<Command<N>> {
        self.state = State::Step(next);
        match step {
            Step::Feed(level) => self.linear(self.level(level)),
            Step::Rapid(level) => self.rapid_if_elsewhere(self.level(level)),
            Step::Dwell if self.dwell_micros == 0 => None,
            Step::Dwell => Some(Command::Dwell {
                micros: self.dwell_micros,
            }),
            Step::Stopped => self.spindle(SpindleDirection::Off),
            Step::Running => self.spindle(self.spindle.0),
            Step::Reversed => self.spindle(self.spindle.0.reversed()),
            Step::Oriented => Some(Command::Orient {
                micro_degrees: 0,
                way: 0,
            }),
            Step::Manual => Some(Command::Stop { optional: false }),
            Step::Shift(true) => self.over(self.offset),
            Step::Shift(false) => self.over([Nm(0); 2]),
            Step::Peck => {
                // The bottom is below the retract plane and the peck above zero.
                let first = self.retract.0.saturating_sub(self.peck.0);
                self.state = State::PeckDown(Nm(first), next);
                None
            }
        }
    }

    fn next(&mut self, points: &[[Nm; 2]; 4]) -> Option<Command<N>> {
        // Each state either returns a command or continues to another; there are at most a few
        // states without a command.
        loop {
            let made = match self.state {
                State::Begin => {
                    self.state = State::Rise;
                    self.path.map(|_| Command::Path {
                        mode: PathMode::ExactPath,
                    })
                }
                State::Rise => {
                    self.state = State::Over;
                    if self.height() < self.retract && self.kind != Kind::LathePeck {
                        self.rapid(self.retract)
                    } else {
                        None
                    }
                }
                State::Over => {
                    self.state = State::Down;
                    if self.kind == Kind::LathePeck {
                        None
                    } else {
                        self.over([Nm(0); 2])
                    }
                }
                State::Down => {
                    self.state = State::Step(0);
                    self.rapid_if_elsewhere(self.retract)
                }
                State::Step(number) => match self.kind.steps().get(usize::from(number)) {
                    Some(&step) => self.step(step, number.wrapping_add(1)),
                    None => {
                        self.next_hole(points);
                        None
                    }
                },
                State::PeckDown(depth, next) => self.peck_down(depth, next),
                State::PeckUp(depth, next) => self.peck_up(depth, next),
                State::PeckBack(depth, next) => {
                    self.state = State::PeckDown(self.below(depth), next);
                    self.rapid_if_elsewhere(self.above(depth))
                }
                State::End => {
                    self.state = State::Done;
                    self.path.map(|mode| Command::Path { mode })
                }
                State::Done => return None,
            };
            if made.is_some() {
                return made;
            }
        }
    }

    #[inline(always)]
    /// A rapid move along the axis of the tool, unless it is at this height.
    fn rapid_if_elsewhere(&mut self, height: Nm) -> Option<Command<N>> {
        if self.height() == height {
            None
        } else {
            self.rapid(height)
        }
    }

    #[inline(always)]
    /// Completes a hole: the position of the next one, or the end of the cycle.
    fn next_hole(&mut self, points: &[[Nm; 2]; 4]) {
        self.left = self.left.saturating_sub(1);
        if self.swing != 0 {
            self.swing = self.swing.wrapping_add(1); // at most 2^16
            self.hole = Swing::of(points, self.pitch).place(self.swing);
        } else {
            for (hole, pitch) in self.hole.iter_mut().zip(self.pitch) {
                hole.0 = hole.0.saturating_add(pitch.0);
            }
        }
        self.state = if self.left == 0 {
            State::End
        } else {
            State::Over
        };
    }

    #[inline(always)]
    /// Cuts to this depth, or with the last peck to the bottom.
    fn peck_down(&mut self, depth: Nm, next: u8) -> Option<Command<N>> {
        if depth <= self.bottom {
            self.state = State::Step(next);
            self.linear(self.bottom)
        } else {
            self.state = State::PeckUp(depth, next);
            self.linear(depth)
        }
    }

    #[inline(always)]
    /// Retracts from this depth: out of the hole (G83), or by the length that breaks the chip.
    fn peck_up(&mut self, depth: Nm, next: u8) -> Option<Command<N>> {
        if self.kind == Kind::Peck {
            self.state = State::PeckBack(depth, next);
            self.rapid(self.retract)
        } else {
            self.state = State::PeckDown(self.below(depth), next);
            self.rapid(self.above(depth))
        }
    }

    /// The depth of the peck after this one.
    const fn below(&self, depth: Nm) -> Nm {
        Nm(depth.0.saturating_sub(self.peck.0))
    }

    /// The height of the clearance above this depth, not above the retract plane.
    fn above(&self, depth: Nm) -> Nm {
        Nm(depth.0.saturating_add(self.clearance.0)).min(self.retract)
    }
}

/// The four moves of a turning, facing or threading cycle: rapid in, cut, feed out, rapid back.
#[derive(Copy, Clone, Debug)]
pub(crate) struct Rectangle<const N: usize> {
    pub(crate) corners: [[Nm; N]; 4],
    pub(crate) feed: Feed,
    /// The second move is a thread of this lead, and the third a rapid.
    pub(crate) lead: Option<Nm>,
    pub(crate) next: u8,
}

impl<const N: usize> Rectangle<N> {
    fn next(&mut self) -> Option<Command<N>> {
        let to = self.corners.get(usize::from(self.next)).copied()?;
        let number = self.next;
        self.next = number.wrapping_add(1);
        let feed = self.feed;
        Some(match (number, self.lead) {
            (1, Some(lead)) => Command::Thread { to, lead },
            (1, None) | (2, None) => Command::Linear { to, feed },
            _ => Command::Rapid { to },
        })
    }
}

/// A cycle in progress.
#[derive(Clone, Debug)]
pub(crate) enum Cycle<const N: usize> {
    Holes(Holes<N>),
    Rectangle(Rectangle<N>),
    Passes(Passes<N>),
}

impl<const N: usize> Cycle<N> {
    /// The next command; `points` are a centre and the vector from there to the start.
    pub(crate) fn next(&mut self, points: &[[Nm; 2]; 4]) -> Option<Command<N>> {
        match self {
            Cycle::Holes(holes) => holes.next(points),
            Cycle::Rectangle(rectangle) => rectangle.next(),
            Cycle::Passes(passes) => passes.next(),
        }
    }
}

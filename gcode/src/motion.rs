//! What moves: who gets the axis words, G0 to G3 and G53.

use crate::arc::{self, Arc, Direction, Plane};
use crate::block::{AXES, Block, Letters, axis_letter};
use crate::code::{Code, EXTENDED, Group};
use crate::command::{Command, Feed, SpindleDirection};
use crate::commands::Commands;
use crate::decimal::Decimal;
use crate::dialect::Flavour;
use crate::error::ErrorKind;
use crate::fault::Fault;
use crate::modal::{Distance, FeedMode, Modal, Motion, shifted};
use crate::nm::Nm;

/// The frame and sense of target words.
#[derive(Copy, Clone)]
pub(crate) enum Frame {
    Work,
    WorkIncremental,
    Machine,
}

impl<const N: usize> Modal<N> {
    /// The last stage before stops: words without a user are refused here, then one of G10, G28, G30, G92 or the motion
    /// happens.
    #[inline(never)]
    pub(crate) fn moves(&mut self, block: &Block, commands: &mut Commands<N>) -> Result<(), Fault> {
        if self.dialect.flavour == Flavour::Drill {
            return self.drill(block, commands);
        }
        let non_modal = block.code(Group::NonModal);
        let direct_length = block.code(Group::ToolLength) == Some(Code::DirectToolLength);
        let covets = direct_length || non_modal.is_some_and(Code::covets_axes);
        let code = block.code(Group::Motion);
        if covets && code.is_some_and(|code| code != Code::CancelMotion) {
            let group = if direct_length {
                Group::ToolLength
            } else {
                Group::NonModal
            };
            return Err(Fault::at_code(ErrorKind::TwoUsersOfWords, group));
        }
        let mode = match code {
            Some(code) => mode(code),
            None => self.modes.motion,
        };
        if EXTENDED && matches!(code, Some(Code::ContourCycle(_))) {
            return Err(Fault::at_code(ErrorKind::ContourOfBlocks, Group::Motion));
        }
        #[cfg(feature = "extended")]
        self.leave_series(mode);
        let mine = !covets && (block.axes() != 0 || code.is_some());
        self.check_words(block, mode, mine)?;
        self.stay_in(mode);
        self.check_compensation(block, if mine { mode } else { None })?;
        match non_modal {
            Some(Code::CancelShift) => {
                (self.modes.shift, self.modes.kept_shift) = ([Nm(0); N], [Nm(0); N])
            }
            Some(Code::SuspendShift) if EXTENDED => self.modes.shift = [Nm(0); N],
            Some(Code::RestoreShift) if EXTENDED => self.modes.shift = self.modes.kept_shift,
            Some(Code::SetData) => return self.set_data(block),
            Some(Code::Shift) => return self.set_shift(block),
            Some(Code::Home(which)) => return self.go_home(block, which, commands),
            _ => {}
        }
        if covets {
            return Ok(());
        }
        self.travel(block, mode, mine, commands)
    }

    /// As [`Modal::moves`], of a block with nothing but a move, which is most of them.
    #[inline]
    pub(crate) fn moves_only(
        &mut self,
        block: &Block,
        commands: &mut Commands<N>,
    ) -> Result<(), Fault> {
        let code = block.code(Group::Motion);
        let mode = code.map_or(self.modes.motion, mode);
        let mine = block.axes() != 0 || code.is_some();
        self.check_words(block, mode, mine)?;
        self.travel(block, mode, mine, commands)?;
        self.stay_in(mode);
        Ok(())
    }

    /// The mode is that of the next block too.
    #[inline]
    fn stay_in(&mut self, mode: Option<Motion>) {
        // Motion is not modal on the micro mill's link.
        self.modes.motion = if self.dialect.flavour == Flavour::Micromill {
            None
        } else {
            mode
        };
        if EXTENDED && mode != Some(Motion::Cubic) {
            self.modes.tail = None;
        }
    }

    /// Refuses words without a user; `mine` is whether the motion has the axis words, or its code.
    #[inline]
    fn check_words(&self, block: &Block, mode: Option<Motion>, mine: bool) -> Result<(), Fault> {
        if !block.has_claims() {
            return Ok(());
        }
        let modal = block.code(Group::Motion).is_none();
        let users = match mode {
            Some(mode) if mine && modal => letters(mode, self.modes.plane),
            Some(Motion::Clockwise | Motion::CounterClockwise) if mine => {
                arc_letters(self.modes.plane)
            }
            _ => Letters::NONE,
        };
        block.check_users(users)
    }

    /// The motion itself.
    #[inline]
    fn travel(
        &mut self,
        block: &Block,
        mode: Option<Motion>,
        mine: bool,
        commands: &mut Commands<N>,
    ) -> Result<(), Fault> {
        let direction = match mode {
            Some(Motion::Clockwise) => Direction::Clockwise,
            Some(Motion::CounterClockwise) => Direction::CounterClockwise,
            None | Some(Motion::Rapid | Motion::Linear) => {
                return self.straight(block, mode, commands);
            }
            Some(mode) => {
                self.no_machine_frame(block)?;
                return if mine {
                    self.special(block, mode, commands)
                } else {
                    Ok(())
                };
            }
        };
        self.no_machine_frame(block)?;
        if !mine {
            return Ok(());
        }
        self.arc(block, direction, commands)
    }

    /// What cannot be done while the contour is compensated.
    fn check_compensation(&self, block: &Block, mode: Option<Motion>) -> Result<(), Fault> {
        if !EXTENDED || self.modes.compensation.is_none() {
            return Ok(());
        }
        if let Some(code) = block.code(Group::NonModal) {
            if code != Code::Dwell {
                return Err(Fault::at_code(
                    ErrorKind::UnderCompensation,
                    Group::NonModal,
                ));
            }
        }
        match mode {
            None
            | Some(Motion::Rapid | Motion::Linear | Motion::Clockwise | Motion::CounterClockwise) => {
                Ok(())
            }
            Some(_) => Err(Fault::at_motion(ErrorKind::UnderCompensation)),
        }
    }

    /// The modes that are not lines or arcs.
    #[inline(never)]
    fn special(
        &mut self,
        block: &Block,
        mode: Motion,
        commands: &mut Commands<N>,
    ) -> Result<(), Fault> {
        if let Motion::Probe { away, must } = mode {
            return self.probe(block, away, must, commands);
        }
        #[cfg(feature = "extended")]
        match mode {
            Motion::Cubic => return self.cubic(block, commands),
            Motion::Quadratic => return self.quadratic(block, commands),
            Motion::Thread => return self.thread(block, commands),
            Motion::Cycle(kind) => return self.canned(block, kind, commands),
            _ => {}
        }
        Ok(())
    }

    fn no_machine_frame(&self, block: &Block) -> Result<(), Fault> {
        match block.code(Group::NonModal) {
            Some(Code::MachineFrame) => {
                Err(Fault::at_code(ErrorKind::MachineFrame, Group::NonModal))
            }
            _ => Ok(()),
        }
    }

    pub(crate) fn frame(&self) -> Frame {
        match self.modes.distance {
            Distance::Absolute => Frame::Work,
            Distance::Incremental => Frame::WorkIncremental,
        }
    }

    /// The position with the axis words of the block applied.
    pub(crate) fn target(&self, block: &Block, frame: Frame) -> Result<[Nm; N], Fault> {
        let given = block.axes();
        let mut target = self.modes.position;
        // Beyond the axes with letters there is nothing, and no bit of `given`.
        for (axis, target) in (0..AXES).zip(target.iter_mut()) {
            if given & 1u16.wrapping_shl(axis as u32) == 0 {
                continue;
            }
            let letter = block.letter_of(axis);
            let (value, zero) = match (block.axis(axis), block.increment(axis)) {
                (Some(value), None) => match frame {
                    Frame::Work => (value, self.zero_of(axis)),
                    Frame::WorkIncremental => (value, *target),
                    Frame::Machine => (value, Nm(0)),
                },
                (None, Some(value)) => (value, *target),
                _ => return Err(Fault::at(ErrorKind::TwoUsersOfWords, letter)),
            };
            *target = shifted(zero, self.length(letter, *value)?, letter)?;
        }
        Ok(target)
    }

    /// G0 and G1, by code or modal; without axis words they only set the mode.
    fn straight(
        &mut self,
        block: &Block,
        mode: Option<Motion>,
        commands: &mut Commands<N>,
    ) -> Result<(), Fault> {
        let machine_frame = block.code(Group::NonModal) == Some(Code::MachineFrame);
        if machine_frame && (mode.is_none() || self.modes.distance == Distance::Incremental) {
            return self.no_machine_frame(block);
        }
        if block.axes() == 0 {
            return Ok(());
        }
        let Some(mode) = mode else {
            return Err(Fault::at_axes(ErrorKind::AxisWordsWithoutMotion));
        };
        self.check_z_alone(block)?;
        let to = self.target(
            block,
            if machine_frame {
                Frame::Machine
            } else {
                self.frame()
            },
        )?;
        let feed = match mode {
            Motion::Rapid => None,
            _ => Some(self.feed_of()?),
        };
        self.modes.position = to;
        commands.straight(to, feed);
        Ok(())
    }

    /// The feed in effect for a feed move of this block.
    pub(crate) fn feed_of(&self) -> Result<Feed, Fault> {
        let rate = i64::try_from(self.modes.feed).ok().filter(|&rate| rate > 0);
        let missing = match self.modes.feed_mode {
            FeedMode::PerMinute | FeedMode::PerRevolution => ErrorKind::NoFeed,
            FeedMode::InverseTime => ErrorKind::NoInverseTime,
        };
        let rate = rate.ok_or_else(|| Fault::at_motion(missing))?;
        Ok(match self.modes.feed_mode {
            FeedMode::PerMinute => Feed::PerMinute(Nm(rate)),
            FeedMode::PerRevolution => {
                self.check_turning()?;
                Feed::PerRevolution(Nm(rate))
            }
            FeedMode::InverseTime => Feed::InverseTime {
                micro_per_minute: self.modes.feed,
            },
        })
    }

    /// Refuses a move that needs a turning spindle when it stands.
    pub(crate) fn check_turning(&self) -> Result<(), Fault> {
        if self.modes.spindle == SpindleDirection::Off {
            return Err(Fault::at_motion(ErrorKind::SpindleStopped));
        }
        Ok(())
    }

    /// On the micro mill Z moves alone.
    pub(crate) fn check_z_alone(&self, block: &Block) -> Result<(), Fault> {
        const Z: u16 = 0b100;
        let axes = block.axes();
        if self.dialect.flavour == Flavour::Micromill && axes & Z != 0 && axes != Z {
            return Err(Fault::at(ErrorKind::ZNotAlone, b'Z'));
        }
        Ok(())
    }

    /// G2 and G3.
    #[inline(never)]
    fn arc(
        &mut self,
        block: &Block,
        direction: Direction,
        commands: &mut Commands<N>,
    ) -> Result<(), Fault> {
        let axes = self.modes.plane.axes();
        let letters = self.modes.plane.centre_letters();
        let given = block.axes();
        let plane_words = axes
            .iter()
            .any(|&axis| given & 1u16.wrapping_shl(axis as u32) != 0);
        let centre_words = letters.map(|letter| block.word(letter).is_some());
        let any_centre = centre_words.contains(&true);
        let radius_word = block.word(b'R');
        if block.axes() == 0 && !any_centre && radius_word.is_none() {
            return Err(Fault::at_code(ErrorKind::NoAxisWords, Group::Motion));
        }
        // Two axes make a plane; a machine without them has no such arc.
        if axes.iter().any(|&axis| axis >= N) {
            return Err(Fault::at_motion(ErrorKind::NoCentre));
        }
        if self.dialect.flavour == Flavour::Micromill && block.axis(2).is_some() {
            return Err(Fault::at(ErrorKind::ZNotAlone, b'Z'));
        }
        let to = self.target(block, self.frame())?;
        let plane_of =
            |point: &[Nm; N]| axes.map(|axis| point.get(axis).copied().unwrap_or_default());
        let (from, end) = (plane_of(&self.modes.position), plane_of(&to));
        let (centre, radius, mismatch) = match radius_word {
            Some(_) if any_centre => {
                return Err(Fault::at(ErrorKind::RadiusAndCentre, b'R'));
            }
            Some(_) if !plane_words => return Err(Fault::at_motion(ErrorKind::NoEnd)),
            Some(value) => {
                let radius = self.length(b'R', value)?;
                let by_radius = arc::with_radius(from, end, radius, direction);
                let by_radius = by_radius.map_err(|kind| match kind {
                    ErrorKind::RadiusToSamePoint => Fault::at_motion(kind),
                    _ => Fault::at(kind, b'R'),
                })?;
                let radius = if by_radius.short {
                    None
                } else {
                    Some(Nm(radius.0.saturating_abs()))
                };
                (by_radius.centre, radius, by_radius.mismatch)
            }
            None => {
                let centre = self.centre(block, letters, centre_words, from)?;
                let mismatch = arc::with_centre(from, end, centre).map_err(|kind| match kind {
                    ErrorKind::EndOffArc(_) if plane_words => Fault::at_axes(kind),
                    _ => Fault::at_motion(kind),
                })?;
                (centre, None, mismatch)
            }
        };
        let turns = match block.word(b'P') {
            None => 0,
            Some(value) => {
                let turns = value
                    .whole()
                    .and_then(|whole| u32::try_from(whole).ok())
                    .and_then(|turns| turns.checked_sub(1));
                turns.ok_or_else(|| Fault::at(ErrorKind::NotWhole(b'P'), b'P'))?
            }
        };
        let feed = self.feed_of()?;
        let mut around = self.modes.position;
        for (axis, centre) in axes.into_iter().zip(centre) {
            if let Some(entry) = around.get_mut(axis) {
                *entry = centre;
            }
        }
        let resolution = self.resolution(block, axes, letters);
        let arc = Arc {
            to,
            centre: around,
            plane: self.modes.plane,
            direction,
            turns,
            radius,
            mismatch,
            resolution,
        };
        self.modes.position = to;
        commands.motion(Command::Arc { arc, feed });
        Ok(())
    }

    /// The centre by its words: offsets from the start, or (both needed) coordinates in the work frame.
    #[inline(never)]
    fn centre(
        &self,
        block: &Block,
        letters: [u8; 2],
        given: [bool; 2],
        from: [Nm; 2],
    ) -> Result<[Nm; 2], Fault> {
        let absolute = self.modes.centres == Distance::Absolute;
        if !given.contains(&true) {
            return Err(Fault::at_motion(ErrorKind::NoCentre));
        }
        if absolute && given.contains(&false) {
            return Err(Fault::at_motion(ErrorKind::HalfCentre));
        }
        let mut centre = from;
        if absolute {
            centre = self.modes.plane.axes().map(|axis| self.zero_of(axis));
        }
        for (centre, letter) in centre.iter_mut().zip(letters) {
            if let Some(length) = self.length_of(block, letter)? {
                *centre = shifted(*centre, length, letter)?;
            }
        }
        Ok(centre)
    }

    /// One unit of the finest last digit of the words that shape the arc.
    fn resolution(&self, block: &Block, axes: [usize; 2], letters: [u8; 2]) -> Nm {
        let [first, second] = axes.map(axis_letter);
        let [one, other] = letters;
        let mut finest: Option<Decimal> = None;
        for letter in [first, second, one, other, b'R'] {
            if let Some(value) = block.word(letter) {
                if finest.is_none_or(|finest| value.places() > finest.places()) {
                    finest = Some(value);
                }
            }
        }
        finest
            .and_then(|value| self.modes.units.length(value.last_place()))
            .unwrap_or_default()
    }
}

/// The mode of a motion code; `None` for G80.
const fn mode(code: Code) -> Option<Motion> {
    match code {
        Code::Rapid => Some(Motion::Rapid),
        Code::Linear => Some(Motion::Linear),
        Code::Clockwise => Some(Motion::Clockwise),
        Code::CounterClockwise => Some(Motion::CounterClockwise),
        Code::Cubic => Some(Motion::Cubic),
        Code::Quadratic => Some(Motion::Quadratic),
        Code::Thread => Some(Motion::Thread),
        Code::Probe { away, must } => Some(Motion::Probe { away, must }),
        Code::Cycle(kind) => Some(Motion::Cycle(kind)),
        _ => None,
    }
}

/// Letters beside the axes that a mode uses when its code is not in the block.
const fn letters(mode: Motion, plane: Plane) -> Letters {
    match mode {
        Motion::Rapid | Motion::Linear | Motion::Probe { .. } => Letters::NONE,
        Motion::Clockwise | Motion::CounterClockwise => arc_letters(plane),
        Motion::Cubic => Code::Cubic.letters(),
        Motion::Quadratic => Code::Quadratic.letters(),
        Motion::Thread => Code::Thread.letters(),
        Motion::Cycle(kind) => kind.letters(),
    }
}

const fn arc_letters(plane: Plane) -> Letters {
    match plane {
        Plane::Xy => const { Letters::new(b"IJRP") },
        Plane::Zx => const { Letters::new(b"IKRP") },
        Plane::Yz => const { Letters::new(b"JKRP") },
    }
}

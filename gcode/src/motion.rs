//! What moves: G0 to G3, G28, G53, G92, and who may use which word.

use crate::arc::{self, Arc, Direction, Plane};
use crate::block::{AXES, Block, axis_letter};
use crate::code::{Code, Group};
use crate::command::{Command, Commands, Feed};
use crate::dialect::Flavour;
use crate::error::{Error, ErrorKind};
use crate::modal::{Distance, FeedMode, Modal, Motion};
use crate::nm::Nm;

/// The frame and sense of target words.
#[derive(Copy, Clone)]
enum Frame {
    Work,
    WorkIncremental,
    Machine,
}

impl<const N: usize> Modal<N> {
    /// The last stage before stops: words without a user are refused here, then one of G28, G92 or the motion happens.
    pub(crate) fn moves(&mut self, block: &Block, commands: &mut Commands<N>) -> Result<(), Error> {
        let non_modal = block.code(Group::NonModal);
        let covets = matches!(non_modal, Some(Code::Home | Code::Shift));
        let code = block.code(Group::Motion);
        if covets && code.is_some_and(|code| code != Code::CancelMotion) {
            return Err(block.error_at_code(ErrorKind::TwoUsersOfWords, Group::NonModal));
        }
        let mode = match code {
            Some(Code::Rapid) => Some(Motion::Rapid),
            Some(Code::Linear) => Some(Motion::Linear),
            Some(Code::Clockwise) => Some(Motion::Clockwise),
            Some(Code::CounterClockwise) => Some(Motion::CounterClockwise),
            Some(_) => None,
            None => self.motion,
        };
        // Motion is not modal on the micro mill's link.
        self.motion = if self.dialect.flavour == Flavour::Rs274 {
            mode
        } else {
            None
        };
        let mine = !covets && (block.axes() != 0 || code.is_some());
        let arc = mine && matches!(mode, Some(Motion::Clockwise | Motion::CounterClockwise));
        check_words(block, arc.then_some(self.plane))?;
        match non_modal {
            Some(Code::StoreHome) => self.home = self.position,
            Some(Code::CancelShift) => self.shift = [Nm(0); N],
            Some(Code::Shift) => return self.set_shift(block),
            Some(Code::Home) => return self.go_home(block, commands),
            _ => {}
        }
        let direction = match mode {
            Some(Motion::Clockwise) => Direction::Clockwise,
            Some(Motion::CounterClockwise) => Direction::CounterClockwise,
            _ => return self.straight(block, mode, commands),
        };
        if !mine {
            return self.no_machine_frame(block);
        }
        self.no_machine_frame(block)?;
        self.arc(block, direction, commands)
    }

    fn no_machine_frame(&self, block: &Block) -> Result<(), Error> {
        match block.code(Group::NonModal) {
            Some(Code::MachineFrame) => {
                Err(block.error_at_code(ErrorKind::MachineFrame, Group::NonModal))
            }
            _ => Ok(()),
        }
    }

    fn frame(&self) -> Frame {
        match self.distance {
            Distance::Absolute => Frame::Work,
            Distance::Incremental => Frame::WorkIncremental,
        }
    }

    /// The position with the axis words of the block applied.
    fn target(&self, block: &Block, frame: Frame) -> Result<[Nm; N], Error> {
        let zero = match frame {
            Frame::Work => self.work_offset(),
            Frame::WorkIncremental => self.position,
            Frame::Machine => [Nm(0); N],
        };
        let mut target = self.position;
        for (axis, (target, zero)) in (0..N).zip(target.iter_mut().zip(zero)) {
            if let Some(value) = block.axis(axis) {
                let letter = axis_letter(axis);
                let length = self.length(block, letter, value)?;
                let sum = zero
                    .0
                    .checked_add(length.0)
                    .and_then(|sum| Nm(sum).within_limit());
                *target = sum.ok_or_else(|| block.error_at(ErrorKind::NumberTooLarge, letter))?;
            }
        }
        Ok(target)
    }

    /// G0 and G1, by code or modal; without axis words they only set the mode.
    fn straight(
        &mut self,
        block: &Block,
        mode: Option<Motion>,
        commands: &mut Commands<N>,
    ) -> Result<(), Error> {
        let machine_frame = block.code(Group::NonModal) == Some(Code::MachineFrame);
        if machine_frame && (mode.is_none() || self.distance == Distance::Incremental) {
            return self.no_machine_frame(block);
        }
        if block.axes() == 0 {
            return Ok(());
        }
        let Some(mode) = mode else {
            return Err(block.error_at_axes(ErrorKind::AxisWordsWithoutMotion));
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
        let motion = match mode {
            Motion::Rapid => Command::Rapid { to },
            _ => Command::Linear {
                to,
                feed: self.feed_of(block)?,
            },
        };
        self.position = to;
        commands.motion(motion);
        Ok(())
    }

    /// The feed in effect for a feed move of this block.
    fn feed_of(&self, block: &Block) -> Result<Feed, Error> {
        let rate = i64::try_from(self.feed).ok().filter(|&rate| rate > 0);
        let missing = match self.feed_mode {
            FeedMode::PerMinute => ErrorKind::NoFeed,
            FeedMode::InverseTime => ErrorKind::NoInverseTime,
        };
        let rate = rate.ok_or_else(|| block.error_at_motion(missing))?;
        Ok(match self.feed_mode {
            FeedMode::PerMinute => Feed::PerMinute(Nm(rate)),
            FeedMode::InverseTime => Feed::InverseTime {
                micro_per_minute: self.feed,
            },
        })
    }

    /// On the micro mill Z moves alone.
    fn check_z_alone(&self, block: &Block) -> Result<(), Error> {
        const Z: u16 = 0b100;
        let axes = block.axes();
        if self.dialect.flavour == Flavour::Micromill && axes & Z != 0 && axes != Z {
            return Err(block.error_at(ErrorKind::ZNotAlone, b'Z'));
        }
        Ok(())
    }

    /// G92: the present position gets the coordinates of the axis words.
    fn set_shift(&mut self, block: &Block) -> Result<(), Error> {
        if block.axes() == 0 {
            return Err(block.error_at_code(ErrorKind::NoAxisWords, Group::NonModal));
        }
        let mut shift = self.shift;
        let frames = self.position.into_iter().zip(self.system_offset());
        for (axis, (shift, (at, zero))) in (0..N).zip(shift.iter_mut().zip(frames)) {
            if let Some(value) = block.axis(axis) {
                let letter = axis_letter(axis);
                let length = self.length(block, letter, value)?;
                let difference =
                    at.0.checked_sub(zero.0)
                        .and_then(|work| work.checked_sub(length.0));
                *shift =
                    Nm(difference
                        .ok_or_else(|| block.error_at(ErrorKind::NumberTooLarge, letter))?);
            }
        }
        self.shift = shift;
        Ok(())
    }

    /// G28: through the given point to the stored position, only the axes named; all axes straight where none is.
    fn go_home(&mut self, block: &Block, commands: &mut Commands<N>) -> Result<(), Error> {
        let mut to = self.position;
        for (axis, (to, home)) in (0..N).zip(to.iter_mut().zip(self.home)) {
            if block.axes() == 0 || block.axis(axis).is_some() {
                *to = home;
            }
        }
        if self.dialect.flavour == Flavour::Micromill {
            if block.axes() == 0 {
                return Err(block.error_at_code(ErrorKind::NoAxisWords, Group::NonModal));
            }
            self.check_z_alone(block)?;
            for axis in 0..AXES {
                if block.axis(axis).is_some_and(|value| !value.is_zero()) {
                    let letter = axis_letter(axis);
                    return Err(block.error_at(ErrorKind::NotZero(letter), letter));
                }
            }
        } else if block.axes() != 0 {
            commands.via(self.target(block, self.frame())?);
        }
        self.position = to;
        commands.motion(Command::Rapid { to });
        Ok(())
    }

    /// G2 and G3.
    fn arc(
        &mut self,
        block: &Block,
        direction: Direction,
        commands: &mut Commands<N>,
    ) -> Result<(), Error> {
        let axes = self.plane.axes();
        let letters = self.plane.centre_letters();
        let plane_words = axes.iter().any(|&axis| block.axis(axis).is_some());
        let centre_words = letters.map(|letter| block.word(letter).is_some());
        let any_centre = centre_words.contains(&true);
        let radius_word = block.word(b'R');
        if block.axes() == 0 && !any_centre && radius_word.is_none() {
            return Err(block.error_at_code(ErrorKind::NoAxisWords, Group::Motion));
        }
        // Two axes make a plane; a machine without them has no such arc.
        if axes.iter().any(|&axis| axis >= N) {
            return Err(block.error_at_motion(ErrorKind::NoCentre));
        }
        if self.dialect.flavour == Flavour::Micromill && block.axis(2).is_some() {
            return Err(block.error_at(ErrorKind::ZNotAlone, b'Z'));
        }
        let to = self.target(block, self.frame())?;
        let plane_of =
            |point: &[Nm; N]| axes.map(|axis| point.get(axis).copied().unwrap_or_default());
        let (from, end) = (plane_of(&self.position), plane_of(&to));
        let (centre, radius, mismatch) = match radius_word {
            Some(_) if any_centre => {
                return Err(block.error_at(ErrorKind::RadiusAndCentre, b'R'));
            }
            Some(_) if !plane_words => return Err(block.error_at_motion(ErrorKind::NoEnd)),
            Some(value) => {
                let radius = self.length(block, b'R', value)?;
                let by_radius = arc::with_radius(from, end, radius, direction);
                let by_radius = by_radius.map_err(|kind| match kind {
                    ErrorKind::RadiusToSamePoint => block.error_at_motion(kind),
                    _ => block.error_at(kind, b'R'),
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
                    ErrorKind::EndOffArc(_) if plane_words => block.error_at_axes(kind),
                    _ => block.error_at_motion(kind),
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
                turns.ok_or_else(|| block.error_at(ErrorKind::NotWhole(b'P'), b'P'))?
            }
        };
        let feed = self.feed_of(block)?;
        let mut around = self.position;
        for (axis, centre) in axes.into_iter().zip(centre) {
            if let Some(entry) = around.get_mut(axis) {
                *entry = centre;
            }
        }
        let resolution = self.resolution(block, axes, letters);
        let arc = Arc {
            to,
            centre: around,
            plane: self.plane,
            direction,
            turns,
            radius,
            mismatch,
            resolution,
        };
        self.position = to;
        commands.motion(Command::Arc { arc, feed });
        Ok(())
    }

    /// The centre by its words: offsets from the start, or (both needed) coordinates in the work frame.
    fn centre(
        &self,
        block: &Block,
        letters: [u8; 2],
        given: [bool; 2],
        from: [Nm; 2],
    ) -> Result<[Nm; 2], Error> {
        let absolute = self.centres == Distance::Absolute;
        if !given.contains(&true) {
            return Err(block.error_at_motion(ErrorKind::NoCentre));
        }
        if absolute && given.contains(&false) {
            return Err(block.error_at_motion(ErrorKind::HalfCentre));
        }
        let offset = self.work_offset();
        let zero = if absolute {
            self.plane
                .axes()
                .map(|axis| offset.get(axis).copied().unwrap_or_default())
        } else {
            from
        };
        let mut centre = zero;
        for (centre, letter) in centre.iter_mut().zip(letters) {
            if let Some(value) = block.word(letter) {
                let length = self.length(block, letter, value)?;
                let sum = centre
                    .0
                    .checked_add(length.0)
                    .and_then(|sum| Nm(sum).within_limit());
                *centre = sum.ok_or_else(|| block.error_at(ErrorKind::NumberTooLarge, letter))?;
            }
        }
        Ok(centre)
    }

    /// One unit of the finest last digit of the words that shape the arc.
    fn resolution(&self, block: &Block, axes: [usize; 2], letters: [u8; 2]) -> Nm {
        let ends = axes.into_iter().filter_map(|axis| block.axis(axis));
        let centres = letters
            .into_iter()
            .chain([b'R'])
            .filter_map(|letter| block.word(letter));
        let finest = ends.chain(centres).max_by_key(|value| value.places());
        finest
            .and_then(|value| self.units.length(value.last_place()))
            .unwrap_or_default()
    }
}

/// Refuses the words that nothing in the block uses, and a `P` with two users; `plane` is that of an arc.
fn check_words(block: &Block, plane: Option<Plane>) -> Result<(), Error> {
    let unused: &[u8] = match plane {
        None => b"IJKR",
        Some(Plane::Xy) => b"K",
        Some(Plane::Zx) => b"J",
        Some(Plane::Yz) => b"I",
    };
    if let Some(&letter) = unused.iter().find(|&&letter| block.word(letter).is_some()) {
        return Err(block.error_at(ErrorKind::UnusedWord(letter), letter));
    }
    if block.word(b'P').is_some() {
        let dwell = block.code(Group::NonModal) == Some(Code::Dwell);
        let blend = block.code(Group::Path) == Some(Code::Blend);
        match u8::from(plane.is_some())
            .wrapping_add(u8::from(dwell))
            .wrapping_add(u8::from(blend))
        {
            0 => return Err(block.error_at(ErrorKind::UnusedWord(b'P'), b'P')),
            1 => {}
            _ => return Err(block.error_at(ErrorKind::TwoUsersOfWords, b'P')),
        }
    }
    Ok(())
}

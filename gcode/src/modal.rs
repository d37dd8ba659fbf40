//! The modal state, and the order in which a block changes it.

#[cfg(feature = "extended")]
mod canned;
pub(crate) mod commands;
mod drill;
mod frames;
pub(crate) mod modes;
mod motion;
#[cfg(feature = "extended")]
mod printer;
#[cfg(all(feature = "program", feature = "extended"))]
pub(crate) mod saved;
mod settings;
#[cfg(feature = "extended")]
mod special;
mod state;
pub(crate) mod tools;
#[cfg(feature = "extended")]
mod turned;

use crate::blocks::block::Block;
use crate::blocks::fault::{Fault, Reason};
use crate::codes::code::{Code, Group};
use crate::codes::dialect::{Dialect, Flavour};
use crate::codes::letters::first_of;
#[cfg(feature = "extended")]
use crate::codes::letters::polar_sign;
use crate::error::{Error, ErrorKind};
use crate::features::{EXTENDED, ROOMY};
use crate::modal::commands::{Changed, Commands, Entry};
#[cfg(feature = "extended")]
use crate::modal::modes::Sticky;
use crate::modal::modes::{FeedMode, Modes, Units, initial};
#[cfg(feature = "extended")]
use crate::modal::tools::Tool;
use crate::modal::tools::Tools;
use crate::values::nm::{Measure, Nm};

/// The number of work frames: G54 to G59, with the extended codes up to G59.3.
const SYSTEMS: usize = if EXTENDED { 9 } else { 6 };

/// The state that one block leaves to the next: modes, frames, eight tools and the programmed
/// position. Cheap to clone.
///
/// The initial state is machine zero with all offsets zero, and G54, G17, G21, G90, G91.1, G94,
/// G64, G40, G49, G98, G97 and G8. There is no motion mode, so axis words before the first motion
/// code are an error. There is no feed, and spindle and coolant are off. Micro mill: micrometres
/// and absolute centres. Grbl: G0. Lathes: G18 and G7.
///
/// A, B and C are in degrees in any unit: a millionth of a degree is one [`Nm`].
///
/// The fields that are used most come first, because short instructions reach 32 bytes from the
/// address.
#[derive(Clone, Debug, Eq, PartialEq)]
#[repr(C)]
pub struct Modal<const N: usize> {
    pub(crate) modes: Modes<N>,
    // The fields below change only as the last action of a block, so they need no backup.
    /// Positions of G28 and G30.
    pub(crate) homes: [[Nm; N]; 2],
    pub(crate) offsets: [[Nm; N]; SYSTEMS],
    /// Rotation of each work frame about its zero, in ten-millionths of a degree.
    #[cfg(feature = "extended")]
    pub(crate) angles: [u32; SYSTEMS],
    pub(crate) tools: Tools<N>,
}

/// The sum of a coordinate and the length of a word.
#[cfg(feature = "extended")]
pub(crate) fn shifted(from: Nm, by: Nm, letter: u8) -> Result<Nm, Fault> {
    from.0
        .checked_add(by.0)
        .and_then(|sum| Nm(sum).within_limit())
        .ok_or(Fault::at(Reason::NumberTooLarge, letter))
}

impl<const N: usize> Modal<N> {
    /// The state at the start of a program.
    pub fn new(dialect: Dialect) -> Self {
        let mut modal = Self::ZERO;
        modal.modes.dialect = dialect;
        modal.modes.active = initial(dialect);
        modal
    }

    /// All bytes are zero (unless the extended codes add others), so nothing has to be copied from
    /// a constant.
    const ZERO: Self = Modal {
        modes: Modes::NONE,
        homes: [[Nm(0); N]; 2],
        offsets: [[Nm(0); N]; SYSTEMS],
        #[cfg(feature = "extended")]
        angles: [0; SYSTEMS],
        tools: Tools::new(),
    };

    /// Returns the meaning of a block: the state after it, and its commands in the order of
    /// execution of RS-274. All or nothing: `self` is never changed, and with an error there is no
    /// new state and no command.
    ///
    /// Order: feed mode, F, spindle mode, S, T, M62 to M68, M6, spindle, coolant, M48 to M53, G4,
    /// plane, units, cutter compensation, tool length, work frame, path mode, distance modes, G98,
    /// then one of G10, G28, G30, G92 and the motion, stop. So an `F` next to `G20` is still in the
    /// previous unit.
    ///
    /// # Errors
    /// Errors that depend on the state: axis words without motion (E0206) or missing (E0207),
    /// unused words (E0208), axes that this machine does not have (E0201), arcs, cycles and splines
    /// (E03xx), feed and ranges (E05xx), missing words (E0213), codes forbidden under compensation
    /// (E0217), coordinates beyond [`Nm::LIMIT`] (E0103).
    pub fn plan(&self, block: &Block) -> Result<(Modal<N>, Commands<N>), Error> {
        let mut next = self.clone();
        let mut commands = Commands::new();
        next.apply(block, &mut commands)?;
        Ok((next, commands))
    }

    /// Does [`Modal::plan`] in place. Nothing is moved. Only the modes (or, for G0 to G3 with axis
    /// words, `F` and `N`, the values that these change) are backed up, in `commands`, so that
    /// [`Modal::revert`] can take the block back. Take all commands before the next block, or drop
    /// them with [`Commands::clear`]. After an error of the block there are no commands, and the
    /// state is unchanged.
    ///
    /// # Errors
    /// Those of [`Modal::plan`], and E0509 if commands have not been taken: they stay, and the
    /// block has no effect.
    #[cfg_attr(not(target_has_atomic = "32"), inline(never))]
    pub fn apply(&mut self, block: &Block, commands: &mut Commands<N>) -> Result<(), Error> {
        if !commands.is_empty() {
            return Err(Error {
                kind: ErrorKind::CommandsWaiting,
                at: 0,
                end: 0,
            });
        }
        let done = match self.plain_move(block) {
            Some(mode) => self.apply_move(block, mode, commands),
            None => self.apply_any(block, commands),
        };
        done.map_err(|fault| {
            commands.clear();
            let axes = self.modes.dialect.axes();
            let error = block.error_on(axes, fault, Measure::of(commands.arc.mismatch));
            #[cfg(feature = "extended")]
            let error = self.with_polar_sign(error);
            error
        })
    }

    /// The error with a polar coordinate as it is written.
    #[cfg(feature = "extended")]
    #[cold]
    fn with_polar_sign(&self, mut error: Error) -> Error {
        if let (ErrorKind::UnusedWord(letter), true) =
            (&mut error.kind, self.modes.dialect.has_polar())
        {
            *letter = polar_sign(*letter);
        }
        error
    }

    /// The stages of [`Modal::execute`] for a block that is only a move.
    #[inline(always)]
    fn apply_move(
        &mut self,
        block: &Block,
        mode: Code,
        commands: &mut Commands<N>,
    ) -> Result<(), Fault> {
        // Position and mode change last.
        commands.before.feed = self.modes.feed;
        let done = self
            .check_axes(block)
            .and_then(|()| self.set_feed(block))
            .and_then(|()| match ROOMY || EXTENDED {
                true => self.moves_on(block, mode, commands),
                false => {
                    let motion = self.active(Group::Motion);
                    commands.before.position = self.modes.position;
                    commands.note_move(motion);
                    self.moves(block, commands)
                }
            });
        if done.is_err() {
            self.modes.feed = commands.before.feed;
        }
        done
    }

    #[cfg_attr(target_has_atomic = "32", inline(never))]
    #[cfg_attr(not(target_has_atomic = "32"), inline(always))]
    fn apply_any(&mut self, block: &Block, commands: &mut Commands<N>) -> Result<(), Fault> {
        self.modes.write_to(&mut commands.before);
        commands.entry = Entry::None;
        let done = self.execute(block, commands);
        if done.is_err() {
            commands.before.write_to(&mut self.modes);
            return done;
        }
        self.store(block, commands);
        self.stop(block, commands);
        commands.note_modes();
        Ok(())
    }

    /// The motion of a block that is only a move, if it and the previous motion are one of G0 to
    /// G3, or none.
    #[inline(always)]
    fn plain_move(&self, block: &Block) -> Option<Code> {
        let before = self.active(Group::Motion);
        let code = block.code(Group::Motion).unwrap_or(before);
        // A cycle that ends here leaves words that have to be cleared.
        let simple = before.is_plain_move() || before == Code::CancelMotion || !EXTENDED;
        #[cfg(feature = "extended")]
        let simple = simple && !self.modes.is_rotated;
        Some(code).filter(|code| block.is_move() && code.is_plain_move() && simple)
    }

    /// The code in effect of a modal group.
    #[inline(always)]
    pub(crate) fn active(&self, group: Group) -> Code {
        let code = self.modes.active.get(group as usize).copied();
        code.flatten().unwrap_or(Code::Foreign)
    }

    #[inline(always)]
    pub(crate) fn set_active(&mut self, group: Group, code: Code) {
        if let Some(active) = self.modes.active.get_mut(group as usize) {
            *active = Some(code);
        }
    }

    fn execute(&mut self, block: &Block, commands: &mut Commands<N>) -> Result<(), Fault> {
        self.check_axes(block)?;
        #[cfg(feature = "extended")]
        block.check_needs_no_program()?;
        self.set_feed(block)?;
        self.set_outputs(block, commands)?;
        self.set_dwell(block, commands)?;
        self.set_modes(block, commands)?;
        self.moves(block, commands)
    }

    /// Stores the position before the block for G28.1, G30.1 and the G54 of the micro mill, once
    /// the block can no longer fail.
    fn store(&mut self, block: &Block, commands: &mut Commands<N>) {
        let [first, second] = &mut self.homes;
        let (entry, to) = match block.code(Group::NonModal) {
            Some(Code::StoreHome) => (Entry::Home, first),
            Some(Code::StoreSecondHome) => (Entry::SecondHome, second),
            _ => {
                let micromill = self.modes.dialect.flavour == Flavour::Micromill;
                match self.offsets.first_mut() {
                    Some(offset) if micromill && block.code(Group::System).is_some() => {
                        (Entry::System(0), offset)
                    }
                    _ => return,
                }
            }
        };
        commands.keep(entry, to);
        *to = commands.before.position;
    }

    /// Takes back the block of these commands, for a caller that cannot make all of them. The state
    /// is then as it was before [`Modal::apply`], and there are no commands.
    ///
    /// The commands are those of the last block, taken or not. Without an accepted block, or after
    /// [`Commands::clear`], nothing changes.
    pub fn revert(&mut self, commands: &mut Commands<N>) {
        let (changed, motion) = commands.take_changed();
        let before = &commands.before;
        match changed {
            Changed::Nothing => {}
            Changed::Move => {
                (self.modes.position, self.modes.feed) = (before.position, before.feed);
                self.set_active(Group::Motion, motion.unwrap_or(Code::Foreign));
            }
            Changed::Modes => {
                before.write_to(&mut self.modes);
                self.restore(commands);
            }
        }
    }

    /// Restores the entry of a table that the block changed.
    fn restore(&mut self, commands: &Commands<N>) {
        let [first, second] = &mut self.homes;
        match commands.entry {
            Entry::None => {}
            Entry::Home => *first = commands.kept,
            Entry::SecondHome => *second = commands.kept,
            Entry::System(system) => {
                let system = usize::from(system);
                if let Some(offset) = self.offsets.get_mut(system) {
                    *offset = commands.kept;
                }
                #[cfg(feature = "extended")]
                if let Some(angle) = self.angles.get_mut(system) {
                    *angle = commands.kept_angle;
                }
            }
            #[cfg(feature = "extended")]
            Entry::Tool(place) => {
                let (number, radius) = commands.kept_tool;
                let tool = Tool {
                    offset: commands.kept,
                    radius,
                };
                self.tools.put(usize::from(place), number, tool);
            }
        }
    }

    /// Checks that this machine has the axes of the block.
    fn check_axes(&self, block: &Block) -> Result<(), Fault> {
        let mine = if N < 16 {
            1u16.wrapping_shl(N as u32).wrapping_sub(1)
        } else {
            u16::MAX
        };
        let foreign = block.axes() & !mine;
        if EXTENDED && self.modes.dialect.flavour == Flavour::Lathe {
            block.check_increments()?;
        }
        if foreign == 0 {
            return Ok(());
        }
        Err(Fault::at(Reason::UnknownWord, first_of(u32::from(foreign))))
    }

    fn stop(&mut self, block: &Block, commands: &mut Commands<N>) {
        let Some(code) = block.code(Group::Stop) else {
            return;
        };
        commands.finish(Some(code));
        if matches!(code, Code::End | Code::EndAndRewind) {
            self.end();
        }
    }

    /// The reset of M2 and M30: G54, G92.1 (not in the grbl dialect), G17 (lathes G18), G90, G94,
    /// G1, G40, M5, M9. Work zeros, tool length, units and the feed stay.
    fn end(&mut self) {
        if self.modes.dialect.flavour != Flavour::Grbl {
            self.modes.shift = [Nm(0); N];
        }
        if self.feed_mode() != FeedMode::PerMinute {
            self.modes.feed = 0;
        }
        let (lathe, micromill) = (
            self.modes.dialect.is_lathe(),
            self.modes.dialect.flavour == Flavour::Micromill,
        );
        for (group, code) in [
            (
                Group::Plane,
                if lathe { Code::PlaneZx } else { Code::PlaneXy },
            ),
            (Group::System, Code::G54),
            (Group::Distance, Code::Absolute),
            (Group::FeedMode, Code::PerMinute),
            (
                Group::Motion,
                if micromill {
                    Code::CancelMotion
                } else {
                    Code::Linear
                },
            ),
        ] {
            self.set_active(group, code);
        }
        #[cfg(feature = "extended")]
        {
            self.modes.sticky = Sticky::NONE;
            (self.modes.more.tail, self.modes.more.compensation) = (None, None);
            self.modes.more.nurbs = (0, 0);
            self.note_rotation();
        }
        self.stop_outputs();
    }

    /// Adds a word to a length, if the block has it; both stay within [`Nm::LIMIT`].
    #[cfg_attr(target_pointer_width = "64", inline(always))]
    #[cfg_attr(not(target_has_atomic = "32"), inline(never))]
    pub(crate) fn add_word(&self, block: &Block, letter: u8, to: &mut Nm) -> Result<(), Fault> {
        let (factor, exponent) = self.scale_of(letter);
        let Some(word) = block.value(letter) else {
            return Ok(());
        };
        if let Some(value) = word.scaled(i32::from(factor), exponent) {
            // Both are below 2^63 / 2 where it matters.
            let sum = Nm(to.0.wrapping_add(value));
            if Nm(value).within_limit().is_some() && sum.within_limit().is_some() {
                *to = sum;
                return Ok(());
            }
        }
        Err(Fault::at(Reason::NumberTooLarge, letter))
    }

    /// The unit of a word: millionths of a degree, the unit of length, or half of it.
    fn scale_of(&self, letter: u8) -> (u8, u8) {
        match letter {
            // The letters under which the words of the axes after Z are stored.
            b'A'..=b'C' if self.is_rotary(usize::from(letter.wrapping_sub(b'A'))) => {
                Units::Millimetres.scale(false)
            }
            b'X' | b'U' if self.is_diameter() => self.units().scale(true),
            _ => self.units().scale(false),
        }
    }

    /// Whether the axis of this number after Z is rotary.
    fn is_rotary(&self, after_z: usize) -> bool {
        // At most 2, so the sum fits.
        !EXTENDED || self.modes.dialect.axes().is_rotary(after_z.wrapping_add(3))
    }

    /// A word as a length, if the block has it.
    #[cfg(feature = "extended")]
    pub(crate) fn length_of(&self, block: &Block, letter: u8) -> Result<Option<Nm>, Fault> {
        if block.word(letter).is_none() {
            return Ok(None);
        }
        let mut length = Nm(0);
        self.add_word(block, letter, &mut length)?;
        Ok(Some(length))
    }
}

//! Frames and tools: G10, G28 and G30, G43 and G49, G92, and the sides of G41 and G42.

use crate::block::{AXES, Block, axis_letter};
use crate::code::{Code, EXTENDED, Group, Side};
use crate::command::Command;
use crate::commands::Commands;
use crate::dialect::Flavour;
use crate::error::ErrorKind;
use crate::fault::Fault;
use crate::modal::{Modal, coordinate};
use crate::nm::Nm;
use crate::settings::{missing, whole};
use crate::tools::Tool;

/// What the axis words of a block say.
#[derive(Copy, Clone)]
enum From {
    /// The value itself.
    Word,
    /// How the present position shall read: in the work frame (G10 L20), by G92, or by the length of the tool, in the work
    /// frame (G10 L10) or in the fixture of G59.3, whatever shifts the others (G10 L11).
    System,
    Shift,
    ToolInWork,
    ToolInFixture,
}

impl<const N: usize> Modal<N> {
    #[inline(never)]
    pub(crate) fn set_compensation(
        &mut self,
        block: &Block,
        commands: &mut Commands<N>,
    ) -> Result<(), Fault> {
        let (side, direct) = match block.code(Group::Compensation).filter(|_| EXTENDED) {
            None => return Ok(()),
            Some(Code::Compensate { side, direct }) => (side, direct),
            Some(_) => {
                if self.modes.compensation.take().is_some() {
                    commands.compensation(None, Nm(0), self.modes.plane);
                }
                return Ok(());
            }
        };
        if self.modes.compensation.is_some() {
            return Err(Fault::at_code(
                ErrorKind::UnderCompensation,
                Group::Compensation,
            ));
        }
        let radius = if direct {
            let value = block
                .word(b'D')
                .ok_or_else(|| missing(b'D', Group::Compensation))?;
            self.modes
                .units
                .half(value)
                .ok_or_else(|| Fault::at(ErrorKind::NumberTooLarge, b'D'))?
        } else {
            match whole::<u32>(block, b'D')? {
                Some(0) => Nm(0),
                Some(number) => {
                    let tool = self.tools.get(number);
                    tool.ok_or_else(|| Fault::at(ErrorKind::UnknownTool, b'D'))?
                        .radius
                }
                None => {
                    let tool = self.tools.get(self.modes.loaded);
                    let unknown = || Fault::at_code(ErrorKind::UnknownTool, Group::Compensation);
                    tool.ok_or_else(unknown)?.radius
                }
            }
        };
        // A negative radius is a tool on the other side.
        let side = match (side, radius < Nm(0)) {
            (Side::Left, true) => Side::Right,
            (Side::Right, true) => Side::Left,
            (side, false) => side,
        };
        self.modes.compensation = Some(side);
        commands.compensation(Some(side), Nm(radius.0.saturating_abs()), self.modes.plane);
        Ok(())
    }

    #[inline(never)]
    pub(crate) fn set_tool_length(
        &mut self,
        block: &Block,
        commands: &mut Commands<N>,
    ) -> Result<(), Fault> {
        let mut number = 0;
        let before = self.modes.length;
        match block.code(Group::ToolLength) {
            None => return Ok(()),
            Some(Code::ToolLength) if EXTENDED => {
                number = whole(block, b'H')?.unwrap_or(self.modes.loaded);
                // A tool that is not in the table has no length of its own: its length is in the work zero.
                self.modes.length = self.tools.get(number).unwrap_or_default().offset;
            }
            Some(Code::DirectToolLength) => {
                if block.axes() == 0 {
                    return Err(Fault::at_code(ErrorKind::NoAxisWords, Group::ToolLength));
                }
                let mut length = self.modes.length;
                for (axis, length) in (0..N).zip(length.iter_mut()) {
                    if let Some(value) = self.length_of(block, axis_letter(axis))? {
                        *length = value;
                    }
                }
                self.modes.length = length;
            }
            Some(_) => {
                self.modes.length = [Nm(0); N];
                // G49 in the first line of many a program.
                if before == self.modes.length {
                    return Ok(());
                }
            }
        }
        commands.length(number, self.modes.length);
        Ok(())
    }

    /// G10 and its `L`.
    #[inline(never)]
    pub(crate) fn set_data(&mut self, block: &Block) -> Result<(), Fault> {
        let kind: u8 = whole(block, b'L')?.ok_or_else(|| missing(b'L', Group::NonModal))?;
        let number: u32 = whole(block, b'P')?.ok_or_else(|| missing(b'P', Group::NonModal))?;
        match kind {
            1 | 10 | 11 if EXTENDED && self.dialect.flavour != Flavour::Grbl => {
                self.write_tool(block, kind, number)
            }
            2 | 20 => {
                if block.word(b'R').is_some_and(|angle| !angle.is_zero()) {
                    return Err(Fault::at(ErrorKind::OutOfRange(b'R'), b'R'));
                }
                let system = match number.checked_sub(1) {
                    None => Some(self.modes.system),
                    Some(system) => u8::try_from(system).ok(),
                };
                let most = if self.dialect.flavour == Flavour::Grbl {
                    6
                } else {
                    self.offsets.len()
                };
                let system = system
                    .filter(|&system| usize::from(system) < most)
                    .ok_or_else(|| Fault::at(ErrorKind::OutOfRange(b'P'), b'P'))?;
                let from = if kind == 20 { From::System } else { From::Word };
                let words = self.axes_of(block, from)?;
                if let Some(zero) = self.offsets.get_mut(usize::from(system)) {
                    write(zero, words);
                }
                Ok(())
            }
            _ => Err(Fault::at(ErrorKind::OutOfRange(b'L'), b'L')),
        }
    }

    /// G10 L1, L10, L11: the length and the radius of a tool.
    fn write_tool(&mut self, block: &Block, kind: u8, number: u32) -> Result<(), Fault> {
        if number == 0 {
            return Err(Fault::at(ErrorKind::OutOfRange(b'P'), b'P'));
        }
        let mut tool = self.tools.get(number).unwrap_or_default();
        let from = match kind {
            1 => From::Word,
            10 => From::ToolInWork,
            _ => From::ToolInFixture,
        };
        write(&mut tool.offset, self.axes_of(block, from)?);
        if let Some(radius) = self.length_of(block, b'R')? {
            tool.radius = radius;
        }
        if self.tools.set(number, tool) {
            Ok(())
        } else {
            Err(Fault::at(ErrorKind::ToolTableFull, b'P'))
        }
    }

    /// What a coordinate of the present position is where its zero is sought, so that it reads the word.
    fn here(&self, axis: usize, from: From) -> Option<i64> {
        let position = coordinate(&self.modes.position, axis).0;
        let length = coordinate(&self.modes.length, axis).0;
        let shift = coordinate(&self.modes.shift, axis).0;
        // All within a few times Nm::LIMIT.
        Some(match from {
            From::Word => return None,
            From::System => position.saturating_sub(shift).saturating_sub(length),
            From::Shift => position
                .saturating_sub(self.system_offset_of(axis).0)
                .saturating_sub(length),
            From::ToolInWork => position.saturating_sub(self.work_offset_of(axis).0),
            From::ToolInFixture => {
                let fixture = self
                    .offsets
                    .last()
                    .map_or(0, |zero| coordinate(zero, axis).0);
                position.saturating_sub(fixture)
            }
        })
    }

    /// The axis words of a block: as they are, or as what the present position shall read.
    fn axes_of(&self, block: &Block, from: From) -> Result<[Option<Nm>; N], Fault> {
        let mut words = [None; N];
        for (axis, entry) in (0..N).zip(words.iter_mut()) {
            let letter = block.letter_of(axis);
            if let Some(value) = self.length_of(block, letter)? {
                let wanted = match self.here(axis, from) {
                    Some(here) => Nm(here.saturating_sub(value.0)),
                    None => value,
                };
                let within = wanted.within_limit();
                *entry = Some(within.ok_or(Fault::at(ErrorKind::NumberTooLarge, letter))?);
            }
        }
        Ok(words)
    }

    /// G92: the present position gets the coordinates of the axis words; on the drill zero without any.
    #[inline(never)]
    pub(crate) fn set_shift(&mut self, block: &Block) -> Result<(), Fault> {
        if block.axes() == 0 {
            if self.dialect.flavour != Flavour::Drill {
                return Err(Fault::at_code(ErrorKind::NoAxisWords, Group::NonModal));
            }
            for axis in 0..N {
                if let (Some(here), Some(shift)) =
                    (self.here(axis, From::Shift), self.modes.shift.get_mut(axis))
                {
                    *shift = Nm(here);
                }
            }
        }
        let words = self.axes_of(block, From::Shift)?;
        write(&mut self.modes.shift, words);
        self.modes.kept_shift = self.modes.shift;
        Ok(())
    }

    /// G28 and G30: through the given point to the stored position, only the axes named; all axes straight where none
    /// is.
    #[inline(never)]
    pub(crate) fn go_home(
        &mut self,
        block: &Block,
        which: u8,
        commands: &mut Commands<N>,
    ) -> Result<(), Fault> {
        let home = if which == 0 {
            self.homes[0]
        } else {
            self.homes[1]
        };
        let given = block.axes();
        let mut to = self.modes.position;
        for (axis, (to, home)) in (0..N).zip(to.iter_mut().zip(home)) {
            if given == 0 || axis < AXES && given & 1u16.wrapping_shl(axis as u32) != 0 {
                *to = home;
            }
        }
        if self.dialect.flavour == Flavour::Micromill {
            if given == 0 {
                return Err(Fault::at_code(ErrorKind::NoAxisWords, Group::NonModal));
            }
            self.check_z_alone(block)?;
            for axis in 0..AXES {
                if block.axis(axis).is_some_and(|value| !value.is_zero()) {
                    let letter = axis_letter(axis);
                    return Err(Fault::at(ErrorKind::NotZero(letter), letter));
                }
            }
        } else if given != 0 {
            commands.via(self.target(block, self.frame())?);
        }
        self.modes.position = to;
        commands.motion(Command::Rapid { to });
        Ok(())
    }
}

/// Replaces what is given.
fn write<const N: usize>(to: &mut [Nm; N], words: [Option<Nm>; N]) {
    for (entry, word) in to.iter_mut().zip(words) {
        if let Some(word) = word {
            *entry = word;
        }
    }
}

impl<const N: usize> Tool<N> {
    /// A tool without length.
    pub const fn of_radius(radius: Nm) -> Self {
        Tool {
            offset: [Nm(0); N],
            radius,
        }
    }
}

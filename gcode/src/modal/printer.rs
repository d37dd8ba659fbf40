//! Codes of 3D printers: heaters, fans, and the extruder.

use crate::blocks::block::Block;
use crate::blocks::fault::{Fault, Reason};
use crate::codes::code::{Code, Group};
use crate::codes::dialect::Flavour;
use crate::command::{Feed, HeatWait, Heater};
use crate::modal::Modal;
use crate::modal::commands::{Commands, Plain};
use crate::modal::settings::{missing, unsigned, whole};
use crate::values::nm::Nm;

/// Length of a retraction by G10, nm.
///
/// # Source
/// Marlin 2.1, `Configuration_adv.h`, `RETRACT_LENGTH` 3 mm and `RETRACT_FEEDRATE` 45 mm/s.
const RETRACTION: i64 = 3_000_000;
/// Its speed, nm/min.
const RETRACTION_FEED: i64 = 2_700_000_000;

impl<const N: usize> Modal<N> {
    /// Whether the dialect is that of printers.
    pub(crate) fn is_printer(&self) -> bool {
        self.modes.dialect.flavour == Flavour::Printer
    }

    /// Whether an axis is the extruder of a printer.
    pub(crate) fn is_extruder(&self, axis: usize) -> bool {
        self.is_printer() && self.modes.dialect.axes().letter(axis) == Some(b'E')
    }

    /// M82, M83, M84, M104 to M109, M140, M141, M190, M191, G10 and G11.
    #[inline(never)]
    pub(crate) fn printer_code(
        &mut self,
        block: &Block,
        code: Code,
        commands: &mut Commands<N>,
    ) -> Result<(), Fault> {
        match code {
            Code::ExtruderAbsolute => self.modes.more.feeds_increments = false,
            Code::ExtruderRelative => self.modes.more.feeds_increments = true,
            Code::MotorsOff => commands.io(Plain::MotorsOff),
            Code::Retract => self.retract(true, commands),
            Code::Unretract => self.retract(false, commands),
            Code::Fan | Code::FanOff => commands.io(fan(block, code)?),
            _ => commands.io(self.heat(block, code)?),
        }
        Ok(())
    }

    /// A heater gets a target; `S`, or `R` which also waits while it cools.
    fn heat(&self, block: &Block, code: Code) -> Result<Plain, Fault> {
        let waits = matches!(
            code,
            Code::HeatExtruderAndWait | Code::HeatBedAndWait | Code::HeatChamberAndWait
        );
        let heater = match code {
            Code::HeatExtruder | Code::HeatExtruderAndWait => {
                let loaded = u8::try_from(self.modes.loaded).unwrap_or(u8::MAX);
                Heater::Extruder(whole(block, b'T', u8::MAX)?.unwrap_or(loaded))
            }
            Code::HeatBed | Code::HeatBedAndWait => Heater::Bed,
            _ => Heater::Chamber,
        };
        let (letter, wait) = match (waits, block.has(b'R')) {
            (true, true) => (b'R', HeatWait::Reached),
            (true, false) => (b'S', HeatWait::Heated),
            (false, _) => (b'S', HeatWait::None),
        };
        let value = block
            .word(letter)
            .ok_or_else(|| missing(letter, Group::Io))?;
        let milli = unsigned(value, 3).filter(|&milli| milli <= MOST_MILLI_CELSIUS);
        let milli = milli.ok_or_else(|| Fault::at(Reason::OutOfRange, letter))?;
        Ok(Plain::Heat(heater, milli as u32, wait))
    }

    /// G10 and G11: the filament moves, and the coordinate of the extruder stays. A second one of
    /// the same kind has no effect.
    fn retract(&mut self, back: bool, commands: &mut Commands<N>) {
        let axis = self.modes.dialect.axes().index(b'E');
        let Some(axis) = axis.filter(|_| self.modes.more.is_retracted != back) else {
            return;
        };
        self.modes.more.is_retracted = back;
        let by = if back { -RETRACTION } else { RETRACTION };
        commands.arc.to = self.modes.position;
        let (to, shift) = (
            commands.arc.to.get_mut(axis),
            self.modes.shift.get_mut(axis),
        );
        if let (Some(to), Some(shift)) = (to, shift) {
            // Both are below 2^50, and at most one retraction apart.
            to.0 = to.0.wrapping_add(by);
            shift.0 = shift.0.wrapping_add(by);
            commands.feed = Feed::PerMinute(Nm(RETRACTION_FEED));
            self.go(Code::Linear, commands);
        }
    }
}

/// Hotter than any heater of a printer: 2000 degrees Celsius.
const MOST_MILLI_CELSIUS: u64 = 2_000_000;

/// M106 and M107: `S` is the speed, 255 the highest.
fn fan(block: &Block, code: Code) -> Result<Plain, Fault> {
    let number = whole(block, b'P', u8::MAX)?.unwrap_or(0);
    let per_mille = match block.word(b'S') {
        _ if code == Code::FanOff => 0,
        None => 1000,
        Some(speed) => {
            let milli = unsigned(speed, 3).filter(|&milli| milli <= 255_000);
            let milli = milli.ok_or_else(|| Fault::at(Reason::OutOfRange, b'S'))?;
            // At most 1000, rounded.
            (milli.wrapping_add(127) / 255) as u16
        }
    };
    Ok(Plain::Fan(number, per_mille))
}

//! Letters of a status report.

use crate::grbl::text::Text;

/// Closed inputs, one bit each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Pins(pub u16);

/// Accessories that are on, one bit each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Accessories(pub u8);

/// Letters of the inputs, bit 0 first.
const PINS: &[u8] = b"PXYZABCDHRSLTQ";
/// Letters of the accessories: spindle clockwise, spindle counter-clockwise, flood, mist.
const ACCESSORIES: &[u8] = b"SCFM";

impl Pins {
    /// The probe.
    pub const PROBE: u16 = 1;
    /// The limit switch of X. Those of the other axes follow, up to C.
    pub const LIMIT_X: u16 = 1 << 1;
    /// The safety door.
    pub const DOOR: u16 = 1 << 7;
    /// The hold button.
    pub const HOLD: u16 = 1 << 8;
    /// The reset button.
    pub const RESET: u16 = 1 << 9;
    /// The start button.
    pub const START: u16 = 1 << 10;
    /// Block delete is on. This and the following letters are of grblHAL.
    pub const BLOCK_DELETE: u16 = 1 << 11;
    /// M1 has no effect.
    pub const NO_OPTIONAL_STOP: u16 = 1 << 12;
    /// The machine holds after each block.
    pub const SINGLE_BLOCK: u16 = 1 << 13;

    /// Appends the field `|Pn:` if an input is closed.
    pub fn put(self, text: &mut Text) {
        put(text, b"|Pn:", PINS, self.0);
    }

    pub(crate) fn parse(letters: &[u8]) -> Pins {
        Pins(parse(PINS, letters))
    }
}

impl Accessories {
    /// The spindle turns clockwise.
    pub const CLOCKWISE: u8 = 1;
    /// The spindle turns counter-clockwise.
    pub const COUNTER_CLOCKWISE: u8 = 2;
    /// Flood coolant.
    pub const FLOOD: u8 = 4;
    /// Mist coolant.
    pub const MIST: u8 = 8;

    pub(crate) fn put(self, text: &mut Text) {
        put(text, b"|A:", ACCESSORIES, self.0.into());
    }

    /// Appends the letters.
    pub fn put_letters(self, text: &mut Text) {
        put_letters(text, ACCESSORIES, self.0.into());
    }

    pub(crate) fn parse(letters: &[u8]) -> Accessories {
        // There are four letters.
        Accessories(parse(ACCESSORIES, letters) as u8)
    }
}

fn put(text: &mut Text, name: &[u8], letters: &[u8], bits: u16) {
    if bits == 0 {
        return;
    }
    text.put(name);
    put_letters(text, letters, bits);
}

fn put_letters(text: &mut Text, letters: &[u8], bits: u16) {
    for (bit, letter) in (0_u32..).zip(letters) {
        if bits.wrapping_shr(bit) & 1 == 1 {
            text.put(&[*letter]);
        }
    }
}

fn parse(all: &[u8], letters: &[u8]) -> u16 {
    let bits = (0_u32..).zip(all);
    bits.filter(|(_, letter)| letters.contains(letter))
        .fold(0, |bits, (bit, _)| bits | 1_u16.wrapping_shl(bit))
}

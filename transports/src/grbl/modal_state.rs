//! The modal state: `$G`.

use crate::grbl::place::Units;
use crate::grbl::status::feed;
use crate::grbl::text::{Text, decimal, rounded, whole};

/// Modal state as `[GC:G0 G54 G17 G21 G90 G94 M5 M9 T0 F0 S0]` shows it. Codes are in tenths: 382
/// is G38.2.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ModalState {
    /// G0 to G3, G38.2 to G38.5, G80.
    pub motion: u16,
    /// G54 to G59.
    pub frame: u16,
    /// G17 to G19.
    pub plane: u16,
    /// G20 or G21.
    pub units: u16,
    /// G90 or G91.
    pub distance: u16,
    /// G93 or G94.
    pub feed_mode: u16,
    /// M0, M2 or M30 that has stopped the program.
    pub program: Option<u16>,
    /// M3, M4 or M5.
    pub spindle: u16,
    /// Mist coolant, M7.
    pub mist: bool,
    /// Flood coolant, M8.
    pub flood: bool,
    /// T word.
    pub tool: u8,
    /// F word, in nm/min.
    pub feed_nm_per_min: u64,
    /// S word, in thousandths of a turn per minute.
    pub milli_rpm: u64,
}

impl Default for ModalState {
    /// The state after a reset.
    fn default() -> Self {
        ModalState {
            motion: 0,
            frame: 540,
            plane: 170,
            units: 210,
            distance: 900,
            feed_mode: 940,
            program: None,
            spindle: 50,
            mist: false,
            flood: false,
            tool: 0,
            feed_nm_per_min: 0,
            milli_rpm: 0,
        }
    }
}

impl ModalState {
    pub(crate) fn put(&self, text: &mut Text, units: Units) {
        let codes = [
            self.motion,
            self.frame,
            self.plane,
            self.units,
            self.distance,
            self.feed_mode,
        ];
        for (number, code) in (0_u8..).zip(codes) {
            let letter: &[u8] = if number == 0 { b"G" } else { b" G" };
            put_code(text, letter, code);
        }
        if let Some(program) = self.program {
            put_code(text, b" M", program);
        }
        put_code(text, b" M", self.spindle);
        if self.mist {
            text.put(b" M7");
        }
        if self.flood {
            text.put(b" M8");
        }
        if !self.mist && !self.flood {
            text.put(b" M9");
        }
        text.put(b" T");
        text.put_number(self.tool.into());
        text.put(b" F");
        text.put_feed(self.feed_nm_per_min, units);
        text.put(b" S");
        let milli_rpm = i64::try_from(self.milli_rpm).unwrap_or(i64::MAX);
        text.put_decimal(rounded(milli_rpm, 1000), 0);
    }

    /// Reads the words after `[GC:`.
    pub(crate) fn parse(text: &[u8]) -> Option<(ModalState, Units)> {
        let mut state = ModalState::default();
        let mut units = Units::Millimetres;
        for word in text.split(|byte| *byte == b' ') {
            let (letter, number) = word.split_first()?;
            match letter {
                b'T' => state.tool = whole(number)?,
                b'S' => state.milli_rpm = whole::<u64>(number)?.checked_mul(1000)?,
                b'F' => {
                    if number.contains(&b'.') {
                        units = Units::Inches;
                    }
                    state.feed_nm_per_min = feed(number, units)?;
                }
                letter => state.take_code(*letter, code(number)?)?,
            }
        }
        Some((state, units))
    }

    fn take_code(&mut self, letter: u8, code: u16) -> Option<()> {
        match (letter, code) {
            (b'G', 0..=30 | 382..=385 | 800) => self.motion = code,
            (b'G', 540..=590) => self.frame = code,
            (b'G', 170..=190) => self.plane = code,
            (b'G', 200 | 210) => self.units = code,
            (b'G', 900 | 910) => self.distance = code,
            (b'G', 930 | 940) => self.feed_mode = code,
            (b'M', 0 | 10 | 20 | 300) => self.program = Some(code),
            (b'M', 30 | 40 | 50) => self.spindle = code,
            (b'M', 70) => self.mist = true,
            (b'M', 80) => self.flood = true,
            (b'M', 90) => {}
            _ => return None,
        }
        Some(())
    }
}

fn put_code(text: &mut Text, letter: &[u8], tenths: u16) {
    text.put(letter);
    match tenths % 10 {
        0 => text.put_decimal((tenths / 10).into(), 0),
        _ => text.put_decimal(tenths.into(), 1),
    }
}

fn code(text: &[u8]) -> Option<u16> {
    match decimal(text, 1)? {
        (tenths, []) => u16::try_from(tenths).ok(),
        _ => None,
    }
}

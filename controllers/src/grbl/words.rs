//! The words of a block, checked in the order of Grbl and with its error numbers.

use husillo_transports::grbl::{ErrorCode, decimal};

#[cfg(feature = "grblhal")]
use super::hal::{Extra, extra_code, extra_m};

/// One word: its letter and the text of its number.
#[derive(Clone, Copy, Debug)]
pub(super) struct Word<'a> {
    pub(super) letter: u8,
    pub(super) number: &'a [u8],
    /// The number in tenths. Further decimals are dropped.
    pub(super) tenths: i32,
}

/// Reads the words of a line that has no blanks.
pub(super) struct WordReader<'a>(pub(super) &'a [u8]);

impl<'a> Iterator for WordReader<'a> {
    type Item = Result<Word<'a>, ErrorCode>;

    fn next(&mut self) -> Option<Self::Item> {
        let (letter, rest) = self.0.split_first()?;
        if !letter.is_ascii_uppercase() {
            return Some(Err(ErrorCode::ExpectedLetter));
        }
        let Some((hundredths, after)) = decimal(rest, 2) else {
            return Some(Err(ErrorCode::BadNumber));
        };
        self.0 = after;
        let length = rest.len().saturating_sub(after.len());
        Some(Ok(Word {
            letter: *letter,
            number: rest.get(..length).unwrap_or_default(),
            tenths: i32::try_from(hundredths / 10).unwrap_or(i32::MAX),
        }))
    }
}

/// The codes and words of a block that matter before the modal state is known. Codes are in tenths.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Given {
    /// Letters of all words other than G and M, bit 0 for A.
    pub(super) letters: u32,
    pub(super) motion: Option<u16>,
    /// G4, G10, G28, G30, G53, G92 and their variants.
    pub(super) non_modal: Option<u16>,
    /// G43.1, G49.
    pub(super) length: Option<u16>,
    pub(super) frame: Option<u16>,
    pub(super) units: Option<u16>,
    /// G17 to G19.
    pub(super) plane: Option<u16>,
    /// G90, G91.
    pub(super) distance: Option<u16>,
    pub(super) feed_mode: Option<u16>,
    /// Whether G40, G61 and G91.1 were given. They are always in effect.
    others: [bool; 3],
    /// M0, M1, M2, M30.
    pub(super) stop: Option<u16>,
    pub(super) spindle: Option<u16>,
    pub(super) coolant: Option<u16>,
    /// N.
    pub(super) line: u32,
    /// Whole parts of P and of L.
    pub(super) p: i64,
    pub(super) l: i64,
    /// T.
    pub(super) tool: u8,
    /// The code that uses the axis words.
    axis_user: Option<AxisUser>,
    /// Whole part of H, and codes that Grbl does not have.
    #[cfg(feature = "grblhal")]
    pub(super) h: u32,
    #[cfg(feature = "grblhal")]
    pub(super) extra: Extra,
    #[cfg(feature = "grblhal")]
    is_hal: bool,
}

/// The codes that a controller has.
#[derive(Clone, Copy, Debug)]
pub(super) struct CodeSet {
    /// M7.
    pub(super) has_mist: bool,
    #[cfg(feature = "grblhal")]
    pub(super) is_hal: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum AxisUser {
    Motion,
    NonModal,
    Length,
}

/// Returns the bit of a letter.
pub(super) const fn bit(letter: u8) -> u32 {
    1_u32.wrapping_shl(letter.wrapping_sub(b'A') as u32)
}

const AXES: u32 = bit(b'X') | bit(b'Y') | bit(b'Z');
const CENTRE: u32 = bit(b'I') | bit(b'J') | bit(b'K');
const PARAMETERS: u32 = AXES
    | CENTRE
    | bit(b'F')
    | bit(b'L')
    | bit(b'N')
    | bit(b'P')
    | bit(b'R')
    | bit(b'S')
    | bit(b'T');
/// Words whose value must not be negative.
const UNSIGNED: u32 = bit(b'F') | bit(b'N') | bit(b'P') | bit(b'T') | bit(b'S');

impl Given {
    /// Reads the words of a line.
    ///
    /// # Errors
    /// Fails with the first error that Grbl finds in the words.
    pub(super) fn read(line: &[u8], codes: CodeSet) -> Result<Given, ErrorCode> {
        let mut given = Given::default();
        #[cfg(feature = "grblhal")]
        {
            given.is_hal = codes.is_hal;
        }
        for word in WordReader(line) {
            let word = word?;
            match word.letter {
                b'G' => given.take_g(&word)?,
                b'M' => given.take_m(&word, codes.has_mist)?,
                _ => given.take_parameter(&word)?,
            }
        }
        Ok(given)
    }

    /// Whether the codes are those of grblHAL.
    #[cfg(feature = "grblhal")]
    pub(super) const fn is_hal(&self) -> bool {
        self.is_hal
    }

    /// Whether the codes are those of grblHAL.
    #[cfg(not(feature = "grblhal"))]
    pub(super) const fn is_hal(&self) -> bool {
        false
    }

    pub(super) const fn has(&self, letter: u8) -> bool {
        self.letters & bit(letter) != 0
    }

    pub(super) const fn has_axes(&self) -> bool {
        self.letters & AXES != 0
    }

    fn take_g(&mut self, word: &Word) -> Result<(), ErrorCode> {
        #[cfg(feature = "grblhal")]
        if self.is_hal {
            if let Some(result) = extra_code(self, word) {
                return result;
            }
        }
        let code = u16::try_from(word.tenths).map_err(|_| ErrorCode::Unsupported)?;
        let (number, tenth) = (code / 10, code % 10);
        let slot = match number {
            4 | 10 | 28 | 30 | 53 | 92 => {
                let uses_axes = matches!(number, 10 | 28 | 30 | 92) && tenth == 0;
                if uses_axes {
                    self.use_axes(AxisUser::NonModal)?;
                }
                if matches!(number, 28 | 30 | 92) && tenth > 1 {
                    return Err(ErrorCode::Unsupported);
                }
                &mut self.non_modal
            }
            0..=3 | 38 => {
                self.use_axes(AxisUser::Motion)?;
                if number == 38 && !matches!(tenth, 2..=5) {
                    return Err(ErrorCode::Unsupported);
                }
                &mut self.motion
            }
            80 => &mut self.motion,
            17..=19 => &mut self.plane,
            20 | 21 => &mut self.units,
            54..=59 => &mut self.frame,
            90 | 91 if tenth == 0 => &mut self.distance,
            93 | 94 => &mut self.feed_mode,
            43 | 49 => {
                self.use_axes(AxisUser::Length)?;
                if number == 43 && tenth != 1 {
                    return Err(ErrorCode::Unsupported);
                }
                &mut self.length
            }
            40 | 61 | 91 => return self.take_other(code),
            _ => return Err(ErrorCode::Unsupported),
        };
        let takes_tenth = matches!(code, 281 | 301 | 921 | 382..=385 | 431) || number == 49;
        if !takes_tenth && (tenth != 0 || has_decimals(word)) {
            return Err(ErrorCode::NotWhole);
        }
        set(slot, code)
    }

    /// Accepts codes that are always in effect.
    fn take_other(&mut self, code: u16) -> Result<(), ErrorCode> {
        let [compensation, path, centre] = &mut self.others;
        let slot = match code {
            400 => compensation,
            610 => path,
            911 => centre,
            401..=409 => return Err(ErrorCode::NotWhole),
            _ => return Err(ErrorCode::Unsupported),
        };
        if core::mem::replace(slot, true) {
            return Err(ErrorCode::ModalGroup);
        }
        Ok(())
    }

    fn take_m(&mut self, word: &Word, has_mist: bool) -> Result<(), ErrorCode> {
        #[cfg(feature = "grblhal")]
        if self.is_hal {
            if let Some(result) = extra_m(self, word) {
                return result;
            }
        }
        if has_decimals(word) {
            return Err(ErrorCode::NotWhole);
        }
        let code = u16::try_from(word.tenths).map_err(|_| ErrorCode::Unsupported)?;
        let slot = match code / 10 {
            0 | 1 | 2 | 30 => &mut self.stop,
            3..=5 => &mut self.spindle,
            7 if has_mist => &mut self.coolant,
            8 | 9 => &mut self.coolant,
            _ => return Err(ErrorCode::Unsupported),
        };
        set(slot, code)
    }

    fn take_parameter(&mut self, word: &Word) -> Result<(), ErrorCode> {
        let bit = bit(word.letter);
        if bit & PARAMETERS == 0 && !self.is_hal() {
            return Err(ErrorCode::Unsupported);
        }
        if self.letters & bit != 0 {
            return Err(ErrorCode::Repeated);
        }
        self.letters |= bit;
        let is_negative = word.number.starts_with(b"-") && word.number.iter().any(is_not_zero);
        if is_negative && bit & UNSIGNED != 0 {
            return Err(ErrorCode::Negative);
        }
        let whole = i64::from(word.tenths / 10);
        match word.letter {
            b'P' => self.p = whole,
            b'L' => self.l = whole,
            b'N' => self.line = u32::try_from(whole).unwrap_or(u32::MAX),
            #[cfg(feature = "grblhal")]
            b'H' => self.h = u32::try_from(whole).map_err(|_| ErrorCode::Negative)?,
            b'T' => {
                self.tool = match u8::try_from(whole) {
                    Ok(tool) => tool,
                    Err(_) if self.is_hal() => 0,
                    Err(_) => return Err(ErrorCode::ToolNumber),
                }
            }
            _ => {}
        }
        Ok(())
    }

    pub(super) fn use_axes(&mut self, user: AxisUser) -> Result<(), ErrorCode> {
        if self.axis_user.is_some() {
            return Err(ErrorCode::AxisConflict);
        }
        self.axis_user = Some(user);
        Ok(())
    }

    /// Whether the motion code or the motion mode uses the axis words. A motion code uses them even
    /// if the block has none.
    pub(super) fn is_motion(&self) -> bool {
        match self.axis_user {
            Some(user) => user == AxisUser::Motion,
            None => self.has_axes(),
        }
    }

    /// Checks the words against each other and against the motion mode. Values are checked later.
    ///
    /// # Errors
    /// Fails with the first error that Grbl finds.
    pub(super) fn check(&self, mode: u16, state: &Modes) -> Result<(), ErrorCode> {
        if self.has(b'N') && self.line > 10_000_000 {
            return Err(ErrorCode::LineNumber);
        }
        let motion = self.motion.unwrap_or(mode);
        let is_feed = !matches!(motion, 0 | 800);
        let is_inverse = self.feed_mode.map_or(state.is_inverse, |code| code == 930);
        if is_inverse && self.is_motion() && is_feed && !self.has(b'F') {
            return Err(ErrorCode::NoFeed);
        }
        if self.non_modal == Some(40) && !self.has(b'P') {
            return Err(ErrorCode::MissingValue);
        }
        if self.length == Some(431) && self.letters & AXES != bit(b'Z') && !self.is_hal() {
            return Err(ErrorCode::ToolLengthAxis);
        }
        self.check_non_modal(motion)?;
        if motion == 800 && self.has_axes() && self.axis_user != Some(AxisUser::NonModal) {
            return Err(ErrorCode::AxisWords);
        }
        if !self.is_motion() {
            return self.check_unused(0);
        }
        let needs_feed = is_feed && self.has_feed(state) == Some(false);
        if needs_feed {
            return Err(ErrorCode::NoFeed);
        }
        match motion {
            20 | 30 => self.check_arc(state),
            382..=385 if !self.has_axes() => Err(ErrorCode::NoAxisWords),
            _ => self.check_unused(0),
        }
    }

    /// Whether the feed of an earlier block is valid. `None`: the block has an F word, which
    /// decides this.
    fn has_feed(&self, state: &Modes) -> Option<bool> {
        if self.has(b'F') {
            return None;
        }
        let changes = self
            .feed_mode
            .is_some_and(|code| (code == 930) != state.is_inverse);
        Some(state.has_feed && !changes)
    }

    fn check_non_modal(&self, motion: u16) -> Result<(), ErrorCode> {
        match self.non_modal {
            #[cfg(feature = "grblhal")]
            Some(100) if self.is_hal => self.check_data(),
            Some(100) => {
                if !self.has_axes() {
                    return Err(ErrorCode::NoAxisWords);
                }
                if !self.has(b'P') && !self.has(b'L') {
                    return Err(ErrorCode::MissingValue);
                }
                if self.p > 6 {
                    return Err(ErrorCode::WorkFrame);
                }
                match self.l {
                    20 => Ok(()),
                    2 if !self.has(b'R') => Ok(()),
                    _ => Err(ErrorCode::Unsupported),
                }
            }
            Some(920) if !self.has_axes() => Err(ErrorCode::NoAxisWords),
            Some(530) if !matches!(motion, 0 | 10) => Err(ErrorCode::MachineFrame),
            _ => Ok(()),
        }
    }

    /// Checks G10 of grblHAL.
    #[cfg(feature = "grblhal")]
    fn check_data(&self) -> Result<(), ErrorCode> {
        if !matches!(self.l, 1 | 2 | 10 | 11 | 20) {
            return Err(ErrorCode::Unsupported);
        }
        if !self.has_axes() && !self.has(b'R') {
            return Err(ErrorCode::NoAxisWords);
        }
        if !self.has(b'P') {
            return Err(ErrorCode::MissingValue);
        }
        if matches!(self.l, 2 | 20) && self.p > 9 {
            return Err(ErrorCode::WorkFrame);
        }
        Ok(())
    }

    fn check_arc(&self, state: &Modes) -> Result<(), ErrorCode> {
        // A centre alone is a full circle for grblHAL.
        let is_circle = self.is_hal() && self.letters & CENTRE != 0;
        if !self.has_axes() && !is_circle {
            return Err(ErrorCode::NoAxisWords);
        }
        let (axes, centre) = match self.plane.unwrap_or(state.plane) {
            170 => (bit(b'X') | bit(b'Y'), bit(b'I') | bit(b'J')),
            180 => (bit(b'X') | bit(b'Z'), bit(b'I') | bit(b'K')),
            _ => (bit(b'Y') | bit(b'Z'), bit(b'J') | bit(b'K')),
        };
        if self.letters & axes == 0 && !is_circle {
            return Err(ErrorCode::NoPlaneWords);
        }
        if !self.has(b'R') && self.letters & centre == 0 {
            return Err(ErrorCode::NoCentre);
        }
        self.check_unused(bit(b'R') | CENTRE)
    }

    /// Rejects words that no code uses. `used` has the words that the motion uses.
    fn check_unused(&self, used: u32) -> Result<(), ErrorCode> {
        let mut used = used | AXES | bit(b'F') | bit(b'N') | bit(b'S') | bit(b'T');
        match self.non_modal {
            Some(40) => used |= bit(b'P'),
            Some(100) if self.is_hal() => used |= bit(b'P') | bit(b'L') | bit(b'R'),
            Some(100) => used |= bit(b'P') | bit(b'L'),
            _ => {}
        }
        #[cfg(feature = "grblhal")]
        {
            let motion = self.motion.unwrap_or(800);
            let letters = self.extra.letters(motion, self.length);
            used |= letters.iter().fold(0, |bits, letter| bits | bit(*letter));
        }
        if self.letters & !used != 0 {
            return Err(ErrorCode::Unused);
        }
        Ok(())
    }
}

/// The modes that the check of a block requires.
#[derive(Clone, Copy, Debug)]
pub(super) struct Modes {
    pub(super) is_inverse: bool,
    pub(super) has_feed: bool,
    /// G17 to G19 in tenths.
    pub(super) plane: u16,
}

fn set(slot: &mut Option<u16>, code: u16) -> Result<(), ErrorCode> {
    if slot.is_some() {
        return Err(ErrorCode::ModalGroup);
    }
    *slot = Some(code);
    Ok(())
}

fn is_not_zero(byte: &u8) -> bool {
    matches!(byte, b'1'..=b'9')
}

/// Whether the number of a code has decimals other than zero.
pub(super) fn has_decimals(word: &Word) -> bool {
    let mut parts = word.number.splitn(2, |byte| *byte == b'.');
    parts
        .nth(1)
        .is_some_and(|decimals| decimals.iter().any(is_not_zero))
}

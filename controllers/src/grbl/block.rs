//! Conversion of a Grbl block to blocks of `gcode`.

use husillo_gcode::{
    Block, Commands, Dialect, Distance, Error, ErrorKind, FeedMode, Modal, Motion, Plane, Units,
};
use husillo_transports::grbl::{ErrorCode, Text, decimal};

use super::words::{Given, Modes, WordReader};

/// Returns the code of the motion mode, in tenths.
pub(super) fn motion_code(modal: &Modal<3>) -> u16 {
    match modal.motion() {
        Some(Motion::Rapid) => 0,
        Some(Motion::Linear) => 10,
        Some(Motion::Clockwise) => 20,
        Some(Motion::CounterClockwise) => 30,
        Some(Motion::Probe { away, must }) => match (away, must) {
            (false, true) => 382,
            (false, false) => 383,
            (true, true) => 384,
            (true, false) => 385,
        },
        #[cfg(feature = "grblhal")]
        other => super::hal::extra_motion(other),
        #[cfg(not(feature = "grblhal"))]
        _ => 800,
    }
}

/// Returns the code of the plane, in tenths.
pub(super) fn plane_code(modal: &Modal<3>) -> u16 {
    match modal.plane() {
        Plane::Xy => 170,
        Plane::Zx => 180,
        Plane::Yz => 190,
    }
}

pub(super) fn modes(modal: &Modal<3>) -> Modes {
    Modes {
        is_inverse: modal.feed_mode() == FeedMode::InverseTime,
        has_feed: modal.feed().is_some_and(|feed| feed.0 > 0),
        plane: plane_code(modal),
    }
}

/// Reads a block and applies it to the modal state. `commands` then has its commands.
///
/// # Errors
/// Fails with the error number of Grbl. The modal state is then unspecified.
pub(super) fn apply(
    line: &[u8],
    given: &Given,
    modal: &mut Modal<3>,
    commands: &mut Commands<3>,
) -> Result<(), ErrorCode> {
    given.check(motion_code(modal), &modes(modal))?;
    // Grbl reads the units of a block first, and stores positions before it moves.
    let first = match given.non_modal {
        Some(281 | 301 | 921) if given.has_axes() => given.non_modal,
        _ => None,
    };
    for code in [given.units, first].into_iter().flatten() {
        let mut text = Text::new();
        put_code(&mut text, b'G', code);
        apply_text(text.bytes(), modal, commands)?;
    }
    // The distance mode does not apply to G53.
    let is_incremental = given.distance.map_or_else(
        || modal.distance() == Distance::Incremental,
        |code| code == 910,
    );
    if given.non_modal != Some(530) || !is_incremental {
        return apply_text(rest(line, given, first).bytes(), modal, commands);
    }
    let mut text = rest(line, given, Some(910));
    text.put(b"G90");
    apply_text(text.bytes(), modal, commands)?;
    apply_text(b"G91", modal, &mut Commands::new())
}

/// Returns the words that `gcode` has to read.
fn rest(line: &[u8], given: &Given, first: Option<u16>) -> Text {
    let mut text = Text::new();
    for word in WordReader(line).filter_map(Result::ok) {
        let code = u16::try_from(word.tenths).unwrap_or(u16::MAX);
        match word.letter {
            b'N' => {}
            // Codes that are always in effect. M1 has no effect, because there is no switch for it.
            b'G' if matches!(code, 200 | 210 | 400 | 610 | 911) || Some(code) == first => {}
            b'M' if code == 10 && !given.is_hal() => {}
            #[cfg(feature = "grblhal")]
            b'M' if super::hal::Extra::hides_m(code) => {}
            b'G' if code == 490 => text.put(b"G49"),
            b'G' | b'M' => put_code(&mut text, word.letter, code),
            b'P' if given.non_modal == Some(100) => {
                text.put(b"P");
                text.put_decimal(given.p, 0);
            }
            b'L' => {
                text.put(b"L");
                text.put_decimal(given.l, 0);
            }
            b'T' => {
                text.put(b"T");
                text.put_decimal((word.tenths / 10).into(), 0);
            }
            letter => {
                text.put(&[letter]);
                put_value(&mut text, word.number);
            }
        }
    }
    if given.non_modal == Some(100) && !given.has(b'P') {
        text.put(b"P0");
    }
    text
}

/// Appends the number of a word. Decimals below a millionth of the smallest unit are dropped.
fn put_value(text: &mut Text, number: &[u8]) {
    match decimal(number, 9) {
        Some((value, _)) if number.len() > 12 => text.put_decimal(value, 9),
        _ => text.put(number),
    }
}

pub(super) fn put_code(text: &mut Text, letter: u8, tenths: u16) {
    text.put(&[letter]);
    match tenths % 10 {
        0 => text.put_decimal((tenths / 10).into(), 0),
        _ => text.put_decimal(tenths.into(), 1),
    }
}

fn apply_text(
    text: &[u8],
    modal: &mut Modal<3>,
    commands: &mut Commands<3>,
) -> Result<(), ErrorCode> {
    let mut block = Block::new();
    let dialect: Dialect = *modal.dialect();
    block
        .read(text, &dialect)
        .and_then(|()| modal.apply(&block, commands))
        .map_err(|error: Error| code_of(error.kind))
}

/// Returns the error number of Grbl for an error of `gcode` that [`Given::check`] does not detect.
fn code_of(kind: ErrorKind) -> ErrorCode {
    match kind {
        ErrorKind::NotALetter(_) => ErrorCode::ExpectedLetter,
        ErrorKind::MissingNumber(_) | ErrorKind::MalformedNumber | ErrorKind::TooManyDigits => {
            ErrorCode::BadNumber
        }
        ErrorKind::NotWhole(_) => ErrorCode::NotWhole,
        ErrorKind::RepeatedWord(_) => ErrorCode::Repeated,
        ErrorKind::TwoCodesOfOneGroup => ErrorCode::ModalGroup,
        ErrorKind::TwoUsersOfWords => ErrorCode::AxisConflict,
        ErrorKind::AxisWordsWithoutMotion => ErrorCode::AxisWords,
        ErrorKind::NoAxisWords => ErrorCode::NoAxisWords,
        ErrorKind::UnusedWord(_) => ErrorCode::Unused,
        ErrorKind::MachineFrame => ErrorCode::MachineFrame,
        ErrorKind::NoEnd => ErrorCode::NoPlaneWords,
        ErrorKind::RadiusTooSmall(_) => ErrorCode::BadRadius,
        ErrorKind::NoFeed | ErrorKind::NoInverseTime => ErrorCode::NoFeed,
        ErrorKind::Negative(_) => ErrorCode::Negative,
        ErrorKind::NoDwellTime | ErrorKind::MissingWord(_) => ErrorCode::MissingValue,
        ErrorKind::UnknownWord(_) | ErrorKind::UnknownCode(..) | ErrorKind::NotOfDialect(..) => {
            ErrorCode::Unsupported
        }
        _ => ErrorCode::BadTarget,
    }
}

/// Returns G20 or G21, in tenths.
pub(super) fn units_code(modal: &Modal<3>) -> u16 {
    match modal.units() {
        Units::Inches => 200,
        _ => 210,
    }
}

/// Returns G90 or G91, in tenths.
pub(super) fn distance_code(modal: &Modal<3>) -> u16 {
    match modal.distance() {
        Distance::Absolute => 900,
        Distance::Incremental => 910,
    }
}

/// Returns G93 or G94, in tenths.
pub(super) fn feed_mode_code(modal: &Modal<3>) -> u16 {
    match modal.feed_mode() {
        FeedMode::InverseTime => 930,
        _ => 940,
    }
}

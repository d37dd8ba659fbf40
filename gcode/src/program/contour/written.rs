//! Moves of a cycle as blocks with words of the program.

use super::passes::Move;
use super::reading::point;
use crate::blocks::block::Block;
use crate::blocks::fault::{Fault, Reason};
use crate::compensation::offset::{Vector, minus};
use crate::error::{Error, ErrorKind};
use crate::modal::Modal;
use crate::modal::modes::{Distance, Units};
use crate::values::decimal::Decimal;
use crate::values::nm::{Measure, Nm};
use crate::values::wide::divide;
use crate::words::word::Word;

/// The block that makes this move from the present state, exact to the nanometre. Its words have
/// the columns `at..end`.
pub(super) fn block<const N: usize>(
    wanted: Move,
    modal: &Modal<N>,
    (at, end): (usize, usize),
) -> Result<Block, Error> {
    let (code, to, centre) = match wanted {
        Move::Rapid(to) => (0, to, None),
        Move::Feed(to) => (1, to, None),
        Move::Thread { to, .. } => (32, to, None),
        Move::Arc {
            to,
            centre,
            clockwise,
        } => (if clockwise { 2 } else { 3 }, to, Some(centre)),
    };
    let here = point(&modal.position());
    let zero: Vector = [0, 2].map(|axis| modal.zero_of(axis).0);
    let origin = |distance| match distance {
        Distance::Absolute => zero,
        Distance::Incremental => here,
    };
    let [x, z] = minus(to, origin(modal.distance()));
    // A coordinate is at most 2^50, the difference of two 2^51.
    let across = if modal.is_diameter() {
        x.saturating_mul(2)
    } else {
        x
    };
    let centre = centre.map(|centre: Vector| minus(centre, origin(modal.centre_distance())));
    let [i, k] = centre.unwrap_or_default();
    let word = |letter, value: Option<Decimal>| match value {
        Some(value) => Ok(Word {
            letter,
            value,
            at,
            end,
        }),
        None => Err(Error {
            kind: ErrorKind::NumberTooLarge,
            at,
            end,
        }),
    };
    let units = modal.units();
    let words = [
        Some(word(b'G', Decimal::new(code, 0))),
        Some(word(b'X', number(across, units))),
        Some(word(b'Z', number(z, units))),
        centre.map(|_| word(b'I', number(i, units))),
        centre.map(|_| word(b'K', number(k, units))),
        match wanted {
            Move::Thread { lead, .. } => Some(word(b'K', number(lead, units))),
            _ => None,
        },
    ];
    Block::from_words(words.into_iter().flatten(), modal.dialect())
}

/// A length below 2^52 as a number that is read as the same nanometres: exact in millimetres,
/// within 0.002 nm in inches.
fn number(length: i64, units: Units) -> Option<Decimal> {
    match units {
        Units::Millimetres => Decimal::new(length, 6),
        Units::Micrometres => Decimal::new(length, 3),
        Units::Inches => {
            // 10^10 / 25.4e6 is 50000 / 127; the product is below 2^68.
            let above = u128::from(length.unsigned_abs()).wrapping_mul(50_000);
            let digits = i64::try_from(divide(above.wrapping_add(63), 127)).ok()?;
            let signed = if length < 0 {
                digits.wrapping_neg()
            } else {
                digits
            };
            Decimal::new(signed, 10)
        }
    }
}

/// The words of a block with these letters as a separate block.
pub(super) fn part<const N: usize>(
    block: &Block,
    letters: &[u8],
    modal: &Modal<N>,
) -> Result<Block, Error> {
    let words = letters.iter().filter_map(|&letter| {
        let value = block.word(letter)?;
        // An error there has the columns of the word.
        let place = block.error(Fault::at(Reason::NoEnd, letter), Measure::of(Nm(0)));
        Some(Ok(Word {
            letter,
            value,
            at: place.at,
            end: place.end,
        }))
    });
    Block::from_words(words, modal.dialect())
}

/// A length of a word that is never a diameter. Without a decimal point it is in thousandths of a
/// millimetre, or ten-thousandths of an inch.
pub(super) fn counted_length<const N: usize>(
    block: &Block,
    letter: u8,
    modal: &Modal<N>,
) -> Result<Option<Nm>, Fault> {
    match block.word(letter).filter(|value| value.places() == 0) {
        None => plain_length(block, letter, modal),
        Some(value) => {
            let places = match modal.units() {
                Units::Inches => 4,
                _ => 3,
            };
            let small = Decimal::new(value.digits(), places);
            let length = small.and_then(|small| modal.units().length(small));
            let length = length.ok_or(Fault::at(Reason::NumberTooLarge, letter))?;
            Ok(Some(length))
        }
    }
}

/// A length of a word that is never a diameter.
pub(super) fn plain_length<const N: usize>(
    block: &Block,
    letter: u8,
    modal: &Modal<N>,
) -> Result<Option<Nm>, Fault> {
    match block.word(letter) {
        None => Ok(None),
        Some(value) => {
            let length = modal.units().length(value);
            let length = length.ok_or_else(|| Fault::at(Reason::NumberTooLarge, letter))?;
            Ok(Some(length))
        }
    }
}

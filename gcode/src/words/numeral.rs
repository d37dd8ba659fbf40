//! The number of a word from its text: short code for common numbers, and code for all numbers.

use crate::error::{Error, ErrorKind};
use crate::values::decimal::Decimal;

/// Blanks inside a line; the ends of lines are blanks for a text that is one line.
pub(crate) const fn is_blank(byte: u8, lines: bool) -> bool {
    matches!(byte, b' ' | b'\t') || (!lines && matches!(byte, b'\r' | b'\n'))
}

/// The byte at a position; 0 beyond the end, which occurs in no number and no blank. In 32 bits, so
/// that no instruction is spent on cutting it to eight.
#[inline(always)]
fn byte_at(text: &[u8], at: usize) -> u32 {
    match text.get(at) {
        Some(&byte) => u32::from(byte),
        None => 0,
    }
}

/// Appends the digits from a position on to `low`. Returns the new number, the position after them
/// and the byte there. The number is right as long as it has nine digits.
#[inline(always)]
fn digits(text: &[u8], mut at: usize, mut low: u32) -> (u32, usize, u32) {
    loop {
        let byte = byte_at(text, at);
        let digit = byte.wrapping_sub(ZERO);
        if digit > 9 {
            return (low, at, byte);
        }
        low = low.wrapping_mul(10).wrapping_add(digit);
        at = at.wrapping_add(1); // below the length of the text
    }
}

pub(crate) const ZERO: u32 = b'0' as u32;
const NINE: u32 = b'9' as u32;
const POINT: u32 = b'.' as u32;
const PLUS: u32 = b'+' as u32;
const MINUS: u32 = b'-' as u32;
const SPACE: u32 = b' ' as u32;
pub(crate) const LINE_FEED: u32 = b'\n' as u32;

/// Index of a letter in the alphabet; at least 26 for other bytes.
#[inline(always)]
pub(crate) fn alphabet(byte: u32) -> u32 {
    (byte & !0x20).wrapping_sub(b'A' as u32)
}

/// Bytes of a word and of the text after it, enough for the words of most programs.
pub(crate) const WINDOW: usize = 16;

/// Whether the words of one line are read through the window too. It takes a quarter of a kilobyte
/// of code, for which processors without compare-and-swap (Cortex-M0) have little room.
pub(crate) const QUICK: bool = cfg!(target_has_atomic = "32");

/// Largest number of digits before the point within the window.
const WHOLE: usize = 4;

/// Largest number of digits after it. Together nine: below 10^9 < 2^30.
const PLACES: usize = 5;

/// A byte of the window. All positions used are below `1 + 1 + WHOLE + 1 + PLACES + 2 = 14`.
#[inline(always)]
pub(crate) fn window_at(window: &[u8; WINDOW], at: usize) -> u32 {
    match window.get(at) {
        Some(&byte) => u32::from(byte),
        None => 0,
    }
}

/// The number of a word whose letter is the first byte of the window, if it has few digits and no
/// blank inside: its value, the position after it and the position after a blank. `None` for
/// everything else, right or wrong. The loops have fixed lengths, so that unrolled loops need no
/// counter.
#[inline(always)]
pub(crate) fn window_number(window: &[u8; WINDOW], lines: bool) -> Option<(Decimal, usize, usize)> {
    let (mut at, mut negative) = (1, false);
    let sign = window_at(window, 1);
    if sign.wrapping_sub(ZERO) > 9 {
        negative = sign == MINUS;
        if negative || sign == PLUS {
            at = 2;
        }
    }
    let (mut low, mut whole) = (0_u32, 0);
    let mut byte = window_at(window, at);
    while whole < WHOLE {
        let digit = byte.wrapping_sub(ZERO);
        if digit > 9 {
            break;
        }
        low = low.wrapping_mul(10).wrapping_add(digit);
        whole = whole.wrapping_add(1);
        byte = window_at(window, at.wrapping_add(whole));
    }
    at = at.wrapping_add(whole);
    let mut places = 0;
    if byte == POINT {
        at = at.wrapping_add(1);
        byte = window_at(window, at);
        while places < PLACES {
            let digit = byte.wrapping_sub(ZERO);
            if digit > 9 {
                break;
            }
            low = low.wrapping_mul(10).wrapping_add(digit);
            places = places.wrapping_add(1);
            byte = window_at(window, at.wrapping_add(places));
        }
        if places | whole == 0 {
            return None;
        }
        at = at.wrapping_add(places);
    } else if whole == 0 {
        return None;
    }
    let end = at;
    if byte == SPACE {
        at = at.wrapping_add(1);
        byte = window_at(window, at);
    }
    // Digits, and below them points, signs, commas and blanks: bytes that may continue a number or
    // be wrong in it.
    if byte > NINE || (lines && byte == LINE_FEED) {
        let value = Decimal::short(low, places as u8, negative)?;
        return Some((value, end, at));
    }
    None
}

/// A number of one to nine digits without blanks inside: its value, the position after it and the
/// position after the following blanks. `None` for everything else, right or wrong, which
/// [`number`] handles.
#[inline(always)]
pub(crate) fn short_number(text: &[u8], at: usize, lines: bool) -> Option<(Decimal, usize, usize)> {
    let sign = byte_at(text, at);
    let negative = sign == MINUS;
    let mut first = at;
    if negative || sign == PLUS {
        first = at.wrapping_add(1);
    }
    let (mut low, mut end, mut byte) = digits(text, first, 0);
    let mut places = 0;
    if byte == POINT {
        let point = end.wrapping_add(1);
        (low, end, byte) = digits(text, point, low);
        places = end.wrapping_sub(point);
        // From here on only for the count: the point is not a digit.
        first = first.wrapping_add(1);
    }
    // 1..=9 digits: below 10^9 < 2^30. There are at most as many places.
    if end.wrapping_sub(first).wrapping_sub(1) > 8 {
        return None;
    }
    let mut next = end;
    if byte == SPACE {
        next = end.wrapping_add(1);
        byte = byte_at(text, next);
    }
    // The number also ends at the end of the text, and before a NUL.
    if alphabet(byte) > 25 && byte != 0 && !(lines && byte == LINE_FEED) {
        next = behind_number(text, next, lines)?;
    }
    let value = Decimal::short(low, places as u8, negative)?;
    Some((value, end, next))
}

/// The position after the blanks that follow a number; `None` where the number continues after
/// them, or is wrong there.
#[inline(never)]
fn behind_number(text: &[u8], mut at: usize, lines: bool) -> Option<usize> {
    while let Some(&byte) = text.get(at) {
        match byte {
            b'0'..=b'9' | b'.' | b'+' | b'-' | b',' => return None,
            _ if is_blank(byte, lines) => at = at.wrapping_add(1),
            _ => break,
        }
    }
    Some(at)
}

/// The number after the letter at the start of the text: `[+-] digits [. digits]` with at least one
/// digit, blanks anywhere. Returns it with the position after it, twice. An error covers the rest
/// of the text that looks like this number.
#[cold]
#[inline(never)]
pub(crate) fn number(
    text: &[u8],
    letter: u8,
    lines: bool,
) -> Result<(Decimal, usize, usize), Error> {
    let mut value = Decimal::default();
    let mut at = 1_usize;
    let mut end = at;
    while text.get(at).is_some_and(|&byte| is_blank(byte, lines)) {
        at = at.wrapping_add(1);
    }
    let first = at;
    let (mut negative, mut signed, mut point, mut digits) = (false, false, false, false);
    while let Some(&byte) = text.get(at) {
        let fault = match byte {
            b'0'..=b'9' => {
                digits = true;
                let digit = byte.wrapping_sub(b'0');
                value.push(digit, point)
            }
            b'.' if !point => {
                point = true;
                Ok(())
            }
            b'+' | b'-' if !(signed || point || digits) => {
                signed = true;
                negative = byte == b'-';
                Ok(())
            }
            b'.' | b'+' | b'-' => Err(ErrorKind::MalformedNumber),
            b',' if !point => Err(ErrorKind::DecimalComma),
            b'#' | b'[' if !digits => Err(ErrorKind::Expression),
            _ if is_blank(byte, lines) => {
                at = at.wrapping_add(1);
                continue;
            }
            _ => break,
        };
        let here = at;
        at = at.wrapping_add(1);
        end = at;
        if let Err(kind) = fault {
            while matches!(text.get(end), Some(b'0'..=b'9' | b'.')) {
                end = end.wrapping_add(1);
            }
            let at = match kind {
                ErrorKind::NumberTooLarge | ErrorKind::TooManyDigits => first,
                _ => here,
            };
            return Err(Error { kind, at, end });
        }
    }
    if !digits {
        let kind = ErrorKind::MissingNumber(letter);
        return Err(Error { kind, at: 0, end });
    }
    let value = if negative { value.negated() } else { value };
    Ok((value, end, end))
}

//! Lines of a text, and those with a number.

use crate::dialect::Dialect;
use crate::word::words;

/// A place between two lines.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
pub(super) struct Place {
    pub(super) at: usize,
    /// Number of the line behind it.
    pub(super) number: usize,
}

/// The line behind a place, without its end, and the place behind it.
pub(super) fn line_at(text: &[u8], place: Place) -> Option<(&[u8], Place)> {
    let rest = text.get(place.at..).filter(|rest| !rest.is_empty())?;
    let ends = (0..rest.len()).zip(rest).find(|&(_, &byte)| byte == b'\n');
    let length = ends.map_or(rest.len(), |(length, _)| length);
    let line = rest.get(..length).unwrap_or_default();
    let at = place.at.wrapping_add(length).wrapping_add(1);
    let after = Place {
        at: at.min(text.len()),
        number: place.number.wrapping_add(1),
    };
    Some((line.strip_suffix(b"\r").unwrap_or(line), after))
}

/// The number behind the `N` that a line begins with.
pub(super) fn number_of(line: &[u8], dialect: &Dialect) -> Option<i64> {
    let mut words = words(line);
    let first = words.next()?.ok()?;
    if first.letter != b'N' || (words.is_deleted() && dialect.block_delete()) {
        return None;
    }
    first.value.whole()
}

/// The place of the last line with this number from a place up to a byte, or of the first one.
pub(super) fn find(
    text: &[u8],
    from: Place,
    until: usize,
    number: i64,
    last: bool,
    dialect: &Dialect,
) -> Option<Place> {
    let (mut place, mut found) = (from, None);
    while let Some((line, after)) = line_at(text, place).filter(|_| place.at < until) {
        if number_of(line, dialect) == Some(number) {
            found = Some(place);
            if !last {
                return found;
            }
        }
        place = after;
    }
    found
}

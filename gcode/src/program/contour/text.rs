//! Lines of a text, and lines with a number.

use crate::codes::dialect::Dialect;
use crate::program::line::first_line;
use crate::words::word::words;

/// A position between two lines.
#[derive(Copy, Clone, Eq, PartialEq, Debug)]
pub(super) struct Place {
    pub(super) at: usize,
    /// Number of the line after it.
    pub(super) number: usize,
}

/// The line after a position, without its line end, and the position after it.
pub(super) fn line_at(text: &[u8], place: Place) -> Option<(&[u8], Place)> {
    let (line, behind) = first_line(text.get(place.at..)?)?;
    let after = Place {
        // `behind` is the end of the text.
        at: text.len().wrapping_sub(behind.len()),
        number: place.number.wrapping_add(1),
    };
    Some((line, after))
}

/// The number of lines of a text.
pub(super) fn count(text: &[u8]) -> usize {
    let start = Place { at: 0, number: 0 };
    let next = |&place: &Place| line_at(text, place).map(|(_, after)| after);
    let last = core::iter::successors(Some(start), next).last();
    last.map_or(0, |place| place.number)
}

/// The number of the `N` that starts a line.
pub(super) fn number_of(line: &[u8], dialect: &Dialect) -> Option<i64> {
    let mut words = words(line);
    let first = words.next()?.ok()?;
    if first.letter != b'N' || (words.is_deleted() && dialect.block_delete()) {
        return None;
    }
    first.value.whole()
}

/// The position of the last line with this number, from a position up to a byte; or of the first
/// one.
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

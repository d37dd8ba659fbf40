//! The words of a line of a routine.

use std::ops::Range;

/// A word and its position in its line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Word<'t> {
    /// Its text.
    pub text: &'t str,
    /// Its bytes in the line.
    pub span: Range<usize>,
}

/// The words of a line up to its comment. `x10` is two words as in G-code, and so is `12mm`.
pub fn words(line: &str) -> Vec<Word<'_>> {
    let code = line.split(['#', ';']).next().unwrap_or_default();
    let mut words = Vec::new();
    let mut from = None;
    for (at, c) in code.char_indices().chain([(code.len(), ' ')]) {
        match (from, c.is_whitespace() || c == ',') {
            (None, false) => from = Some(at),
            (Some(start), true) => {
                split(code, start..at, &mut words);
                from = None;
            }
            _ => {}
        }
    }
    words
}

/// The bytes of a line from its first to its last word.
#[must_use]
pub fn span(line: &str) -> Range<usize> {
    let all = words(line);
    let start = all.first().map_or(0, |word| word.span.start);
    start..all.last().map_or(0, |word| word.span.end)
}

/// Splits a text without spaces into the letter of an axis, a number and its unit. Any other text
/// stays one word.
fn split<'t>(code: &'t str, span: Range<usize>, words: &mut Vec<Word<'t>>) {
    let text = &code[span.clone()];
    let is_axis = text.starts_with(['x', 'y', 'z', 'X', 'Y', 'Z']);
    let behind = text.get(1..).unwrap_or_default();
    let cut = if is_axis && is_number(unit_cut(behind).0) {
        1
    } else {
        0
    };
    let (axis, rest) = text.split_at(cut);
    let (number, unit) = unit_cut(rest);
    let mut at = span.start;
    let pieces = if is_number(number) {
        [axis, number, unit]
    } else {
        [axis, rest, ""]
    };
    for piece in pieces {
        if !piece.is_empty() {
            words.push(Word {
                text: piece,
                span: at..at + piece.len(),
            });
        }
        at += piece.len();
    }
}

/// Splits a text after its last digit.
fn unit_cut(text: &str) -> (&str, &str) {
    let end = text.rfind(|c: char| c.is_ascii_digit() || c == '.');
    text.split_at(end.map_or(0, |at| at + 1))
}

/// Whether a word is a number: an optional sign or `+-`, then digits with an optional decimal
/// point.
pub fn is_number(text: &str) -> bool {
    let digits = ["+-", "\u{b1}", "+", "-"]
        .iter()
        .find_map(|sign| text.strip_prefix(sign))
        .unwrap_or(text);
    !digits.is_empty()
        && digits.starts_with(|c: char| c.is_ascii_digit() || c == '.')
        && digits.contains(|c: char| c.is_ascii_digit())
        && digits.bytes().all(|b| b.is_ascii_digit() || b == b'.')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn written_together() {
        let texts = |line| -> Vec<String> {
            let words = words(line).into_iter();
            words.map(|word| word.text.to_owned()).collect()
        };
        assert_eq!(
            texts("point P1 at x-10.5 Y2mm z 3 in towards -z # top"),
            [
                "point", "P1", "at", "x", "-10.5", "Y", "2", "mm", "z", "3", "in", "towards", "-z"
            ]
        );
        assert_eq!(texts("diameter 12 +-0.02; x"), ["diameter", "12", "+-0.02"]);
        assert_eq!(
            texts("\u{b1}20um +0.03,-0.01"),
            ["\u{b1}20", "um", "+0.03", "-0.01"]
        );
        assert_eq!(texts("bore X_1 1.2.3"), ["bore", "X_1", "1.2.3"]);
        assert_eq!(words(" \u{e9}t\u{e9} x")[1].span, 7..8);
    }
}

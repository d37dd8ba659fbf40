//! Comments in parentheses.

use crate::words::scanner::is_end;

/// The length of the comment at the start of a text, with its parentheses; `None` if it is not
/// closed. The text is the rest of its line.
#[cfg(feature = "program")]
pub(crate) fn comment_length(text: &[u8]) -> Option<usize> {
    comment_within(text, false).ok()
}

/// The length of the comment at the start of a text, with its parentheses, or the length of its
/// line if it is not closed. With `lines` the text has more lines.
///
/// Pairs of parentheses may stand within a comment. One that is not closed ends with its line if
/// that line ends with `)`, as in `(tool 1 (flat)`.
///
/// # Cost
/// One pass over the comment, or over the line.
pub(crate) fn comment_within(text: &[u8], lines: bool) -> Result<usize, usize> {
    let (mut depth, mut closed, mut at) = (0_usize, 0, 0_usize);
    loop {
        let byte = match text.get(at) {
            Some(&byte) if !(lines && is_end(byte)) => byte,
            _ => return if closed == 0 { Err(at) } else { Ok(closed) },
        };
        at = at.wrapping_add(1); // at most the length of the text
        match byte {
            // At most the length of the text; the first byte is a `(`.
            b'(' => depth = depth.wrapping_add(1),
            b')' => {
                depth = depth.wrapping_sub(1);
                if depth == 0 {
                    return Ok(at);
                }
                closed = at;
            }
            b' ' | b'\t' | b'\r' | b'\n' => {}
            _ => closed = 0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_comment_ends_with_its_own_parenthesis() {
        for (text, length) in [
            ("(a) X1", Some(3)),
            ("(a (b) c) X1", Some(9)),
            ("((()))()", Some(6)),
            ("()", Some(2)),
            ("(a (b) \t", Some(6)),
            ("(a (b) X1", None),
            ("(a", None),
            ("(", None),
        ] {
            assert_eq!(
                comment_within(text.as_bytes(), false).ok(),
                length,
                "{text}"
            );
        }
    }
}

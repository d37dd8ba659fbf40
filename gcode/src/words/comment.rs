//! Comments in parentheses.

/// The length of the comment at the start of a text, with its parentheses; `None` if it is not
/// closed. The text is the rest of its line.
///
/// Pairs of parentheses may stand within a comment. One that is not closed ends with its line if
/// that line ends with `)`, as in `(tool 1 (flat)`.
///
/// # Cost
/// One pass over the comment, or over the line.
pub(crate) fn comment_length(text: &[u8]) -> Option<usize> {
    let mut depth = 0_usize;
    let mut closed = None;
    for (end, byte) in (1_usize..).zip(text) {
        match byte {
            // Both at most the length of the text; the first byte is a `(`.
            b'(' => depth = depth.wrapping_add(1),
            b')' => {
                depth = depth.wrapping_sub(1);
                closed = Some(end);
                if depth == 0 {
                    return closed;
                }
            }
            b' ' | b'\t' | b'\r' | b'\n' => {}
            _ => closed = None,
        }
    }
    closed
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
            assert_eq!(comment_length(text.as_bytes()), length, "{text}");
        }
    }
}

//! Lines of a text.

/// Returns the lines of `text` with their numbers from 1. Lines have no line end, which is LF, CR
/// LF or CR. A line end at the end of the text starts no further line.
///
/// # Cost
/// One test of each byte.
pub const fn lines(text: &[u8]) -> Lines<'_> {
    Lines {
        rest: text,
        number: 0,
    }
}

/// Iterator of [`lines`].
#[derive(Clone, Debug)]
pub struct Lines<'a> {
    rest: &'a [u8],
    number: usize,
}

impl<'a> Iterator for Lines<'a> {
    type Item = (usize, &'a [u8]);

    fn next(&mut self) -> Option<Self::Item> {
        if self.rest.is_empty() {
            return None;
        }
        let is_end = |byte: &u8| matches!(byte, b'\n' | b'\r');
        let end = self.rest.iter().position(is_end);
        let (line, behind) = self.rest.split_at_checked(end.unwrap_or(self.rest.len()))?;
        let length = if behind.starts_with(b"\r\n") { 2 } else { 1 };
        self.rest = behind.get(length..).unwrap_or_default();
        // There are at most as many lines as bytes.
        self.number = self.number.wrapping_add(1);
        Some((self.number, line))
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::vec::Vec;

    #[test]
    fn all_line_ends() {
        let found: Vec<_> = lines(b"a\nb\r\nc\rd\n\n\re").collect();
        let expected: [&[u8]; 7] = [b"a", b"b", b"c", b"d", b"", b"", b"e"];
        assert_eq!(found, (1..).zip(expected).collect::<Vec<_>>());
        assert_eq!(lines(b"").count(), 0);
        assert_eq!(lines(b"\n").count(), 1);
    }
}
